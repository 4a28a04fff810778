//! `check` and `verify` as a gate in somebody's CI meets them: what passes, what does not and for which reason, and what cannot be used.

#[path = "common/program.rs"]
mod program;

use std::path::Path;

use program::{done, fails, json, run, text};
use serde_json::Value;
use undulate::{
    CollisionModel, CollisionOptions, Motion, Reason, Spline, StartPosture, State, Waypoints,
};

/// A column with an arm of two links beside it that can reach back into the column; `base` and `fore` are the one pair to check.
const URDF: &str = r#"<robot name="two">
  <link name="base"><collision><origin xyz="0 0 0.3"/><geometry><cylinder radius="0.08" length="0.6"/></geometry></collision></link>
  <link name="upper"><collision><origin xyz="0 0 0.15"/><geometry><cylinder radius="0.03" length="0.2"/></geometry></collision></link>
  <link name="fore"><collision><origin xyz="0 0 0.125"/><geometry><cylinder radius="0.03" length="0.25"/></geometry></collision></link>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0.2 0 0.5"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" velocity="2" effort="9"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/><origin xyz="0 0 0.3"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" velocity="2" effort="9"/></joint>
</robot>"#;

const NOD: &str = "time_s,shoulder,elbow\n0,0,0\n1,0.5,0.25\n2,0,0\n";
const NOD_JSON: &str = r#"{"joint_names": ["elbow", "shoulder"], "points": [
  {"positions": [0, 0], "time_from_start": {"sec": 0, "nanosec": 0}},
  {"positions": [0.25, 0.5], "time_from_start": 1.0},
  {"positions": [0, 0], "time_from_start": {"secs": 2, "nsecs": 0}}]}"#;
const NOD_YAML: &str = "/play:\n  ros__parameters:\n    motions:\n      nod:\n        joints: [shoulder, elbow]\n        positions: [0, 0, 0.5, 0.25, 0, 0]\n        times_from_start: [0, 1, 2]\n";
/// Reaches back, and into the column.
const BACK: &str = "time_s,shoulder,elbow\n0,0,0\n2,-1,-2\n4,0,0\n";

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, content) in [
        ("two.urdf", URDF),
        ("nod.csv", NOD),
        ("nod.json", NOD_JSON),
        ("nod.yaml", NOD_YAML),
        ("back.csv", BACK),
    ] {
        std::fs::write(folder.path().join(name), content).unwrap();
    }
    folder
}

/// The report of a run with --json that must end with `code`, and what it says on standard error.
fn report(at: &Path, code: i32, arguments: &[&str]) -> (Value, String) {
    let arguments: Vec<&str> = arguments.iter().copied().chain(["--json"]).collect();
    let output = run(at, &arguments);
    let error = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {error}");
    let value = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|e| panic!("{arguments:?}: no one object on standard output: {e}"));
    (value, error)
}

/// The same with masses.
fn heavy() -> String {
    let inertial = r#"<inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>"#;
    URDF.replace("</link>", inertial)
}

/// Ten seconds at a kilohertz of standing still, but for one waypoint somewhere.
fn spike() -> String {
    let mut text = "time_s,shoulder,elbow,shoulder/velocity,elbow/velocity\n".to_owned();
    for n in 0..=10_000 {
        let velocity = if n == 5_003 { 1.0 } else { 0.0 };
        text.push_str(&format!("{:?},0,0,{velocity},0\n", f64::from(n) / 1000.0));
    }
    text
}

fn check<'a>(motion: &'a str, options: &[&'a str]) -> Vec<&'a str> {
    let fixed = ["check", motion, "--robot", "two.urdf"];
    let count = if options.contains(&"--robot") { 2 } else { 4 };
    fixed
        .into_iter()
        .take(count)
        .chain(options.iter().copied())
        .collect()
}

#[test]
fn one_move_in_three_formats_gets_one_answer() {
    let folder = folder();
    let answer = |file: &str| {
        let mut value = json(folder.path(), &check(file, &["--margin", "0.01"]));
        assert_eq!(value["motion"], file);
        value["motion"].take();
        value
    };
    let csv = answer("nod.csv");
    assert_eq!(csv["passes"], true);
    assert_eq!(csv["reasons"], serde_json::json!([]));
    // At rest the nearest of the forearm is 9 cm beside the rim of the column and 20 cm above it; it leans away from there.
    let clearance = csv["collision"]["clearance_m"].as_array().unwrap();
    let (lower, upper) = (
        clearance[0].as_f64().unwrap(),
        clearance[1].as_f64().unwrap(),
    );
    assert!(0.0 < lower && lower <= upper && upper - lower <= 1e-4);
    let at_rest = f64::hypot(0.12 - 0.03, 0.2);
    assert!(lower <= at_rest, "{lower} {at_rest}");
    assert_eq!(csv, answer("nod.json"));
    assert_eq!(csv, answer("nod.yaml"));
}

#[test]
fn what_does_not_pass_has_its_reason_and_exit_code_3() {
    let folder = folder();
    let at = folder.path();
    for (name, content) in [
        ("slow.toml", "[limits.elbow]\nvelocity = 0.2\n"),
        (
            "fast.toml",
            "[limits.elbow]\nvelocity = 9\n[limits.shoulder]\nvelocity = 9\n",
        ),
        (
            "unlimited.urdf",
            &URDF.replacen("velocity=\"2\"", "velocity=\"0\"", 1),
        ),
        ("heavy.urdf", &heavy()),
        ("spike.csv", &spike()),
        (
            "ball.toml",
            "[[object]]\nname = \"ball\"\nsphere = { radius = 0.05 }\nposition = [0.2, 0, 1.0]\n",
        ),
        ("over.csv", "time_s,shoulder,elbow\n0,0,0\n3,3.2,0\n"),
        (
            "all.csv",
            "time_s,shoulder,elbow\n0,0,0\n0.2,-1,-2\n0.4,0,-3.5\n",
        ),
    ] {
        std::fs::write(at.join(name), content).unwrap();
    }
    for (motion, options, reasons) in [
        ("back.csv", vec![], vec!["self-collision"]),
        ("over.csv", vec![], vec!["position-limit"]),
        (
            "all.csv",
            vec![],
            vec!["position-limit", "velocity-limit", "self-collision"],
        ),
        (
            "nod.csv",
            vec!["--max-velocity", "0.4"],
            vec!["velocity-limit"],
        ),
        (
            "nod.csv",
            vec!["--limits", "slow.toml"],
            vec!["velocity-limit"],
        ),
        // What no joint may exceed, no file allows.
        (
            "nod.csv",
            vec!["--limits", "fast.toml", "--max-velocity", "0.4"],
            vec!["velocity-limit"],
        ),
        // A joint that nothing is known of may do nothing.
        (
            "nod.csv",
            vec!["--robot", "unlimited.urdf"],
            vec!["limit-missing"],
        ),
        (
            "spike.csv",
            vec!["--robot", "heavy.urdf"],
            vec!["effort-limit"],
        ),
        (
            "nod.csv",
            vec!["--max-acceleration", "100"],
            vec!["velocity-jump"],
        ),
        ("nod.csv", vec!["--margin", "0.25"], vec!["clearance"]),
        // Nothing meets, only what is around it.
        ("nod.csv", vec!["--padding", "0.25"], vec!["clearance"]),
        (
            "nod.csv",
            vec!["--pair-padding", "base:fore=0.25"],
            vec!["clearance"],
        ),
        (
            "back.csv",
            vec!["--padding", "0.01"],
            vec!["self-collision"],
        ),
        // Were each joint half a radian off, nobody could say.
        ("nod.csv", vec!["--tolerance", "0.5"], vec!["undecided"]),
        (
            "nod.csv",
            vec!["--tolerance", "elbow=80deg", "--tolerance", "0.01deg"],
            vec!["undecided"],
        ),
        (
            "nod.csv",
            vec!["--scene", "ball.toml"],
            vec!["scene-collision"],
        ),
    ] {
        let (value, _) = report(at, 3, &check(motion, &options));
        assert_eq!(value["passes"], false);
        assert_eq!(value["reasons"], serde_json::json!(reasons), "{options:?}");
        // The same in words.
        let output = run(at, &check(motion, &options));
        assert_eq!(output.status.code(), Some(3));
        let words = text(&output.stdout);
        for reason in reasons {
            assert!(words.contains(&format!("\nreason: {reason}\n")), "{words}");
        }
        assert!(words.ends_with("does not pass\n"), "{words}");
    }
    // What passes beside it.
    for options in [
        vec!["--max-velocity", "0.5"],
        vec!["--margin", "0.05", "--tolerance", "0.1deg"],
        vec!["--padding", "0.05"],
        vec!["--padding", "0.25", "--pair-padding", "fore:base=0"],
    ] {
        assert!(done(at, &check("nod.csv", &options)).ends_with("passes\n"));
    }
    // Which joint, when and by how much.
    let (value, _) = report(at, 3, &check("nod.csv", &["--max-velocity", "0.4"]));
    let broken: Vec<&Value> = value["limits"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|l| !l["reason"].is_null())
        .collect();
    assert_eq!(broken.len(), 1);
    assert_eq!(broken[0]["joint"], "shoulder");
    assert_eq!(broken[0]["source"], "given");
    assert!((broken[0]["excess"].as_f64().unwrap() - 0.1).abs() < 1e-12);
}

#[test]
fn what_cannot_be_used_does_not_pass_and_says_why() {
    let folder = folder();
    let at = folder.path();
    for (name, content) in [
        (
            "larger.csv",
            "time_s,shoulder,elbow,wrist\n0,0,0,0\n1,0,0,1\n",
        ),
        ("repeated.csv", "time_s,shoulder\n0,0\n1,0.1\n1,0.2\n"),
        ("backward.csv", "time_s,shoulder\n0,0\n2,0.1\n1,0.2\n"),
        ("nan.csv", "time_s,shoulder\n0,0\n1,nan\n"),
        ("late.csv", "time_s,shoulder\n1,0\n2,0.1\n"),
        ("cut.json", "{\"joint_names\": [\"shoulder\"], \"poi"),
        ("notes.txt", "wave at them"),
        (
            "both.yaml",
            "p:\n  ros__parameters:\n    motions:\n      a: {joints: [shoulder], positions: [0, 1], times_from_start: [0, 1]}\n      b: {joints: [shoulder], positions: [0, 9], times_from_start: [0, 9]}\n",
        ),
        (
            "fore.toml",
            "[[object]]\nname = \"fore\"\nsphere = { radius = 0.1 }\n",
        ),
        (
            "flat.toml",
            "[[object]]\nname = \"x\"\nsphere = { radius = 0 }\n",
        ),
    ] {
        std::fs::write(at.join(name), content).unwrap();
    }
    for (motion, options, code, reason, words) in [
        ("larger.csv", vec![], 1, "unknown-joint", "no joint `wrist`"),
        (
            "repeated.csv",
            vec![],
            1,
            "times-not-increasing",
            "repeated.csv, line 4",
        ),
        (
            "backward.csv",
            vec![],
            1,
            "times-not-increasing",
            "after 2 s",
        ),
        ("nan.csv", vec![], 1, "not-finite", "line 3"),
        (
            "late.csv",
            vec![],
            1,
            "start-unknown",
            "--from-first-waypoint",
        ),
        ("cut.json", vec![], 1, "unreadable", "cut.json"),
        ("notes.txt", vec![], 1, "unsupported", "notes.txt"),
        ("nobody.csv", vec![], 1, "unreadable", "nobody.csv"),
        ("both.yaml", vec![], 1, "unknown-motion", "one of a, b"),
        (
            "both.yaml",
            vec!["--motion", "c"],
            1,
            "unknown-motion",
            "no motion `c`",
        ),
        (
            "nod.csv",
            vec!["--scene", "fore.toml"],
            1,
            "invalid",
            "called `fore`, as a link is",
        ),
        (
            "nod.csv",
            vec!["--scene", "flat.toml"],
            1,
            "invalid",
            "flat.toml",
        ),
        (
            "nod.csv",
            vec!["--leave-out", "base:fore"],
            1,
            "no-collision-geometry",
            "no pair of links is checked",
        ),
        (
            "nod.csv",
            vec!["--leave-out", "base:hand"],
            1,
            "invalid",
            "no link or object `hand`",
        ),
        (
            "nod.csv",
            vec!["--at", "wrist=1"],
            1,
            "unknown-joint",
            "no joint `wrist`",
        ),
        (
            "nod.csv",
            vec!["--at", "elbow=1"],
            2,
            "start-unknown",
            "`shoulder`",
        ),
        (
            "nod.csv",
            vec!["--at", "elbow=1", "--at", "shoulder=0"],
            1,
            "start-elsewhere",
            "elbow",
        ),
        (
            "nod.csv",
            vec!["--margin", "-1"],
            2,
            "invalid",
            "a margin of -1 m",
        ),
        (
            "nod.csv",
            vec!["--tolerance", "5furlongs"],
            2,
            "invalid",
            "--tolerance 5furlongs",
        ),
        (
            "nod.csv",
            vec!["--tolerance", "-0.1"],
            2,
            "invalid",
            "a tolerance of -0.1",
        ),
        (
            "nod.csv",
            vec!["--accuracy", "0"],
            2,
            "invalid",
            "an accuracy of 0 m",
        ),
        (
            "nod.csv",
            vec!["--padding", "-0.1"],
            2,
            "invalid",
            "a padding of -0.1 m",
        ),
        (
            "nod.csv",
            vec!["--map", "wave_arm_human"],
            2,
            "invalid",
            "--map",
        ),
        ("nod.json", vec!["--degrees"], 2, "invalid", "--degrees"),
    ] {
        let (value, error) = report(at, code, &check(motion, &options));
        assert_eq!(value["passes"], false, "{motion} {options:?}");
        assert_eq!(
            value["reasons"],
            serde_json::json!([reason]),
            "{motion} {options:?}: {error}"
        );
        assert!(error.contains(words), "{motion} {options:?}: {error}");
        let output = run(at, &check(motion, &options));
        let told = text(&output.stdout);
        assert!(told.contains(&format!("reason: {reason}\n")), "{told}");
    }
    // Said where it starts, the late one is a move as any.
    for start in [vec!["--from-first-waypoint"], vec!["--at", "shoulder=0.1"]] {
        let (value, _) = report(at, 0, &check("late.csv", &start));
        assert_eq!(value["held"], serde_json::json!({"elbow": 0.0}));
    }
}

#[test]
fn a_wave_takes_no_options_of_moves() {
    let folder = folder();
    let at = folder.path();
    done(at, &["learn", "-o", "model.json"]);
    done(
        at,
        &["sample", "model.json", "--seed", "3", "-o", "wave.json"],
    );
    for option in [
        vec!["--degrees"],
        vec!["--at", "elbow=1"],
        vec!["--from-first-waypoint"],
        vec!["--motion", "x"],
    ] {
        let arguments = ["check", "wave.json", "--robot", "wave_arm"];
        let arguments: Vec<&str> = arguments.into_iter().chain(option.clone()).collect();
        let (value, error) = report(at, 2, &arguments);
        assert_eq!(value["passes"], false);
        assert!(error.contains(option[0]), "{error}");
    }
}

#[test]
fn several_motions_are_all_looked_at_whatever_becomes_of_one() {
    let folder = folder();
    let at = folder.path();
    std::fs::write(at.join("bad.csv"), "time_s,wrist\n0,0\n1,1\n").unwrap();
    let (value, error) = report(
        at,
        1,
        &check(
            "bad.csv",
            &["nod.csv", "back.csv", "nod.yaml", "--all-motions"],
        ),
    );
    assert!(error.contains("no joint `wrist`"), "{error}");
    assert_eq!(value["passes"], false);
    assert_eq!(
        value["reasons"],
        serde_json::json!(["self-collision", "unknown-joint"])
    );
    let passes: Vec<&Value> = value["motions"]
        .as_array()
        .unwrap()
        .iter()
        .map(|m| &m["passes"])
        .collect();
    assert_eq!(passes, [false, true, false, true]);
    assert_eq!(value["motions"][3]["motion"], "nod.yaml: nod");
    let (value, _) = report(at, 3, &check("nod.csv", &["back.csv"]));
    assert_eq!(value["reasons"], serde_json::json!(["self-collision"]));
    let (value, _) = report(at, 0, &check("nod.csv", &["nod.json"]));
    assert_eq!(value["passes"], true);
}

#[test]
fn pairs_say_why_and_an_srdf_is_not_trusted_in_silence() {
    let folder = folder();
    let at = folder.path();
    std::fs::write(
        at.join("two.srdf"),
        r#"<robot name="two"><disable_collisions link1="base" link2="fore" reason="Never"/></robot>"#,
    )
    .unwrap();
    std::fs::write(
        at.join("floor.toml"),
        "[[object]]\nname = \"floor\"\nhalf_space = { normal = [0, 0, 1], offset = 0.01 }\n",
    )
    .unwrap();
    let srdf = ["--srdf", "two.srdf", "--pairs"];
    let scene = ["--scene", "floor.toml"];
    let options: Vec<&str> = srdf.into_iter().chain(scene).collect();
    let (value, warnings) = report(at, 0, &check("back.csv", &options));
    assert!(
        warnings.contains("the SRDF disables base and fore (Never), and they touch in"),
        "{warnings}"
    );
    assert!(
        warnings.contains("floor of the scene touches base"),
        "{warnings}"
    );
    let pair = |links: [&str; 2]| {
        let pairs = value["pairs"].as_array().unwrap();
        let found = pairs
            .iter()
            .find(|p| p["links"] == serde_json::json!(links));
        found.unwrap().clone()
    };
    let disabled = pair(["base", "fore"]);
    assert_eq!(disabled["status"], "disabled by an SRDF: Never");
    assert_eq!(disabled["checked"], false);
    // In the whole square of positions it folds back into the column in a good part.
    let touching = disabled["touching"].as_u64().unwrap();
    assert!((20..500).contains(&touching), "{touching}");
    assert_eq!(disabled["samples"], 1000);
    assert_eq!(pair(["base", "upper"])["status"], "adjacent");
    assert_eq!(pair(["floor", "fore"])["checked"], true);
    assert_eq!(
        pair(["floor", "base"])["status"],
        "no joint between them, touching"
    );
    let words = done(at, &check("nod.csv", &options));
    assert!(words.contains("touching in 1000 random configurations of seed 0"));
    // Of this very move, and without being asked.
    let quiet = ["--srdf", "two.srdf", "--scene", "floor.toml"];
    let told = "the SRDF disables base and fore, and this motion makes them touch";
    let (value, warnings) = report(at, 0, &check("back.csv", &quiet));
    assert!(warnings.contains(told), "{warnings}");
    assert!(value["warnings"].to_string().contains(told), "{value}");
    let (_, warnings) = report(at, 0, &check("nod.csv", &quiet));
    assert!(!warnings.contains(told), "{warnings}");
    // Kept, it is checked and refused.
    let kept: Vec<&str> = options
        .iter()
        .copied()
        .chain(["--keep", "fore:base"])
        .collect();
    let (value, _) = report(at, 3, &check("back.csv", &kept));
    assert_eq!(value["reasons"], serde_json::json!(["self-collision"]));
}

#[test]
fn the_table_of_reasons_is_printed_whole() {
    let folder = tempfile::tempdir().unwrap();
    let words = done(folder.path(), &["check", "--reasons"]);
    for reason in Reason::ALL {
        assert!(words.contains(&format!("\n{:<22}{}\n", reason.code(), reason.meaning())));
    }
    let table = json(folder.path(), &["check", "--reasons"]);
    let codes: Vec<&str> = table["reasons"]
        .as_array()
        .unwrap()
        .iter()
        .map(|r| r["code"].as_str().unwrap())
        .collect();
    assert_eq!(codes, Reason::ALL.map(Reason::code));
    // Without a motion there is nothing else to say.
    fails(folder.path(), 2, &["check"]);
}

#[test]
fn figures_name_the_pair_and_mark_what_is_undecided() {
    let folder = folder();
    let at = folder.path();
    done(at, &check("nod.csv", &["--figure", "nod.svg"]));
    let svg = std::fs::read_to_string(at.join("nod.svg")).unwrap();
    assert!(svg.contains(">\nbase and fore, "));
    for word in ["clearance (mm)", "time (s)", "contact", "proven"] {
        assert!(svg.contains(&format!(">\n{word}\n</text>")), "{word}");
    }
    assert!(!svg.contains("undecided"));
    let unsure = [
        "--tolerance",
        "0.5",
        "--margin",
        "0.01",
        "--figure",
        "unsure.svg",
    ];
    report(at, 3, &check("nod.csv", &unsure));
    let svg = std::fs::read_to_string(at.join("unsure.svg")).unwrap();
    assert!(svg.contains(">\nundecided\n</text>") && svg.contains(">\nmargin\n</text>"));
    done(at, &check("nod.csv", &["nod.json", "--figure", "both.png"]));
    assert_eq!(
        &std::fs::read(at.join("both.png")).unwrap()[..4],
        b"\x89PNG"
    );
    fails(at, 2, &check("nod.csv", &["--figure", "nod.pdf"]));
}

/// Of single numbers: no time between the samples of a profile is nearer than its lower bound, and it is no looser than it says.
#[test]
fn a_profile_bounds_what_dense_samples_see() {
    let robot = undulate::Robot::from_urdf(URDF).unwrap();
    let collision = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
    let waypoints = Waypoints::from_csv("back.csv", BACK.as_bytes(), false).unwrap();
    let spline = Spline::new(&waypoints, StartPosture::Given).unwrap();
    let accuracy = 1e-3;
    let profile = collision.clearance_profile(&spline, 50, accuracy).unwrap();
    assert_eq!((profile[0].from, profile[49].to), (0.0, 4.0));
    let mut checker = collision.checker();
    let mut distance = |t: f64| {
        let mut state = State::zeros(2);
        spline.state_into(t, &mut state);
        checker
            .clearance(state.position.as_slice())
            .unwrap()
            .distance
    };
    // A bound that claims twice its accuracy more is caught somewhere.
    let mut caught = false;
    for interval in &profile {
        let least = (0..=200)
            .map(|i| distance(interval.from + (interval.to - interval.from) * f64::from(i) / 200.0))
            .fold(f64::INFINITY, f64::min);
        assert!(interval.lower <= least, "{interval:?} {least}");
        caught |= interval.lower + 2.0 * accuracy > least;
        assert!(interval.nearest.distance - interval.lower <= accuracy);
        assert!((interval.from..=interval.to).contains(&interval.nearest.time));
        assert!((distance(interval.nearest.time) - interval.nearest.distance).abs() < 1e-9);
    }
    assert!(caught);
    let least = collision.minimum_clearance(&spline, accuracy).unwrap();
    let of_profile = profile
        .iter()
        .map(|i| i.lower)
        .fold(f64::INFINITY, f64::min);
    assert!(least.lower < 0.0 && (of_profile - least.lower).abs() <= accuracy);
    for wrong in [
        collision.clearance_profile(&spline, 0, accuracy),
        collision.clearance_profile(&spline, 50, 0.0),
    ] {
        assert!(wrong.is_err());
    }
}

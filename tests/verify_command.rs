//! Certificates: written by `check`, verified by `verify`, and refused when anything of them or of what they rest on is another.

#[path = "common/program.rs"]
mod program;

use std::path::Path;

use program::{done, fails, json, run, text};
use serde_json::{Value, json as object};

/// A wave on the shipped arm with a table beside it, and its certificate: of a margin that leaves it little to spare, for of a calm wave with much
/// to spare one interval is proof enough.
fn certified() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    // A copy, so that it can be changed; its map is named, as for any file.
    std::fs::write(at.join("arm.urdf"), include_str!("../robots/wave_arm.urdf")).unwrap();
    std::fs::write(
        at.join("table.toml"),
        "[[object]]\nname = \"table\"\nbox = { size = [0.2, 0.2, 0.02] }\nposition = [0.9, 0, 0.3]\n",
    )
    .unwrap();
    std::fs::write(
        at.join("arm.srdf"),
        r#"<robot name="wave_arm"><disable_collisions link1="base" link2="head" reason="Never"/></robot>"#,
    )
    .unwrap();
    done(at, &["learn", "-o", "model.json"]);
    done(
        at,
        &[
            "sample",
            "model.json",
            "--seed",
            "3",
            "--robot",
            "wave_arm",
            "-o",
            "wave.json",
        ],
    );
    done(
        at,
        &[
            "sample",
            "model.json",
            "--seed",
            "4",
            "--robot",
            "wave_arm",
            "-o",
            "other.json",
        ],
    );
    let words = done(
        at,
        &with(&[
            "check",
            "wave.json",
            "--margin",
            "0.046",
            "--tolerance",
            "0.05deg",
            "--certificate",
            "cert.json",
        ]),
    );
    assert!(
        words.contains("wrote cert.json") && words.contains("passes"),
        "{words}"
    );
    folder
}

/// With the options of reading.
fn with<'a>(arguments: &[&'a str]) -> Vec<&'a str> {
    let reading = [
        "--robot",
        "arm.urdf",
        "--map",
        "wave_arm_demonstrator",
        "--scene",
        "table.toml",
        "--srdf",
        "arm.srdf",
    ];
    arguments.iter().copied().chain(reading).collect()
}

fn verify<'a>(certificate: &'a str, motion: &'a str) -> Vec<&'a str> {
    with(&["verify", certificate, motion])
}

fn read(at: &Path, name: &str) -> String {
    std::fs::read_to_string(at.join(name)).unwrap()
}

#[test]
fn a_certificate_names_what_it_rests_on_and_holds() {
    let folder = certified();
    let at = folder.path();
    let file: Value = serde_json::from_str(&read(at, "cert.json")).unwrap();
    let named: Vec<&str> = file["rests_on"]
        .as_array()
        .unwrap()
        .iter()
        .map(|e| e["what"].as_str().unwrap())
        .collect();
    assert_eq!(
        named,
        [
            "urdf",
            "srdf",
            "scene",
            "motion",
            "joint map",
            "joint motion"
        ]
    );
    let limits = file["limits"].as_array().unwrap();
    assert!(
        limits
            .iter()
            .all(|l| l.as_str().unwrap().ends_with("of the URDF"))
    );
    assert_eq!(file["margin_m"], 0.046);
    let value = json(at, &verify("cert.json", "wave.json"));
    assert_eq!(value["passes"], true);
    assert_eq!(value["intervals"], file["tree"].as_array().unwrap().len());
    assert!(value["spare_m"].as_f64().unwrap() > 0.0);
    let words = done(at, &verify("cert.json", "wave.json"));
    assert!(
        words.contains("joint map wave_arm_demonstrator: the same") && words.ends_with("holds\n")
    );
}

#[test]
fn other_files_are_refused_and_named() {
    let folder = certified();
    let at = folder.path();
    let refused = |words: &str, arguments: &[&str]| {
        let error = fails(at, 3, arguments);
        assert!(error.contains(words), "{error}");
        let arguments: Vec<&str> = arguments.iter().copied().chain(["--json"]).collect();
        let value: Value = serde_json::from_slice(&run(at, &arguments).stdout).unwrap();
        assert_eq!(value["passes"], false);
    };
    refused(
        "the motion `other.json` is not the one",
        &verify("cert.json", "other.json"),
    );
    for (name, what) in [
        ("arm.urdf", "urdf"),
        ("arm.srdf", "srdf"),
        ("table.toml", "scene"),
        ("wave.json", "motion"),
    ] {
        let before = read(at, name);
        // One byte, which changes nothing of what it says.
        std::fs::write(at.join(name), format!("{before}\n")).unwrap();
        refused(
            &format!("the {what} `{name}` is not the one"),
            &verify("cert.json", "wave.json"),
        );
        std::fs::write(at.join(name), before).unwrap();
    }
    let without: Vec<&str> = verify("cert.json", "wave.json")[..7].to_vec();
    refused("rests on the srdf `arm.srdf`, and none is given", &without);
    // Padding and pairs are part of what was proven.
    let all = verify("cert.json", "wave.json");
    for option in [["--padding", "0.001"], ["--leave-out", "torso:hand"]] {
        let arguments: Vec<&str> = all.iter().copied().chain(option).collect();
        refused("the pairs that are checked are others", &arguments);
    }
    done(at, &all);
}

#[test]
fn a_certificate_that_was_changed_is_refused() {
    let folder = certified();
    let at = folder.path();
    let file: Value = serde_json::from_str(&read(at, "cert.json")).unwrap();
    let last = file["tree"].as_array().unwrap().len() - 1;
    type Change<'a> = Box<dyn Fn(&mut Value) + 'a>;
    let changes: Vec<(&str, &str, Change)> = vec![
        (
            "a leaf removed",
            "not proven from",
            Box::new(|f| {
                f["tree"].as_array_mut().unwrap().remove(last / 2);
            }),
        ),
        (
            "the last leaf removed",
            "not proven from",
            Box::new(|f| {
                f["tree"].as_array_mut().unwrap().remove(last);
            }),
        ),
        (
            "a pair left out of a leaf",
            "not proven from",
            Box::new(|f| {
                f["tree"][last][2].as_array_mut().unwrap().pop();
            }),
        ),
        (
            "one leaf for all",
            "may come nearer",
            Box::new(|f| {
                let duration = f["duration_s"].as_f64().unwrap();
                let pairs = f["checked"].as_array().unwrap().len();
                let all: Vec<usize> = (0..pairs).collect();
                f["tree"] = object!([[duration / 2.0, duration / 2.0, all]]);
            }),
        ),
        (
            "a half width enlarged",
            "may come nearer",
            Box::new(|f| {
                for leaf in f["tree"].as_array_mut().unwrap() {
                    leaf[1] = object!(leaf[1].as_f64().unwrap() * 4.0);
                }
            }),
        ),
        (
            "the margin raised",
            "above the margin",
            Box::new(|f| f["margin_m"] = object!(0.05)),
        ),
        (
            "the tolerance raised",
            "may come nearer",
            Box::new(|f| {
                f["tolerance"] = object!(vec![0.2; f["joints"].as_array().unwrap().len()]);
            }),
        ),
        (
            "a margin that is none",
            "a margin or tolerance",
            Box::new(|f| f["margin_m"] = object!(-1.0)),
        ),
        (
            "a pair not checked",
            "pairs that are checked are others",
            Box::new(|f| {
                let pair = f["checked"].as_array_mut().unwrap().pop().unwrap();
                let count = f["checked"].as_array().unwrap().len();
                for leaf in f["tree"].as_array_mut().unwrap() {
                    leaf[2]
                        .as_array_mut()
                        .unwrap()
                        .retain(|p| p.as_u64() != Some(count as u64));
                }
                f["not_checked"]
                    .as_array_mut()
                    .unwrap()
                    .push(object!({"pair": pair["pair"], "why": "left out by the caller"}));
            }),
        ),
        (
            "another duration",
            "a motion of",
            Box::new(|f| f["duration_s"] = object!(1.0)),
        ),
        (
            "another geometry",
            "geometry is another",
            Box::new(|f| {
                f["geometry_sha256"] = object!("0".repeat(64));
            }),
        ),
        (
            "no motion named",
            "names no motion",
            Box::new(|f| {
                f["rests_on"]
                    .as_array_mut()
                    .unwrap()
                    .retain(|e| e["what"] != "motion");
            }),
        ),
        (
            "no scene named",
            "rests on none",
            Box::new(|f| {
                f["rests_on"]
                    .as_array_mut()
                    .unwrap()
                    .retain(|e| e["what"] != "scene");
            }),
        ),
    ];
    for (name, words, change) in &changes {
        let mut changed = file.clone();
        change(&mut changed);
        assert_ne!(changed, file, "{name}");
        std::fs::write(at.join("changed.json"), changed.to_string()).unwrap();
        let error = fails(at, 3, &verify("changed.json", "wave.json"));
        assert!(error.contains(words), "{name}: {error}");
    }
    // As it was written it holds; what is no certificate cannot be used.
    std::fs::write(at.join("changed.json"), file.to_string()).unwrap();
    done(at, &verify("changed.json", "wave.json"));
    for content in [
        "",
        "{}",
        &read(at, "wave.json"),
        &read(at, "cert.json")[..2000],
    ] {
        std::fs::write(at.join("changed.json"), content).unwrap();
        fails(at, 1, &verify("changed.json", "wave.json"));
    }
}

#[test]
fn none_is_written_for_what_does_not_pass() {
    let folder = certified();
    let at = folder.path();
    let arguments = with(&[
        "check",
        "wave.json",
        "--margin",
        "0.5",
        "--certificate",
        "no.json",
    ]);
    let output = run(at, &arguments);
    assert_eq!(output.status.code(), Some(3));
    assert!(text(&output.stdout).contains("no certificate is written"));
    assert!(!at.join("no.json").exists());
    let arguments = with(&[
        "check",
        "wave.json",
        "other.json",
        "--certificate",
        "no.json",
    ]);
    assert!(fails(at, 2, &arguments).contains("--certificate for 2 motions"));
}

#[test]
fn moves_have_certificates_too() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(
        at.join("lift.csv"),
        "time_s,shoulder_roll,shoulder_roll/velocity\n0,0.2,0\n2,0.8,0\n",
    )
    .unwrap();
    let reading = ["--robot", "wave_arm", "--at", "elbow=20deg"];
    let all = |arguments: &[&'static str]| -> Vec<&'static str> {
        arguments.iter().copied().chain(reading).collect()
    };
    done(
        at,
        &all(&["check", "lift.csv", "--certificate", "lift.cert.json"]),
    );
    done(at, &all(&["verify", "lift.cert.json", "lift.csv"]));
    // The hash is the file's; where other joints stand is part of the motion that the proof is looked at with.
    let value = json(at, &all(&["verify", "lift.cert.json", "lift.csv"]));
    assert_eq!(value["rests_on"][0]["name"], "wave_arm");
    // Of the same file, and not the same move.
    let other = [
        "verify",
        "lift.cert.json",
        "lift.csv",
        "--robot",
        "wave_arm",
        "--at",
        "elbow=21deg",
    ];
    let error = fails(at, 3, &other);
    assert!(
        error.contains("makes another motion of the joints"),
        "{error}"
    );
}

#[test]
fn no_more_is_believed_than_planes_prove() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    // Two capsules that stand askew beside each other: parry's search ends micrometres before the distance.
    let urdf = r#"<robot name="pair"><link name="base"><collision><origin rpy="0.3 0.2 0.1"/>
        <geometry><capsule radius="0.05" length="0.4"/></geometry></collision></link>
        <link name="arm"><collision><origin xyz="0.3 0.07 0.11" rpy="1.1 -0.4 0.7"/>
        <geometry><capsule radius="0.06" length="0.3"/></geometry></collision></link>
        <joint name="hinge" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
        <limit lower="-1" upper="1" velocity="1" effort="1"/></joint></robot>"#;
    std::fs::write(at.join("pair.urdf"), urdf).unwrap();
    std::fs::write(at.join("still.csv"), "time_s,hinge\n0,0.2\n1,0.2\n").unwrap();
    let target = ["--robot", "pair.urdf", "--keep", "base:arm"];
    let with = |arguments: &[&str]| -> Vec<String> {
        arguments
            .iter()
            .chain(&target)
            .map(|a| (*a).to_owned())
            .collect()
    };
    let check = |margin: &str| {
        let all = with(&[
            "check",
            "still.csv",
            "--accuracy",
            "1e-9",
            "--margin",
            margin,
            "--certificate",
            "c.json",
        ]);
        done(at, &all.iter().map(String::as_str).collect::<Vec<_>>())
    };
    check("0");
    let report = with(&["check", "still.csv", "--accuracy", "1e-9"]);
    let report = json(at, &report.iter().map(String::as_str).collect::<Vec<_>>());
    let clearance = report["collision"]["clearance_m"][1].as_f64();
    let clearance = clearance.unwrap_or_else(|| panic!("{}", report["collision"]));
    let mut file: Value = serde_json::from_str(&read(at, "c.json")).unwrap();
    for (more, code) in [(-1e-6, 0), (1e-7, 3), (8e-6, 3)] {
        file["margin_m"] = object!(clearance + more);
        file["clearance_above_m"] = object!(clearance + more);
        std::fs::write(at.join("claim.json"), file.to_string()).unwrap();
        let all = with(&["verify", "claim.json", "still.csv"]);
        let all: Vec<&str> = all.iter().map(String::as_str).collect();
        let output = run(at, &all);
        assert_eq!(
            output.status.code(),
            Some(code),
            "{more}: {}",
            text(&output.stdout)
        );
    }
}

//! The program as a person or a script sees it: the main job, the verbs on files, and what bad input gets.

mod common;

use std::path::Path;
use std::process::{Command, Output};

use common::shared;
use serde_json::Value;

fn run(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_undulate"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// The standard output of a run that must succeed.
fn done(folder: &Path, arguments: &[&str]) -> String {
    let output = run(folder, arguments);
    assert_eq!(
        output.status.code(),
        Some(0),
        "{arguments:?}: {}",
        text(&output.stderr)
    );
    text(&output.stdout)
}

fn json(folder: &Path, arguments: &[&str]) -> Value {
    let arguments: Vec<&str> = arguments.iter().copied().chain(["--json"]).collect();
    serde_json::from_str(&done(folder, &arguments)).unwrap()
}

/// The error line of a run that must fail with `code`.
fn fails(folder: &Path, code: i32, arguments: &[&str]) -> String {
    let output = run(folder, arguments);
    let error = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {error}");
    error
}

fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn the_main_job_draws_its_figures_and_its_claims_hold() {
    let folder = tempfile::tempdir().unwrap();
    let report = json(folder.path(), &["reproduce", "--out", "out"]);
    for claim in report["claims"].as_array().unwrap() {
        assert_eq!(claim["holds"], true, "{claim}");
    }
    let out = folder.path().join("out");
    assert_eq!(
        files(&out),
        [
            "figure1.png",
            "figure1.svg",
            "figure2.png",
            "figure2.svg",
            "figure3.png",
            "report.json"
        ]
    );
    let written: Value =
        serde_json::from_str(&std::fs::read_to_string(out.join("report.json")).unwrap()).unwrap();
    assert_eq!(written, report);
    for figure in ["figure1.png", "figure2.png", "figure3.png"] {
        let bytes = std::fs::read(out.join(figure)).unwrap();
        assert_eq!(&bytes[..8], b"\x89PNG\r\n\x1a\n");
    }
    let svg = std::fs::read_to_string(out.join("figure1.svg")).unwrap();
    for word in ["<svg", "elbow flexion", "wrist deviation", "unconditioned"] {
        assert!(svg.contains(word), "{word}");
    }
    // Never twice the same, but for the same seed.
    let words = done(folder.path(), &["reproduce", "--out", "again"]);
    assert!(
        words.contains("holds") && words.contains("again"),
        "{words}"
    );
    let read = |path: &str| std::fs::read(folder.path().join(path)).unwrap();
    assert_eq!(read("out/report.json"), read("again/report.json"));
    done(
        folder.path(),
        &["reproduce", "--seed", "1", "--out", "other"],
    );
    assert_ne!(read("out/report.json"), read("other/report.json"));
}

#[test]
fn from_the_demonstrator_to_the_robot() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let learned = json(at, &["learn", "-o", "model.json"]);
    assert_eq!(learned["demonstrations"].as_array().unwrap().len(), 15);
    assert_eq!(learned["rank"], 14);
    done(
        at,
        &[
            "condition",
            "model.json",
            "--given",
            "modulus:elbow_flexion:10=5deg",
            "-o",
            "large.json",
        ],
    );
    done(
        at,
        &["sample", "large.json", "--seed", "3", "-o", "wave.json"],
    );
    done(
        at,
        &[
            "sample",
            "large.json",
            "--seed",
            "3",
            "-n",
            "3",
            "--csv",
            "50",
            "-o",
            "waves",
        ],
    );
    assert_eq!(files(&at.join("waves")).len(), 6);
    // Sample 0 is the same alone and among others.
    let read = |path: &str| std::fs::read(at.join(path)).unwrap();
    assert_eq!(read("wave.json"), read("waves/wave_0000.json"));
    assert_ne!(read("wave.json"), read("waves/wave_0001.json"));
    let checked = json(at, &["check", "wave.json", "--robot", "wave_arm"]);
    assert_eq!(checked["passes"], true);
    assert!(checked["collision"]["clearance_m"].as_f64().unwrap() > 0.01);
    let simulated = json(
        at,
        &[
            "simulate",
            "wave.json",
            "--robot",
            "wave_arm",
            "-o",
            "rollout.csv",
        ],
    );
    for joint in simulated["joints"].as_array().unwrap() {
        assert!(joint["rms_error_rad"].as_f64().unwrap() < 1e-3, "{joint}");
    }
    let rollout = text(&read("rollout.csv"));
    assert!(rollout.starts_with("time_s,shoulder_pitch.reference_rad,shoulder_pitch.position_rad"));
    // With a robot, what it cannot do is drawn again.
    let gated = json(
        at,
        &[
            "sample",
            "model.json",
            "--seed",
            "5",
            "-n",
            "8",
            "--robot",
            "wave_arm",
            "-o",
            "gated",
        ],
    );
    assert!(gated["draws"].as_u64().unwrap() >= 8);
    for wave in gated["waves"].as_array().unwrap() {
        done(
            at,
            &["check", wave.as_str().unwrap(), "--robot", "wave_arm"],
        );
    }
    // A drawn wave is a recording again.
    done(
        at,
        &[
            "learn",
            "waves",
            "--duration",
            "6.6666667",
            "-o",
            "again.json",
        ],
    );
    done(
        at,
        &["map", "--init", "model.json", "wave_arm", "-o", "map.toml"],
    );
    let shown = json(
        at,
        &[
            "map",
            "--show",
            "model.json",
            "wave_arm",
            "--map",
            "map.toml",
            "-o",
            "map.png",
        ],
    );
    assert_eq!(shown["joints"].as_array().unwrap().len(), 6);
    assert_eq!(&read("map.png")[..4], b"\x89PNG");
}

#[test]
fn real_waves_reach_the_robot() {
    let Some(shared) = shared("real human waves") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let waves = shared.canonicalize().unwrap().join("waves");
    let list = waves.join("sets/A_right_normal_1p5_3hz.txt");
    let learned = json(
        at,
        &[
            "learn",
            "--list",
            list.to_str().unwrap(),
            "--root",
            waves.to_str().unwrap(),
            "-o",
            "model.json",
        ],
    );
    assert_eq!(learned["joints"].as_array().unwrap().len(), 7);
    assert!(learned["demonstrations"].as_array().unwrap().len() >= 15);
    let mut passed = 0;
    for seed in 0..10 {
        let seed = seed.to_string();
        done(
            at,
            &["sample", "model.json", "--seed", &seed, "-o", "wave.json"],
        );
        let output = run(at, &["check", "wave.json", "--robot", "wave_arm", "--json"]);
        let checked: Value = serde_json::from_str(&text(&output.stdout)).unwrap();
        assert_eq!(
            output.status.code(),
            Some(if checked["passes"] == true { 0 } else { 3 })
        );
        if checked["passes"] == true {
            passed += 1;
            let simulated = json(at, &["simulate", "wave.json", "--robot", "wave_arm"]);
            for joint in simulated["joints"].as_array().unwrap() {
                assert!(joint["rms_error_rad"].as_f64().unwrap() < 2e-3, "{joint}");
            }
        }
    }
    assert!(passed >= 5, "{passed} of 10 waves pass");
}

#[test]
fn bad_recordings_are_named_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let rows = |joint: &str, rows: usize| {
        let mut text = format!("time_s,{joint}\n");
        for n in 0..rows {
            let t = 0.02 * n as f64;
            text.push_str(&format!("{t},{}\n", (12.0 * t).sin()));
        }
        text
    };
    std::fs::create_dir(at.join("empty")).unwrap();
    for (name, content) in [
        ("good.csv", rows("a", 200)),
        ("short.csv", rows("a", 20)),
        ("other.csv", rows("b", 200)),
        ("nothing.csv", String::new()),
        ("unsorted.csv", "time_s,a\n0,1\n2,1\n1,1\n".into()),
        ("text.csv", "time_s,a\n0,1\n1,one\n".into()),
        ("nan.csv", "time_s,a\n0,1\n1,nan\n".into()),
        (
            "still.csv",
            format!(
                "time_s,a\n{}",
                (0..200)
                    .map(|n| format!("{},0.5\n", 0.02 * n as f64))
                    .collect::<String>()
            ),
        ),
        ("list.txt", "# set\n\ngood.csv\nmissing.csv\n".into()),
    ] {
        std::fs::write(at.join(name), content).unwrap();
    }
    let before = files(at);
    for (arguments, words) in [
        (
            vec!["learn", "missing.csv"],
            vec!["missing.csv", "check that the path exists"],
        ),
        (vec!["learn", "empty"], vec!["empty: no CSV files"]),
        (
            vec!["learn", "nothing.csv"],
            vec!["nothing.csv: the file is empty"],
        ),
        (
            vec!["learn", "unsorted.csv"],
            vec!["unsorted.csv, line 4: time 1 s does not come after 2 s"],
        ),
        (
            vec!["learn", "text.csv"],
            vec!["text.csv, line 3, column `a`: found `one`"],
        ),
        (
            vec!["learn", "nan.csv"],
            vec!["nan.csv, line 3, column `a`"],
        ),
        (
            vec!["learn", "good.csv", "other.csv"],
            vec!["other.csv: joints b, expected a as in good.csv"],
        ),
        (
            vec!["learn", "good.csv", "--joints", "c"],
            vec!["good.csv, line 1: no column `c` among time_s, a"],
        ),
        (
            vec!["learn", "good.csv"],
            vec!["only 1 of 1 recordings can be used", "at least two"],
        ),
        (
            vec!["learn", "good.csv", "short.csv"],
            vec![
                "only 1 of 2 recordings can be used",
                "short.csv lasts 0.380 s",
            ],
        ),
        (
            vec!["learn", "good.csv", "good.csv", "--harmonics", "120"],
            vec!["good.csv: 200 samples for 120 harmonics", "at most 9"],
        ),
        (
            vec!["learn", "still.csv", "still.csv", "--duration", "3"],
            vec!["still.csv, joint `a`: the joint never moves"],
        ),
        (
            vec!["learn", "--list", "list.txt"],
            vec!["list.txt, line 4: no file", "missing.csv"],
        ),
    ] {
        let error = fails(at, 1, &arguments);
        for word in words {
            assert!(
                error.contains(word),
                "{arguments:?} lacks `{word}`: {error}"
            );
        }
    }
    let error = fails(
        at,
        2,
        &["learn", "good.csv", "good.csv", "--duration", "-1"],
    );
    assert!(error.contains("duration of -1 s"), "{error}");
    assert_eq!(files(at), before, "an output of a failed run");
}

#[test]
fn bad_models_waves_and_robots_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    done(at, &["learn", "-o", "model.json"]);
    done(
        at,
        &["sample", "model.json", "--seed", "3", "-o", "wave.json"],
    );
    let model = std::fs::read_to_string(at.join("model.json")).unwrap();
    std::fs::write(at.join("cut.json"), &model[..1000]).unwrap();
    std::fs::write(
        at.join("later.json"),
        model.replace("\"version\":1", "\"version\":7"),
    )
    .unwrap();
    std::fs::write(at.join("map.toml"), "[joints.elbow]\nfrom = \"knee\"\n").unwrap();
    std::fs::write(
        at.join("one.urdf"),
        r#"<robot name="one"><link name="a"/><link name="b"/><joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint></robot>"#,
    )
    .unwrap();
    for (arguments, words) in [
        (
            vec!["sample", "cut.json", "-o", "x.json"],
            vec!["cut.json", "cut short"],
        ),
        (
            vec!["sample", "later.json", "-o", "x.json"],
            vec!["later.json: version 7, expected 1"],
        ),
        (
            vec!["sample", "wave.json", "-o", "x.json"],
            vec!["format `undulate wave`, expected `undulate model`"],
        ),
        (
            vec!["check", "model.json", "--robot", "wave_arm"],
            vec!["format `undulate model`", "undulate sample"],
        ),
        (
            vec![
                "condition",
                "model.json",
                "--given",
                "modulus:knee:3=1deg",
                "-o",
                "x.json",
            ],
            vec!["no joint `knee`"],
        ),
        (
            vec![
                "condition",
                "model.json",
                "--given",
                "modulus:elbow_flexion:99=1deg",
                "-o",
                "x.json",
            ],
            vec!["no harmonic 99"],
        ),
        (
            vec![
                "condition",
                "model.json",
                "--given",
                "modulus:elbow_flexion:3=-1deg",
                "-o",
                "x.json",
            ],
            vec!["positive modulus"],
        ),
        (
            vec!["check", "wave.json", "--robot", "nobody"],
            vec!["no robot `nobody`", "wave_arm"],
        ),
        (
            vec![
                "check",
                "wave.json",
                "--robot",
                "wave_arm",
                "--map",
                "map.toml",
            ],
            vec!["robot joint `elbow`", "no joint `knee`"],
        ),
        (
            vec!["check", "wave.json", "--robot", "one.urdf"],
            vec!["joint `j`: nothing moves it"],
        ),
    ] {
        let error = fails(at, 1, &arguments);
        for word in words {
            assert!(
                error.contains(word),
                "{arguments:?} lacks `{word}`: {error}"
            );
        }
    }
    assert!(!at.join("x.json").exists());
    // Wrong usage is another code.
    for (arguments, word) in [
        ("learn --no-such-option", "unexpected argument"),
        ("learn --joints a", "no recordings"),
        ("learn --harmonics 0", "0 harmonics, expected from 1"),
        ("learn --harmonics 18446744073709551615", "expected from 1"),
        (
            "condition model.json --given size:elbow=3deg -o x.json",
            "quantity `size`",
        ),
        (
            "sample model.json -n 2 -o x.json",
            "2 waves, expected 1 for a file",
        ),
        ("sample model.json -n 0 -o x", "0 waves"),
        ("sample model.json --csv 0 -o x.json", "--csv 0"),
        ("check wave.json --robot wave_arm --step 0", "step of 0 m"),
        (
            "check wave.json --robot wave_arm --leave-out base",
            "expected LINK:LINK",
        ),
        (
            "simulate wave.json --robot wave_arm --time-step 1",
            "time step of 1 s",
        ),
        (
            "simulate wave.json --robot wave_arm --bandwidth 100",
            "bandwidth of 100 Hz",
        ),
        (
            "simulate wave.json --robot wave_arm --duration 1e9",
            "duration of 1000000000 s",
        ),
        (
            "condition model.json --given offset:elbow_flexion=3 -o x.json",
            "with its unit",
        ),
        (
            "map --init model.json wave_arm -o map.toml",
            "the file exists",
        ),
        ("map model.json wave_arm", "--init"),
        ("", "Usage"),
    ] {
        let arguments: Vec<&str> = arguments.split_whitespace().collect();
        let error = fails(at, 2, &arguments);
        assert!(
            error.contains(word),
            "{arguments:?} lacks `{word}`: {error}"
        );
    }
    assert!(!at.join("x.json").exists());
}

#[cfg(unix)]
#[test]
fn links_are_followed_and_what_is_no_file_stays_what_it_is() {
    use std::os::unix::fs::{FileTypeExt, symlink};
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("target.json"), "old").unwrap();
    symlink("target.json", at.join("link.json")).unwrap();
    done(at, &["learn", "-o", "link.json"]);
    assert!(
        std::fs::symlink_metadata(at.join("link.json"))
            .unwrap()
            .is_symlink()
    );
    let written = std::fs::read_to_string(at.join("target.json")).unwrap();
    assert!(written.starts_with("{\"format\":\"undulate model\""));
    // A device is written to, not replaced; through a link of ours, lest a failure cost the machine its own.
    symlink("/dev/null", at.join("null.json")).unwrap();
    done(at, &["learn", "-o", "null.json"]);
    let device = std::fs::metadata(at.join("null.json")).unwrap();
    assert!(device.file_type().is_char_device());
    assert_eq!(files(at), ["link.json", "null.json", "target.json"]);
}

#[test]
fn every_verb_has_help_with_an_example() {
    let folder = tempfile::tempdir().unwrap();
    for verb in [
        "reproduce",
        "learn",
        "condition",
        "sample",
        "check",
        "simulate",
        "map",
    ] {
        let help = done(folder.path(), &[verb, "--help"]);
        assert!(
            help.contains("Example") && help.contains(&format!("undulate {verb}")),
            "{help}"
        );
    }
}

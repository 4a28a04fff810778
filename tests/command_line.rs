//! The program as a person or a script sees it: the main job, and the verbs on files.

mod common;
#[path = "common/program.rs"]
mod program;

use common::shared;
use program::{done, fails, files, json, run, text};
use serde_json::Value;

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
    assert_eq!(learned["rank"], 255);
    let paper = json(at, &["learn", "--paper", "-o", "paper.json"]);
    assert_eq!(paper["rank"], 14);
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
    assert!(checked["collision"]["clearance_m"][0].as_f64().unwrap() > 0.01);
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
            // Real waves are faster than the demonstrator's; twice the bound of the main job.
            for joint in simulated["joints"].as_array().unwrap() {
                assert!(joint["rms_error_rad"].as_f64().unwrap() < 2e-3, "{joint}");
            }
        }
    }
    assert!(passed >= 5, "{passed} of 10 waves pass");
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
        "inspect-demos",
        "condition",
        "sample",
        "trajectory",
        "check",
        "verify",
        "screen",
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

/// A joint that is written a turn off for a while is learned as if it were not.
#[test]
fn jumps_of_whole_turns_are_taken_out_before_anything_is_learned() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let frequencies = [0.0, std::f64::consts::TAU].map(|jump| {
        for m in 0..3 {
            let row = |n: u32| {
                let t = f64::from(n) / 50.0;
                let wave = (0.3 + 0.02 * f64::from(m)) * ((9.0 + f64::from(m)) * t).sin();
                let turn = if (100..150).contains(&n) { jump } else { 0.0 };
                format!("{t},{}\n", wave + turn)
            };
            let rows: String = (0..250).map(row).collect();
            let name = at.join(format!("takes/{m}.csv"));
            std::fs::create_dir_all(at.join("takes")).unwrap();
            std::fs::write(name, format!("time_s,elbow\n{rows}")).unwrap();
        }
        let report = json(at, &["learn", "takes", "--period", "cycle", "-k", "1"]);
        let fits = report["demonstrations"].as_array().unwrap().clone();
        let told = fits.iter().map(|fit| fit["frequency_hz"].as_f64().unwrap());
        told.collect::<Vec<f64>>()
    });
    let [whole, jumping] = &frequencies;
    assert_eq!((whole.len(), jumping.len()), (3, 3));
    for (a, b) in whole.iter().zip(jumping) {
        assert!((a - b).abs() < 1e-9, "{frequencies:?}");
    }
}

#[test]
fn a_recording_that_cannot_be_read_does_not_hide_the_others() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let rows = |column: &str, value: fn(f64) -> String| {
        let row = |n: u32| {
            let t = f64::from(n) / 50.0;
            format!("{t},{}\n", value(t))
        };
        format!("time_s,{column}\n{}", (0..250).map(row).collect::<String>())
    };
    let wave = |t: f64| (0.3 * (9.0 * t).sin()).to_string();
    std::fs::create_dir(at.join("takes")).unwrap();
    let write = |name: &str, text: String| std::fs::write(at.join("takes").join(name), text);
    write("a.csv", rows("elbow", wave)).unwrap();
    write("b.csv", rows("wrist", wave)).unwrap();
    write("c.csv", rows("elbow", |_| "nan".into())).unwrap();
    write("d.csv", rows("elbow", wave)).unwrap();
    let report = json(at, &["inspect-demos", "takes"]);
    assert_eq!(report["recordings"].as_array().unwrap().len(), 2);
    let unreadable = report["unreadable"].as_array().unwrap();
    let told: Vec<&str> = unreadable.iter().map(|e| e.as_str().unwrap()).collect();
    assert!(
        told[0].contains("b.csv") && told[0].contains("elbow"),
        "{told:?}"
    );
    assert!(
        told[1].contains("c.csv") && told[1].contains("line 2"),
        "{told:?}"
    );
    let text = done(at, &["inspect-demos", "takes"]);
    assert!(
        text.contains("4 recordings, 2 with something to look at"),
        "{text}"
    );
    std::fs::remove_file(at.join("takes/a.csv")).unwrap();
    std::fs::remove_file(at.join("takes/b.csv")).unwrap();
    std::fs::remove_file(at.join("takes/d.csv")).unwrap();
    fails(at, 1, &["inspect-demos", "takes"]);
}

//! A move from rest to rest, as a controller runs it.

#[path = "common/program.rs"]
mod program;

use program::{done, fails, files, json};

#[test]
fn what_is_performed_starts_and_ends_at_rest_and_passes_the_check() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    done(at, &["learn", "-o", "model.json"]);
    for (seed, name) in [("1", "a.json"), ("2", "b.json")] {
        done(
            at,
            &[
                "sample",
                "model.json",
                "--seed",
                seed,
                "--robot",
                "wave_arm",
                "-o",
                name,
            ],
        );
    }
    let report = json(
        at,
        &[
            "perform",
            "a.json",
            "b.json",
            "--robot",
            "wave_arm",
            "--duration",
            "3",
            "--at",
            "elbow=20deg",
            "-o",
            "greeting.json",
        ],
    );
    let ends: Vec<f64> = serde_json::from_value(report["legs_end_s"].clone()).unwrap();
    assert_eq!(ends.len(), 5);
    assert!(ends[0] >= 1.0 && ends[1] - ends[0] >= 3.0 && ends[4] - ends[3] >= 1.0);
    let text = std::fs::read_to_string(at.join("greeting.json")).unwrap();
    let file: serde_json::Value = serde_json::from_str(&text).unwrap();
    let points = file["points"].as_array().unwrap();
    let elbow = file["joint_names"]
        .as_array()
        .unwrap()
        .iter()
        .position(|j| j == "elbow")
        .unwrap();
    for point in [&points[0], &points[points.len() - 1]] {
        let near = |what: &str, joint: usize, expected: f64, within: f64| {
            let found = point[what][joint].as_f64().unwrap();
            assert!((found - expected).abs() < within, "{what} {found}");
        };
        near("positions", elbow, 20f64.to_radians(), 1e-9);
        for joint in 0..6 {
            near("velocities", joint, 0.0, 1e-9);
            near("accelerations", joint, 0.0, 1e-6);
        }
    }
    let check = json(at, &["check", "greeting.json", "--robot", "wave_arm"]);
    assert_eq!(check["passes"], true);
    assert_eq!(check["warnings"].as_array().unwrap().len(), 0, "{check}");
}

#[test]
fn what_cannot_be_performed_is_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    done(at, &["learn", "-o", "model.json"]);
    done(
        at,
        &[
            "sample",
            "model.json",
            "--seed",
            "1",
            "--robot",
            "wave_arm",
            "-o",
            "a.json",
        ],
    );
    let before = files(at);
    let refused = |code: i32, more: &[&str], expected: &str| {
        let mut arguments = vec!["perform", "a.json", "--robot", "wave_arm"];
        arguments.extend(more);
        let error = fails(at, code, &arguments);
        assert!(error.contains(expected), "{error}");
        assert_eq!(files(at), before);
    };
    refused(
        3,
        &["--at", "elbow=300deg", "-o", "m.json"],
        "position-limit",
    );
    refused(2, &["--duration", "0", "-o", "m.json"], "duration of 0 s");
    refused(
        2,
        &["--ease", "-1", "-o", "m.json"],
        "ways of at least -1 s",
    );
    refused(2, &["-o", "m.yaml"], "no velocities");
    refused(
        3,
        &["--max-velocity", "0.05", "-o", "m.json"],
        "velocity-limit",
    );
    refused(3, &["--margin", "5", "-o", "m.json"], "clearance");
    // Eight waypoints in ten seconds are no wave.
    refused(
        3,
        &["--rate", "0.1", "-o", "m.json"],
        "leaves the wave by up to",
    );
}

//! Mixtures and learning curves on the command line.

#[path = "common/program.rs"]
mod program;

use std::path::Path;

use program::{done, fails, json, run, text};
use undulate::{DEMONSTRATOR_JOINTS, Mixture, Recording, synthetic};

fn write(path: &Path, recording: &Recording) {
    let mut text = format!("time_s,{}\n", DEMONSTRATOR_JOINTS.join(","));
    for (t, row) in recording
        .times()
        .iter()
        .zip(recording.positions().row_iter())
    {
        let row: Vec<String> = row.iter().map(ToString::to_string).collect();
        text.push_str(&format!("{t},{}\n", row.join(",")));
    }
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, text).unwrap();
}

/// The slowest and the fastest five of the demonstrator in a folder each.
fn record(at: &Path) {
    for (m, recording) in synthetic(0).unwrap().recordings().iter().enumerate() {
        match m {
            0..5 => write(&at.join(format!("slow/{m}.csv")), recording),
            10.. => write(&at.join(format!("fast/{m}.csv")), recording),
            _ => {}
        }
    }
}

#[test]
fn kinds_are_learned_named_conditioned_and_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    record(at);
    let learn = |kinds| {
        let common = ["learn", "slow", "fast", "--period", "cycle", "--kinds"];
        [&common[..], &[kinds, "-o", "mixture.json"]].concat()
    };
    let words = done(at, &learn("folders"));
    assert!(
        words.contains("2 kinds of wave: slow 50 %, fast 50 %"),
        "{words}"
    );
    let words = done(at, &learn("2"));
    assert!(words.contains("2 kinds of wave: a 50 %, b 50 %"), "{words}");
    assert!(
        words.contains("median frequency") && words.contains(" Hz") && words.contains(" deg of "),
        "{words}"
    );
    let rename = [
        "--rename",
        "a=one",
        "--rename",
        "b=other",
        "-o",
        "named.json",
    ];
    done(at, &[&["condition", "mixture.json"][..], &rename].concat());
    let given = [
        "condition",
        "named.json",
        "--given",
        "frequency=1.5Hz",
        "-o",
        "slow.json",
    ];
    let value = json(at, &given);
    let kinds = value["kinds"].as_array().unwrap();
    let likeliest = kinds
        .iter()
        .map(|k| k["weight"].as_f64().unwrap())
        .fold(0.0, f64::max);
    assert!(likeliest > 0.99, "{value}");
    let far = [
        "condition",
        "named.json",
        "--given",
        "frequency=7Hz",
        "-o",
        "far.json",
    ];
    let notes = text(&run(at, &far).stderr);
    assert!(
        notes.contains("standard deviations from every kind"),
        "{notes}"
    );
    let text = std::fs::read_to_string(at.join("slow.json")).unwrap();
    assert_eq!(Mixture::from_json(&text).unwrap().components().len(), 2);
    done(
        at,
        &[
            "sample",
            "named.json",
            "-n",
            "4",
            "--given",
            "frequency=2Hz",
            "-o",
            "waves",
        ],
    );
    done(
        at,
        &[
            "condition",
            "named.json",
            "--component",
            "one",
            "-o",
            "one.json",
        ],
    );
    done(
        at,
        &["sample", "one.json", "--tempo", "1.1x", "-o", "wave.json"],
    );
    done(
        at,
        &["screen", "named.json", "--robot", "wave_arm", "-n", "3"],
    );
}

#[test]
fn what_a_mixture_cannot_do_is_said_with_the_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    record(at);
    done(
        at,
        &[
            "learn",
            "slow",
            "fast",
            "--kinds",
            "folders",
            "-o",
            "mixture.json",
        ],
    );
    for verb in [
        &["trajectory", "mixture.json", "-o", "t.csv"][..],
        &[
            "sample",
            "mixture.json",
            "--towards",
            "elbow_flexion@1s=90deg+-2deg",
            "-o",
            "w.json",
        ],
        &["sample", "mixture.json", "--tempo", "1.2x", "-o", "w.json"],
    ] {
        let words = fails(at, 1, verb);
        assert!(words.contains("--component NAME"), "{words}");
    }
    let words = fails(
        at,
        1,
        &[
            "condition",
            "mixture.json",
            "--component",
            "wild",
            "-o",
            "w.json",
        ],
    );
    assert!(words.contains("slow, fast"), "{words}");
    fails(at, 2, &["condition", "mixture.json", "-o", "w.json"]);
    fails(
        at,
        2,
        &[
            "condition",
            "mixture.json",
            "--rename",
            "slow",
            "-o",
            "w.json",
        ],
    );
    fails(
        at,
        2,
        &["learn", "slow", "fast", "--kinds", "some", "-o", "w.json"],
    );
    fails(
        at,
        1,
        &["learn", "slow", "fast", "--kinds", "4", "-o", "w.json"],
    );
    // Folders of one name are not one kind, and two recordings are none.
    std::fs::create_dir_all(at.join("other/slow")).unwrap();
    std::fs::create_dir(at.join("few")).unwrap();
    for m in 0..2 {
        let from = at.join(format!("slow/{m}.csv"));
        std::fs::copy(&from, at.join(format!("other/slow/{m}.csv"))).unwrap();
        std::fs::copy(&from, at.join(format!("few/{m}.csv"))).unwrap();
    }
    for (folders, told) in [
        (["slow", "other/slow"], "two folders named `slow`"),
        (["slow", "few"], "2 recordings of a kind"),
    ] {
        let common = ["--kinds", "folders", "-o", "w.json"];
        let words = fails(at, 2, &[&["learn"], &folders[..], &common].concat());
        assert!(words.contains(told), "{words}");
    }
}

#[test]
fn a_learning_curve_is_told_and_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let curve = [
        "learning-curve",
        "--period",
        "cycle",
        "--draws",
        "1",
        "-o",
        "curve.svg",
    ];
    let words = done(at, &curve);
    assert!(
        words.contains("twice as many gave") && words.contains("record next"),
        "{words}"
    );
    let value = json(at, &curve);
    let last = value["curve"].as_array().unwrap().last().unwrap().clone();
    assert_eq!(last["demonstrations"], 14);
    assert_eq!(value["worth"].as_array().unwrap().len(), 15);
    assert!(
        std::fs::read_to_string(at.join("curve.svg"))
            .unwrap()
            .contains("demonstrations")
    );
}

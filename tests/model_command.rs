//! The verbs of the model: estimators, cycles, knobs, bounds, targets, and what they refuse.

#[path = "common/program.rs"]
mod program;

use std::path::Path;

use program::{done, fails, json, run, text};
use undulate::{Derivative, FourierMovementPrimitive, Wave};

fn wave(path: &Path) -> Wave {
    Wave::from_json(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn model(path: &Path) -> FourierMovementPrimitive {
    FourierMovementPrimitive::from_json(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// Two joints that hang for a second, are raised, wave for five, are lowered.
fn uncut(number: u64) -> String {
    let raised = |t: f64| {
        let x = (t - 1.0).min(9.0 - t).clamp(0.0, 1.0);
        x * x * (3.0 - 2.0 * x)
    };
    let frequency = 1.5 + 0.02 * number as f64;
    let swing = |t: f64| {
        if (2.5..7.5).contains(&t) {
            1.0 - (std::f64::consts::TAU * frequency * (t - 2.5)).cos()
        } else {
            0.0
        }
    };
    let rows = (0..600).map(|n| {
        let t = n as f64 / 60.0;
        let (lift, elbow) = (1.9 * raised(t) + 0.1 * swing(t), 0.3 * swing(t) - raised(t));
        format!("{t:.4},{lift:.6},{elbow:.6}\n")
    });
    format!("time_s,lift,elbow\n{}", rows.collect::<String>())
}

#[test]
fn what_is_cut_from_a_recording_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for number in 0..6 {
        std::fs::write(at.join(format!("take{number}.csv")), uncut(number)).unwrap();
    }
    let learn = |more: &[&str]| {
        let arguments = [&["learn", ".", "-o", "model.json"], more].concat();
        let output = run(at, &arguments);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        (text(&output.stdout), text(&output.stderr))
    };
    let (_, notes) = learn(&[]);
    for number in 0..6 {
        let name = format!("take{number}.csv: ");
        let line = notes.lines().find(|line| line.contains(&name)).unwrap();
        let (_, told) = line.split_once(&name).unwrap();
        let (used, rest) = told.split_once(' ').unwrap();
        assert!((4.0..5.5).contains(&used.parse().unwrap()), "{line}");
        assert!(
            rest.starts_with("of 9.98 s are a rhythm, and used"),
            "{line}"
        );
        assert!(line.ends_with("one part; --uncut takes all"), "{line}");
    }
    let (_, notes) = learn(&["--uncut"]);
    assert!(!notes.contains("a rhythm"), "{notes}");
}

#[test]
fn cycles_are_learned_turned_and_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let words = done(at, &["learn", "--period", "cycle", "-o", "lively.json"]);
    assert!(
        words.contains("frequency") && words.contains("swing:elbow_flexion"),
        "{words}"
    );
    let output = run(
        at,
        &[
            "condition",
            "lively.json",
            "--tempo",
            "1.2x",
            "--size",
            "0.8x",
            "--livelier",
            "1.5x",
            "-o",
            "quick.json",
        ],
    );
    let (words, notes) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(0), "{notes}");
    for knob in [
        "--tempo 1.2x is frequency=",
        "--size 0.8x is swing:",
        "--livelier 1.5x is jitter:",
    ] {
        assert!(notes.contains(knob), "{notes}");
    }
    assert!(
        words.contains("frequency") && words.contains("Hz"),
        "{words}"
    );
    let medians = |name: &str| {
        let primitive = model(&at.join(name));
        ["frequency", "swing:elbow_flexion", "jitter:tempo"]
            .map(|c| primitive.median(&c.parse().unwrap()).unwrap())
    };
    let (before, after) = (medians("lively.json"), medians("quick.json"));
    for ((before, after), factor) in before.iter().zip(after).zip([1.2, 0.8, 1.5]) {
        assert!((after / before - factor).abs() < 1e-9, "{before} {after}");
    }
    // Started at the upper turning point of the joint that moves most.
    done(
        at,
        &["sample", "quick.json", "--start", "0deg", "-o", "wave.json"],
    );
    let wave = wave(&at.join("wave.json"));
    let largest = wave
        .weights()
        .iter()
        .copied()
        .fold(num_complex::Complex::ZERO, |best, w| {
            if w.norm() > best.norm() { w } else { best }
        });
    assert!(largest.arg().abs() < 1e-9);
    // A condition of the other kind of period is named, with what to say instead.
    let error = fails(
        at,
        1,
        &[
            "condition",
            "lively.json",
            "--given",
            "modulus:elbow_flexion:1=5deg",
            "-o",
            "x.json",
        ],
    );
    assert!(error.contains("`swing:elbow_flexion=VALUE`"), "{error}");
    done(at, &["learn", "-o", "model.json"]);
    let error = fails(
        at,
        1,
        &[
            "condition",
            "model.json",
            "--given",
            "frequency=2Hz",
            "-o",
            "x.json",
        ],
    );
    assert!(error.contains("--period cycle"), "{error}");
    let tempo = ["condition", "model.json", "--tempo", "1.2x", "-o", "x.json"];
    let error = fails(at, 1, &tempo);
    assert!(error.contains("--period cycle"), "{error}");
    let error = fails(at, 2, &["condition", "model.json", "-o", "x.json"]);
    assert!(error.contains("no condition"), "{error}");
    assert!(!at.join("x.json").exists());
}

#[test]
fn hertz_are_harmonics_and_wishes_have_deviations() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    done(at, &["learn", "-o", "model.json"]);
    // T = 20/3 s: 1.52 Hz is near harmonic 10, 1.57 Hz lies between 10 and 11.
    let given = "modulus:elbow_flexion:1.52Hz=5deg+-0.5deg";
    let told = json(
        at,
        &[
            "condition",
            "model.json",
            "--given",
            given,
            "-o",
            "near.json",
        ],
    );
    assert!((told["given"][0]["frequency_hz"].as_f64().unwrap() - 1.5).abs() < 1e-12);
    let near = model(&at.join("near.json"));
    let elbow = "modulus:elbow_flexion:10".parse().unwrap();
    let deviation = near.standard_deviation(&elbow).unwrap();
    assert!(deviation > 0.05 && deviation < 0.1, "{deviation}");
    let error = fails(
        at,
        1,
        &[
            "condition",
            "model.json",
            "--given",
            "modulus:elbow_flexion:1.57Hz=5deg",
            "-o",
            "x.json",
        ],
    );
    assert!(
        error.contains("1.500 Hz (k = 10)") && error.contains("1.650 Hz (k = 11)"),
        "{error}"
    );
}

#[test]
fn bounds_are_kept_and_hopeless_ones_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    done(at, &["learn", "-o", "model.json"]);
    let bound = "wrist_deviation=-30deg..30deg";
    let arguments = [
        "sample",
        "model.json",
        "-n",
        "20",
        "--within",
        bound,
        "-o",
        "waves",
    ];
    let told = json(at, &arguments);
    let (draws, within) = (
        told["draws"].as_u64().unwrap(),
        told["within_bounds"].as_u64().unwrap(),
    );
    assert!(within == 20 && draws > 20, "{told}");
    for file in program::files(&at.join("waves")) {
        let range = wave(&at.join("waves").join(file)).range(4, Derivative::Position);
        assert!(range.upper <= 30f64.to_radians() && range.lower >= -30f64.to_radians());
    }
    let hopeless = "wrist_deviation=10deg..10.1deg";
    let error = fails(
        at,
        1,
        &["sample", "model.json", "--within", hopeless, "-o", "x.json"],
    );
    assert!(error.contains("0 of 1000 draws"), "{error}");
    for wrong in ["wrist=0deg..1deg", "wrist_deviation=1deg..0deg"] {
        fails(
            at,
            1,
            &["sample", "model.json", "--within", wrong, "-o", "x.json"],
        );
    }
}

#[test]
fn draws_towards_a_target_reach_it_and_tell_how_the_chains_went() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    done(at, &["learn", "-k", "12", "-o", "model.json"]);
    let target = "elbow_flexion@1.2s=118deg+-2deg";
    let arguments = [
        "sample",
        "model.json",
        "-n",
        "20",
        "--towards",
        target,
        "-o",
        "waves",
    ];
    let told = json(at, &arguments);
    assert_eq!(told["chains"]["mixed"], true, "{told}");
    let mean = program::files(&at.join("waves"))
        .iter()
        .map(|file| wave(&at.join("waves").join(file)).position(1.2)[3].to_degrees())
        .sum::<f64>()
        / 20.0;
    assert!((mean - 118.0).abs() < 2.0, "{mean}");
    let error = fails(
        at,
        1,
        &[
            "sample",
            "model.json",
            "--towards",
            "elbow@1s=1deg+-1deg",
            "-o",
            "x.json",
        ],
    );
    assert!(error.contains("no joint `elbow`"), "{error}");
    let error = fails(
        at,
        2,
        &[
            "sample",
            "model.json",
            "--towards",
            target,
            "--start",
            "redrawn",
            "-o",
            "x.json",
        ],
    );
    assert!(error.contains("--start"), "{error}");
}

#[test]
fn estimators_are_compared_and_offsets_explained() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let arguments = [
        "compare-estimators",
        "-k",
        "10",
        "--between",
        "elbow_flexion,wrist_deviation",
    ];
    let told = json(at, &arguments);
    let estimators = told["estimators"].as_array().unwrap();
    assert_eq!(estimators.len(), 5);
    assert!(estimators[0]["density"].as_f64() > estimators[4]["density"].as_f64());
    let words = done(at, &["learn", "--offsets", "by-data", "-o", "model.json"]);
    assert!(
        words.contains("both signs: no logarithm") && words.contains("more probable"),
        "{words}"
    );
    let error = fails(at, 1, &["learn", "--offsets", "log", "-o", "x.json"]);
    assert!(
        error.contains("joint `wrist_deviation`") && error.contains("no common sign"),
        "{error}"
    );
}

#[test]
fn knobs_go_together_and_a_condition_has_the_last_word() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    // README's words: all knobs at once, and a condition that has the last word.
    done(at, &["learn", "--period", "cycle", "-o", "lively.json"]);
    let all = [
        "--tempo",
        "1.2x",
        "--size",
        "0.8x",
        "--more",
        "wrist_deviation",
        "--livelier",
        "1.5x",
    ];
    let condition = [
        "condition",
        "lively.json",
        "--given",
        "swing:elbow_flexion=12deg",
        "-o",
        "all.json",
    ];
    done(
        at,
        &condition.iter().chain(&all).copied().collect::<Vec<_>>(),
    );
    let median = |name: &str, coordinate: &str| {
        model(&at.join(name))
            .median(&coordinate.parse().unwrap())
            .unwrap()
    };
    let elbow = median("all.json", "swing:elbow_flexion").to_degrees();
    assert!((elbow - 12.0).abs() < 1e-9, "{elbow}");
    let wrist = "swing:wrist_deviation";
    let (before, after) = (median("lively.json", wrist), median("all.json", wrist));
    let more = model(&at.join("lively.json"))
        .standard_deviation(&wrist.parse().unwrap())
        .unwrap();
    assert!((after / before - 0.8 * more.exp()).abs() < 1e-9);
}

#[test]
fn what_cannot_be_is_refused_and_not_forgotten() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    done(at, &["learn", "-k", "12", "-o", "model.json"]);
    done(at, &["learn", "--period", "cycle", "-o", "lively.json"]);
    let refused = |model: &str, given: &str, words: &str| {
        let error = fails(
            at,
            1,
            &["condition", model, "--given", given, "-o", "x.json"],
        );
        assert!(error.contains(words), "{given}: {error}");
    };
    refused("lively.json", "frequency=1e-9Hz", "frequency");
    refused("lively.json", "frequency=1e9Hz", "frequency");
    // Rows of any size are rows.
    for size in ["1e160", "1e-12"] {
        let given = format!("sum:{size}*modulus:elbow_flexion:10=-3e-12");
        let told = json(
            at,
            &[
                "condition",
                "model.json",
                "--given",
                &given,
                "-o",
                "sum.json",
            ],
        );
        assert_eq!(
            told["rank"].as_u64().unwrap() + 1,
            told["rank_before"].as_u64().unwrap()
        );
    }
    done(
        at,
        &[
            "condition",
            "model.json",
            "--given",
            "modulus:elbow_flexion:10=5deg",
            "-o",
            "five.json",
        ],
    );
    refused(
        "five.json",
        "modulus:elbow_flexion:10=6deg+-1deg",
        "certain already, 5.0000 deg",
    );
    refused(
        "model.json",
        "modulus:elbow_flexion:0.07Hz=5deg",
        "near 0.150 Hz (k = 1)",
    );
    let nowhere = "elbow_flexion:1.51Hz..1.52Hz=10deg+-1deg";
    let error = fails(
        at,
        1,
        &["sample", "model.json", "--towards", nowhere, "-o", "x.json"],
    );
    assert!(
        error.contains("no harmonic from 1.51 to 1.52 Hz"),
        "{error}"
    );
    for option in ["--paper", "--align"] {
        let error = fails(
            at,
            2,
            &["learn", "--period", "cycle", option, "-o", "x.json"],
        );
        assert!(error.contains(option), "{error}");
    }
}

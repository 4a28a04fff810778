//! Many waves at once.

#[path = "common/program.rs"]
mod program;

use program::{done, fails, run, text};
use serde_json::Value;
use undulate::clopper_pearson;

fn lines(text: &str) -> Vec<Value> {
    text.lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

#[test]
fn draws_are_the_same_on_any_number_of_threads_and_as_check_sees_them() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    done(at, &["learn", "-o", "model.json"]);
    let screen = |jobs: &str, output: &str| {
        let report = run(
            at,
            &[
                "screen",
                "model.json",
                "--robot",
                "wave_arm",
                "-n",
                "40",
                "--seed",
                "3",
                "--margin",
                "0.02",
                "--jobs",
                jobs,
                "--json",
                "--output",
                output,
            ],
        );
        assert_eq!(report.status.code(), Some(0), "{}", text(&report.stderr));
        text(&report.stdout)
    };
    let one = screen("1", "one.jsonl");
    let two = screen("2", "two.jsonl");
    let read = |name: &str| std::fs::read_to_string(at.join(name)).unwrap();
    assert_eq!(read("one.jsonl"), read("two.jsonl"));
    assert_eq!(one.replace("one.jsonl", "two.jsonl"), two);
    let mut all = lines(&one);
    let summary = all.pop().unwrap();
    assert_eq!(all, lines(&read("one.jsonl")));
    assert_eq!(all.len(), 40);
    for (i, line) in all.iter().enumerate() {
        assert_eq!(line["index"], i);
    }
    // The summary counts what the lines say.
    let passing = all.iter().filter(|l| l["passes"] == true).count();
    let clear = all.iter().filter(|l| l["verdict"] == "clear").count();
    assert_eq!(summary["passes"]["waves"], passing);
    assert_eq!(summary["clear"]["waves"], clear);
    assert!(
        passing > 0 && passing <= clear && clear < 40,
        "{passing} {clear}"
    );
    let interval = &summary["clear"]["interval"];
    let (lower, upper) = clopper_pearson(clear as u64, 40, 0.95);
    assert_eq!(*interval, serde_json::json!([lower, upper]));
    let least = all
        .iter()
        .map(|l| l["clearance_m"][1].as_f64().unwrap())
        .fold(f64::INFINITY, f64::min);
    assert_eq!(summary["worst_pairs"][0]["clearance_m"], least);
    // Wave i is what `sample` draws, and its line what `check` says.
    done(
        at,
        &[
            "sample",
            "model.json",
            "--seed",
            "3",
            "-n",
            "6",
            "-o",
            "waves",
        ],
    );
    for (i, line) in all.iter().enumerate().take(6) {
        let name = format!("waves/wave_{i:04}.json");
        let output = run(
            at,
            &[
                "check", &name, "--robot", "wave_arm", "--margin", "0.02", "--json",
            ],
        );
        let checked: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(checked["passes"], line["passes"]);
        assert_eq!(checked["reasons"], line["reasons"]);
        assert_eq!(checked["collision"]["clearance_m"], line["clearance_m"]);
    }
    // A folder of files is another way in.
    let report = run(
        at,
        &[
            "screen", "waves", "--robot", "wave_arm", "--margin", "0.02", "--json",
        ],
    );
    let files = lines(&text(&report.stdout));
    assert_eq!(files.len(), 7);
    for (file, line) in files.iter().zip(&all).take(6) {
        assert_eq!(file["clearance_m"], line["clearance_m"]);
        assert!(file["motion"].as_str().unwrap().ends_with(".json"));
    }
}

#[test]
fn a_share_can_be_asked_for_and_what_cannot_be_used_is_no_success() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    done(at, &["learn", "-o", "model.json"]);
    let screen = |more: &[&'static str]| -> Vec<&'static str> {
        let fixed = ["screen", "model.json", "--robot", "wave_arm", "-n", "20"];
        fixed.into_iter().chain(more.iter().copied()).collect()
    };
    // All of 20 are never known to be more than (1 - 0.95) / 2 to the power 1/20.
    let output = run(at, &screen(&["--least", "0.9"]));
    assert_eq!(output.status.code(), Some(3));
    let words = text(&output.stdout);
    assert!(
        words.contains("passes: ") && words.contains("with 95 % confidence"),
        "{words}"
    );
    done(at, &screen(&["--least", "0.01"]));
    fails(at, 2, &screen(&["--least", "2"]));
    fails(at, 2, &screen(&["--jobs", "0"]));
    done(at, &screen(&["--figure", "nearest.svg"]));
    let svg = std::fs::read_to_string(at.join("nearest.svg")).unwrap();
    assert_eq!(svg.matches(">\nclearance (mm)\n</text>").count(), 6);

    done(at, &["sample", "model.json", "-n", "2", "-o", "waves"]);
    std::fs::write(at.join("waves/broken.json"), "{").unwrap();
    let output = run(at, &["screen", "waves", "--robot", "wave_arm", "--json"]);
    assert_eq!(output.status.code(), Some(1));
    let all = lines(&text(&output.stdout));
    assert_eq!(all[0]["reasons"], serde_json::json!(["unreadable"]));
    assert_eq!(all[3]["waves"], 3);
    assert!(text(&output.stderr).contains("broken.json"));
    fails(
        at,
        2,
        &["screen", "waves", "--robot", "wave_arm", "-n", "3"],
    );
    std::fs::create_dir(at.join("empty")).unwrap();
    fails(at, 1, &["screen", "empty", "--robot", "wave_arm"]);
}

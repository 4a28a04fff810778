//! Assessments, in one piece and in shards; and waves that are mended on the way.

#[path = "common/program.rs"]
mod program;

use program::{done, fails, files, json, run, text};
use undulate::clopper_pearson;

const ASSESS: [&str; 12] = [
    "assess",
    "model.json",
    "--robot",
    "wave_arm",
    "-n",
    "45",
    "--seed",
    "2",
    "--margin",
    "0.01",
    "--by",
    "shift,slow,shrink",
];

fn with<'a>(more: &[&'a str]) -> Vec<&'a str> {
    ASSESS.iter().chain(more).copied().collect()
}

#[test]
fn shards_merge_to_the_bytes_of_one_run() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    done(at, &["learn", "-o", "model.json"]);
    let read = |name: &str| std::fs::read_to_string(at.join(name)).unwrap();
    done(at, &with(&["--jobs", "1", "-o", "one.json"]));
    done(at, &with(&["--jobs", "2", "-o", "two.json"]));
    assert_eq!(read("one.json"), read("two.json"));
    let names: Vec<String> = (0..7).map(|i| format!("shard_{i}.json")).collect();
    for (i, name) in names.iter().enumerate() {
        done(at, &with(&["--shard", &format!("{i}/7"), "-o", name]));
    }
    let mut merge = vec!["merge", "-o", "merged.json"];
    merge.extend(names.iter().rev().map(String::as_str));
    done(at, &merge);
    assert_eq!(read("one.json"), read("merged.json"));

    // What a part says is said of the part.
    let part = run(at, &["merge", "shard_0.json", "shard_3.json"]);
    assert!(text(&part.stderr).contains("of 45 waves are drawn"));
    for (arguments, expected) in [
        (vec!["merge", "shard_0.json", "shard_0.json"], "in both"),
        (
            vec!["merge", "shard_0.json", "other.json"],
            "differ in: margin",
        ),
        (
            vec!["merge", "shard_0.json", "model.json"],
            "undulate assessment",
        ),
    ] {
        done(
            at,
            &[
                "assess",
                "model.json",
                "--robot",
                "wave_arm",
                "-n",
                "45",
                "--seed",
                "2",
                "--by",
                "shift,slow,shrink",
                "--shard",
                "1/7",
                "-o",
                "other.json",
            ],
        );
        let error = fails(at, 1, &arguments);
        assert!(error.contains(expected), "{error}");
    }
    for shard in ["7/7", "-1/7", "x", "0/46", "0/0"] {
        let option = format!("--shard={shard}");
        let error = fails(at, 2, &with(&[&option]));
        assert!(error.contains("--shard"), "{error}");
    }
}

#[test]
fn bounds_are_exact_and_the_worst_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    done(at, &["learn", "-o", "model.json"]);
    let report = json(at, &with(&["--worst", "worst", "--confidence", "0.9"]));
    let drawn = report["drawn"].as_u64().unwrap();
    let passed = report["passed"]["count"].as_u64().unwrap();
    assert_eq!(drawn, 45);
    // One-sided at 90 %: the two-sided interval at 80 %.
    let near = |found: &serde_json::Value, expected: f64| {
        assert!(
            (found.as_f64().unwrap() - expected).abs() < 1e-12,
            "{found}"
        );
    };
    near(
        &report["passed"]["probability_above"],
        clopper_pearson(passed, drawn, 0.8).0,
    );
    let failures = report["failures"].as_array().unwrap();
    assert!(!failures.is_empty());
    for failure in failures {
        let count = failure["count"].as_u64().unwrap();
        near(
            &failure["probability_below"],
            clopper_pearson(count, drawn, 0.8).1,
        );
        let code = failure["reason"].as_str().unwrap();
        let file = format!("{code}.json");
        assert!(files(&at.join("worst")).contains(&file));
        // It fails as it is said to.
        let wave = format!("worst/{file}");
        let check = run(
            at,
            &[
                "check", &wave, "--robot", "wave_arm", "--margin", "0.01", "--json",
            ],
        );
        assert_eq!(check.status.code(), Some(3));
        assert!(text(&check.stdout).contains(code), "{code}");
    }
    let bins = report["clearance_m"].as_array().unwrap();
    let counted: u64 = bins.iter().map(|bin| bin[2].as_u64().unwrap()).sum();
    assert_eq!(counted + report["clearance_unknown"].as_u64().unwrap(), 45);
    let mending = &report["mending"];
    assert_eq!(mending["tried"].as_u64(), Some(drawn - passed));
    assert!(mending["mended"].as_u64() > Some(0), "{mending}");
}

#[test]
fn a_wave_that_fails_is_mended_and_then_passes() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    done(at, &["learn", "-o", "model.json"]);
    done(at, &with(&["--worst", "worst"]));
    for file in files(&at.join("worst")) {
        let wave = format!("worst/{file}");
        let mend = |by: &str| {
            run(
                at,
                &[
                    "mend",
                    &wave,
                    "--robot",
                    "wave_arm",
                    "--margin",
                    "0.01",
                    "--by",
                    by,
                    "-o",
                    "mended.json",
                ],
            )
        };
        let mended = mend("shift,shrink-offending,slow,shrink");
        assert_eq!(mended.status.code(), Some(0), "{}", text(&mended.stderr));
        done(
            at,
            &[
                "check",
                "mended.json",
                "--robot",
                "wave_arm",
                "--margin",
                "0.01",
            ],
        );
        std::fs::remove_file(at.join("mended.json")).unwrap();
    }
    // What no means mends is not written.
    let file = &files(&at.join("worst"))[0];
    let wave = format!("worst/{file}");
    let arguments = [
        "mend",
        &wave,
        "--robot",
        "wave_arm",
        "--margin",
        "5",
        "--by",
        "shrink",
        "-o",
        "mended.json",
    ];
    let refused = run(at, &arguments);
    assert_eq!(refused.status.code(), Some(3));
    assert!(!at.join("mended.json").exists());
}

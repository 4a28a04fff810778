//! What bad input gets: a message with its place, an exit code that means something, and no output.

#[path = "common/program.rs"]
mod program;

use program::{done, fails, files};

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
        model.replace("\"version\":2", "\"version\":7"),
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
            vec!["later.json: version 7, expected 1 to 2"],
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
            vec!["positive number"],
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
        (
            "check wave.json --robot wave_arm --accuracy 0",
            "accuracy of 0 m",
        ),
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

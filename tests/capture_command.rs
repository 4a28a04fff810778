//! `undulate capture`: motion capture to recordings that `learn` takes, all of them or none.

use std::path::Path;

use undulate::{ARM_ANGLES, CsvOptions, Recording, Side, stream};

#[path = "common/program.rs"]
mod program;
#[path = "common/skeleton.rs"]
mod skeleton;

use program::{done, fails, files, json, run, text};
use skeleton::{FRAMES, Skeleton, Waves, angles, random_waves};

/// A left arm that hangs.
const STILL: Waves = [
    [0.1, 0.0, 0.0],
    [0.2, 0.01, 0.0],
    [0.0; 3],
    [0.3, 0.0, 0.0],
    [0.0; 3],
    [0.0; 3],
    [0.0; 3],
];

/// A right arm that waves with some size.
fn waving(number: u64) -> Waves {
    let mut waves = random_waves(&mut stream(12, number), 1);
    for wave in &mut waves {
        wave[1] = wave[1].max(0.2);
    }
    waves
}

/// Four cycles.
fn write(folder: &Path, name: &str, right: &Waves, left: &Waves) {
    let text = Skeleton::mixamo().text([right, left], false);
    let lines: Vec<&str> = text.lines().collect();
    let (head, cycle) = lines.split_at(lines.len() - FRAMES);
    let head = head.join("\n").replace(
        &format!("Frames: {FRAMES}"),
        &format!("Frames: {}", 4 * FRAMES),
    );
    let text = format!("{head}\n{}", format!("{}\n", cycle.join("\n")).repeat(4));
    std::fs::write(folder.join(name), text).unwrap();
}

#[test]
fn recordings_of_the_arm_that_waves_are_learned() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for number in 0..3 {
        write(at, &format!("take{number}.bvh"), &waving(number), &STILL);
    }
    let report = json(
        at,
        &[
            "capture",
            "take0.bvh",
            "take1.bvh",
            "take2.bvh",
            "-o",
            "taken",
        ],
    );
    assert_eq!(report["order"], "xzy");
    assert_eq!(
        files(&at.join("taken")),
        ["take0_R.csv", "take1_R.csv", "take2_R.csv"]
    );
    for number in 0..3 {
        let value = &report["recordings"][number as usize];
        assert_eq!(value["skeleton"], "Mixamo");
        assert_eq!(value["arm"], "right");
        assert_eq!(value["rate_hz"].as_f64().unwrap().round(), skeleton::RATE);
        let path = at.join(format!("taken/take{number}_R.csv"));
        let recording = Recording::open(&path, &CsvOptions::default()).unwrap();
        assert!(recording.joints().iter().eq(ARM_ANGLES));
        for frame in 0..FRAMES {
            for (joint, expected) in angles(&waving(number), frame).into_iter().enumerate() {
                assert!((recording.positions()[(frame, joint)] - expected).abs() < 1e-9);
            }
        }
    }
    done(
        at,
        &["learn", "taken", "--harmonics", "4", "-o", "model.json"],
    );
}

#[test]
fn words_say_what_was_taken() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "take.bvh", &waving(0), &STILL);
    let words = done(
        at,
        &[
            "capture", "take.bvh", "--order", "zxy", "--from", "0.2", "--to", "0.7", "-o",
            "one.csv",
        ],
    );
    for part in [
        "skeleton Mixamo of 10 bones, 160 frames at 40 Hz; right hand",
        "right arm: 21 samples, 0.50 s",
        "to one.csv",
        "wrote 1 recordings, order zxy",
    ] {
        assert!(words.contains(part), "{part}: {words}");
    }
    assert_eq!(files(at), ["one.csv", "take.bvh"]);
}

#[test]
fn nothing_is_written_where_one_of_them_is_bad() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "good.bvh", &waving(0), &waving(1));
    let whole = std::fs::read_to_string(at.join("good.bvh")).unwrap();
    std::fs::write(at.join("short.bvh"), &whole[..whole.len() - 200]).unwrap();
    std::fs::write(at.join("odd.bvh"), whole.replace("ForeArm", "Tentacle")).unwrap();
    for (code, arguments, expected) in [
        (1, &["good.bvh", "short.bvh"][..], "short.bvh, line"),
        (
            1,
            &["good.bvh", "odd.bvh"],
            "without RightForeArm; say in a bone map (--bones)",
        ),
        (1, &["good.bvh", "none.bvh"], "none.bvh: No such file"),
        (2, &["good.bvh", "good.bvh"], "two recordings for"),
        (2, &["good.bvh", "--rate", "-3"], "a rate of -3 Hz"),
        (
            2,
            &["good.bvh", "--shoulder", "0,1,2"],
            "--shoulder for a BVH file",
        ),
        (
            2,
            &["good.bvh", "--from", "5"],
            "nothing from 5 to inf s, expected a part of 0 to",
        ),
        (
            2,
            &["good.bvh", "--hinge-roll", "200deg"],
            "expected an angle within half a turn",
        ),
        (2, &["table.csv", "--bones", "bones.json"], "bones.json"),
    ] {
        let code = if arguments.contains(&"--bones") {
            1
        } else {
            code
        };
        let arguments = [&["capture"], arguments, &["-o", "taken"]].concat();
        let error = fails(at, code, &arguments);
        assert!(error.contains(expected), "{expected}: {error}");
        assert!(!at.join("taken").exists(), "{arguments:?}");
    }
    // One file is for one recording.
    let error = fails(
        at,
        2,
        &["capture", "good.bvh", "--arm", "both", "-o", "one.csv"],
    );
    assert!(error.contains("two recordings for one.csv"), "{error}");
    assert!(!at.join("one.csv").exists());
    done(at, &["capture", "good.bvh", "--arm", "both", "-o", "both"]);
    assert_eq!(files(&at.join("both")), ["good_L.csv", "good_R.csv"]);
}

#[test]
fn learn_says_what_makes_recordings_of_bvh() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "take.bvh", &waving(0), &STILL);
    let error = fails(at, 1, &["learn", "take.bvh"]);
    assert!(error.contains("take.bvh: motion capture (BVH), expected a CSV table of joint angles; `undulate capture` makes one of it"), "{error}");
    std::fs::create_dir(at.join("takes")).unwrap();
    write(at, "takes/take.bvh", &waving(0), &STILL);
    let error = fails(at, 1, &["learn", "takes"]);
    assert!(
        error.contains("takes: no CSV files")
            && error.contains("`undulate capture` makes them of BVH files"),
        "{error}"
    );
}

#[test]
fn a_map_says_which_bones_are_what_and_positions_are_taken_too() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "take.bvh", &waving(2), &STILL);
    let odd = std::fs::read_to_string(at.join("take.bvh"))
        .unwrap()
        .replace("mixamorig:", "X");
    std::fs::write(at.join("odd.bvh"), odd).unwrap();
    let map = "{\"thorax\": \"XSpine2\", \"right\": {\"upper_arm\": \"XRightArm\", \"forearm\": \"XRightForeArm\", \"hand\": \"XRightHand\"}}";
    std::fs::write(at.join("bones.json"), map).unwrap();
    done(
        at,
        &["capture", "take.bvh", "--arm", "right", "-o", "known.csv"],
    );
    done(
        at,
        &[
            "capture",
            "odd.bvh",
            "--bones",
            "bones.json",
            "-o",
            "mapped.csv",
        ],
    );
    let read = |name: &str| std::fs::read_to_string(at.join(name)).unwrap();
    assert_eq!(read("known.csv"), read("mapped.csv"));
    // The upper arm is said to lie upside down: its elbow bends the wrong way.
    let wrong = map.replace(
        "\"XRightArm\"",
        "{\"bone\": \"XRightArm\", \"up\": [0, -1, 0], \"forward\": [0, 0, -1]}",
    );
    std::fs::write(at.join("wrong.json"), wrong).unwrap();
    let arguments = [
        "capture",
        "odd.bvh",
        "--bones",
        "wrong.json",
        "-o",
        "wrong.csv",
    ];
    let notes = text(&run(at, &arguments).stderr);
    assert!(notes.contains("the elbow bends about an axis"), "{notes}");
    let notes = text(&run(at, &["capture", "take.bvh", "-o", "."]).stderr);
    assert!(!notes.contains("the elbow bends"), "{notes}");
    fails(at, 2, &["capture", "take.bvh", "--from", "nan", "-o", "."]);

    let mut table = String::from("time_s,elbow_x,elbow_y,elbow_z,hand_x,hand_y,hand_z\n");
    for frame in 0..FRAMES {
        let [humerus, forearm, _] =
            skeleton::segments(angles(&waving(2), frame), false, Side::Left);
        let elbow = -0.3 * humerus.column(1);
        let hand = elbow - 0.2 * forearm.column(1);
        table += &format!(
            "{},{},{},{},{},{},{}\n",
            frame as f64 / 40.0,
            elbow.x,
            elbow.y,
            elbow.z,
            hand.x,
            hand.y,
            hand.z
        );
    }
    std::fs::write(at.join("markers.csv"), table).unwrap();
    let error = fails(at, 1, &["capture", "markers.csv", "-o", "left.csv"]);
    assert!(
        error.contains("say with --shoulder X,Y,Z where it is"),
        "{error}"
    );
    let output = run(
        at,
        &[
            "capture",
            "markers.csv",
            "--arm",
            "left",
            "--shoulder",
            "0,0,0",
            "-o",
            "left.csv",
        ],
    );
    assert!(output.status.success(), "{}", text(&output.stderr));
    let recording = Recording::open(&at.join("left.csv"), &CsvOptions::default()).unwrap();
    assert_eq!(recording.joints().len(), 4);
    let expected = angles(&waving(2), 17);
    assert!(
        (0..4).all(|joint| (recording.positions()[(17, joint)] - expected[joint]).abs() < 1e-9)
    );
}

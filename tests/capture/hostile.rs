//! Files that are cut short, go in a cycle, announce what is not there, or lack what is needed: each is refused with its place.

use undulate::{ArmMotion, BoneMap, Bvh, PositionOptions, Side, stream};

use crate::skeleton::{Skeleton, random_waves};

fn whole() -> String {
    let waves = random_waves(&mut stream(5, 0), 1);
    Skeleton::mixamo().text([&waves, &waves], false)
}

fn refused(text: &str) -> String {
    Bvh::from_text(text).unwrap_err().to_string()
}

/// Two bones, whose MOTION has these lines.
fn small(motion: &str) -> String {
    format!(
        "HIERARCHY\nROOT a\n{{\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nJOINT b\n{{\nOFFSET 1 0 0\nCHANNELS 1 Xrotation\n}}\n}}\nMOTION\n{motion}"
    )
}

#[test]
fn each_bad_file_gets_its_place_and_what_to_do() {
    let rows = "1 2 3 4\n1 2 3 4\n";
    let with = |line: &str, other: &str| {
        let text = small(&format!("Frames: 2\nFrame Time: 0.1\n{rows}"));
        assert!(text.contains(line), "{line}");
        text.replace(line, other)
    };
    for (text, expected) in [
        (String::new(), "the file is empty, expected HIERARCHY"),
        (
            "time_s,a\n0,1\n".into(),
            "line 1: found `time_s,a`, expected HIERARCHY",
        ),
        (
            "HIERARCHY\nROOT a\n{\n".into(),
            "line 3: the file is cut short",
        ),
        (
            with("}\n}\n", "}\n"),
            "line 11: 1 braces are not closed, expected `}` for bone `a` of line 2",
        ),
        (
            with("}\n}\n", "}\n}\n}\n"),
            "line 12: found `}`, expected as many `{` before it",
        ),
        (
            with("JOINT b", "JOINT a"),
            "line 6: a cycle: bone `a` is below itself, expected a name of its own; the other is on line 2",
        ),
        (
            with("}\n}\n", "}\nJOINT b\n{\n}\n}\n"),
            "line 11: two bones `b`, expected a name of its own; the other is on line 6",
        ),
        (
            with("JOINT b\n{", "JOINT b\n"),
            "expected `{` after a bone's name",
        ),
        (with("JOINT b", "JOINT"), "line 6: a bone without name"),
        (
            with("OFFSET 1 0 0", "OFFSET 1 0"),
            "line 8: found `1 0`, expected three numbers",
        ),
        (
            with("OFFSET 1 0 0", "OFFSET 1 nan 0"),
            "line 8: found `nan`, expected a finite number",
        ),
        (
            with("1 Xrotation", "1 Wrotation"),
            "line 9: channel `Wrotation`, expected Xposition",
        ),
        (
            with("1 Xrotation", "2 Xrotation"),
            "line 9: CHANNELS 2 Xrotation: 1 names",
        ),
        (
            with("1 Xrotation", "2 Xrotation Xrotation"),
            "one of them twice",
        ),
        (
            with("MOTION\n", ""),
            "line 12: found `Frames: 2`, expected ROOT, JOINT",
        ),
        (
            with("Frames: 2", "Frames: two"),
            "line 13: found `two`, expected Frames: and a whole number",
        ),
        (
            with("Frames: 2\n", ""),
            "line 13: found `Frame Time: 0.1`, expected `Frames:`",
        ),
        (with("Time: 0.1", "Time: 0"), "line 14: a frame time of 0 s"),
        (with("Time: 0.1", "Time: nan"), "line 14: found `nan`"),
        (
            small("Frames: 2\n"),
            "line 13: the file is cut short, expected `Frame Time:`",
        ),
        (
            with("1 2 3 4\n", "1 2 3 NaN\n"),
            "line 15, number 4: found `NaN`, expected a finite number",
        ),
        (
            with("1 2 3 4\n", "1 2 3 inf\n"),
            "line 15, number 4: found `inf`",
        ),
        (
            with("1 2 3 4\n", "1 2 3 1e300\n"),
            "line 15, number 4: found `1e300`",
        ),
        (
            with("1 2 3 4\n", "1 2 3 4,5\n"),
            "line 15, number 4: found `4,5`",
        ),
        (
            with("1 2 3 4\n1 2", "1 2 3 4\n1"),
            "line 16: a frame of 3 numbers, expected 4",
        ),
        (
            with("Frames: 2", "Frames: 3"),
            "line 16: 2 frames, the file is cut short, expected 3",
        ),
        (
            with("Frames: 2", "Frames: 1"),
            "line 16: more frames than announced",
        ),
        (
            small("Frames: 1\nFrame Time: 0.1\n1 2 3 4\n"),
            "1 frames, expected at least two",
        ),
        // A million, and as many as there are numbers, that are not there: nothing is taken for them.
        (
            with("Frames: 2", "Frames: 1000000"),
            "2 frames, the file is cut short, expected 1000000",
        ),
        (
            with("Frames: 2", &format!("Frames: {}", usize::MAX)),
            "the file is cut short",
        ),
        (
            "HIERARCHY\nMOTION\nFrames: 2\n".into(),
            "line 2: no bone with channels",
        ),
        (
            format!("HIERARCHY\n{}", "ROOT a { OFFSET 0 0 0 }".repeat(2)),
            "two bones `a`",
        ),
    ] {
        let error = refused(&text);
        assert!(error.contains(expected), "{expected:?}, got: {error}");
    }
}

#[test]
fn chains_of_any_depth_are_read_or_refused_and_exhaust_no_stack() {
    let chain = |bones: usize| {
        let mut text = String::from("HIERARCHY\nROOT b0 {\nCHANNELS 1 Xrotation\n");
        (1..bones).for_each(|i| text.push_str(&format!("JOINT b{i} {{\n")));
        text.push_str(&"}\n".repeat(bones));
        text + "MOTION\nFrames: 2\nFrame Time: 0.1\n1\n2\n"
    };
    assert_eq!(Bvh::from_text(&chain(4096)).unwrap().bones().count(), 4096);
    assert!(
        refused(&chain(1_000_000)).contains("line 4099: too many bones, expected at most 4096")
    );
    let braces = format!("HIERARCHY\nROOT a {{{}", "End Site {".repeat(200_000));
    assert!(refused(&braces).contains("outside a bone"));
}

#[test]
fn a_million_frames_are_read() {
    let mut text = small("Frames: 1000000\nFrame Time: 0.008333\n");
    text.push_str(&"1 2 3 4\n".repeat(1_000_000));
    let bvh = Bvh::from_text(&text).unwrap();
    assert_eq!((bvh.frames(), bvh.rate()), (1_000_000, 120.0));
}

#[test]
fn every_cut_is_refused() {
    let text = whole();
    for end in (0..text.len() - 2).step_by(97) {
        // A cut within the last number leaves another one.
        if text[end..].trim_end().contains(' ') {
            assert!(Bvh::from_text(&text[..end]).is_err(), "cut at {end}");
        }
    }
}

#[test]
fn missing_bones_are_named_with_those_that_are_there() {
    let bvh = Bvh::from_text(
        &whole()
            .replace("mixamorig:LeftHand\n", "Paw\n")
            .replace("RightForeArm", "Wing"),
    )
    .unwrap();
    let error = BoneMap::recognise(&bvh).unwrap_err().to_string();
    for part in [
        "an unknown skeleton of bones Root, mixamorig:Spine2",
        "nearest to that of Mixamo, without",
        "Hand",
        "bone map (--bones)",
    ] {
        assert!(error.contains(part), "{part}: {error}");
    }
    // One arm is enough.
    let bvh = Bvh::from_text(&whole().replace("RightForeArm", "Wing")).unwrap();
    let map = BoneMap::recognise(&bvh).unwrap();
    assert_eq!(map.sides().collect::<Vec<_>>(), [Side::Left]);
    let error = ArmMotion::from_bvh(&bvh, &map, Side::Right)
        .unwrap_err()
        .to_string();
    assert!(error.contains("no right arm"), "{error}");

    let bvh = Bvh::from_text(&whole()).unwrap();
    for (map, expected) in [
        (
            "{\"thorax\": \"Chest\", \"right\": {\"upper_arm\": \"a\", \"forearm\": \"b\"}}",
            "no bone `Chest` among Root, mixamorig:Spine2",
        ),
        (
            "{\"thorax\": \"Root\", \"right\": {\"upper_arm\": \"mixamorig:RightForeArm\", \"forearm\": \"mixamorig:RightArm\"}}",
            "the second is not below the first",
        ),
        (
            "{\"thorax\": \"Root\", \"right\": {\"upper_arm\": \"mixamorig:LeftArm\", \"forearm\": \"mixamorig:LeftForeArm\"}}",
            "bone `mixamorig:LeftArm`: the bone points inwards in the T-pose",
        ),
        (
            "{\"thorax\": {\"bone\": \"mixamorig:Spine2\", \"up\": [0, 1, 0], \"forward\": [0, 0, -1]}, \"right\": {\"upper_arm\": \"mixamorig:RightArm\", \"forearm\": \"mixamorig:RightForeArm\"}, \"left\": {\"upper_arm\": \"mixamorig:LeftArm\", \"forearm\": \"mixamorig:LeftForeArm\"}}",
            "bone `mixamorig:Spine2`: the left shoulder is not on the left of the right one",
        ),
    ] {
        let map = BoneMap::from_json(map).unwrap();
        let error = ArmMotion::from_bvh(&bvh, &map, Side::Right)
            .unwrap_err()
            .to_string();
        assert!(error.contains(expected), "{expected}: {error}");
    }
}

#[test]
fn bad_maps_are_refused() {
    for (text, expected) in [
        ("", "line 1, column 0: EOF"),
        (
            "{\"thorax\": \"a\"}",
            "no arm, expected `right`, `left` or both",
        ),
        (
            "{\"thorax\": 3, \"right\": {}}",
            "a bone's name, or {\"bone\"",
        ),
        (
            "{\"thorax\": \"a\", \"middle\": {}}",
            "unknown field `middle`",
        ),
        (
            "{\"thorax\": {\"bone\": \"a\", \"up\": [0, 1, 0], \"forward\": [0, 2, 0]}, \"right\": {\"upper_arm\": \"b\", \"forearm\": \"c\"}}",
            "bone `a`: up and forward span no plane",
        ),
        (
            "{\"thorax\": \"a\", \"right\": {\"upper_arm\": {\"bone\": \"b\", \"up\": [1e308, 1e308, 0], \"forward\": [0, 0, 1]}, \"forearm\": \"c\"}}",
            "bone `b`: up and forward span no plane",
        ),
    ] {
        let error = BoneMap::from_json(text).unwrap_err().to_string();
        assert!(error.contains(expected), "{expected}: {error}");
    }
}

#[test]
fn bad_tables_of_positions_are_refused() {
    const HEADER: &str =
        "time_s,shoulder_x,shoulder_y,shoulder_z,elbow_x,elbow_y,elbow_z,hand_x,hand_y,hand_z\n";
    let bent = "0,0,0,0,0,-1,0,0,-1,1\n1,0,0,0,0,-1,0,0,-1,1\n";
    let options = PositionOptions {
        side: Side::Right,
        shoulder: None,
    };
    for (text, expected) in [
        (String::new(), "the file is empty"),
        (
            "time_s,hand_x\n".into(),
            "no column `shoulder_x` among time_s, hand_x; say with --shoulder",
        ),
        (HEADER.replace("hand_z", "hand"), "no column `hand_z`"),
        (HEADER.replace("time_s", "t"), "no column `time_s`"),
        (
            HEADER.into(),
            "0 samples with all positions, expected at least two",
        ),
        (
            format!("{HEADER}{}", bent.replace("\n1,0", "\n0,0")),
            "line 3: time 0 s does not come after 0 s",
        ),
        (
            format!("{HEADER}{}", bent.replace("-1,1", "x,1")),
            "line 2, column `hand_y`: found `x`",
        ),
        (
            format!("{HEADER}{}", bent.replace("-1,1", "1e300,1")),
            "line 2: a position of 1000",
        ),
        (
            format!("{HEADER}{}", bent.replace("-1,0,0,-1,1", "0,0,0,-1,1")),
            "line 2: no direction from shoulder to elbow",
        ),
        (
            format!("{HEADER}{}", bent.replace("0,-1,1", "0,-2,0")),
            "the elbow never bends",
        ),
        (
            format!("{}{bent}", HEADER.replace("time_s", "pelvis_x,time_s")),
            "no column `other_shoulder_x`",
        ),
    ] {
        let error = ArmMotion::from_positions(text.as_bytes(), options)
            .unwrap_err()
            .to_string();
        assert!(error.contains(expected), "{expected}: {error}");
    }
    let fixed = PositionOptions {
        shoulder: Some([f64::NAN, 0.0, 0.0]),
        ..options
    };
    let error = ArmMotion::from_positions(format!("{HEADER}{bent}").as_bytes(), fixed).unwrap_err();
    assert!(
        error.to_string().contains("expected three finite numbers"),
        "{error}"
    );
}

//! Skeletons and positions made from known angles: the same angles come back.

use nalgebra::{Matrix3, Rotation3, Vector3};
use undulate::rand::RngExt;
use undulate::{
    ARM_ANGLES, ArmMotion, BoneMap, Bvh, CaptureNote, Captured, PositionOptions, ShoulderOrder,
    Side, stream,
};

use crate::skeleton::{FRAMES, RATE, Skeleton, Waves, angles, random_waves, segments, trunk};

/// Rounding of degrees and back, where no order is singular.
const ROUNDING: f64 = 1e-9;

const ORDERS: [(ShoulderOrder, bool, usize); 2] = [
    (ShoulderOrder::Xzy, false, 1),
    (ShoulderOrder::Zxy, true, 0),
];

fn check(captured: &Captured, waves: &Waves, what: &str) {
    let recording = &captured.recording;
    let positions = recording.positions();
    assert_eq!(positions.nrows(), FRAMES);
    for frame in 0..FRAMES {
        assert_eq!(recording.times()[frame], frame as f64 / RATE);
        let expected = angles(waves, frame);
        for joint in 0..positions.ncols() {
            assert_eq!(recording.joints().name(joint), ARM_ANGLES[joint]);
            let off = (positions[(frame, joint)] - expected[joint]).abs();
            assert!(
                off < ROUNDING,
                "{what}: frame {frame}, {}: off by {off}",
                ARM_ANGLES[joint]
            );
        }
    }
}

fn captured(
    text: &str,
    map: Option<&BoneMap>,
    side: Side,
    order: ShoulderOrder,
) -> (ArmMotion, Captured) {
    let bvh = Bvh::from_text(text).unwrap();
    let map = map
        .cloned()
        .unwrap_or_else(|| BoneMap::recognise(&bvh).unwrap());
    let motion = ArmMotion::from_bvh(&bvh, &map, side).unwrap();
    let captured = motion.angles("made", order).unwrap();
    (motion, captured)
}

/// All orders of three axes.
const CHANNELS: [[usize; 3]; 6] = [
    [0, 1, 2],
    [0, 2, 1],
    [1, 0, 2],
    [1, 2, 0],
    [2, 0, 1],
    [2, 1, 0],
];

#[test]
fn known_angles_come_back_from_any_channels_of_both_arms_in_both_orders() {
    for number in 0..40 {
        let rng = &mut stream(5, number);
        let mut skeleton = Skeleton::mixamo();
        skeleton.channels = (0..7).map(|_| CHANNELS[rng.random_range(0..6)]).collect();
        skeleton.roll = rng.random_range(-1.0..1.0);
        for (order, zxy, middle) in ORDERS {
            let waves = [random_waves(rng, middle), random_waves(rng, middle)];
            let text = skeleton.text([&waves[0], &waves[1]], zxy);
            for (waves, side) in waves.iter().zip(Side::ALL) {
                let (motion, captured) = captured(&text, None, side, order);
                check(&captured, waves, &format!("{number} {order} {side:?}"));
                let off = (motion.hinge_roll() - skeleton.roll).abs();
                assert!(
                    off < ROUNDING,
                    "{number} {order} {side:?}: roll off by {off}"
                );
            }
        }
    }
}

/// Left, up and forward of a bone of any own axes.
fn any_axes(rng: &mut impl RngExt) -> Matrix3<f64> {
    let mut turn = || rng.random_range(-3.0..3.0);
    *Rotation3::from_euler_angles(turn(), turn(), turn()).matrix()
}

#[test]
fn bones_of_any_own_axes_are_told_by_a_map() {
    for number in 0..20 {
        let rng = &mut stream(6, number);
        let skeleton = Skeleton {
            thorax: "Brust korb",
            arms: [["a", "b", "c", "d"], ["e", "f", "g", "h"]],
            thorax_axes: any_axes(rng),
            arm_axes: [any_axes(rng), any_axes(rng)],
            channels: vec![CHANNELS[number as usize % 6]],
            roll: 0.4,
        };
        let bone = |name: &str, axes: &Matrix3<f64>| {
            let [up, forward] =
                [axes.column(1), axes.column(2)].map(|axis| axis.as_slice().to_vec());
            format!("{{\"bone\": \"{name}\", \"up\": {up:?}, \"forward\": {forward:?}}}")
        };
        let arm = |i: usize| {
            let [upper, forearm, hand, fingers] = skeleton.arms[i];
            let axes = &skeleton.arm_axes[i];
            format!(
                "{{\"upper_arm\": {}, \"forearm\": {}, \"hand\": {}, \"fingers\": \"{fingers}\"}}",
                bone(upper, axes),
                bone(forearm, axes),
                bone(hand, axes)
            )
        };
        let thorax = bone(skeleton.thorax, &skeleton.thorax_axes);
        let map = format!(
            "{{\"thorax\": {thorax}, \"right\": {}, \"left\": {}}}",
            arm(0),
            arm(1)
        );
        let map = BoneMap::from_json(&map).unwrap();
        let waves = [random_waves(rng, 1), random_waves(rng, 1)];
        let text = skeleton.text([&waves[0], &waves[1]], false);
        for (waves, side) in waves.iter().zip(Side::ALL) {
            let (_, captured) = captured(&text, Some(&map), side, ShoulderOrder::Xzy);
            check(&captured, waves, &format!("{number} {side:?}"));
        }
    }
}

#[test]
fn a_part_keeps_the_zero_of_the_whole() {
    let waves = random_waves(&mut stream(7, 0), 1);
    let text = Skeleton::mixamo().text([&waves, &waves], false);
    let (motion, whole) = captured(&text, None, Side::Right, ShoulderOrder::Xzy);
    let part = motion.between(0.25, 0.5).unwrap();
    let found = part.angles("part", ShoulderOrder::Xzy).unwrap().recording;
    assert_eq!(found.times().len(), 11);
    assert_eq!(found.times()[0], 0.0);
    assert_eq!(
        found.positions(),
        &whole.recording.positions().rows(10, 11).into_owned()
    );
    assert_eq!(part.hinge_roll(), motion.hinge_roll());
    let error = motion.between(0.51, 0.52).unwrap_err().to_string();
    assert!(
        error.contains("nothing from 0.51 to 0.52 s, expected a part of 0 to 0.975 s"),
        "{error}"
    );
}

#[test]
fn another_zero_shifts_the_rotation_alone() {
    let waves = random_waves(&mut stream(7, 1), 1);
    let text = Skeleton::mixamo().text([&waves, &waves], false);
    let (motion, before) = captured(&text, None, Side::Left, ShoulderOrder::Xzy);
    let rolled = motion
        .clone()
        .with_hinge_roll(motion.hinge_roll() + 0.25)
        .unwrap();
    let after = rolled.angles("rolled", ShoulderOrder::Xzy).unwrap();
    let shift = after.recording.positions() - before.recording.positions();
    assert!(
        shift.column(2).iter().all(|s| (s - 0.25).abs() < ROUNDING),
        "{shift}"
    );
    assert!(shift.columns(0, 2).amax() < ROUNDING);
    assert!(motion.with_hinge_roll(f64::NAN).is_err());
}

/// An arm that goes up sideways, through where xzy is singular.
const RAISED: Waves = [
    [0.3, 0.0, 0.0],
    [1.5, 0.5, 0.0],
    [0.2, 0.0, 0.0],
    [1.2, 0.1, 0.3],
    [0.0; 3],
    [0.0; 3],
    [0.0; 3],
];

#[test]
fn the_singular_order_is_warned_of_and_angles_run_on_through_it() {
    let text = Skeleton::mixamo().text([&RAISED, &RAISED], false);
    for (order, singular) in [(ShoulderOrder::Xzy, true), (ShoulderOrder::Zxy, false)] {
        let (_, captured) = captured(&text, None, Side::Right, order);
        match &captured.notes[..] {
            [
                CaptureNote::Singular {
                    order: ShoulderOrder::Xzy,
                    nearest,
                    other,
                },
            ] if singular => {
                assert!(*nearest < 0.1 && *other > 0.8, "{nearest} {other}");
                let text = captured.notes[0].to_string();
                assert!(text.contains("zxy stays"), "{text}");
            }
            [] if !singular => {}
            notes => panic!("{order}: {notes:?}"),
        }
        if singular {
            check(&captured, &RAISED, "raised");
        }
    }
}

#[test]
fn frozen_frames_and_a_straight_elbow_are_told_and_no_errors() {
    let still = RAISED.map(|[offset, ..]| [offset - 0.9, 0.0, 0.0]);
    let straight = {
        let mut waves = random_waves(&mut stream(8, 0), 1);
        waves[3] = [0.0, 0.001, 0.0];
        waves
    };
    let text = Skeleton::mixamo().text([&straight, &still], false);
    let (motion, captured) = captured(&text, None, Side::Right, ShoulderOrder::Xzy);
    assert_eq!(captured.notes, [CaptureNote::NoHinge]);
    assert_eq!(motion.hinge_roll(), 0.0);
    // The same frame over and over in the middle.
    let waves = random_waves(&mut stream(8, 1), 1);
    let text = Skeleton::mixamo().text([&waves, &waves], false);
    let mut lines: Vec<&str> = text.lines().collect();
    let first = lines.len() - FRAMES;
    let frozen = lines[first + 10];
    lines[first + 11..first + 20].fill(frozen);
    let (_, captured) = self::captured(&lines.join("\n"), None, Side::Right, ShoulderOrder::Xzy);
    match captured.notes[..] {
        [
            CaptureNote::Frozen {
                frames: 9,
                longest,
                at,
            },
        ] => assert!((longest - 9.0 / RATE).abs() < 1e-12 && at == 10.0 / RATE),
        ref notes => panic!("{notes:?}"),
    }
}

/// A table of an arm that moves so; with a trunk, which moves.
fn positions(waves: &Waves, side: Side, with_trunk: bool) -> String {
    let mut text = String::from(
        "time_s,shoulder_x,shoulder_y,shoulder_z,elbow_x,elbow_y,elbow_z,hand_x,hand_y,hand_z",
    );
    if with_trunk {
        text.push_str(
            ",other_shoulder_x,other_shoulder_y,other_shoulder_z,pelvis_x,pelvis_y,pelvis_z",
        );
    }
    let out = match side {
        Side::Right => -Vector3::x(),
        Side::Left => Vector3::x(),
    };
    for frame in 0..FRAMES {
        let trunk = if with_trunk {
            trunk(frame)
        } else {
            Matrix3::identity()
        };
        let [humerus, forearm, _] = segments(angles(waves, frame), false, side);
        let shoulder = trunk * (0.2 * out + 0.5 * Vector3::y());
        let elbow = shoulder - trunk * humerus * Vector3::y() * 0.3;
        let hand = elbow - trunk * forearm * Vector3::y() * 0.26;
        let other = trunk * (-0.2 * out + 0.5 * Vector3::y());
        let mut points = vec![shoulder, elbow, hand];
        if with_trunk {
            points.extend([other, Vector3::zeros()]);
        }
        text.push_str(&format!("\n{}", frame as f64 / RATE));
        for x in points.iter().flat_map(|p| p.iter()) {
            text.push_str(&format!(",{x}"));
        }
    }
    text
}

#[test]
fn positions_tell_shoulder_and_elbow() {
    for number in 0..20 {
        let waves = random_waves(&mut stream(9, number), 1);
        for (side, with_trunk) in [
            (Side::Right, false),
            (Side::Left, false),
            (Side::Right, true),
            (Side::Left, true),
        ] {
            let text = positions(&waves, side, with_trunk);
            let options = PositionOptions {
                side,
                shoulder: None,
            };
            let motion = ArmMotion::from_positions(text.as_bytes(), options).unwrap();
            let captured = motion.angles("positions", ShoulderOrder::Xzy).unwrap();
            assert_eq!(captured.recording.joints().len(), 4);
            check(
                &captured,
                &waves,
                &format!("{number} {side:?} {with_trunk}"),
            );
        }
    }
}

#[test]
fn where_the_elbow_is_straight_the_rotation_is_carried_on() {
    // Hardly bent half of the time, while the upper arm stands still.
    let mut waves = RAISED.map(|[offset, ..]| [0.4 * offset, 0.0, 0.0]);
    waves[3] = [0.1, 0.1, 0.0];
    let text = positions(&waves, Side::Right, false);
    let options = PositionOptions {
        side: Side::Right,
        shoulder: None,
    };
    let motion = ArmMotion::from_positions(text.as_bytes(), options).unwrap();
    let captured = motion.angles("positions", ShoulderOrder::Xzy).unwrap();
    check(&captured, &waves, "straight");
    assert!(
        matches!(
            captured.notes[..],
            [CaptureNote::Straight {
                samples: 15..25,
                of: FRAMES
            }]
        ),
        "{:?}",
        captured.notes
    );
}

#[test]
fn rows_without_positions_are_gaps_and_a_shoulder_may_stay_where_it_is() {
    let waves = random_waves(&mut stream(9, 99), 1);
    let text = positions(&waves, Side::Right, false);
    let rows: Vec<String> = text
        .lines()
        .enumerate()
        .map(|(i, line)| {
            let mut fields: Vec<&str> = line.split(',').collect();
            // Rows 11 to 20 have no hand; no row has a shoulder.
            if (12..22).contains(&i) {
                fields[8] = "";
            }
            fields.drain(1..4);
            fields.join(",")
        })
        .collect();
    let options = PositionOptions {
        side: Side::Right,
        shoulder: Some([-0.2, 0.5, 0.0]),
    };
    let motion = ArmMotion::from_positions(rows.join("\n").as_bytes(), options).unwrap();
    assert_eq!(motion.samples(), FRAMES - 10);
    let captured = motion.angles("positions", ShoulderOrder::Xzy).unwrap();
    match captured.notes[..] {
        [
            CaptureNote::Gap {
                gaps: 1,
                longest,
                at,
            },
        ] => {
            assert!(
                (longest - 11.0 / RATE).abs() < 1e-12 && at == 10.0 / RATE,
                "{longest} {at}"
            );
        }
        ref notes => panic!("{notes:?}"),
    }
    let expected = angles(&waves, 30);
    let found = captured.recording.positions();
    assert!((0..4).all(|joint| (found[(20, joint)] - expected[joint]).abs() < ROUNDING));
}

//! No motion is proven clear that touches, and none is said to touch that does not: against parry on a grid of a kilohertz.

mod advancement;
#[path = "../common/mod.rs"]
mod common;
#[path = "../common/dense.rs"]
mod dense;
mod fuzz;
mod halved;
mod robots;
mod verified;
#[path = "../common/waves.rs"]
mod waves;

use dense::Dense;
use robots::carousel;
use undulate::{
    Certification, CollisionModel, CollisionOptions, HalfSpace, PairStatus, PeriodGrid, Robot,
    Scene, SceneObject, SceneShape, Shape, Wave, nalgebra, shipped, stream,
};
use waves::random_wave;

/// As people wave: a period and its harmonics.
const PERIOD: f64 = 6.7;
const HARMONICS: usize = 26;
/// Of samples \[Hz\].
const RATE: f64 = 1000.0;
/// Two ways of computing a distance may differ by this \[m\].
const ROUNDING: f64 = 1e-9;

/// The grid on which a wave is looked at.
fn grid() -> PeriodGrid {
    PeriodGrid::new((PERIOD * RATE).ceil() as usize, HARMONICS)
}

#[test]
fn the_minimum_is_between_its_bounds_and_no_sample_is_below() {
    for (name, robot, options, _) in robots::robots() {
        let model = CollisionModel::new(&robot, &options).unwrap();
        let dense = Dense::new(&robot, &model);
        let mut prover = model.prover();
        for number in 0..8 {
            let wave = random_wave(&robot, HARMONICS, PERIOD, 0.6, &mut stream(2, number));
            let found = prover.minimum_clearance(&wave, 1e-4).unwrap();
            assert!(
                found.lower <= found.at.distance && found.at.distance <= found.lower + 1e-4,
                "{name}: {found:?}"
            );
            let sampled = dense.clearance(&robot, &wave, 100.0, f64::NEG_INFINITY);
            assert!(
                sampled >= found.lower.max(0.0) - ROUNDING,
                "{name} {number}: {found:?}, sampled {sampled}"
            );
            let there = dense.at(
                &robot,
                wave.position(found.at.time).as_slice(),
                f64::INFINITY,
            );
            assert!(
                (there - found.at.distance.max(0.0)).abs() < ROUNDING,
                "{name} {number}: {found:?}, {there}"
            );
        }
    }
}

/// The same padding about all pairs is taken off the distance of the nearest.
#[test]
fn padding_comes_off_the_clearance_at_a_configuration() {
    for (name, robot, options, _) in robots::robots() {
        // Of all pairs: which ones always touch depends on the padding.
        let options = CollisionOptions {
            always_touching: None,
            ..options
        };
        let padded = CollisionOptions {
            padding: 0.05,
            ..options.clone()
        };
        let model = CollisionModel::new(&robot, &options).unwrap();
        let padded = CollisionModel::new(&robot, &padded).unwrap();
        for number in 0..50 {
            let wave = random_wave(&robot, HARMONICS, PERIOD, 1.0, &mut stream(4, number));
            let q = wave.position(0.0);
            let [bare, found] = [&model, &padded].map(|m| m.clearance(q.as_slice()).unwrap());
            assert!(
                (bare.distance - 0.05 - found.distance).abs() < ROUNDING,
                "{name} {number}: {bare:?}, {found:?}"
            );
        }
    }
}

/// What was asked before changes no answer: a prover keeps where it was nearest, and nothing of what it looked for.
#[test]
fn a_prover_that_is_used_answers_as_a_new_one() {
    let mut seen = [false; 2];
    for (name, robot, options, _) in robots::robots() {
        let model = CollisionModel::new(&robot, &options).unwrap();
        let mut used = model.prover();
        for number in 0..8 {
            let wave = random_wave(&robot, HARMONICS, PERIOD, 0.6, &mut stream(3, number));
            for with_scene in [true, false] {
                used.touches(&wave, with_scene).unwrap();
            }
            let is_clear = |found: Certification| matches!(found, Certification::Clear { .. });
            let found = is_clear(used.certify(&wave, 0.0, &[]).unwrap());
            let expected = is_clear(model.certify(&wave, 0.0, &[]).unwrap());
            assert_eq!(found, expected, "{name} {number}");
            seen[usize::from(expected)] = true;
        }
    }
    assert_eq!(seen, [true; 2], "waves of both kinds");
}

/// The first arm swings by `size` about the angle 0, the second stands at `angle`.
fn swing(size: f64, angle: f64) -> Wave {
    let weights = nalgebra::DMatrix::from_row_slice(
        2,
        1,
        &[
            undulate::num_complex::Complex::new(size / 2.0, 0.0),
            undulate::num_complex::Complex::ZERO,
        ],
    );
    let offsets = nalgebra::DVector::from_vec(vec![0.0, angle]);
    Wave::new(carousel(0.1).joints().clone(), 2.0, offsets, weights).unwrap()
}

#[test]
fn the_nearest_that_two_arms_come_is_a_chord() {
    let robot = carousel(0.1);
    let model = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
    // At the turning point, angle 0.6 to 1.5: a chord of the unit circle less two radii.
    let nearest = 2.0 * f64::sin(0.45) - 0.2;
    let wave = swing(0.6, 1.5);
    let found = model.minimum_clearance(&wave, 1e-6).unwrap();
    assert!(
        (found.at.distance - nearest).abs() < 1e-6
            && found.lower <= nearest
            && found.lower > nearest - 2e-6,
        "{found:?}"
    );
    assert!(
        (found.at.time - 0.0).abs().min((found.at.time - 2.0).abs()) < 1e-2,
        "{found:?}"
    );
    let certify = |margin: f64, tolerance: &[f64]| model.certify(&wave, margin, tolerance).unwrap();
    assert!(certify(nearest - 1e-6, &[]).is_clear());
    assert!(matches!(
        certify(nearest + 1e-6, &[]),
        Certification::Collides { .. }
    ));
    // 0.1 rad of either arm is 0.1 m of its ball at most, of both 0.2 m.
    assert!(certify(nearest - 0.21, &[0.1, 0.1]).is_clear());
    assert!(matches!(
        certify(nearest - 0.19, &[0.1, 0.1]),
        Certification::Undecided { .. }
    ));
}

#[test]
fn overlap_is_measured_as_depth() {
    let model = CollisionModel::new(&carousel(0.1), &CollisionOptions::default()).unwrap();
    let wave = swing(0.6, 0.65);
    let found = model.minimum_clearance(&wave, 1e-6).unwrap();
    let nearest = 2.0 * f64::sin(0.025) - 0.2;
    assert!(
        (found.at.distance - nearest).abs() < 1e-6,
        "{found:?} {nearest}"
    );
    let Certification::Collides { witness, .. } = model.certify(&wave, 0.0, &[]).unwrap() else {
        panic!("it touches");
    };
    assert!(witness.distance <= 0.0 && witness.pair == ("one".into(), "two".into()));
}

#[test]
fn scenes_and_padding_are_kept_clear_of() {
    let robot = carousel(0.1);
    let wall = |offset: f64| {
        let shape = SceneShape::HalfSpace(HalfSpace::new(nalgebra::Vector3::x(), offset).unwrap());
        let post = SceneShape::Solid(
            Shape::Cylinder {
                radius: 0.05,
                length: 4.0,
            },
            nalgebra::Isometry3::translation(1.5, 0.0, 0.0),
        );
        let objects =
            [("wall", shape), ("post of a lamp", post)].map(|(name, shape)| SceneObject {
                name: name.to_owned(),
                shape,
            });
        Scene::new(objects.to_vec()).unwrap()
    };
    // The second arm stands at pi / 2, the first swings between -0.5 and 0.5: x of its ball is cos 0.5 at least.
    let wave = swing(0.5, std::f64::consts::FRAC_PI_2);
    let with = |offset: f64, padding: f64| {
        let options = CollisionOptions {
            scene: wall(offset),
            padding,
            ..CollisionOptions::default()
        };
        CollisionModel::new(&robot, &options).unwrap()
    };
    // Behind the wall is x <= offset; the second arm's ball is at x = 0.
    let found = with(-0.5, 0.0).minimum_clearance(&wave, 1e-6).unwrap();
    // To the post of the lamp: 1.5 - 1 - 0.1 - 0.05.
    assert!((found.at.distance - 0.35).abs() < 1e-6, "{found:?}");
    assert_eq!(found.at.pair, ("post of a lamp".into(), "one".into()));
    assert!(found.at.is_with_scene);
    let found = with(-0.3, 0.0).minimum_clearance(&wave, 1e-6).unwrap();
    assert!((found.at.distance - 0.2).abs() < 1e-6, "{found:?}");
    assert_eq!(found.at.pair, ("wall".into(), "two".into()));
    let padded = with(-0.3, 0.15).minimum_clearance(&wave, 1e-6).unwrap();
    assert!((padded.at.distance - 0.05).abs() < 1e-6, "{padded:?}");
    assert!(
        !with(-0.3, 0.25)
            .certify(&wave, 0.0, &[])
            .unwrap()
            .is_clear()
    );
}

#[test]
fn pairs_say_why_they_are_checked() {
    let robot = shipped::robot("wave_arm").unwrap();
    let base = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
    let (a, b) = base
        .pairs()
        .iter()
        .find(|p| p.is_checked())
        .unwrap()
        .names
        .clone();
    let status = |options: &CollisionOptions| {
        let model = CollisionModel::new(&robot, options).unwrap();
        let pair = model
            .pairs()
            .iter()
            .find(|p| p.names == (a.clone(), b.clone()))
            .unwrap();
        pair.status.to_string()
    };
    let disabled = vec![(b.clone(), a.clone(), Some("Never".to_owned()))];
    let left_out = vec![(b.clone(), a.clone())];
    let default = CollisionOptions::default;
    assert_eq!(
        status(&CollisionOptions {
            disabled: disabled.clone(),
            ..default()
        }),
        "disabled by an SRDF: Never"
    );
    assert_eq!(
        status(&CollisionOptions {
            left_out: left_out.clone(),
            ..default()
        }),
        "left out by the caller"
    );
    assert_eq!(
        status(&CollisionOptions {
            disabled,
            kept: left_out,
            ..default()
        }),
        "checked"
    );
    // Of the other pairs an SRDF says nothing by that.
    let options = CollisionOptions {
        disabled: vec![(a.clone(), b.clone(), None)],
        ..default()
    };
    let model = CollisionModel::new(&robot, &options).unwrap();
    let changed = model.pairs().iter().zip(base.pairs());
    let changed: Vec<_> = changed
        .filter(|(now, before)| now.status != before.status)
        .map(|(now, _)| now.names.clone())
        .collect();
    assert_eq!(changed, [(a.clone(), b.clone())]);
    let unknown = CollisionOptions {
        left_out: vec![("ghost".to_owned(), a)],
        ..default()
    };
    let error = CollisionModel::new(&robot, &unknown)
        .err()
        .unwrap()
        .to_string();
    assert!(error.contains("no link or object `ghost`"), "{error}");
}

#[test]
fn a_configuration_has_the_clearance_of_its_chord_less_the_padding() {
    let options = CollisionOptions {
        padding: 0.15,
        ..CollisionOptions::default()
    };
    let found = CollisionModel::new(&carousel(0.1), &options)
        .unwrap()
        .clearance(&[0.0, 1.0])
        .unwrap();
    let chord = 2.0 * f64::sin(0.5) - 0.2;
    assert!(
        (found.distance - (chord - 0.15)).abs() < ROUNDING,
        "{found:?}"
    );
}

#[test]
fn what_touches_now_and_then_touches_neither_always_nor_never() {
    let contacts = |radius: f64| {
        let robot = carousel(radius);
        let model = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
        let mut contacts = model.pair_contacts(&robot, 200, 0).unwrap();
        assert_eq!(contacts.len(), 1);
        contacts.remove(0)
    };
    let (small, some, large) = (contacts(1e-6), contacts(0.5), contacts(1.1));
    assert!(small.never() && !small.always(), "{small:?}");
    assert!(!some.never() && !some.always(), "{some:?}");
    assert!(!large.never() && large.always(), "{large:?}");
}

#[test]
fn every_pair_that_an_srdf_disables_and_that_touches_is_told() {
    let robot = carousel(0.1);
    let scene = |offset: f64| {
        let shape = SceneShape::HalfSpace(HalfSpace::new(nalgebra::Vector3::x(), offset).unwrap());
        let name = "wall".to_owned();
        Scene::new(vec![SceneObject { name, shape }]).unwrap()
    };
    let disabled = [("one", "two"), ("wall", "one"), ("wall", "two")]
        .map(|(a, b)| (a.to_owned(), b.to_owned(), None));
    // The first arm swings to 0.6 about the x axis and into the second at 0.65, which is behind a wall that ends at x = 0.75 with the first or without.
    let told = |offset: f64| {
        let options = CollisionOptions {
            scene: scene(offset),
            disabled: disabled.to_vec(),
            ..CollisionOptions::default()
        };
        let model = CollisionModel::new(&robot, &options).unwrap();
        let found = model.disabled_collisions(&swing(0.6, 0.65)).unwrap();
        let mut pairs: Vec<_> = found.into_iter().map(|moment| moment.pair).collect();
        pairs.sort();
        pairs
    };
    let named = |pairs: &[(&str, &str)]| -> Vec<(String, String)> {
        let named = pairs.iter().map(|(a, b)| (a.to_string(), b.to_string()));
        named.collect()
    };
    assert_eq!(told(-2.0), named(&[("one", "two")]));
    assert_eq!(told(0.7), named(&[("one", "two"), ("wall", "two")]));
    let all = named(&[("one", "two"), ("wall", "one"), ("wall", "two")]);
    assert_eq!(told(0.75), all);
}

#[test]
fn a_collision_within_a_tolerance_is_told_as_one() {
    let model = CollisionModel::new(&carousel(0.1), &CollisionOptions::default()).unwrap();
    // The balls are deep in each other, and it takes no tolerance.
    let wave = swing(0.6, 0.65);
    for tolerance in [1e-3, 0.05, 0.5] {
        let found = model.certify(&wave, 0.0, &[tolerance; 2]).unwrap();
        let Certification::Collides { witness, .. } = found else {
            panic!("{tolerance}: {found:?}");
        };
        assert!(witness.distance <= 0.0);
    }
    // Clear by itself, and not within the tolerance: undecided, and not after millions of intervals.
    let wave = swing(0.6, 1.0);
    let Certification::Undecided { work, .. } = model.certify(&wave, 0.0, &[0.2; 2]).unwrap()
    else {
        panic!("0.2 rad is more than there is between");
    };
    assert!(work.intervals < 1000, "{work:?}");
}

#[test]
fn one_link_with_a_shape_is_kept_clear_of_a_scene() {
    let urdf = r#"<robot name="lamp"><link name="base"/><link name="arm">
        <collision><origin xyz="1 0 0"/><geometry><sphere radius="0.1"/></geometry></collision></link>
        <joint name="hinge" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/></joint></robot>"#;
    let robot = Robot::from_urdf(urdf).unwrap();
    let alone = CollisionModel::new(&robot, &CollisionOptions::default());
    let error = alone.err().unwrap().to_string();
    assert!(
        error.contains("a single body has collision shapes"),
        "{error}"
    );
    let table = HalfSpace::new(nalgebra::Vector3::z(), -0.5).unwrap();
    let options = CollisionOptions {
        scene: Scene::new(vec![SceneObject {
            name: "table".to_owned(),
            shape: SceneShape::HalfSpace(table),
        }])
        .unwrap(),
        ..CollisionOptions::default()
    };
    let model = CollisionModel::new(&robot, &options).unwrap();
    // Down to sin 0.2 below its axis.
    let weights = nalgebra::DMatrix::from_element(1, 1, undulate::num_complex::Complex::from(0.1));
    let offsets = nalgebra::DVector::zeros(1);
    let wave = Wave::new(robot.joints().clone(), 2.0, offsets, weights).unwrap();
    let found = model.minimum_clearance(&wave, 1e-6).unwrap();
    assert!(
        (found.at.distance - (0.4 - f64::sin(0.2))).abs() < 1e-6,
        "{found:?}"
    );
}

#[test]
fn links_that_meet_at_joints_far_apart_are_kept_apart() {
    // Two joints and no shape between torso and hand: in each other at rest they are a wrist, and apart an arm that can reach back.
    let arm = |length: f64| {
        let urdf = format!(
            r#"<robot name="reach"><link name="torso"><collision><geometry><sphere radius="0.2"/></geometry></collision></link>
            <link name="upper"/><link name="hand"><collision><origin xyz="{length} 0 0"/><geometry><sphere radius="0.05"/></geometry></collision></link>
            <joint name="shoulder" type="continuous"><parent link="torso"/><child link="upper"/><origin xyz="{length} 0 0"/><axis xyz="0 0 1"/></joint>
            <joint name="elbow" type="continuous"><parent link="upper"/><child link="hand"/><axis xyz="0 0 1"/></joint></robot>"#
        );
        let robot = Robot::from_urdf(&urdf).unwrap();
        let model = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
        model.pairs()[0].status.clone()
    };
    assert_eq!(arm(0.3), PairStatus::Checked);
    assert_eq!(arm(0.1), PairStatus::Adjacent);
}

#[test]
fn wishes_of_pairs_that_cannot_be_are_refused() {
    let robot = shipped::robot("wave_arm").unwrap();
    let names = |a: &str, b: &str| (a.to_owned(), b.to_owned());
    let base = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
    let of = |is: fn(&PairStatus) -> bool| {
        let pair = base.pairs().iter().find(|p| is(&p.status));
        pair.expect("the arm has such a pair").names.clone()
    };
    let rigid = of(|status| matches!(status, PairStatus::Rigid { .. }));
    let adjacent = of(|status| *status == PairStatus::Adjacent);
    let refused = |options: CollisionOptions, why: &str| {
        let error = CollisionModel::new(&robot, &options).err().unwrap();
        assert!(error.to_string().contains(why), "{error}");
    };
    let kept = |pair: &(String, String)| CollisionOptions {
        kept: vec![pair.clone()],
        ..CollisionOptions::default()
    };
    let padded = |pair: &(String, String)| CollisionOptions {
        pair_padding: vec![(pair.clone(), 0.01)],
        ..CollisionOptions::default()
    };
    refused(kept(&rigid), "no joint lies between them");
    refused(padded(&adjacent), "the pair is not checked (adjacent)");
    refused(kept(&names("hand", "hand")), "no two links");
    // Checked by choice, it takes a padding.
    let both = CollisionOptions {
        kept: vec![adjacent.clone()],
        ..padded(&adjacent)
    };
    assert!(CollisionModel::new(&robot, &both).is_ok());
}

#[test]
fn no_speed_keeps_a_search_going_for_ever() {
    let model = CollisionModel::new(&carousel(0.1), &CollisionOptions::default()).unwrap();
    for size in [1e9, 1e50] {
        let found = model.minimum_clearance(&swing(size, 1.0), 1e-4).unwrap();
        assert!(found.lower < found.at.distance, "{found:?}");
        assert!(found.work.intervals <= 600_000, "{:?}", found.work);
    }
}

#[test]
fn what_overflows_proves_nothing() {
    // A slider that may go as far as numbers do, and an arm that turns through the table by as much as numbers allow.
    let urdf = r#"<robot name="far"><link name="base"/><link name="slide"/>
        <link name="arm"><collision><origin xyz="1 0 0"/><geometry><sphere radius="0.1"/></geometry></collision></link>
        <joint name="slider" type="prismatic"><parent link="base"/><child link="slide"/><axis xyz="1 0 0"/>
        <limit lower="-1.7e308" upper="1.7e308" effort="1" velocity="1"/></joint>
        <joint name="hinge" type="continuous"><parent link="slide"/><child link="arm"/><axis xyz="0 1 0"/></joint>
        <link name="foot"><collision><geometry><sphere radius="0.05"/></geometry></collision></link>
        <joint name="fixed" type="fixed"><parent link="base"/><child link="foot"/></joint></robot>"#;
    let robot = Robot::from_urdf(urdf).unwrap();
    let table = SceneShape::HalfSpace(HalfSpace::new(nalgebra::Vector3::z(), -0.2).unwrap());
    let options = CollisionOptions {
        scene: Scene::new(vec![SceneObject {
            name: "table".to_owned(),
            shape: table,
        }])
        .unwrap(),
        ..CollisionOptions::default()
    };
    let model = CollisionModel::new(&robot, &options).unwrap();
    for size in [1.0, 1e14, 1e50, 1e100] {
        let mut weights = nalgebra::DMatrix::zeros(2, 1);
        weights[(1, 0)] = undulate::num_complex::Complex::new(size / 2.0, 0.0);
        let offsets = nalgebra::DVector::zeros(2);
        let wave = Wave::new(robot.joints().clone(), 2.0, offsets, weights).unwrap();
        assert!(
            !model.certify(&wave, 0.0, &[]).unwrap().is_clear(),
            "{size}"
        );
    }
}

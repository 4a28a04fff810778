//! Strategies about robots draw what they say, and shrink to what they say.

use std::cell::Cell;

use proptest::prelude::*;
use proptest::test_runner::{Config, TestError, TestRng, TestRunner};
use undulate::testing::{
    Arm, Format, arms, configurations, hostile, moves, scene_texts, scenes, trees, waypoints,
};
use undulate::{
    CollisionModel, CollisionOptions, MoveOptions, Robot, Scene, SceneShape, Shape, Waypoints,
    shipped,
};

fn config() -> Config {
    Config {
        cases: 64,
        failure_persistence: None,
        ..Config::default()
    }
}

/// What a property that fails shrinks to.
fn counterexample<S: Strategy>(strategy: S, fails: impl Fn(&S::Value) -> bool) -> S::Value {
    let rng = TestRng::deterministic_rng(Default::default());
    let outcome = TestRunner::new_with_rng(config(), rng).run(&strategy, |value| {
        prop_assert!(!fails(&value));
        Ok(())
    });
    match outcome {
        Err(TestError::Fail(_, value)) => value,
        other => panic!("{other:?}"),
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn arms_are_chains_that_collide_and_have_dynamics(arm in arms(1..=8)) {
        let joints = arm.joints().len();
        prop_assert!((1..=8).contains(&joints));
        prop_assert_eq!(arm.bodies().len(), joints + 1);
        prop_assert!(arm.bodies().iter().skip(1).enumerate().all(|(i, body)| body.parent == i));
        prop_assert!(arm.bodies().iter().all(|body| body.collision.len() == 1));
        arm.require_dynamics()?;
        CollisionModel::new(arm.robot(), &CollisionOptions::default())?;
        let again = Robot::from_urdf(arm.urdf())?;
        prop_assert_eq!(again.joints(), arm.joints());
    }

    #[test]
    fn configurations_are_within_limits(
        (arm, q) in arms(1..=6).prop_flat_map(|arm| {
            let q = configurations(arm.robot());
            (Just(arm), q)
        })
    ) {
        prop_assert_eq!(q.len(), arm.joints().len());
        for (j, q) in q.iter().enumerate() {
            let within = arm.properties(j).position.map_or(q.abs() <= std::f64::consts::PI, |range| range.contains(*q));
            prop_assert!(within);
        }
    }

    #[test]
    fn scenes_are_read(text in scene_texts(0..=6)) {
        let scene = Scene::from_toml(&text)?;
        prop_assert_eq!(scene.objects().len(), text.matches("[[object]]").count());
    }

    #[test]
    fn moves_are_read_as_they_were(waypoints in waypoints(1..=3, 2..=5)) {
        let read = Waypoints::read("move.csv", &waypoints.to_csv()?, &MoveOptions::default())?;
        prop_assert_eq!(read, waypoints);
    }

    #[test]
    fn moves_of_all_formats_are_read(
        (format, text) in prop::sample::select(vec![Format::Csv, Format::Json, Format::Yaml])
            .prop_flat_map(|format| (Just(format), moves(format, 1..=3, 2..=5)))
    ) {
        Waypoints::read(format.file(), text.as_bytes(), &MoveOptions::default())?;
    }
}

#[test]
fn arms_shrink_to_one_joint_about_z_and_long_ones_to_straight_ones() {
    let arm = counterexample(arms(1..=8), |_| true);
    assert_eq!(arm.joints().len(), 1);
    assert_eq!(arm.joint(0).axis.as_slice(), [0.0, 0.0, 1.0]);
    assert!(format!("{arm:?}").contains("<axis xyz=\"0 0 1\"/>"));

    let is_long = |arm: &Arm| arm.joints().len() >= 3;
    let arm = counterexample(arms(1..=8), is_long);
    assert_eq!(arm.joints().len(), 3);
    // Straight: the last link's frame stands upright over the first.
    let poses = arm.link_poses(&arm.rest());
    let pose = poses.last().unwrap();
    assert!(pose.rotation.angle() < 1e-12, "{pose}");
    assert!(pose.translation.vector.xy().norm() < 1e-12, "{pose}");
}

#[test]
fn configurations_shrink_to_rest() {
    let robot = shipped::robot("wave_arm").unwrap();
    assert_eq!(
        counterexample(configurations(&robot), |_| true),
        robot.rest()
    );
}

#[test]
fn scenes_shrink_to_a_half_space_and_those_of_solids_to_a_sphere() {
    let scene = counterexample(scenes(1..=5), |_| true);
    assert_eq!(scene.objects().len(), 1);
    assert!(matches!(scene.objects()[0].shape, SceneShape::HalfSpace(_)));
    let solid = |scene: &Scene| {
        let shapes = scene.objects().iter();
        shapes
            .map(|o| &o.shape)
            .any(|s| matches!(s, SceneShape::Solid(..)))
    };
    let scene = counterexample(scenes(1..=5), solid);
    let [object] = scene.objects() else {
        panic!("{scene:?}")
    };
    let SceneShape::Solid(Shape::Sphere { .. }, pose) = &object.shape else {
        panic!("{object:?}")
    };
    assert_eq!(pose.translation.vector.norm(), 0.0);
}

/// No reader panics, and each refuses some: a reader that takes all would not read.
#[test]
fn hostile_texts_are_refused_by_errors() {
    fn refused(texts: impl Strategy<Value = String>, read: impl Fn(&str) -> bool) -> usize {
        let refused = Cell::new(0);
        let rng = TestRng::deterministic_rng(Default::default());
        TestRunner::new_with_rng(config(), rng)
            .run(&hostile(texts), |text| {
                refused.set(refused.get() + usize::from(!read(&text)));
                Ok(())
            })
            .unwrap();
        refused.get()
    }
    let urdf = |text: &str| Robot::from_urdf(text).is_ok();
    assert!(refused(trees(1..=3), urdf) > 0);
    assert!(refused(arms(1..=3).prop_map(|arm| arm.urdf().to_owned()), urdf) > 0);
    assert!(refused(scene_texts(1..=3), |text| Scene::from_toml(text).is_ok()) > 0);
    for format in [Format::Csv, Format::Json, Format::Yaml] {
        let read = |text: &str| {
            Waypoints::read(format.file(), text.as_bytes(), &MoveOptions::default()).is_ok()
        };
        assert!(refused(moves(format, 1..=3, 2..=4), read) > 0);
    }
}

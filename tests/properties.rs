//! Properties of a robot's motions hold where they hold, and where they do not they say which joint or pair, when, by how much and what was allowed.

use std::panic::{AssertUnwindSafe, catch_unwind};

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use proptest::test_runner::{Config, TestRunner};
use undulate::testing::{
    Seed, fails_at_most, fails_rarely, keeps_clear, keeps_limits, seeds, tracks_within,
};
use undulate::{
    CollisionModel, CollisionOptions, Control, Error, FourierMovementPrimitive, Reason, Robot,
    Simulation, SimulationOptions, Wave, synthetic,
};

/// A pole that a hinge swings by its foot through 1 rad to either side, and a post behind it. At 0.1 N m s/rad.
const URDF: &str = r#"<robot name="gate">
    <link name="ground"/>
    <link name="post"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
    <joint name="foot" type="fixed"><parent link="ground"/><child link="post"/><origin xyz="-1 0 0"/></joint>
    <link name="pole">
        <inertial><origin xyz="0 0 1"/><mass value="2"/>
            <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
        <collision><origin xyz="0 0 1"/><geometry><sphere radius="0.1"/></geometry></collision>
    </link>
    <joint name="hinge" type="revolute"><parent link="ground"/><child link="pole"/><axis xyz="0 1 0"/>
        <limit lower="-1" upper="1" velocity="4" effort="30"/><dynamics damping="0.1"/></joint>
</robot>"#;

fn gate() -> Robot {
    Robot::from_urdf(URDF).unwrap()
}

/// offset + amplitude cos(2 pi t / period)
fn swing(offset: f64, amplitude: f64, period: f64) -> Wave {
    let weights = DMatrix::from_element(1, 1, Complex::from(amplitude / 2.0));
    let offsets = DVector::from_element(1, offset);
    Wave::new(gate().joints().clone(), period, offsets, weights).unwrap()
}

fn told(error: &Error, words: &[&str]) {
    let text = error.to_string();
    assert!(words.iter().all(|word| text.contains(word)), "{text}");
}

#[test]
fn limits_are_kept_or_named() {
    let robot = gate();
    keeps_limits(&robot, &swing(0.1, 0.8, 3.0)).unwrap();
    let error = keeps_limits(&robot, &swing(0.1, -1.2, 2.0)).unwrap_err();
    assert_eq!(error.reason(), Some(Reason::PositionLimit));
    told(&error, &["hinge", "1.3000 at 1.000 s", "-1.0000 .. 1.0000"]);
    // 0.8 rad at 0.8 Hz is just faster than 4 rad/s, and takes 2 kg m^2 of 20 rad/s^2.
    let error = keeps_limits(&robot, &swing(0.0, 0.8, 1.25)).unwrap_err();
    assert_eq!(error.reason(), Some(Reason::VelocityLimit));
    told(
        &error,
        &[
            "velocity-limit: hinge reaches",
            "4.0212",
            "effort-limit: hinge takes",
        ],
    );
    // A robot without masses has no efforts, and is held to what else there is.
    let (massive, massless) = (URDF.find("<inertial>"), URDF.find("</inertial>"));
    let mut urdf = URDF.to_owned();
    urdf.replace_range(massive.unwrap()..massless.unwrap() + 11, "");
    let robot = Robot::from_urdf(&urdf).unwrap();
    keeps_limits(&robot, &swing(0.0, 0.7, 1.25)).unwrap();
    keeps_limits(&gate(), &swing(0.0, 0.7, 1.25)).unwrap_err();
}

#[test]
fn clearance_is_proven_or_the_pair_is_named() {
    let model = CollisionModel::new(&gate(), &CollisionOptions::default()).unwrap();
    // A quarter turn from the post: 2 sin(angle between them / 2) less both radii.
    let wave = swing(0.0, 0.5, 2.0);
    let nearest = 2.0 * ((std::f64::consts::FRAC_PI_2 - 0.5) / 2.0).sin() - 0.2;
    keeps_clear(&model, &wave, nearest - 1e-6).unwrap();
    let error = keeps_clear(&model, &wave, nearest + 1e-3).unwrap_err();
    assert_eq!(error.reason(), Some(Reason::Clearance));
    let margin = format!("expected more than {} m", nearest + 1e-3);
    told(&error, &["post and pole are", "m apart at", &margin]);
    let error = keeps_clear(&model, &swing(0.0, 1.5, 2.0), 0.0).unwrap_err();
    assert_eq!(error.reason(), Some(Reason::SelfCollision));
}

#[test]
fn tracking_is_within_a_tolerance_or_the_joint_is_named() {
    let robot = gate();
    let with = |control| {
        let options = SimulationOptions {
            control,
            ..SimulationOptions::default()
        };
        Simulation::new(&robot, options).unwrap()
    };
    let wave = swing(0.0, 0.3, 2.0);
    tracks_within(&with(Control::FeedForward), &wave, 1e-3).unwrap();
    let error = tracks_within(&with(Control::Feedback), &wave, 1e-3).unwrap_err();
    told(
        &error,
        &["joint `hinge`", "at ", " s: off by ", "at most 0.001 rad"],
    );
    // As far as it says, and no farther.
    let off = with(Control::Feedback).run(&wave).unwrap().tolerance()[0];
    told(&error, &[&format!("{off:.6}")]);
    tracks_within(&with(Control::Feedback), &wave, off).unwrap();
}

#[test]
fn rare_failures_are_demonstrated_and_frequent_ones_told_with_the_first() {
    let primitive = FourierMovementPrimitive::learn(&synthetic(0).unwrap(), 4).unwrap();
    let elbow = primitive.chart().joints().index("elbow_flexion").unwrap();
    let mean = primitive.mean_wave().offsets()[elbow];
    let is_high = |wave: &Wave| match wave.offsets()[elbow] > mean {
        true => Err(Error::new(undulate::ErrorKind::Infeasible, "a high elbow")),
        false => Ok(()),
    };
    // One half of them are.
    fails_rarely(&primitive, 0.6, 0.99, 1000, Seed(3), is_high).unwrap();
    let failures = fails_rarely(&primitive, 0.4, 0.99, 1000, Seed(3), is_high).unwrap_err();
    let (draw, why) = failures.first.clone().unwrap();
    let again = |k| rand::distr::Distribution::sample(&primitive, &mut Seed(3).stream(k));
    assert_eq!(is_high(&again(draw)).unwrap_err(), why);
    assert!((0..draw).all(|k| is_high(&again(k)).is_ok()));
    let text = failures.to_string();
    assert!(text.contains("seed 3"), "{text}");
    let count = (0..1000).filter(|k| is_high(&again(*k)).is_err()).count();
    let told = format!("; {count} draws fail, draw {draw} first: a high elbow");
    assert!(text.ends_with(&told), "{text}");
}

/// What is printed when a property fails is what the one-liner says, and a seed stays.
#[test]
fn proptest_takes_their_errors() {
    let config = Config {
        cases: 32,
        failure_persistence: None,
        ..Config::default()
    };
    let mut runner = TestRunner::new_with_rng(config, TestRunner::deterministic().new_rng());
    let robot = gate();
    let outcome = runner.run(&(0.0..3.0, seeds()), |(amplitude, seed)| {
        fails_at_most(0.5, 0.9, 20, seed, |_| false)?;
        keeps_limits(&robot, &swing(0.0, amplitude, 10.0))?;
        Ok(())
    });
    let text = outcome.unwrap_err().to_string();
    assert!(text.contains("position-limit: hinge reaches"), "{text}");
}

#[test]
fn wrong_arguments_are_named() {
    let names = |argument: &str, call: &dyn Fn()| {
        let panic = catch_unwind(AssertUnwindSafe(call)).expect_err(argument);
        let message = panic.downcast::<String>().unwrap();
        assert!(message.starts_with(argument), "{argument}: {message}");
    };
    let robot = gate();
    let model = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
    let simulation = Simulation::new(&robot, SimulationOptions::default()).unwrap();
    let wave = swing(0.0, 0.1, 2.0);
    for wrong in [-1e-9, f64::NAN, f64::INFINITY] {
        names("margin", &|| drop(keeps_clear(&model, &wave, wrong)));
        names("tolerance", &|| {
            drop(tracks_within(&simulation, &wave, wrong))
        });
    }
    let joints = undulate::Joints::new(["other"]).unwrap();
    let (offsets, weights) = (wave.offsets().clone(), wave.weights().clone());
    let other = Wave::new(joints, 2.0, offsets, weights).unwrap();
    names("motion", &|| drop(keeps_limits(&robot, &other)));
    names("motion", &|| drop(keeps_clear(&model, &other, 0.0)));
    names("motion", &|| drop(tracks_within(&simulation, &other, 0.1)));
    names("trials", &|| {
        drop(fails_at_most(0.01, 0.99, 100, Seed(0), |_| panic!("asked")))
    });
    names("p =", &|| {
        drop(fails_at_most(1.0, 0.99, 100, Seed(0), |_| false))
    });
    names("confidence", &|| {
        drop(fails_at_most(0.1, 0.0, 100, Seed(0), |_| false))
    });
}

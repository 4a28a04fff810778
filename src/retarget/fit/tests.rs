//! Fits against waves that are known.

use super::*;
use crate::anatomy::ShoulderOrder;
use crate::fourier::Joints;

/// Robots and what of them points, of other axes each.
const ROBOTS: [[&str; 2]; 3] = [
    [
        include_str!("../../../robots/wave_arm.urdf"),
        include_str!("../../../robots/wave_arm_directions.toml"),
    ],
    [
        include_str!("../../../robots/column_arm.urdf"),
        include_str!("../../../robots/column_arm_directions.toml"),
    ],
    [
        include_str!("../../../robots/table_arm.urdf"),
        include_str!("../../../robots/table_arm_directions.toml"),
    ],
];

/// Waves that are recovered, of each robot.
const WAVES: usize = 8;

/// A person who waves from the elbow, by seven angles.
fn person() -> Person {
    let joints: [(&str, f64, f64); 7] = [
        ("shoulder_flexion", 40.0, 4.0),
        ("shoulder_abduction", 50.0, 5.0),
        ("shoulder_rotation", -60.0, 9.0),
        ("elbow_flexion", 100.0, 14.0),
        ("forearm_pronation", -10.0, 6.0),
        ("wrist_flexion", -20.0, 3.0),
        ("wrist_deviation", 5.0, 10.0),
    ];
    let offsets = joints.iter().map(|j| j.1.to_radians());
    let weights = DMatrix::from_fn(7, 2, |j, k| {
        let modulus = joints[j].2.to_radians() / 2.0 / (1.0 + 4.0 * k as f64);
        Complex::from_polar(modulus, j as f64 + 2.0 * k as f64)
    });
    let wave = Wave::new(
        Joints::new(joints.map(|j| j.0)).unwrap(),
        0.7,
        DVector::from_iterator(7, offsets),
        weights,
    );
    Person::new(wave.unwrap(), ShoulderOrder::Xzy).unwrap()
}

/// The fit to where a robot's own wave makes its arm point.
fn recovered(arm: &RobotArm, robot: &Robot, wave: &Wave) -> DirectionFit {
    let pointers = arm.on(robot).unwrap();
    let targets = |t: f64| arm.directions(robot, wave.position(t).as_slice()).unwrap();
    let k = wave.harmonics();
    let fit = Fit::new(robot, &pointers, wave.period(), k, k, &targets).unwrap();
    fit.run().unwrap()
}

#[test]
fn a_wave_of_the_robot_itself_is_recovered() {
    for [urdf, arm] in ROBOTS {
        let robot = Robot::from_urdf(urdf).unwrap();
        let arm = RobotArm::from_toml(arm).unwrap();
        let name = robot.name();
        let d = robot.joints().len();
        for number in 0..WAVES {
            // Postures and phases by fractions of an irrational number, within the middle of the limits.
            let share = |i: usize| (0.618_033_988_75 * (1 + i + 40 * number) as f64).fract();
            let offsets = DVector::from_fn(d, |j, _| {
                let limit = robot.properties(j).position.unwrap();
                let near = Interval::within(2.0).intersect(limit);
                near.lower + near.width() * (0.2 + 0.6 * share(j))
            });
            let weights = DMatrix::from_fn(d, 2, |j, k| {
                let phase = std::f64::consts::TAU * share(7 + j + 10 * k);
                Complex::from_polar(0.06 / (1.0 + k as f64), phase)
            });
            let wave = Wave::new(robot.joints().clone(), 1.3, offsets, weights).unwrap();
            let fit = recovered(&arm, &robot, &wave);
            for residual in &fit.residuals {
                assert!(residual.peak < 1e-6, "{name} {number}: {residual:?}");
                assert!(residual.rms <= residual.peak);
            }
        }
    }
}

#[test]
fn joints_that_move_nothing_that_points_are_at_rest_and_a_slider_has_its_share() {
    let robot = super::super::arm::tests::robot();
    let arm = RobotArm::from_toml("[hand]\nfrom = 'fore'\nto = 'tip'").unwrap();
    let wave = Wave::new(
        robot.joints().clone(),
        1.0,
        nalgebra::dvector![0.3, -0.2, 0.02],
        DMatrix::from_fn(3, 1, |j, _| Complex::new(0.02, 0.01 * j as f64)),
    )
    .unwrap();
    let fit = recovered(&arm, &robot, &wave);
    assert!(fit.residuals[0].peak < 1e-6, "{fit:?}");
    // A hand of the upper arm alone: elbow and slider have no part in it.
    let arm = RobotArm::from_toml("[hand]\nlink = 'upper'\naxis = [1, 0, 0]").unwrap();
    let fit = recovered(&arm, &robot, &wave);
    assert!(fit.residuals[0].peak < 1e-6);
    let range = |j| fit.wave.range(j, Derivative::Position);
    assert!(range(0).width() > 0.05);
    for joint in [1, 2] {
        assert!(range(joint).magnitude() < 1e-12);
    }
    let base = RobotArm::from_toml("[hand]\nlink = 'base'\naxis = [1, 0, 0]").unwrap();
    let error = base.fit(&person(), &robot, 2).unwrap_err();
    assert!(error.to_string().contains("no joint moves"), "{error}");
    for harmonics in [0, 61] {
        assert!(arm.fit(&person(), &robot, harmonics).is_err());
    }
}

#[test]
fn what_limits_forbid_is_left_and_told() {
    // An elbow that can bend to 60 degrees only, and the person's is at 100 +- 14.
    let [text, arm] = ROBOTS[0];
    let elbow = r#"<limit lower="-0.05" upper="2.6""#;
    assert!(text.contains(elbow));
    let text = text.replace(elbow, r#"<limit lower="-0.05" upper="1.0471975511965976""#);
    let robot = Robot::from_urdf(&text).unwrap();
    let arm = RobotArm::from_toml(arm).unwrap();
    let fit = arm.fit(&person(), &robot, 2).unwrap();
    assert!(
        fit.at_limit.contains(&"elbow".to_owned()),
        "{:?}",
        fit.at_limit
    );
    let worst = fit.residuals.iter().map(|r| r.peak).fold(0.0, f64::max);
    assert!(worst > 20f64.to_radians(), "{:?}", fit.residuals);
    for (j, limit) in limits(&robot).iter().enumerate() {
        let range = fit.wave.range(j, Derivative::Position);
        let limit = limit.unwrap();
        assert!(limit.lower <= range.lower && range.upper <= limit.upper);
    }
    // The same again, bit for bit.
    assert_eq!(fit, arm.fit(&person(), &robot, 2).unwrap());
}

#[test]
fn limits_of_joints_that_mimic_hold_too() {
    let robot = Robot::from_urdf(
        r#"<robot name="r"><link name="a"/><link name="b"/><link name="c"/>
        <joint name="one" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1"/></joint>
        <joint name="two" type="revolute"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/><limit lower="-1" upper="0.5" velocity="1"/><mimic joint="one" multiplier="-2" offset="0.1"/></joint></robot>"#,
    )
    .unwrap();
    let limit = limits(&robot)[0].unwrap();
    assert!((limit.lower + 0.2).abs() < 1e-15 && (limit.upper - 0.55).abs() < 1e-15);
}

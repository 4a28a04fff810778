//! What a file says of an arm, against what a robot does.

use nalgebra::{DVector, UnitQuaternion};

use super::*;

/// A shoulder that turns about z, an elbow that bends about y 0.3 m along x, a slider, and a flange.
pub(in crate::retarget) fn robot() -> Robot {
    Robot::from_urdf(
        r#"<robot name="r"><link name="base"/><link name="upper"/><link name="fore"/><link name="hand"/><link name="tip"/><link name="twin"/>
        <joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><origin xyz="0 0 1" rpy="0.3 -0.2 0.1"/><axis xyz="0 0 1"/></joint>
        <joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/><origin xyz="0.3 0 0"/><axis xyz="0 1 0"/><limit lower="-2" upper="2" velocity="1"/></joint>
        <joint name="slide" type="prismatic"><parent link="fore"/><child link="hand"/><origin xyz="0.2 0 0"/><axis xyz="0 0 1"/><limit lower="-0.1" upper="0.1" velocity="1"/></joint>
        <joint name="mount" type="fixed"><parent link="hand"/><child link="tip"/><origin xyz="0 0 0.1" rpy="1 2 3"/></joint>
        <joint name="same" type="fixed"><parent link="hand"/><child link="twin"/></joint></robot>"#,
    )
    .unwrap()
}

const ARM: &str = "forward = [0, 1, 0]\n[upper_arm]\nfrom = 'base'\nto = 'tip'\n[forearm]\nlink = 'upper'\naxis = [2, 0, 0]\n[palm]\nlink = 'tip'\naxis = [0, -1, 1]\nweight = 0.5";

#[test]
fn directions_turn_as_their_derivatives_say() {
    let robot = robot();
    let arm = RobotArm::from_toml(ARM).unwrap();
    let pointers = arm.on(&robot).unwrap();
    let mut kinematics = Kinematics::new(&robot);
    let mut rates = Matrix3xX::zeros(3);
    let q = [0.4, -0.7, 0.05];
    for pointer in &pointers {
        let direction = pointer.linearised(&robot, &mut kinematics, &q, &mut rates);
        assert!((direction.norm() - 1.0).abs() < 1e-15);
        for j in 0..3 {
            let at = |h: f64| {
                let mut q = q;
                q[j] += h;
                arm.directions(&robot, &q).unwrap()
            };
            let index = pointers
                .iter()
                .position(|p| p.segment == pointer.segment)
                .unwrap();
            let difference = (at(1e-5)[index] - at(-1e-5)[index]) / 2e-5;
            assert!((difference - rates.column(j)).norm() < 1e-9);
        }
    }
    // The palm's, through every frame of the file.
    let about = UnitQuaternion::from_euler_angles;
    let turned = about(0.3, -0.2, 0.1) * about(0.0, 0.0, q[0]) * about(0.0, q[1], 0.0);
    let expected = turned * about(1.0, 2.0, 3.0) * Vector3::new(0.0, -1.0, 1.0).normalize();
    let palm = pointers.iter().position(|p| p.segment == Segment::Palm);
    let found = arm.directions(&robot, &q).unwrap()[palm.unwrap()];
    assert!((found - expected).norm() < 1e-12, "{found}");
    // The slider changes where the tip is, not how the hand is turned.
    assert!(rates.column(2).norm() == 0.0 && rates.column(1).norm() > 0.1);
}

#[test]
fn a_person_stands_in_the_base_frame_as_the_file_says() {
    let text = |head: &str| format!("{head}\n[hand]\nlink = 'tip'\naxis = [1, 0, 0]");
    let columns = |head: &str| *RobotArm::from_toml(&text(head)).unwrap().to_base();
    let usual = columns("");
    // X left, Y up, Z forward, where x is forward, y left, z up.
    assert_eq!(usual, Matrix3::new(0., 0., 1., 1., 0., 0., 0., 1., 0.));
    assert_eq!(usual.determinant(), 1.0);
    let left = columns("side = 'left'");
    assert_eq!(left * Vector3::x(), -(usual * Vector3::x()));
    assert_eq!(left * Vector3::y(), usual * Vector3::y());
    // Up need not be at a right angle, and forward is kept.
    let hung = columns("forward = [0, 0, -3]\nup = [1, 0, 1]");
    assert!((hung * Vector3::z() + Vector3::z()).norm() < 1e-15);
    assert!((hung * Vector3::y() - Vector3::x()).norm() < 1e-15);
    assert!((hung.determinant() - 1.0).abs() < 1e-15);
}

#[test]
fn every_fault_is_named() {
    for (text, expected) in [
        ("", "nothing that points"),
        ("[thumb]\nlink = 'a'", "line 1: unknown field `thumb`"),
        ("[hand]\nlnk = 'a'", "unknown field `lnk`"),
        ("[hand]", "[hand]: no direction"),
        ("[hand]\nlink = 'a'", "[hand]: half a direction, or two"),
        ("[hand]\nfrom = 'a'\naxis = [1, 0, 0]", "half a direction"),
        ("[hand]\nlink = 'a'\naxis = [1, 0]", "line 3"),
        (
            "[palm]\nlink = 'a'\naxis = [0, 0, 0]",
            "[palm], axis: [0.0, 0.0, 0.0]",
        ),
        ("[palm]\nlink = 'a'\naxis = [0, nan, 1]", "[palm], axis"),
        ("[palm]\nlink = 'a'\naxis = [inf, 0, 0]", "[palm], axis"),
        (
            "[palm]\nlink = 'a'\naxis = [1, 0, 0]\nweight = 0",
            "weight = 0",
        ),
        (
            "[palm]\nlink = 'a'\naxis = [1, 0, 0]\nweight = inf",
            "weight = inf",
        ),
        (
            "side = 'up'\n[palm]\nlink = 'a'\naxis = [1, 0, 0]",
            "unknown variant `up`",
        ),
        (
            "forward = [0, 0, 2]\n[palm]\nlink = 'a'\naxis = [1, 0, 0]",
            "forward and up along one line",
        ),
        (
            "up = [0, 0, 0]\n[palm]\nlink = 'a'\naxis = [1, 0, 0]",
            "up: ",
        ),
    ] {
        let error = RobotArm::from_toml(text).unwrap_err();
        assert!(error.to_string().contains(expected), "{text:?}: {error}");
    }
    let robot = robot();
    for (text, expected) in [
        (
            "[hand]\nlink = 'wrist'\naxis = [1, 0, 0]",
            "[hand], robot `r`: no link `wrist`",
        ),
        ("[hand]\nfrom = 'base'\nto = 'wrist'", "no link `wrist`"),
        (
            "[hand]\nfrom = 'hand'\nto = 'twin'",
            "links `hand` and `twin` at one place",
        ),
        ("[hand]\nfrom = 'tip'\nto = 'tip'", "at one place"),
    ] {
        let arm = RobotArm::from_toml(text).unwrap();
        let error = arm.directions(&robot, &[0.0; 3]).unwrap_err();
        assert!(error.to_string().contains(expected), "{text:?}: {error}");
    }
    // Large and small numbers are directions like others.
    let arm = RobotArm::from_toml("[hand]\nlink = 'tip'\naxis = [1e-300, 0, 1e-300]").unwrap();
    let large = RobotArm::from_toml("[hand]\nlink = 'tip'\naxis = [1e300, 0, 1e300]").unwrap();
    let q = DVector::zeros(3);
    let [a, b] = [arm, large].map(|arm| arm.directions(&robot, q.as_slice()).unwrap()[0]);
    assert!((a - b).norm() < 1e-15);
}

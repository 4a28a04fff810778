//! Serial arms.

use std::fmt::{self, Write as _};
use std::ops::{Deref, RangeInclusive};

use proptest::collection::vec;
use proptest::prelude::*;

use super::super::argument::require_counts;
use super::tree::{numbers, origin};
use crate::robot::Robot;

/// A [`Robot`] that has been drawn, and its file, as which it prints.
#[derive(Clone)]
pub struct Arm {
    urdf: String,
    robot: Robot,
}

impl Arm {
    /// Its URDF.
    pub fn urdf(&self) -> &str {
        &self.urdf
    }

    /// The robot.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }
}

impl Deref for Arm {
    type Target = Robot;
    fn deref(&self) -> &Robot {
        &self.robot
    }
}

impl fmt::Debug for Arm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "an arm of {} joints:", self.robot.joints().len())?;
        f.write_str(&self.urdf)
    }
}

/// What one joint and the link that it moves are drawn as.
#[derive(Debug, Clone)]
struct Drawn {
    axis: [f64; 3],
    tilt: Option<[f64; 3]>,
    /// `None`: continuous.
    limits: Option<(f64, f64)>,
    velocity: f64,
    effort: f64,
    length: f64,
    radius: f64,
    density: f64,
}

/// Serial arms with so many revolute joints: a base, and links that are solid cylinders of 0.1 to 0.5 m along z, 2 to 6 cm in radius, as heavy as wood
/// to titanium (500 to 4500 kg/m^3), all of it collision geometry. Half of the axes are x, y or z, the others any; a third of the joints
/// are tilted, by up to 1 rad about each of x, y and z; limits lie 0.2 to 3 rad to either side of 0, one joint in ten has none; speeds up to 0.5 to 5 rad/s,
/// torques up to 20 to 200 N m. Joints are called `joint_0` to the tip, links `base` and `link_0` and so on. Every arm is valid and has dynamics;
/// bent ones may touch themselves. They shrink to fewer joints, axes along z, straight arms, joints without limits, and
/// dimensions at their least.
///
/// ```
/// use proptest::prelude::*;
/// use undulate::testing::arms;
///
/// proptest!(|(arm in arms(1..=8))| {
///     prop_assert!(arm.require_dynamics().is_ok());
///     prop_assert!(arm.urdf().contains("joint_0"));
/// });
/// ```
///
/// # Panics
/// When `joints` is an empty range or starts at 0.
#[track_caller]
pub fn arms(joints: RangeInclusive<usize>) -> impl Strategy<Value = Arm> {
    require_counts("joints", &joints, 1);
    let any_axis = prop::array::uniform3(-1.0..1.0f64).prop_map(|a| {
        // A short axis is replaced, not thrown away.
        let length = a.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length < 0.2 {
            [0.0, 0.0, 1.0]
        } else {
            a.map(|x| x / length)
        }
    });
    let axis = prop_oneof![
        1 => Just([0.0, 0.0, 1.0]),
        1 => Just([0.0, 1.0, 0.0]),
        1 => Just([1.0, 0.0, 0.0]),
        3 => any_axis,
    ];
    let tilt = prop::option::weighted(1.0 / 3.0, prop::array::uniform3(-1.0..1.0f64));
    let limits = prop::option::weighted(0.9, (0.2..3.0f64, 0.2..3.0f64));
    let joint = (axis, tilt, limits, 0.5..5.0f64, 20.0..200.0f64);
    let link = (0.1..0.5f64, 0.02..0.06f64, 500.0..4500.0f64);
    let drawn = (joint, link).prop_map(
        |((axis, tilt, limits, velocity, effort), (length, radius, density))| Drawn {
            axis,
            tilt,
            limits,
            velocity,
            effort,
            length,
            radius,
            density,
        },
    );
    vec(drawn, joints).prop_map(|joints| {
        let urdf = text(&joints);
        let robot = Robot::from_urdf(&urdf).expect("an arm of solid links is a robot");
        Arm { urdf, robot }
    })
}

fn text(joints: &[Drawn]) -> String {
    // The base, down from the first joint.
    let mut text = String::from("<robot name=\"arm\">\n");
    link(&mut text, "base", -0.1, 0.06, 1000.0);
    let (mut parent, mut height) = ("base".to_owned(), 0.0);
    for (i, joint) in joints.iter().enumerate() {
        let name = format!("link_{i}");
        link(&mut text, &name, joint.length, joint.radius, joint.density);
        let [roll, pitch, yaw] = joint.tilt.unwrap_or_default();
        let (kind, range) = match joint.limits {
            Some((below, above)) => (
                "revolute",
                format!("lower=\"{}\" upper=\"{above}\" ", -below),
            ),
            None => ("continuous", String::new()),
        };
        let _ = writeln!(
            text,
            "<joint name=\"joint_{i}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{name}\"/>{}\
             <axis xyz=\"{}\"/><limit {range}velocity=\"{}\" effort=\"{}\"/></joint>",
            origin(&[0.0, 0.0, height, roll, pitch, yaw]),
            numbers(&joint.axis),
            joint.velocity,
            joint.effort,
        );
        (parent, height) = (name, joint.length);
    }
    text + "</robot>\n"
}

/// A solid cylinder from the origin along z.
fn link(text: &mut String, name: &str, length: f64, radius: f64, density: f64) {
    let mass = density * std::f64::consts::PI * radius * radius * length.abs();
    let across = mass * (3.0 * radius * radius + length * length) / 12.0;
    let middle = origin(&[0.0, 0.0, length / 2.0, 0.0, 0.0, 0.0]);
    let _ = writeln!(
        text,
        "<link name=\"{name}\"><inertial>{middle}<mass value=\"{mass}\"/>\
         <inertia ixx=\"{across}\" ixy=\"0\" ixz=\"0\" iyy=\"{across}\" iyz=\"0\" izz=\"{}\"/></inertial>\
         <collision>{middle}<geometry><cylinder radius=\"{radius}\" length=\"{}\"/></geometry></collision></link>",
        mass * radius * radius / 2.0,
        length.abs(),
    );
}

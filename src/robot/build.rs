//! Assembles a [`Robot`] from a parsed URDF that has passed the lint: links, bodies, joints.

use std::collections::HashMap;

use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};
use urdf_rs::JointType;

use super::contents::{Contents, rgb};
use super::kinematics::Step;
use super::lint::Doubtful;
use super::load::LoadOptions;
use super::meshes::Meshes;
use super::{Body, BodyJoint, JointKind, Link, Robot, limits, mimics};
use crate::error::{Error, ErrorKind, Result, listed};
use crate::fourier::Joints;

/// An axis is a unit vector when its length is 1 but for this: rounding of printed digits.
const UNIT: f64 = 1e-3;

/// A robot of links, joints and materials that were checked one by one and as a tree.
pub(super) fn build(
    urdf: &urdf_rs::Robot,
    doubtful: &Doubtful,
    options: &LoadOptions,
) -> Result<Robot> {
    let children: HashMap<&str, &urdf_rs::Joint> = urdf
        .joints
        .iter()
        .map(|j| (j.child.link.as_str(), j))
        .collect();
    let mut below: HashMap<&str, Vec<&urdf_rs::Joint>> = HashMap::new();
    for joint in &urdf.joints {
        below.entry(&joint.parent.link).or_default().push(joint);
    }
    let links: HashMap<&str, &urdf_rs::Link> =
        urdf.links.iter().map(|l| (l.name.as_str(), l)).collect();
    let colored = |m: &'_ urdf_rs::Material| m.color.as_ref().map(rgb);
    let Some(root) = urdf
        .links
        .iter()
        .find(|l| !children.contains_key(l.name.as_str()))
    else {
        return Err(Error::new(ErrorKind::Shape, "no root link"));
    };

    let mut contents = Contents {
        colors: urdf
            .materials
            .iter()
            .filter_map(|m| colored(m).map(|c| (m.name.as_str(), c)))
            .collect(),
        doubtful,
        inconsistent: options.inertia,
        meshes: Meshes::new(options)?,
        notes: Vec::new(),
    };
    let mut names = Vec::new();
    let mut commanded = Vec::new();
    let mut bodies: Vec<Body> = Vec::new();
    let mut placed: Vec<Link> = Vec::new();
    // Depth first in the order of the file, without recursion: chains may be long.
    let mut open = vec![(
        root,
        None::<(usize, &urdf_rs::Joint)>,
        Isometry3::identity(),
    )];
    while let Some((link, held, pose)) = open.pop() {
        // `pose` is the link's frame in the body of the link that holds it, the joint's origin included.
        let joint = held.map(|(_, joint)| joint);
        let parent = held.map_or(0, |(holder, _)| placed[holder].body);
        let moving = joint.filter(|j| j.joint_type != JointType::Fixed);
        let (body, frame) = if placed.is_empty() || moving.is_some() {
            let joint = moving.map(|joint| {
                if joint.mimic.is_none() {
                    names.push(joint.name.clone());
                    commanded.push(bodies.len());
                }
                body_joint(joint, pose, &mut contents.notes)
            });
            bodies.push(Body {
                name: link.name.clone(),
                parent,
                joint,
                inertial: None,
                collision: Vec::new(),
                visual: Vec::new(),
                unread_collision: Vec::new(),
                doubtful_inertia: Vec::new(),
            });
            (bodies.len() - 1, Isometry3::identity())
        } else {
            (parent, pose)
        };
        let holder = placed.len();
        contents.add(&mut bodies[body], (holder, link), &frame)?;
        placed.push(Link {
            name: link.name.clone(),
            body,
            pose: frame,
            parent: held.map(|(holder, _)| holder),
            joint: joint.map(|j| j.name.clone()),
        });
        for joint in below.get(link.name.as_str()).into_iter().flatten().rev() {
            let origin = frame * isometry(&joint.origin);
            let Some(child) = links.get(joint.child.link.as_str()) else {
                let what = format!("no link `{}`", listed(&[&joint.child.link]));
                return Err(Error::new(ErrorKind::Name, what));
            };
            open.push((child, Some((holder, joint)), origin));
        }
    }

    if names.is_empty() {
        return Err(Error::new(ErrorKind::Shape, "no joint that moves")
            .expected("at least one revolute, continuous or prismatic joint")
            .at(format!("robot `{}`", urdf.name)));
    }
    let follows = mimics::resolve(&urdf.joints, &names)?;
    for joint in bodies.iter_mut().filter_map(|b| b.joint.as_mut()) {
        if let Some(follows) = follows.get(joint.name.as_str()) {
            joint.index = follows.index;
            joint.multiplier = follows.multiplier;
            joint.offset = follows.offset;
        }
    }
    let mut notes = contents.notes;
    let (of_meshes, enclosures) = contents.meshes.finish();
    notes.extend(of_meshes);
    let robot = Robot {
        name: urdf.name.clone(),
        joints: Joints::new(names)?,
        commanded,
        steps: bodies.iter().map(Step::new).collect(),
        bodies,
        tip: 0,
        links: placed,
        enclosures,
        notes,
    };
    robot.with_tip(options.tip.as_deref())
}

fn body_joint(
    joint: &urdf_rs::Joint,
    origin: Isometry3<f64>,
    notes: &mut Vec<String>,
) -> BodyJoint {
    let axis = Vector3::from(*joint.axis.xyz);
    if (axis.norm() - 1.0).abs() > UNIT {
        let name = &joint.name;
        notes.push(format!(
            "joint `{name}`: its axis of length {:.3e} is normalised",
            axis.norm()
        ));
    }
    BodyJoint {
        name: joint.name.clone(),
        kind: match joint.joint_type {
            JointType::Prismatic => JointKind::Prismatic,
            _ => JointKind::Revolute,
        },
        is_commanded: joint.mimic.is_none(),
        axis: Unit::new_normalize(axis),
        index: 0,
        multiplier: 1.0,
        offset: 0.0,
        origin,
        properties: limits::properties(joint, notes),
    }
}

/// URDF's `rpy` turns about the fixed axes x, y, z in this order.
pub(super) fn isometry(pose: &urdf_rs::Pose) -> Isometry3<f64> {
    let [roll, pitch, yaw] = *pose.rpy;
    Isometry3::from_parts(
        Translation3::from(Vector3::from(*pose.xyz)),
        UnitQuaternion::from_euler_angles(roll, pitch, yaw),
    )
}

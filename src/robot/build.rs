//! Assembles a [`Robot`] from a parsed URDF that has passed the lint: bodies, inertias, shapes.

use std::collections::HashMap;

use nalgebra::{Isometry3, Matrix3, SymmetricEigen, Translation3, Unit, UnitQuaternion, Vector3};
use urdf_rs::{Geometry, JointType};

use super::kinematics::Step;
use super::{Body, BodyJoint, Inertial, JointKind, JointProperties, Link, Robot};
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::{Interval, Joints};
use crate::geometry::{Shape, Solid};

/// An inertia may violate positive semidefiniteness by this share of its trace: rounding of printed digits.
const INERTIA_TOLERANCE: f64 = 1e-6;

pub(super) fn build(urdf: &urdf_rs::Robot) -> Result<Robot> {
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
    let by_name: HashMap<&str, &urdf_rs::Joint> =
        urdf.joints.iter().map(|j| (j.name.as_str(), j)).collect();
    let colors: HashMap<&str, [f32; 3]> = urdf
        .materials
        .iter()
        .filter_map(|m| m.color.as_ref().map(|c| (m.name.as_str(), rgb(c))))
        .collect();
    let Some(root) = urdf
        .links
        .iter()
        .find(|l| !children.contains_key(l.name.as_str()))
    else {
        return Err(Error::new(ErrorKind::Shape, "no root link"));
    };

    let mut notes = Vec::new();
    let mut names = Vec::new();
    let mut commanded = Vec::new();
    let mut bodies: Vec<Body> = Vec::new();
    let mut placed: Vec<Link> = Vec::new();
    // Depth first in the order of the file, without recursion: chains may be long.
    let mut open = vec![(root, None::<&urdf_rs::Joint>, 0, Isometry3::identity())];
    while let Some((link, joint, parent, pose)) = open.pop() {
        // `pose` is the link's frame in body `parent`, up to and including the joint's origin.
        let moving = joint.filter(|j| j.joint_type != JointType::Fixed);
        let (body, frame) = if placed.is_empty() || moving.is_some() {
            let joint = moving.map(|joint| {
                if joint.mimic.is_none() {
                    names.push(joint.name.clone());
                    commanded.push(bodies.len());
                }
                body_joint(joint, pose, joint_properties(joint, &mut notes))
            });
            bodies.push(Body {
                name: link.name.clone(),
                parent,
                joint,
                inertial: None,
                collision: Vec::new(),
                visual: Vec::new(),
                unread_collision: Vec::new(),
            });
            (bodies.len() - 1, Isometry3::identity())
        } else {
            (parent, pose)
        };
        add_link(&mut bodies[body], link, &frame, &colors, &mut notes)?;
        placed.push(Link {
            name: link.name.clone(),
            body,
            pose: frame,
        });
        for joint in below.get(link.name.as_str()).into_iter().flatten().rev() {
            let origin = frame * isometry(&joint.origin);
            open.push((links[joint.child.link.as_str()], Some(joint), body, origin));
        }
    }

    if names.is_empty() {
        return Err(Error::new(ErrorKind::Shape, "no joint that moves")
            .expected("at least one revolute, continuous or prismatic joint")
            .at(format!("robot `{}`", urdf.name)));
    }
    let joints = Joints::new(names)?;
    for body in bodies.iter_mut().skip(1) {
        if let Some(joint) = &mut body.joint {
            resolve(joint, &joints, &by_name)?;
        }
    }
    Ok(Robot {
        name: urdf.name.clone(),
        joints,
        commanded,
        steps: bodies.iter().map(Step::new).collect(),
        bodies,
        links: placed,
        notes,
    })
}

/// Follows a chain of mimics to the joint that is commanded.
fn resolve(
    joint: &mut BodyJoint,
    joints: &Joints,
    by_name: &HashMap<&str, &urdf_rs::Joint>,
) -> Result<()> {
    let mut leader = joint.name.as_str();
    while let Some(mimic) = by_name.get(leader).and_then(|j| j.mimic.as_ref()) {
        let gain = mimic.multiplier.unwrap_or(1.0);
        // position = m (gain * x + shift) + o
        joint.offset += joint.multiplier * mimic.offset.unwrap_or(0.0);
        joint.multiplier *= gain;
        leader = &mimic.joint;
    }
    joint.index = joints.index(leader)?;
    Ok(())
}

fn body_joint(
    joint: &urdf_rs::Joint,
    origin: Isometry3<f64>,
    properties: JointProperties,
) -> BodyJoint {
    BodyJoint {
        name: joint.name.clone(),
        kind: match joint.joint_type {
            JointType::Prismatic => JointKind::Prismatic,
            _ => JointKind::Revolute,
        },
        axis: Unit::new_normalize(Vector3::from(*joint.axis.xyz)),
        index: 0,
        multiplier: 1.0,
        offset: 0.0,
        origin,
        properties,
    }
}

fn joint_properties(joint: &urdf_rs::Joint, notes: &mut Vec<String>) -> JointProperties {
    let limit = &joint.limit;
    let mut given = |what: &str, value: f64| {
        if value > 0.0 {
            Some(value)
        } else {
            notes.push(format!("joint `{}`: no {what} limit is given", joint.name));
            None
        }
    };
    let velocity = given("velocity", limit.velocity);
    let effort = given("effort", limit.effort);
    let position = match joint.joint_type {
        JointType::Continuous => None,
        _ => Some(Interval {
            lower: limit.lower,
            upper: limit.upper,
        }),
    };
    if position.is_some_and(|p| p.lower == 0.0 && p.upper == 0.0) {
        notes.push(format!(
            "joint `{}`: its position limits are 0 and 0, so it may not move; give lower and upper, or make it continuous",
            joint.name
        ));
    }
    let dynamics = joint.dynamics.clone().unwrap_or_default();
    JointProperties {
        position,
        velocity,
        effort,
        damping: dynamics.damping,
        friction: dynamics.friction,
    }
}

fn add_link(
    body: &mut Body,
    link: &urdf_rs::Link,
    frame: &Isometry3<f64>,
    colors: &HashMap<&str, [f32; 3]>,
    notes: &mut Vec<String>,
) -> Result<()> {
    if let Some(inertial) = inertial(link, frame, notes)? {
        body.inertial = Some(match body.inertial.take() {
            None => inertial,
            Some(other) => other.joined(&inertial),
        });
    }
    let solid = |origin: &urdf_rs::Pose, shape: Shape, color| Solid {
        shape,
        pose: frame * isometry(origin),
        color,
    };
    let before = body.collision.len();
    for collision in &link.collision {
        match shape(&collision.geometry) {
            Ok(shape) => body.collision.push(solid(&collision.origin, shape, None)),
            Err(mesh) => body
                .unread_collision
                .push(format!("link `{}`: mesh {mesh}", link.name)),
        }
    }
    let visible = body.visual.len();
    for visual in &link.visual {
        let color = visual.material.as_ref().and_then(|m| {
            m.color
                .as_ref()
                .map(rgb)
                .or_else(|| colors.get(m.name.as_str()).copied())
        });
        if let Ok(shape) = shape(&visual.geometry) {
            body.visual.push(solid(&visual.origin, shape, color));
        }
    }
    if body.visual.len() == visible {
        body.visual.extend_from_slice(&body.collision[before..]);
    }
    Ok(())
}

/// The inertial of a link in the frame of its body; `None` when it has no mass.
fn inertial(
    link: &urdf_rs::Link,
    frame: &Isometry3<f64>,
    notes: &mut Vec<String>,
) -> Result<Option<Inertial>> {
    let mass = link.inertial.mass.value;
    let i = &link.inertial.inertia;
    if mass <= 0.0 {
        if mass < 0.0 || i.ixx != 0.0 {
            notes.push(format!(
                "link `{}`: a mass of {mass} kg is left out",
                link.name
            ));
        }
        return Ok(None);
    }
    let tensor = Matrix3::new(
        i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz,
    );
    let mut moments = SymmetricEigen::new(tensor).eigenvalues;
    moments.as_mut_slice().sort_by(f64::total_cmp);
    let tolerance = INERTIA_TOLERANCE * tensor.trace().abs();
    if moments[0] < -tolerance {
        return Err(Error::new(
            ErrorKind::Value,
            format!("inertia is not positive semidefinite: principal moments {:.3e}, {:.3e}, {:.3e} kg m^2", moments[0], moments[1], moments[2]),
        )
        .expected("moments of a body with mass")
        .help("recompute the inertia from the mesh or shape")
        .at(format!("link `{}`", link.name)));
    }
    if moments[2] > moments[0] + moments[1] + tolerance {
        notes.push(format!(
            "link `{}`: principal moments {:.3e}, {:.3e}, {:.3e} kg m^2 violate the triangle inequality: no body has them",
            link.name, moments[0], moments[1], moments[2]
        ));
    }
    let pose = frame * isometry(&link.inertial.origin);
    let rotation = pose.rotation.to_rotation_matrix().into_inner();
    Ok(Some(Inertial {
        mass,
        center: pose.translation.vector,
        inertia: rotation * tensor * rotation.transpose(),
    }))
}

impl Inertial {
    /// Two bodies as one (parallel axes).
    fn joined(&self, other: &Self) -> Self {
        let mass = self.mass + other.mass;
        let center = (self.center * self.mass + other.center * other.mass) / mass;
        let about = |part: &Self| {
            let d = part.center - center;
            part.inertia + (Matrix3::identity() * d.norm_squared() - d * d.transpose()) * part.mass
        };
        Self {
            mass,
            center,
            inertia: about(self) + about(other),
        }
    }
}

/// The shape, or the mesh that it is instead.
fn shape(geometry: &Geometry) -> std::result::Result<Shape, &str> {
    match geometry {
        Geometry::Box { size } => Ok(Shape::Box {
            half_extents: Vector3::from(**size) / 2.0,
        }),
        Geometry::Sphere { radius } => Ok(Shape::Sphere { radius: *radius }),
        Geometry::Cylinder { radius, length } => Ok(Shape::Cylinder {
            radius: *radius,
            length: *length,
        }),
        Geometry::Capsule { radius, length } => Ok(Shape::Capsule {
            radius: *radius,
            length: *length,
        }),
        Geometry::Mesh { filename, .. } => Err(filename),
    }
}

/// URDF's `rpy` turns about the fixed axes x, y, z in this order.
fn isometry(pose: &urdf_rs::Pose) -> Isometry3<f64> {
    let [roll, pitch, yaw] = *pose.rpy;
    Isometry3::from_parts(
        Translation3::from(Vector3::from(*pose.xyz)),
        UnitQuaternion::from_euler_angles(roll, pitch, yaw),
    )
}

fn rgb(color: &urdf_rs::Color) -> [f32; 3] {
    let [red, green, blue, _] = *color.rgba;
    [red, green, blue].map(|c| (c as f32).clamp(0.0, 1.0))
}

//! `undulate robot`.

use std::collections::BTreeMap;

use clap::Args;
use serde_json::{Value, json};

use super::robot::Reading;
use super::simulate::units;
use super::{Outcome, output};
use crate::error::{Error, Result};
use crate::geometry::Shape;
use crate::robot::{Body, BodyJoint, JointKind, Link, Robot, Srdf};

/// Links deeper than this are not indented further: chains may be long.
const DEEPEST: usize = 24;

/// Lines of a list of remarks; the JSON has all.
const MOST_REMARKS: usize = 40;

/// Kinds of shapes of a body that are told apart.
const MOST_KINDS: usize = 8;

/// Describe a robot: tree, joints, limits, mass, reach, shapes; what was mended, what is missing, what looks wrong.
#[derive(Args)]
#[command(
    after_help = "Reads what there is: a robot without meshes or masses is described all the same, and what cannot be done with it is said.\n\n\
    Examples:\n  \
    undulate robot wave_arm\n  \
    undulate robot arm/urdf/arm.urdf --meshes arm --srdf arm.srdf\n  \
    undulate robot gripper.urdf --tip palm --json"
)]
pub(super) struct Arguments {
    /// A URDF file, or the name of a shipped robot.
    #[arg(value_name = "URDF|NAME")]
    robot: String,
    #[command(flatten)]
    reading: Reading,
    /// The link whose reach is told [default: the end of the longest chain].
    #[arg(long, value_name = "LINK")]
    tip: Option<String>,
    /// Measure how closely hulls enclose their meshes: up to a second a mesh.
    #[arg(long)]
    measure: bool,
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    let robot = arguments
        .reading
        .robot_with(&arguments.robot, arguments.measure)?;
    let robot = match &arguments.tip {
        None => robot,
        tip => robot.with_tip(tip.as_deref())?,
    };
    let srdf = arguments.reading.srdf(&robot)?;
    let facts = Facts::of(&robot);
    let value = match json {
        true => facts.json(&robot, srdf.as_ref()),
        false => Value::Null,
    };
    output::report(json, &value, || facts.words(&robot, srdf.as_ref()));
    Ok(Outcome::Done)
}

/// What is said in words and in JSON alike.
struct Facts {
    mass: f64,
    reach: f64,
    doubts: Vec<String>,
    /// What is asked of a robot, and why it cannot be had.
    missing: Vec<(&'static str, Option<String>)>,
}

impl Facts {
    fn of(robot: &Robot) -> Self {
        let why = |result: Result<()>| result.err().map(|e: Error| e.to_string());
        Self {
            mass: robot.bodies().iter().map(mass).sum(),
            reach: robot.reach(robot.tip()),
            doubts: robot.doubts(),
            missing: vec![
                ("kinematics", None),
                ("collision", why(robot.require_collision(0))),
                ("dynamics", why(robot.require_dynamics())),
            ],
        }
    }

    fn words(&self, robot: &Robot, srdf: Option<&Srdf>) -> String {
        let tips: Vec<&str> = robot.tips().iter().map(|l| l.name.as_str()).collect();
        let reach = match self.reach {
            r if r.is_finite() => format!("at most {r:.3} m from its first joint"),
            _ => "without bound".to_owned(),
        };
        let mut parts = vec![
            format!(
                "robot `{}`: {} joints, {} links in {} bodies, {:.3} kg\ntip `{}` of {}; it reaches {reach}",
                robot.name(),
                robot.joints().len(),
                robot.links().len(),
                robot.bodies().len(),
                self.mass,
                robot.tip().name,
                crate::error::listed(&tips),
            ),
            tree(robot),
            joint_table(robot),
            body_table(robot),
            enclosure_table(robot),
        ];
        if let Some(srdf) = srdf {
            parts.push(format!(
                "SRDF: {} pairs disabled, {} groups, {} end effectors",
                srdf.disabled().len(),
                srdf.groups().len(),
                srdf.end_effectors().len()
            ));
        }
        let can = |(what, why): &(&str, Option<String>)| match why {
            None => format!("{what}: all that is needed is there"),
            Some(why) => format!("{what}: {why}"),
        };
        let missing: Vec<String> = self.missing.iter().map(can).collect();
        parts.push(remarks("what can be done", &missing));
        parts.push(remarks(
            "read otherwise than it stands, or left out",
            robot.notes(),
        ));
        parts.push(remarks("looks wrong", &self.doubts));
        parts.retain(|part| !part.is_empty());
        parts.join("\n\n")
    }

    fn json(&self, robot: &Robot, srdf: Option<&Srdf>) -> Value {
        let missing: BTreeMap<&str, &Option<String>> = self
            .missing
            .iter()
            .map(|(what, why)| (*what, why))
            .collect();
        json!({
            "robot": robot.name(),
            "joints": robot.moving().map(|(body, joint)| joint_json(robot, body, joint)).collect::<Vec<_>>(),
            "links": robot.links().iter().map(|link| json!({
                "name": link.name,
                "parent": link.parent.map(|p| &robot.links()[p].name),
                "joint": link.joint,
                "kind": kind_of_link(robot, link),
                "body": robot.bodies()[link.body].name,
            })).collect::<Vec<_>>(),
            "bodies": robot.bodies().iter().map(body_json).collect::<Vec<_>>(),
            "enclosures": robot.enclosures().iter().map(|e| json!({
                "mesh": e.mesh,
                "hulls": e.hulls,
                "largest_gap_m": [e.enclosure.largest_gap.0, e.enclosure.largest_gap.1],
                "volume_ratio": e.enclosure.volume_ratio,
            })).collect::<Vec<_>>(),
            "mass_kg": self.mass,
            "tip": robot.tip().name,
            "tips": robot.tips().iter().map(|l| &l.name).collect::<Vec<_>>(),
            // JSON has no infinity: null is without bound.
            "reach_m": self.reach,
            "srdf": srdf.map(|s| json!({
                "disabled": s.disabled(),
                "groups": s.groups().iter().map(|g| &g.name).collect::<Vec<_>>(),
            })),
            "missing": missing,
            "notes": robot.notes(),
            "doubts": self.doubts,
        })
    }
}

fn mass(body: &Body) -> f64 {
    body.inertial.as_ref().map_or(0.0, |i| i.mass)
}

fn remarks(title: &str, lines: &[String]) -> String {
    if lines.is_empty() {
        return String::new();
    }
    let mut text = format!("{title}:");
    for line in lines.iter().take(MOST_REMARKS) {
        text.push_str("\n  ");
        text.push_str(line);
    }
    if lines.len() > MOST_REMARKS {
        text.push_str(&format!("\n  and {} more", lines.len() - MOST_REMARKS));
    }
    text
}

fn kind(joint: &BodyJoint) -> &'static str {
    match (joint.kind, &joint.properties.position) {
        (JointKind::Prismatic, _) => "prismatic",
        (JointKind::Revolute, None) => "continuous",
        (JointKind::Revolute, Some(_)) => "revolute",
    }
}

/// How a link is held; `None` for the root.
fn kind_of_link(robot: &Robot, link: &Link) -> Option<&'static str> {
    let parent = link.parent?;
    match &robot.bodies()[link.body].joint {
        Some(joint) if robot.links()[parent].body != link.body => Some(kind(joint)),
        _ => Some("fixed"),
    }
}

/// A line a link, under the link that holds it.
fn tree(robot: &Robot) -> String {
    let mut depths = Vec::with_capacity(robot.links().len());
    let mut lines = vec!["tree:".to_owned()];
    for link in robot.links() {
        let depth = link.parent.map_or(0, |p| depths[p] + 1);
        depths.push(depth);
        let mut line = format!("{:1$}{2}", "", 2 * (1 + depth.min(DEEPEST)), link.name);
        if let (Some(joint), Some(kind)) = (&link.joint, kind_of_link(robot, link)) {
            line.push_str(&format!("  <- {joint}, {kind}"));
            if let (Some(joint), true) = (&robot.bodies()[link.body].joint, kind != "fixed") {
                let [x, y, z] = joint.axis.into_inner().into();
                let way = match joint.kind {
                    JointKind::Revolute => "about",
                    JointKind::Prismatic => "along",
                };
                line.push_str(&format!(" {way} {}", axis([x, y, z])));
            }
        }
        if depth > DEEPEST {
            line.push_str(&format!("  (depth {depth})"));
        }
        lines.push(line);
    }
    lines.join("\n")
}

/// A coordinate axis by its name, another by its numbers.
fn axis(numbers: [f64; 3]) -> String {
    for (i, name) in ["x", "y", "z"].iter().enumerate() {
        let rest = (0..3).filter(|j| *j != i).all(|j| numbers[j] == 0.0);
        if rest {
            let sign = if numbers[i] < 0.0 { "-" } else { "" };
            return format!("{sign}{name}");
        }
    }
    let [x, y, z] = numbers;
    format!("({x:.4}, {y:.4}, {z:.4})")
}

fn joint_table(robot: &Robot) -> String {
    let number = |value: Option<f64>, unit: &str| match value {
        None => "not given".to_owned(),
        Some(value) => format!("{} {unit}", short(value)),
    };
    let rows: Vec<Vec<String>> = robot
        .moving()
        .map(|(_, joint)| {
            let (unit, rate, force) = units(joint.kind);
            let p = &joint.properties;
            let range = p.position.as_ref().map_or_else(
                || "any".to_owned(),
                |i| format!("{} .. {} {unit}", short(i.lower), short(i.upper)),
            );
            let follows = match joint.is_commanded {
                true => String::new(),
                false => follows(robot, joint),
            };
            vec![
                joint.name.clone(),
                kind(joint).to_owned(),
                range,
                number(p.velocity, rate),
                number(p.effort, force),
                follows,
            ]
        })
        .collect();
    output::table(&["joint", "kind", "position", "speed", "effort", ""], &rows)
}

fn follows(robot: &Robot, joint: &BodyJoint) -> String {
    let shift = match joint.offset {
        o if o > 0.0 => format!(" + {}", short(o)),
        o if o < 0.0 => format!(" - {}", short(-o)),
        _ => String::new(),
    };
    let leader = robot.joints().name(joint.index);
    format!("= {} {leader}{shift}", short(joint.multiplier))
}

fn short(value: f64) -> String {
    match value.abs() {
        v if v != 0.0 && !(1e-3..1e6).contains(&v) => format!("{value:.2e}"),
        _ => {
            let text = format!("{value:.4}");
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
    }
}

fn body_table(robot: &Robot) -> String {
    let rows: Vec<Vec<String>> = robot
        .bodies()
        .iter()
        .map(|body| {
            let mass = match &body.inertial {
                None => "no mass".to_owned(),
                Some(inertial) => format!("{} kg", short(inertial.mass)),
            };
            vec![body.name.clone(), mass, shapes(body)]
        })
        .collect();
    output::table(&["body", "mass", "collision shapes"], &rows)
}

/// How much larger hulls are than their meshes, where that was measured.
fn enclosure_table(robot: &Robot) -> String {
    if robot.enclosures().is_empty() {
        return String::new();
    }
    let rows: Vec<Vec<String>> = robot
        .enclosures()
        .iter()
        .map(|e| {
            let (low, high) = e.enclosure.largest_gap;
            let volume = match e.enclosure.volume_ratio {
                None => "mesh not closed".to_owned(),
                Some(ratio) => format!("{ratio:.3}"),
            };
            vec![
                e.mesh.clone(),
                e.hulls.to_string(),
                format!("{} .. {} mm", short(1e3 * low), short(1e3 * high)),
                volume,
            ]
        })
        .collect();
    output::table(
        &["mesh", "hulls", "largest gap", "volume of hulls / mesh"],
        &rows,
    )
}

/// Shapes of a kind together, in the order in which the kinds come.
fn shapes(body: &Body) -> String {
    let mut kinds: Vec<(String, usize)> = Vec::new();
    for solid in &body.collision {
        let kind = match &solid.shape {
            Shape::Hull(hull) => {
                let error = match hull.tolerance() {
                    e if e > 0.0 => format!(", enclosing to {e:.1e} m"),
                    _ => String::new(),
                };
                format!("hull of {} corners{error}", hull.vertices().len())
            }
            other => primitive(other).to_owned(),
        };
        match kinds.iter().position(|(k, _)| *k == kind) {
            Some(known) => kinds[known].1 += 1,
            None if kinds.len() < MOST_KINDS => kinds.push((kind, 1)),
            None => {}
        }
    }
    let told: usize = kinds.iter().map(|(_, count)| count).sum();
    let mut parts: Vec<String> = kinds
        .iter()
        .map(|(kind, count)| match count {
            1 => kind.clone(),
            _ => format!("{count} x {kind}"),
        })
        .collect();
    if told < body.collision.len() {
        parts.push(format!("{} others", body.collision.len() - told));
    }
    if !body.unread_collision.is_empty() {
        parts.push(format!("{} not read", body.unread_collision.len()));
    }
    match parts.is_empty() {
        true => "none".to_owned(),
        false => parts.join(", "),
    }
}

fn primitive(shape: &Shape) -> &'static str {
    match shape {
        Shape::Box { .. } => "box",
        Shape::Sphere { .. } => "sphere",
        Shape::Cylinder { .. } => "cylinder",
        Shape::Capsule { .. } => "capsule",
        Shape::Hull(_) => "hull",
    }
}

fn joint_json(robot: &Robot, body: usize, joint: &BodyJoint) -> Value {
    let (unit, rate, force) = units(joint.kind);
    let axis: [f64; 3] = joint.axis.into_inner().into();
    json!({
        "name": joint.name,
        "kind": kind(joint),
        "moves": robot.bodies()[body].name,
        "axis": axis,
        "units": [unit, rate, force],
        "position": joint.properties.position.as_ref().map(|i| [i.lower, i.upper]),
        "velocity": joint.properties.velocity,
        "effort": joint.properties.effort,
        "damping": joint.properties.damping,
        "friction": joint.properties.friction,
        "follows": (!joint.is_commanded).then(|| json!({
            "joint": robot.joints().name(joint.index),
            "multiplier": joint.multiplier,
            "offset": joint.offset,
        })),
    })
}

fn body_json(body: &Body) -> Value {
    let shape = |solid: &crate::geometry::Solid| match &solid.shape {
        Shape::Hull(hull) => json!({
            "kind": "hull",
            "corners": hull.vertices().len(),
            "volume_m3": hull.volume(),
            "enclosing_error_m": hull.tolerance(),
        }),
        other => json!({ "kind": primitive(other) }),
    };
    json!({
        "name": body.name,
        "mass_kg": body.inertial.as_ref().map(|i| i.mass),
        "shapes": body.collision.iter().map(shape).collect::<Vec<_>>(),
        "not_read": body.unread_collision,
    })
}

//! Robots as text: random trees for laws that hold for every robot.

use std::fmt::Write as _;
use std::ops::RangeInclusive;

use proptest::collection::vec;
use proptest::prelude::*;

use super::super::argument::require_counts;

/// What one moving link and its joint are drawn as.
#[derive(Debug, Clone)]
struct Drawn {
    /// 0 revolute, 1 continuous, 2 prismatic.
    kind: usize,
    axis: [f64; 3],
    origin: [f64; 6],
    /// Share of the links so far at which the parent stands; the last of them above 1.
    parent: f64,
    /// Share of the joints so far at which the leader stands, multiplier, offset.
    mimic: Option<(f64, f64, f64)>,
    mass: f64,
    center: [f64; 6],
    edges: [f64; 3],
    /// Whether a second link with mass is fixed to it.
    loaded: bool,
}

/// URDFs of trees with so many joints that move: revolute, continuous and prismatic in any mixture, about any axis (not
/// unit vectors, as files have them), with turned origins and inertial frames, branches, loads on fixed joints and joints
/// that mimic others (and others' mimics). Masses of 0.2 to 5 kg are boxes of 0.1 to 0.5 m, so every mass matrix is
/// positive definite. They shrink to fewer joints, to chains and to numbers that are 0 or at their least.
///
/// ```
/// # #[cfg(feature = "robot")] {
/// use proptest::prelude::*;
/// use undulate::Robot;
/// use undulate::testing::trees;
///
/// proptest!(|(urdf in trees(1..=4))| {
///     let robot = Robot::from_urdf(&urdf)?;
///     prop_assert!(robot.require_dynamics().is_ok());
/// });
/// # }
/// ```
///
/// # Panics
/// When `joints` is an empty range or starts at 0.
#[track_caller]
pub fn trees(joints: RangeInclusive<usize>) -> impl Strategy<Value = String> {
    require_counts("joints", &joints, 1);
    let axis = [-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64].prop_map(|a| {
        // A short axis is replaced, not thrown away.
        if a.iter().map(|x| x * x).sum::<f64>() < 0.04 {
            [0.0, 0.0, 1.0]
        } else {
            a
        }
    });
    let pose = || {
        (
            prop::array::uniform3(-0.4..0.4f64),
            prop::array::uniform3(-3.0..3.0f64),
        )
            .prop_map(|(x, r)| [x[0], x[1], x[2], r[0], r[1], r[2]])
    };
    let mimic = prop::option::weighted(0.2, (0.0..1.0f64, -2.0..2.0f64, -1.0..1.0f64));
    let link = (
        (0..3usize, axis, pose(), 0.0..2.0f64, mimic),
        (
            0.2..5.0f64,
            pose(),
            prop::array::uniform3(0.1..0.5f64),
            prop::bool::weighted(0.2),
        ),
    )
        .prop_map(
            |((kind, axis, origin, parent, mimic), (mass, center, edges, loaded))| Drawn {
                kind,
                axis,
                origin,
                parent,
                mimic,
                mass,
                center,
                edges,
                loaded,
            },
        );
    vec(link, joints).prop_map(|links| text(&links))
}

fn text(links: &[Drawn]) -> String {
    let mut text = String::from("<robot name=\"tree\">\n<link name=\"link_0\"/>\n");
    for (i, drawn) in links.iter().enumerate() {
        let link = i + 1;
        let earlier = |share: f64, count: usize| ((share * count as f64) as usize).min(count - 1);
        body(&mut text, &format!("link_{link}"), drawn);
        let kind = ["revolute", "continuous", "prismatic"][drawn.kind];
        let parent = earlier(drawn.parent, link);
        let _ = writeln!(
            text,
            "<joint name=\"joint_{i}\" type=\"{kind}\"><parent link=\"link_{parent}\"/><child link=\"link_{link}\"/>{}\
             <axis xyz=\"{}\"/><limit lower=\"-3\" upper=\"3\" velocity=\"5\" effort=\"50\"/>{}</joint>",
            origin(&drawn.origin),
            numbers(&drawn.axis),
            match drawn.mimic {
                Some((leader, multiplier, offset)) if i > 0 => format!(
                    "<mimic joint=\"joint_{}\" multiplier=\"{multiplier}\" offset=\"{offset}\"/>",
                    earlier(leader, i)
                ),
                _ => String::new(),
            }
        );
        if drawn.loaded {
            body(&mut text, &format!("load_{link}"), drawn);
            let _ = writeln!(
                text,
                "<joint name=\"mount_{link}\" type=\"fixed\"><parent link=\"link_{link}\"/><child link=\"load_{link}\"/>{}</joint>",
                origin(&drawn.center)
            );
        }
    }
    text + "</robot>\n"
}

/// A link that is a solid box.
fn body(text: &mut String, name: &str, drawn: &Drawn) {
    let [x, y, z] = drawn.edges.map(|e| e * e * drawn.mass / 12.0);
    let _ = writeln!(
        text,
        "<link name=\"{name}\"><inertial>{}<mass value=\"{}\"/>\
         <inertia ixx=\"{}\" ixy=\"0\" ixz=\"0\" iyy=\"{}\" iyz=\"0\" izz=\"{}\"/></inertial></link>",
        origin(&drawn.center),
        drawn.mass,
        y + z,
        x + z,
        x + y
    );
}

/// `<origin/>` of x, y, z, roll, pitch, yaw.
pub(super) fn origin(pose: &[f64; 6]) -> String {
    let (xyz, rpy) = pose.split_at(3);
    format!(
        "<origin xyz=\"{}\" rpy=\"{}\"/>",
        numbers(xyz),
        numbers(rpy)
    )
}

pub(super) fn numbers(values: &[f64]) -> String {
    values
        .iter()
        .map(f64::to_string)
        .collect::<Vec<_>>()
        .join(" ")
}

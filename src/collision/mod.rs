//! Self-collision of a robot, by parry in f64.

mod motion;

use nalgebra::{Isometry3, Point3};
use parry3d::math::{Pose, Rotation, Vector};
use parry3d::query;
use parry3d::shape::SharedShape;

pub use motion::MotionClearance;

use crate::error::{Error, ErrorKind, Result};
use crate::geometry::{Hull, Shape, Solid};
use crate::robot::Robot;

/// Why a pair of bodies is checked or not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PairStatus {
    /// It is checked.
    Checked,
    /// It is checked, although it touches in the rest configuration already: no motion will pass. The shapes are too
    /// large, or the pair should be left out.
    TouchingAtRest,
    /// Not checked: a joint connects the two bodies, and their shapes overlap by design.
    Adjacent,
    /// Not checked: the caller said so.
    LeftOut,
}

/// Two bodies that might touch.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    /// Indices into [`Robot::bodies`].
    pub bodies: (usize, usize),
    /// Names of the bodies' links.
    pub names: (String, String),
    /// Whether it is checked, and why.
    pub status: PairStatus,
}

impl Pair {
    /// Whether it is checked.
    pub fn is_checked(&self) -> bool {
        matches!(
            self.status,
            PairStatus::Checked | PairStatus::TouchingAtRest
        )
    }
}

/// The smallest distance between bodies that are checked.
#[derive(Debug, Clone, PartialEq)]
pub struct Clearance {
    /// \[m\]; 0 when they touch or overlap.
    pub distance: f64,
    /// Names of the two bodies.
    pub pair: (String, String),
}

/// The collision shapes of a robot and the pairs of bodies to be kept apart.
pub struct CollisionModel {
    /// By body.
    shapes: Vec<Vec<Part>>,
    pairs: Vec<Pair>,
}

/// One shape in the frame of its body.
struct Part {
    shape: SharedShape,
    pose: Pose,
    /// Around the origin of `pose` \[m\].
    radius: f64,
}

impl CollisionModel {
    /// The shapes of `robot`, every pair of bodies checked but for neighbours and the pairs of links in `left_out`.
    ///
    /// # Errors
    /// When a link has collision geometry that cannot be read (meshes), when a name in `left_out` is no link,
    /// or when there is no shape at all: what is not known is not called free.
    pub fn new(robot: &Robot, left_out: &[(String, String)]) -> Result<Self> {
        let here = |e: Error| e.at(format!("robot `{}`", robot.name()));
        let unread: Vec<&str> = robot
            .bodies()
            .iter()
            .flat_map(|b| b.unread_collision.iter().map(String::as_str))
            .collect();
        if let Some(first) = unread.first() {
            return Err(here(
                Error::new(
                    ErrorKind::Unsupported,
                    format!(
                        "{} collision meshes are not read, first {first}",
                        unread.len()
                    ),
                )
                .expected("boxes, spheres, cylinders and capsules as collision shapes")
                .help("replace the meshes by primitives; limits and simulation work without"),
            ));
        }
        let shapes: Vec<Vec<Part>> = robot
            .bodies()
            .iter()
            .map(|body| body.collision.iter().map(Part::new).collect())
            .collect();
        if shapes.iter().filter(|s| !s.is_empty()).count() < 2 {
            return Err(here(
                Error::new(
                    ErrorKind::Infeasible,
                    "fewer than two bodies have collision shapes",
                )
                .help("add <collision> elements to the URDF"),
            ));
        }
        let body_of = |name: &String| {
            robot
                .links()
                .iter()
                .find(|l| l.name == *name)
                .map(|l| l.body)
                .ok_or_else(|| {
                    here(Error::new(
                        ErrorKind::Name,
                        format!("no link `{name}` to leave out"),
                    ))
                })
        };
        let left_out = left_out
            .iter()
            .map(|(a, b)| Ok((body_of(a)?, body_of(b)?)))
            .collect::<Result<Vec<_>>>()?;

        let mut pairs = Vec::new();
        for b in 0..shapes.len() {
            for a in 0..b {
                if shapes[a].is_empty() || shapes[b].is_empty() {
                    continue;
                }
                let status = if left_out.contains(&(a, b)) || left_out.contains(&(b, a)) {
                    PairStatus::LeftOut
                } else if robot.bodies()[b].parent == a {
                    PairStatus::Adjacent
                } else {
                    PairStatus::Checked
                };
                pairs.push(Pair {
                    bodies: (a, b),
                    names: (
                        robot.bodies()[a].name.clone(),
                        robot.bodies()[b].name.clone(),
                    ),
                    status,
                });
            }
        }
        let mut model = Self { shapes, pairs };
        let rest = robot.body_poses(&robot.rest());
        for i in 0..model.pairs.len() {
            let pair = &model.pairs[i];
            if pair.is_checked() && model.distance(pair, &rest, f64::INFINITY) <= 0.0 {
                model.pairs[i].status = PairStatus::TouchingAtRest;
            }
        }
        Ok(model)
    }

    /// Every pair of bodies with shapes, and whether and why it is checked.
    pub fn pairs(&self) -> &[Pair] {
        &self.pairs
    }

    /// The first pair that touches or overlaps at configuration `q`, if any. Panics when `q` has not one entry a joint.
    pub fn collision(&self, robot: &Robot, q: &[f64]) -> Option<&Pair> {
        let poses = robot.body_poses(q);
        self.checked().find(|pair| {
            let (a, b) = pair.bodies;
            self.shapes[a].iter().any(|left| {
                let placed = pose(&poses[a]) * left.pose;
                self.shapes[b].iter().any(|right| {
                    let other = pose(&poses[b]) * right.pose;
                    !left.is_farther(&placed, right, &other, 0.0)
                        && query::intersection_test(&placed, &*left.shape, &other, &*right.shape)
                            // A pair that parry cannot decide is not free.
                            .map_or(true, |i| i.intersecting)
                })
            })
        })
    }

    /// The smallest distance between checked bodies at configuration `q`; `None` when no pair is checked.
    /// Panics when `q` has not one entry a joint.
    pub fn clearance(&self, robot: &Robot, q: &[f64]) -> Option<Clearance> {
        self.nearest(&robot.body_poses(q), f64::INFINITY)
            .map(|(distance, pair)| Clearance {
                distance,
                pair: pair.names.clone(),
            })
    }

    fn checked(&self) -> impl Iterator<Item = &Pair> {
        self.pairs.iter().filter(|p| p.is_checked())
    }

    /// The smallest distance below `bound`, and the pair that has it.
    fn nearest(&self, poses: &[Isometry3<f64>], bound: f64) -> Option<(f64, &Pair)> {
        let mut best = None;
        let mut bound = bound;
        for pair in self.checked() {
            let distance = self.distance(pair, poses, bound);
            if distance < bound {
                bound = distance;
                best = Some((distance, pair));
            }
        }
        best
    }

    /// The distance of two bodies \[m\], or anything from `bound` on when it is not less than `bound`.
    fn distance(&self, pair: &Pair, poses: &[Isometry3<f64>], bound: f64) -> f64 {
        let (a, b) = pair.bodies;
        let (pose_a, pose_b) = (pose(&poses[a]), pose(&poses[b]));
        let mut least = bound;
        for left in &self.shapes[a] {
            let placed = pose_a * left.pose;
            for right in &self.shapes[b] {
                let other = pose_b * right.pose;
                if left.is_farther(&placed, right, &other, least) {
                    continue;
                }
                // parry says 0 when its search gives up: on the safe side, as is here what it does not support, and what
                // is not a number.
                let distance = query::distance(&placed, &*left.shape, &other, &*right.shape)
                    .map_or(0.0, |d| {
                        if d.distance.is_finite() {
                            d.distance
                        } else {
                            0.0
                        }
                    });
                least = least.min(distance);
            }
        }
        least
    }
}

impl Part {
    fn new(solid: &Solid) -> Self {
        let upright = Isometry3::rotation(nalgebra::Vector3::x() * std::f64::consts::FRAC_PI_2);
        let (shape, turn) = match &solid.shape {
            Shape::Box { half_extents: h } => {
                (SharedShape::cuboid(h.x, h.y, h.z), Isometry3::identity())
            }
            Shape::Sphere { radius } => (SharedShape::ball(*radius), Isometry3::identity()),
            // parry's cylinders stand along y.
            Shape::Cylinder { radius, length } => {
                (SharedShape::cylinder(length / 2.0, *radius), upright)
            }
            Shape::Capsule { radius, length } => (
                SharedShape::capsule_z(length / 2.0, *radius),
                Isometry3::identity(),
            ),
            Shape::Hull(hull) => (polyhedron(hull), Isometry3::identity()),
        };
        Self {
            shape,
            pose: pose(&(solid.pose * turn)),
            radius: solid.shape.radius(),
        }
    }

    /// Whether the bounding spheres alone are farther apart than `distance`.
    fn is_farther(&self, placed: &Pose, other: &Self, other_placed: &Pose, distance: f64) -> bool {
        let gap = (placed.translation - other_placed.translation).length();
        gap - self.radius - other.radius > distance
    }
}

/// A hull; a capsule around it where parry makes no polyhedron of it (flat ones).
fn polyhedron(hull: &Hull) -> SharedShape {
    let point = |p: &Point3<f64>| Vector::new(p.x, p.y, p.z);
    let vertices = hull.vertices().iter().map(point).collect();
    let solid = (!hull.is_flat())
        .then(|| SharedShape::convex_mesh(vertices, hull.faces()))
        .flatten();
    solid.unwrap_or_else(|| {
        let (a, b, radius) = hull.bounding_capsule();
        SharedShape::capsule(point(&a), point(&b), radius)
    })
}

/// parry speaks glam.
fn pose(isometry: &Isometry3<f64>) -> Pose {
    let (t, r) = (&isometry.translation.vector, &isometry.rotation.coords);
    Pose::from_parts(
        Vector::new(t.x, t.y, t.z),
        Rotation::from_xyzw(r.x, r.y, r.z, r.w),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two spheres of 0.1 m, 1 m from a common post, turning about it by q0 and q1, and a bead on the post.
    fn carousel() -> Robot {
        let arm = |name: &str| {
            format!(
                r#"<link name="{name}"><collision><origin xyz="1 0 0"/><geometry><sphere radius="0.1"/></geometry></collision></link>
            <joint name="{name}_joint" type="continuous"><parent link="post"/><child link="{name}"/><axis xyz="0 0 1"/></joint>"#
            )
        };
        Robot::from_urdf(&format!(
            r#"<robot name="carousel"><link name="post"><collision><geometry><cylinder radius="0.2" length="1"/></geometry></collision></link>{}{}</robot>"#,
            arm("one"), arm("two")
        ))
        .unwrap()
    }

    #[test]
    fn distance_on_the_carousel_is_the_chord_less_two_radii() {
        let robot = carousel();
        let model = CollisionModel::new(&robot, &[]).unwrap();
        for angle in [0.3, 1.0, 2.0, 3.1_f64] {
            let expected = 2.0 * (angle / 2.0).sin() - 0.2;
            let clearance = model.clearance(&robot, &[0.4, 0.4 + angle]).unwrap();
            assert!(
                (clearance.distance - expected).abs() < 1e-12,
                "{clearance:?}"
            );
            assert_eq!(clearance.pair, ("one".into(), "two".into()));
            assert!(model.collision(&robot, &[0.4, 0.4 + angle]).is_none());
        }
        assert_eq!(model.clearance(&robot, &[0.0, 0.15]).unwrap().distance, 0.0);
        assert!(model.collision(&robot, &[0.0, 0.15]).is_some());
    }

    #[test]
    fn pairs_say_why_they_are_checked() {
        let robot = carousel();
        let status = |left_out: &[(String, String)]| -> Vec<PairStatus> {
            CollisionModel::new(&robot, left_out)
                .unwrap()
                .pairs()
                .iter()
                .map(|p| p.status)
                .collect()
        };
        use PairStatus::{Adjacent, LeftOut, TouchingAtRest};
        assert_eq!(status(&[]), [Adjacent, Adjacent, TouchingAtRest]);
        assert_eq!(
            status(&[("two".into(), "one".into())]),
            [Adjacent, Adjacent, LeftOut]
        );
        let error = CollisionModel::new(&robot, &[("two".into(), "ghost".into())])
            .err()
            .unwrap();
        assert!(error.to_string().contains("no link `ghost`"));
    }

    #[test]
    fn cylinders_stand_along_z() {
        let robot = Robot::from_urdf(
            r#"<robot name="r"><link name="a"><collision><geometry><cylinder radius="0.1" length="2"/></geometry></collision></link>
            <link name="m"/><link name="b"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
            <joint name="i" type="continuous"><parent link="a"/><child link="m"/></joint>
            <joint name="j" type="prismatic"><parent link="m"/><child link="b"/><axis xyz="0 0 1"/><limit lower="1" upper="5" velocity="1"/></joint></robot>"#,
        )
        .unwrap();
        let model = CollisionModel::new(&robot, &[]).unwrap();
        let clearance = model.clearance(&robot, &[0.0, 1.5]).unwrap();
        assert!((clearance.distance - 0.4).abs() < 1e-9, "{clearance:?}");
    }

    #[test]
    fn meshes_are_not_called_free() {
        let robot = Robot::from_urdf(
            r#"<robot name="r"><link name="a"/><link name="b"><collision><geometry><mesh filename="package://x/b.stl"/></geometry></collision></link>
            <joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint></robot>"#,
        )
        .unwrap();
        let error = CollisionModel::new(&robot, &[]).err().unwrap();
        assert!(
            error
                .to_string()
                .contains("link `b`: mesh package://x/b.stl"),
            "{error}"
        );
    }
}

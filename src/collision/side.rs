//! A side of a pair as verification sees it: shapes of parry, how far they reach by parry, and how far their corners are from axes.

use nalgebra::{Isometry3, Point3, Vector3};
use parry3d::math::{Pose, Rotation, Vector};
use parry3d::shape::SharedShape;

use super::CollisionOptions;
use super::scene::{SceneObject, SceneShape};
use crate::error::{Error, ErrorKind, Result};
use crate::geometry::{Convex, HalfSpace, Shape, Warm, signed_distance};
use crate::robot::{JointKind, Robot};

/// One side of a pair.
pub(super) struct Side {
    body: usize,
    shapes: Vec<Placed>,
}

/// A shape in the frame of its body.
enum Placed {
    Convex(Box<Solid>),
    HalfSpace(HalfSpace),
}

struct Solid {
    /// `None` of a flat hull, which parry does not know: its corners are all of it.
    shape: Option<SharedShape>,
    pose: Isometry3<f64>,
    /// Points and a radius about them that enclose its core: all but a margin that is round, which goes where the core goes.
    corners: Vec<Point3<f64>>,
    radius: f64,
    /// A ball around the core, where that may be better.
    ball: Option<(Point3<f64>, f64)>,
    /// By so much it may be larger than `shape`.
    tolerance: f64,
    /// Asked for a direction, and believed in nothing.
    guide: Convex,
}

impl Solid {
    /// How far it reaches along `n`, by parry, when its body is at `pose` \[m\].
    fn height(&self, pose: &Isometry3<f64>, n: &Vector3<f64>) -> f64 {
        let map = self.shape.as_ref().and_then(|shape| shape.as_support_map());
        let reached = match map {
            Some(map) => {
                let along = Vector::new(n.x, n.y, n.z);
                along.dot(map.support_point(&parry(&(pose * self.pose)), along))
            }
            None => {
                let heights = self.corners.iter().map(|c| n.dot(&(pose * c).coords));
                heights.fold(f64::NEG_INFINITY, f64::max)
            }
        };
        reached + self.tolerance
    }
}

pub(super) fn side(robot: &Robot, options: &CollisionOptions, name: &str) -> Result<Side> {
    if let Some(object) = options.scene.objects().iter().find(|o| o.name == name) {
        return Ok(Side {
            body: 0,
            shapes: vec![of_object(object)?],
        });
    }
    let link = robot.links().iter().position(|l| l.name == name);
    let Some(link) = link else {
        return Err(Error::new(ErrorKind::Name, format!("no link `{name}`")));
    };
    let body = robot.links()[link].body;
    let solids = robot.bodies()[body]
        .collision
        .iter()
        .filter(|s| s.link == link);
    Ok(Side {
        body,
        shapes: solids
            .map(|s| convex(&s.shape, &s.pose))
            .collect::<Result<_>>()?,
    })
}

fn of_object(object: &SceneObject) -> Result<Placed> {
    match &object.shape {
        SceneShape::HalfSpace(half_space) => Ok(Placed::HalfSpace(*half_space)),
        SceneShape::Solid(shape, pose) => convex(shape, pose),
    }
}

fn convex(shape: &Shape, pose: &Isometry3<f64>) -> Result<Placed> {
    let upright = Isometry3::rotation(Vector3::x() * std::f64::consts::FRAC_PI_2);
    let along = |length: f64| {
        [-0.5, 0.5]
            .map(|end| Point3::new(0.0, 0.0, end * length))
            .to_vec()
    };
    let none = Isometry3::identity();
    let (parry, turn, corners, radius, tolerance) = match shape {
        Shape::Sphere { radius } => (
            Some(SharedShape::ball(*radius)),
            none,
            vec![Point3::origin()],
            0.0,
            0.0,
        ),
        Shape::Capsule { radius, length } => (
            Some(SharedShape::capsule_z(length / 2.0, *radius)),
            none,
            along(*length),
            0.0,
            0.0,
        ),
        // parry's cylinders stand along y.
        Shape::Cylinder { radius, length } => (
            Some(SharedShape::cylinder(length / 2.0, *radius)),
            upright,
            along(*length),
            *radius,
            0.0,
        ),
        Shape::Box { half_extents: h } => {
            let corners = (0..8).map(|i| {
                let sign = |axis: usize| if i >> axis & 1 == 0 { -1.0 } else { 1.0 };
                Point3::new(sign(0) * h.x, sign(1) * h.y, sign(2) * h.z)
            });
            (
                Some(SharedShape::cuboid(h.x, h.y, h.z)),
                none,
                corners.collect(),
                0.0,
                0.0,
            )
        }
        Shape::Hull(hull) => {
            let points: Vec<Vector> = hull
                .vertices()
                .iter()
                .map(|v| Vector::new(v.x, v.y, v.z))
                .collect();
            (
                SharedShape::convex_mesh(points, hull.faces()),
                none,
                hull.vertices().to_vec(),
                0.0,
                hull.tolerance(),
            )
        }
    };
    Ok(Placed::Convex(Box::new(Solid {
        shape: parry,
        pose: pose * turn,
        corners: corners.iter().map(|c| pose * c).collect(),
        radius,
        ball: match shape {
            Shape::Cylinder { radius, length } => {
                Some((pose * Point3::origin(), radius.hypot(length / 2.0)))
            }
            _ => None,
        },
        tolerance,
        guide: Convex::new(shape, pose)?,
    })))
}

/// The smallest distance of two sides, from below, and how many of shapes were looked at: a plane between two shapes, by the farthest points that
/// parry finds along its normal, proves that they are no nearer, wherever the normal is from. parry's own distance proves nothing: its search
/// ends with up to 15 micrometres too many where a shape is round.
pub(super) fn distance(poses: &[Isometry3<f64>], a: &Side, b: &Side) -> (f64, usize) {
    let mut least = f64::INFINITY;
    let mut looks = 0;
    let (at_a, at_b) = (&poses[a.body], &poses[b.body]);
    for left in &a.shapes {
        for right in &b.shapes {
            looks += 1;
            let proven = match (left, right) {
                (Placed::Convex(left), Placed::Convex(right)) => {
                    let guided = signed_distance(
                        left.guide.at(&at_a.into()),
                        right.guide.at(&at_b.into()),
                        &mut Warm::default(),
                    );
                    let n = guided.normal.normalize();
                    -right.height(at_b, &-n) - left.height(at_a, &n)
                }
                (Placed::HalfSpace(half_space), Placed::Convex(right)) => {
                    -right.height(at_b, &-half_space.normal()) - half_space.offset()
                }
                _ => 0.0,
            };
            // What is no number is no proof.
            least = least.min(if proven.is_nan() { 0.0 } else { proven });
        }
    }
    (least, looks)
}

/// How much the distance can fall while every joint stays within its radius: over the joints between the two, those up to one of them by the
/// corners of the first side, the others by those of the second (see `displacement`).
pub(super) fn fall(
    robot: &Robot,
    poses: &[Isometry3<f64>],
    a: &Side,
    b: &Side,
    radius: &[f64],
) -> f64 {
    let way = |body: usize| {
        let mut bodies = Vec::new();
        let mut at = body;
        while robot.bodies()[at].joint.is_some() {
            bodies.push(at);
            at = robot.bodies()[at].parent;
        }
        bodies
    };
    let (up, mut down) = (way(a.body), way(b.body));
    let shared = up
        .iter()
        .rev()
        .zip(down.iter().rev())
        .take_while(|(x, y)| x == y)
        .count();
    down.truncate(down.len() - shared);
    let chain: Vec<usize> = up[..up.len() - shared]
        .iter()
        .copied()
        .chain(down.into_iter().rev())
        .collect();
    let moved = |side: &Side, body: usize| {
        let Some(joint) = &robot.bodies()[body].joint else {
            return 0.0;
        };
        let turn = joint.multiplier.abs() * radius[joint.index];
        let rho = match joint.kind {
            JointKind::Prismatic => 1.0,
            JointKind::Revolute => {
                let axis = poses[body].rotation * joint.axis.into_inner();
                farthest(poses, side, &poses[body].translation.vector, &axis)
            }
        };
        rho * turn
    };
    let first: Vec<f64> = chain.iter().map(|body| moved(a, *body)).collect();
    let second: Vec<f64> = chain.iter().map(|body| moved(b, *body)).collect();
    (0..=chain.len())
        .map(|s| first[..s].iter().sum::<f64>() + second[s..].iter().sum::<f64>())
        .fold(f64::INFINITY, f64::min)
}

/// The distance of the farthest point of a side's cores from an axis.
fn farthest(
    poses: &[Isometry3<f64>],
    side: &Side,
    origin: &Vector3<f64>,
    axis: &Vector3<f64>,
) -> f64 {
    let off = |point: &Point3<f64>| {
        let arm = (poses[side.body] * point).coords - origin;
        arm.cross(axis).norm()
    };
    let mut most: f64 = 0.0;
    for shape in &side.shapes {
        most = most.max(match shape {
            Placed::HalfSpace(_) => f64::INFINITY,
            Placed::Convex(solid) => {
                let by_corners = solid.corners.iter().map(off).fold(0.0, f64::max) + solid.radius;
                let by_ball = solid.ball.as_ref().map(|(center, size)| off(center) + size);
                by_corners.min(by_ball.unwrap_or(f64::INFINITY))
            }
        });
    }
    most
}

/// parry speaks glam.
fn parry(isometry: &Isometry3<f64>) -> Pose {
    let (t, r) = (&isometry.translation.vector, &isometry.rotation.coords);
    Pose::from_parts(
        Vector::new(t.x, t.y, t.z),
        Rotation::from_xyzw(r.x, r.y, r.z, r.w),
    )
}

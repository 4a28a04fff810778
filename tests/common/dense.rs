//! What is looked at on samples of a motion, by parry as it comes: slow, and silent on what happens between.

use parry3d::bounding_volume::BoundingSphere;
use parry3d::math::{Pose, Rotation, Vector};
use parry3d::query;
use parry3d::shape::SharedShape;
use undulate::nalgebra::Isometry3;
use undulate::{CollisionModel, Robot, Shape, Wave};

/// The shapes of a link, with their bodies, their poses on them and the spheres around them.
pub type Part = Vec<Solid>;

pub struct Solid {
    pub body: usize,
    pub shape: SharedShape,
    pub pose: Pose,
    pub sphere: BoundingSphere,
}

pub type Pair = [Part; 2];

pub struct Dense {
    /// Those that are checked.
    pub pairs: Vec<Pair>,
}

pub fn pose(isometry: &Isometry3<f64>) -> Pose {
    let (t, r) = (&isometry.translation.vector, &isometry.rotation.coords);
    Pose::from_parts(
        Vector::new(t.x, t.y, t.z),
        Rotation::from_xyzw(r.x, r.y, r.z, r.w),
    )
}

pub fn parry_shape(shape: &Shape) -> (SharedShape, Isometry3<f64>) {
    let upright =
        Isometry3::rotation(undulate::nalgebra::Vector3::x() * std::f64::consts::FRAC_PI_2);
    match shape {
        Shape::Box { half_extents: h } => {
            (SharedShape::cuboid(h.x, h.y, h.z), Isometry3::identity())
        }
        Shape::Sphere { radius } => (SharedShape::ball(*radius), Isometry3::identity()),
        // parry's cylinders stand along y.
        Shape::Cylinder { radius, length } => {
            (SharedShape::cylinder(length / 2.0, *radius), upright)
        }
        Shape::Hull(hull) => {
            let points = hull
                .vertices()
                .iter()
                .map(|v| Vector::new(v.x, v.y, v.z))
                .collect();
            (
                SharedShape::convex_mesh(points, hull.faces()).expect("a hull"),
                Isometry3::identity(),
            )
        }
        Shape::Capsule { radius, length } => (
            SharedShape::capsule_z(length / 2.0, *radius),
            Isometry3::identity(),
        ),
    }
}

impl Dense {
    pub fn new(robot: &Robot, model: &CollisionModel) -> Self {
        let shapes = |name: &str| {
            let index = robot.links().iter().position(|l| l.name == name).unwrap();
            let body = robot.links()[index].body;
            let solids = robot.bodies()[body]
                .collision
                .iter()
                .filter(|s| s.link == index);
            solids
                .map(|solid| {
                    let (shape, turn) = parry_shape(&solid.shape);
                    Solid {
                        body,
                        pose: pose(&(solid.pose * turn)),
                        sphere: shape.compute_local_bounding_sphere(),
                        shape,
                    }
                })
                .collect()
        };
        Self {
            pairs: model
                .pairs()
                .iter()
                .filter(|p| p.is_checked())
                .map(|p| [shapes(&p.names.0), shapes(&p.names.1)])
                .collect(),
        }
    }

    /// The smallest distance on a grid of `rate` \[Hz\], 0 where something touches; stops at the first that is not above `enough`.
    pub fn clearance(&self, robot: &Robot, wave: &Wave, rate: f64, enough: f64) -> f64 {
        let samples = (wave.period() * rate).ceil() as usize;
        let mut least = f64::INFINITY;
        for n in 0..samples {
            let q = wave.position(wave.period() * n as f64 / samples as f64);
            least = least.min(self.at(robot, q.as_slice(), least));
            if least <= enough {
                break;
            }
        }
        least
    }

    /// At one configuration; `bound` where it is not smaller.
    pub fn at(&self, robot: &Robot, q: &[f64], bound: f64) -> f64 {
        let poses = Self::poses(robot, q);
        let least = |least: f64, pair: &Pair| distance(pair, &poses, least);
        self.pairs.iter().fold(bound, least)
    }

    /// Of the bodies.
    pub fn poses(robot: &Robot, q: &[f64]) -> Vec<Pose> {
        robot.body_poses(q).iter().map(pose).collect()
    }
}

/// Of one pair, or `bound` where it is not nearer.
pub fn distance([a, b]: &Pair, poses: &[Pose], bound: f64) -> f64 {
    let mut least = bound;
    for a in a {
        let placed_a = poses[a.body] * a.pose;
        for b in b {
            let placed_b = poses[b.body] * b.pose;
            let between = placed_a.transform_point(a.sphere.center)
                - placed_b.transform_point(b.sphere.center);
            if between.length() - a.sphere.radius - b.sphere.radius > least {
                continue;
            }
            let distance = query::distance(&placed_a, &*a.shape.0, &placed_b, &*b.shape.0)
                .unwrap()
                .distance;
            least = least.min(distance);
        }
    }
    least
}

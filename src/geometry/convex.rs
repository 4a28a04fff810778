//! [`Convex`]: a shape made ready for questions of distance.

use nalgebra::{Isometry3, Matrix3, Point3, Vector3};

use super::Shape;
use super::enclosing::{Ball, BoundingCapsule};
use crate::error::{Error, ErrorKind, Result};

/// Points in a block, whatever the processor: two vectors of AVX2, one of AVX-512.
pub(crate) const LANES: usize = 8;

/// The largest coordinate or size \[m\], so that no product of a few of them overflows.
const LARGEST: f64 = 1e12;

/// A convex shape in the frame of its body: a core, and all that is within `margin` of it.
///
/// A sphere is a point with a margin, a capsule a segment with one; boxes and hulls are their vertices, cylinders are
/// themselves, with none. The pose of a solid on its body is worked into the core, so that a query needs the body's alone.
#[derive(Debug, Clone, PartialEq)]
pub struct Convex {
    core: Core,
    margin: f64,
    /// The largest distance \[m\] of a point of the core from the body's origin, rounded up.
    reach: f64,
    ball: Ball,
    capsule: BoundingCapsule,
}

/// What the margin is laid around.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Core {
    Points(Points),
    Cylinder(Cylinder),
}

/// The hull of points, in blocks that are filled up with the last one.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Points {
    /// x, y and z of [`LANES`] points each.
    pub(crate) blocks: Vec<[[f64; LANES]; 3]>,
    pub(crate) count: usize,
}

/// A disc swept along a segment.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Cylinder {
    pub(crate) center: Vector3<f64>,
    /// Its own axes as columns; the third is that of the cylinder.
    pub(crate) axes: Matrix3<f64>,
    pub(crate) radius: f64,
    pub(crate) half_length: f64,
}

impl Points {
    fn new(points: &[Point3<f64>]) -> Self {
        let blocks = points
            .chunks(LANES)
            .map(|block| {
                let last = block.len() - 1;
                [0, 1, 2].map(|axis| std::array::from_fn(|lane| block[lane.min(last)][axis]))
            })
            .collect();
        Self {
            blocks,
            count: points.len(),
        }
    }

    /// Point `i`; beyond the last one, the last.
    #[inline(always)]
    pub(crate) fn get(&self, i: usize) -> Vector3<f64> {
        let i = i.min(self.count - 1);
        let [x, y, z] = &self.blocks[i / LANES];
        Vector3::new(x[i % LANES], y[i % LANES], z[i % LANES])
    }
}

impl Convex {
    /// `shape` at `pose` on its body.
    ///
    /// # Errors
    /// When a radius is negative, or a length or a coordinate is not finite or beyond 1e12 m.
    pub fn new(shape: &Shape, pose: &Isometry3<f64>) -> Result<Self> {
        let along = |length: f64| {
            [-0.5, 0.5].map(|end| pose.transform_point(&Point3::new(0.0, 0.0, end * length)))
        };
        match shape {
            // The tolerance: by so much points may stick out of the hull of the vertices.
            Shape::Hull(hull) => {
                let vertices: Vec<Point3<f64>> = hull
                    .vertices()
                    .iter()
                    .map(|vertex| pose.transform_point(vertex))
                    .collect();
                Self::from_points(&vertices, hull.tolerance())
            }
            Shape::Sphere { radius } => {
                Self::from_points(&[pose.translation.vector.into()], *radius)
            }
            Shape::Capsule { radius, length } => Self::from_points(&along(*length), *radius),
            Shape::Box { half_extents } => {
                let corners: [Point3<f64>; 8] = std::array::from_fn(|corner| {
                    let sign = |axis: usize| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 };
                    let sides = Vector3::new(sign(0), sign(1), sign(2));
                    pose.transform_point(&half_extents.component_mul(&sides).into())
                });
                Self::from_points(&corners, 0.0)
            }
            Shape::Cylinder { radius, length } => {
                let center = pose.translation.vector;
                let size = [*radius, *length];
                if !(valid(&center) && size.iter().all(|s| (0.0..=LARGEST).contains(s))) {
                    return Err(out_of_range(format!(
                        "a cylinder of radius {radius} and length {length} at {center:?}"
                    )));
                }
                let cylinder = Cylinder {
                    center,
                    axes: *pose.rotation.to_rotation_matrix().matrix(),
                    radius: *radius,
                    half_length: length / 2.0,
                };
                let rim = libm::hypot(*radius, length / 2.0);
                let ball = Ball::rounded_up(center, rim, rim);
                Ok(Self {
                    margin: 0.0,
                    reach: (center.norm() + rim) * (1.0 + 16.0 * f64::EPSILON),
                    ball,
                    capsule: BoundingCapsule::of_cylinder(&cylinder),
                    core: Core::Cylinder(cylinder),
                })
            }
        }
    }

    /// The hull of `points` \[m\] and all that is within `margin` \[m\] of it.
    ///
    /// # Errors
    /// Without a point, or when a number is not finite or beyond 1e12 m, or when the margin is negative.
    pub fn from_points(points: &[Point3<f64>], margin: f64) -> Result<Self> {
        if points.is_empty() {
            return Err(Error::new(ErrorKind::Shape, "no points")
                .expected("at least one point of a convex shape"));
        }
        if let Some(point) = points.iter().find(|p| !valid(&p.coords)) {
            return Err(out_of_range(format!(
                "a point at ({}, {}, {})",
                point.x, point.y, point.z
            )));
        }
        if !(0.0..=LARGEST).contains(&margin) {
            return Err(out_of_range(format!("a margin of {margin}")));
        }
        let reach = points.iter().map(|p| p.coords.norm()).fold(0.0, f64::max);
        Ok(Self {
            core: Core::Points(Points::new(points)),
            margin,
            reach: reach * (1.0 + 16.0 * f64::EPSILON),
            ball: Ball::of_points(points).grown(margin),
            capsule: BoundingCapsule::of_points(points).grown(margin),
        })
    }

    /// The core.
    #[inline(always)]
    pub(crate) fn core(&self) -> &Core {
        &self.core
    }

    /// What is laid around the core \[m\]: the radius of spheres and capsules, 0 for what has edges.
    #[inline(always)]
    pub fn margin(&self) -> f64 {
        self.margin
    }

    /// The largest distance \[m\] of a point of the shape from the body's origin, rounded up.
    #[inline(always)]
    pub fn reach(&self) -> f64 {
        self.reach + self.margin
    }

    /// A ball around the shape, in the frame of its body.
    #[inline(always)]
    pub fn ball(&self) -> &Ball {
        &self.ball
    }

    /// A capsule around the shape, in the frame of its body.
    #[inline(always)]
    pub fn capsule(&self) -> &BoundingCapsule {
        &self.capsule
    }

    /// The shape where its body is.
    #[inline(always)]
    pub fn at<'a>(&'a self, placement: &'a Placement) -> Placed<'a> {
        Placed {
            convex: self,
            placement,
        }
    }
}

fn valid(point: &Vector3<f64>) -> bool {
    point.iter().all(|x| x.abs() <= LARGEST)
}

fn out_of_range(what: String) -> Error {
    Error::new(ErrorKind::Value, what).expected(format!(
        "lengths in metres from 0 to {LARGEST:e}, coordinates within {LARGEST:e}"
    ))
}

/// Where a body is: `rotation` * p + `translation` takes a point p of the body to the world.
///
/// Matrices as they come from a chain of joints: queries work with them as they are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Orthonormal to 64 machine epsilons, which is what some dozens of joints leave of it.
    pub rotation: Matrix3<f64>,
    /// \[m\]
    pub translation: Vector3<f64>,
}

impl Placement {
    /// The body's frame is the world's.
    pub fn identity() -> Self {
        Self {
            rotation: Matrix3::identity(),
            translation: Vector3::zeros(),
        }
    }

    /// A point of the body, in the world.
    #[inline(always)]
    pub fn point(&self, p: &Vector3<f64>) -> Vector3<f64> {
        turn(&self.rotation, p) + self.translation
    }
}

impl From<&Isometry3<f64>> for Placement {
    fn from(pose: &Isometry3<f64>) -> Self {
        Self {
            rotation: *pose.rotation.to_rotation_matrix().matrix(),
            translation: pose.translation.vector,
        }
    }
}

/// A shape and where its body is.
#[derive(Debug, Clone, Copy)]
pub struct Placed<'a> {
    /// In the frame of the body.
    pub convex: &'a Convex,
    /// Of the body in the world.
    pub placement: &'a Placement,
}

/// m v. Spelt out, so that the order of the sum is this one and nothing is called.
#[inline(always)]
pub(crate) fn turn(m: &Matrix3<f64>, v: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(
        m.m11 * v.x + m.m12 * v.y + m.m13 * v.z,
        m.m21 * v.x + m.m22 * v.y + m.m23 * v.z,
        m.m31 * v.x + m.m32 * v.y + m.m33 * v.z,
    )
}

/// m^T v.
#[inline(always)]
pub(crate) fn turn_back(m: &Matrix3<f64>, v: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(
        m.m11 * v.x + m.m21 * v.y + m.m31 * v.z,
        m.m12 * v.x + m.m22 * v.y + m.m32 * v.z,
        m.m13 * v.x + m.m23 * v.y + m.m33 * v.z,
    )
}

/// a . b
#[inline(always)]
pub(crate) fn dot(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    a.x * b.x + a.y * b.y + a.z * b.z
}

/// Two unit vectors that make a frame with the unit vector `axis`.
pub(crate) fn perpendiculars(axis: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let least = axis.iamin();
    let first = axis.cross(&Vector3::ith(least, 1.0)).normalize();
    [first, axis.cross(&first)]
}

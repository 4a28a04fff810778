//! Shapes of links.

use std::sync::Arc;

use nalgebra::{Isometry3, Point3, Vector3};

use super::bounds::outward;
use super::hull::Hull;

/// A convex shape in its own frame: a primitive about its centre, or a hull. Lengths in metres, each positive and finite.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)]
pub enum Shape {
    /// Half the edge lengths along x, y, z.
    Box {
        half_extents: Vector3<f64>,
    },
    Sphere {
        radius: f64,
    },
    /// Its axis is z, as in URDF.
    Cylinder {
        radius: f64,
        length: f64,
    },
    /// Its axis is z; `length` is the distance of the centres of the caps.
    Capsule {
        radius: f64,
        length: f64,
    },
    /// Of a mesh, or of a part of one, anywhere in its frame. Shared, for it may be large.
    Hull(Arc<Hull>),
}

impl Shape {
    /// The largest distance \[m\] of a point of the shape from the origin of its frame, rounded outward.
    pub fn radius(&self) -> f64 {
        match self {
            Self::Hull(hull) => hull.radius(),
            // Their centre is the origin.
            _ => self.bounding_sphere().1,
        }
    }

    /// Centre and radius \[m\] of the smallest ball around the shape, rounded outward.
    pub fn bounding_sphere(&self) -> (Point3<f64>, f64) {
        let radius = match self {
            Self::Box { half_extents } => outward(half_extents.norm()),
            Self::Sphere { radius } => *radius,
            Self::Cylinder { radius, length } => {
                outward(Vector3::new(*radius, length / 2.0, 0.0).norm())
            }
            Self::Capsule { radius, length } => outward(radius + length / 2.0),
            Self::Hull(hull) => return hull.bounding_sphere(),
        };
        (Point3::origin(), radius)
    }

    /// Ends of the axis and radius \[m\] of a small capsule around the shape, rounded outward.
    pub fn bounding_capsule(&self) -> (Point3<f64>, Point3<f64>, f64) {
        let along = |axis: usize, half: f64, radius: f64| {
            let end = Vector3::ith(axis, half);
            ((-end).into(), end.into(), radius)
        };
        match self {
            Self::Box { half_extents } => {
                let axis = half_extents.imax();
                let mut across = *half_extents;
                across[axis] = 0.0;
                along(axis, half_extents[axis], outward(across.norm()))
            }
            Self::Sphere { radius } => along(2, 0.0, *radius),
            Self::Cylinder { radius, length } | Self::Capsule { radius, length } => {
                along(2, length / 2.0, *radius)
            }
            Self::Hull(hull) => hull.bounding_capsule(),
        }
    }
}

impl From<Hull> for Shape {
    fn from(hull: Hull) -> Self {
        Self::Hull(Arc::new(hull))
    }
}

/// A shape fixed to a body: `pose` takes coordinates about its centre to the body's.
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    /// What it is.
    pub shape: Shape,
    /// Where it is.
    pub pose: Isometry3<f64>,
    /// Index of its link in the robot's list.
    pub link: usize,
    /// Its colour, red, green and blue from 0 to 1, where the file gives one.
    pub color: Option<[f32; 3]>,
}

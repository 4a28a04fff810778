//! Shapes of links.

use nalgebra::{Isometry3, Vector3};

/// A primitive shape about its own centre. Lengths in metres, each positive and finite.
#[derive(Debug, Clone, Copy, PartialEq)]
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
}

impl Shape {
    /// The largest distance \[m\] of a point of the shape from its centre.
    pub fn radius(&self) -> f64 {
        match self {
            Self::Box { half_extents } => half_extents.norm(),
            Self::Sphere { radius } => *radius,
            Self::Cylinder { radius, length } => radius.hypot(length / 2.0),
            Self::Capsule { radius, length } => radius + length / 2.0,
        }
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

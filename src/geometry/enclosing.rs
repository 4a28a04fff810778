//! Balls and capsules around shapes, found once when a shape is made.

use nalgebra::{Point3, Vector3};

use super::bounds;
use super::convex::Cylinder;

/// A ball.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ball {
    /// \[m\]
    pub center: Vector3<f64>,
    /// \[m\], rounded up.
    pub radius: f64,
}

/// All that is within `radius` of a segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundingCapsule {
    /// Ends of the segment \[m\].
    pub ends: [Vector3<f64>; 2],
    /// \[m\], rounded up.
    pub radius: f64,
}

impl Ball {
    /// `size` is that of the numbers `radius` was computed from: rounding is proportional to it.
    pub(crate) fn rounded_up(center: Vector3<f64>, radius: f64, size: f64) -> Self {
        let size = size + center.norm();
        Self {
            center,
            radius: radius + 32.0 * f64::EPSILON * size,
        }
    }

    pub(crate) fn of_points(points: &[Point3<f64>]) -> Self {
        let ball = bounds::Ball::around(points);
        Self::rounded_up(ball.centre.coords, ball.radius, ball.radius)
    }

    pub(crate) fn grown(self, margin: f64) -> Self {
        Self::rounded_up(self.center, self.radius + margin, margin)
    }
}

impl BoundingCapsule {
    pub(crate) fn of_points(points: &[Point3<f64>]) -> Self {
        let capsule = bounds::Capsule::around(points);
        Self {
            ends: capsule.ends.map(|end| end.coords),
            radius: capsule.radius,
        }
    }

    pub(crate) fn of_cylinder(cylinder: &Cylinder) -> Self {
        let axis = cylinder.axes.column(2) * cylinder.half_length;
        let size = cylinder.center.norm() + cylinder.half_length;
        Self {
            ends: [cylinder.center - axis, cylinder.center + axis],
            radius: cylinder.radius + 32.0 * f64::EPSILON * (cylinder.radius + size),
        }
    }

    pub(crate) fn grown(self, margin: f64) -> Self {
        Self {
            ends: self.ends,
            radius: (self.radius + margin) * (1.0 + 2.0 * f64::EPSILON),
        }
    }
}

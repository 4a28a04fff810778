//! Half-spaces: tables, walls and floors, fixed to the world.

use fearless_simd::{Level, Simd, dispatch};
use nalgebra::{Point3, Vector3};

use super::{SLACK, Separation, SignedDistance};
use crate::error::{Error, ErrorKind, Result};
use crate::geometry::convex::{Placed, dot, turn, turn_back};

/// All points p of the world with normal . p <= offset: they are occupied.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfSpace {
    normal: Vector3<f64>,
    offset: f64,
}

impl HalfSpace {
    /// `normal`, of any length, points to where it is free; `offset` \[m\] is the plane's distance from the origin along it.
    ///
    /// # Errors
    /// When the normal has no direction or a number is not finite.
    pub fn new(normal: Vector3<f64>, offset: f64) -> Result<Self> {
        let largest = normal.amax();
        // Scaled first, so that no square overflows or vanishes.
        let unit = (normal / largest).normalize();
        if !(largest > 0.0 && unit.iter().all(|x| x.is_finite()) && offset.is_finite()) {
            return Err(Error::new(
                ErrorKind::Value,
                format!(
                    "a half-space of normal ({}, {}, {}) and offset {offset}",
                    normal.x, normal.y, normal.z
                ),
            )
            .expected("a normal that is not zero, and finite numbers"));
        }
        Ok(Self {
            normal: unit,
            offset,
        })
    }

    /// The unit vector to where it is free.
    pub fn normal(&self) -> &Vector3<f64> {
        &self.normal
    }

    /// \[m\]
    pub fn offset(&self) -> f64 {
        self.offset
    }

    /// Bounds of the signed distance of `a`: there is nothing to be searched, they differ by rounding alone.
    pub fn separation(&self, a: Placed) -> Separation {
        dispatch!(Level::new(), simd => self.separation_with(simd, a))
    }

    /// The same, for who has dispatched already.
    #[inline(always)]
    pub(crate) fn separation_with<S: Simd>(&self, simd: S, a: Placed) -> Separation {
        let placement = a.placement;
        let down = -turn_back(&placement.rotation, &self.normal);
        let value = dot(&self.normal, &placement.translation)
            - a.convex.core().height(simd, &down)
            - self.offset
            - a.convex.margin();
        let t = &placement.translation;
        let slack =
            SLACK * (t.x.abs() + t.y.abs() + t.z.abs() + a.convex.reach() + self.offset.abs());
        Separation::checked(value - slack, value + slack)
    }

    /// Signed distance of `a`, its lowest point and the foot of that, and the way from `a` into the half-space.
    pub fn signed_distance(&self, a: Placed) -> SignedDistance {
        let placement = a.placement;
        let down = -turn_back(&placement.rotation, &self.normal);
        let lowest = dispatch!(Level::new(), simd => a.convex.core().farthest(simd, &down));
        let point = turn(&placement.rotation, &lowest.point) + placement.translation
            - self.normal * a.convex.margin();
        let distance = dot(&self.normal, &point) - self.offset;
        SignedDistance {
            distance: if distance.is_finite() {
                distance
            } else {
                f64::NEG_INFINITY
            },
            points: [
                Point3::from(point),
                Point3::from(point - self.normal * distance),
            ],
            normal: -self.normal,
        }
    }
}

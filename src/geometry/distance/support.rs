//! How far a core reaches in a direction, by looking at every vertex.
//!
//! A scan looks at 72 to 220 vertices in some tens of nanoseconds, needs no graph of neighbours, cannot get caught on
//! vertices that a hull does not use, and what it finds is the plane's value itself: nothing is left to be verified.

use fearless_simd::{Simd, SimdBase, SimdMask, f64x8};
use nalgebra::Vector3;

use crate::geometry::convex::{Core, Cylinder, LANES, Points, dot, turn_back};

/// The number of a point that is no vertex.
pub(super) const SMOOTH: u32 = u32::MAX;

/// A point of a core that is farthest in a direction.
#[derive(Clone, Copy)]
pub(super) struct Farthest {
    /// Its coordinate in that direction.
    pub(super) height: f64,
    pub(super) point: Vector3<f64>,
    /// Which vertex it is, or [`SMOOTH`].
    pub(super) index: u32,
}

impl Core {
    /// The largest u . p of the core's points p.
    #[inline(always)]
    pub(crate) fn height<S: Simd>(&self, simd: S, u: &Vector3<f64>) -> f64 {
        match self {
            Self::Points(points) => points.height(simd, u),
            Self::Cylinder(cylinder) => cylinder.height(u),
        }
    }

    /// A point with the largest u . p, of several vertices the first.
    #[inline(always)]
    pub(super) fn farthest<S: Simd>(&self, simd: S, u: &Vector3<f64>) -> Farthest {
        match self {
            Self::Points(points) => points.farthest(simd, u),
            Self::Cylinder(cylinder) => cylinder.farthest(u),
        }
    }
}

/// u . p for a block of points, the direction spread over the lanes.
#[inline(always)]
fn heights<S: Simd>(simd: S, u: &[f64x8<S>; 3], block: &[[f64; LANES]; 3]) -> f64x8<S> {
    let [x, y, z] = block;
    u[0] * f64x8::load_array_ref(simd, x)
        + u[1] * f64x8::load_array_ref(simd, y)
        + u[2] * f64x8::load_array_ref(simd, z)
}

#[inline(always)]
fn spread<S: Simd>(simd: S, u: &Vector3<f64>) -> [f64x8<S>; 3] {
    [
        f64x8::splat(simd, u.x),
        f64x8::splat(simd, u.y),
        f64x8::splat(simd, u.z),
    ]
}

impl Points {
    /// Two maxima run side by side, so that neither waits for the other.
    #[inline(always)]
    fn height<S: Simd>(&self, simd: S, u: &Vector3<f64>) -> f64 {
        let u = spread(simd, u);
        let lowest = f64x8::splat(simd, f64::NEG_INFINITY);
        let (mut even, mut odd) = (lowest, lowest);
        let (pairs, rest) = self.blocks.as_chunks::<2>();
        for [first, second] in pairs {
            even = even.max(heights(simd, &u, first));
            odd = odd.max(heights(simd, &u, second));
        }
        for block in rest {
            even = even.max(heights(simd, &u, block));
        }
        even.max(odd).reduce_max()
    }

    #[inline(always)]
    fn farthest<S: Simd>(&self, simd: S, u: &Vector3<f64>) -> Farthest {
        let u = spread(simd, u);
        let mut best = f64x8::splat(simd, f64::NEG_INFINITY);
        let mut at = f64x8::splat(simd, 0.0);
        let mut number = at;
        let one = f64x8::splat(simd, 1.0);
        for block in &self.blocks {
            let heights = heights(simd, &u, block);
            let better = heights.simd_gt(best);
            best = best.max(heights);
            // Strictly better: a lane keeps its first block.
            at = simd.select_f64x8(better, number, at);
            number += one;
        }
        let height = best.reduce_max();
        let mut lanes = best.simd_eq(height).to_bitmask();
        let at = at.as_slice();
        let mut index = self.count;
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            index = index.min(at[lane % LANES] as usize * LANES + lane);
            lanes &= lanes - 1;
        }
        // Lanes beyond the last point repeat it.
        let index = index.min(self.count - 1);
        Farthest {
            height,
            point: self.get(index),
            index: index as u32,
        }
    }
}

impl Cylinder {
    #[inline(always)]
    fn height(&self, u: &Vector3<f64>) -> f64 {
        let own = turn_back(&self.axes, u);
        let across = (own.x * own.x + own.y * own.y).sqrt();
        dot(&self.center, u) + self.half_length * own.z.abs() + self.radius * across
    }

    #[inline(always)]
    fn farthest(&self, u: &Vector3<f64>) -> Farthest {
        let own = turn_back(&self.axes, u);
        let across = (own.x * own.x + own.y * own.y).sqrt();
        let scale = if across > 0.0 {
            self.radius / across
        } else {
            0.0
        };
        let along = if own.z < 0.0 {
            -self.half_length
        } else {
            self.half_length
        };
        let local = Vector3::new(own.x * scale, own.y * scale, along);
        Farthest {
            height: self.height(u),
            point: crate::geometry::convex::turn(&self.axes, &local) + self.center,
            index: SMOOTH,
        }
    }
}

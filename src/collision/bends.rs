//! How near two shapes can come over an interval, along one direction, to second order.
//!
//! Seen from the first part A, all joints of the chain in their middle positions, a point p of the second part B goes to
//! exp(d_1) .. exp(d_n) p, d_k the turn of joint k about its axis as it is in the middle (the product of exponentials; Murray, Li and Sastry, "A
//! Mathematical Introduction to Robotic Manipulation", 1994, section 3.2). One factor moves p by d_k z x r, within rho d_k^2 / 2, and what the
//! later ones have moved already by no more than d_k times that. With d_k = s_k (v_k t + e_k), |e_k| <= bend_k, this is
//!
//! ```text
//! p'(t) = p + t (W x p + u) + e,    |e| <= sum_k rho_k (bend_k + r_k^2 / 2) + r_k sum_{j > k} rho_j r_j,
//! W = sum s_k v_k z_k,    u = - sum s_k v_k z_k x o_k,
//! ```
//!
//! and a prismatic joint adds s_k v_k z_k to u and bend_k to the bound. Then n . p'(t) = (n + t n x W) . p + t n . u: for every p affine in t, so
//! the least over p and t is at an end of the interval, where it is a support of B in the direction n + t n x W.

use fearless_simd::Simd;
use nalgebra::Vector3;

use super::CollisionModel;
use super::filter::{Batch, OUTWARD};
use super::frames::lane_of;
use crate::geometry::Placed;
use crate::robot::JointKind;

/// Of a pair, on one interval.
pub(super) struct Bends {
    /// Half the interval \[s\].
    half: f64,
    /// W \[rad/s\] and u \[m/s\].
    turning: Vector3<f64>,
    moving: Vector3<f64>,
    /// On |e| \[m\], with what rounding does.
    rest: f64,
}

impl Batch {
    /// What bounds a pair to second order on interval number `lane`, of half width `half` \[s\]; capsules must have been asked.
    #[inline(always)]
    pub fn bends(&self, model: &CollisionModel, pair: usize, lane: usize, half: f64) -> Bends {
        let girth = model.parts[model.pairs[pair].parts.1].girth;
        let (mut turning, mut moving) = (Vector3::zeros(), Vector3::zeros());
        let (mut rest, mut later) = (0.0, 0.0);
        // From B back to A, so that what moves later is summed already.
        for step in model.chains.of(pair).iter().rev() {
            let joint = &model.frames.joints()[step.joint()];
            let placement = lane_of(&self.placed[joint.body], lane);
            let axis: Vector3<f64> = placement.rotation.column(2).into();
            let velocity = step.sign() * joint.multiplier * self.rows.velocity[joint.index][lane];
            let bend = joint.multiplier.abs() * self.rows.bend[joint.index][lane] * OUTWARD
                + self.tolerance[step.joint()][lane];
            let turn = self.turn[step.joint()][lane];
            match joint.kind {
                JointKind::Revolute => {
                    let rho = self.second_rho(step)[lane] + girth;
                    turning += axis * velocity;
                    moving -= axis.cross(&placement.translation) * velocity;
                    rest += rho * (bend + turn * turn / 2.0) + turn * later;
                    later += rho * turn;
                }
                JointKind::Prismatic => {
                    moving += axis * velocity;
                    rest += bend;
                    later += turn;
                }
            }
        }
        // The directions are longer than 1 by what they turn, and coordinates of the model's size are moved by them.
        let longer = 1.0 + half * (turning.norm() + moving.norm());
        Bends {
            half,
            turning,
            moving,
            rest: rest * OUTWARD + 4.0 * self.rounding * longer,
        }
    }
}

impl Bends {
    /// A lower bound \[m\] of the distance of two shapes over the interval, by planes across `n`, which is of unit length but for rounding; they are
    /// placed as in the middle of the interval.
    #[inline(always)]
    pub fn separation<S: Simd>(&self, simd: S, a: Placed, b: Placed, n: &Vector3<f64>) -> f64 {
        let own = a.placement.rotation.tr_mul(n);
        let highest = a.convex.core().height(simd, &own) + n.dot(&a.placement.translation);
        let turned = n.cross(&self.turning);
        let mut lowest = f64::INFINITY;
        for time in [-self.half, self.half] {
            let direction = n + turned * time;
            let down = b.placement.rotation.tr_mul(&-direction);
            let support = b.convex.core().height(simd, &down);
            let at = direction.dot(&b.placement.translation) - support + time * n.dot(&self.moving);
            lowest = lowest.min(at);
        }
        lowest - highest - a.convex.margin() - b.convex.margin() - self.rest
    }
}

#[cfg(test)]
mod tests;

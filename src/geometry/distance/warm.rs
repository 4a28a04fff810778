//! [`Warm`]: where the last question about a pair ended.

use nalgebra::Vector3;

use super::Relative;
use super::simplex::{Simplex, Vertex};
use super::support::SMOOTH;
use crate::geometry::convex::{Core, Placement, dot, turn};

/// Where the last question about a pair ended: the next one starts there.
///
/// Any value is sound with any pair and any pose. What belongs to another pair only makes the first step a poor one.
#[derive(Debug, Clone, PartialEq)]
pub struct Warm {
    /// From A to B, in A's frame; zero when nothing is known.
    pub(super) direction: Vector3<f64>,
    /// Numbers of the vertices that were nearest, or that the origin was between.
    ids: [[u32; 2]; 4],
    len: usize,
}

impl Default for Warm {
    fn default() -> Self {
        Self {
            direction: Vector3::zeros(),
            ids: [[0; 2]; 4],
            len: 0,
        }
    }
}

impl Warm {
    /// In the world, with the placement of A; `None` when nothing is known. Of unit length but for rounding.
    pub(crate) fn direction(&self, a: &Placement) -> Option<Vector3<f64>> {
        let length = self.direction.norm();
        (length > 0.0).then(|| a.rotation * (self.direction / length))
    }

    /// A direction alone.
    pub(super) fn towards(direction: Vector3<f64>) -> Self {
        Self {
            direction,
            ..Self::default()
        }
    }

    /// What was nearest last time, where it is now.
    #[inline(always)]
    pub(super) fn simplex(&self, cores: [&Core; 2], relative: &Relative) -> Simplex {
        let mut simplex = Simplex::empty();
        if let [Core::Points(a), Core::Points(b)] = cores {
            for ids in &self.ids[..self.len] {
                let (p, q) = (a.get(ids[0] as usize), b.get(ids[1] as usize));
                let q = turn(&relative.rotation, &q) + relative.translation;
                simplex.push(Vertex {
                    w: q - p,
                    a: p,
                    b: q,
                    ids: *ids,
                });
            }
        }
        simplex
    }

    #[inline(always)]
    pub(super) fn remember(&mut self, simplex: &Simplex) {
        let vertices = simplex.vertices();
        self.len = 0;
        if vertices.iter().all(|v| !v.ids.contains(&SMOOTH)) {
            for (ids, vertex) in self.ids.iter_mut().zip(vertices) {
                *ids = vertex.ids;
            }
            self.len = vertices.len();
        }
    }

    #[inline(always)]
    pub(super) fn direction_or(&self, relative: &Relative) -> Vector3<f64> {
        if self.direction != Vector3::zeros() {
            return self.direction;
        }
        let length = dot(&relative.way, &relative.way).sqrt();
        if length > 0.0 {
            relative.way / length
        } else {
            Vector3::x()
        }
    }
}

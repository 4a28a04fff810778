//! Depth and nearest points of cores that overlap or touch.

use fearless_simd::{Level, dispatch};
use nalgebra::Vector3;

use super::gjk::{self, Walk};
use super::simplex::Vertex;
use super::{Nearest, Relative, Warm, epa};
use crate::geometry::convex::Core;

/// How far beyond touching cores are moved to find the points that touch, relative to the coordinates.
const APART: f64 = 0.01;

/// How often a normal is made better at most, and the depth \[m\] that is worth another time.
const POLISHING: usize = 20;
const LEAST_GAIN: f64 = 1e-12;

/// Of cores that a walk did not part.
#[inline(never)]
pub(super) fn overlap(
    cores: [&Core; 2],
    relative: &Relative,
    walk: &Walk,
    warm: &mut Warm,
) -> Nearest {
    let level = Level::new();
    // The polytope's normals point out of B - A, against the way from A to B.
    let mut support = |n: &Vector3<f64>| -> (Vertex, f64) {
        let u = -n;
        let (vertex, value) = dispatch!(level, simd => gjk::support(simd, cores, relative, &u));
        (vertex, -value)
    };
    let found = epa::penetration(&mut support, walk.simplex.vertices(), relative.size);
    if !walk.inside && found.depth <= -walk.norm {
        // The walk was right: they are apart.
        return walk.apart();
    }
    let mut nearest = Nearest {
        distance: -found.depth,
        normal: -found.normal,
        points: walk.simplex.witnesses(),
    };
    // Moved apart along the normal, by more than the depth, the cores have the same points nearest; and the way between
    // these is a better normal, where the polytope's facets stand for something round.
    let away = found.depth.max(0.0) + APART * relative.size;
    for _ in 0..POLISHING {
        let shift = nearest.normal * away;
        let moved = Relative {
            translation: relative.translation + shift,
            ..*relative
        };
        *warm = Warm::towards(nearest.normal);
        let walk = dispatch!(level, simd => gjk::walk(simd, cores, &moved, warm, |_, _| false));
        if walk.inside {
            break;
        }
        let [p, q] = walk.simplex.witnesses();
        nearest.points = [p, q - shift];
        let normal = walk.normal;
        let distance = -support(&-normal).1;
        let gain = distance - nearest.distance;
        if gain <= 0.0 {
            break;
        }
        nearest.normal = normal;
        nearest.distance = distance;
        if gain < LEAST_GAIN {
            break;
        }
    }
    *warm = Warm::towards(nearest.normal);
    nearest
}

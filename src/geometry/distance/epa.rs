//! How deep two cores are in one another: van den Bergen's expanding polytope, over signed distances.
//!
//! The depth is the least support value h(n) of D = B - A over unit vectors n. A polytope in D gives a lower bound, its
//! face nearest to the origin; the support value in that face's direction is an upper one. Distances of faces are signed,
//! so the polytope need not hold the origin, and touching or barely separated cores are no special case.

use nalgebra::Vector3;

use super::polytope::Polytope;
use super::simplex::Vertex;
use crate::geometry::convex::{dot, perpendiculars};

/// The bounds agree when they are this near \[m\], and relative to the size of D.
const ABSOLUTE: f64 = 1e-10;
const RELATIVE: f64 = 1e-11;

/// A face is seen from points less than this share of the tolerance below it: coplanar faces go together, so that no
/// new face is a sliver along an old edge.
const COPLANAR: f64 = 0.1;

/// Polytopes take a dozen, discs against discs a hundred.
const STEPS: usize = 400;

/// A tetrahedron from the walk is used when none of its heights is below this share of its size.
const FLAT: f64 = 1e-6;

/// How deep, and where.
pub(super) struct Penetration {
    /// \[m\]; negative when the cores turn out to be apart.
    pub(super) depth: f64,
    /// The unit vector n out of D at its nearest face: moving A by depth * n parts the cores.
    pub(super) normal: Vector3<f64>,
}

/// A vertex of D with the largest n . w, and that value.
pub(super) type Support<'a> = &'a mut dyn FnMut(&Vector3<f64>) -> (Vertex, f64);

/// `start` may be a tetrahedron of D; `size` \[m\] is that of D's coordinates.
pub(super) fn penetration(support: Support, start: &[Vertex], size: f64) -> Penetration {
    let tolerance = ABSOLUTE.max(RELATIVE * size);
    let corners = match fat(start).map_or_else(|| tetrahedron(support, tolerance), Ok) {
        Ok(corners) => corners,
        Err(normal) => {
            return Penetration { depth: 0.0, normal };
        }
    };
    let mut polytope = Polytope::new(corners, COPLANAR * tolerance);
    let mut best = Penetration {
        depth: f64::INFINITY,
        normal: Vector3::x(),
    };
    for _ in 0..STEPS {
        let Some(nearest) = polytope.nearest() else {
            break;
        };
        let face = polytope.faces[nearest];
        let (vertex, height) = support(&face.normal);
        if height < best.depth {
            best.depth = height;
            best.normal = face.normal;
        }
        if best.depth - face.distance <= tolerance {
            break;
        }
        if !polytope.expand(nearest, vertex) {
            // Rounding has the better of this face; its neighbours look the same way.
            polytope.faces[nearest].distance = f64::INFINITY;
        }
    }
    best
}

/// The tetrahedron itself, unless it is too flat to tell in from out.
fn fat(start: &[Vertex]) -> Option<[Vertex; 4]> {
    let corners: [Vertex; 4] = start.try_into().ok()?;
    let [p, q, r, s] = corners.map(|c| c.w);
    let edges = [q - p, r - p, s - p, r - q, s - q, s - r];
    let size = edges.iter().map(|e| e.norm_squared()).fold(0.0, f64::max);
    let volume = dot(&edges[0], &edges[1].cross(&edges[2])).abs();
    // Six volumes over the largest possible area is no more than a height.
    (volume > FLAT * size * size.sqrt()).then_some(corners)
}

/// Extreme points of D that are no plane's: the ends of its longest extent along an axis, then what is farthest from the
/// line, then from the plane. What has no such points is flat: its normal.
fn tetrahedron(support: Support, tolerance: f64) -> Result<[Vertex; 4], Vector3<f64>> {
    let mut ends: Option<[Vertex; 2]> = None;
    let mut longest = tolerance;
    for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
        let pair = [support(&axis).0, support(&-axis).0];
        let length = (pair[1].w - pair[0].w).norm();
        if length > longest {
            longest = length;
            ends = Some(pair);
        }
    }
    let [p, q] = ends.ok_or_else(Vector3::x)?;
    let along = (q.w - p.w) / longest;
    let [u, v] = perpendiculars(&along);
    let off_line = |w: &Vector3<f64>| {
        let way = w - p.w;
        (way - along * dot(&along, &way)).norm()
    };
    let sides = [u, -u, v, -v].map(|side| support(&side).0);
    let r = farthest(&sides, off_line, tolerance).ok_or(u)?;
    let normal = along.cross(&(r.w - p.w)).normalize();
    let off_plane = |w: &Vector3<f64>| dot(&normal, &(w - p.w)).abs();
    let sides = [normal, -normal].map(|side| support(&side).0);
    let s = farthest(&sides, off_plane, tolerance).ok_or(normal)?;
    Ok([p, q, r, s])
}

/// The vertex with the largest distance, if that is more than `least`.
fn farthest(
    vertices: &[Vertex],
    distance: impl Fn(&Vector3<f64>) -> f64,
    least: f64,
) -> Option<Vertex> {
    let mut best = (least, None);
    for vertex in vertices {
        let distance = distance(&vertex.w);
        if distance > best.0 {
            best = (distance, Some(*vertex));
        }
    }
    best.1
}

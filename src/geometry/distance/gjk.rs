//! Gilbert, Johnson and Keerthi's walk to the nearest points of two cores (doi 10.1109/56.2083).

use fearless_simd::Simd;
use nalgebra::Vector3;

use super::simplex::{Closest, Simplex, Vertex};
use super::support::SMOOTH;
use super::{NOTHING, Nearest, Relative, Warm};
use crate::geometry::convex::{Core, dot, turn, turn_back};

/// Upper and lower bound agree when they are this near, relative and \[m\].
const RELATIVE: f64 = 1e-12;
const ABSOLUTE: f64 = 1e-13;

/// Polytopes take 3 to 10 steps, discs some dozens.
const STEPS: usize = 200;

/// Where the walk ended.
pub(super) struct Walk {
    pub(super) simplex: Simplex,
    /// From A's nearest point to B's; not of use when `inside`.
    pub(super) v: Vector3<f64>,
    /// Its length \[m\].
    pub(super) norm: f64,
    /// The highest value of a separating plane met, without any slack.
    pub(super) lower: f64,
    /// The distance of two points that are in the cores.
    pub(super) upper: f64,
    /// Whether the origin is in the simplex, or no farther from it than rounding can tell.
    pub(super) inside: bool,
}

impl Walk {
    /// The answer when the cores are apart.
    #[inline(always)]
    pub(super) fn apart(&self) -> Nearest {
        Nearest {
            distance: self.norm,
            normal: self.v / self.norm,
            points: self.simplex.witnesses(),
        }
    }
}

/// Walks until `enough(lower, upper)`, or the bounds agree, or nothing is gained any more.
#[inline(always)]
pub(super) fn walk<S: Simd>(
    simd: S,
    cores: [&Core; 2],
    relative: &Relative,
    warm: &mut Warm,
    enough: impl Fn(f64, f64) -> bool,
) -> Walk {
    let mut walk = Walk {
        simplex: warm.simplex(cores, relative),
        v: Vector3::zeros(),
        norm: f64::INFINITY,
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        inside: false,
    };
    if walk.simplex.vertices().is_empty() {
        let u = warm.direction_or(relative);
        let (vertex, value) = support(simd, cores, relative, &u);
        walk.lower = value;
        warm.direction = u;
        walk.simplex.push(vertex);
    }
    let mut square = f64::INFINITY;
    for _ in 0..STEPS {
        let nearest = match walk.simplex.closest() {
            Closest::Inside => {
                walk.inside = true;
                break;
            }
            Closest::At(nearest) => nearest,
        };
        if nearest.square >= square {
            walk.simplex.pop();
            break;
        }
        square = nearest.square;
        walk.simplex.keep(&nearest);
        walk.v = nearest.v;
        walk.norm = square.sqrt();
        if walk.norm <= NOTHING * relative.size {
            walk.inside = true;
            break;
        }
        // The foot on a sliver's plane may be off the sliver: what counts is the distance of points that are in the cores.
        walk.upper = if walk.simplex.vertices().len() == 3 {
            let [a, b] = walk.simplex.witnesses();
            (b - a).norm()
        } else {
            walk.norm
        };
        let u = walk.v / walk.norm;
        let (vertex, value) = support(simd, cores, relative, &u);
        if value > walk.lower {
            walk.lower = value;
            warm.direction = u;
        }
        if walk.norm - value <= RELATIVE * walk.norm + ABSOLUTE
            || enough(walk.lower, walk.upper)
            || is_among(walk.simplex.vertices(), &vertex)
        {
            break;
        }
        walk.simplex.push(vertex);
    }
    warm.remember(&walk.simplex);
    walk
}

/// The vertex of B - A that is lowest along the unit vector u, and u . b - u . a there: no point of one core is nearer to
/// any of the other along u.
#[inline(always)]
pub(super) fn support<S: Simd>(
    simd: S,
    cores: [&Core; 2],
    relative: &Relative,
    u: &Vector3<f64>,
) -> (Vertex, f64) {
    let a = cores[0].farthest(simd, u);
    let b = cores[1].farthest(simd, &-turn_back(&relative.rotation, u));
    let value = dot(u, &relative.translation) - b.height - a.height;
    let point = turn(&relative.rotation, &b.point) + relative.translation;
    let vertex = Vertex {
        w: point - a.point,
        a: a.point,
        b: point,
        ids: [a.index, b.index],
    };
    (vertex, value)
}

#[inline(always)]
fn is_among(vertices: &[Vertex], vertex: &Vertex) -> bool {
    vertices
        .iter()
        .any(|known| known.ids == vertex.ids && !known.ids.contains(&SMOOTH))
}

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

/// What rounding does to a squared distance.
const ROUNDING: f64 = 1e-14;

/// Steps that gain nothing, before it is over.
const STALLS: usize = 3;

/// Polytopes take 3 to 10 steps, discs some dozens.
const STEPS: usize = 200;

/// Where the walk ended.
pub(super) struct Walk {
    pub(super) simplex: Simplex,
    /// The distance of the simplex from the origin \[m\]; not of use when `inside`.
    pub(super) norm: f64,
    /// The highest value of a separating plane met, without any slack, and its unit vector from A to B.
    pub(super) lower: f64,
    pub(super) normal: Vector3<f64>,
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
            normal: self.normal,
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
        norm: f64::INFINITY,
        lower: f64::NEG_INFINITY,
        normal: Vector3::x(),
        upper: f64::INFINITY,
        inside: false,
    };
    if walk.simplex.vertices().is_empty() {
        let u = warm.direction_or(relative);
        let (vertex, value) = support(simd, cores, relative, &u);
        walk.lower = value;
        walk.normal = u;
        walk.simplex.push(vertex);
    }
    let mut square = f64::INFINITY;
    let mut stalls = 0;
    for _ in 0..STEPS {
        let nearest = match walk.simplex.closest(walk.lower > 0.0) {
            Closest::Inside => {
                walk.inside = true;
                break;
            }
            Closest::At(nearest) => nearest,
        };
        // Near the end the square no longer shows what the direction still gains.
        if nearest.square > square * (1.0 + ROUNDING) {
            walk.simplex.pop();
            break;
        }
        let nearer = nearest.square < square;
        square = square.min(nearest.square);
        walk.simplex.keep(&nearest);
        walk.norm = nearest.square.sqrt();
        if walk.norm <= NOTHING * relative.size {
            walk.inside = true;
            break;
        }
        // The foot on a sliver's plane may be off the sliver: what counts is the distance of points that are in the cores.
        walk.upper = walk.upper.min(if walk.simplex.vertices().len() == 3 {
            let [a, b] = walk.simplex.witnesses();
            (b - a).norm()
        } else {
            walk.norm
        });
        let u = nearest.v / walk.norm;
        let (vertex, value) = support(simd, cores, relative, &u);
        if value <= walk.lower && !nearer {
            stalls += 1;
        }
        if value > walk.lower {
            walk.lower = value;
            walk.normal = u;
        }
        if walk.norm - walk.lower <= RELATIVE * walk.norm + ABSOLUTE
            || enough(walk.lower, walk.upper)
            || stalls > STALLS
            || is_among(walk.simplex.vertices(), &vertex)
        {
            break;
        }
        walk.simplex.push(vertex);
    }
    if walk.lower > f64::NEG_INFINITY {
        warm.direction = walk.normal;
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

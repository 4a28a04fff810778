//! Spheres and capsules: nearest points of two segments in closed form.

use nalgebra::Vector3;

use super::{NOTHING, Nearest, Relative};
use crate::geometry::convex::{Core, dot, perpendiculars, turn};

/// A squared sine below which segments count as parallel.
const PARALLEL: f64 = 1e-28;

/// A vector shorter than this has lost digits in its square.
const SHORTEST: f64 = 1e-140;

/// Ends of A's core and of B's.
pub(super) type Ends = [[Vector3<f64>; 2]; 2];

/// The ends in A's frame, if both cores are points or segments.
#[inline(always)]
pub(super) fn ends(cores: [&Core; 2], relative: &Relative) -> Option<Ends> {
    let [Core::Points(a), Core::Points(b)] = cores else {
        return None;
    };
    if a.count > 2 || b.count > 2 {
        return None;
    }
    let place = |p: Vector3<f64>| turn(&relative.rotation, &p) + relative.translation;
    Some([[a.get(0), a.get(1)], [place(b.get(0)), place(b.get(1))]])
}

/// The value of the plane across `u`: no point of one is nearer to any of the other along u.
#[inline(always)]
pub(super) fn plane([a, b]: Ends, u: &Vector3<f64>) -> f64 {
    dot(u, &b[0]).min(dot(u, &b[1])) - dot(u, &a[0]).max(dot(u, &a[1]))
}

/// Distance and nearest points; `size` \[m\] is that of the coordinates.
#[inline(always)]
pub(super) fn nearest(ends: Ends, size: f64) -> Nearest {
    let ([p, q], inner) = points(ends);
    let way = q - p;
    let distance = dot(&way, &way).sqrt();
    let [d, e] = ends.map(|[from, to]| to - from);
    if distance > NOTHING * size {
        // The way is across a segment in whose inside it ends, however much rounding has left of so short a way.
        let across = match inner {
            [true, true] => {
                let normal = d.cross(&e);
                if dot(&normal, &way) < 0.0 {
                    -normal
                } else {
                    normal
                }
            }
            [true, false] => across(&way, &d),
            [false, true] => across(&way, &e),
            [false, false] => way,
        };
        return Nearest {
            distance,
            normal: across.try_normalize(SHORTEST).unwrap_or(way / distance),
            points: [p, q],
        };
    }
    // They cross, or are one in the other: out of both, if there is such a way.
    let longer = if dot(&d, &d) > dot(&e, &e) { d } else { e };
    let normal = d.cross(&e).try_normalize(SHORTEST).or_else(|| {
        longer
            .try_normalize(SHORTEST)
            .map(|axis| perpendiculars(&axis)[0])
    });
    Nearest {
        distance: 0.0,
        normal: normal.unwrap_or_else(Vector3::x),
        points: [p, q],
    }
}

/// A point on each of the segments p, p + d and q, q + e, so that none on one is nearer to the other.
///
/// And whether each is inside its segment. From cross products: with the Gram determinant nearly parallel segments lose
/// twice the digits.
#[inline(always)]
fn points([[p, p_end], [q, q_end]]: Ends) -> ([Vector3<f64>; 2], [bool; 2]) {
    let (d, e, r) = (p_end - p, q_end - q, q - p);
    let (dd, ee) = (dot(&d, &d), dot(&e, &e));
    let normal = d.cross(&e);
    let nn = dot(&normal, &normal);
    if nn > PARALLEL * dd * ee {
        let s = dot(&r.cross(&e), &normal) / nn;
        let t = dot(&r.cross(&d), &normal) / nn;
        if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
            return ([p + d * s, q + e * t], [true; 2]);
        }
    }
    // Otherwise an end of one of them is nearest.
    let mut best = ([p, q], [false; 2]);
    let mut least = f64::INFINITY;
    let mut take = |a: Vector3<f64>, b: Vector3<f64>, inner: [bool; 2]| {
        let way = b - a;
        let square = dot(&way, &way);
        if square < least {
            least = square;
            best = ([a, b], inner);
        }
    };
    for end in [p, p_end] {
        let share = foot(&end, &q, &e, ee);
        take(end, q + e * share, [false, share > 0.0 && share < 1.0]);
    }
    for end in [q, q_end] {
        let share = foot(&end, &p, &d, dd);
        take(p + d * share, end, [share > 0.0 && share < 1.0, false]);
    }
    best
}

/// What of `way` is across the direction `d`.
#[inline(always)]
fn across(way: &Vector3<f64>, d: &Vector3<f64>) -> Vector3<f64> {
    way - d * (dot(way, d) / dot(d, d))
}

/// Where on q, q + e the foot of p is, from 0 to 1.
#[inline(always)]
fn foot(p: &Vector3<f64>, q: &Vector3<f64>, e: &Vector3<f64>, ee: f64) -> f64 {
    if ee > 0.0 {
        (dot(&(p - q), e) / ee).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

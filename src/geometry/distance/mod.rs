//! Signed distance of two convex shapes, with bounds that hold.
//!
//! For any unit vector u, min over B of u . b - max over A of u . a is no more than the signed distance, and the largest
//! such value is the signed distance itself, apart or not. A proof needs one u and a look at every vertex; how u was
//! found does not matter. So [`separation`] tries the u that held last, and walks (GJK) only when that one no longer will.

mod epa;
mod gjk;
mod half_space;
mod overlap;
mod polytope;
mod rough;
mod segments;
mod simplex;
mod support;
mod warm;

use fearless_simd::{Level, Simd, dispatch};
use nalgebra::{Matrix3, Point3, Vector3};

pub use half_space::HalfSpace;
pub use rough::rough_separation;
pub use warm::Warm;

use super::convex::{Placed, dot, turn, turn_back};

/// What rounding can do to the value of a plane, relative to the coordinates it is computed from.
///
/// With e the machine epsilon, M = |t|_1 + reach of A + reach of B, to first order, in units of e M:
/// rotations orthonormal to 64 e make the world's direction R_A u up to 32 longer than u, which overstates the value by as
/// much (32), and A's own direction R_A^T R_A u differ from u (64); a shape's pose worked into its core (16, by the
/// quaternion's norm and one product); u, normalised, is within 2 of a unit vector; each of the products R_A u, R_B^T w and
/// w . t, and each vertex's dot product, is three terms, 2 at most (10 together, as relative poses have a product more);
/// sums and margins 4. That is 128; a quarter more for what is of second order, and for the rounding of M.
pub(crate) const SLACK: f64 = 160.0 * f64::EPSILON;

/// A distance of cores that is rounding alone, relative to the coordinates it is computed from.
const NOTHING: f64 = 1e-15;

/// Bounds of a signed distance \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Separation {
    /// Proven by a plane: the signed distance is no less.
    pub lower: f64,
    /// Of two points that are in the shapes: the distance is no more. Infinite when the plane that held last has decided.
    pub upper: f64,
}

/// Signed distance of two shapes A and B, in the world's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SignedDistance {
    /// \[m\]; of shapes that overlap minus the depth: how far one of them must move for them to touch.
    /// Minus infinity when a placement is not finite.
    pub distance: f64,
    /// On A and on B: the second less the first is `distance` times `normal`.
    pub points: [Point3<f64>; 2],
    /// The unit vector from A to B; moving B along it parts them.
    pub normal: Vector3<f64>,
}

/// Signed distance of two cores, the unit vector from A to B, and a point of each, in A's frame.
#[derive(Clone, Copy)]
struct Nearest {
    distance: f64,
    normal: Vector3<f64>,
    points: [Vector3<f64>; 2],
}

/// B's frame in A's.
#[derive(Clone, Copy)]
struct Relative {
    rotation: Matrix3<f64>,
    translation: Vector3<f64>,
    /// That of the coordinates \[m\].
    size: f64,
    /// From the middle of A's to that of B's, should nothing better be known.
    way: Vector3<f64>,
}

/// Bounds of the signed distance of `a` and `b`, as good as it takes to compare it with `threshold` \[m\]: until the lower
/// one is above, or the upper one is not, or they agree to 1e-12 of the distance and 1e-13 m.
///
/// Depth beyond the margins of shapes that overlap is not measured: both bounds hold, and the upper one is minus the margins.
pub fn separation(a: Placed, b: Placed, warm: &mut Warm, threshold: f64) -> Separation {
    dispatch!(Level::new(), simd => separation_with(simd, a, b, warm, threshold))
}

/// Whether `a` and `b` touch or overlap, or are so near that rounding cannot tell.
pub fn intersects(a: Placed, b: Placed, warm: &mut Warm) -> bool {
    // A lower bound is never NaN.
    separation(a, b, warm, 0.0).lower <= 0.0
}

/// Signed distance and nearest points of `a` and `b`, to 1e-9 m for shapes of metres.
pub fn signed_distance(a: Placed, b: Placed, warm: &mut Warm) -> SignedDistance {
    dispatch!(Level::new(), simd => signed_distance_with(simd, a, b, warm))
}

/// [`separation`], for who has dispatched already.
#[inline(always)]
pub(crate) fn separation_with<S: Simd>(
    simd: S,
    a: Placed,
    b: Placed,
    warm: &mut Warm,
    threshold: f64,
) -> Separation {
    let enough = |lower, upper| lower > threshold || upper <= threshold;
    separation_until(simd, a, b, warm, threshold, enough)
}

/// Bounds of the signed distance of `a` and `b`: by the plane that held last when the lower one is above `threshold` \[m\]; else until they are
/// `enough`, or agree.
#[inline(always)]
pub(crate) fn separation_until<S: Simd>(
    simd: S,
    a: Placed,
    b: Placed,
    warm: &mut Warm,
    threshold: f64,
    enough: impl Fn(f64, f64) -> bool,
) -> Separation {
    let margins = a.convex.margin() + b.convex.margin();
    let offset = b.placement.translation - a.placement.translation;
    let slack = slack(a, b, &offset);
    let mut known = f64::NEG_INFINITY;
    if warm.direction != Vector3::zeros() {
        let lower = plane(simd, a, b, &offset, &warm.direction) - margins - slack;
        if lower > threshold && lower.is_finite() {
            return Separation {
                lower,
                upper: f64::INFINITY,
            };
        }
        known = lower;
    }
    let relative = Relative::new(a, b, &offset);
    if !relative.is_finite() {
        return Separation::checked(f64::NAN, f64::NAN);
    }
    let cores = [a.convex.core(), b.convex.core()];
    if let Some(ends) = segments::ends(cores, &relative) {
        let nearest = segments::nearest(ends, relative.size);
        warm.direction = nearest.normal;
        let lower = segments::plane(ends, &nearest.normal);
        return Separation::checked(lower - margins - slack, nearest.distance - margins + slack);
    }
    let walk = gjk::walk(simd, cores, &relative, warm, |lower, upper| {
        enough(lower - margins - slack, upper - margins + slack)
    });
    let upper = if walk.inside { 0.0 } else { walk.upper };
    let lower = walk.lower - margins - slack;
    Separation::checked(
        if known > lower { known } else { lower },
        upper - margins + slack,
    )
}

/// The value of the plane across `u`, a unit vector in A's frame: no more than the signed distance of the cores, but for
/// rounding.
#[inline(always)]
fn plane<S: Simd>(simd: S, a: Placed, b: Placed, offset: &Vector3<f64>, u: &Vector3<f64>) -> f64 {
    let world = turn(&a.placement.rotation, u);
    let back = -turn_back(&b.placement.rotation, &world);
    dot(&world, offset) - b.convex.core().height(simd, &back) - a.convex.core().height(simd, u)
}

#[inline(always)]
fn slack(a: Placed, b: Placed, offset: &Vector3<f64>) -> f64 {
    let reach = a.convex.reach() + b.convex.reach();
    SLACK * size(offset, reach)
}

/// That of the coordinates \[m\]: not so small that the square of what is no rounding of it has lost digits.
#[inline(always)]
fn size(offset: &Vector3<f64>, reach: f64) -> f64 {
    offset.x.abs() + offset.y.abs() + offset.z.abs() + reach + 1e-100
}

/// [`signed_distance`], for who has dispatched already.
#[inline(always)]
pub(crate) fn signed_distance_with<S: Simd>(
    simd: S,
    a: Placed,
    b: Placed,
    warm: &mut Warm,
) -> SignedDistance {
    let offset = b.placement.translation - a.placement.translation;
    let relative = Relative::new(a, b, &offset);
    if !relative.is_finite() {
        return SignedDistance {
            distance: f64::NEG_INFINITY,
            points: [Point3::origin(); 2],
            normal: Vector3::x(),
        };
    }
    let cores = [a.convex.core(), b.convex.core()];
    let found = if let Some(ends) = segments::ends(cores, &relative) {
        let nearest = segments::nearest(ends, relative.size);
        warm.direction = nearest.normal;
        nearest
    } else {
        let walk = gjk::walk(simd, cores, &relative, warm, |_, _| false);
        if !walk.inside && walk.lower > 0.0 {
            walk.apart()
        } else {
            overlap::overlap(cores, &relative, &walk, warm)
        }
    };
    let margins = [a.convex.margin(), b.convex.margin()];
    let [p, q] = found.points;
    let world = |p: Vector3<f64>| Point3::from(a.placement.point(&p));
    SignedDistance {
        distance: found.distance - (margins[0] + margins[1]),
        points: [
            world(p + found.normal * margins[0]),
            world(q - found.normal * margins[1]),
        ],
        normal: turn(&a.placement.rotation, &found.normal),
    }
}

impl Separation {
    /// Nothing is known where a number is none.
    #[inline(always)]
    fn checked(lower: f64, upper: f64) -> Self {
        Self {
            lower: if lower.is_finite() {
                lower
            } else {
                f64::NEG_INFINITY
            },
            upper: if upper.is_nan() { f64::INFINITY } else { upper },
        }
    }
}

impl Relative {
    #[inline(always)]
    fn new(a: Placed, b: Placed, offset: &Vector3<f64>) -> Self {
        let (ra, rb) = (&a.placement.rotation, &b.placement.rotation);
        let columns = [0, 1, 2].map(|i| {
            let column = Vector3::new(rb[(0, i)], rb[(1, i)], rb[(2, i)]);
            turn_back(ra, &column)
        });
        let rotation = Matrix3::from_columns(&columns);
        let translation = turn_back(ra, offset);
        let reach = a.convex.reach() + b.convex.reach();
        Self {
            size: size(&translation, reach),
            way: turn(&rotation, &b.convex.ball().center) + translation - a.convex.ball().center,
            rotation,
            translation,
        }
    }
    /// Not so when a placement has a number that is none.
    #[inline(always)]
    fn is_finite(&self) -> bool {
        (self.size + self.rotation.iter().sum::<f64>()).is_finite()
    }
}

#[cfg(test)]
mod tests;

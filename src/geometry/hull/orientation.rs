//! Exact signs: on which side of a plane or a line a point is (Shewchuk, "Adaptive Precision Floating-Point Arithmetic
//! and Fast Robust Geometric Predicates", 1997, as in the crate `robust`).
//!
//! They are exact as long as no product of three coordinates underflows, which [`LEAST`] sees to.

use nalgebra::Point3;
use robust::{Coord, Coord3D, orient2d, orient3d};

/// Coordinates nearer to 0 than this \[m\] are taken for 0: 2^-100, some 1e-30 m. What is left are multiples of 2^-152,
/// whose threefold products stay normal numbers.
pub(super) const LEAST: f64 = 1.0 / (1_u128 << 100) as f64;

fn coord(p: &Point3<f64>) -> Coord3D<f64> {
    Coord3D {
        x: p.x,
        y: p.y,
        z: p.z,
    }
}

/// Positive when `p` is strictly on the side of the plane through a, b, c from which they go round counterclockwise,
/// 0 when it is in the plane; six times the volume of the tetrahedron, with the right sign, but only nearly its size.
pub(super) fn height(a: &Point3<f64>, b: &Point3<f64>, c: &Point3<f64>, p: &Point3<f64>) -> f64 {
    -orient3d(coord(a), coord(b), coord(c), coord(p))
}

/// As [`height`], for a line through a and b in the plane of all coordinates but `axis`: positive when `p` is on its left.
pub(super) fn left(a: &Point3<f64>, b: &Point3<f64>, p: &Point3<f64>, axis: usize) -> f64 {
    let flat = |p: &Point3<f64>| Coord {
        x: p[(axis + 1) % 3],
        y: p[(axis + 2) % 3],
    };
    orient2d(flat(a), flat(b), flat(p))
}

/// The first coordinate along which the triangle a, b, c can be flattened and keeps an area; `None` when they lie on one line.
pub(super) fn shadow(a: &Point3<f64>, b: &Point3<f64>, c: &Point3<f64>) -> Option<usize> {
    (0..3).find(|axis| left(a, b, c, *axis) != 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitive::stream;
    use rand::RngExt;

    /// Whole numbers that lie in a plane, or one unit beside it: rounding alone would not tell.
    #[test]
    fn signs_are_those_of_whole_numbers() {
        const SIDE: i64 = 1 << 30;
        let mut rng = stream(11, 0);
        let mut seen = [0; 3];
        for _ in 0..20_000 {
            let mut any = || [0; 3].map(|_: i64| rng.random_range(-SIDE..SIDE));
            let (a, u, v) = (any(), any().map(|x| x >> 12), any().map(|x| x >> 12));
            let (s, t) = (rng.random_range(-50..50), rng.random_range(-50..50));
            let off: [i64; 3] = [0; 3].map(|_: i64| rng.random_range(-1..=1));
            let at =
                |s: i64, t: i64| std::array::from_fn::<i64, 3, _>(|i| a[i] + s * u[i] + t * v[i]);
            let (b, c) = (at(1, 0), at(0, 1));
            let p: [i64; 3] = std::array::from_fn(|i| at(s, t)[i] + off[i]);
            let d = |q: [i64; 3]| std::array::from_fn::<i128, 3, _>(|i| i128::from(q[i] - a[i]));
            let (x, y, z) = (d(b), d(c), d(p));
            let exact = x[0] * (y[1] * z[2] - y[2] * z[1]) - x[1] * (y[0] * z[2] - y[2] * z[0])
                + x[2] * (y[0] * z[1] - y[1] * z[0]);
            // Scaled down as far as hulls go, where underflow would begin to show.
            for scale in [1.0, LEAST] {
                let point = |q: [i64; 3]| Point3::from(q.map(|x| x as f64 * scale));
                let sign = height(&point(a), &point(b), &point(c), &point(p));
                let sign = if sign == 0.0 {
                    0
                } else {
                    sign.signum() as i128
                };
                assert_eq!(sign, exact.signum());
                seen[(sign + 1) as usize] += 1;
            }
        }
        assert!(seen.iter().all(|n| *n > 500), "{seen:?}");
    }
}

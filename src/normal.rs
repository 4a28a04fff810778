//! Standard normal numbers with the same bits on every machine.
//!
//! `rand_distr`'s ziggurat calls `exp` and `ln` of the system's mathematics library, whose last bit differs between
//! systems; a model and a seed must give the same wave everywhere. So: Box and Muller (1958) on the `libm` crate.

use rand::Rng;

/// No draw is farther from zero than this: u > 0 is at least 2^-53, and sqrt(-2 ln 2^-53) = 8.57.
pub(super) const FARTHEST: f64 = 8.58;

/// Fills `values` with independent standard normal numbers, two from every two words of `rng`.
pub(super) fn fill<R: Rng + ?Sized>(rng: &mut R, values: &mut [f64]) {
    for pair in values.chunks_mut(2) {
        // (0, 1] under the logarithm, [0, 1) for the angle.
        let u = ((rng.next_u64() >> 11) + 1) as f64 * (1.0 / (1u64 << 53) as f64);
        let v = (rng.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64);
        let radius = libm::sqrt(-2.0 * libm::log(u));
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * v);
        pair[0] = radius * cos;
        if let Some(second) = pair.get_mut(1) {
            *second = radius * sin;
        }
    }
}

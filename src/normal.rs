//! Standard normal numbers with the same bits on every machine.
//!
//! `rand_distr`'s ziggurat calls `exp` and `ln` of the system's mathematics library, whose last bit differs between
//! systems; a model and a seed must give the same wave everywhere. So: Box and Muller (1958) on the crate's own kernels,
//! many pairs at a time.

use fearless_simd::{Level, dispatch};
use rand::Rng;

use crate::elementary::{ln, sin_cos};

/// Pairs computed together: what the generator makes at once.
const PAIRS: usize = 16;

/// The two words of a pair, little-endian.
type Words = [[u8; 8]; 2];

/// Fills `values` with independent standard normal numbers, two from every two words of `rng`.
pub(super) fn fill<R: Rng + ?Sized>(rng: &mut R, values: &mut [f64]) {
    let mut words: [Words; PAIRS] = Default::default();
    for values in values.chunks_mut(2 * PAIRS) {
        // No more words than are needed, so that what is drawn next does not depend on the size of a block.
        let needed = &mut words[..values.len().div_ceil(2)];
        rng.fill_bytes(needed.as_flattened_mut().as_flattened_mut());
        let normals = dispatch!(Level::new(), _ => transform(&words));
        values.copy_from_slice(&normals.as_flattened()[..values.len()]);
    }
}

/// Box and Muller's transform of uniform numbers.
#[inline(always)]
fn transform(words: &[Words; PAIRS]) -> [[f64; 2]; PAIRS] {
    let (mut x, mut y) = ([0.0; PAIRS], [0.0; PAIRS]);
    for i in 0..PAIRS {
        // From 1 to below 2: 52 random bits under the exponent of 1.
        let [first, second] =
            words[i].map(|word| f64::from_bits(1.0_f64.to_bits() | u64::from_le_bytes(word) >> 12));
        // (0, 1] under the logarithm, [0, 1) for the angle.
        let (u, v) = (first - (1.0 - f64::EPSILON), second - 1.0);
        let radius = (-2.0 * ln(u)).sqrt();
        let (sin, cos) = sin_cos(std::f64::consts::TAU * v);
        x[i] = radius * cos;
        y[i] = radius * sin;
    }
    std::array::from_fn(|i| [x[i], y[i]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitive::stream;

    #[test]
    fn a_pair_takes_two_words_and_vectors_change_no_bit() {
        // From any place in the generator's buffer, any number of values.
        for (skipped, count) in [(0, 1), (1, 2), (0, 31), (3, 32), (0, 33), (61, 270)] {
            let mut rng = stream(3, 1);
            (0..skipped).for_each(|_| _ = rng.next_u32());
            let mut words = stream(3, 1);
            (0..skipped).for_each(|_| _ = words.next_u32());
            let mut values = vec![0.0; count];
            fill(&mut rng, &mut values);
            for pair in values.chunks(2) {
                // The undispatched twin.
                let mut block: [Words; PAIRS] = Default::default();
                block[0] = [(); 2].map(|()| words.next_u64().to_le_bytes());
                for (found, expected) in pair.iter().zip(transform(&block)[0]) {
                    assert_eq!(found.to_bits(), expected.to_bits(), "{skipped} {count}");
                }
            }
            assert_eq!(rng.next_u64(), words.next_u64());
        }
    }

    #[test]
    fn the_farthest_draw_is_within_the_bound() {
        let mut words: [Words; PAIRS] = Default::default();
        // u = 1; all others u = 2^-52 and v = 0.
        words[0] = [[0xff; 8], [0; 8]];
        let normals = transform(&words);
        assert_eq!(normals[0], [0.0; 2]);
        assert!(normals[1][0] > 8.49 && normals[1][0] < 8.5);
    }

    /// The largest distance between the empirical and the normal distribution function.
    fn distance(mut values: Vec<f64>) -> f64 {
        values.sort_by(f64::total_cmp);
        let n = values.len() as f64;
        let at = |(i, x): (usize, &f64)| {
            let below = 0.5 * libm::erfc(-x / std::f64::consts::SQRT_2);
            (below - i as f64 / n)
                .abs()
                .max((below - (i + 1) as f64 / n).abs())
        };
        values.iter().enumerate().map(at).fold(0.0, f64::max)
    }

    /// Seed 11, N = 100 000. The inequality of Dvoretzky, Kiefer and Wolfowitz with Massart's constant, exact at any N:
    /// a false alarm has at most probability 2 exp(-2 N d^2) = 1e-9.
    #[test]
    fn draws_are_normally_distributed() {
        let mut values = vec![0.0; 100_000];
        fill(&mut stream(11, 0), &mut values);
        let bound = libm::sqrt(libm::log(2.0 / 1e-9) / (2.0 * values.len() as f64));
        assert!(distance(values.clone()) < bound);
        // Its power: a spread larger by a tenth, and the right spread in another shape, are caught.
        assert!(distance(values.iter().map(|z| 1.1 * z).collect()) > bound);
        let uniform = |z: &f64| libm::sqrt(3.0) * libm::erf(z / std::f64::consts::SQRT_2);
        assert!(distance(values.iter().map(uniform).collect()) > bound);
    }
}

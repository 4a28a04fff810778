//! exp, ln, sin and cos with the same bits on every machine, for moderate arguments and many of them.
//!
//! The system's mathematics library differs from machine to machine in the last bit, and the `libm` crate, which does not,
//! takes one number at a time. These are branch-free sequences of IEEE operations (never fused), so the compiler may put
//! them into vectors of any width without changing a result. Taylor's series on the reduced argument, to where the next
//! term is below 2^-57; tested against `libm`: exp and ln to 4 machine epsilons of their values, sin and cos to one of 1.

use fearless_simd::{Level, dispatch};
use num_complex::Complex;

/// The largest |x| of [`exp`] and [`sin_cos`].
pub(crate) const LARGEST: f64 = 600.0;

/// Adding and subtracting 3 x 2^51 rounds to the nearest whole number, which then stands in the low bits.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// ln 2 and pi / 2 in parts; the first parts have so many trailing zeros that a product with a whole number below 2^20 is exact.
const LN_2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];
const HALF_PI: [f64; 3] = [
    1.570_796_326_734_125_6,
    6.077_100_506_303_966e-11,
    2.022_266_248_795_950_6e-21,
];

/// e^x for |x| <= [`LARGEST`].
#[inline(always)]
pub(crate) fn exp(x: f64) -> f64 {
    let shifted = x * std::f64::consts::LOG2_E + ROUNDER;
    let k = shifted - ROUNDER;
    let r = (x - k * LN_2[0]) - k * LN_2[1];
    let series = 1.0 + r * horner(r, &EXP);
    // The low bits of `shifted` are k in two's complement: the exponent of 2^k.
    let exponent = shifted.to_bits().wrapping_add(1023) << 52;
    series * f64::from_bits(exponent)
}

/// ln x for normal x > 0.
#[inline(always)]
pub(crate) fn ln(x: f64) -> f64 {
    // x = 2^k m with m from sqrt(1/2) to sqrt 2: so that k is 0 about x = 1, where ln m alone must be accurate.
    let shifted = x.to_bits().wrapping_add(1.0_f64.to_bits() - LEAST_MANTISSA);
    let k = f64::from_bits(WHOLE | (shifted >> 52)) - (f64::from_bits(WHOLE) + 1023.0);
    let m = f64::from_bits((shifted & (u64::MAX >> 12)) + LEAST_MANTISSA);
    // ln m = 2 artanh s, |s| < 0.172.
    let s = (m - 1.0) / (m + 1.0);
    let square = s * s;
    let series = 2.0 * s + 2.0 * s * (square * horner(square, &ARTANH));
    k * LN_2[0] + (k * LN_2[1] + series)
}

/// sqrt(1/2), the least m of [`ln`], as bits.
const LEAST_MANTISSA: u64 = std::f64::consts::FRAC_1_SQRT_2.to_bits();

/// 2^52, as bits: a number below 2^52 put into its low bits is added.
const WHOLE: u64 = 0x433 << 52;

/// sin x and cos x for |x| <= [`LARGEST`].
#[inline(always)]
pub(crate) fn sin_cos(x: f64) -> (f64, f64) {
    let shifted = x * std::f64::consts::FRAC_2_PI + ROUNDER;
    let k = shifted - ROUNDER;
    let r = ((x - k * HALF_PI[0]) - k * HALF_PI[1]) - k * HALF_PI[2];
    let square = r * r;
    let sin = r + r * square * horner(square, &SIN);
    let cos = 1.0 - 0.5 * square + square * square * horner(square, &COS);
    // Quarter turns: exchange in odd quadrants, signs from the second bit of k and of k + 1.
    let quadrant = shifted.to_bits();
    let odd = 0_u64.wrapping_sub(quadrant & 1);
    let pick = |a: f64, b: f64| (a.to_bits() & !odd) | (b.to_bits() & odd);
    let sign = |q: u64| (q & 2) << 62;
    (
        f64::from_bits(pick(sin, cos) ^ sign(quadrant)),
        f64::from_bits(pick(cos, sin) ^ sign(quadrant.wrapping_add(1))),
    )
}

/// e^l (cos p + i sin p) for pairs of `logarithms` and `phases`, none beyond [`LARGEST`], in place of what `numbers` holds.
pub(crate) fn polar(logarithms: &[f64], phases: &[f64], numbers: &mut Vec<Complex<f64>>) {
    numbers.clear();
    numbers.resize(logarithms.len().min(phases.len()), Complex::ZERO);
    dispatch!(Level::new(), _ => polar_loop(logarithms, phases, numbers));
}

/// A loop over slices: an iterator's methods would not be compiled for the processor at hand.
#[inline(always)]
fn polar_loop(logarithms: &[f64], phases: &[f64], numbers: &mut [Complex<f64>]) {
    for ((logarithm, phase), number) in logarithms.iter().zip(phases).zip(numbers) {
        let modulus = exp(*logarithm);
        let (sin, cos) = sin_cos(*phase);
        *number = Complex::new(modulus * cos, modulus * sin);
    }
}

/// c_0 + c_1 x + c_2 x^2 + ..
#[inline(always)]
fn horner<const N: usize>(x: f64, coefficients: &[f64; N]) -> f64 {
    let mut sum = coefficients[N - 1];
    let mut i = N - 1;
    while i > 0 {
        i -= 1;
        sum = sum * x + coefficients[i];
    }
    sum
}

/// (e^r - 1) / r
const EXP: [f64; 14] = reciprocal_factorials(1, 1, [1.0, 1.0]);
/// (sin r - r) / r^3 and (cos r - 1 + r^2 / 2) / r^4, in powers of r^2.
const SIN: [f64; 8] = reciprocal_factorials(3, 2, [-1.0, 1.0]);
const COS: [f64; 7] = reciprocal_factorials(4, 2, [1.0, -1.0]);

/// (artanh s - s) / s^3 in powers of s^2: 1/3, 1/5, ..
const ARTANH: [f64; 10] = {
    let mut coefficients = [0.0; 10];
    let mut i = 0;
    while i < coefficients.len() {
        coefficients[i] = 1.0 / (2 * i + 3) as f64;
        i += 1;
    }
    coefficients
};

/// 1 / n! for n = `first`, `first + step`, .., with alternating `signs`.
const fn reciprocal_factorials<const N: usize>(
    first: usize,
    step: usize,
    signs: [f64; 2],
) -> [f64; N] {
    let mut coefficients = [0.0; N];
    let mut i = 0;
    while i < N {
        let mut factorial = 1.0;
        let mut n = 2;
        while n <= first + i * step {
            factorial *= n as f64;
            n += 1;
        }
        coefficients[i] = signs[i % 2] / factorial;
        i += 1;
    }
    coefficients
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Arguments from tiny to the largest, of both signs, none of them round.
    fn arguments() -> impl Iterator<Item = f64> {
        (0..200_000).map(|i| {
            let share = f64::from(i) / 199_999.0;
            let x = LARGEST * share * share * (1.0 + 1e-9 * share).min(1.0);
            if i % 2 == 0 { x } else { -x }
        })
    }

    #[test]
    fn exp_agrees_with_libm() {
        for x in arguments() {
            let (found, expected) = (exp(x), libm::exp(x));
            assert!(
                (found - expected).abs() <= 4.0 * f64::EPSILON * expected,
                "{x}: {found:e} {expected:e}"
            );
        }
        assert_eq!(exp(0.0), 1.0);
    }

    #[test]
    fn sine_and_cosine_agree_with_libm() {
        for x in arguments() {
            let ((sin, cos), (s, c)) = (sin_cos(x), libm::sincos(x));
            assert!(
                (sin - s).abs() <= f64::EPSILON && (cos - c).abs() <= f64::EPSILON,
                "{x}"
            );
        }
        assert_eq!(sin_cos(0.0), (0.0, 1.0));
    }

    #[test]
    fn ln_agrees_with_libm() {
        // All over (0, 1], close to 1 on both sides, about the powers of two, and where the mantissa is split.
        let shares = (1..=100_000).map(|i| f64::from(i) / 100_000.0);
        let close = (1..=1000).flat_map(|i| {
            let step = f64::from(i) * f64::EPSILON;
            [
                1.0 - step,
                1.0 + step,
                std::f64::consts::FRAC_1_SQRT_2 + step - 500.0 * f64::EPSILON,
            ]
        });
        let powers = (0..=53).flat_map(|k| {
            let power = libm::ldexp(1.0, -k);
            [
                power,
                power * (1.0 + f64::EPSILON),
                power * 0.75,
                power * (std::f64::consts::SQRT_2 - f64::EPSILON),
            ]
        });
        for x in shares.chain(close).chain(powers) {
            let (found, expected) = (ln(x), libm::log(x));
            assert!(
                (found - expected).abs() <= 4.0 * f64::EPSILON * expected.abs(),
                "{x:e}: {found:e} {expected:e}"
            );
        }
        assert_eq!(ln(1.0), 0.0);
    }

    #[test]
    fn polar_numbers_are_exp_and_sin_cos_to_the_last_bit() {
        let l: Vec<f64> = arguments().step_by(1999).collect();
        let p: Vec<f64> = l.iter().map(|l| 0.01 * l).collect();
        // So that some are left over when vectors are full.
        assert!(!l.len().is_multiple_of(2));
        let mut numbers = vec![Complex::ONE];
        polar(&l, &p, &mut numbers);
        assert_eq!(numbers.len(), l.len());
        for ((number, l), p) in numbers.iter().zip(l).zip(p) {
            let (modulus, (sin, cos)) = (exp(l), sin_cos(p));
            assert_eq!(number.re.to_bits(), (modulus * cos).to_bits());
            assert_eq!(number.im.to_bits(), (modulus * sin).to_bits());
        }
    }
}

//! Waves of no particular model.

use std::ops::RangeInclusive;

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use proptest::collection::vec;
use proptest::prelude::*;

use super::super::argument::require_counts;
use crate::fourier::{Joints, Wave};

/// ln of the smallest modulus \[ln rad\], and how much larger one may be.
const SMALLEST: f64 = -4.0;
const LARGER: f64 = 3.5;

/// Waves of up to so many joints and harmonics: periods of 0.5 to 10 s, offsets within 2 rad, moduli from e^-4 to e^-0.5 rad,
/// any phases. They shrink to fewer joints and harmonics, and to weights of modulus e^-4 and phase 0.
///
/// ```
/// use proptest::prelude::*;
/// use undulate::testing::waves;
///
/// proptest!(|(wave in waves(1..=3, 1..=4), t in -9.0..9.0)| {
///     let gap = wave.position(t + wave.period()) - wave.position(t);
///     prop_assert!(gap.amax() < 1e-12);
/// });
/// ```
///
/// # Panics
/// When `joints` or `harmonics` is an empty range or starts at 0.
#[track_caller]
pub fn waves(
    joints: RangeInclusive<usize>,
    harmonics: RangeInclusive<usize>,
) -> impl Strategy<Value = Wave> {
    require_counts("joints", &joints, 1);
    require_counts("harmonics", &harmonics, 1);
    let (most_joints, most_harmonics) = (*joints.end(), *harmonics.end());
    let polar = (0.0..LARGER, 0.0..std::f64::consts::TAU);
    // The shape first, and the rest as it is for the largest one, so that fewer joints leave the others as they are: what is drawn anew for
    // each shape is shrunk anew for each.
    let weights = vec(polar, most_joints * most_harmonics);
    (
        joints,
        harmonics,
        0.5..10.0,
        weights,
        vec(-2.0..2.0f64, most_joints),
    )
        .prop_map(move |(joints, harmonics, period, weights, offsets)| {
            let weights = DMatrix::from_fn(joints, harmonics, |d, k| {
                let (logarithm, phase) = weights[d * most_harmonics + k];
                Complex::from_polar((SMALLEST + logarithm).exp(), phase)
            });
            Wave::new(
                Joints::new((0..joints).map(|d| format!("joint_{d}"))).expect("at least one joint"),
                period,
                DVector::from_column_slice(&offsets[..joints]),
                weights,
            )
            .expect("drawn within what a wave may be")
        })
}

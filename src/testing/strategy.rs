//! Strategies: what proptest draws.

use std::ops::RangeInclusive;

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use proptest::collection::vec;
use proptest::prelude::*;

use crate::fourier::{Joints, Wave};
use crate::primitive::{FourierMovementPrimitive, Gaussian, LogPolar};

/// Waves of up to so many joints and harmonics: periods of 0.5 to 10 s, offsets within 2 rad, moduli from e^-4 to e^-0.5 rad,
/// any phases. They shrink to fewer joints and harmonics, and to weights of modulus e^-4 and phase 0.
pub fn waves(
    joints: RangeInclusive<usize>,
    harmonics: RangeInclusive<usize>,
) -> impl Strategy<Value = Wave> {
    (joints, harmonics, 0.5..10.0).prop_flat_map(|(joints, harmonics, period)| {
        let polar = (-4.0..-0.5f64, 0.0..std::f64::consts::TAU);
        (vec(polar, joints * harmonics), vec(-2.0..2.0f64, joints)).prop_map(
            move |(weights, offsets)| {
                let weights = weights
                    .iter()
                    .map(|(logarithm, phase)| Complex::from_polar(logarithm.exp(), *phase));
                Wave::new(
                    Joints::new((0..joints).map(|d| format!("joint_{d}")))
                        .expect("at least one joint"),
                    period,
                    DVector::from_vec(offsets),
                    DMatrix::from_iterator(joints, harmonics, weights),
                )
                .expect("drawn within what a wave may be")
            },
        )
    })
}

/// Gaussians of `dimension` with factors of `rank` columns: means within 1, entries of the factor within 0.5.
pub fn gaussians(dimension: usize, rank: usize) -> impl Strategy<Value = Gaussian> {
    (
        vec(-1.0..1.0f64, dimension),
        vec(-0.5..0.5f64, dimension * rank),
    )
        .prop_map(move |(mean, factor)| {
            Gaussian::new(
                DVector::from_vec(mean),
                DMatrix::from_vec(dimension, rank, factor),
            )
            .expect("finite and of fitting sizes")
        })
}

/// Primitives of up to so many joints and harmonics, and of this rank.
pub fn primitives(
    joints: RangeInclusive<usize>,
    harmonics: RangeInclusive<usize>,
    rank: usize,
) -> impl Strategy<Value = FourierMovementPrimitive> {
    waves(joints, harmonics).prop_flat_map(move |wave| {
        let chart = LogPolar::of(&wave);
        gaussians(chart.dimension(), rank).prop_map(move |gaussian| {
            FourierMovementPrimitive::new(chart.clone(), gaussian)
                .expect("a Gaussian of the chart's dimension, far from overflow")
        })
    })
}

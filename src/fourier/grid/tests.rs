//! The grid against the series, and its vectors against each other.

use super::*;
use crate::fourier::Joints;
use nalgebra::DVector;
use num_complex::Complex;

const HARMONICS: usize = 25;

fn wave(joints: usize) -> Wave {
    let number = |i: usize| libm::sin(1.7 * i as f64 + 0.3);
    let weights = DMatrix::from_fn(joints, HARMONICS, |d, k| {
        let i = d * HARMONICS + k;
        Complex::new(number(i), number(i + 1000)) / (k + 1) as f64
    });
    let names = Joints::new((0..joints).map(|d| format!("joint_{d}"))).unwrap();
    Wave::new(
        names,
        2.3,
        DVector::from_fn(joints, |d, _| number(d + 2000)),
        weights,
    )
    .unwrap()
}

/// The vectors of every processor that this one can stand in for.
fn levels() -> Vec<Level> {
    let best = Level::new();
    let mut levels = vec![Level::baseline(), best];
    #[cfg(target_arch = "x86_64")]
    levels.extend(
        [
            best.as_sse4_2().map(Simd::level),
            best.as_avx2().map(Simd::level),
        ]
        .into_iter()
        .flatten(),
    );
    levels
}

#[test]
fn vectors_of_every_width_give_the_same_bits() {
    for (points, joints) in [
        (1, 1),
        (2, 3),
        (7, 2),
        (16, 1),
        (33, 5),
        (100, 4),
        (500, 5),
        (501, 5),
    ] {
        let (wave, grid) = (wave(joints), PeriodGrid::new(points, HARMONICS));
        for derivative in [Derivative::Position, Derivative::Velocity, Derivative::Jerk] {
            let expected = grid.evaluate(&wave, derivative);
            let series = Series::new(&wave, derivative);
            for level in levels() {
                let mut values = DMatrix::zeros(points, joints);
                dispatch!(level, simd => grid.sum(simd, &series, values.as_mut_slice()));
                for (found, expected) in values.iter().zip(&expected) {
                    assert_eq!(found.to_bits(), expected.to_bits(), "{points} {level:?}");
                }
            }
        }
    }
}

/// Sums of single numbers in the documented order, where multiplication and addition cannot be one.
#[test]
fn the_bits_are_those_of_single_numbers() {
    let (points, wave) = (500, wave(3));
    let grid = PeriodGrid::new(points, HARMONICS);
    let values = wave.on_grid(&grid, Derivative::Position);
    for d in 0..3 {
        for n in 1..=points / 4 - LANES {
            let sum = |parity: usize| {
                let (mut cosines, mut sines) = (0.0, 0.0);
                for k in by_parity(HARMONICS).filter(|k| k % 2 == parity) {
                    let turned = (k * n % points) as f64;
                    let (sin, cos) = libm::sincos(std::f64::consts::TAU * turned / points as f64);
                    let weight = wave.weights()[(d, k - 1)];
                    cosines += std::hint::black_box(2.0 * weight.re * cos);
                    sines += std::hint::black_box(-2.0 * weight.im * sin);
                }
                (cosines, sines)
            };
            let (even, odd) = (sum(0), sum(1));
            let expected = wave.offsets()[d] + ((even.0 + odd.0) + (even.1 + odd.1));
            assert_eq!(values[(n, d)].to_bits(), expected.to_bits(), "{n}");
        }
    }
}

#[test]
fn a_long_grid_is_the_series_at_its_points() {
    let wave = wave(5);
    for points in [500, 501] {
        // With harmonics to spare.
        let grid = PeriodGrid::new(points, HARMONICS + 3);
        let values = wave.on_grid(&grid, Derivative::Velocity);
        for (n, t) in grid.times(wave.period()).into_iter().enumerate() {
            let state = wave.state(t);
            for d in 0..5 {
                let scale = wave.harmonic_sum(d, 1);
                assert!(
                    (values[(n, d)] - state.velocity[d]).abs() < 1e-12 * scale,
                    "{n}"
                );
            }
        }
    }
}

//! Random waves of a robot's joints.

use rand::Rng;
use undulate::nalgebra::{DMatrix, DVector};
use undulate::num_complex::Complex;
use undulate::{Joints, Robot, Wave};

/// A number from 0 to 1.
pub fn uniform<R: Rng + ?Sized>(rng: &mut R) -> f64 {
    (rng.next_u64() >> 11) as f64 / (1u64 << 53) as f64
}

/// A wave about a posture anywhere within the limits (3 rad where there are none), with most of its motion in a few harmonics about one in ten of
/// `harmonics`, as people wave, and up to `size` rad of it.
pub fn random_wave<R: Rng + ?Sized>(
    robot: &Robot,
    harmonics: usize,
    period: f64,
    size: f64,
    rng: &mut R,
) -> Wave {
    let joints: &Joints = robot.joints();
    let offsets = DVector::from_fn(joints.len(), |j, _| {
        let u = uniform(rng);
        match robot.properties(j).position {
            Some(range) => {
                range.lower.max(-3.0) + u * (range.upper.min(3.0) - range.lower.max(-3.0))
            }
            None => 6.0 * u - 3.0,
        }
    });
    let beat = 1.0 + uniform(rng) * 0.4 * harmonics as f64;
    let size = size * uniform(rng);
    let weights = DMatrix::from_fn(joints.len(), harmonics, |_, k| {
        let away = (k as f64 + 1.0 - beat).abs();
        let modulus = 0.5 * size * uniform(rng) * (-away).exp();
        Complex::from_polar(modulus, std::f64::consts::TAU * uniform(rng))
    });
    Wave::new(joints.clone(), period, offsets, weights).unwrap()
}

//! A wave as a motion.

use fearless_simd::{Level, Simd, SimdBase, dispatch, f64x4};

use super::{LANES, Motion, Tube};
use crate::elementary::sin_cos;
use crate::fourier::{Derivative, Extremes, Joints, State, Wave};

/// Pieces of the period for each harmonic to start from: at the highest, Taylor's remainders are of use from the start.
const PIECES: f64 = 2.4;

impl Motion for Wave {
    type Tube<'a> = WaveTube<'a>;

    fn joints(&self) -> &Joints {
        self.joints()
    }

    fn duration(&self) -> f64 {
        self.period()
    }

    fn is_periodic(&self) -> bool {
        true
    }

    fn state_into(&self, t: f64, state: &mut State) {
        self.state_into(t, state);
    }

    fn extremes(&self, joint: usize, derivative: Derivative) -> Extremes {
        self.extremes(joint, derivative)
    }

    fn tube(&self) -> WaveTube<'_> {
        WaveTube::new(self)
    }
}

/// The positions of a wave over intervals: Taylor's theorem about the middle, with remainders of first, second and third
/// order from the harmonic sums (see [`Wave::enclosure`]).
#[derive(Debug)]
pub struct WaveTube<'a> {
    wave: &'a Wave,
    /// Of each harmonic and joint, a and b of a cos(k w t) + b sin(k w t).
    terms: Vec<[f64; 2]>,
    bounds: Vec<Bounds>,
}

/// Of one joint.
#[derive(Debug)]
struct Bounds {
    offset: f64,
    /// The largest displacement, speed, acceleration and jerk.
    sums: [f64; 4],
    /// What rounding does to position, velocity and acceleration at a time within the period.
    rounding: [f64; 3],
}

impl<'a> WaveTube<'a> {
    fn new(wave: &'a Wave) -> Self {
        let weights = wave.weights().iter();
        let slack = wave.slack();
        let bounds = (0..wave.joints().len())
            .map(|joint| {
                let sums: [f64; 4] = std::array::from_fn(|i| wave.harmonic_sum(joint, i as i32));
                let offset = wave.offsets()[joint];
                Bounds {
                    offset,
                    sums,
                    rounding: [
                        slack * 2.0 * (sums[0] + offset.abs()),
                        slack * sums[1],
                        slack * sums[2],
                    ],
                }
            })
            .collect();
        Self {
            wave,
            // Column-major: harmonic by harmonic, joint by joint.
            terms: weights.map(|w| [2.0 * w.re, -2.0 * w.im]).collect(),
            bounds,
        }
    }

    /// Position, velocity and acceleration of all joints at four times, and the radii that follow.
    #[inline(always)]
    fn evaluate<S: Simd>(
        &self,
        simd: S,
        middle: &[f64; LANES],
        half: &[f64; LANES],
        position: &mut [[f64; LANES]],
        radius: &mut [[f64; LANES]],
    ) {
        let period = self.wave.period();
        let w = self.wave.angular_frequency();
        let (mut sin, mut cos, mut late) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            let turns = middle[lane] / period;
            (sin[lane], cos[lane]) = sin_cos(std::f64::consts::TAU * (turns - turns.floor()));
            // Dividing a late time by the period loses digits of the phase, and neighbouring intervals meet but for rounding.
            late[lane] = 8.0 * f64::EPSILON * (middle[lane].abs() + period);
        }
        let step = [
            f64x4::load_array_ref(simd, &cos),
            f64x4::load_array_ref(simd, &sin),
        ];
        let h = f64x4::load_array_ref(simd, half);
        let late = f64x4::load_array_ref(simd, &late);
        let joints = self.bounds.len();
        let zero = f64x4::splat(simd, 0.0);
        for (joint, bounds) in self.bounds.iter().enumerate() {
            let [mut c, mut s] = step;
            let (mut value, mut slope, mut curvature) = (zero, zero, zero);
            let mut k = 1.0;
            let mut at = joint;
            while let Some([a, b]) = self.terms.get(at) {
                let even = c * *a + s * *b;
                let odd = c * *b - s * *a;
                value += even;
                slope += odd * k;
                curvature += even * (k * k);
                (c, s) = (c * step[0] - s * step[1], s * step[0] + c * step[1]);
                k += 1.0;
                at += joints;
            }
            let [s0, s1, s2, s3] = bounds.sums;
            let slope = slope.abs() * w + bounds.rounding[1];
            let curvature = curvature.abs() * (w * w) + bounds.rounding[2];
            let first = h * s1;
            let second = h * (slope + h * (s2 / 2.0));
            let third = h * (slope + h * (curvature * 0.5 + h * (s3 / 6.0)));
            let moved = first
                .min(second)
                .min(third)
                .min(f64x4::splat(simd, 2.0 * s0));
            let widened = moved * (1.0 + 16.0 * f64::EPSILON) + late * s1 + bounds.rounding[0];
            (value + bounds.offset).store_slice(&mut position[joint]);
            widened.store_slice(&mut radius[joint]);
        }
    }
}

impl Tube for WaveTube<'_> {
    fn pieces(&self, pieces: &mut Vec<(f64, f64)>) {
        let count = (PIECES * self.wave.harmonics() as f64 / LANES as f64)
            .ceil()
            .max(1.0)
            * LANES as f64;
        let half = self.wave.period() / (2.0 * count);
        pieces.extend((0..count as usize).map(|n| ((2 * n + 1) as f64 * half, half)));
    }

    fn over(&mut self, middle: f64, half: f64, position: &mut [f64], radius: &mut [f64]) {
        let joints = self.bounds.len();
        let (mut q, mut r) = (vec![[0.0; LANES]; joints], vec![[0.0; LANES]; joints]);
        self.over_four(&[middle; LANES], &[half; LANES], &mut q, &mut r);
        for joint in 0..joints {
            (position[joint], radius[joint]) = (q[joint][0], r[joint][0]);
        }
    }

    fn over_four(
        &mut self,
        middle: &[f64; LANES],
        half: &[f64; LANES],
        position: &mut [[f64; LANES]],
        radius: &mut [[f64; LANES]],
    ) {
        dispatch!(Level::new(), simd => self.evaluate(simd, middle, half, position, radius));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitive::stream;
    use nalgebra::{DMatrix, DVector};
    use num_complex::Complex;
    use rand::Rng;

    fn uniform<R: Rng>(rng: &mut R) -> f64 {
        (rng.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A wave of three joints and up to twelve harmonics.
    fn wave(seed: u64) -> Wave {
        let mut rng = stream(seed, 0);
        let harmonics = 1 + (rng.next_u64() % 12) as usize;
        let mut number = || 2.0 * uniform(&mut rng) - 1.0;
        let weights = DMatrix::from_fn(3, harmonics, |_, k| {
            Complex::new(number(), number()) / (k + 1) as f64
        });
        let offsets = DVector::from_fn(3, |_, _| number());
        Wave::new(Joints::new(["a", "b", "c"]).unwrap(), 3.0, offsets, weights).unwrap()
    }

    #[test]
    fn a_tube_contains_the_wave_and_shrinks_to_it() {
        for seed in 0..40 {
            let wave = wave(seed);
            let mut tube = wave.tube();
            let (mut q, mut r) = ([0.0; 3], [0.0; 3]);
            for n in 0..50 {
                let (middle, half) = (-4.0 + 0.31 * f64::from(n), 0.5 / f64::from(1 << (n % 12)));
                tube.over(middle, half, &mut q, &mut r);
                for i in 0..=20 {
                    let t = middle + half * (f64::from(i) / 10.0 - 1.0);
                    let at = wave.position(t);
                    for joint in 0..3 {
                        assert!(
                            (at[joint] - q[joint]).abs() <= r[joint],
                            "{seed} {middle} {half}"
                        );
                    }
                }
                tube.over(middle, 0.0, &mut q, &mut r);
                assert!(r.iter().all(|r| *r < 1e-11), "{r:?}");
            }
        }
    }

    #[test]
    fn vectors_of_any_width_give_the_same_bits() {
        let wave = wave(7);
        let tube = wave.tube();
        let middle = [0.1, 0.9, -2.0, 7.0];
        let half = [0.01, 0.1, 0.0, 2.0];
        let at = |level: Level| {
            let mut numbers = [[[0.0; LANES]; 3]; 2];
            let [q, r] = &mut numbers;
            dispatch!(level, simd => tube.evaluate(simd, &middle, &half, q, r));
            numbers
        };
        assert_eq!(at(Level::baseline()), at(Level::new()));
    }

    #[test]
    fn pieces_cover_the_period() {
        let wave = wave(3);
        let mut pieces = Vec::new();
        wave.tube().pieces(&mut pieces);
        let mut end = 0.0;
        for (middle, half) in pieces {
            assert!((middle - half - end).abs() < 1e-15);
            end = middle + half;
        }
        assert!((end - wave.period()).abs() < 1e-14);
    }
}

//! A wave as a motion.

use fearless_simd::{Level, Simd, SimdBase, dispatch, f64x8};

use super::{LANES, Motion, Tube, TubeRows};
use crate::elementary::sin_cos;
use crate::fourier::{Derivative, Extremes, Joints, State, Wave};

/// Pieces of the period for each harmonic to start from: at the highest, Taylor's remainders are of use from the start.
const PIECES: f64 = 1.8;

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
    /// Of each joint and harmonic, a and b of a cos(k w t) + b sin(k w t).
    terms: Vec<[f64; 2]>,
    bounds: Vec<Bounds>,
    /// Of each harmonic, cos(k w t) and sin(k w t) at the times at hand.
    turns: Vec<[[f64; LANES]; 2]>,
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
        let mut terms = Vec::with_capacity(wave.weights().len());
        for row in wave.weights().row_iter() {
            terms.extend(row.iter().map(|w| [2.0 * w.re, -2.0 * w.im]));
        }
        let slack = wave.slack();
        let bounds = (0..wave.joints().len())
            .map(|joint| {
                let sums = wave.harmonic_sums(joint);
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
            terms,
            bounds,
            turns: vec![[[0.0; LANES]; 2]; wave.harmonics()],
        }
    }

    /// Position, velocity and acceleration of all joints at several times, and the radii that follow.
    #[inline(always)]
    fn evaluate<S: Simd>(
        &mut self,
        simd: S,
        middle: &[f64; LANES],
        half: &[f64; LANES],
        rows: &mut TubeRows,
    ) {
        let period = self.wave.period();
        let mut late = [0.0; LANES];
        for lane in 0..LANES {
            // Dividing a late time by the period loses digits of the phase, and neighbouring intervals meet but for rounding.
            late[lane] = 8.0 * f64::EPSILON * (middle[lane].abs() + period);
        }
        let h = f64x8::load_array_ref(simd, half);
        let late = f64x8::load_array_ref(simd, &late);
        self.turn(simd, middle);
        let joints = self.bounds.len();
        let whole = joints - joints % TOGETHER;
        for joint in (0..whole).step_by(TOGETHER) {
            self.block::<S, TOGETHER>(simd, joint, [h, late], rows);
        }
        for joint in whole..joints {
            self.block::<S, 1>(simd, joint, [h, late], rows);
        }
    }

    /// The powers of exp(i w t): odd and even ones apart, so that neither waits for the other.
    #[inline(always)]
    fn turn<S: Simd>(&mut self, simd: S, middle: &[f64; LANES]) {
        let (mut sin, mut cos) = ([0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            let turns = middle[lane] / self.wave.period();
            (sin[lane], cos[lane]) = sin_cos(std::f64::consts::TAU * (turns - turns.floor()));
        }
        let one = [
            f64x8::load_array_ref(simd, &cos),
            f64x8::load_array_ref(simd, &sin),
        ];
        let two = product(one, one);
        let (mut odd, mut even) = (one, two);
        for pair in self.turns.chunks_mut(2) {
            odd[0].store_slice(&mut pair[0][0]);
            odd[1].store_slice(&mut pair[0][1]);
            if let Some(second) = pair.get_mut(1) {
                even[0].store_slice(&mut second[0]);
                even[1].store_slice(&mut second[1]);
            }
            odd = product(odd, two);
            even = product(even, two);
        }
    }

    /// J joints from `first` on.
    #[inline(always)]
    fn block<S: Simd, const J: usize>(
        &self,
        simd: S,
        first: usize,
        [h, late]: [f64x8<S>; 2],
        rows: &mut TubeRows,
    ) {
        let w = self.wave.angular_frequency();
        let harmonics = self.turns.len();
        let terms = &self.terms[first * harmonics..][..J * harmonics];
        let zero = f64x8::splat(simd, 0.0);
        let (mut value, mut slope, mut curvature) = ([zero; J], [zero; J], [zero; J]);
        let mut k = 1.0;
        for (i, [cos, sin]) in self.turns.iter().enumerate() {
            let c = f64x8::load_array_ref(simd, cos);
            let s = f64x8::load_array_ref(simd, sin);
            for j in 0..J {
                let [a, b] = terms[j * harmonics + i];
                let even = c * a + s * b;
                let odd = c * b - s * a;
                value[j] += even;
                slope[j] += odd * k;
                curvature[j] += even * (k * k);
            }
            k += 1.0;
        }
        for j in 0..J {
            let bounds = &self.bounds[first + j];
            let [s0, s1, s2, s3] = bounds.sums;
            let velocity = slope[j] * w;
            let slope = velocity.abs() + bounds.rounding[1];
            let curvature = curvature[j].abs() * (w * w) + bounds.rounding[2];
            // How far it can be from its tangent, and from where it is.
            let by_second = h * h * (s2 / 2.0);
            let by_third = h * h * (curvature * 0.5 + h * (s3 / 6.0));
            let bend = by_second.min(by_third);
            let moved = (h * slope + bend)
                .min(h * s1)
                .min(f64x8::splat(simd, 2.0 * s0));
            let rounding = late * s1 + bounds.rounding[0];
            let bend = bend * OUTWARD + h * bounds.rounding[1] + rounding;
            (value[j] + bounds.offset).store_slice(&mut rows.position[first + j]);
            (moved * OUTWARD + rounding).store_slice(&mut rows.radius[first + j]);
            velocity.store_slice(&mut rows.velocity[first + j]);
            bend.store_slice(&mut rows.bend[first + j]);
        }
    }
}

/// A few dozen roundings.
const OUTWARD: f64 = 1.0 + 16.0 * f64::EPSILON;

/// Joints whose sums are formed together: with three, none waits for another, and all fit into sixteen registers.
const TOGETHER: usize = 3;

/// Of complex numbers.
#[inline(always)]
fn product<S: Simd>(a: [f64x8<S>; 2], b: [f64x8<S>; 2]) -> [f64x8<S>; 2] {
    [a[0] * b[0] - a[1] * b[1], a[1] * b[0] + a[0] * b[1]]
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
        let mut rows = TubeRows::new(joints);
        self.over_lanes(&[middle; LANES], &[half; LANES], &mut rows);
        for joint in 0..joints {
            (position[joint], radius[joint]) = (rows.position[joint][0], rows.radius[joint][0]);
        }
    }

    fn over_lanes(&mut self, middle: &[f64; LANES], half: &[f64; LANES], rows: &mut TubeRows) {
        dispatch!(Level::new(), simd => self.evaluate(simd, middle, half, rows));
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
                let mut rows = TubeRows::new(3);
                tube.over_lanes(&[middle; LANES], &[half; LANES], &mut rows);
                for i in 0..=20 {
                    let t = middle + half * (f64::from(i) / 10.0 - 1.0);
                    let at = wave.position(t);
                    for joint in 0..3 {
                        let ahead = rows.velocity[joint][0] * (t - middle);
                        assert!((at[joint] - q[joint] - ahead).abs() <= rows.bend[joint][0]);
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
        let mut tube = wave.tube();
        let middle = [0.1, 0.9, -2.0, 7.0, 0.0, 2.9, 1.3, -0.4];
        let half = [0.01, 0.1, 0.0, 2.0, 0.3, 0.02, 1e-6, 1.0];
        let mut at = |level: Level| {
            let mut numbers = TubeRows::new(3);
            dispatch!(level, simd => tube.evaluate(simd, &middle, &half, &mut numbers));
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

//! [`Yardstick`]: how a motion is measured where one demonstration is left out.

use std::f64::consts::TAU;

use nalgebra::DMatrix;
use num_complex::Complex;

use super::DISTANCES;
use crate::demonstration::{Course, Recording, Variation};
use crate::error::{Error, ErrorKind, Result};

/// Length of a window, in cycles of the left-out demonstration, and its points.
const CYCLES: f64 = 2.0;
const POINTS: usize = 32;

/// Third octaves from here \[Hz\] to here, or to half of the rate.
const LOWEST: f64 = 0.3;
const HIGHEST: f64 = 10.0;

/// Frequencies looked at in a third octave.
const TONES: usize = 8;

/// Amplitudes, spreads and variations below these are not seen: 0.1 deg, 0.1 %.
const FAINT: f64 = TAU / 3600.0;
const STEADY: f64 = 1e-3;

/// Farther than so much of the half range that was demonstrated a joint is beyond anything demonstrated.
const BEYOND: f64 = 1.5;

/// Scales that the demonstrations which are learned from set, and the times of the one that is left out.
pub(super) struct Yardstick<'a> {
    truth: &'a Recording,
    /// The joint whose turning points align motions.
    joint: usize,
    /// Standard deviations of joints about the mean of each recording (D) \[rad\], and of a course's entries.
    spreads: Vec<f64>,
    course_spreads: Vec<f64>,
    /// Of each joint, what lies beyond is beyond anything demonstrated \[rad\].
    ranges: Vec<(f64, f64)>,
    /// Length of a window \[s\].
    window: f64,
    /// One a band, its tones: Hann-weighted, normalised turns of N samples each.
    bands: Vec<Vec<Vec<Complex<f64>>>>,
}

/// What is measured of a motion.
pub(super) struct Measured {
    /// The vectors that distances compare, in the order of [`Distance`](super::Distance).
    pub vectors: [Vec<Vec<f64>>; DISTANCES],
    pub variation: Result<Variation>,
    /// Of each joint, the product of its first harmonic and the conjugate of the reference joint's.
    pub relative: Vec<Complex<f64>>,
    /// RMS jerk over RMS velocity and squared angular frequency: 1 for a sinusoid.
    pub jerk: f64,
    /// Whether a joint is beyond anything demonstrated.
    pub is_beyond: bool,
}

impl<'a> Yardstick<'a> {
    /// # Errors
    /// When the left-out demonstration has no rhythm, or none of the others.
    pub fn new(learned: &[Recording], truth: &'a Recording, joint: usize) -> Result<Self> {
        let frequency = Variation::of(truth)?.frequency;
        let joints = 0..truth.joints().len();
        let column = |r: &Recording, d: usize| -> Vec<f64> {
            r.positions().column(d).iter().copied().collect()
        };
        // About each recording's own posture: a gesture is what moves.
        let spread = |d: usize| {
            let about = |r: &Recording| {
                let y = column(r, d);
                let mean = y.iter().sum::<f64>() / y.len() as f64;
                y.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / y.len() as f64
            };
            let square = learned.iter().map(about).sum::<f64>() / learned.len() as f64;
            square.sqrt().max(FAINT)
        };
        let range = |d: usize| {
            let all = learned.iter().flat_map(|r| column(r, d));
            let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| {
                (low.min(y), high.max(y))
            });
            let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
            (middle - BEYOND * half, middle + BEYOND * half)
        };
        let courses: Vec<Vec<f64>> = learned
            .iter()
            .filter_map(|r| Some(course(&Variation::of(r).ok()?, joint)))
            .collect();
        if courses.len() < 2 {
            return Err(Error::new(
                ErrorKind::Infeasible,
                "fewer than two recordings with a rhythm",
            ));
        }
        let count = courses.len() as f64;
        let course_spread = |i: usize| {
            let mean = courses.iter().map(|c| c[i]).sum::<f64>() / count;
            let square: f64 = courses.iter().map(|c| (c[i] - mean).powi(2)).sum();
            (square / (count - 1.0)).sqrt().max(STEADY)
        };
        let cycles = (truth.span() * frequency - 1.0).clamp(1.0, CYCLES);
        Ok(Self {
            truth,
            joint,
            spreads: joints.clone().map(spread).collect(),
            course_spreads: (0..courses[0].len()).map(course_spread).collect(),
            ranges: joints.map(range).collect(),
            window: cycles / frequency,
            bands: bands(truth.times()),
        })
    }

    /// A motion at the left-out demonstration's times.
    ///
    /// # Errors
    /// When a position is not finite.
    pub fn measure(&self, positions: DMatrix<f64>) -> Result<Measured> {
        let (joints, times) = (self.truth.joints().clone(), self.truth.times().to_vec());
        let motion = Recording::new("draw", joints, times, positions)?;
        let course = Course::of(&motion, self.joint);
        let frequency = course.variation.as_ref().map_or(f64::NAN, |v| v.frequency);
        let of_course = |v: &Variation| {
            let entries = self::course(v, self.joint);
            let root = (entries.len() as f64).sqrt();
            let scaled = entries.iter().zip(&self.course_spreads);
            scaled.map(|(x, s)| x / (s * root)).collect()
        };
        let y = motion.positions();
        let is_beyond = self
            .ranges
            .iter()
            .zip(y.column_iter())
            .any(|((low, high), y)| y.min() < *low || y.max() > *high);
        let [power, level] = self.spectrum(&motion);
        Ok(Measured {
            vectors: [
                self.windows(&motion, &course.turns),
                vec![power],
                vec![level],
                course.variation.iter().map(of_course).collect(),
            ],
            jerk: jerk(&motion) / (TAU * frequency).powi(2),
            relative: course.relative,
            variation: course.variation,
            is_beyond,
        })
    }

    /// Stretches of the motion that begin at turning points, each joint about its mean, in units of the joints' spreads; a motion that turns nowhere is seen as it is.
    fn windows(&self, motion: &Recording, turns: &[f64]) -> Vec<Vec<f64>> {
        let times = motion.times();
        let (first, last) = (times[0], times[times.len() - 1]);
        let fits = |start: &f64| *start >= first && start + self.window <= last;
        let mut starts: Vec<f64> = turns.iter().copied().filter(fits).collect();
        if starts.is_empty() {
            starts = vec![first, (last - self.window).max(first)];
        }
        let root = ((POINTS * self.spreads.len()) as f64).sqrt();
        let window = |start: f64| {
            let mut values = Vec::with_capacity(POINTS * self.spreads.len());
            for (y, spread) in motion.positions().column_iter().zip(&self.spreads) {
                let at = |i: usize| {
                    let t = start + self.window * i as f64 / (POINTS - 1) as f64;
                    let next = times.partition_point(|u| *u <= t).clamp(1, times.len() - 1);
                    let step = times[next] - times[next - 1];
                    let share = ((t - times[next - 1]) / step).min(1.0);
                    y[next - 1] + share * (y[next] - y[next - 1])
                };
                let seen: Vec<f64> = (0..POINTS).map(at).collect();
                let mean = seen.iter().sum::<f64>() / POINTS as f64;
                values.extend(seen.iter().map(|y| (y - mean) / (spread * root)));
            }
            values
        };
        starts.into_iter().map(window).collect()
    }

    /// Amplitudes of each joint in third octaves, in units of the joints' spreads, and as levels \[dB\].
    fn spectrum(&self, motion: &Recording) -> [Vec<f64>; 2] {
        let flat = motion.without_drift();
        let (mut amplitudes, mut levels) = (Vec::new(), Vec::new());
        for (y, spread) in flat.positions().column_iter().zip(&self.spreads) {
            let mean = y.mean();
            for tones in &self.bands {
                let square = |tone: &Vec<Complex<f64>>| {
                    let terms = tone.iter().zip(y.iter()).map(|(e, y)| e * (y - mean));
                    terms.sum::<Complex<f64>>().norm_sqr()
                };
                let power = tones.iter().map(square).sum::<f64>() / tones.len() as f64;
                amplitudes.push(power.sqrt() / spread);
                levels.push(20.0 * (power.sqrt() + FAINT).log10());
            }
        }
        let root = (levels.len() as f64).sqrt();
        levels.iter_mut().for_each(|l| *l /= root);
        [amplitudes, levels]
    }
}

/// ln of what is seen of a motion as a whole: tempo, size, and how both vary.
fn course(variation: &Variation, joint: usize) -> Vec<f64> {
    vec![
        variation.frequency.ln(),
        variation.swing[joint].max(FAINT).ln(),
        (variation.envelope + STEADY).ln(),
        (variation.tempo + STEADY).ln(),
    ]
}

/// Of each third octave below half of the rate, tones by which a Hann-weighted sum of samples is the amplitude of a sinusoid.
fn bands(times: &[f64]) -> Vec<Vec<Vec<Complex<f64>>>> {
    let span = times[times.len() - 1] - times[0];
    let nyquist = (times.len() - 1) as f64 / (2.0 * span);
    let share = |t: f64| (t - times[0]) / span;
    let hann: Vec<f64> = times
        .iter()
        .map(|t| (std::f64::consts::PI * share(*t)).sin().powi(2))
        .collect();
    let total: f64 = hann.iter().sum();
    let tone = |frequency: f64| -> Vec<Complex<f64>> {
        times
            .iter()
            .zip(&hann)
            .map(|(t, w)| Complex::from_polar(2.0 * w / total, -TAU * frequency * (t - times[0])))
            .collect()
    };
    let third = |i: f64| LOWEST * (i / 3.0).exp2();
    (0..)
        .take_while(|i| third(f64::from(i + 1)) <= nyquist.min(HIGHEST))
        .map(|i| {
            let at = |n: usize| third(f64::from(i) + (n as f64 + 0.5) / TONES as f64);
            (0..TONES).map(|n| tone(at(n))).collect()
        })
        .collect()
}

/// RMS jerk over RMS velocity, of all joints \[1/s^2\], by differences of samples.
fn jerk(motion: &Recording) -> f64 {
    let (mut times, mut values) = (motion.times().to_vec(), motion.positions().clone());
    let mut sizes = Vec::new();
    for _ in 0..3 {
        let count = times.len().saturating_sub(1);
        values = DMatrix::from_fn(count, values.ncols(), |n, d| {
            (values[(n + 1, d)] - values[(n, d)]) / (times[n + 1] - times[n])
        });
        times = times.windows(2).map(|t| 0.5 * (t[0] + t[1])).collect();
        sizes.push((values.norm_squared() / count.max(1) as f64).sqrt());
    }
    sizes[2] / sizes[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::demonstration::synthetic;
    use crate::fourier::Joints;

    #[test]
    fn the_jerk_of_a_sinusoid_is_one_and_its_level_its_amplitude() {
        let times: Vec<f64> = (0..=900).map(|n| f64::from(n) / 150.0).collect();
        let positions = DMatrix::from_fn(times.len(), 1, |n, _| 0.2 * (TAU * 1.5 * times[n]).cos());
        let joints = Joints::new(["a"]).unwrap();
        let motion = Recording::new("r", joints, times.clone(), positions).unwrap();
        assert!((jerk(&motion) / (TAU * 1.5).powi(2) - 1.0).abs() < 0.01);
        let tone = Complex::from_polar(1.0, -TAU * 1.5 * times[0]);
        assert_eq!(tone, Complex::new(1.0, 0.0));
        let demonstrations = synthetic(0).unwrap();
        let learned = &demonstrations.recordings()[1..];
        let truth = &demonstrations.recordings()[0];
        let yardstick = Yardstick::new(learned, truth, 3).unwrap();
        // At the rate of the demonstrator all third octaves below 10 Hz are there: log2(10 / 0.3) * 3.
        assert_eq!(yardstick.bands.len(), 15);
        let measured = yardstick.measure(truth.positions().clone()).unwrap();
        assert!(!measured.is_beyond && measured.variation.is_ok());
        // Two cycles of ten fit eight times or nine.
        assert!((8..=9).contains(&measured.vectors[0].len()));
        let beyond = truth.positions() * 3.0;
        assert!(yardstick.measure(beyond).unwrap().is_beyond);
    }
}

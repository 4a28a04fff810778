//! [`Variation`]: how alike the cycles of a motion are, the same measure for recordings and for waves.

use super::demodulation::{self, CENTRES, Window};
use super::recording::Recording;
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::{PeriodGrid, Wave};

/// Samples a cycle of a wave that is measured.
const SAMPLES: f64 = 48.0;

/// How the cycles of a motion vary, in the joint whose first harmonic carries most energy unless said otherwise.
///
/// Amplitude and phase are those of a sinusoid fitted within Hann windows of two cycles that slide along the motion, at the
/// motion's own tempo and after its drift is removed. Jitter from one cycle to the next is damped by that, drift and slow
/// change are not; numbers compare only to numbers of this measure.
#[derive(Debug, Clone, PartialEq)]
pub struct Variation {
    /// Number of the dominant joint.
    pub dominant: usize,
    /// Cycles a second, mean over the motion \[Hz\].
    pub frequency: f64,
    /// Standard deviation over mean of the amplitude along the motion.
    pub envelope: f64,
    /// 5 % quantile of the amplitude along the motion, over its mean: how near it comes to a stop.
    pub envelope_low: f64,
    /// Standard deviation over mean of the frequency, taken over one cycle at a time.
    pub tempo: f64,
    /// Of each joint, half of peak to peak within a cycle, mean over the cycles \[rad\].
    pub swing: Vec<f64>,
    /// Of each joint, the length of the mean of exp(i phase relative to the dominant joint): 1 is locked, 0 unrelated.
    pub lock: Vec<f64>,
}

impl Variation {
    /// Of a recording.
    ///
    /// # Errors
    /// When it has fewer than two and a half cycles of a rhythm.
    pub fn of(recording: &Recording) -> Result<Self> {
        measure(recording, recording.tempo()).map_err(|e| e.at(recording.name.clone()))
    }

    /// Of one period of a wave with some cycles in it.
    ///
    /// # Errors
    /// When its period has fewer than two and a half cycles.
    pub fn of_wave(wave: &Wave) -> Result<Self> {
        // Its cycle is not known but from its energy: the tempo of a sampled period.
        let harmonics = wave.harmonics() as f64;
        let points = (4.0 * harmonics).max(SAMPLES) as usize;
        let grid = PeriodGrid::new(points, wave.harmonics());
        let times = grid.times(wave.period());
        let positions = wave.on_grid(&grid, crate::fourier::Derivative::Position);
        let recording = Recording::new("wave", wave.joints().clone(), times, positions)?;
        measure(&recording, recording.tempo())
    }
}

pub(super) fn measure(recording: &Recording, tempo: f64) -> Result<Variation> {
    let flat = recording.without_drift();
    of_windows(&flat, tempo, &demodulation::demodulate(&flat, tempo))
}

/// Of a recording without drift, from its windows at its tempo.
pub(super) fn of_windows(flat: &Recording, tempo: f64, windows: &[Window]) -> Result<Variation> {
    let pairs = demodulation::a_cycle_apart(windows);
    if pairs.len() < CENTRES / 2 {
        return Err(Error::new(
            ErrorKind::Infeasible,
            format!(
                "{:.1} cycles of {tempo:.2} Hz in {:.2} s",
                tempo * flat.span(),
                flat.span()
            ),
        )
        .expected("at least 2.5 cycles of a rhythm"));
    }
    let dominant = demodulation::dominant(windows);
    let mut envelope: Vec<f64> = windows.iter().map(|w| w.phasors[dominant].norm()).collect();
    let (mean, deviation) = mean_and_deviation(&envelope);
    envelope.sort_by(f64::total_cmp);
    let low = envelope[((envelope.len() - 1) as f64 * 0.05).round() as usize];

    let phases = demodulation::unwrapped(windows, dominant);
    let frequencies: Vec<f64> = pairs
        .iter()
        .map(|(i, j)| tempo * (1.0 + (phases[*j] - phases[*i]) / std::f64::consts::TAU))
        .collect();
    let (_, tempo_deviation) = mean_and_deviation(&frequencies);
    let last = windows.len() - 1;
    let between = (windows[last].step - windows[0].step) as f64 / CENTRES as f64;
    let turns = (phases[last] - phases[0]) / std::f64::consts::TAU;
    let frequency = tempo * (1.0 + turns / between);

    let joints = 0..flat.joints.len();
    Ok(Variation {
        dominant,
        frequency,
        envelope: deviation / mean,
        envelope_low: low / mean,
        tempo: tempo_deviation / frequency,
        swing: joints.clone().map(|d| swing(flat, windows, d)).collect(),
        lock: joints.map(|d| lock(windows, d, dominant)).collect(),
    })
}

pub(super) fn mean_and_deviation(values: &[f64]) -> (f64, f64) {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let square: f64 = values.iter().map(|x| (x - mean).powi(2)).sum();
    (mean, (square / values.len() as f64).sqrt())
}

/// Half of peak to peak within the cycle around each window's centre, mean over the windows.
fn swing(recording: &Recording, windows: &[Window], joint: usize) -> f64 {
    let y = recording.positions.column(joint);
    let half = |window: &Window| {
        let cycle = window.cycle.clone();
        let high = cycle
            .clone()
            .fold(cycle.start, |best, n| if y[n] > y[best] { n } else { best });
        let low = cycle
            .clone()
            .fold(cycle.start, |best, n| if y[n] < y[best] { n } else { best });
        (vertex(recording, joint, high) - vertex(recording, joint, low)) / 2.0
    };
    windows.iter().map(half).sum::<f64>() / windows.len() as f64
}

/// The extremum of the parabola through a sample and its neighbours, where the sample is their extremum: at ten samples
/// a cycle a turning point lies up to 5 % beyond the nearest sample.
fn vertex(recording: &Recording, joint: usize, n: usize) -> f64 {
    let (t, y) = (&recording.times, recording.positions.column(joint));
    if n == 0 || n + 1 == t.len() || (y[n] - y[n - 1]) * (y[n] - y[n + 1]) <= 0.0 {
        return y[n];
    }
    // Newton's form about the sample: y_n + slope s + curvature s^2.
    let (before, after) = (t[n] - t[n - 1], t[n + 1] - t[n]);
    let (rise, fall) = ((y[n] - y[n - 1]) / before, (y[n + 1] - y[n]) / after);
    let curvature = (fall - rise) / (before + after);
    let slope = rise + curvature * before;
    y[n] - slope * slope / (4.0 * curvature)
}

fn lock(windows: &[Window], joint: usize, dominant: usize) -> f64 {
    let sum: num_complex::Complex<f64> = windows
        .iter()
        .map(|w| {
            let relative = w.phasors[joint] * w.phasors[dominant].conj();
            let length = relative.norm();
            if length > 0.0 {
                relative / length
            } else {
                relative
            }
        })
        .sum();
    sum.norm() / windows.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fourier::Joints;
    use nalgebra::{DMatrix, dmatrix, dvector};
    use num_complex::Complex;
    use std::f64::consts::TAU;

    /// Twenty cycles of 2 Hz; amplitude goes up and down by 20 % every ten cycles, tempo by 10 %.
    #[test]
    fn slow_modulation_measures_as_it_is_in_closed_form() {
        let times: Vec<f64> = (0..=1000).map(|n| f64::from(n) / 100.0).collect();
        let at = |t: f64, d: usize| {
            let slow = TAU * 0.1 * 2.0 * t;
            // Integral of 1 + 0.1 cos(slow).
            let phase = TAU * (2.0 * t + 0.1 / (TAU * 0.1) * slow.sin());
            match d {
                0 => 1.1 + 0.3 * (1.0 + 0.2 * slow.cos()) * phase.cos() + 0.05 * t,
                1 => 0.1 * (phase + 1.0).cos() + 0.02 * (2.0 * phase).cos(),
                _ => 0.05 * (TAU * 1.7 * t).cos(),
            }
        };
        let positions = DMatrix::from_fn(times.len(), 3, |n, d| at(times[n], d));
        let joints = Joints::new(["a", "b", "c"]).unwrap();
        let recording = Recording::new("r", joints, times, positions).unwrap();
        let found = Variation::of(&recording).unwrap();
        assert_eq!(found.dominant, 0);
        assert!((found.frequency - 2.0).abs() < 0.02, "{found:?}");
        // Hann's window of two cycles lets through sinc(0.2) / (1 - 0.04) at 0.1 a cycle; a mean over one cycle sinc(0.1).
        let sinc = |x: f64| (TAU * x / 2.0).sin() / (TAU * x / 2.0);
        let window = sinc(0.2) / (1.0 - 0.04);
        let envelope = 0.2 * window / 2f64.sqrt();
        let tempo = 0.1 * window * sinc(0.1) / 2f64.sqrt();
        assert!(
            (found.envelope / envelope - 1.0).abs() < 0.06,
            "{found:?} {envelope}"
        );
        assert!(
            (found.tempo / tempo - 1.0).abs() < 0.06,
            "{found:?} {tempo}"
        );
        assert!((found.envelope_low - 0.8).abs() < 0.03, "{found:?}");
        assert!((found.swing[0] / 0.3 - 1.0).abs() < 0.02, "{found:?}");
        assert!(found.lock[1] > 0.99 && found.lock[2] < 0.3, "{found:?}");
    }

    #[test]
    fn a_steady_wave_does_not_vary_and_one_cycle_is_none() {
        let wave = |cycles: usize| {
            let mut weights = DMatrix::zeros(1, 2 * cycles);
            weights[(0, cycles - 1)] = Complex::new(0.05, 0.1);
            weights[(0, 2 * cycles - 1)] = Complex::new(0.01, 0.0);
            Wave::new(
                Joints::new(["a"]).unwrap(),
                0.5 * cycles as f64,
                dvector![0.2],
                weights,
            )
            .unwrap()
        };
        let found = Variation::of_wave(&wave(10)).unwrap();
        assert!(found.envelope < 0.003 && found.tempo < 0.003, "{found:?}");
        assert!((found.frequency - 2.0).abs() < 1e-3);
        let peak = (0..1000)
            .map(|n| wave(10).position(f64::from(n) * 5e-4)[0])
            .fold((f64::MAX, f64::MIN), |(l, h), y| (l.min(y), h.max(y)));
        assert!(
            (found.swing[0] / ((peak.1 - peak.0) / 2.0) - 1.0).abs() < 0.01,
            "{found:?}"
        );
        assert!(Variation::of_wave(&wave(1)).is_err());
        let still = Wave::new(
            Joints::new(["a"]).unwrap(),
            1.0,
            dvector![0.2],
            dmatrix![Complex::new(0.0, 0.0)],
        );
        assert!(Variation::of_wave(&still.unwrap()).is_err());
    }
}

//! [`Course`]: what one demodulation tells of a motion, for those who measure many.

use std::f64::consts::TAU;

use num_complex::Complex;

use super::demodulation::{self, Window};
use super::recording::Recording;
use super::variation::{self, Variation};
use crate::error::Result;

/// A motion's variation, its upper turning points in one joint, and the other joints' phases relative to it.
#[derive(Debug)]
pub(crate) struct Course {
    /// Refused where there are fewer than two and a half cycles of a rhythm.
    pub variation: Result<Variation>,
    /// Times at which the joint's first harmonic is at its upper turning point \[s\].
    pub turns: Vec<f64>,
    /// Of each joint, sum over the motion of its first harmonic times the conjugate of the reference joint's \[rad^2\].
    pub relative: Vec<Complex<f64>>,
}

impl Course {
    /// Of a recording, relative to joint number `joint`.
    pub fn of(recording: &Recording, joint: usize) -> Self {
        let tempo = recording.tempo();
        let flat = recording.without_drift();
        let windows = demodulation::demodulate(&flat, tempo);
        let start = recording.times[0];
        let relative = |d: usize| -> Complex<f64> {
            let product = |w: &Window| w.phasors[d] * w.phasors[joint].conj();
            windows.iter().map(product).sum()
        };
        Self {
            turns: turns(&windows, joint, recording.span() * tempo)
                .into_iter()
                .map(|cycles| start + cycles / tempo)
                .collect(),
            relative: (0..recording.joints.len()).map(relative).collect(),
            variation: variation::of_windows(&flat, tempo, &windows),
        }
    }
}

/// Where the phase of a joint is a whole number of turns, in cycles of the tempo since the start. The phase is linear between the windows'
/// centres, and goes on at the tempo before the first and after the last.
fn turns(windows: &[Window], joint: usize, end: f64) -> Vec<f64> {
    let phases = demodulation::unwrapped(windows, joint);
    let mut along: Vec<(f64, f64)> = windows
        .iter()
        .zip(&phases)
        .map(|(w, phase)| (w.centre, w.centre + phase / TAU))
        .collect();
    let (Some(first), Some(last)) = (along.first().copied(), along.last().copied()) else {
        return Vec::new();
    };
    along.insert(0, (0.0, first.1 - first.0));
    along.push((end, last.1 + end - last.0));
    let mut turns: Vec<f64> = Vec::new();
    for pair in along.windows(2) {
        let ((from, a), (to, b)) = (pair[0], pair[1]);
        let mut turn = a.ceil();
        while turn < b {
            let at = from + (to - from) * (turn - a) / (b - a);
            // A phase that goes back and forth turns once.
            if turns.last().is_none_or(|last| at - last > 0.5) {
                turns.push(at);
            }
            turn += 1.0;
        }
    }
    turns
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fourier::Joints;
    use nalgebra::DMatrix;

    #[test]
    fn turning_points_and_relative_phases_of_sinusoids_are_where_they_are() {
        let times: Vec<f64> = (0..=300).map(|n| 3.0 + f64::from(n) / 60.0).collect();
        let positions = DMatrix::from_fn(times.len(), 2, |n, d| {
            let phase = TAU * 1.7 * (times[n] - 3.2);
            [0.4 + 0.3 * phase.cos(), 0.1 * (phase + 1.0).cos()][d]
        });
        let joints = Joints::new(["a", "b"]).unwrap();
        let recording = Recording::new("r", joints, times, positions).unwrap();
        let course = Course::of(&recording, 0);
        assert_eq!(course.turns.len(), 9);
        for (n, turn) in course.turns.iter().enumerate() {
            assert!((turn - (3.2 + n as f64 / 1.7)).abs() < 0.01, "{course:?}");
        }
        assert!((course.relative[1].arg() - 1.0).abs() < 0.01);
        assert_eq!(
            course.variation.unwrap(),
            Variation::of(&recording).unwrap()
        );
    }
}

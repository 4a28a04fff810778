//! The tempo of a recording: the dominant frequency of its joints.

use nalgebra::DMatrix;

use super::Recording;

/// Slower than this is drift of posture, not a gesture \[Hz\].
pub(super) const SLOWEST: f64 = 0.4;
/// Faster than this no arm waves \[Hz\].
pub(super) const FASTEST: f64 = 8.0;
/// Of a longer recording only this much is looked at \[s\].
const LONGEST: f64 = 60.0;
/// Frequencies tried a 1/span, so that a peak is found to a sixteenth of the width of its lobe.
const OVERSAMPLING: f64 = 8.0;

impl Recording {
    /// The frequency \[Hz\] of the sinusoid that, taken away from every joint, takes most energy with it
    /// (the periodogram of Lomb 1976 without its phase shift, summed over joints; drift removed first).
    /// Only the first minute is looked at. 0 when the recording is too short for 1.5 cycles of any frequency between
    /// 0.4 and 8 Hz.
    pub fn tempo(&self) -> f64 {
        let flat = self.first(LONGEST).without_drift();
        let samples = flat.times.len();
        let mut centred = flat.positions.clone();
        for mut column in centred.column_iter_mut() {
            let mean = column.mean();
            column.add_scalar_mut(-mean);
        }
        let span = flat.span();
        let nyquist = (samples - 1) as f64 / (2.0 * span);
        let (low, high) = (SLOWEST.max(1.5 / span), FASTEST.min(nyquist));
        let step = 1.0 / (OVERSAMPLING * span);
        let steps = ((high - low) / step).floor();
        if !(steps.is_finite() && steps >= 0.0) {
            return 0.0;
        }
        let steps = steps as usize;
        let power = |i: usize| {
            explained(
                &flat.times,
                &centred,
                low + (high - low) * i as f64 / steps.max(1) as f64,
            )
        };
        let (best, _) = (0..=steps)
            .map(|i| (i, power(i)))
            .fold(
                (0, -1.0),
                |best, next| if next.1 > best.1 { next } else { best },
            );
        low + (high - low) * best as f64 / steps.max(1) as f64
    }
}

impl Recording {
    /// The samples within so many seconds of the first, two at the least.
    pub(super) fn first(&self, seconds: f64) -> Self {
        let end = self.times[0] + seconds;
        let count = self.times.partition_point(|t| *t <= end).max(2);
        Self {
            times: self.times[..count].to_vec(),
            positions: self.positions.rows(0, count).into_owned(),
            ..self.clone()
        }
    }
}

/// Energy that the best sinusoid of `frequency` explains, summed over the joints: 2 x 2 normal equations.
fn explained(times: &[f64], centred: &DMatrix<f64>, frequency: f64) -> f64 {
    let w = std::f64::consts::TAU * frequency;
    let basis: Vec<(f64, f64)> = times.iter().map(|t| (w * t).sin_cos()).collect();
    let (mut cc, mut ss, mut cs) = (0.0, 0.0, 0.0);
    for (s, c) in &basis {
        cc += c * c;
        ss += s * s;
        cs += c * s;
    }
    let determinant = cc * ss - cs * cs;
    if determinant <= f64::EPSILON * cc * ss {
        return 0.0;
    }
    centred
        .column_iter()
        .map(|y| {
            let (mut yc, mut ys) = (0.0, 0.0);
            for (y, (s, c)) in y.iter().zip(&basis) {
                yc += y * c;
                ys += y * s;
            }
            (ss * yc * yc - 2.0 * cs * yc * ys + cc * ys * ys) / determinant
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fourier::Joints;

    #[test]
    fn tempo_of_a_drifting_sine_among_harmonics() {
        for frequency in [0.7, 1.9, 3.3] {
            let times: Vec<f64> = (0..240).map(|n| f64::from(n) / 40.0).collect();
            let positions = DMatrix::from_fn(240, 2, |n, d| {
                let phase = std::f64::consts::TAU * frequency * times[n];
                0.5 * times[n] + 0.2 * (phase + d as f64).cos() + 0.08 * (2.0 * phase).sin()
            });
            let recording =
                Recording::new("r", Joints::new(["a", "b"]).unwrap(), times, positions).unwrap();
            assert!(
                (recording.tempo() - frequency).abs() < 0.03,
                "{}",
                recording.tempo()
            );
        }
    }
}

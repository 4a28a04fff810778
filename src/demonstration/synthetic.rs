//! A synthetic demonstrator: waves like the paper's, for those who have no recordings yet.

use nalgebra::DMatrix;
use rand::SeedableRng;
use rand::distr::Distribution;
use rand::rngs::ChaCha8Rng;
use rand_distr::StandardNormal;

use super::{Demonstrations, Duration, Recording};
use crate::error::Result;
use crate::fourier::Joints;

/// The demonstrator's joints, in the convention of human joint angles with zero at the hanging arm:
/// flexion forward, abduction outward, rotation inward, elbow bent, wrist towards the thumb are positive.
pub const JOINTS: [&str; 5] = [
    "shoulder_flexion",
    "shoulder_abduction",
    "shoulder_rotation",
    "elbow_flexion",
    "wrist_deviation",
];

/// T \[s\]: 10 cycles at 1.5 Hz, 20 at 3 Hz.
pub const PERIOD: f64 = 20.0 / 3.0;

/// How many demonstrations there are.
const DEMONSTRATIONS: usize = 15;
/// Samples of a demonstration, at 75 Hz on an open grid.
const SAMPLES: usize = 500;
/// Standard deviation of ln tempo and of ln amplitude from cycle to cycle.
const CYCLE_JITTER: f64 = 0.05;
/// Standard deviation of ln amplitude from demonstration to demonstration.
const AMPLITUDE_SPREAD: f64 = 0.10;
/// Standard deviation of the phase at the start \[rad\]: each wave starts near the outer turning point.
const START_SPREAD: f64 = 0.3;
/// Amplitude of the second harmonic of the tempo over that of the first.
const SECOND_HARMONIC: f64 = 0.06;
/// Amplitude of the slow wander of posture and of the unrhythmic rest of a movement \[deg\].
const WANDER: f64 = 0.6;
const REST: f64 = 0.02;

/// What one joint does. Angles in degrees, phases in radians.
struct Part {
    offset: f64,
    offset_spread: f64,
    /// Amplitude in the slowest and in the fastest wave; in between, geometric.
    slow: f64,
    fast: f64,
    /// Behind the elbow.
    lag: f64,
}

#[rustfmt::skip]
const PARTS: [Part; JOINTS.len()] = [
    Part { offset: 15.0, offset_spread: 4.0, slow: 1.6, fast: 0.8, lag: 2.6 },
    Part { offset: 70.0, offset_spread: 4.0, slow: 2.4, fast: 1.2, lag: 0.9 },
    Part { offset: -78.0, offset_spread: 5.0, slow: 4.0, fast: 1.6, lag: -0.7 },
    Part { offset: 110.0, offset_spread: 5.0, slow: 13.0, fast: 2.2, lag: 0.0 },
    Part { offset: 0.0, offset_spread: 3.0, slow: 11.4, fast: 10.5, lag: 0.5 },
];

/// Fifteen demonstrations of waving, five joints, 20/3 s, 500 samples each; from slow waves that the elbow drives
/// (10 cycles, 1.5 Hz) with a wrist of similar amplitude, through a continuum, to fast ones that the wrist drives
/// (20 cycles, 3 Hz) with a quiet elbow. Tempo and amplitude vary by 5 % from cycle to cycle. A seed is a demonstrator.
///
/// ```
/// let demonstrations = undulate::synthetic(0)?;
/// assert_eq!(demonstrations.recordings().len(), 15);
/// # Ok::<(), undulate::Error>(())
/// ```
///
/// # Errors
/// None that its own constants could cause.
pub fn synthetic(seed: u64) -> Result<Demonstrations> {
    let joints = Joints::new(JOINTS)?;
    let recordings = (0..DEMONSTRATIONS)
        .map(|m| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            // From the end, so that no draw of a model with the same seed uses the same numbers.
            rng.set_stream(u64::MAX - m as u64);
            // A continuum, denser towards both ends, as people have a slow wave and a fast one.
            let turn = std::f64::consts::PI * m as f64 / (DEMONSTRATIONS - 1) as f64;
            let pace = (1.0 - turn.cos()) / 2.0;
            let times = (0..SAMPLES)
                .map(|n| PERIOD * n as f64 / SAMPLES as f64)
                .collect();
            Recording::new(
                format!("synthetic {}", m + 1),
                joints.clone(),
                times,
                perform(pace, &mut rng),
            )
        })
        .collect::<Result<Vec<_>>>()?;
    Demonstrations::new(recordings, Duration::Seconds(PERIOD))
}

/// One wave; `pace` runs from 0, slow, to 1, fast. SAMPLES x 5, rad.
fn perform(pace: f64, rng: &mut ChaCha8Rng) -> DMatrix<f64> {
    let mut normal = || -> f64 { StandardNormal.sample(rng) };
    let cycles = 10.0 + 10.0 * pace;
    let tempo: Vec<f64> = (0..22).map(|_| CYCLE_JITTER * normal()).collect();
    let swing: Vec<f64> = (0..22).map(|_| (CYCLE_JITTER * normal()).exp()).collect();
    let start = START_SPREAD * normal();

    // Cycles done at each sample: the integral of a tempo that is linear between cycles, scaled to end at `cycles`.
    let share = |n: usize| cycles * n as f64 / SAMPLES as f64;
    let mut done = vec![0.0; SAMPLES + 1];
    for n in 0..SAMPLES {
        let rate = 1.0 + (between(&tempo, share(n)) + between(&tempo, share(n + 1))) / 2.0;
        done[n + 1] = done[n] + rate;
    }
    let scale = cycles / done[SAMPLES];

    let mut positions = DMatrix::zeros(SAMPLES, PARTS.len());
    for (d, part) in PARTS.iter().enumerate() {
        let offset = part.offset + part.offset_spread * normal();
        let amplitude =
            part.slow.powf(1.0 - pace) * part.fast.powf(pace) * (AMPLITUDE_SPREAD * normal()).exp();
        let lag = part.lag + 0.1 * normal();
        // Wander: three slow sinusoids of random size and phase.
        let wander: [(f64, f64); 3] = std::array::from_fn(|_| (normal(), normal()));
        for n in 0..SAMPLES {
            let phase = std::f64::consts::TAU * scale * done[n] + start - lag;
            let turn = std::f64::consts::TAU * n as f64 / SAMPLES as f64;
            let slow: f64 = wander
                .iter()
                .enumerate()
                .map(|(i, (a, b))| {
                    let k = (i + 1) as f64;
                    (a * (k * turn).cos() + b * (k * turn).sin()) / k
                })
                .sum();
            let degrees = offset
                + amplitude
                    * between(&swing, share(n))
                    * (phase.cos() + SECOND_HARMONIC * (2.0 * phase + 0.8).cos())
                + WANDER * slow
                + REST * normal();
            positions[(n, d)] = degrees.to_radians();
        }
    }
    positions
}

/// Linear between the values at whole numbers; the last value beyond them.
fn between(values: &[f64], at: f64) -> f64 {
    let last = values.len() - 1;
    let i = (at.floor() as usize).min(last);
    let next = (i + 1).min(last);
    values[i] + (values[next] - values[i]) * (at - i as f64).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_waves_between_1_5_and_3_hertz_and_repeats_itself_only_for_a_seed() {
        let demonstrations = synthetic(3).unwrap();
        let tempos: Vec<f64> = demonstrations
            .recordings()
            .iter()
            .map(Recording::tempo)
            .collect();
        assert!(
            (tempos[0] - 1.5).abs() < 0.1 && (tempos[14] - 3.0).abs() < 0.15,
            "{tempos:?}"
        );
        assert!(tempos.windows(2).all(|t| t[1] > t[0] - 0.1), "{tempos:?}");
        assert_eq!(demonstrations, synthetic(3).unwrap());
        assert_ne!(demonstrations, synthetic(4).unwrap());
    }

    #[test]
    fn offsets_of_the_wrist_have_both_signs() {
        let demonstrations = synthetic(0).unwrap();
        let means: Vec<f64> = demonstrations
            .recordings()
            .iter()
            .map(|r| r.positions().column(4).mean())
            .collect();
        assert!(means.iter().any(|m| *m > 0.0) && means.iter().any(|m| *m < 0.0));
    }
}

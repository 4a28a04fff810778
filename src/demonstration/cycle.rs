//! [`CycleFit`] and [`CycleFits`]: recordings described by a mean cycle and its variation.

use super::half_cycles::median;
use super::jitter::{self, Series};
use super::mean_cycle::MeanCycle;
use super::recording::Recording;
use super::residual;
use super::{LeftOut, level};
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::{Autoregression, CycleResidual, Joints, MOST_CYCLE_HARMONICS, Wave};

/// A recording so many times as fast as the set's median may have been taken at twice its tempo.
const TWICE: std::ops::Range<f64> = 1.5..3.0;

/// A joint that moves less than this share of what it does in others stands still.
const STILL: f64 = 1e-6;

/// One recording as a mean cycle that is repeated with variations of amplitude and tempo.
#[derive(Debug, Clone, PartialEq)]
pub struct CycleFit {
    /// The recording.
    pub name: String,
    /// The mean cycle, with period 1/f: its time 0 is the recording's first stamp, its offsets are the recording's at
    /// mid-time. Straight drift is taken out. Weights are half amplitudes, as of any wave, and means over the cycles:
    /// they are fitted along the motion's own phase, so that a tempo that wanders does not make them smaller.
    pub wave: Wave,
    /// Share of the energy about each joint's straight line that one steady rhythm of this frequency explains.
    pub explained: f64,
    /// The same when amplitude and tempo vary as they were found to, if that is more.
    pub explained_with_jitter: f64,
    /// Cycles that the recording lasts.
    pub cycles: f64,
    /// Standard deviation of ln amplitude from cycle to cycle.
    pub amplitude_jitter: f64,
    /// Standard deviation of ln tempo from cycle to cycle.
    pub tempo_jitter: f64,
}

impl CycleFit {
    /// f \[Hz\].
    pub fn frequency(&self) -> f64 {
        1.0 / self.wave.period()
    }
}

/// Recordings of one gesture, each with its own frequency, and how their cycles follow each other.
///
/// Amplitude and phase of the dominant joint are demodulated as by [`Variation`](super::Variation). Their variation is
/// modelled as stationary: ln amplitude and ln tempo are autoregressions with a level for each recording and a
/// coefficient common to all, for one recording of ten cycles does not tell its own. What the window hides and what few
/// cycles cannot show is allowed for exactly, so waves drawn with these levels measure as the recordings do.
#[derive(Debug, Clone, PartialEq)]
pub struct CycleFits {
    joints: Joints,
    fits: Vec<CycleFit>,
    left_out: Vec<LeftOut>,
    amplitude: Autoregression,
    tempo: Autoregression,
    residual: CycleResidual,
}

impl CycleFits {
    /// Fits each of `recordings`, uncut, with `harmonics` harmonics of its own frequency.
    ///
    /// # Errors
    /// When there are no recordings, their joints differ, the harmonics are none or beyond 50, or no recording can be
    /// used. One that cannot (less than three cycles, no rhythm, too few samples, a joint that stands still there alone) is left out, by name. One
    /// that is far faster than the median of the others, where half of its tempo explains far more, is taken at half: a joint that moves twice a cycle was the largest.
    pub fn new(recordings: &[Recording], harmonics: usize) -> Result<Self> {
        if !(1..=MOST_CYCLE_HARMONICS).contains(&harmonics) {
            return Err(Error::new(
                ErrorKind::Setting,
                format!("{harmonics} harmonics of a cycle"),
            )
            .expected(format!("from 1 to {MOST_CYCLE_HARMONICS}")));
        }
        let joints = super::common_joints(recordings)?;
        let mut seen = Vec::new();
        let mut left_out = Vec::new();
        let mut used = Vec::new();
        for recording in recordings {
            match MeanCycle::of(recording, harmonics) {
                Ok(one) => {
                    seen.push(one);
                    used.push(recording);
                }
                Err(error) => left_out.push(LeftOut {
                    name: recording.name.clone(),
                    reason: error.to_string(),
                }),
            }
        }
        if !seen.is_empty() {
            let usual = median(seen.iter().map(|one| one.fit.frequency()).collect());
            for (one, recording) in seen.iter_mut().zip(used) {
                if TWICE.contains(&(one.fit.frequency() / usual))
                    && let Some(half) = one.of_half_tempo(recording)
                {
                    *one = half;
                }
            }
        }
        leave_out_still(&joints, &mut seen, &mut left_out);
        if seen.is_empty() {
            let reasons: Vec<String> = left_out
                .iter()
                .take(5)
                .map(|l| format!("; {}: {}", l.name, l.reason))
                .collect();
            return Err(Error::new(
                ErrorKind::Infeasible,
                format!("no recording can be fitted{}", reasons.concat()),
            )
            .expected("at least three cycles of a rhythm"));
        }
        let amplitudes: Vec<&Series> = seen.iter().map(|one| &one.amplitude).collect();
        let tempos: Vec<&Series> = seen.iter().map(|one| &one.tempo).collect();
        let amplitude = jitter::common(&amplitudes)?;
        let tempo = jitter::common(&tempos)?;
        let levels = |series: &[&Series], process| {
            let logs: Vec<_> = series.iter().map(|s| s.log_level(process)).collect();
            level::pooled(&logs)
        };
        let levels = levels(&amplitudes, &amplitude)
            .into_iter()
            .zip(levels(&tempos, &tempo));
        let fits = levels
            .zip(&seen)
            .map(|((amplitude_jitter, tempo_jitter), one)| CycleFit {
                amplitude_jitter,
                tempo_jitter,
                ..one.fit.clone()
            })
            .collect();
        let sizes = seen.iter().map(|one| one.fit.wave.weights().norm());
        let largest = sizes.fold(0.0, f64::max);
        let residuals: Vec<_> = seen.iter().map(|one| &one.residual).collect();
        Ok(Self {
            residual: residual::common(joints.len(), largest, &residuals)?,
            joints,
            fits,
            left_out,
            amplitude,
            tempo,
        })
    }

    /// The joints' names.
    pub fn joints(&self) -> &Joints {
        &self.joints
    }

    /// One fit a recording that was not left out, in their order.
    pub fn fits(&self) -> &[CycleFit] {
        &self.fits
    }

    /// The same without jitter: what a model of steady cycles learns from.
    #[must_use]
    pub fn steady(&self) -> Self {
        let fits = self.fits.iter().map(|fit| CycleFit {
            amplitude_jitter: 0.0,
            tempo_jitter: 0.0,
            ..fit.clone()
        });
        Self {
            fits: fits.collect(),
            ..self.clone()
        }
    }

    /// The recordings that could not be used, and why.
    pub fn left_out(&self) -> &[LeftOut] {
        &self.left_out
    }

    /// How ln amplitude follows that of the cycle before.
    pub fn amplitude(&self) -> Autoregression {
        self.amplitude
    }

    /// How ln tempo follows that of the cycle before.
    pub fn tempo(&self) -> Autoregression {
        self.tempo
    }

    /// What the cycles and their jitter leave, in all recordings alike.
    pub fn residual(&self) -> &CycleResidual {
        &self.residual
    }
}

/// A joint that stands still in some recordings and moves in others: of no movement there is no logarithm.
fn leave_out_still(joints: &Joints, seen: &mut Vec<MeanCycle>, left_out: &mut Vec<LeftOut>) {
    let size = |one: &MeanCycle, d: usize| one.fit.wave.weights().row(d).norm();
    let largest = |d: usize| seen.iter().map(|one| size(one, d)).fold(0.0, f64::max);
    let least: Vec<f64> = (0..joints.len()).map(|d| STILL * largest(d)).collect();
    seen.retain(|one| {
        let still = (0..joints.len()).find(|d| size(one, *d) < least[*d]);
        if let Some(d) = still {
            left_out.push(LeftOut {
                name: one.fit.name.clone(),
                reason: format!(
                    "`{}` stands still: leave out this recording, or the joint with --joints",
                    joints.name(d)
                ),
            });
        }
        still.is_none()
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fourier::CycleRing;
    use nalgebra::{DMatrix, dmatrix, dvector};
    use num_complex::Complex;
    use rand::SeedableRng;
    use rand::distr::Distribution;
    use rand::rngs::ChaCha8Rng;
    use rand_distr::StandardNormal;

    fn joints() -> Joints {
        Joints::new(["a", "b"]).unwrap()
    }

    /// 1.83 Hz, a swing of 0.3 and its second harmonic; the other joint swings less, and late.
    fn cycle() -> Wave {
        Wave::new(
            joints(),
            1.0 / 1.83,
            dvector![0.4, -1.0],
            dmatrix![
                Complex::new(0.15, 0.0), Complex::new(0.0, 0.02);
                Complex::new(0.03, 0.06), Complex::new(0.01, 0.0)
            ],
        )
        .unwrap()
    }

    fn recorded(name: &str, times: Vec<f64>, at: impl Fn(f64, usize) -> f64) -> Recording {
        let positions = DMatrix::from_fn(times.len(), 2, |n, d| at(times[n], d));
        Recording::new(name, joints(), times, positions).unwrap()
    }

    fn uniform(span: f64) -> Vec<f64> {
        (0..=(60.0 * span) as usize)
            .map(|n| n as f64 / 60.0)
            .collect()
    }

    #[test]
    fn a_steady_cycle_is_found_on_uneven_stamps_with_a_gap_and_drift() {
        let cycle = cycle();
        let times: Vec<f64> = (0..300)
            .map(|n| 7.0 + (f64::from(n) + 0.4 * (f64::from(n * n) * 0.7).sin()) / 60.0)
            .filter(|t| !(9.2..9.7).contains(t))
            .collect();
        let (start, middle) = (times[0], (times[0] + times[times.len() - 1]) / 2.0);
        let drifting = recorded("r", times, |t, d| {
            cycle.position(t - start)[d] + 0.1 * (t - middle)
        });
        let fits = CycleFits::new(&[drifting], 2).unwrap();
        let fit = &fits.fits()[0];
        assert!(
            (fit.frequency() / 1.83 - 1.0).abs() < 5e-4,
            "{}",
            fit.frequency()
        );
        assert!((fit.wave.weights() - cycle.weights()).camax() < 0.01 * 0.15);
        assert!((fit.wave.offsets() - cycle.offsets()).amax() < 1e-3);
        assert!(fit.explained > 0.999 && fit.explained_with_jitter > 0.999);
        assert!(
            fit.amplitude_jitter < 0.01 && fit.tempo_jitter < 0.01,
            "{fit:?}"
        );
    }

    /// 60 recordings of 4 to 11 cycles, cut anywhere from rings of 40 cycles with known levels and coefficients; seed 11.
    /// Standard errors, from how estimates scatter between seeds: 0.1 of a coefficient, 0.08 of the mean ln level.
    /// The bounds are three of them: false alarms of 0.3 % each.
    #[test]
    fn levels_and_memory_of_jitter_are_recovered_from_short_recordings() {
        let (amplitude, tempo) = (
            Autoregression::new(0.5).unwrap(),
            Autoregression::new(0.0).unwrap(),
        );
        let (level, tempo_level) = (0.12, 0.05);
        let ring = CycleRing::new(40).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        let recordings: Vec<Recording> = (0..60)
            .map(|m| {
                let mut draw = |process: &Autoregression, level: f64| -> Vec<f64> {
                    let normals: Vec<f64> =
                        (0..40).map(|_| StandardNormal.sample(&mut rng)).collect();
                    process
                        .on_ring(&normals)
                        .iter()
                        .map(|x| level * x)
                        .collect()
                };
                let wave = ring
                    .wave(
                        &cycle(),
                        &draw(&amplitude, level),
                        &draw(&tempo, tempo_level),
                    )
                    .unwrap();
                let cycles = 4.0 + f64::from(m % 8);
                let start = 0.3 * f64::from(m);
                recorded(&m.to_string(), uniform(cycles / 1.83), |t, d| {
                    wave.position(start + t)[d]
                })
            })
            .collect();
        let fits = CycleFits::new(&recordings, 2).unwrap();
        assert_eq!(fits.fits().len(), 60, "{:?}", fits.left_out());
        assert!(
            (fits.amplitude().coefficient() - 0.5).abs() < 0.3,
            "{fits:?}"
        );
        assert!(fits.tempo().coefficient().abs() < 0.3, "{fits:?}");
        let mean = |of: &dyn Fn(&CycleFit) -> f64| {
            fits.fits().iter().map(of).sum::<f64>() / fits.fits().len() as f64
        };
        let log = mean(&|f| (f.amplitude_jitter / level).ln());
        let tempo_log = mean(&|f| (f.tempo_jitter / tempo_level).ln());
        assert!(
            log.abs() < 0.24 && tempo_log.abs() < 0.24,
            "{log} {tempo_log}"
        );
        // What is seen of it is far less, so the test would notice if nothing were corrected.
        let seen: f64 = recordings
            .iter()
            .map(|r| (crate::demonstration::Variation::of(r).unwrap().envelope / level).ln())
            .sum();
        assert!(seen / 60.0 < -0.4, "{}", seen / 60.0);
        // Levels are alike, so they come out alike, though each recording alone tells little of its own.
        let spread = mean(&|f| ((f.amplitude_jitter / level).ln() - log).powi(2)).sqrt();
        assert!(spread < 0.2, "{spread}");
        // A tempo that wanders does not make amplitudes smaller.
        let swing = mean(&|f| f.wave.weights()[(0, 0)].norm() / 0.15);
        assert!((swing - 1.0).abs() < 0.03, "{swing}");
    }

    #[test]
    fn what_has_no_three_cycles_of_a_rhythm_is_left_out_by_name() {
        let cycle = cycle();
        let good = recorded("good", uniform(4.0), |t, d| cycle.position(t)[d]);
        let short = recorded("short", uniform(1.2), |t, d| cycle.position(t)[d]);
        // A quadratic congruence: as good as noise.
        let noise = recorded("noise", uniform(4.0), |t, d| {
            let n = (60.0 * t).round() as u64;
            ((n * n * 7919 + 104_729 * n * (d as u64 + 1)) % 1009) as f64 / 1009.0
        });
        let still = recorded("still", uniform(4.0), |_, _| 0.5);
        let ramp = recorded("ramp", uniform(4.0), |t, _| 0.5 * t);
        let coarse = recorded(
            "coarse",
            (0..12).map(|n| 0.4 * f64::from(n)).collect(),
            |t, d| cycle.position(t)[d],
        );
        let huge = recorded("huge", uniform(4.0), |t, d| 1e200 * cycle.position(t)[d]);
        let all = [
            good.clone(),
            short.clone(),
            noise,
            still,
            ramp,
            coarse,
            huge,
        ];
        let fits = CycleFits::new(&all, 3).unwrap();
        let names = |fits: &CycleFits| {
            fits.fits()
                .iter()
                .map(|f| f.name.clone())
                .collect::<Vec<_>>()
        };
        assert_eq!(names(&fits), ["good"], "{fits:?}");
        assert_eq!(fits.left_out().len(), 6);
        assert!(
            fits.left_out()[0].reason.contains("2.3 cycles in 1.20 s"),
            "{fits:?}"
        );
        let error = CycleFits::new(&[short], 3).unwrap_err();
        assert!(error.to_string().contains("short: 2.3 cycles"), "{error}");
        assert!(CycleFits::new(&[], 3).is_err());
        assert!(CycleFits::new(&[good], 0).is_err());
    }

    #[test]
    fn a_recording_in_which_one_joint_stands_still_is_left_out_by_name() {
        let cycle = cycle();
        let good = |name| recorded(name, uniform(4.0), |t, d| cycle.position(t)[d]);
        let half = recorded("half", uniform(4.0), |t, d| {
            if d == 0 { cycle.position(t)[0] } else { 0.7 }
        });
        let fits = CycleFits::new(&[good("one"), half, good("two")], 2).unwrap();
        assert_eq!(fits.fits().len(), 2);
        let [left_out] = fits.left_out() else {
            panic!("{:?}", fits.left_out());
        };
        assert!(left_out.name == "half" && left_out.reason.contains("`b` stands still"));
    }

    /// The second joint goes to and fro twice a cycle, in one recording farther than the first.
    #[test]
    fn a_joint_that_moves_twice_a_cycle_does_not_double_the_tempo() {
        let recordings: Vec<Recording> = [0.02, 0.03, 0.3, 0.01]
            .iter()
            .enumerate()
            .map(|(m, twice)| {
                let phase = move |t: f64| std::f64::consts::TAU * (0.95 + 0.01 * m as f64) * t;
                recorded(&m.to_string(), uniform(6.0), |t, d| {
                    [0.2 * phase(t).cos(), twice * (2.0 * phase(t)).cos()][d]
                })
            })
            .collect();
        assert!((recordings[2].tempo() - 1.94).abs() < 0.02);
        let fits = CycleFits::new(&recordings, 2).unwrap();
        let fit = &fits.fits()[2];
        assert!((fit.frequency() - 0.97).abs() < 0.01, "{fit:?}");
        assert!(fit.explained > 0.999, "{fit:?}");
        // One that is as fast, with little in it that is slower, stays as it is.
        let mut fast = recordings.clone();
        fast[2] = recorded("fast", uniform(6.0), |t, _| {
            0.2 * (12.2 * t).cos() + 0.03 * (6.1 * t).cos()
        });
        let frequency = CycleFits::new(&fast, 2).unwrap().fits()[2].frequency();
        assert!((frequency - 1.94).abs() < 0.01, "{frequency}");
    }

    #[test]
    fn a_still_joint_beside_a_waving_one_is_fitted() {
        let cycle = cycle();
        let half = recorded("half", uniform(4.0), |t, d| {
            if d == 0 { cycle.position(t)[0] } else { 0.7 }
        });
        let fits = CycleFits::new(&[half], 2).unwrap();
        let wave = &fits.fits()[0].wave;
        assert!((wave.offsets()[1] - 0.7).abs() < 1e-12);
        assert!(wave.weights().row(1).camax() < 1e-12);
    }
}

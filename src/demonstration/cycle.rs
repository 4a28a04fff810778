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
        halve_doubled(&mut seen, &used);
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

/// Takes those at half of their tempo that were taken at twice it, beside the median of all.
fn halve_doubled(seen: &mut [MeanCycle], recordings: &[&Recording]) {
    if seen.is_empty() {
        return;
    }
    let usual = median(seen.iter().map(|one| one.fit.frequency()).collect());
    for (one, recording) in seen.iter_mut().zip(recordings) {
        if TWICE.contains(&(one.fit.frequency() / usual))
            && let Some(half) = one.of_half_tempo(recording)
        {
            *one = half;
        }
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
mod tests;

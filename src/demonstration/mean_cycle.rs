//! The mean cycle of one recording: its frequency, its weights, and what varies about it.

use std::f64::consts::TAU;

use super::cycle::CycleFit;
use super::demodulation::{self, CENTRES, Window};
use super::jitter::Series;
use super::recording::Recording;
use super::residual::{Bands, Left};
use super::steady;
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::Wave;

/// Three, but for the sample that an open grid lacks and the error of the frequency. Fewer cycles have no variation from
/// cycle to cycle that could be told from drift.
const FEWEST_CYCLES: f64 = 2.8;
/// Harmonics of a cycle explain less than this of a motion that has no rhythm.
const LEAST_EXPLAINED: f64 = 0.4;
/// Its frequency is looked for in the first minute \[s\]: later a rhythm is out of step with its start, and its phase,
/// which is followed to the end, says what the frequency is. So is what the cycles leave, of which a minute tells enough.
const LONGEST: f64 = 60.0;
/// Where less than this is unexplained the tempo is right.
const MUCH: f64 = 0.1;
/// By this factor. With half the frequency a fit has odd harmonics of it to follow noise with, which takes less than this.
const CLEARLY: f64 = 0.75;

/// A fit whose levels are not known yet, with what they follow from.
pub(super) struct MeanCycle {
    pub fit: CycleFit,
    pub amplitude: Series,
    pub tempo: Series,
    pub residual: Bands,
}

impl MeanCycle {
    pub(super) fn of(recording: &Recording, harmonics: usize) -> Result<Self> {
        Self::near(recording, recording.tempo(), harmonics)
    }

    /// The same about half of its tempo, if much of the motion is unexplained and that leaves clearly less: where a joint moves twice a cycle and farther than the others do, its
    /// movement has been taken for the cycle.
    pub(super) fn of_half_tempo(&self, recording: &Recording) -> Option<Self> {
        let harmonics = self.fit.wave.harmonics();
        let left = |one: &Self| 1.0 - one.fit.explained;
        if left(self) < MUCH {
            return None;
        }
        let half = Self::near(recording, 0.5 * self.fit.frequency(), harmonics).ok()?;
        (left(&half) <= CLEARLY * left(self)).then_some(half)
    }

    fn near(recording: &Recording, tempo: f64, harmonics: usize) -> Result<Self> {
        let (times, positions) = (&recording.times, &recording.positions);
        let span = recording.span();
        let told = |error: Error| match error.kind() {
            ErrorKind::Infeasible => drowned(recording).unwrap_or(error),
            _ => error,
        };
        check(recording, tempo, harmonics).map_err(told)?;
        let start = recording.first(LONGEST);
        let near = steady::frequency(&start.times, &start.positions, tempo, harmonics);
        check(recording, near, harmonics).map_err(told)?;

        let windows = demodulation::demodulate(&recording.without_drift(), near);
        if demodulation::a_cycle_apart(&windows).len() < CENTRES / 2 {
            return Err(
                Error::new(ErrorKind::Infeasible, "gaps leave no two cycles in a row")
                    .expected("at least three cycles of a rhythm"),
            );
        }
        let joint = demodulation::dominant(&windows);
        let amplitudes: Vec<f64> = windows.iter().map(|w| w.phasors[joint].norm()).collect();
        let mean = amplitudes.iter().sum::<f64>() / amplitudes.len() as f64;
        if mean.is_nan() || mean <= 0.0 {
            return Err(no_rhythm(near, 0.0));
        }
        let gains: Vec<f64> = amplitudes.iter().map(|a| a / mean).collect();
        // A constant phase belongs to the cycle, a steady gain of phase to its frequency, and the rest is jitter.
        let (wander, gain) = without_line(&windows, &demodulation::unwrapped(&windows, joint));
        let frequency = near * (1.0 + gain / TAU);

        let cycles: Vec<f64> = times.iter().map(|t| (t - times[0]) * near).collect();
        let steady: Vec<f64> = times
            .iter()
            .map(|t| TAU * frequency * (t - times[0]))
            .collect();
        let ones = vec![1.0; times.len()];
        let rigid = steady::fit(times, positions, &steady, &ones, harmonics)?;
        let along: Vec<f64> = steady
            .iter()
            .zip(between(&windows, &wander, &cycles))
            .map(|(phase, p)| phase + p)
            .collect();
        let swell = between(&windows, &gains, &cycles);
        let lively = steady::fit(times, positions, &along, &swell, harmonics)?;
        let steady_share = rigid.explained;
        // Where the jitter of the dominant joint is not that of the others, following it explains less.
        let best = if lively.explained < rigid.explained {
            rigid
        } else {
            lively
        };
        if best.explained < LEAST_EXPLAINED {
            return Err(no_rhythm(frequency, best.explained));
        }
        let logarithms: Vec<f64> = gains
            .iter()
            .map(|g| g.max(f64::MIN_POSITIVE).ln())
            .collect();
        let seen = times.partition_point(|t| *t <= times[0] + LONGEST).max(2);
        let left = Left {
            cycles: &times[..seen]
                .iter()
                .map(|t| t * frequency)
                .collect::<Vec<f64>>(),
            positions: best.left.rows(0, seen),
            fitted: best.fitted.rows(0, seen),
            size: best.weights.norm(),
        };
        Ok(Self {
            residual: Bands::of(&left, (harmonics + 1) as f64),
            amplitude: Series::amplitude(&windows, &cycles, &logarithms),
            tempo: Series::tempo(&windows, &cycles, &wander),
            fit: CycleFit {
                name: recording.name.clone(),
                wave: Wave::new(
                    recording.joints.clone(),
                    1.0 / frequency,
                    best.offsets,
                    best.weights,
                )?,
                explained: steady_share,
                explained_with_jitter: best.explained,
                cycles: span * frequency,
                amplitude_jitter: 0.0,
                tempo_jitter: 0.0,
            },
        })
    }
}

/// What is slow has the most energy, though there is a rhythm.
fn drowned(recording: &Recording) -> Option<Error> {
    let parts = recording.rhythmic_parts();
    let most = parts.iter().max_by(|a, b| a.cycles.total_cmp(&b.cycles))?;
    (most.cycles >= FEWEST_CYCLES).then(|| {
        let what = format!(
            "posture moves more than the rhythm of {:.2} Hz does",
            most.frequency
        );
        Error::new(ErrorKind::Infeasible, what)
            .expected("three cycles of what moves most")
            .help("take out what is slow (--remove-drift=slow)")
    })
}

fn no_rhythm(frequency: f64, explained: f64) -> Error {
    Error::new(
        ErrorKind::Infeasible,
        format!(
            "a rhythm of {frequency:.2} Hz explains {:.0} % of the motion",
            100.0 * explained
        ),
    )
    .expected(format!("at least {:.0} %", 100.0 * LEAST_EXPLAINED))
    .help("is it a rhythmic gesture, without what comes before and after?")
}

/// `values` less the straight line through them, and that line's slope a cycle.
fn without_line(windows: &[Window], values: &[f64]) -> (Vec<f64>, f64) {
    let count = values.len() as f64;
    let middle = windows.iter().map(|w| w.centre).sum::<f64>() / count;
    let mean = values.iter().sum::<f64>() / count;
    let spread: f64 = windows.iter().map(|w| (w.centre - middle).powi(2)).sum();
    let slope = windows
        .iter()
        .zip(values)
        .map(|(w, x)| (w.centre - middle) * (x - mean))
        .sum::<f64>()
        / spread;
    let rest = windows
        .iter()
        .zip(values)
        .map(|(w, x)| x - mean - slope * (w.centre - middle))
        .collect();
    (rest, slope)
}

/// Whether a recording has cycles enough of `frequency`, and samples enough for its harmonics.
fn check(recording: &Recording, frequency: f64, harmonics: usize) -> Result<()> {
    let span = recording.span();
    let cycles = span * frequency;
    if cycles < FEWEST_CYCLES {
        return Err(Error::new(
            ErrorKind::Infeasible,
            format!("{cycles:.1} cycles in {span:.2} s"),
        )
        .expected("at least 3"));
    }
    let nyquist = (recording.times.len() - 1) as f64 / (2.0 * span);
    if harmonics as f64 * frequency >= nyquist {
        return Err(Error::new(
            ErrorKind::Shape,
            format!(
                "{:.1} samples a cycle for {harmonics} harmonics",
                2.0 * nyquist / frequency
            ),
        )
        .expected(format!("more than {}", 2 * harmonics))
        .help("take fewer harmonics"));
    }
    Ok(())
}

/// Values at the windows' centres, linear between them and constant beyond, at the samples' times `cycles`.
fn between(windows: &[Window], values: &[f64], cycles: &[f64]) -> Vec<f64> {
    cycles
        .iter()
        .map(|u| {
            let next = windows.partition_point(|w| w.centre <= *u);
            if next == 0 {
                return values[0];
            }
            if next == windows.len() {
                return values[next - 1];
            }
            let (a, b) = (windows[next - 1].centre, windows[next].centre);
            let share = (u - a) / (b - a);
            values[next - 1] + (values[next] - values[next - 1]) * share
        })
        .collect()
}

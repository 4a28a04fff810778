//! [`CycleFit`] and [`CycleFits`]: recordings described by a mean cycle and its variation.

use super::demodulation::{self, Window};
use super::jitter::{self, Series};
use super::recording::Recording;
use super::{LeftOut, steady};
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::{Autoregression, Joints, Wave};

/// Three, but for the sample that an open grid lacks and the error of the frequency. Fewer cycles have no variation from
/// cycle to cycle that could be told from drift.
const FEWEST_CYCLES: f64 = 2.8;
/// Harmonics of a cycle explain less than this of a motion that has no rhythm.
const LEAST_EXPLAINED: f64 = 0.4;
/// No arm's cycle has more, and the search for its frequency takes time with their cube.
const MOST_HARMONICS: usize = 50;

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
    /// The same when amplitude and tempo vary as they were found to.
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
}

impl CycleFits {
    /// Fits each of `recordings`, uncut, with `harmonics` harmonics of its own frequency.
    ///
    /// # Errors
    /// When there are no recordings, their joints differ, the harmonics are none or beyond 50, or no recording can be
    /// used. One that cannot (less than three cycles, no rhythm, too few samples) is left out, by name.
    pub fn new(recordings: &[Recording], harmonics: usize) -> Result<Self> {
        if !(1..=MOST_HARMONICS).contains(&harmonics) {
            return Err(Error::new(
                ErrorKind::Setting,
                format!("{harmonics} harmonics of a cycle"),
            )
            .expected(format!("from 1 to {MOST_HARMONICS}")));
        }
        let joints = super::common_joints(recordings)?;
        let mut seen = Vec::new();
        let mut left_out = Vec::new();
        for recording in recordings {
            match Demodulated::of(recording, harmonics) {
                Ok(one) => seen.push(one),
                Err(error) => left_out.push(LeftOut {
                    name: recording.name.clone(),
                    reason: error.to_string(),
                }),
            }
        }
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
        let levels = jitter::levels(&amplitudes, &amplitude)
            .into_iter()
            .zip(jitter::levels(&tempos, &tempo));
        let fits = levels
            .zip(&seen)
            .map(|((amplitude_jitter, tempo_jitter), one)| CycleFit {
                amplitude_jitter,
                tempo_jitter,
                ..one.fit.clone()
            })
            .collect();
        Ok(Self {
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
}

/// A fit whose levels are not known yet, with what they follow from.
struct Demodulated {
    fit: CycleFit,
    amplitude: Series,
    tempo: Series,
}

impl Demodulated {
    fn of(recording: &Recording, harmonics: usize) -> Result<Self> {
        let (times, positions) = (&recording.times, &recording.positions);
        let span = recording.span();
        let tempo = recording.tempo();
        check(recording, tempo, harmonics)?;
        let frequency = steady::frequency(times, positions, tempo, harmonics);
        check(recording, frequency, harmonics)?;

        let cycles: Vec<f64> = times.iter().map(|t| (t - times[0]) * frequency).collect();
        let turn = |u: &f64| std::f64::consts::TAU * u;
        let phases: Vec<f64> = cycles.iter().map(turn).collect();
        let ones = vec![1.0; times.len()];
        let rigid = steady::fit(times, positions, &phases, &ones, harmonics)?;

        let flat = recording.without_drift();
        let windows = demodulation::demodulate(&flat, frequency);
        if demodulation::a_cycle_apart(&windows).is_empty() {
            return Err(
                Error::new(ErrorKind::Infeasible, "gaps leave no two cycles in a row")
                    .expected("at least three cycles of a rhythm"),
            );
        }
        let joint = demodulation::dominant(&windows);
        let amplitudes: Vec<f64> = windows.iter().map(|w| w.phasors[joint].norm()).collect();
        let deviations = demodulation::unwrapped(&windows, joint);
        let mean = amplitudes.iter().sum::<f64>() / amplitudes.len() as f64;
        let gains: Vec<f64> = amplitudes.iter().map(|a| a / mean).collect();
        // The dominant joint's own phase belongs to the cycle, only what wanders to the way there.
        let centre = deviations.iter().sum::<f64>() / deviations.len() as f64;
        let wander: Vec<f64> = deviations.iter().map(|p| p - centre).collect();

        let along: Vec<f64> = phases
            .iter()
            .zip(between(&windows, &wander, &cycles))
            .map(|(phase, p)| phase + p)
            .collect();
        let gain = between(&windows, &gains, &cycles);
        let lively = steady::fit(times, positions, &along, &gain, harmonics)?;
        let best = rigid.explained.max(lively.explained);
        if best < LEAST_EXPLAINED {
            return Err(Error::new(
                ErrorKind::Infeasible,
                format!(
                    "a rhythm of {frequency:.2} Hz explains {:.0} % of the motion",
                    100.0 * best
                ),
            )
            .expected(format!("at least {:.0} %", 100.0 * LEAST_EXPLAINED))
            .help("is it a rhythmic gesture, without what comes before and after?"));
        }
        let logarithms: Vec<f64> = gains
            .iter()
            .map(|g| g.max(f64::MIN_POSITIVE).ln())
            .collect();
        Ok(Self {
            amplitude: Series::amplitude(&windows, &cycles, &logarithms),
            tempo: Series::tempo(&windows, &cycles, &wander),
            fit: CycleFit {
                name: recording.name.clone(),
                wave: Wave::new(
                    recording.joints.clone(),
                    1.0 / frequency,
                    lively.offsets,
                    lively.weights,
                )?,
                explained: rigid.explained,
                explained_with_jitter: lively.explained,
                cycles: span * frequency,
                amplitude_jitter: 0.0,
                tempo_jitter: 0.0,
            },
        })
    }
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

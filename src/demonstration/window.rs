//! The common period T: which recordings to keep, and how much of them.

use super::Recording;
use crate::error::{Error, ErrorKind, Result};

/// Cycles that a window must hold for its rhythm to be learned.
const FEWEST_CYCLES: f64 = 3.0;

/// How the common period is chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Duration {
    /// The span of one of the recordings: the one for which (recordings kept) x T is largest, where a recording is kept
    /// if it lasts T and makes at least three cycles within it. (The shortest span would be at the mercy of one short
    /// recording.)
    Auto,
    /// This many seconds.
    Seconds(f64),
}

/// A recording that was left out.
#[derive(Debug, Clone, PartialEq)]
pub struct LeftOut {
    /// Its name.
    pub name: String,
    /// Why: how long it is, or how few cycles it has.
    pub reason: String,
}

struct Candidate {
    recording: Recording,
    /// The longest period it can serve \[s\].
    covers: f64,
    /// Dominant frequency \[Hz\].
    tempo: f64,
}

impl Candidate {
    fn new(recording: Recording) -> Self {
        let span = recording.span();
        // N samples at a step of T/N lack their end point, and yet are a whole period.
        let step = span / (recording.times.len() - 1) as f64;
        Self {
            covers: span + step,
            tempo: recording.tempo(),
            recording,
        }
    }

    fn refusal(&self, period: f64, fewest_cycles: f64) -> Option<String> {
        // Stamps are often printed with few digits.
        if self.covers < period * (1.0 - 1e-4) {
            Some(format!(
                "lasts {:.3} s of {period:.3} s",
                self.recording.span()
            ))
        } else if self.tempo * period < fewest_cycles {
            Some(format!(
                "makes {:.1} cycles in {period:.3} s, fewer than {fewest_cycles}",
                self.tempo * period
            ))
        } else {
            None
        }
    }
}

/// The period, the recordings cut to it, and those left out.
pub(super) fn cut(
    recordings: Vec<Recording>,
    duration: Duration,
) -> Result<(f64, Vec<Recording>, Vec<LeftOut>)> {
    let candidates: Vec<Candidate> = recordings.into_iter().map(Candidate::new).collect();
    let (period, fewest_cycles) = match duration {
        Duration::Seconds(seconds) if seconds.is_finite() && seconds > 0.0 => (seconds, 0.0),
        Duration::Seconds(seconds) => {
            return Err(
                Error::new(ErrorKind::Setting, format!("duration of {seconds} s"))
                    .expected("a positive number of seconds"),
            );
        }
        Duration::Auto => (best_period(&candidates), FEWEST_CYCLES),
    };
    let slowest_rate = candidates
        .iter()
        .map(|c| c.recording.span() / (c.recording.times.len() - 1) as f64)
        .fold(0.0, f64::max);
    let mut kept = Vec::new();
    let mut left_out = Vec::new();
    for candidate in candidates {
        match candidate.refusal(period, fewest_cycles) {
            None => kept.push(first_seconds(&candidate.recording, period)?),
            Some(reason) => left_out.push(LeftOut {
                name: candidate.recording.name,
                reason,
            }),
        }
    }
    if kept.len() < 2 {
        // No wave is seen at a sample every half second.
        let coarse = slowest_rate > 0.5;
        let reasons: Vec<String> = left_out
            .iter()
            .take(5)
            .map(|l| format!("; {} {}", l.name, l.reason))
            .collect();
        return Err(Error::new(
            ErrorKind::Infeasible,
            format!(
                "only {} of {} recordings can be used for a period of {period:.3} s{}",
                kept.len(),
                kept.len() + left_out.len(),
                reasons.join("")
            ),
        )
        .expected("at least two")
        .help(if coarse {
            "are the times in milliseconds? `time_s` is seconds"
        } else if left_out.is_empty() {
            "give several recordings of the same gesture: from one nothing is known of how they vary"
        } else {
            "give longer recordings of the same gesture, or a shorter --duration"
        }));
    }
    Ok((period, kept, left_out))
}

fn best_period(candidates: &[Candidate]) -> f64 {
    let score = |period: f64| {
        let kept = candidates
            .iter()
            .filter(|c| c.refusal(period, FEWEST_CYCLES).is_none())
            .count();
        // Of one recording nothing can be learned.
        if kept < 2 { 0.0 } else { kept as f64 * period }
    };
    let mut spans: Vec<f64> = candidates.iter().map(|c| c.recording.span()).collect();
    spans.sort_by(f64::total_cmp);
    // At equal scores the longer period, which is seen last.
    spans
        .into_iter()
        .map(|t| (t, score(t)))
        .fold(
            (0.0, -1.0),
            |best, next| if next.1 >= best.1 { next } else { best },
        )
        .0
}

/// The samples from the start to T, the end point included where there is one, times from 0.
fn first_seconds(recording: &Recording, period: f64) -> Result<Recording> {
    let start = recording.times[0];
    // A stamp at the end may have been rounded upwards; it is still the end point.
    let end = period * (1.0 + 1e-9);
    let times: Vec<f64> = recording
        .times
        .iter()
        .map(|t| t - start)
        .take_while(|t| *t <= end)
        .collect();
    let positions = recording.positions.rows(0, times.len()).into_owned();
    Recording::new(
        recording.name.clone(),
        recording.joints.clone(),
        times,
        positions,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fourier::Joints;
    use nalgebra::DMatrix;

    fn sine(name: &str, frequency: f64, span: f64) -> Recording {
        let times: Vec<f64> = (0..=(span * 50.0).round() as usize)
            .map(|n| n as f64 / 50.0)
            .collect();
        let positions = DMatrix::from_fn(times.len(), 1, |n, _| {
            (std::f64::consts::TAU * frequency * times[n] + 0.4).sin()
        });
        Recording::new(name, Joints::new(["a"]).unwrap(), times, positions).unwrap()
    }

    #[test]
    fn one_long_recording_is_not_the_only_one_that_is_kept() {
        let all = [100.0, 4.0, 4.2].map(|span| sine(&format!("{span} s"), 2.0, span));
        let (period, kept, _) = cut(all.to_vec(), Duration::Auto).unwrap();
        assert_eq!((period, kept.len()), (4.0, 3));
    }

    #[test]
    fn one_short_recording_does_not_shorten_all() {
        let mut recordings: Vec<_> = [5.0, 5.2, 5.4, 6.0]
            .iter()
            .map(|span| sine(&format!("{span} s"), 2.0, *span))
            .collect();
        recordings.push(sine("short", 2.0, 1.0));
        let (period, kept, left_out) = cut(recordings, Duration::Auto).unwrap();
        // 4 x 5.0 = 20 against 3 x 5.2, 2 x 5.4, 1 x 6.0 and 5 x 1.0 (and two cycles are too few).
        assert!((period - 5.0).abs() < 1e-12);
        assert_eq!(kept.len(), 4);
        assert_eq!(left_out[0].name, "short");
        assert!(left_out[0].reason.contains("lasts 1.000 s"));
        assert!(
            kept.iter()
                .all(|r| r.times.len() == 251 && r.times[250] == 5.0)
        );
    }

    #[test]
    fn a_slow_recording_has_too_few_cycles_unless_the_user_says_so() {
        let recordings = vec![
            sine("a", 2.0, 4.0),
            sine("b", 2.0, 4.0),
            sine("slow", 0.5, 4.0),
        ];
        let (_, _, left_out) = cut(recordings.clone(), Duration::Auto).unwrap();
        assert!(left_out[0].name == "slow" && left_out[0].reason.contains("cycles"));
        let (_, kept, _) = cut(recordings, Duration::Seconds(4.0)).unwrap();
        assert_eq!(kept.len(), 3);
    }

    #[test]
    fn an_open_grid_is_a_whole_period() {
        let open: Vec<f64> = (0..100).map(|n| f64::from(n) / 50.0).collect();
        let positions = DMatrix::from_fn(100, 1, |n, _| (0.5 * n as f64).sin());
        let recording =
            Recording::new("open", Joints::new(["a"]).unwrap(), open, positions).unwrap();
        let (_, kept, _) = cut(vec![recording.clone(), recording], Duration::Seconds(2.0)).unwrap();
        assert_eq!(kept[0].times.len(), 100);
    }
}

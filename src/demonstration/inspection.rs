//! [`Inspection`]: what of a recording would be learned, and what may be wrong with it.

use nalgebra::DVector;

use super::finding::{Finding, Flag};
use super::half_cycles;
use super::hand;
use super::leakage::Leakage;
use super::pieces;
use super::recording::Recording;
use super::rhythmic_part::{self, RhythmicPart};
use super::variation::{self, Variation};
use crate::error::Result;
use crate::fourier::FourierBasis;

/// Faster than this no joint of an arm moves \[rad/s\].
const FASTEST_JOINT: f64 = 20.0;
/// Nearer to 0 than this the cosine of the shoulder's second angle makes the other two jump.
const NEAR_SINGULAR: f64 = 0.25;
/// A joint that goes no farther than this stands still \[rad\].
const STANDS_STILL: f64 = 1e-3;
/// Of fewer cycles it cannot be told how they vary.
const FEWEST_CYCLES: f64 = 3.0;
/// Harmonics a cycle, of so many cycles at most, that the leakage is of.
const HARMONICS: usize = 4;
const LEAKAGE_CYCLES: f64 = 10.0;
/// Half cycles that go to and fro once or twice.
const TO_AND_FRO: std::ops::RangeInclusive<usize> = 2..=4;
/// In a motion that turns, of the way from lowest to highest.
const TURNS: f64 = 0.4;

/// What a look at one recording shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Inspection {
    /// The recording.
    pub name: String,
    /// Its rhythmic parts, by time.
    pub parts: Vec<RhythmicPart>,
    /// From when to when \[s\] would be learned: the spans of [`Recording::gestures`].
    pub used: Vec<(f64, f64)>,
    /// Of the part that moves most; `None` without a rhythm.
    pub rhythm: Option<Rhythm>,
    /// What may be wrong.
    pub findings: Vec<Finding>,
}

/// How the part of a recording that moves most goes.
#[derive(Debug, Clone, PartialEq)]
pub struct Rhythm {
    /// The part, in whole cycles.
    pub part: RhythmicPart,
    /// How its cycles vary.
    pub variation: Variation,
    /// What four harmonics a cycle leave of its first ten cycles at most.
    pub leakage: Leakage,
    /// Mean position of each joint \[rad\].
    pub posture: DVector<f64>,
}

impl Inspection {
    /// Looks at one recording.
    ///
    /// # Errors
    /// None that a valid recording could cause.
    pub fn of(recording: &Recording) -> Result<Self> {
        let missing = pieces::missing(recording);
        let arm = hand::arm(recording);
        let second = arm.as_ref().map(|arm| arm.second);
        let seen = hand::seen_of(recording, arm);
        let parts = rhythmic_part::find(&seen, &missing);
        let used = recording.spans(&seen, &parts);
        let unwrapped = recording.unwrapped();
        let most = parts
            .iter()
            .max_by(|a, b| (a.cycles * a.size).total_cmp(&(b.cycles * b.size)));
        // A rhythm in which gaps leave no two cycles in a row is found, and cannot be measured.
        let rhythm = most.and_then(|part| Rhythm::of(&unwrapped, part).ok());

        let is_short = rhythm.is_none() && most.is_some_and(|part| part.cycles < FEWEST_CYCLES);
        let mut findings = Vec::new();
        let mut add = |flag, time, joint: Option<usize>, value| {
            findings.push(Finding {
                flag,
                time,
                joint: joint.map(|d| recording.joints.name(d).to_owned()),
                value,
            });
        };
        match parts.len() {
            0 if goes_to_and_fro(&seen) => add(Flag::FewCycles, None, None, 0.0),
            0 => add(Flag::NoRhythm, None, None, 0.0),
            _ if is_short => add(Flag::FewCycles, None, None, 0.0),
            1 => {}
            count => add(Flag::SeveralParts, None, None, count as f64),
        }
        // What is missing beside a part may have cut it short.
        let cycle = parts.iter().map(|p| 1.0 / p.frequency).fold(0.0, f64::max);
        for stretch in &missing {
            let flag = if stretch.frozen {
                Flag::FrozenFrames
            } else {
                Flag::Gap
            };
            let concerns = |(start, end): &(f64, f64)| {
                stretch.start < end + cycle && start - cycle < stretch.end
            };
            if used.iter().any(concerns) {
                add(flag, Some(stretch.start), None, stretch.end - stretch.start);
            }
        }
        for d in 0..recording.joints.len() {
            if let Some((count, first)) = turn_jumps(recording, d) {
                add(Flag::TurnJump, Some(first), Some(d), count as f64);
            }
        }
        for (start, end) in &used {
            let Ok(part) = unwrapped.between(*start, *end) else {
                continue;
            };
            for d in 0..part.joints.len() {
                let column = part.positions.column(d);
                let way = column.max() - column.min();
                if way <= STANDS_STILL {
                    add(Flag::StillJoint, None, Some(d), way);
                }
                let (time, speed) = fastest(&part, d);
                if speed > FASTEST_JOINT {
                    add(Flag::FastJump, Some(time), Some(d), speed);
                }
            }
            if let Some(d) = second {
                let cosines = part.positions.column(d).map(|angle| angle.cos().abs());
                let nearest = cosines.imin();
                if cosines[nearest] < NEAR_SINGULAR {
                    add(
                        Flag::Gimbal,
                        Some(part.times[nearest]),
                        Some(d),
                        cosines[nearest],
                    );
                }
            }
        }
        Ok(Self {
            name: recording.name.clone(),
            parts,
            used,
            rhythm,
            findings,
        })
    }

    /// Whether anything was found that spoils a demonstration.
    pub fn is_spoilt(&self) -> bool {
        self.findings.iter().any(|finding| finding.flag.spoils())
    }
}

impl Rhythm {
    fn of(recording: &Recording, part: &RhythmicPart) -> Result<Self> {
        let part = part.whole_cycles();
        let cut = recording.cut(&part)?;
        Ok(Self {
            part,
            variation: variation::measure(&cut, part.frequency)?,
            leakage: leakage(&cut, &part)?,
            posture: cut.positions.row_mean().transpose(),
        })
    }
}

fn leakage(cut: &Recording, part: &RhythmicPart) -> Result<Leakage> {
    let cycles = part.cycles.min(LEAKAGE_CYCLES);
    let start = cut.times[0];
    let mut first = cut.first(part.duration() * cycles / part.cycles);
    first.times.iter_mut().for_each(|t| *t -= start);
    // N samples at a step of T/N lack their end point.
    let period = first.span() * (1.0 + 1.0 / first.times.len() as f64);
    let most = (first.times.len().saturating_sub(2) / 2).max(1);
    let harmonics = (HARMONICS * cycles as usize).clamp(1, most);
    let wave =
        FourierBasis::new(period, harmonics)?.fit(&first.joints, &first.times, &first.positions)?;
    Ok(first.leakage(&wave))
}

/// How often a joint jumps by whole turns, and when first \[s\].
fn turn_jumps(recording: &Recording, joint: usize) -> Option<(usize, f64)> {
    let y = recording.positions.column(joint);
    let mut jumps = (1..y.len()).filter(|n| (y[*n] - y[n - 1]).abs() > std::f64::consts::PI);
    let first = jumps.next()?;
    Some((1 + jumps.count(), recording.times[first]))
}

/// When a joint is fastest \[s\], and how fast \[rad/s\].
fn fastest(recording: &Recording, joint: usize) -> (f64, f64) {
    let (t, y) = (&recording.times, recording.positions.column(joint));
    (1..y.len())
        .map(|n| (t[n], ((y[n] - y[n - 1]) / (t[n] - t[n - 1])).abs()))
        .fold(
            (0.0, 0.0),
            |best, next| if next.1 > best.1 { next } else { best },
        )
}

/// Whether the joint that moves most turns once or twice: a wave that is too short, and not no wave.
fn goes_to_and_fro(seen: &Recording) -> bool {
    let way = |d: usize| {
        let y = seen.positions.column(d);
        y.max() - y.min()
    };
    let most = (0..seen.joints.len()).fold(0, |best, d| if way(d) > way(best) { d } else { best });
    let y = seen.positions.column(most);
    let turns = half_cycles::turning_points(y.iter().copied(), TURNS * way(most));
    way(most) > 0.0 && TO_AND_FRO.contains(&turns.len().saturating_sub(1))
}

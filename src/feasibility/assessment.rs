//! [`Assessment`]: how often draws of a model fail on a robot, with bounds that hold.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{Change, LimitUse, Mended, Verdict, touching};
use crate::collision::{Certification, Evidence};
use crate::document;
use crate::error::{Error, ErrorKind, Reason, Result};
use crate::fourier::Wave;
use crate::proportion::clopper_pearson;

/// What an assessment file calls itself, and its version.
const ASSESSMENT: &str = "undulate assessment";
const VERSION: u64 = 1;

/// Width of a bin of the histogram \[m\].
const BIN: f64 = 2e-3;

/// What became of draws of a model on a robot: counts, and the worst wave of each kind of failure.
///
/// Everything in it is counted or largest, so that assessments of disjoint draws [`merge`](Self::merge) to the same bytes in whatever order, as if
/// they had been one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Assessment {
    format: String,
    version: u64,
    /// What it rests on, by what it is: hashes of files, and words.
    rests_on: BTreeMap<String, String>,
    seed: u64,
    /// All that are to be drawn.
    waves: u64,
    /// Which have been: ranges of numbers, the end left out, in order and apart.
    drawn: Vec<(u64, u64)>,
    passed: u64,
    failures: BTreeMap<String, Failure>,
    clearance: Histogram,
    mending: Mending,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Failure {
    count: u64,
    worst: Worst,
}

/// The worst wave of a kind of failure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Worst {
    /// Its number among the draws of the seed.
    pub draw: u64,
    /// How bad it is: the excess as a share of the limit, or how far the nearest pair is short of the margin \[m\].
    pub severity: f64,
    /// The wave on the robot's joints, as a wave file; none where the draw could not be put on the robot.
    pub wave: Option<String>,
}

/// Smallest clearances, counted in bins of 2 mm.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Histogram {
    /// By number: bin n is from 2 n mm on.
    bins: BTreeMap<i64, u64>,
    /// Draws whose clearance was not found.
    unknown: u64,
}

/// How many of the draws that fail pass after mending, and how many of these by each means.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Mending {
    tried: u64,
    mended: u64,
    shifted: u64,
    slowed: u64,
    joints_shrunk: u64,
    all_shrunk: u64,
}

/// A count of trials, and the exact one-sided bound on the probability behind it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounded {
    /// Trials of that kind.
    pub count: u64,
    /// At the confidence asked for, the probability is on this side of it: above for passing, below for failures.
    pub bound: f64,
}

impl Assessment {
    /// Of no draw yet, of `waves` that are to be drawn from `seed`; `rests_on` is what all of them share.
    pub fn new(rests_on: &[Evidence], words: &[(&str, String)], seed: u64, waves: u64) -> Self {
        // Names of files differ from machine to machine, their bytes do not.
        let hashes = rests_on
            .iter()
            .map(|e| (e.what.clone(), format!("sha256 {}", e.sha256)));
        let words = words
            .iter()
            .map(|(what, word)| ((*what).to_owned(), word.clone()));
        Self {
            format: ASSESSMENT.to_owned(),
            version: VERSION,
            rests_on: hashes.chain(words).collect(),
            seed,
            waves,
            drawn: Vec::new(),
            passed: 0,
            failures: BTreeMap::new(),
            clearance: Histogram::default(),
            mending: Mending::default(),
        }
    }

    /// Adds draw number `draw`: the wave on the robot's joints with its verdict, or why there is none; and what mending made of it, where it was tried.
    pub fn add(&mut self, draw: u64, outcome: &Result<(Wave, Verdict)>, mended: Option<&Mended>) {
        let reasons = match outcome {
            Ok((_, verdict)) => verdict.reasons(),
            Err(error) => vec![Reason::of(error)],
        };
        self.drawn = united(&self.drawn, &[(draw, draw + 1)]);
        self.passed += u64::from(reasons.is_empty());
        for reason in reasons {
            let worst = Worst {
                draw,
                severity: outcome
                    .as_ref()
                    .map_or(0.0, |(_, verdict)| severity(verdict, reason)),
                wave: outcome.as_ref().ok().map(|(wave, _)| wave.to_json()),
            };
            self.count(reason.code(), 1, worst);
        }
        let found = outcome
            .as_ref()
            .ok()
            .and_then(|(_, v)| v.clearance.as_ref());
        match found {
            Some(found) => {
                let bin = (found.lower / BIN).floor() as i64;
                *self.clearance.bins.entry(bin).or_default() += 1;
            }
            None => self.clearance.unknown += 1,
        }
        if let Some(mended) = mended {
            let mending = &mut self.mending;
            mending.tried += 1;
            if mended.verdict.passes() {
                let by = |is: fn(&Change) -> bool| u64::from(mended.changes.iter().any(is));
                mending.mended += 1;
                mending.shifted += by(|c| matches!(c, Change::Shifted { .. }));
                mending.slowed += by(|c| matches!(c, Change::Slowed { .. }));
                mending.joints_shrunk += by(|c| matches!(c, Change::Shrunk { joint: Some(_), .. }));
                mending.all_shrunk += by(|c| matches!(c, Change::Shrunk { joint: None, .. }));
            }
        }
    }

    fn count(&mut self, code: &str, count: u64, worst: Worst) {
        match self.failures.get_mut(code) {
            None => {
                self.failures
                    .insert(code.to_owned(), Failure { count, worst });
            }
            Some(failure) => {
                failure.count += count;
                let old = &failure.worst;
                // Of equals the first drawn.
                let is_worse = worst.severity > old.severity
                    || worst.severity == old.severity && worst.draw < old.draw;
                if is_worse {
                    failure.worst = worst;
                }
            }
        }
    }

    /// This assessment and another part of it.
    ///
    /// # Errors
    /// When they do not rest on the same, are not parts of the same draws, or have draws in common.
    pub fn merge(&self, other: &Self) -> Result<Self> {
        let refuse = |what: String| {
            Err(Error::new(ErrorKind::Infeasible, what).expected(
                "parts of one assessment: the same model, robot, options, seed and number of waves",
            ))
        };
        for what in self.rests_on.keys().chain(other.rests_on.keys()) {
            if self.rests_on.get(what) != other.rests_on.get(what) {
                return refuse(format!("assessments that differ in: {what}"));
            }
        }
        if (self.seed, self.waves) != (other.seed, other.waves) {
            return refuse(format!(
                "{} waves of seed {}, and {} of seed {}",
                self.waves, self.seed, other.waves, other.seed
            ));
        }
        let drawn = united(&self.drawn, &other.drawn);
        let count = |ranges: &[(u64, u64)]| ranges.iter().map(|(from, to)| to - from).sum::<u64>();
        if count(&drawn) < count(&self.drawn) + count(&other.drawn) {
            return refuse("draws that are in both".to_owned());
        }
        let mut merged = self.clone();
        merged.drawn = drawn;
        merged.passed += other.passed;
        for (code, failure) in &other.failures {
            merged.count(code, failure.count, failure.worst.clone());
        }
        for (bin, count) in &other.clearance.bins {
            *merged.clearance.bins.entry(*bin).or_default() += count;
        }
        merged.clearance.unknown += other.clearance.unknown;
        let (a, b) = (&mut merged.mending, &other.mending);
        a.tried += b.tried;
        a.mended += b.mended;
        a.shifted += b.shifted;
        a.slowed += b.slowed;
        a.joints_shrunk += b.joints_shrunk;
        a.all_shrunk += b.all_shrunk;
        Ok(merged)
    }

    /// How many waves have been drawn.
    pub fn drawn(&self) -> u64 {
        self.drawn.iter().map(|(from, to)| to - from).sum()
    }

    /// How many are to be.
    pub fn waves(&self) -> u64 {
        self.waves
    }

    /// How many passed, and what the probability of passing is above at `confidence`. Panics when that is not between 0 and 1.
    pub fn passed(&self, confidence: f64) -> Bounded {
        Bounded {
            count: self.passed,
            bound: one_sided(self.passed, self.drawn(), confidence).0,
        }
    }

    /// Each kind of failure by its code: how often, what its probability is below at `confidence`, and the worst. Panics when the confidence is not
    /// between 0 and 1.
    pub fn failures(&self, confidence: f64) -> impl Iterator<Item = (&str, Bounded, &Worst)> {
        let drawn = self.drawn();
        self.failures.iter().map(move |(code, failure)| {
            let bound = one_sided(failure.count, drawn, confidence).1;
            let count = failure.count;
            (code.as_str(), Bounded { count, bound }, &failure.worst)
        })
    }

    /// What the probability of a kind of failure that never came is below at `confidence`.
    pub fn unseen(&self, confidence: f64) -> f64 {
        one_sided(0, self.drawn(), confidence).1
    }

    /// Smallest clearances: from, to \[m\], and how many; and how many are not known.
    pub fn clearances(&self) -> (Vec<(f64, f64, u64)>, u64) {
        let bins = self.clearance.bins.iter();
        let edge = |n: f64| n * BIN;
        let edges = bins.map(|(n, count)| (edge(*n as f64), edge(*n as f64 + 1.0), *count));
        (edges.collect(), self.clearance.unknown)
    }

    /// Of the draws that fail: how many mending was tried on, how many pass after it, and how many of these were shifted, slowed, shrunk in single joints
    /// and shrunk as a whole.
    pub fn mending(&self) -> (u64, u64, [u64; 4]) {
        let m = &self.mending;
        let by = [m.shifted, m.slowed, m.joints_shrunk, m.all_shrunk];
        (m.tried, m.mended, by)
    }

    /// The assessment file, version 1.
    pub fn to_json(&self) -> String {
        document::write(self)
    }

    /// Reads an assessment file.
    ///
    /// # Errors
    /// When the text is none, is cut short or of a later version, or its counts do not fit together.
    pub fn from_json(text: &str) -> Result<Self> {
        let this: Self = document::read(text, ASSESSMENT, VERSION)?;
        let wrong = |what: &str| Err(Error::new(ErrorKind::Value, what));
        // Codes become names of files.
        let is_known = |code: &String| Reason::ALL.iter().any(|reason| reason.code() == code);
        if !this.failures.keys().all(is_known) {
            return wrong("a kind of failure that there is not");
        }
        let mut end = 0;
        for (n, (from, to)) in this.drawn.iter().enumerate() {
            if from >= to || (n > 0 && *from <= end) || *to > this.waves {
                return wrong("ranges of draws that are out of order");
            }
            end = *to;
        }
        let drawn = this.drawn();
        let clearances = this
            .clearance
            .bins
            .values()
            .try_fold(this.clearance.unknown, |sum: u64, count| {
                sum.checked_add(*count)
            });
        if this.passed > drawn
            || this.failures.values().any(|f| f.count > drawn)
            || clearances != Some(drawn)
            || this.mending.tried > drawn
            || this.mending.mended > this.mending.tried
        {
            return wrong("more waves of a kind than were drawn");
        }
        Ok(this)
    }
}

/// How bad a wave is in one kind of failure.
fn severity(verdict: &Verdict, reason: Reason) -> f64 {
    let share = |use_: &LimitUse| use_.excess() / use_.limit.magnitude().max(f64::MIN_POSITIVE);
    let limits = verdict.limits.iter().filter(|l| l.reason() == Some(reason));
    let efforts = verdict.efforts.iter().flatten();
    let efforts = efforts.filter(|e| e.reason() == Some(reason));
    let too = verdict
        .touches_too
        .as_ref()
        .filter(|m| touching(m) == reason);
    let distance = match (&verdict.clearance, &verdict.collision) {
        _ if too.is_some() => too.map_or(0.0, |moment| -moment.distance),
        (Some(found), _) => -found.lower,
        (None, Some(Certification::Collides { witness, .. })) => -witness.distance,
        _ => 0.0,
    };
    match reason {
        Reason::SelfCollision | Reason::SceneCollision | Reason::Clearance | Reason::Undecided => {
            distance
        }
        Reason::EffortLimit => efforts
            .map(|e| e.excess() / e.limit.unwrap_or(f64::INFINITY).max(f64::MIN_POSITIVE))
            .fold(0.0, f64::max),
        _ => limits.map(share).fold(0.0, f64::max),
    }
    // What is infinite has no place in the file.
    .min(f64::MAX)
}

/// Ranges of numbers, in order and apart.
fn united(a: &[(u64, u64)], b: &[(u64, u64)]) -> Vec<(u64, u64)> {
    let mut all: Vec<(u64, u64)> = a.iter().chain(b).copied().collect();
    all.sort_unstable();
    let mut united: Vec<(u64, u64)> = Vec::with_capacity(all.len());
    for (from, to) in all {
        match united.last_mut() {
            Some(last) if from <= last.1 => last.1 = last.1.max(to),
            _ => united.push((from, to)),
        }
    }
    united
}

/// The bounds below and above which a probability is, each at this confidence.
fn one_sided(count: u64, trials: u64, confidence: f64) -> (f64, f64) {
    assert!(
        confidence > 0.0 && confidence < 1.0,
        "a confidence of {confidence}"
    );
    let tail = 1.0 - confidence;
    // The interval leaves its rest on both sides alike.
    if 2.0 * tail < 1.0 {
        clopper_pearson(count, trials, 1.0 - 2.0 * tail)
    } else {
        (0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn failing(number: u64) -> Result<(Wave, Verdict)> {
        let kind = [ErrorKind::Shape, ErrorKind::Value][(number % 2) as usize];
        Err(Error::new(kind, "none"))
    }

    fn part(draws: impl Iterator<Item = u64>) -> Assessment {
        let words = [("margin", "0 m".to_owned())];
        let mut part = Assessment::new(&[], &words, 3, 40);
        draws.for_each(|draw| part.add(draw, &failing(draw), None));
        part
    }

    #[test]
    fn parts_merge_to_the_whole_in_any_order() {
        let whole = part(0..40);
        let [a, b, c] = [0, 1, 2].map(|i| part((0..40).filter(move |n| n % 3 == i)));
        for (x, y, z) in [(&a, &b, &c), (&c, &a, &b), (&b, &c, &a)] {
            assert_eq!(
                x.merge(y).unwrap().merge(z).unwrap().to_json(),
                whole.to_json()
            );
            assert_eq!(x.merge(&y.merge(z).unwrap()).unwrap(), whole);
        }
        assert_eq!(Assessment::from_json(&whole.to_json()).unwrap(), whole);
        assert_eq!((whole.drawn(), whole.passed(0.99).count), (40, 0));
        let codes: Vec<_> = whole
            .failures(0.99)
            .map(|f| (f.0, f.1.count, f.2.draw))
            .collect();
        assert_eq!(codes, [("invalid", 20, 1), ("wrong-size", 20, 0)]);
        // 1 - 0.01^(1/40) for what never came.
        assert!((whole.unseen(0.99) - (1.0 - 0.01f64.powf(1.0 / 40.0))).abs() < 1e-9);
    }

    #[test]
    fn parts_that_do_not_fit_are_refused() {
        let a = part(0..3);
        let refused = |b: &Assessment, expected: &str| {
            let error = a.merge(b).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        };
        refused(&part(2..5), "in both");
        let other = Assessment::new(&[], &[("margin", "1 m".to_owned())], 3, 40);
        refused(&other, "margin");
        let other = Assessment::new(&[], &[("margin", "0 m".to_owned())], 4, 40);
        refused(&other, "seed 4");
        let text = a.to_json().replace("[[0,3]]", "[[0,2]]");
        assert!(Assessment::from_json(&text).is_err());
        assert!(Assessment::from_json("{}").is_err());
        // What would be written beside the folder that was asked for.
        let text = a.to_json().replace("\"invalid\"", "\"../invalid\"");
        assert!(Assessment::from_json(&text).is_err());
        // Clearances beyond all numbers.
        let bins = format!("\"bins\":{{\"{}\":2}},\"unknown\":1", i64::MAX);
        let text = a.to_json().replace("\"bins\":{},\"unknown\":3", &bins);
        let (edges, _) = Assessment::from_json(&text).unwrap().clearances();
        assert!(edges[0].1.is_finite());
    }
}

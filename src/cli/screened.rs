//! What `undulate screen` tells: a line of each motion, and of all together a summary.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::screen::Arguments;
use super::verdict::{codes, millimetres};
use crate::collision::Certification;
use crate::error::{Error, Reason, Result};
use crate::feasibility::Verdict;
use crate::proportion::clopper_pearson;

/// Of the interval of a share.
const CONFIDENCE: f64 = 0.95;
/// Pairs that a summary names.
const NAMED: usize = 5;

/// What became of one motion: the line of it, and what a summary needs.
pub(super) struct Line {
    pub text: String,
    pub index: usize,
    pub name: Option<String>,
    pub reasons: Vec<Reason>,
    is_clear: bool,
    /// Names of the pair that comes nearest, and how near \[m\].
    pub nearest: Option<((String, String), f64)>,
    pub error: Option<Error>,
}

impl Line {
    pub(super) fn new(index: usize, name: Option<String>, verdict: Result<Verdict>) -> Self {
        let (verdict, error) = match verdict {
            Ok(verdict) => (Some(verdict), None),
            Err(error) => (None, Some(error)),
        };
        let reasons = match (&verdict, &error) {
            (Some(verdict), _) => verdict.reasons(),
            (None, error) => error.iter().map(Reason::of).collect(),
        };
        let collision = verdict.as_ref().and_then(|v| v.collision.as_ref());
        let clearance = verdict.as_ref().and_then(|v| v.clearance.as_ref());
        let is_clear = collision.is_some_and(Certification::is_clear);
        let value = json!({
            "index": index,
            "motion": name,
            "passes": reasons.is_empty(),
            "reasons": codes(&reasons),
            "verdict": collision.map(|c| match c {
                Certification::Clear { .. } => "clear",
                Certification::Collides { .. } => "collides",
                Certification::Undecided { .. } => "undecided",
            }),
            "clearance_m": clearance.map(|c| [c.lower, c.at.distance]),
            "pair": clearance.map(|c| [&c.at.pair.0, &c.at.pair.1]),
            "time_s": clearance.map(|c| c.at.time),
            "intervals": collision.map(|c| c.work().intervals),
            "distances": collision.map(|c| c.work().distances),
            "error": error.as_ref().map(ToString::to_string),
        });
        Self {
            text: value.to_string(),
            index,
            name,
            is_clear,
            nearest: clearance.map(|c| (c.at.pair.clone(), c.at.distance)),
            reasons,
            error,
        }
    }
}

pub(super) fn share(some: usize, all: usize) -> (f64, f64) {
    clopper_pearson(some as u64, all as u64, CONFIDENCE)
}

/// How often each reason is given, in the order of the table.
fn reasons(lines: &[Line]) -> BTreeMap<Reason, usize> {
    let mut counts = BTreeMap::new();
    for reason in lines.iter().flat_map(|l| &l.reasons) {
        *counts.entry(*reason).or_default() += 1;
    }
    counts
}

/// For each pair that comes nearest in a wave, in how many, and how near; the nearest first.
fn worst(lines: &[Line]) -> Vec<(&(String, String), usize, f64)> {
    let mut pairs: BTreeMap<&(String, String), (usize, f64)> = BTreeMap::new();
    for (pair, distance) in lines.iter().filter_map(|l| l.nearest.as_ref()) {
        let entry = pairs.entry(pair).or_insert((0, f64::INFINITY));
        *entry = (entry.0 + 1, entry.1.min(*distance));
    }
    let mut worst: Vec<_> = pairs.into_iter().map(|(p, (n, d))| (p, n, d)).collect();
    worst.sort_by(|a, b| a.2.total_cmp(&b.2));
    worst.truncate(NAMED);
    worst
}

fn counts(lines: &[Line]) -> [(&'static str, usize); 2] {
    let count = |is: fn(&Line) -> bool| lines.iter().filter(|l| is(l)).count();
    [
        ("passes", count(|l| l.reasons.is_empty())),
        ("clear", count(|l| l.is_clear)),
    ]
}

pub(super) fn summary(lines: &[Line], arguments: &Arguments) -> Value {
    let mut value = json!({
        "summary": true,
        "waves": lines.len(),
        "confidence": CONFIDENCE,
        "reasons": reasons(lines).iter().map(|(r, n)| (r.code().to_owned(), json!(n))).collect::<serde_json::Map<_, _>>(),
        "worst_pairs": worst(lines).iter().map(|(pair, count, distance)| json!({
            "pair": [pair.0, pair.1], "waves": count, "clearance_m": distance,
        })).collect::<Vec<_>>(),
        "output": arguments.output,
        "figure": arguments.figure,
    });
    for (what, count) in counts(lines) {
        let (lower, upper) = share(count, lines.len());
        value[what] = json!({
            "waves": count,
            "share": count as f64 / (lines.len() as f64).max(1.0),
            "interval": [lower, upper],
        });
    }
    value
}

pub(super) fn words(lines: &[Line], arguments: &Arguments) -> String {
    let mut text = Vec::new();
    for (what, count) in counts(lines) {
        let (lower, upper) = share(count, lines.len());
        let told = match what {
            "clear" => "proven clear",
            what => what,
        };
        text.push(format!(
            "{told}: {count} of {} waves, {:.1} % ({:.1} .. {:.1} % with {:.0} % confidence)",
            lines.len(),
            100.0 * count as f64 / (lines.len() as f64).max(1.0),
            100.0 * lower,
            100.0 * upper,
            100.0 * CONFIDENCE
        ));
    }
    for (reason, count) in reasons(lines) {
        text.push(format!("reason: {reason} {count} times"));
    }
    for ((a, b), count, distance) in worst(lines) {
        text.push(format!(
            "{a} and {b} come nearest in {count} waves, to {} mm at the least",
            millimetres(distance)
        ));
    }
    for path in [&arguments.output, &arguments.figure].into_iter().flatten() {
        text.push(format!("wrote {}", path.display()));
    }
    text.join("\n")
}

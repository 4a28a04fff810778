//! What arguments of assertions and strategies must be: whoever calls with others is told which one, and where.

use std::ops::RangeInclusive;

use super::law::first_count;

/// No test has more samples.
const LARGEST: usize = 1 << 50;

/// Panics unless `value` is a probability strictly between 0 and 1.
#[track_caller]
pub(super) fn require_probability(name: &str, value: f64) {
    assert!(
        value > 0.0 && value < 1.0,
        "{name} = {value}: a probability between 0 and 1, without the ends"
    );
}

/// Panics when so many samples tell less than they should, with the number that would do: the first that `is_telling`, as all after it are.
#[track_caller]
pub(super) fn require_telling(samples: usize, unnoticed: &str, is_telling: impl Fn(usize) -> bool) {
    assert!(
        is_telling(samples),
        "samples: {samples} are too few, {unnoticed} could pass unnoticed; {}",
        needed(samples, "", is_telling)
    );
}

/// How many samples would do where so many are too few, in words.
pub(super) fn needed(samples: usize, of: &str, is_telling: impl Fn(usize) -> bool) -> String {
    let mut enough = samples.max(1);
    while !is_telling(enough) {
        if enough > LARGEST {
            return format!("more than {LARGEST}{of} are needed");
        }
        enough *= 2;
    }
    let least = first_count(enough as u64, |n| {
        n as usize > samples && is_telling(n as usize)
    });
    format!("at least {least}{of} are needed")
}

/// Panics when a range of counts is empty or starts below `least`.
#[track_caller]
pub(super) fn require_counts(name: &str, counts: &RangeInclusive<usize>, least: usize) {
    assert!(
        !counts.is_empty() && *counts.start() >= least,
        "{name} = {counts:?}: a range of counts from {least} or more that is not empty"
    );
}

//! What arguments of assertions and strategies must be: whoever calls with others is told which one, and where.

use std::ops::RangeInclusive;

/// Panics unless `value` is a probability strictly between 0 and 1.
#[track_caller]
pub(super) fn require_probability(name: &str, value: f64) {
    assert!(
        value > 0.0 && value < 1.0,
        "{name} = {value}: a probability between 0 and 1, without the ends"
    );
}

/// Panics when there are fewer than `least` samples.
#[track_caller]
pub(super) fn require_samples(samples: usize, least: usize) {
    assert!(
        samples >= least,
        "samples: {samples} are too few, at least {least} are needed"
    );
}

/// Panics when so many samples tell less than they should.
#[track_caller]
pub(super) fn require_telling(is_telling: bool, samples: usize, unnoticed: &str) {
    assert!(
        is_telling,
        "samples: {samples} are too few, {unnoticed} could pass unnoticed"
    );
}

/// Panics when a range of counts is empty or starts below `least`.
#[track_caller]
pub(super) fn require_counts(name: &str, counts: &RangeInclusive<usize>, least: usize) {
    assert!(
        !counts.is_empty() && *counts.start() >= least,
        "{name} = {counts:?}: a range of counts from {least} or more that is not empty"
    );
}

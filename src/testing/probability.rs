//! Two claims about a probability, and they are not each other's opposite.

use super::alarm::{Alarm, Power};
use super::argument::require_probability;
use super::law::{MISS, first_count};
use crate::proportion::{at_least, at_most, lower_bound, upper_bound};

/// Is it demonstrated at `confidence` that what failed `failures` times in so many independent `trials` fails with probability `p` at
/// most? Passes only if the upper bound of Clopper and Pearson, one-sided, is at most p: if the probability were above p, that would happen
/// with at most 1 - `confidence`, whatever it is. Exact.
///
/// The alarm says how small the probability must be for it to be demonstrated in 99 of 100 cases.
///
/// ```
/// use undulate::testing::{demonstrate_below, refute_above};
///
/// assert!(demonstrate_below(0, 300, 0.01, 0.95).is_ok());
/// // Two of 300 are less than one in a hundred, and demonstrate nothing of the kind; they do not refute it either.
/// let alarm = demonstrate_below(2, 300, 0.01, 0.95).unwrap_err();
/// assert!(alarm.statistic > 0.02);
/// assert!(refute_above(2, 300, 0.01, 0.05).is_ok());
/// ```
///
/// # Errors
/// When the upper bound is above p.
///
/// # Panics
/// When `p` or `confidence` is not within 0..1, there are more `failures` than `trials`, or so few `trials` that even none failing would
/// demonstrate nothing.
#[track_caller]
pub fn demonstrate_below(failures: u64, trials: u64, p: f64, confidence: f64) -> Result<(), Alarm> {
    require_probability("confidence", confidence);
    require_counts(failures, trials, p);
    let tail = 1.0 - confidence;
    assert!(
        trials > 0 && upper_bound(0, trials, tail) <= p,
        "trials: {trials} without a failure demonstrate no probability of {p} at most, {:.0} would",
        (tail.ln() / (-p).ln_1p()).ceil()
    );
    let bound = upper_bound(failures, trials, tail);
    Alarm::unless_within(
        "upper bound of a probability",
        bound,
        (0.0, p),
        trials as usize,
        || {
            let too_many = first_count(trials, |k| k == trials || at_most(k, trials, p) > tail);
            Power {
                of: "demonstrated if the probability is at most",
                smallest: lower_bound(too_many, trials, MISS),
            }
        },
    )
}

/// Is there evidence that what failed `failures` times in so many independent `trials` fails with more than probability `p`? Fails only if
/// the lower bound of Clopper and Pearson, one-sided, is above p: if the probability is p or less, that happens with at most
/// `false_alarm`. Exact but for the steps of the binomial law.
///
/// ```
/// use undulate::testing::refute_above;
///
/// assert!(refute_above(9, 300, 0.01, 1e-3).is_ok());
/// assert!(refute_above(12, 300, 0.01, 1e-3).is_err());
/// ```
///
/// # Errors
/// When the lower bound is above p.
///
/// # Panics
/// When `p` or `false_alarm` is not within 0..1, there are more `failures` than `trials`, or so few `trials` that even all of them failing
/// would be no evidence.
#[track_caller]
pub fn refute_above(failures: u64, trials: u64, p: f64, false_alarm: f64) -> Result<(), Alarm> {
    require_probability("false_alarm", false_alarm);
    require_counts(failures, trials, p);
    assert!(
        trials > 0 && lower_bound(trials, trials, false_alarm) > p,
        "trials: {trials} that all fail are no evidence of more than {p}, {:.0} would be",
        (false_alarm.ln() / p.ln()).floor() + 1.0
    );
    let bound = lower_bound(failures, trials, false_alarm);
    Alarm::unless_within(
        "lower bound of a probability",
        bound,
        (0.0, p),
        trials as usize,
        || {
            let fewest = first_count(trials, |k| at_least(k, trials, p) < false_alarm);
            Power {
                of: "a probability of",
                smallest: upper_bound(fewest - 1, trials, MISS),
            }
        },
    )
}

#[track_caller]
fn require_counts(failures: u64, trials: u64, p: f64) {
    require_probability("p", p);
    assert!(
        failures <= trials,
        "failures: {failures} of {trials} trials"
    );
}

//! Assertions about quantiles.

use super::alarm::{Alarm, Power};
use super::argument::{require_probability, require_telling};
use super::law::{MISS, first_count};
use crate::proportion::{at_least, at_most, lower_bound, upper_bound};

/// Is `value` the quantile of `probability` of what these numbers are drawn from? How many are at most `value` is binomial, so the test is
/// exact at any N for any continuous distribution (but for the steps of the binomial law). Where many numbers may be equal to `value`,
/// it asks what a quantile promises, P(x < value) <= `probability` <= P(x <= value), and is conservative.
///
/// What it catches is a probability of what is at most `value` that is off by so much.
///
/// ```
/// use rand::RngExt;
/// use undulate::testing::{Seed, quantile};
///
/// let mut rng = Seed(1).rng();
/// let samples: Vec<f64> = (0..1000).map(|_| rng.random::<f64>().powi(2)).collect();
/// assert!(quantile(&samples, 0.9, 0.81, 1e-6).is_ok());
/// assert!(quantile(&samples, 0.9, 0.9, 1e-6).is_err());
/// ```
///
/// # Errors
/// When fewer or more samples lie below than do with probability `false_alarm`.
///
/// # Panics
/// When `false_alarm` or `probability` is not within 0..1, `value` is not a number, or `samples` are so few that all of them or none
/// of them below `value` would raise no alarm.
#[track_caller]
pub fn quantile(
    samples: &[f64],
    probability: f64,
    value: f64,
    false_alarm: f64,
) -> Result<(), Alarm> {
    require_probability("false_alarm", false_alarm);
    require_probability("probability", probability);
    assert!(!value.is_nan(), "value = {value}: a number");
    let (n, tail) = (samples.len() as u64, false_alarm / 2.0);
    // Infinite samples have their place; what is no number has none.
    for x in samples.iter().filter(|x| x.is_nan()) {
        Alarm::unless_within("a sample", *x, (f64::MIN, f64::MAX), samples.len(), || {
            Power::CERTAIN
        })?;
    }
    require_telling(
        samples.len(),
        "a value that is below all samples, or above them,",
        |n| {
            let n = n as u64;
            let (fewest, most) = accepted(n, probability, tail);
            n > 0 && fewest > 0 && most < n
        },
    );
    let (fewest, most) = accepted(n, probability, tail);
    let power = || Power {
        of: "a probability of what is below that is off by",
        smallest: (upper_bound(most, n, MISS) - probability)
            .max(probability - lower_bound(fewest, n, MISS)),
    };
    let bounds = (fewest as f64, most as f64);
    let count = |is_below: &dyn Fn(f64) -> bool| samples.iter().filter(|x| is_below(**x)).count();
    let below = count(&|x| x < value) as f64;
    let at_most = count(&|x| x <= value) as f64;
    let n = samples.len();
    Alarm::unless_within(
        "samples below the quantile",
        below,
        (0.0, bounds.1),
        n,
        power,
    )?;
    Alarm::unless_within(
        "samples up to the quantile",
        at_most,
        (bounds.0, n as f64),
        n,
        power,
    )
}

/// The counts that a binomial law does not leave on either side with more than probability `tail`.
fn accepted(trials: u64, probability: f64, tail: f64) -> (u64, u64) {
    let fewest = first_count(trials, |k| at_most(k, trials, probability) >= tail);
    let too_many = first_count(trials, |k| at_least(k, trials, probability) < tail);
    (fewest, too_many - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fair_coin_of_ten_throws() {
        // P(X <= 1) = 11 / 1024, P(X <= 2) = 56 / 1024.
        assert_eq!(accepted(10, 0.5, 12.0 / 1024.0), (2, 8));
        assert_eq!(accepted(10, 0.5, 10.0 / 1024.0), (1, 9));
        assert_eq!(accepted(10, 0.5, 0.5 / 1024.0), (0, 10));
    }
}

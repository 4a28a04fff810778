//! Assertions about a distribution function.

use super::alarm::{Alarm, Power};
use super::argument::{require_probability, require_telling};
use super::law::MISS;

/// At this distance half of all probability may be elsewhere.
const FARTHEST: f64 = 0.5;
pub(super) const ELSEWHERE: &str = "half of all probability elsewhere";

/// Have independent numbers this distribution function, which must be continuous? By Kolmogorov and Smirnov's largest distance from the
/// empirical one, with Massart's bound P(distance > d) <= 2 exp(-2 N d^2) (Annals of Probability 18, 1990). It holds at any N, and is
/// conservative, the more so the rarer the alarm: at a `false_alarm` of 0.05 the true probability is less by a few percent at N = 1000 and by a fifth at
/// N = 20, at 1e-6 by 7 % at N = 1000 and a third at N = 100 (the exact law: Simard and L'Ecuyer, Journal of Statistical Software 39, 2011).
///
/// What it catches is a largest distance of the true distribution function from `distribution`, wherever it is: at that place the count of
/// samples is binomial, and Hoeffding's inequality adds sqrt(ln 100 / 2N) to the threshold.
///
/// ```
/// use rand::RngExt;
/// use undulate::testing::{Seed, distribution};
///
/// let mut rng = Seed(1).rng();
/// let samples: Vec<f64> = (0..1000).map(|_| rng.random::<f64>().powi(2)).collect();
/// assert!(distribution(&samples, |x| x.clamp(0.0, 1.0).sqrt(), 1e-6).is_ok());
/// assert!(distribution(&samples, |x| x.clamp(0.0, 1.0), 1e-6).is_err());
/// ```
///
/// # Errors
/// When the distance is larger than it is with probability `false_alarm`.
///
/// # Panics
/// When `false_alarm` is not within 0..1, `distribution` gives no probability, or `samples` are so few that half of all probability could
/// be elsewhere.
#[track_caller]
pub fn distribution(
    samples: &[f64],
    distribution: impl Fn(f64) -> f64,
    false_alarm: f64,
) -> Result<(), Alarm> {
    named("distribution", samples.to_vec(), distribution, false_alarm)
}

/// [`distribution`], called `what` in the alarm.
#[track_caller]
pub(super) fn named(
    what: &'static str,
    mut samples: Vec<f64>,
    distribution: impl Fn(f64) -> f64,
    false_alarm: f64,
) -> Result<(), Alarm> {
    require_probability("false_alarm", false_alarm);
    let n = samples.len();
    require_telling(n, ELSEWHERE, |n| is_telling(n, false_alarm));
    let (most, caught) = thresholds(n, false_alarm);
    Alarm::unless_finite(&samples, n)?;
    samples.sort_unstable_by(f64::total_cmp);
    let mut statistic: f64 = 0.0;
    for (i, x) in samples.iter().enumerate() {
        let below = distribution(*x);
        assert!(
            (0.0..=1.0).contains(&below),
            "distribution: {below} at {x} is no probability"
        );
        let (before, after) = (i as f64 / n as f64, (i + 1) as f64 / n as f64);
        statistic = statistic.max(below - before).max(after - below);
    }
    Alarm::unless_within(what, statistic, (0.0, most), n, || Power {
        of: "a distance of distribution functions of",
        smallest: caught,
    })
}

/// The distance above which there is an alarm, and the one that is caught.
fn thresholds(samples: usize, false_alarm: f64) -> (f64, f64) {
    let n = samples as f64;
    let most = ((2.0 / false_alarm).ln() / (2.0 * n)).sqrt();
    (most, most + (-MISS.ln() / (2.0 * n)).sqrt())
}

/// Whether so many samples tell what they must.
pub(super) fn is_telling(samples: usize, false_alarm: f64) -> bool {
    thresholds(samples, false_alarm).1 < FARTHEST
}

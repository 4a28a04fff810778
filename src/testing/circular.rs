//! Assertions about angles.
//!
//! The mean direction mu and the resultant length R of an angle are those of its trigonometric moment, E exp(i angle) = R exp(i mu); R is 1
//! for one angle alone and exp(-s^2 / 2) for a normal law of standard deviation s wrapped around the circle. So sin(angle - mu) has
//! mean 0 and cos(angle - mu) mean R, both lie within -1 .. 1, and their variances add up to 1 - R^2. That is what the tests use, with
//! Hoeffding's bounds for means of bounded numbers (JASA 58, 1963, theorem 1, and 3 for those of a known largest variance): they hold at
//! any N and for any distribution of angles with that moment.

use std::f64::consts::FRAC_PI_2;

use super::alarm::{Alarm, Power};
use super::argument::{require_probability, require_telling};
use super::law::{Bounded, MISS, crossing};

/// Have angles \[rad\] this mean direction, given their resultant length? By the average of sin(angle - mean). Conservative: for angles
/// within a small spread, nearly all of 1 - R^2 is the variance of the sine, and the bound is as far off as the Gaussian bound is; for
/// wide ones by up to twice the variance. A third of `false_alarm` guards against the opposite direction.
///
/// What it catches is a mean direction that is off by an angle \[rad\], at the same resultant length.
///
/// ```
/// use undulate::testing::{Seed, circular_mean};
/// use undulate::rand::RngExt;
///
/// // Uniform within 0.3 of pi, on both sides of the cut: R = sin(0.3) / 0.3.
/// let mut rng = Seed(3).rng();
/// let angles: Vec<f64> = (0..1000)
///     .map(|_| std::f64::consts::PI + rng.random_range(-0.3..0.3))
///     .map(|a: f64| a.sin().atan2(a.cos()))
///     .collect();
/// let resultant = 0.3_f64.sin() / 0.3;
/// assert!(circular_mean(&angles, std::f64::consts::PI, resultant, 1e-6).is_ok());
/// assert!(circular_mean(&angles, 3.0, resultant, 1e-6).is_err());
/// ```
///
/// # Errors
/// When the average is farther from 0 than it is with probability `false_alarm`.
///
/// # Panics
/// When `false_alarm` or `resultant` is not within 0..1, `mean` is not finite, or there are so few `angles` that a right angle could
/// pass unnoticed.
#[track_caller]
pub fn circular_mean(
    angles: &[f64],
    mean: f64,
    resultant: f64,
    false_alarm: f64,
) -> Result<(), Alarm> {
    require(mean, resultant, false_alarm);
    let (n, tail) = (angles.len(), false_alarm / 3.0);
    let about = |mean: f64| Bounded {
        low: -1.0,
        high: 1.0,
        mean,
        variance: 1.0 - resultant * resultant,
    };
    let most = |n| about(0.0).upper(n, tail);
    let passes = |off: f64, n: usize, most: f64| {
        let sine = resultant * off.sin();
        sine <= most || about(sine).rate(most) < -MISS.ln() / n as f64
    };
    require_telling(n, "a mean direction that is off by a right angle", |n| {
        !passes(FRAC_PI_2, n, most(n))
    });
    let most = most(n);
    Alarm::unless_finite(angles, n)?;
    let power = || Power {
        of: "a mean direction that is off, in rad, by",
        smallest: crossing(0.0, FRAC_PI_2, |off| passes(off, n, most)),
    };
    let sine = average(angles, |a| (a - mean).sin());
    Alarm::unless_within("mean direction (sine)", sine, (-most, most), n, power)?;
    let cosine = average(angles, |a| (a - mean).cos());
    let least = about(resultant).lower(n, tail).min(0.0);
    Alarm::unless_within("mean direction (cosine)", cosine, (least, 1.0), n, power)
}

/// Have angles \[rad\] this resultant length about this mean direction? By the average of cos(angle - mean). Conservative, and the more so the
/// less they spread: most of 1 - R^2 is not the cosine's variance then.
///
/// What it catches is a resultant length that is smaller, angles that spread more, about the same direction.
///
/// ```
/// use undulate::testing::{Seed, circular_spread};
/// use undulate::rand::RngExt;
///
/// let mut rng = Seed(3).rng();
/// let angles: Vec<f64> = (0..1000).map(|_| rng.random_range(-1.5..1.5)).collect();
/// assert!(circular_spread(&angles, 0.0, 1.5_f64.sin() / 1.5, 1e-6).is_ok());
/// assert!(circular_spread(&angles, 0.0, 0.9, 1e-6).is_err());
/// ```
///
/// # Errors
/// When the average is farther from `resultant` than it is with probability `false_alarm`.
///
/// # Panics
/// When `false_alarm` or `resultant` is not within 0..1, `mean` is not finite, or there are so few `angles` that no direction at all could
/// pass unnoticed.
#[track_caller]
pub fn circular_spread(
    angles: &[f64],
    mean: f64,
    resultant: f64,
    false_alarm: f64,
) -> Result<(), Alarm> {
    require(mean, resultant, false_alarm);
    let (n, tail) = (angles.len(), false_alarm / 2.0);
    let about = |mean: f64| Bounded::within((-1.0, 1.0), mean);
    let law = about(resultant);
    let caught = |resultant: f64, n: usize, least: f64| {
        resultant < least && about(resultant).rate(least) >= -MISS.ln() / n as f64
    };
    require_telling(n, "angles of no direction", |n| {
        caught(0.0, n, law.lower(n, tail))
    });
    let bounds = (law.lower(n, tail), law.upper(n, tail));
    Alarm::unless_finite(angles, n)?;
    let cosine = average(angles, |a| (a - mean).cos());
    Alarm::unless_within("resultant length", cosine, bounds, n, || Power {
        of: "a resultant length that is smaller by",
        smallest: resultant - crossing(0.0, resultant, |r| caught(r, n, bounds.0)),
    })
}

fn average(angles: &[f64], part: impl Fn(f64) -> f64) -> f64 {
    angles.iter().map(|a| part(*a)).sum::<f64>() / angles.len() as f64
}

#[track_caller]
fn require(mean: f64, resultant: f64, false_alarm: f64) {
    require_probability("false_alarm", false_alarm);
    assert!(
        resultant > 0.0 && resultant < 1.0,
        "resultant = {resultant}: a resultant length between 0 and 1, without the ends"
    );
    assert!(mean.is_finite(), "mean = {mean}: a finite angle");
}

//! Assertions about independence.

use super::alarm::{Alarm, Power};
use super::argument::{require_probability, require_telling};
use super::law::MISS;

/// Are two numbers that are drawn together independent? By Kendall's tau, the share of pairs of draws that agree in their order less the share
/// that do not. Of independent numbers of any distributions, S = tau N (N - 1) / 2 is a sum of independent uniform steps from -(i - 1) to
/// i - 1, i = 1..N (Kendall, Biometrika 30, 1938); since sinh(i l) / (i sinh l) <= exp((i^2 - 1) l^2 / 6), it is sub-Gaussian with its own
/// variance N (N - 1) (2N + 5) / 18, and P(|S| > s) <= 2 exp(-s^2 / 2 variance). That holds at any N, and is conservative as the Gaussian
/// bound is: the true probability is an eighth at 0.05, a fourteenth at 1e-6. Draws that are equal count for nothing, which is as if
/// their order were drawn, averaged, and keeps the bound.
///
/// What it catches is a tau of the distribution, by Hoeffding's inequality for averages over pairs (theorem in section 5 of "Probability
/// inequalities for sums of bounded random variables"). Dependence without a tendency, such as y = x^2 about 0, it does not see.
///
/// ```
/// use rand::RngExt;
/// use undulate::testing::{Seed, independence};
///
/// let mut rng = Seed(1).rng();
/// let x: Vec<f64> = (0..600).map(|_| rng.random()).collect();
/// let y: Vec<f64> = (0..600).map(|_| rng.random()).collect();
/// assert!(independence(&x, &y, 1e-6).is_ok());
/// let sum: Vec<f64> = x.iter().zip(&y).map(|(x, y)| x + y).collect();
/// assert!(independence(&x, &sum, 1e-6).is_err());
/// ```
///
/// # Errors
/// When tau is farther from 0 than it is with probability `false_alarm`.
///
/// # Panics
/// When `false_alarm` is not within 0..1, there are not as many `y` as `x`, or so few samples that numbers in the same order could pass
/// unnoticed.
#[track_caller]
pub fn independence(x: &[f64], y: &[f64], false_alarm: f64) -> Result<(), Alarm> {
    require_probability("false_alarm", false_alarm);
    assert!(
        x.len() == y.len(),
        "y: {} numbers beside {}",
        y.len(),
        x.len()
    );
    let pairs = |n: f64| n * (n - 1.0) / 2.0;
    let most = |n: f64| {
        let variance = n * (n - 1.0) * (2.0 * n + 5.0) / 18.0;
        (2.0 * variance * (2.0 / false_alarm).ln()).sqrt() / pairs(n)
    };
    let caught = |n: f64| most(n) + (-2.0 * MISS.ln() / (n / 2.0).floor()).sqrt();
    require_telling(x.len(), "numbers in the same order", |n| {
        caught(n as f64) < 1.0
    });
    let n = x.len() as f64;
    let (pairs, most, caught) = (pairs(n), most(n), caught(n));
    Alarm::unless_finite(x.iter().chain(y), x.len())?;
    let mut agreeing = 0.0;
    for i in 0..x.len() {
        for j in 0..i {
            agreeing += order(x[i], x[j]) * order(y[i], y[j]);
        }
    }
    let tau = agreeing / pairs;
    Alarm::unless_within("Kendall's tau", tau, (-most, most), x.len(), || Power {
        of: "a tau beyond",
        smallest: caught,
    })
}

fn order(a: f64, b: f64) -> f64 {
    f64::from(i8::from(a > b) - i8::from(a < b))
}

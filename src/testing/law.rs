//! Laws of statistics, under what is asserted and under what must be caught: quantiles and bounds of tails.

use statrs::function::beta::beta_reg;
use statrs::function::gamma::{gamma_lr, gamma_ur};

/// How often a discrepancy of the stated size may pass: 1 less the power.
pub(super) const MISS: f64 = 0.01;

/// What is left of a Poisson law once this share of it has been summed.
const NEGLIGIBLE: f64 = 1e-9;

/// To this share of itself a number is known.
const PRECISION: f64 = 1e-10;

/// Halvings of an interval about a number that is 0.
const HALVINGS: usize = 200;

/// Where `is_below` ceases to hold between `low` and `high`.
pub(super) fn crossing(mut low: f64, mut high: f64, is_below: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..HALVINGS {
        if high - low <= PRECISION * high.abs().max(low.abs()) {
            break;
        }
        let middle = 0.5 * (low + high);
        if is_below(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Where `is_below` ceases to hold above 0.
pub(super) fn crossing_above_zero(start: f64, is_below: impl Fn(f64) -> bool) -> f64 {
    let mut high = start;
    while is_below(high) {
        high *= 2.0;
    }
    crossing(0.0, high, is_below)
}

/// The first count of `trials` at most from which `holds`, which holds for all after it; one more when it holds for none.
pub(super) fn first_count(trials: u64, holds: impl Fn(u64) -> bool) -> u64 {
    let (mut low, mut high) = (0, trials + 1);
    while low < high {
        let middle = low + (high - low) / 2;
        if middle > trials || holds(middle) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    low
}

/// Below and above these a chi-square of so many degrees of freedom lies with probability `tail` each.
pub(super) fn chi_squared(freedom: f64, tail: f64) -> (f64, f64) {
    (
        chi_squared_below(freedom, tail),
        crossing_above_zero(freedom, |x| gamma_ur(freedom / 2.0, x / 2.0) > tail),
    )
}

/// Below this a chi-square lies with probability `tail`.
pub(super) fn chi_squared_below(freedom: f64, tail: f64) -> f64 {
    crossing_above_zero(freedom, |x| gamma_lr(freedom / 2.0, x / 2.0) < tail)
}

/// The sum of a Poisson law's weights times probabilities, of which the first is given and each is less than the one before by `step(j)`.
fn poisson_mixture(mean: f64, first: f64, step: impl Fn(f64) -> f64) -> f64 {
    let (mut sum, mut seen, mut term, mut j) = (0.0, 0.0, first, 0.0);
    let end = mean + 40.0 * (mean.sqrt() + 1.0);
    while seen < 1.0 - NEGLIGIBLE && j < end {
        let weight = (j * mean.ln() - mean - libm::lgamma(j + 1.0)).exp();
        sum += weight * term;
        seen += weight;
        term -= step(j);
        j += 1.0;
    }
    sum
}

/// The noncentrality at which a chi-square is at most `x` with probability [`MISS`].
pub(super) fn chi_squared_noncentrality(freedom: f64, x: f64) -> f64 {
    let (a, x) = (freedom / 2.0, x / 2.0);
    let first = gamma_lr(a, x);
    // P(a, x) - P(a + 1, x), DLMF 8.8.5.
    let step = |j: f64| ((a + j) * x.ln() - x - libm::lgamma(a + j + 1.0)).exp();
    crossing_above_zero(freedom, |lambda| {
        poisson_mixture(lambda / 2.0, first, step) > MISS
    })
}

/// Above this an F of (a, b) degrees of freedom lies with probability `tail`.
pub(super) fn fisher_above(a: f64, b: f64, tail: f64) -> f64 {
    crossing_above_zero(1.0, |f| beta_reg(b / 2.0, a / 2.0, b / (b + a * f)) > tail)
}

/// The noncentrality at which an F of (a, b) degrees of freedom is at most `f` with probability [`MISS`].
pub(super) fn fisher_noncentrality(a: f64, b: f64, f: f64) -> f64 {
    let y = a * f / (a * f + b);
    let (start, a, b) = (a, a / 2.0, b / 2.0);
    let first = beta_reg(a, b, y);
    // I_y(a, b) - I_y(a + 1, b), DLMF 8.17.20.
    let step = |j: f64| {
        let a = a + j;
        let beta = libm::lgamma(a + 1.0) + libm::lgamma(b) - libm::lgamma(a + b);
        (a * y.ln() + b * libm::log1p(-y) - beta).exp()
    };
    crossing_above_zero(start, |lambda| {
        poisson_mixture(lambda / 2.0, first, step) > MISS
    })
}

/// Numbers within `low` .. `high` of a mean and of at most a variance, whatever their distribution is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounded {
    pub low: f64,
    pub high: f64,
    pub mean: f64,
    pub variance: f64,
}

impl Bounded {
    /// Of any variance.
    pub fn within((low, high): (f64, f64), mean: f64) -> Self {
        let variance = (high - mean) * (mean - low);
        Self {
            low,
            high,
            mean,
            variance,
        }
    }

    fn mirrored(&self) -> Self {
        Self {
            low: -self.high,
            high: -self.low,
            mean: -self.mean,
            variance: self.variance,
        }
    }

    /// P(average of N >= x) <= exp(-N rate) for x above the mean: Hoeffding, "Probability inequalities for sums of bounded
    /// random variables" (JASA 58, 1963), theorems 1 and 3. Of all laws the one of two points, the upper end and the one that
    /// gives mean and variance, has the heaviest tail; the rate is the divergence of that law from the one of mean x.
    fn rate_above(&self, x: f64) -> f64 {
        let other = (self.mean - self.variance / (self.high - self.mean)).max(self.low);
        let share = |y: f64| ((y - other) / (self.high - other)).clamp(0.0, 1.0);
        divergence(share(x), share(self.mean))
    }

    /// The rate of the tail at x, on the side of the mean on which it is.
    pub fn rate(&self, x: f64) -> f64 {
        if x >= self.mean {
            self.rate_above(x)
        } else {
            self.mirrored().rate_above(-x)
        }
    }

    /// Above this the average of so many lies with probability `tail` at most; the upper end when no average is that unlikely.
    pub fn upper(&self, samples: usize, tail: f64) -> f64 {
        let needed = -tail.ln() / samples as f64;
        if self.rate_above(self.high) <= needed {
            return self.high;
        }
        crossing(self.mean, self.high, |x| self.rate_above(x) < needed)
    }

    /// Below this the average of so many lies with probability `tail` at most; the lower end when no average is that unlikely.
    pub fn lower(&self, samples: usize, tail: f64) -> f64 {
        -self.mirrored().upper(samples, tail)
    }
}

/// Of two coins, q from p: sum of q ln(q / p).
fn divergence(q: f64, p: f64) -> f64 {
    let term = |q: f64, p: f64| if q > 0.0 { q * (q / p).ln() } else { 0.0 };
    term(q, p) + term(1.0 - q, 1.0 - p)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_chi_square_are_those_of_tables() {
        // Two degrees: an exponential law; many: Wilson and Hilferty's cube is good to four digits.
        let (low, high) = chi_squared(2.0, 1e-9);
        assert!((high - 2.0 * 1e9_f64.ln()).abs() < 1e-6 && (low - 2e-9).abs() < 1e-15);
        let n: f64 = 50_000.0;
        let cube = |z: f64| n * (1.0 - 2.0 / (9.0 * n) + z * (2.0 / (9.0 * n)).sqrt()).powi(3);
        let (low, high) = chi_squared(n, 0.01);
        let z = 2.326_347_874;
        assert!((low / cube(-z) - 1.0).abs() < 1e-6 && (high / cube(z) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn noncentral_laws_agree_with_the_normal_law() {
        // One degree: |N(delta, 1)| <= c. At delta = c + 2.326 the other side counts for nothing.
        let c: f64 = 4.0;
        let delta = chi_squared_noncentrality(1.0, c * c).sqrt();
        assert!((delta - (c + 2.326_347_874)).abs() < 1e-6, "{delta}");
        // With very many degrees in the denominator F is chi-square.
        let delta = fisher_noncentrality(1.0, 1e7, c * c).sqrt();
        assert!((delta - (c + 2.326_347_874)).abs() < 1e-4, "{delta}");
    }

    #[test]
    fn hoeffding_holds_for_a_coin_and_is_not_far_off() {
        // P(at least 70 of 100 fair throws) = 3.925e-5.
        let coin = Bounded::within((0.0, 1.0), 0.5);
        let bound = (-100.0 * coin.rate(0.7)).exp();
        assert!(bound > 3.925e-5 && bound < 10.0 * 3.925e-5, "{bound:e}");
        // A variance that is known to be small makes the same average less likely.
        let calm = Bounded {
            variance: 0.05,
            ..coin
        };
        assert!(calm.rate(0.7) > 2.0 * coin.rate(0.7));
        assert!((calm.rate(0.3) - calm.rate(0.7)).abs() < 1e-12);
    }
}

//! Intervals by resampling demonstrations.

use rand::RngExt;

use crate::primitive::stream;
use crate::proportion::incomplete_beta;

/// Resamples: twenty and more of them lie beyond either end of a 95 % interval.
const RESAMPLES: usize = 4000;

/// A number with an interval.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs)]
pub struct Estimate {
    pub value: f64,
    pub lower: f64,
    pub upper: f64,
}

impl Estimate {
    /// A `statistic` of the mean of rows, one a demonstration, with the interval that resampled demonstrations give it.
    ///
    /// Percentiles of few resampled values are too narrow by sqrt((n - 1) / n) and by the normal tails that they imply; their levels are widened so that for
    /// a mean of normal values the interval is Student's (Hesterberg, "What teachers should know about the bootstrap", The American
    /// Statistician 69, 2015, section 5.3: expanded percentiles). Resamples are drawn by `seed`.
    pub fn of(
        rows: &[Vec<f64>],
        statistic: impl Fn(&[f64]) -> f64,
        confidence: f64,
        seed: u64,
    ) -> Self {
        let count = rows.len();
        let width = rows.first().map_or(0, Vec::len);
        let mean = |picked: &mut dyn Iterator<Item = usize>| {
            let mut sum = vec![0.0; width];
            for row in picked {
                for (sum, x) in sum.iter_mut().zip(&rows[row]) {
                    *sum += x / count as f64;
                }
            }
            statistic(&sum)
        };
        let value = mean(&mut (0..count));
        if !value.is_finite() {
            return Self {
                value,
                lower: f64::NAN,
                upper: f64::NAN,
            };
        }
        if count < 2 {
            return Self {
                value,
                lower: f64::NEG_INFINITY,
                upper: f64::INFINITY,
            };
        }
        let mut rng = stream(seed, 0);
        let mut resampled: Vec<f64> = (0..RESAMPLES)
            .map(|_| mean(&mut (0..count).map(|_| rng.random_range(0..count))))
            .filter(|x| x.is_finite())
            .collect();
        resampled.sort_by(f64::total_cmp);
        let Some(last) = resampled.len().checked_sub(1) else {
            return Self {
                value,
                lower: f64::NAN,
                upper: f64::NAN,
            };
        };
        let beyond = expanded(0.5 * (1.0 - confidence), count) * last as f64;
        Self {
            value,
            lower: resampled[(beyond.floor() as usize).min(last)],
            upper: resampled[last - (beyond.floor() as usize).min(last)],
        }
    }

    /// The mean of values, one a demonstration.
    pub fn of_mean(values: &[f64], confidence: f64, seed: u64) -> Self {
        let rows: Vec<Vec<f64>> = values.iter().map(|x| vec![*x]).collect();
        Self::of(&rows, |mean| mean[0], confidence, seed)
    }
}

/// The tail of a normal distribution beyond sqrt(n / (n - 1)) times the quantile of Student's t with n - 1 degrees of freedom.
fn expanded(tail: f64, count: usize) -> f64 {
    let freedom = (count - 1) as f64;
    // P(T > t) = I_x(freedom / 2, 1 / 2) / 2 with x = freedom / (freedom + t^2), increasing in x.
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if 0.5 * incomplete_beta(middle, 0.5 * freedom, 0.5) < tail {
            low = middle;
        } else {
            high = middle;
        }
    }
    let quantile = (freedom * (1.0 / high - 1.0)).sqrt();
    let wider = quantile * (count as f64 / freedom).sqrt();
    0.5 * libm::erfc(wider / std::f64::consts::SQRT_2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_those_of_students_tables() {
        // t_{0.975} is 2.2622 with 9 degrees of freedom and tends to 1.9600.
        let normal = |x: f64| 0.5 * libm::erfc(x / std::f64::consts::SQRT_2);
        let expected = normal(2.262_157 * (10.0_f64 / 9.0).sqrt());
        assert!((expanded(0.025, 10) - expected).abs() < 1e-7);
        assert!((expanded(0.025, 1_000_000) - 0.025).abs() < 1e-5);
    }

    #[test]
    fn one_demonstration_says_nothing_of_the_mean() {
        let one = Estimate::of_mean(&[3.0], 0.95, 0);
        assert_eq!((one.value, one.lower), (3.0, f64::NEG_INFINITY));
    }
}

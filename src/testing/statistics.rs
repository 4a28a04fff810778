//! Statistical assertions with a stated probability of a false alarm.

use std::fmt;

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::primitive::Gaussian;

/// Singular values of a factor below this share of the largest are directions without variance.
const RANK_TOLERANCE: f64 = 1e-10;

/// A sample may leave the span of the factor by this share of the spread: rounding.
const SPAN_TOLERANCE: f64 = 1e-9;

/// Why samples are not believed to come from the distribution.
#[derive(Debug, Clone, PartialEq)]
pub struct Alarm {
    /// What is off: `mean`, `variance` in some direction, or `span`.
    pub what: &'static str,
    /// The statistic that was out of bounds.
    pub statistic: f64,
    /// The bounds.
    pub bounds: (f64, f64),
    /// Number of samples.
    pub samples: usize,
    /// The smallest ratio of variances (above 1) that the test catches with 99 % power at this number of samples.
    pub detectable_ratio: f64,
}

impl fmt::Display for Alarm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} is off: statistic {:.4} outside {:.4} .. {:.4} with N = {} (a ratio of variances of {:.3} would be caught with 99 % power)",
            self.what,
            self.statistic,
            self.bounds.0,
            self.bounds.1,
            self.samples,
            self.detectable_ratio
        )
    }
}

/// Are these draws of `gaussian`? Exact at any N: with z = F^+ (x - mu) standard normal in r dimensions,
///
/// * N |mean of z|^2 is chi-square with r degrees of freedom;
/// * the sum of (u . z)^2 is chi-square with N degrees of freedom for each unit vector u: the r axes and the r (r - 1)
///   diagonals (e_i +- e_j) / sqrt 2, so that every entry of the covariance is tested;
/// * x - mu lies in the span of F.
///
/// Half of `false_alarm` goes to the mean, half is shared by the directions (Bonferroni).
///
/// # Errors
/// The first statistic out of its bounds; for true draws with probability at most `false_alarm`.
///
/// # Panics
/// When `false_alarm` is not within 0..1, a sample has another dimension, or there are so few samples that a variance four
/// times too large could pass unnoticed.
pub fn gaussian(
    samples: &[DVector<f64>],
    gaussian: &Gaussian,
    false_alarm: f64,
) -> Result<(), Alarm> {
    assert!(
        false_alarm > 0.0 && false_alarm < 1.0,
        "false_alarm = {false_alarm}: a probability between 0 and 1"
    );
    assert!(
        samples.iter().all(|x| x.len() == gaussian.dimension()),
        "samples of another dimension than the Gaussian"
    );
    let n = samples.len() as f64;
    // A column of zeros changes nothing, and a matrix without columns has no decomposition.
    let svd = gaussian.factor().insert_column(0, 0.0).svd(true, false);
    let u = svd.u.expect("asked for");
    let largest = svd.singular_values.max();
    let kept: Vec<usize> = (0..svd.singular_values.len())
        .filter(|i| svd.singular_values[*i] > RANK_TOLERANCE * largest)
        .collect();
    let rank = kept.len();
    let directions = (rank * rank).max(1) as f64;
    let tail = false_alarm / (4.0 * directions);
    let variance = ChiSquared::new(n.max(1.0)).expect("at least one degree of freedom");
    let bounds = (variance.inverse_cdf(tail), variance.inverse_cdf(1.0 - tail));
    let detectable_ratio = bounds.1 / variance.inverse_cdf(0.01);
    assert!(
        detectable_ratio < 4.0,
        "{} samples are too few: only a variance {detectable_ratio:.1} times too large would be caught",
        samples.len()
    );
    let alarm = |what, statistic, bounds| Alarm {
        what,
        statistic,
        bounds,
        samples: samples.len(),
        detectable_ratio,
    };

    let basis = DMatrix::from_fn(gaussian.dimension(), rank, |i, j| u[(i, kept[j])]);
    let mut sum = DVector::zeros(rank);
    let mut products = DMatrix::zeros(rank, rank);
    for x in samples {
        let deviation = x - gaussian.mean();
        let coordinates = basis.tr_mul(&deviation);
        let outside = (&deviation - &basis * &coordinates).norm();
        let allowed = SPAN_TOLERANCE * (largest + deviation.norm());
        if outside > allowed {
            return Err(alarm("span", outside, (0.0, allowed)));
        }
        let z = DVector::from_fn(rank, |i, _| coordinates[i] / svd.singular_values[kept[i]]);
        sum += &z;
        products.ger(1.0, &z, &z, 1.0);
    }
    if rank == 0 {
        return Ok(());
    }
    let mean = sum.norm_squared() / n;
    let most = ChiSquared::new(rank as f64)
        .expect("at least one degree of freedom")
        .inverse_cdf(1.0 - false_alarm / 2.0);
    if mean > most {
        return Err(alarm("mean", mean, (0.0, most)));
    }
    for i in 0..rank {
        for j in 0..=i {
            let (a, b, c) = (products[(i, i)], products[(j, j)], products[(i, j)]);
            let along = if i == j {
                vec![a]
            } else {
                vec![(a + b) / 2.0 + c, (a + b) / 2.0 - c]
            };
            for statistic in along {
                if !(bounds.0..=bounds.1).contains(&statistic) {
                    return Err(alarm("variance", statistic, bounds));
                }
            }
        }
    }
    Ok(())
}

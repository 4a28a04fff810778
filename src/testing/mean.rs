//! Assertions about means.

use nalgebra::{DMatrix, DVector};

use super::alarm::{Alarm, Power};
use super::argument::{require_probability, require_telling};
use super::law::{Bounded, MISS, crossing, fisher_above, fisher_noncentrality};

/// A test of a mean that would not see two standard deviations sees nothing.
const FARTHEST_MEAN: f64 = 2.0;

/// Have normally distributed vectors this mean, whatever their covariance? By Hotelling's T^2 = N (m - mu)^T S^-1 (m - mu), m and S
/// the mean and the covariance (with 1/(N-1)) of the samples: T^2 (N - d) / (d (N - 1)) is F of (d, N - d) degrees of freedom
/// (Hotelling, Annals of Mathematical Statistics 2, 1931). Exact at any N > d; in one dimension it is Student's test.
///
/// What is told is sqrt(T^2 / N), the Mahalanobis distance of the means, and so is what it catches, by the noncentral F.
///
/// ```
/// use nalgebra::{DVector, dvector};
/// use undulate::testing::{Seed, mean};
/// use undulate::{Gaussian, nalgebra};
///
/// let gaussian = Gaussian::new(dvector![1.0, 2.0], nalgebra::dmatrix![0.3, 0.0; 0.1, 0.2])?;
/// let mut rng = Seed(5).rng();
/// let samples: Vec<DVector<f64>> = (0..500).map(|_| gaussian.sample(&mut rng)).collect();
/// assert!(mean(&samples, gaussian.mean(), 1e-6).is_ok());
/// let alarm = mean(&samples, &dvector![1.0, 2.2], 1e-6).unwrap_err();
/// assert!(alarm.to_string().starts_with("mean: "), "{alarm}");
/// # Ok::<(), undulate::Error>(())
/// ```
///
/// # Errors
/// When T^2 is larger than it is with probability `false_alarm`, or the samples do not vary in every direction.
///
/// # Panics
/// When `false_alarm` is not within 0..1, `mean` is not finite, `samples` are of another dimension than it, or so few that two standard deviations could
/// pass unnoticed.
#[track_caller]
pub fn mean(samples: &[DVector<f64>], mean: &DVector<f64>, false_alarm: f64) -> Result<(), Alarm> {
    require_probability("false_alarm", false_alarm);
    let dimension = mean.len();
    assert!(mean.iter().all(|x| x.is_finite()), "mean: finite numbers");
    assert!(
        dimension > 0 && samples.iter().all(|x| x.len() == dimension),
        "samples: of another dimension than the mean, which has {dimension}"
    );
    let d = dimension as f64;
    // What is above them with that probability, of F and of T^2.
    let most = |n: f64| {
        let f = fisher_above(d, n - d, false_alarm);
        (f, f * d * (n - 1.0) / (n - d))
    };
    require_telling(
        samples.len(),
        "a mean that is off by two standard deviations",
        |n| n > dimension && (most(n as f64).1 / n as f64).sqrt() < FARTHEST_MEAN,
    );
    let n = samples.len() as f64;
    let (f, most) = most(n);
    Alarm::unless_finite(samples.iter().flat_map(|x| x.iter()), samples.len())?;
    let (average, scatter) = moments(samples);
    let deviation = average - mean;
    let statistic = (scatter / (n - 1.0))
        .cholesky()
        .map_or(f64::NAN, |s| deviation.dot(&s.solve(&deviation)).sqrt());
    let bounds = (0.0, (most / n).sqrt());
    Alarm::unless_within("mean", statistic, bounds, samples.len(), || Power {
        of: "a mean that is off, in standard deviations (Mahalanobis), by",
        smallest: (fisher_noncentrality(d, n - d, f) / n).sqrt(),
    })
}

/// The average of samples, and the sum of outer products of what they are off it.
pub(super) fn moments(samples: &[DVector<f64>]) -> (DVector<f64>, DMatrix<f64>) {
    let average = samples.iter().sum::<DVector<f64>>() / samples.len() as f64;
    let mut scatter = DMatrix::zeros(average.len(), average.len());
    for x in samples {
        let off = x - &average;
        scatter.ger(1.0, &off, &off, 1.0);
    }
    (average, scatter)
}

/// Have numbers within `support` this mean, whatever their distribution is? By Hoeffding's bound in its sharpest form ("Probability
/// inequalities for sums of bounded random variables", JASA 58, 1963, theorem 1). It holds at any N and for any distribution, and is
/// conservative: for a coin by a factor of some units, for numbers that keep away from the ends of the support by more. Where samples
/// are normally distributed, [`mean`] sees more.
///
/// ```
/// use rand::RngExt;
/// use undulate::testing::{Seed, bounded_mean};
///
/// let mut rng = Seed(1).rng();
/// let samples: Vec<f64> = (0..1000).map(|_| rng.random()).collect();
/// assert!(bounded_mean(&samples, (0.0, 1.0), 0.5, 1e-6).is_ok());
/// let alarm = bounded_mean(&samples, (0.0, 1.0), 0.6, 1e-6).unwrap_err();
/// assert!(alarm.statistic < alarm.bounds.0);
/// ```
///
/// # Errors
/// When the average is farther from `mean` than it is with probability `false_alarm`, or a sample is outside the support.
///
/// # Panics
/// When `false_alarm` is not within 0..1, `mean` not inside `support`, or `samples` so few that no mean within the support would be
/// noticed.
#[track_caller]
pub fn bounded_mean(
    samples: &[f64],
    support: (f64, f64),
    mean: f64,
    false_alarm: f64,
) -> Result<(), Alarm> {
    require_probability("false_alarm", false_alarm);
    let (low, high) = support;
    assert!(
        low < high,
        "support = {low} .. {high}: a lower end and a higher one"
    );
    assert!(
        low.is_finite() && high.is_finite() && low < mean && mean < high,
        "mean = {mean}: inside the support, which is {low} .. {high}"
    );
    let n = samples.len();
    for x in samples {
        Alarm::unless_within("a sample", *x, support, n, || Power::CERTAIN)?;
    }
    let law = Bounded::within(support, mean);
    let tail = false_alarm / 2.0;
    let bounds = |n| (law.lower(n, tail), law.upper(n, tail));
    require_telling(n, "a mean at either end of the support", |n| {
        let (lower, upper) = bounds(n);
        lower > low || upper < high
    });
    let bounds = bounds(n);
    let average = samples.iter().sum::<f64>() / n as f64;
    Alarm::unless_within("mean", average, bounds, n, || power(&law, bounds, n))
}

/// What averages outside these bounds are certain to be noticed from: any distribution with a mean so far off.
fn power(law: &Bounded, (lower, upper): (f64, f64), samples: usize) -> Power {
    let needed = -MISS.ln() / samples as f64;
    let passes =
        |mean: f64, bound: f64| Bounded::within((law.low, law.high), mean).rate(bound) < needed;
    let higher = crossing(upper, law.high, |mean| passes(mean, upper)) - law.mean;
    let lower_by = law.mean - crossing(law.low, lower, |mean| !passes(mean, lower));
    if lower <= law.low {
        Power {
            of: "a mean that is higher by",
            smallest: higher,
        }
    } else if upper >= law.high {
        Power {
            of: "a mean that is lower by",
            smallest: lower_by,
        }
    } else {
        Power {
            of: "a mean that is off by",
            smallest: higher.max(lower_by),
        }
    }
}

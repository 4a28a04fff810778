//! The assertion about a whole Gaussian.

use nalgebra::{DMatrix, DVector};
use statrs::function::gamma::gamma_lr;

use super::alarm::{Alarm, Power};
use super::argument::{require_probability, require_telling};
use super::covariance::{TOO_LARGE, Variances};
use super::distribution::{self, ELSEWHERE};
use super::law::{MISS, chi_squared, chi_squared_noncentrality};
use crate::primitive::Gaussian;

/// Singular values of a factor below this share of the largest are directions without variance.
const RANK_TOLERANCE: f64 = 1e-10;

/// A sample may leave the span of the factor by this share of the spread, and by this share of its own size: rounding.
const SPAN_TOLERANCE: f64 = 1e-9;
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Are these independent draws of `gaussian`, whatever its rank r? With z = F^+ (x - mu) standard normal in r dimensions, each of these
/// is tested with a fifth of `false_alarm`:
///
/// * mean: N |mean of z|^2 is chi-square with r degrees of freedom;
/// * variance: the sum of (u . z)^2 is chi-square with N degrees of freedom for each unit vector u: the r axes and the r (r - 1)
///   diagonals (e_i +- e_j) / sqrt 2, so that every entry of the covariance is tested (they share their fifth, Bonferroni);
/// * shape: |z|^2 follows chi-square with r degrees of freedom (Kolmogorov and Smirnov, see [`distribution`](super::distribution));
/// * normality: all entries of all z together follow the normal law (likewise);
/// * succession: draws 2k and 2k + 1 are independent: the sums of (z + z')^2 / 2 and (z - z')^2 / 2 are chi-square.
///
/// And x - mu lies in the span of F, but for rounding. All are exact at any N, or conservative by a few percent.
///
/// ```
/// use nalgebra::{DVector, dmatrix, dvector};
/// use undulate::testing::{Seed, gaussian};
/// use undulate::{Gaussian, nalgebra};
///
/// let seed = Seed(2);
/// let plane = Gaussian::new(dvector![0.0, 1.0, 2.0], dmatrix![0.3, 0.0; 0.1, 0.2; 0.2, 0.2])?;
/// let draws: Vec<DVector<f64>> = (0..1000).map(|k| plane.sample(&mut seed.stream(k))).collect();
/// assert!(gaussian(&draws, &plane, 1e-6).is_ok());
///
/// let wider: Vec<DVector<f64>> = draws.iter().map(|x| plane.mean() + (x - plane.mean()) * 1.3).collect();
/// let alarm = gaussian(&wider, &plane, 1e-6).unwrap_err().of(seed);
/// assert_eq!(alarm.what, "variance");
/// println!("{alarm}"); // statistic, bounds, N, seed, and the ratio that N draws suffice for
/// # Ok::<(), undulate::Error>(())
/// ```
///
/// # Errors
/// The first statistic out of its bounds; for true draws with probability at most `false_alarm`.
///
/// # Panics
/// When `false_alarm` is not within 0..1, `samples` are of another dimension, or so few that a variance four times too large or half of all
/// probability elsewhere could pass unnoticed.
#[track_caller]
pub fn gaussian(
    samples: &[DVector<f64>],
    gaussian: &Gaussian,
    false_alarm: f64,
) -> Result<(), Alarm> {
    require_probability("false_alarm", false_alarm);
    assert!(
        samples.iter().all(|x| x.len() == gaussian.dimension()),
        "samples: of another dimension than the Gaussian, which has {}",
        gaussian.dimension()
    );
    let n = samples.len();
    let whitening = Whitening::of(gaussian);
    let share = false_alarm / 5.0;
    let variances = |n| Variances::new(n, 0, whitening.rank(), share);
    // Before any sample is looked at: all tests that follow must tell something.
    require_telling(n, &format!("{TOO_LARGE} or {ELSEWHERE}"), |n| {
        variances(n).is_telling() && distribution::is_telling(n, share)
    });
    let variances = variances(n);
    Alarm::unless_finite(samples.iter().flat_map(|x| x.iter()), n)?;
    let white = samples
        .iter()
        .map(|x| whitening.apply(x, n))
        .collect::<Result<Vec<_>, _>>()?;
    if whitening.rank() == 0 {
        return Ok(());
    }
    mean(&white, share)?;
    let mut products = DMatrix::zeros(whitening.rank(), whitening.rank());
    for z in &white {
        products.ger(1.0, z, z, 1.0);
    }
    variances.check(&products)?;
    let half = whitening.rank() as f64 / 2.0;
    let norms = white.iter().map(|z| z.norm_squared()).collect();
    distribution::named(
        "distribution of the norm",
        norms,
        |x| gamma_lr(half, x / 2.0),
        share,
    )?;
    let entries = white.iter().flat_map(|z| z.iter().copied()).collect();
    distribution::named(
        "distribution of the entries",
        entries,
        |x| 0.5 * libm::erfc(-x / std::f64::consts::SQRT_2),
        share,
    )?;
    succession(&white, share)
}

/// From draws to standard normal vectors.
pub(super) struct Whitening<'a> {
    gaussian: &'a Gaussian,
    basis: DMatrix<f64>,
    deviations: Vec<f64>,
}

impl<'a> Whitening<'a> {
    pub fn of(gaussian: &'a Gaussian) -> Self {
        // A column of zeros changes nothing, and a matrix without columns has no decomposition.
        let svd = gaussian.factor().insert_column(0, 0.0).svd(true, false);
        let u = svd.u.expect("asked for");
        let largest = svd.singular_values.max();
        let kept: Vec<usize> = (0..svd.singular_values.len())
            .filter(|i| svd.singular_values[*i] > RANK_TOLERANCE * largest)
            .collect();
        Self {
            gaussian,
            basis: u.select_columns(&kept),
            deviations: kept.iter().map(|i| svd.singular_values[*i]).collect(),
        }
    }

    fn rank(&self) -> usize {
        self.deviations.len()
    }

    /// z of x, one of so many samples.
    fn apply(&self, x: &DVector<f64>, samples: usize) -> Result<DVector<f64>, Alarm> {
        let deviation = x - self.gaussian.mean();
        let coordinates = self.basis.tr_mul(&deviation);
        let outside = (&deviation - &self.basis * &coordinates).norm();
        let largest = self.deviations.iter().fold(0.0, |a: f64, b| a.max(*b));
        let allowed = SPAN_TOLERANCE * (largest + deviation.norm()) + ROUNDING * x.norm();
        Alarm::unless_within("span", outside, (0.0, allowed), samples, || Power::CERTAIN)?;
        Ok(self.scaled(coordinates))
    }

    /// z of what x is off the mean, of that which is in the span.
    pub fn projected(&self, deviation: &DVector<f64>) -> DVector<f64> {
        self.scaled(self.basis.tr_mul(deviation))
    }

    fn scaled(&self, coordinates: DVector<f64>) -> DVector<f64> {
        DVector::from_fn(self.rank(), |i, _| coordinates[i] / self.deviations[i])
    }
}

fn mean(white: &[DVector<f64>], false_alarm: f64) -> Result<(), Alarm> {
    let (n, rank) = (white.len() as f64, white[0].len() as f64);
    let (_, most) = chi_squared(rank, false_alarm);
    let statistic = white.iter().sum::<DVector<f64>>().norm_squared() / n;
    Alarm::unless_within("mean", statistic, (0.0, most), white.len(), || Power {
        of: "a mean that is off, in standard deviations (Mahalanobis), by",
        smallest: (chi_squared_noncentrality(rank, most) / n).sqrt(),
    })
}

fn succession(white: &[DVector<f64>], false_alarm: f64) -> Result<(), Alarm> {
    let pairs = white.chunks_exact(2);
    let freedom = (pairs.len() * white[0].len()) as f64;
    let bounds = chi_squared(freedom, false_alarm / 4.0);
    let power = || Power {
        of: "a correlation of successive draws of",
        // Correlation takes from one of the two what it gives to the other; the one that is less is noticed first.
        smallest: 1.0 - bounds.0 / chi_squared(freedom, MISS).1,
    };
    let (mut sums, mut differences) = (0.0, 0.0);
    for pair in pairs {
        sums += (&pair[0] + &pair[1]).norm_squared() / 2.0;
        differences += (&pair[0] - &pair[1]).norm_squared() / 2.0;
    }
    for statistic in [sums, differences] {
        Alarm::unless_within("succession", statistic, bounds, white.len(), power)?;
    }
    Ok(())
}

//! Assertions about covariances.

use nalgebra::{DMatrix, DVector};

use super::alarm::{Alarm, Power};
use super::argument::{require_probability, require_telling};
use super::law::{MISS, chi_squared, chi_squared_below};
use super::mean::moments;

/// A matrix is symmetric to this share of its largest entry.
const SYMMETRIC: f64 = 1e-9;

/// A test of a variance that would not see four times as much sees nothing.
const LARGEST_RATIO: f64 = 4.0;
pub(super) const TOO_LARGE: &str = "a variance four times too large";

/// Have normally distributed vectors this covariance, whatever their mean is? With z the samples less their average, whitened by
/// Cholesky's factor, the sum of (u . z)^2 is chi-square with N - 1 degrees of freedom for each unit vector u: the d axes and the
/// d (d - 1) diagonals (e_i +- e_j) / sqrt 2, so that every entry of the covariance is tested. Each is exact; together they share
/// `false_alarm` (Bonferroni), which is conservative by little, since they are nearly independent.
///
/// What it catches is a variance along one of these directions that is larger or smaller by a ratio; of few samples the smaller one needs the
/// larger ratio, and that is told.
///
/// ```
/// use nalgebra::{DVector, dmatrix, dvector};
/// use undulate::testing::{Seed, covariance};
/// use undulate::{Gaussian, nalgebra};
///
/// let gaussian = Gaussian::new(dvector![1.0, 2.0], dmatrix![0.3, 0.0; 0.1, 0.2])?;
/// let mut rng = Seed(5).rng();
/// let samples: Vec<DVector<f64>> = (0..500).map(|_| gaussian.sample(&mut rng)).collect();
/// assert!(covariance(&samples, &gaussian.covariance(), 1e-6).is_ok());
/// // One entry forgotten.
/// let alarm = covariance(&samples, &dmatrix![0.09, 0.0; 0.0, 0.05], 1e-6).unwrap_err();
/// assert_eq!(alarm.what, "variance");
/// # Ok::<(), undulate::Error>(())
/// ```
///
/// # Errors
/// The first direction whose variance is out of bounds; for true samples with probability at most `false_alarm`.
///
/// # Panics
/// When `false_alarm` is not within 0..1, `covariance` is not symmetric and positive definite (for one of less rank there is
/// [`gaussian`](super::gaussian)), `samples` are of another dimension or so few that a variance four times too large could pass
/// unnoticed.
#[track_caller]
pub fn covariance(
    samples: &[DVector<f64>],
    covariance: &DMatrix<f64>,
    false_alarm: f64,
) -> Result<(), Alarm> {
    require_probability("false_alarm", false_alarm);
    let dimension = covariance.nrows();
    let factor = (covariance.is_square() && dimension > 0)
        .then(|| covariance.clone().cholesky())
        .flatten()
        .expect("covariance: a positive definite matrix");
    let skew = (covariance - covariance.transpose()).amax();
    assert!(
        skew <= SYMMETRIC * covariance.amax(),
        "covariance: a symmetric matrix, and not one that is off by {skew:e}"
    );
    assert!(
        samples.iter().all(|x| x.len() == dimension),
        "samples: of another dimension than the covariance, which has {dimension}"
    );
    let of = |n| Variances::new(n, 1, dimension, false_alarm);
    require_telling(samples.len(), TOO_LARGE, |n| of(n).is_telling());
    let test = of(samples.len());
    Alarm::unless_finite(samples.iter().flat_map(|x| x.iter()), samples.len())?;
    let (_, scatter) = moments(samples);
    // L^-1 S L^-T.
    let half = factor
        .l()
        .solve_lower_triangular(&scatter)
        .expect("its diagonal is positive");
    let products = factor
        .l()
        .solve_lower_triangular(&half.transpose())
        .expect("its diagonal is positive");
    test.check(&products)
}

/// The test of a sum of outer products of standard normal vectors, in all axes and diagonals.
pub(super) struct Variances {
    samples: usize,
    freedom: f64,
    bounds: (f64, f64),
}

impl Variances {
    /// Of so many samples, of which their mean has taken `lost`.
    pub fn new(samples: usize, lost: usize, dimension: usize, false_alarm: f64) -> Self {
        let directions = (dimension * dimension).max(1) as f64;
        let freedom = samples.saturating_sub(lost).max(1) as f64;
        Self {
            samples,
            freedom,
            bounds: chi_squared(freedom, false_alarm / (2.0 * directions)),
        }
    }

    /// Whether it sees what it must.
    pub fn is_telling(&self) -> bool {
        self.larger() < LARGEST_RATIO
    }

    /// The smallest ratio of variances, above 1, that is caught where the variance is larger, and where it is smaller.
    fn larger(&self) -> f64 {
        self.bounds.1 / chi_squared_below(self.freedom, MISS)
    }

    fn smaller(&self) -> f64 {
        chi_squared(self.freedom, MISS).1 / self.bounds.0
    }

    pub fn check(&self, products: &DMatrix<f64>) -> Result<(), Alarm> {
        for i in 0..products.nrows() {
            for j in 0..=i {
                let (a, b, c) = (products[(i, i)], products[(j, j)], products[(i, j)]);
                let along = [(a + b) / 2.0 + c, (a + b) / 2.0 - c];
                // An axis is a diagonal with itself, halved.
                let statistics = if i == j { &[a][..] } else { &along[..] };
                for statistic in statistics {
                    let power = || Power {
                        of: "a variance larger or smaller by a ratio of",
                        smallest: self.larger().max(self.smaller()),
                    };
                    Alarm::unless_within("variance", *statistic, self.bounds, self.samples, power)?;
                }
            }
        }
        Ok(())
    }
}

//! A Gaussian with a low-rank factor: maximum likelihood, conditioning, sampling.

use nalgebra::{DMatrix, DVector};
use rand::Rng;

use crate::error::{Error, ErrorKind, Result};
use crate::normal;

/// A direction whose standard deviation is below this has no variance left: coordinates are radians and logarithms,
/// and what conditioning on a coordinate leaves of it is of the order of 1e-16.
const NO_VARIANCE: f64 = 1e-9;

/// An observed value may differ by this much from the only value that is possible.
const CONSISTENT: f64 = 1e-9;

/// Of an observation's standard deviation, what earlier observations must leave for it to count as another direction.
const DEPENDENT: f64 = 1e-8;

/// N(mu, F F^T) in n dimensions with a factor F of n x r: rank at most r, and never an n x n matrix unless asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Gaussian {
    mean: DVector<f64>,
    factor: DMatrix<f64>,
}

impl Gaussian {
    /// A Gaussian of mean mu (n) and factor F (n x r).
    ///
    /// # Errors
    /// When the sizes do not fit or a number is not finite.
    pub fn new(mean: DVector<f64>, factor: DMatrix<f64>) -> Result<Self> {
        if factor.nrows() != mean.len() {
            return Err(Error::new(
                ErrorKind::Shape,
                format!(
                    "a mean of {} and a factor of {} rows",
                    mean.len(),
                    factor.nrows()
                ),
            ));
        }
        if mean.iter().chain(factor.iter()).any(|v| !v.is_finite()) {
            return Err(Error::new(ErrorKind::Value, "mean or factor is not finite"));
        }
        Ok(Self { mean, factor })
    }

    /// Maximum likelihood from M vectors: their mean, and the covariance with 1/M (not 1/(M-1)), of rank M - 1.
    ///
    /// The factor is (x_1, .., x_M) H / sqrt(M) with Helmert's M x (M-1) orthonormal contrasts H: since H H^T removes
    /// the mean, F F^T is the covariance without any decomposition.
    ///
    /// # Errors
    /// When there are fewer than two vectors or their lengths differ.
    pub fn maximum_likelihood(vectors: &[DVector<f64>]) -> Result<Self> {
        let Some((first, rest)) = vectors.split_first().filter(|(_, rest)| !rest.is_empty()) else {
            return Err(Error::new(
                ErrorKind::Shape,
                format!("{} demonstrations", vectors.len()),
            )
            .expected("at least two"));
        };
        if rest.iter().any(|x| x.len() != first.len()) {
            return Err(Error::new(ErrorKind::Shape, "vectors of different lengths"));
        }
        let count = vectors.len() as f64;
        // Relative to the first vector, so that coordinates far from zero lose nothing to cancellation.
        let mut sum = DVector::zeros(first.len());
        let mut factor = DMatrix::zeros(first.len(), rest.len());
        for (j, x) in rest.iter().enumerate() {
            let before = (j + 1) as f64;
            let scale = 1.0 / (before * (before + 1.0) * count).sqrt();
            for (i, f) in factor.column_mut(j).iter_mut().enumerate() {
                let deviation = x[i] - first[i];
                *f = (sum[i] - before * deviation) * scale;
                sum[i] += deviation;
            }
        }
        Self::new(first + sum / count, factor)
    }

    /// n.
    pub fn dimension(&self) -> usize {
        self.mean.len()
    }

    /// r, the number of columns of F.
    pub fn rank(&self) -> usize {
        self.factor.ncols()
    }

    /// mu (n).
    pub fn mean(&self) -> &DVector<f64> {
        &self.mean
    }

    /// F (n x r).
    pub fn factor(&self) -> &DMatrix<f64> {
        &self.factor
    }

    /// F F^T (n x n).
    pub fn covariance(&self) -> DMatrix<f64> {
        &self.factor * self.factor.transpose()
    }

    /// Standard deviation of coordinate `i`.
    pub fn standard_deviation(&self, i: usize) -> f64 {
        self.factor.row(i).norm()
    }

    /// mu + F z with z standard normal (n).
    pub fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> DVector<f64> {
        let mut z = vec![0.0; self.rank()];
        normal::fill(rng, &mut z);
        let mut x = self.mean.clone();
        // Column by column: a fixed order of summation, the same bits everywhere. Slices, so that it becomes vectors.
        for (j, z) in z.into_iter().enumerate() {
            let column = self.factor.column(j);
            for (x, f) in x.as_mut_slice().iter_mut().zip(column.as_slice()) {
                *x += f * z;
            }
        }
        x
    }

    /// Bounds |x_i - mu_i| over all that [`sample`](Self::sample) can draw.
    pub fn reach(&self, i: usize) -> f64 {
        normal::FARTHEST * self.factor.row(i).iter().map(|f| f.abs()).sum::<f64>()
    }

    /// The Gaussian given x_i = b for each (i, b), exactly:
    ///
    /// ```text
    /// mu' = mu + Sigma A^T (A Sigma A^T)^-1 (b - A mu),   Sigma' = Sigma - Sigma A^T (A Sigma A^T)^-1 A Sigma
    /// ```
    ///
    /// (equation (2) of Panteris, Manschitz and Calinon) without forming Sigma: each observation turns the latent
    /// space (a Householder reflection) until only its first axis matters, sets that axis, and drops it. So the order
    /// does not matter but for rounding, variances never grow, and the result has a column less for each observation.
    /// The observation with the largest share of its variance left goes first, as in a pivoted QR.
    ///
    /// # Errors
    /// The index within `observations` and what to say of it, when a value contradicts what is already certain.
    pub(super) fn condition(
        &self,
        observations: &[(usize, f64)],
    ) -> std::result::Result<Self, Contradiction> {
        let mut posterior = self.clone();
        let mut open: Vec<usize> = (0..observations.len()).collect();
        while !open.is_empty() {
            let share = |o: usize| {
                let i = observations[o].0;
                posterior.standard_deviation(i) / self.standard_deviation(i).max(NO_VARIANCE)
            };
            let mut best = 0;
            for candidate in 1..open.len() {
                if share(open[candidate]) > share(open[best]) {
                    best = candidate;
                }
            }
            let left = share(open[best]);
            let o = open.remove(best);
            let (i, value) = observations[o];
            let residual = value - posterior.mean[i];
            if left > DEPENDENT && posterior.standard_deviation(i) > NO_VARIANCE {
                posterior.fix(i, value);
            } else if residual.abs() > CONSISTENT {
                return Err(Contradiction {
                    observation: o,
                    certain: posterior.mean[i],
                    prior_deviation: self.standard_deviation(i),
                });
            }
        }
        Ok(posterior)
    }

    /// The Mahalanobis distance of the values from the mean, in the marginal of their coordinates:
    /// sqrt((b - A mu)^T (A Sigma A^T)^+ (b - A mu)). Values that are certain already add nothing.
    pub(super) fn mahalanobis(&self, values: &[(usize, f64)]) -> f64 {
        let rows: Vec<usize> = values.iter().map(|v| v.0).collect();
        let marginal = self.factor.select_rows(&rows);
        let deviation =
            DVector::from_iterator(rows.len(), values.iter().map(|(i, b)| b - self.mean[*i]));
        if rows.is_empty() || self.rank() == 0 {
            return 0.0;
        }
        let least = NO_VARIANCE.max(DEPENDENT * marginal.norm());
        // The shortest latent vector that leads there.
        marginal
            .svd(true, true)
            .solve(&deviation, least)
            .map_or(0.0, |z| z.norm())
    }

    fn fix(&mut self, i: usize, value: f64) {
        let row = self.factor.row(i).transpose();
        let norm = row.norm();
        // The reflection I - 2 v v^T / v^T v takes the row to (-s |row|, 0, ..), s the sign of its first entry.
        let sign = if row[0] < 0.0 { -1.0 } else { 1.0 };
        let mut v = row;
        v[0] += sign * norm;
        let scale = 2.0 / v.norm_squared();
        let product = &self.factor * &v;
        self.factor.ger(-scale, &product, &v, 1.0);
        let gain = self.factor.column(0) / (-sign * norm);
        self.mean.axpy(value - self.mean[i], &gain, 1.0);
        let rest = self.factor.ncols() - 1;
        self.factor = self.factor.columns(1, rest).into_owned();
        // What rounding left of the observed coordinate.
        self.mean[i] = value;
        self.factor.row_mut(i).fill(0.0);
    }
}

/// An observation that the Gaussian rules out.
#[derive(Debug)]
pub(super) struct Contradiction {
    /// Which one.
    pub observation: usize,
    /// The only value that is left for its coordinate.
    pub certain: f64,
    /// The coordinate's standard deviation before any observation.
    pub prior_deviation: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{dmatrix, dvector};

    #[test]
    fn maximum_likelihood_of_three_points_by_hand() {
        let points = [dvector![1.0, 0.0], dvector![3.0, 3.0], dvector![5.0, 0.0]];
        let gaussian = Gaussian::maximum_likelihood(&points).unwrap();
        assert!((gaussian.mean() - dvector![3.0, 1.0]).norm() < 1e-15);
        let expected = dmatrix![8.0 / 3.0, 0.0; 0.0, 2.0];
        assert!((gaussian.covariance() - expected).norm() < 1e-14);
        assert_eq!(gaussian.rank(), 2);
    }

    #[test]
    fn conditioning_of_a_bivariate_normal_in_closed_form() {
        // sd 2 and 1, correlation 0.6: mean of x1 given x0 = 3 is 0.6 * 1 * (3 - 1) / 2, variance 1 - 0.36.
        let gaussian = Gaussian::new(dvector![1.0, 0.0], dmatrix![2.0, 0.0; 0.6, 0.8]).unwrap();
        let posterior = gaussian.condition(&[(0, 3.0)]).unwrap();
        assert_eq!(posterior.mean()[0], 3.0);
        assert!((posterior.mean()[1] - 0.6).abs() < 1e-15);
        assert!((posterior.covariance()[(1, 1)] - 0.64).abs() < 1e-15);
        assert_eq!(posterior.standard_deviation(0), 0.0);
    }

    #[test]
    fn repeated_observations_are_one_and_contradictions_are_found() {
        let gaussian = Gaussian::new(dvector![1.0, 0.0], dmatrix![2.0, 0.0; 0.6, 0.8]).unwrap();
        let once = gaussian.condition(&[(0, 3.0)]).unwrap();
        assert_eq!(gaussian.condition(&[(0, 3.0), (0, 3.0)]).unwrap(), once);
        assert_eq!(once.condition(&[(0, 3.0)]).unwrap(), once);
        let contradiction = once.condition(&[(1, 0.5), (0, 3.1)]).unwrap_err();
        assert_eq!((contradiction.observation, contradiction.certain), (1, 3.0));
    }
}

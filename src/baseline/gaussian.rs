//! The Gaussian over weights that all baselines share, regularised as ours is.

use nalgebra::{DMatrix, DVector};

use crate::error::Result;
use crate::primitive::{Covariance, Density, Gaussian, block, weights};
use crate::vectors::dot;

/// A weight that spreads less than this share of the largest spread does not vary.
const STILL: f64 = 1e-12;

/// Of M vectors: their mean and standard deviations, and correlations (1 - a) C + a T as of [`Estimator::Kronecker`](crate::Estimator), C those of the vectors,
/// T one block A (x) AR(1) for each of `blocks` (groups, length), which follow each other. The weight a is the one for which left-out vectors are most
/// probable. (Ours takes their density given one amplitude; a linear model has no such coordinate.)
pub(super) fn shrunk(vectors: &[DVector<f64>], blocks: &[(usize, usize)]) -> Result<Gaussian> {
    let mut scores: Vec<(f64, f64)> = weights().map(|a| (a, 0.0)).collect();
    // With two vectors nothing can be left out: the target carries most.
    if vectors.len() > 2 {
        for m in 0..vectors.len() {
            let mut rest = vectors.to_vec();
            let left_out = rest.remove(m);
            let spread = Spread::of(&rest);
            let density = Density::new(&spread.correlation(0.5, blocks)?);
            let z = spread.standardised(&left_out);
            for (a, score) in &mut scores {
                *score += density.log(z.as_slice(), 2.0 * (1.0 - *a), 2.0 * *a);
            }
        }
    }
    let best = scores
        .into_iter()
        .rev()
        .reduce(|best, next| if next.1 > best.1 { next } else { best });
    let spread = Spread::of(vectors);
    let correlation = spread.correlation(best.map_or(1.0, |(a, _)| a), blocks)?;
    let alone = DVector::zeros(spread.mean.len());
    let covariance = correlation.rescaled(&spread.deviations, &alone)?;
    Gaussian::structured(spread.mean, covariance)
}

/// ln of the density of `x`, over the weights that vary.
pub(super) fn log_density(gaussian: &Gaussian, x: &DVector<f64>) -> f64 {
    let deviation = x - gaussian.prior_mean();
    Density::new(gaussian.prior_covariance()).log(deviation.as_slice(), 1.0, 1.0)
}

struct Spread {
    mean: DVector<f64>,
    deviations: Vec<f64>,
    /// M x n, unit columns.
    directions: DMatrix<f64>,
}

impl Spread {
    fn of(vectors: &[DVector<f64>]) -> Self {
        let (count, n) = (vectors.len() as f64, vectors[0].len());
        let mean = vectors.iter().sum::<DVector<f64>>() / count;
        let mut directions = DMatrix::from_fn(vectors.len(), n, |m, i| vectors[m][i] - mean[i]);
        let norms: Vec<f64> = directions
            .column_iter()
            .map(|c| dot(c.as_slice(), c.as_slice()).sqrt())
            .collect();
        let least = STILL * norms.iter().copied().fold(0.0, f64::max);
        for (mut column, norm) in directions.column_iter_mut().zip(&norms) {
            let scale = if *norm > least { 1.0 / norm } else { 0.0 };
            column *= scale;
        }
        let deviation = |norm: &f64| {
            if *norm > least {
                norm / count.sqrt()
            } else {
                0.0
            }
        };
        Self {
            mean,
            deviations: norms.iter().map(deviation).collect(),
            directions,
        }
    }

    fn correlation(&self, weight: f64, blocks: &[(usize, usize)]) -> Result<Covariance> {
        let n = self.mean.len();
        let scales = vec![weight.sqrt(); n];
        let mut start = 0;
        let mut found = Vec::new();
        for (groups, length) in blocks {
            let count = self.directions.nrows() as f64;
            let own = block(&self.directions, count, &scales, start, (*groups, *length));
            found.extend(own.transpose()?);
            start += groups * length;
        }
        let factor = self.directions.transpose() * (1.0 - weight).sqrt();
        Covariance::new(factor, found, DVector::zeros(n))
    }

    fn standardised(&self, x: &DVector<f64>) -> DVector<f64> {
        DVector::from_fn(x.len(), |i, _| {
            let scale = self.deviations[i];
            if scale > 0.0 {
                (x[i] - self.mean[i]) / scale
            } else {
                0.0
            }
        })
    }
}

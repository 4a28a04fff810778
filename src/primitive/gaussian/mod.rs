//! [`Gaussian`]: maximum likelihood, exact conditioning on linear observations, sampling.

mod observed;

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};
use rand::Rng;

use super::Covariance;
use crate::error::{Error, ErrorKind, Result};
use crate::normal;
use crate::vectors::dot;
pub(crate) use observed::Contradiction;
use observed::{Observed, norm};

/// a^T x = b over the n coordinates of a Gaussian, exactly or with a standard deviation.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearObservation {
    /// The entries of a that are not zero: coordinate and coefficient.
    pub row: Vec<(usize, f64)>,
    /// b.
    pub value: f64,
    /// Of b; 0 for an exact observation.
    pub deviation: f64,
}

impl LinearObservation {
    /// Its standard deviation, if it is not exact.
    fn own_noise(&self) -> Option<f64> {
        (self.deviation > 0.0).then_some(self.deviation)
    }
}

/// N(mu, Sigma) given any number of linear observations, with Sigma an implicit [`Covariance`] B B^T.
///
/// Drawing and conditioning work on the latent z of x = mu + B z, standard normal before any observation. The rows a^T B of the
/// observations, with a latent number more for each that is not exact, are orthonormalised one after the other to Q; given
/// them, what remains of z is its projection away from Q. That is Matheron's rule (Journel and Huijbregts, Mining
/// Geostatistics, 1978, section VII.A.1; Wilson et al., JMLR 22, 2021) with V = A Sigma A^T + noise never formed, so that its
/// condition number enters once and not twice:
///
/// ```text
/// mu' = mu + Sigma A^T V^-1 (b - A mu),   Sigma' = Sigma - U U^T,   U = B Q
/// ```
///
/// m observations cost O((n r + m l) m), a draw O(n r + m l); nothing of size n x n is ever made unless asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Gaussian {
    prior_mean: Arc<DVector<f64>>,
    covariance: Arc<Covariance>,
    observed: Vec<Arc<Observed>>,
    mean: DVector<f64>,
}

impl Gaussian {
    /// A Gaussian of mean mu (n) and factor F (n x r): Sigma = F F^T.
    ///
    /// # Errors
    /// When the sizes do not fit or a number is not finite.
    pub fn new(mean: DVector<f64>, factor: DMatrix<f64>) -> Result<Self> {
        Self::structured(mean, Covariance::of_factor(factor)?)
    }

    /// A Gaussian of mean mu (n) and any covariance.
    ///
    /// # Errors
    /// When the sizes do not fit or the mean is not finite.
    pub fn structured(mean: DVector<f64>, covariance: Covariance) -> Result<Self> {
        if covariance.dimension() != mean.len() {
            return Err(Error::new(
                ErrorKind::Shape,
                format!(
                    "a mean of {} and a covariance of {} rows",
                    mean.len(),
                    covariance.dimension()
                ),
            ));
        }
        if mean.iter().any(|v| !v.is_finite()) {
            return Err(Error::new(ErrorKind::Value, "mean is not finite"));
        }
        Ok(Self {
            prior_mean: Arc::new(mean.clone()),
            covariance: Arc::new(covariance),
            observed: Vec::new(),
            mean,
        })
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

    /// In how many directions it varies: min(n, l) less the exact observations.
    pub fn rank(&self) -> usize {
        let exact = self.observations().filter(|o| o.deviation == 0.0).count();
        self.covariance
            .latent()
            .min(self.dimension())
            .saturating_sub(exact)
    }

    /// mu (n), given the observations.
    pub fn mean(&self) -> &DVector<f64> {
        &self.mean
    }

    /// mu (n) before any observation.
    pub fn prior_mean(&self) -> &DVector<f64> {
        &self.prior_mean
    }

    /// Sigma before any observation.
    pub fn prior_covariance(&self) -> &Covariance {
        &self.covariance
    }

    /// The same before any observation.
    pub(in crate::primitive) fn prior(&self) -> Self {
        Self {
            mean: self.prior_mean.as_ref().clone(),
            observed: Vec::new(),
            ..self.clone()
        }
    }

    /// The observations, in the order in which they were eliminated.
    pub fn observations(&self) -> impl ExactSizeIterator<Item = &LinearObservation> {
        self.observed.iter().map(|o| &o.observation)
    }

    /// Sigma (n x n), given the observations.
    pub fn covariance(&self) -> DMatrix<f64> {
        let mut sigma = self.covariance.dense();
        for observed in &self.observed {
            let gain = DVector::from_column_slice(&observed.gain);
            sigma.ger(-1.0, &gain, &gain, 1.0);
        }
        for (i, _) in self.fixed() {
            sigma.row_mut(i).fill(0.0);
            sigma.column_mut(i).fill(0.0);
        }
        sigma
    }

    /// A factor of Sigma, given the observations (n x l, plus a column for each inexact one): what maps standard normal numbers to x - mu.
    pub fn factor(&self) -> DMatrix<f64> {
        let latent = self.latent();
        let mut factor = DMatrix::zeros(self.dimension(), latent);
        let mut z = vec![0.0; latent];
        for (j, mut column) in factor.column_iter_mut().enumerate() {
            z.fill(0.0);
            z[j] = 1.0;
            column.copy_from(&(self.at_latent(&mut z) - &self.mean));
        }
        factor
    }

    fn fixed(&self) -> impl Iterator<Item = (usize, f64)> {
        self.observed.iter().filter_map(|o| o.fixed())
    }

    fn noises(&self) -> usize {
        self.observed.last().map_or(0, |o| o.noise.len())
    }

    /// How many standard normal numbers a draw takes.
    pub(crate) fn latent(&self) -> usize {
        self.covariance.latent() + self.noises()
    }

    /// The latent numbers that move the coordinates of the block from `start` on and nothing else, if no observation holds them.
    pub(in crate::primitive) fn untouched_latent(
        &self,
        start: usize,
    ) -> Option<std::ops::Range<usize>> {
        let own = self.covariance.latent_of_block(start)?;
        let held = |o: &Arc<Observed>| o.latent[own.clone()].iter().any(|q| *q != 0.0);
        (!self.observed.iter().any(held)).then_some(own)
    }

    /// x of latent numbers; what the observations determine is taken out of `z` first.
    pub(crate) fn at_latent(&self, z: &mut [f64]) -> DVector<f64> {
        let (latent, noise) = z.split_at_mut(self.covariance.latent());
        for observed in &self.observed {
            observed.project_out(latent, noise);
        }
        let mut x = self.mean.clone();
        self.covariance.apply(latent, x.as_mut_slice());
        // What rounding left.
        for (i, value) in self.fixed() {
            x[i] = value;
        }
        x
    }

    /// The gradient with respect to the latent numbers of a function of x, from its gradient g (n) with respect to x.
    pub(in crate::primitive) fn latent_gradient(&self, g: &[f64]) -> Vec<f64> {
        let mut z = self.covariance.apply_transposed(g);
        let mut noise = vec![0.0; self.noises()];
        for observed in self.observed.iter().rev() {
            observed.project_out(&mut z, &mut noise);
        }
        z.extend(noise);
        z
    }

    /// mu + B z, z standard normal and projected away from what is observed (n).
    pub fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> DVector<f64> {
        let mut z = vec![0.0; self.latent()];
        normal::fill(rng, &mut z);
        self.at_latent(&mut z)
    }

    /// Standard deviation of coordinate `i`; panics when there is none, as slices do.
    pub fn standard_deviation(&self, i: usize) -> f64 {
        self.deviation_of(&[(i, 1.0)])
    }

    /// Standard deviation of a^T x.
    pub(in crate::primitive) fn deviation_of(&self, row: &[(usize, f64)]) -> f64 {
        let fixed = row.iter().all(|(i, _)| self.fixed().any(|(j, _)| j == *i));
        if fixed {
            return 0.0;
        }
        let (latent, noise) = self.remaining(row, None);
        norm(&latent, &noise)
    }

    /// a^T mu.
    pub(in crate::primitive) fn mean_of(&self, row: &[(usize, f64)]) -> f64 {
        row.iter().map(|(i, c)| c * self.mean[*i]).sum()
    }

    /// Cov(a^T x, b^T x).
    pub(in crate::primitive) fn covariance_of(
        &self,
        a: &[(usize, f64)],
        b: &[(usize, f64)],
    ) -> f64 {
        let ((x, u), (y, v)) = (self.remaining(a, None), self.remaining(b, None));
        dot(&x, &y) + dot(&u, &v)
    }

    /// a^T B (l).
    fn latent_row(&self, row: &[(usize, f64)]) -> Vec<f64> {
        let mut a = vec![0.0; self.dimension()];
        for (i, c) in row {
            a[*i] += c;
        }
        self.covariance.apply_transposed(&a)
    }

    /// A row over the latent numbers, extended by its own noise if it has a deviation, projected away from the observations: twice, which is
    /// enough (Giraud et al. 2005). The noise that comes of it.
    fn project(&self, latent: &mut [f64], deviation: Option<f64>) -> Vec<f64> {
        let mut noise = vec![0.0; self.noises()];
        noise.extend(deviation);
        for _ in 0..2 {
            for observed in &self.observed {
                observed.project_out(latent, &mut noise);
            }
        }
        noise
    }

    /// What the observations leave of a^T B.
    fn remaining(&self, row: &[(usize, f64)], deviation: Option<f64>) -> (Vec<f64>, Vec<f64>) {
        let mut latent = self.latent_row(row);
        let noise = self.project(&mut latent, deviation);
        (latent, noise)
    }
}

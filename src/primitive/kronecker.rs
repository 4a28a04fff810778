//! [`Kronecker`]: coordinates of joints and harmonics whose correlation is that of the joints times that of the harmonics.

use nalgebra::DMatrix;

use crate::error::{Error, ErrorKind, Result};

/// Covariance S (A (x) R) S of m K consecutive coordinates, group by group (of a joint) and K in each (its harmonics):
/// A (m x m) is the correlation of the groups, R the correlation of a first-order autoregression, R_{kl} = rho^|k-l|, and
/// S = diag(s) holds standard deviations; a coordinate with s = 0 takes no part.
///
/// Its square root is S (L_A (x) L_R), with L_R the recursion y_k = rho y_{k-1} + sqrt(1 - rho^2) z_k; so a product costs
/// O(m^2 K), and A and rho are all there is to estimate.
#[derive(Debug, Clone, PartialEq)]
pub struct Kronecker {
    start: usize,
    correlation: DMatrix<f64>,
    decay: f64,
    deviations: Vec<f64>,
    /// L_A, row by row.
    root: Vec<f64>,
    groups: usize,
    length: usize,
}

impl Kronecker {
    /// A block from coordinate `start` on: A (m x m), rho, and m K standard deviations.
    ///
    /// # Errors
    /// When A is not symmetric and positive definite, |rho| >= 1, or the number of standard deviations is no multiple of m.
    pub fn new(
        start: usize,
        correlation: DMatrix<f64>,
        decay: f64,
        deviations: Vec<f64>,
    ) -> Result<Self> {
        let groups = correlation.nrows();
        if groups == 0
            || correlation.ncols() != groups
            || deviations.is_empty()
            || !deviations.len().is_multiple_of(groups)
        {
            return Err(Error::new(
                ErrorKind::Shape,
                format!(
                    "a correlation of {groups} x {} for {} coordinates",
                    correlation.ncols(),
                    deviations.len()
                ),
            )
            .expected("m x m, for m K coordinates"));
        }
        let refuse = |what: String| Err(Error::new(ErrorKind::Value, what));
        if !(decay.is_finite() && decay.abs() < 1.0) {
            return refuse(format!("an autoregression of {decay}"));
        }
        if let Some(s) = deviations.iter().find(|s| !(s.is_finite() && **s >= 0.0)) {
            return refuse(format!("a standard deviation of {s}"));
        }
        if correlation != correlation.transpose() {
            return refuse("a correlation matrix that is not symmetric".into());
        }
        if correlation.diagonal().iter().any(|d| *d != 1.0) {
            return refuse("a correlation matrix whose diagonal is not 1".into());
        }
        let Some(root) = correlation.clone().cholesky().map(|c| c.unpack()) else {
            return refuse("a correlation matrix that is not positive definite".into());
        };
        Ok(Self {
            start,
            length: deviations.len() / groups,
            root: root.transpose().as_slice().to_vec(),
            correlation,
            decay,
            deviations,
            groups,
        })
    }

    /// The first coordinate.
    pub fn start(&self) -> usize {
        self.start
    }

    /// m K.
    #[allow(clippy::len_without_is_empty)] // never empty
    pub fn len(&self) -> usize {
        self.deviations.len()
    }

    /// A (m x m).
    pub fn correlation(&self) -> &DMatrix<f64> {
        &self.correlation
    }

    /// rho.
    pub fn decay(&self) -> f64 {
        self.decay
    }

    /// s, m K of them.
    pub fn deviations(&self) -> &[f64] {
        &self.deviations
    }

    /// Coordinate i of x times `scales[i]`.
    pub(super) fn rescaled(&self, scales: &[f64]) -> Self {
        let own = &scales[self.start..];
        Self {
            deviations: self
                .deviations
                .iter()
                .zip(own)
                .map(|(s, c)| s * c)
                .collect(),
            ..self.clone()
        }
    }

    fn innovation(&self) -> f64 {
        (1.0 - self.decay * self.decay).sqrt()
    }

    /// The covariance of coordinates `i` and `j`; 0 where one lies outside.
    pub(super) fn covariance(&self, i: usize, j: usize) -> f64 {
        let at = |i: usize| i.checked_sub(self.start).filter(|i| *i < self.len());
        let (Some(i), Some(j)) = (at(i), at(j)) else {
            return 0.0;
        };
        let lag = (i % self.length).abs_diff(j % self.length) as i32;
        self.deviations[i]
            * self.deviations[j]
            * self.correlation[(i / self.length, j / self.length)]
            * self.decay.powi(lag)
    }

    /// x += S (L_A (x) L_R) z, joint by joint as x; `scratch` holds m K numbers.
    #[inline(always)]
    pub(super) fn apply(&self, z: &[f64], x: &mut [f64], scratch: &mut [f64]) {
        let (m, length) = (self.groups, self.length);
        scratch.fill(0.0);
        for d in 0..m {
            let mixed = &mut scratch[d * length..][..length];
            for e in 0..=d {
                let l = self.root[d * m + e];
                for (mixed, z) in mixed.iter_mut().zip(&z[e * length..][..length]) {
                    *mixed += l * z;
                }
            }
        }
        // All joints side by side: each recursion waits for itself alone.
        let innovation = self.innovation();
        for k in 1..length {
            for d in 0..m {
                let i = d * length + k;
                scratch[i] = self.decay * scratch[i - 1] + innovation * scratch[i];
            }
        }
        for ((x, s), y) in x.iter_mut().zip(&self.deviations).zip(&*scratch) {
            *x += s * y;
        }
    }

    /// Appends (S (L_A (x) L_R))^T g to `z`.
    pub(super) fn apply_transposed(&self, g: &[f64], z: &mut Vec<f64>) {
        let (m, length) = (self.groups, self.length);
        let mut scaled: Vec<f64> = g.iter().zip(&self.deviations).map(|(g, s)| g * s).collect();
        let innovation = self.innovation();
        for row in scaled.chunks_exact_mut(length) {
            for k in (1..length).rev() {
                row[k - 1] += self.decay * row[k];
                row[k] *= innovation;
            }
        }
        let from = z.len();
        z.resize(from + self.len(), 0.0);
        for e in 0..m {
            let own = &mut z[from + e * length..][..length];
            for d in e..m {
                let l = self.root[d * m + e];
                for (z, g) in own.iter_mut().zip(&scaled[d * length..][..length]) {
                    *z += l * g;
                }
            }
        }
    }
}

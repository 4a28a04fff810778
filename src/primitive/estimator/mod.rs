//! [`Estimator`]: a covariance of some hundred numbers from some fifteen demonstrations.

mod density;
mod held_out;
mod target;

use std::fmt;
use std::str::FromStr;

use nalgebra::{DMatrix, DVector};

pub(crate) use density::Density;
pub use held_out::HeldOut;
pub(crate) use held_out::weights;
pub(crate) use target::block;

use super::covariance::Covariance;
use super::gaussian::Gaussian;
use super::scatter::{Scatter, UNIFORM};
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::Interval;

/// Standard deviation that the logarithm of a level of jitter has on its own.
const LIVELINESS: f64 = 0.1;

/// How the covariance is estimated. All keep the standard deviations of the demonstrations, and differ in the correlations, C for those of the demonstrations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Estimator {
    /// C itself, of rank M - 1 at most: the paper. It knows M - 1 directions and rules out all others.
    MaximumLikelihood,
    /// (1 - a) C + a T with a Kronecker-structured target T: log moduli correlated like A (x) AR(1), joints times
    /// harmonics, phases by another A (x) AR(1), offsets among themselves. Without a weight a, the one is taken with which left-out demonstrations,
    /// conditioned on their own dominant modulus, are most probable.
    Kronecker {
        /// a, in (0, 1].
        weight: Option<f64>,
    },
    /// The leading eigenvector of C, and the Kronecker target of what it leaves.
    LowRankKronecker,
    /// (1 - a) C + a I with the weight of Ledoit and Wolf (J. Multivariate Analysis 88, 2004), on standardised coordinates.
    LedoitWolf,
    /// The same with the oracle-approximating weight of Chen, Wiesel, Eldar and Hero (IEEE Trans. Signal Processing 58, 2010).
    Oas,
}

impl Default for Estimator {
    fn default() -> Self {
        Self::Kronecker { weight: None }
    }
}

impl Estimator {
    /// One of each.
    pub const ALL: [Self; 5] = [
        Self::Kronecker { weight: None },
        Self::LowRankKronecker,
        Self::LedoitWolf,
        Self::Oas,
        Self::MaximumLikelihood,
    ];

    /// In standardised coordinates.
    fn correlation(self, scatter: &Scatter) -> Result<Covariance> {
        let n = scatter.directions.ncols();
        let active = |i: usize| f64::from(u8::from(scatter.deviations[i] > 0.0));
        let zeros = DVector::zeros(n);
        let c = scatter.directions.transpose();
        let diagonal = |weight: f64| {
            let independent = DVector::from_fn(n, |i, _| weight.sqrt() * active(i));
            Covariance::new(&c * (1.0 - weight).sqrt(), Vec::new(), independent)
        };
        match self {
            Self::MaximumLikelihood => Covariance::of_factor(c),
            Self::Kronecker { weight } => {
                let weight = weight.unwrap_or(1.0);
                if weight <= 0.0 || !Interval::within(1.0).contains(weight) {
                    return Err(
                        Error::new(ErrorKind::Setting, format!("a weight of {weight}"))
                            .expected("more than 0 and at most 1"),
                    );
                }
                let scales = vec![weight.sqrt(); n];
                let blocks =
                    target::blocks(&scatter.chart, &scatter.directions, scatter.count, &scales)?;
                Covariance::new(c * (1.0 - weight).sqrt(), blocks, zeros)
            }
            Self::LowRankKronecker => low_rank(scatter),
            Self::LedoitWolf => diagonal(ledoit_wolf_weight(scatter)),
            Self::Oas => {
                let gram = &scatter.directions * c.clone();
                diagonal(oas(&gram, (0..n).map(active).sum(), scatter.count))
            }
        }
    }

    /// The Gaussian over the coordinates of the scatter's chart.
    pub(super) fn gaussian(self, scatter: &Scatter) -> Result<Gaussian> {
        let mut independent = DVector::zeros(scatter.mean.len());
        for i in &scatter.uniform {
            independent[*i] = UNIFORM;
        }
        // How lively a wave is to be is the user's choice, also where all demonstrations were alike.
        if let Some(tail) = scatter.chart.tail() {
            for jitter in tail + scatter.chart.joints().len() + 1..scatter.mean.len() {
                independent[jitter] = LIVELINESS;
            }
        }
        let covariance = self
            .correlation(scatter)?
            .rescaled(&scatter.deviations, &independent)?;
        Gaussian::structured(scatter.mean.clone(), covariance)
    }
}

fn low_rank(scatter: &Scatter) -> Result<Covariance> {
    let c = &scatter.directions;
    let n = c.ncols();
    let eigen = (c * c.transpose()).symmetric_eigen();
    let leading = eigen.eigenvectors.column(eigen.eigenvalues.imax());
    // sqrt(lambda) u = C^T v for a unit eigenvector v of C C^T.
    let factor = c.tr_mul(&leading);
    let mut rest = c.clone();
    rest.ger(-1.0, &leading, &factor, 1.0);
    let mut scales = vec![0.0; n];
    for (mut column, scale) in rest.column_iter_mut().zip(&mut scales) {
        let norm = column.norm();
        // What rounding leaves of a coordinate that is the leading direction itself.
        if norm > 1e-6 {
            *scale = norm;
            column /= norm;
        } else {
            column.fill(0.0);
        }
    }
    let blocks = target::blocks(&scatter.chart, &rest, scatter.count, &scales)?;
    let factor = DMatrix::from_column_slice(n, 1, factor.as_slice());
    Covariance::new(factor, blocks, DVector::zeros(n))
}

fn ledoit_wolf_weight(scatter: &Scatter) -> f64 {
    let m = scatter.count;
    // With x_m = sqrt(M) times row m of the directions: C = sum x x^T / M, and |C|^2 is that of the Gram matrix.
    let gram = &scatter.directions * scatter.directions.transpose();
    let p = gram.trace();
    let square = gram.norm_squared();
    let fourth: f64 = gram.diagonal().iter().map(|g| (m * g).powi(2)).sum();
    let between = square - p;
    let within = (fourth - m * square) / (m * m);
    if between <= 0.0 {
        1.0
    } else {
        (within / between).clamp(0.0, 1.0)
    }
}

/// OAS for a correlation matrix C of p coordinates from its Gram matrix (same trace, same norm).
fn oas(gram: &DMatrix<f64>, p: f64, n: f64) -> f64 {
    let (trace, square) = (gram.trace(), gram.norm_squared());
    let numerator = (1.0 - 2.0 / p) * square + trace * trace;
    let denominator = (n + 1.0 - 2.0 / p) * (square - trace * trace / p);
    if denominator <= 0.0 {
        1.0
    } else {
        (numerator / denominator).min(1.0)
    }
}

impl fmt::Display for Estimator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::MaximumLikelihood => f.write_str("ml"),
            Self::Kronecker { weight: None } => f.write_str("kronecker"),
            Self::Kronecker { weight: Some(a) } => write!(f, "kronecker:{a}"),
            Self::LowRankKronecker => f.write_str("low-rank"),
            Self::LedoitWolf => f.write_str("ledoit-wolf"),
            Self::Oas => f.write_str("oas"),
        }
    }
}

impl FromStr for Estimator {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        if let Some(weight) = text.strip_prefix("kronecker:") {
            return match weight.parse::<f64>() {
                Ok(a) if a > 0.0 && a <= 1.0 => Ok(Self::Kronecker { weight: Some(a) }),
                _ => Err(
                    Error::new(ErrorKind::Setting, format!("a weight of `{weight}`"))
                        .expected("more than 0 and at most 1"),
                ),
            };
        }
        let named = Self::ALL.into_iter().find(|e| e.to_string() == text);
        named.ok_or_else(|| {
            Error::new(ErrorKind::Setting, format!("estimator `{text}`"))
                .expected("kronecker, kronecker:WEIGHT, low-rank, ledoit-wolf, oas or ml")
        })
    }
}

//! [`TrajectoryMoments`]: mean and covariance of y(t), in closed form.

mod weights;

use nalgebra::{DMatrix, DMatrixView, DVector};
use num_complex::Complex;

use super::{FourierMovementPrimitive, StartSpread};
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::{Derivative, Joints};
use weights::{Kind, absolute, pair, weights};

/// Matrices of so many rows and columns take 0.8 GB, and there are three at a time.
const LARGEST: usize = 10_000;

/// The first two moments of the trajectories of a primitive.
///
/// y(t) is no Gaussian, but it is linear in the weights, and theirs are those of complex log-normal numbers. With complex rows a such that ln w_j = a_j^T x,
///
/// ```text
/// E w_j                    = exp(a_j^T mu + a_j^T Sigma a_j / 2)
/// Cov(w_j, w_k), E w conj w = E w_j conj(E w_k) expm1(a_j^T Sigma conj(a_k))
/// pseudo-covariance, E w w  = E w_j E w_k expm1(a_j^T Sigma a_k)
/// ```
///
/// (moment generating function of the normal distribution); signed offsets are linear in x, and Cov(a^T x, w_k) = a^T Sigma a_k E w_k (Stein's lemma). A start
/// that is delayed by an independent delta multiplies E w_k by f(k), E w_j conj(w_k) by f(j - k) and E w_j w_k by f(j + k), f(q) = E exp(i q w delta).
///
/// Exact for unbounded draws of the primitive; draws that are rejected (for a robot's limits, say) have other moments. The tails are those of
/// log-normal numbers: far heavier than a Gaussian's.
///
/// ```
/// use undulate::{Derivative, FourierMovementPrimitive, StartSpread, synthetic};
///
/// let primitive = FourierMovementPrimitive::learn(&synthetic(0)?, 25)?;
/// let moments = primitive.moments(StartSpread::None)?;
/// let (mean, band) = (moments.mean(1.2, Derivative::Position), moments.standard_deviation(1.2, Derivative::Position));
/// println!("elbow: {:.2} +- {:.2} rad", mean[3], band[3]);
/// # Ok::<(), undulate::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct TrajectoryMoments {
    joints: Joints,
    period: f64,
    /// Entries a joint: w_0, Re w_1, Im w_1, Re w_2, ..
    length: usize,
    mean: DVector<f64>,
    covariance: DMatrix<f64>,
}

impl FourierMovementPrimitive {
    /// Mean and covariance of the trajectories, with a spread of the start on top of the primitive's own.
    ///
    /// # Errors
    /// When a variance is so large that a moment overflows, the spread is no number, each wave has its own frequency, or there are more than 10 000 coordinates.
    pub fn moments(&self, start: StartSpread) -> Result<TrajectoryMoments> {
        if let StartSpread::Normal(deviation) = start
            && !(deviation >= 0.0 && deviation.is_finite())
        {
            return Err(Error::new(
                ErrorKind::Setting,
                format!("a start that spreads by {deviation} s"),
            )
            .expected("a standard deviation in seconds"));
        }
        let chart = self.chart();
        let Some(period) = chart.period() else {
            return Err(Error::new(
                ErrorKind::Unsupported,
                "moments in closed form of waves that each have their own frequency",
            )
            .expected("a model learned with --period common")
            .help("draw waves instead"));
        };
        if chart.dimension() > LARGEST {
            return Err(Error::new(
                ErrorKind::Unsupported,
                format!("the covariance of {} coordinates", chart.dimension()),
            )
            .expected(format!("at most {LARGEST}, 2 D K + D"))
            .help("learn with fewer harmonics, or draw waves"));
        }
        let sigma = absolute(chart, self.gaussian().covariance());
        let mut mu = self.gaussian().mean().clone();
        let (phases, offsets) = chart.starts();
        chart
            .phases()
            .absolute(&mut mu.as_mut_slice()[phases..offsets]);
        let weights = weights(chart, &mu, &sigma);
        let w = std::f64::consts::TAU / period;
        let f = |q: f64| start.characteristic(q, w);

        let length = 2 * chart.harmonics() + 1;
        let size = chart.joints().len() * length;
        let mut mean = DVector::zeros(size);
        let mut covariance = DMatrix::zeros(size, size);
        for (j, one) in weights.iter().enumerate() {
            let middle = match one.kind {
                Kind::Linear(i) => Complex::from(mu[i]),
                Kind::Exponential { mean, .. } => mean * f(one.harmonic as f64),
            };
            mean[one.at] = middle.re;
            if one.harmonic > 0 {
                mean[one.at + 1] = middle.im;
            }
            for other in &weights[..=j] {
                let (hermitian, pseudo) = pair(one, other, &sigma, f);
                let mut set = |i: usize, j: usize, value: f64| {
                    covariance[(i, j)] = value;
                    covariance[(j, i)] = value;
                };
                let (a, b) = (one.at, other.at);
                set(a, b, (hermitian + pseudo).re / 2.0);
                if other.harmonic > 0 {
                    set(a, b + 1, (pseudo - hermitian).im / 2.0);
                }
                if one.harmonic > 0 {
                    set(a + 1, b, (pseudo + hermitian).im / 2.0);
                }
                if one.harmonic > 0 && other.harmonic > 0 {
                    set(a + 1, b + 1, (hermitian - pseudo).re / 2.0);
                }
            }
        }
        if covariance.iter().any(|c| !c.is_finite()) {
            return Err(Error::new(
                ErrorKind::Infeasible,
                "the variance of a log modulus is so large that moments overflow",
            )
            .help("condition on the amplitude, or learn from more demonstrations"));
        }
        Ok(TrajectoryMoments {
            joints: chart.joints().clone(),
            period,
            length,
            mean,
            covariance,
        })
    }
}

impl TrajectoryMoments {
    /// The joints' names.
    pub fn joints(&self) -> &Joints {
        &self.joints
    }

    /// T \[s\].
    pub fn period(&self) -> f64 {
        self.period
    }

    /// E y(t) or of a derivative (D; rad, rad/s, ..).
    pub fn mean(&self, t: f64, derivative: Derivative) -> DVector<f64> {
        let row = self.row(t, derivative);
        DVector::from_fn(self.joints.len(), |d, _| {
            row.dot(&self.mean.rows(d * self.length, self.length))
        })
    }

    /// Standard deviation of y(t) or of a derivative (D).
    pub fn standard_deviation(&self, t: f64, derivative: Derivative) -> DVector<f64> {
        self.covariance((t, derivative), (t, derivative))
            .diagonal()
            .map(|v| v.max(0.0).sqrt())
    }

    /// Cov(y(t), y(s)), or of derivatives of them (D x D; rows at `one`, columns at `other`).
    pub fn covariance(&self, one: (f64, Derivative), other: (f64, Derivative)) -> DMatrix<f64> {
        let (a, b) = (self.row(one.0, one.1), self.row(other.0, other.1));
        let joints = self.joints.len();
        DMatrix::from_fn(joints, joints, |d, e| a.dot(&(self.block(d, e) * &b)))
    }

    /// Mean and standard deviation at n T / N, n = 0..N (each N x D).
    pub fn on_grid(&self, points: usize, derivative: Derivative) -> (DMatrix<f64>, DMatrix<f64>) {
        let basis = self.basis(points, derivative);
        let joints = self.joints.len();
        let mut mean = DMatrix::zeros(points, joints);
        let mut deviation = DMatrix::zeros(points, joints);
        for d in 0..joints {
            mean.set_column(d, &(&basis * self.mean.rows(d * self.length, self.length)));
            let spread = &basis * self.block(d, d);
            for n in 0..points {
                let variance = spread.row(n).dot(&basis.row(n));
                deviation[(n, d)] = variance.max(0.0).sqrt();
            }
        }
        (mean, deviation)
    }

    /// The covariance of the whole trajectory at n T / N (ND x ND): joint by joint, N points in each.
    pub fn covariance_on_grid(&self, points: usize, derivative: Derivative) -> DMatrix<f64> {
        let basis = self.basis(points, derivative);
        let transposed = basis.transpose();
        let joints = self.joints.len();
        let mut covariance = DMatrix::zeros(points * joints, points * joints);
        for d in 0..joints {
            for e in 0..=d {
                let right = self.block(d, e) * &transposed;
                let shape = (points, points);
                let mut block = covariance.view_mut((d * points, e * points), shape);
                block.gemm(1.0, &basis, &right, 0.0);
            }
        }
        covariance.fill_upper_triangle_with_lower_triangle();
        covariance
    }

    fn block(&self, d: usize, e: usize) -> DMatrixView<'_, f64> {
        self.covariance.view(
            (d * self.length, e * self.length),
            (self.length, self.length),
        )
    }

    /// What multiplies w_0, Re w_1, Im w_1, .. in y(t) or a derivative.
    fn row(&self, t: f64, derivative: Derivative) -> DVector<f64> {
        let turns = t / self.period;
        self.row_at(turns - turns.floor(), derivative)
    }

    fn row_at(&self, turn: f64, derivative: Derivative) -> DVector<f64> {
        let mut row = DVector::zeros(self.length);
        let order = derivative.order();
        row[0] = f64::from(u8::from(order == 0));
        let w = std::f64::consts::TAU / self.period;
        for k in 1..=(self.length - 1) / 2 {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * (k as f64 * turn).fract());
            let scale = 2.0 * (k as f64 * w).powi(order);
            // Re(i^n exp(i k w t) (re + i im)).
            let (re, im) = match order % 4 {
                0 => (cos, -sin),
                1 => (-sin, -cos),
                2 => (-cos, sin),
                _ => (sin, cos),
            };
            row[2 * k - 1] = scale * re;
            row[2 * k] = scale * im;
        }
        row
    }

    /// The rows of the grid (N x (2K + 1)).
    fn basis(&self, points: usize, derivative: Derivative) -> DMatrix<f64> {
        let mut basis = DMatrix::zeros(points, self.length);
        for n in 0..points {
            let row = self.row_at(n as f64 / points as f64, derivative);
            basis.row_mut(n).copy_from(&row.transpose());
        }
        basis
    }
}

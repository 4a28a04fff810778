//! [`EllipticalSlice`]: elliptical slice sampling.

use std::f64::consts::TAU;

use nalgebra::DVector;
use rand::Rng;

use super::{Effort, Transition, checked, uniform};
use crate::error::{Error, ErrorKind, Result};
use crate::normal;

/// By then the bracket is narrower than any rounding: the point is the one the chain stands on, so a likelihood that is
/// a function of z has accepted it.
const MOST_SHRINKS: u64 = 1000;

/// Elliptical slice sampling (Murray, Adams and MacKay, "Elliptical slice sampling", AISTATS 2010, figure 2).
///
/// With nu ~ N(0, I_n) the ellipse z cos(theta) + nu sin(theta) holds the prior as it is for every theta. A threshold
/// ln y = L(z) + ln u is drawn under the likelihood, an angle on the whole ellipse, and the bracket of angles is shrunk
/// towards theta = 0 until the likelihood is above the threshold: no step is rejected and nothing is tuned. Each
/// transition costs a logarithm of (prior width / posterior width) evaluations of L, and moves about as far as the
/// posterior's narrowest direction lets it: for tight observations in many dimensions use
/// [`Hamiltonian`](super::Hamiltonian).
#[derive(Debug, Clone)]
pub struct EllipticalSlice<F> {
    log_likelihood: F,
    z: DVector<f64>,
    value: f64,
    /// nu, and the point on the ellipse that is tried.
    other: DVector<f64>,
    tried: DVector<f64>,
    evaluations: u64,
    transitions: u64,
}

impl<F: FnMut(&DVector<f64>) -> f64> EllipticalSlice<F> {
    /// For `log_likelihood` L of z in R^n, n = `dimension`. It must give the same value for the same z; minus infinity
    /// says that z is impossible.
    pub fn new(dimension: usize, log_likelihood: F) -> Self {
        let zeros = DVector::zeros(dimension);
        Self {
            log_likelihood,
            z: zeros.clone(),
            value: f64::NEG_INFINITY,
            other: zeros.clone(),
            tried: zeros,
            evaluations: 0,
            transitions: 0,
        }
    }
}

impl<F: FnMut(&DVector<f64>) -> f64> Transition for EllipticalSlice<F> {
    fn dimension(&self) -> usize {
        self.z.len()
    }

    fn start(&mut self, z: &[f64]) -> Result<bool> {
        self.z.as_mut_slice().copy_from_slice(z);
        self.value = checked((self.log_likelihood)(&self.z))?;
        self.evaluations = 1;
        self.transitions = 0;
        Ok(self.value > f64::NEG_INFINITY)
    }

    fn step<R: Rng + ?Sized>(&mut self, rng: &mut R) -> Result<()> {
        normal::fill(rng, self.other.as_mut_slice());
        let threshold = self.value + libm::log(uniform(rng));
        let mut angle = TAU * uniform(rng);
        let mut bracket = (angle - TAU, angle);
        for _ in 0..MOST_SHRINKS {
            let (sin, cos) = libm::sincos(angle);
            let pairs = self.z.iter().zip(self.other.iter());
            for (tried, (z, other)) in self.tried.iter_mut().zip(pairs) {
                *tried = z * cos + other * sin;
            }
            let value = checked((self.log_likelihood)(&self.tried))?;
            self.evaluations += 1;
            if value >= threshold {
                std::mem::swap(&mut self.z, &mut self.tried);
                self.value = value;
                self.transitions += 1;
                return Ok(());
            }
            if angle < 0.0 {
                bracket.0 = angle;
            } else {
                bracket.1 = angle;
            }
            angle = bracket.0 + (bracket.1 - bracket.0) * uniform(rng);
        }
        Err(Error::new(
            ErrorKind::Value,
            format!(
                "log-likelihood was {} at a point and is below {threshold} around it",
                self.value
            ),
        )
        .expected("the same value whenever it is asked for the same point"))
    }

    fn adapt(&mut self, _done: usize, _total: usize) {}

    fn position(&self) -> &[f64] {
        self.z.as_slice()
    }

    fn log_likelihood(&self) -> f64 {
        self.value
    }

    fn effort(&self) -> Effort {
        Effort {
            transitions: self.transitions,
            evaluations: self.evaluations,
            acceptance_sum: self.transitions as f64,
            divergent: 0,
        }
    }
}

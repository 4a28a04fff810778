//! Conditioning: observations eliminated one after the other.

use std::sync::Arc;

use super::{Gaussian, LinearObservation};
use crate::vectors::{add_scaled, dot};

/// A direction whose standard deviation is below this has no variance: coordinates are radians and logarithms.
const NO_VARIANCE: f64 = 1e-9;

/// An exact value may differ from the only one that is possible by this many standard deviations, or by this much.
const CONSISTENT: f64 = 1e-9;

/// Of an observation's standard deviation, what earlier observations must leave for it to count as another direction.
const DEPENDENT: f64 = 1e-8;

/// One observation, eliminated after those before it.
#[derive(Debug, PartialEq)]
pub(super) struct Observed {
    pub observation: LinearObservation,
    /// Its column of Q: over z, and over the latent numbers of the inexact observations up to it.
    pub latent: Vec<f64>,
    pub noise: Vec<f64>,
    /// Its column of U (n).
    pub gain: Vec<f64>,
}

impl Observed {
    /// The coordinate that is known exactly, if it is one alone.
    pub fn fixed(&self) -> Option<(usize, f64)> {
        match self.observation.row.as_slice() {
            [(i, c)] if self.observation.deviation == 0.0 => Some((*i, self.observation.value / c)),
            _ => None,
        }
    }

    pub fn project_out(&self, latent: &mut [f64], noise: &mut [f64]) {
        let share = dot(&self.latent, latent) + dot(&self.noise, &noise[..self.noise.len()]);
        add_scaled(latent, -share, &self.latent);
        add_scaled(noise, -share, &self.noise);
    }
}

impl Gaussian {
    /// The Gaussian given `observations` as well; the one with the largest share of its variance left goes first, as in a
    /// pivoted QR. Batch and sequence are the same, and the order does not matter, but for rounding.
    ///
    /// # Errors
    /// The index within `observations`, and what to say of it, when a value contradicts what is already certain.
    pub(crate) fn condition(
        &self,
        observations: &[LinearObservation],
    ) -> std::result::Result<Self, Contradiction> {
        let mut posterior = self.clone();
        let mut open: Vec<Pivot> = observations
            .iter()
            .enumerate()
            .map(|(index, observation)| Pivot::new(self, index, observation))
            .collect();
        while !open.is_empty() {
            let mut best = 0;
            for candidate in 1..open.len() {
                if open[candidate].share() > open[best].share() {
                    best = candidate;
                }
            }
            let pivot = open.swap_remove(best);
            let eliminated =
                posterior
                    .eliminate(&observations[pivot.index])
                    .map_err(|certain| Contradiction {
                        observation: pivot.index,
                        certain,
                        prior_deviation: pivot.prior,
                    })?;
            if eliminated && let Some(observed) = posterior.observed.last() {
                open.iter_mut().for_each(|p| p.update(observed));
            }
        }
        Ok(posterior)
    }

    /// As [`condition`](Self::condition), in the order given: what a file needs to come back bit for bit.
    pub(in crate::primitive) fn replay(
        &self,
        observations: &[LinearObservation],
    ) -> std::result::Result<Self, Contradiction> {
        let mut posterior = self.clone();
        for (index, observation) in observations.iter().enumerate() {
            let prior_deviation = self.deviation_of(&observation.row);
            posterior
                .eliminate(observation)
                .map_err(|certain| Contradiction {
                    observation: index,
                    certain,
                    prior_deviation,
                })?;
        }
        Ok(posterior)
    }

    /// Whether the observation told anything new; the only possible value where it contradicts.
    fn eliminate(&mut self, observation: &LinearObservation) -> std::result::Result<bool, f64> {
        let mut latent = self.latent_row(&observation.row);
        let prior = dot(&latent, &latent).sqrt();
        let residual = observation.value - self.mean_of(&observation.row);
        let deviation = observation.own_noise();
        let mut noise = self.project(&mut latent, deviation);
        let left = norm(&latent, &noise);
        // A wish about what does not vary any more cannot be met, and would pass for met: its own noise does not count.
        let varies = norm(&latent, &noise[..self.noises()]);
        if varies <= (DEPENDENT * prior).max(NO_VARIANCE) {
            return if residual.abs() <= CONSISTENT * prior.max(1.0) {
                Ok(false)
            } else {
                Err(self.mean_of(&observation.row))
            };
        }
        latent.iter_mut().chain(&mut noise).for_each(|q| *q /= left);
        let mut gain = vec![0.0; self.dimension()];
        self.covariance.apply(&latent, &mut gain);
        // What is known stays as it is, not only up to rounding.
        for (i, _) in self.fixed() {
            gain[i] = 0.0;
        }
        for (mean, u) in self.mean.iter_mut().zip(&gain) {
            *mean += residual / left * u;
        }
        let observed = Observed {
            observation: observation.clone(),
            latent,
            noise,
            gain,
        };
        if let Some((i, value)) = observed.fixed() {
            self.mean[i] = value;
        }
        self.observed.push(Arc::new(observed));
        Ok(true)
    }

    /// How the values of exact or inexact observations compare to what is expected of them, given what is observed already.
    ///
    /// An angle that an `is_uniform` coordinate leaves no narrower than `uniform` \[rad\] has the density of the circle.
    pub(in crate::primitive) fn surprise(
        &self,
        observations: &[LinearObservation],
        is_uniform: impl Fn(usize) -> bool,
        uniform: f64,
    ) -> Surprise {
        let mut posterior = self.clone();
        let (mut squared, mut log_density) = (0.0, 0.0);
        let normal = 0.5 * libm::log(std::f64::consts::TAU);
        for observation in observations {
            let residual = observation.value - posterior.mean_of(&observation.row);
            let (latent, noise) = posterior.remaining(&observation.row, observation.own_noise());
            let left = norm(&latent, &noise);
            match posterior.eliminate(observation) {
                Ok(true) => {
                    let distance = (residual / left).powi(2);
                    squared += distance;
                    let is_uniform = observation.row.iter().any(|(i, _)| is_uniform(*i));
                    log_density -= if is_uniform && left >= uniform {
                        2.0 * normal
                    } else {
                        0.5 * distance + libm::log(left) + normal
                    };
                }
                // As narrow as anything that counts as certain.
                Ok(false) => log_density -= libm::log(NO_VARIANCE) + normal,
                Err(_) => log_density = f64::NEG_INFINITY,
            }
        }
        Surprise {
            squared,
            log_density,
        }
    }

    /// The Mahalanobis distance of exact or inexact values from what is expected of them, given what is observed already:
    /// sqrt((b - A mu)^T V^-1 (b - A mu)). Values that are certain already add nothing.
    pub(in crate::primitive) fn mahalanobis(&self, observations: &[LinearObservation]) -> f64 {
        self.surprise(observations, |_| false, 0.0).squared.sqrt()
    }
}

/// What values come to, against what was expected of them.
pub(in crate::primitive) struct Surprise {
    /// (b - A mu)^T V^-1 (b - A mu), without values that were certain.
    pub squared: f64,
    /// ln N(b; A mu, V).
    pub log_density: f64,
}

pub(super) fn norm(latent: &[f64], noise: &[f64]) -> f64 {
    (dot(latent, latent) + dot(noise, noise)).sqrt()
}

/// An observation that waits, for the choice of the next.
struct Pivot {
    index: usize,
    /// Standard deviation before any of those that wait, and what those before it have left of its square.
    prior: f64,
    variance: f64,
    latent: Vec<f64>,
}

impl Pivot {
    fn new(gaussian: &Gaussian, index: usize, observation: &LinearObservation) -> Self {
        let (latent, noise) = gaussian.remaining(&observation.row, observation.own_noise());
        let prior = norm(&latent, &noise);
        Self {
            index,
            prior,
            variance: prior * prior,
            latent,
        }
    }

    fn share(&self) -> f64 {
        self.variance.max(0.0).sqrt() / self.prior.max(NO_VARIANCE)
    }

    fn update(&mut self, observed: &Observed) {
        // The noise of another observation is none of this one's.
        self.variance -= dot(&observed.latent, &self.latent).powi(2);
    }
}

/// An observation that the Gaussian rules out.
#[derive(Debug)]
pub(crate) struct Contradiction {
    /// Which one.
    pub observation: usize,
    /// The only value that is left for it.
    pub certain: f64,
    /// Its standard deviation before.
    pub prior_deviation: f64,
}

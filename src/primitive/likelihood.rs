//! [`Likelihood`]: how probable a demonstration is, phases on the circle.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use nalgebra::{DMatrix, DVector};

use super::chart::{LogPolar, PhaseForm, add_to_row, principal};
use super::covariance::Covariance;
use super::estimator::Density;
use super::example::Example;
use super::gaussian::Gaussian;
use super::scatter::UNIFORM;
use super::{FourierMovementPrimitive, LinearObservation};
use crate::error::Result;

/// No recording tells an angle \[rad\], or a logarithm, more finely. It keeps a joint that stands still from being infinitely probable.
const RESOLUTION: f64 = 1e-3;

/// Of the mean amplitude: below it a phase is not what the spread was learned for.
const FAINT: f64 = 0.1;

/// Of each kind of coordinate no more count, the lowest harmonics of every joint: time and memory grow with their cube and square.
const MOST_COUNTED: usize = 1500;

/// An exact observation holds for a demonstration to within this.
const HOLDS: f64 = 1e-6;

/// The density of vectors of a chart, with respect to ln rad, rad and so on of all its coordinates, so that it can be compared between models
/// whatever their branches and reference joints are: the maps between such charts keep volumes.
///
/// A phase lies on the circle: its deviation is the one in (-pi, pi]. One that is uniform has density 1 / (2 pi) and tells nothing. So has one of a
/// demonstration in which its amplitude is less than a tenth of the mean amplitude, weighted by itself as the spread of the phase was learned; of a
/// log-normal amplitude that is exp(mu + 3/2 sigma^2).
pub(super) struct Likelihood {
    chart: LogPolar,
    mean: DVector<f64>,
    covariance: Covariance,
    /// Of each phase, what it takes to tell something; `None` where it is uniform.
    amplitudes: Vec<Option<Amplitude>>,
}

/// A logarithm of amplitude, as a row over x, and the least at which the phase counts.
struct Amplitude {
    row: Vec<(usize, f64)>,
    least: f64,
}

impl Likelihood {
    /// Before any observation.
    pub fn of(chart: &LogPolar, gaussian: &Gaussian) -> Result<Self> {
        let gaussian = gaussian.prior();
        let prior = gaussian.prior_covariance();
        let (n, (phases, after)) = (chart.dimension(), chart.starts());
        let amplitudes = (phases..after)
            .map(|i| {
                let is_uniform = prior.independent()[i] >= UNIFORM;
                (!is_uniform).then(|| Amplitude::of(chart, &gaussian, i - phases))
            })
            .collect();
        let factor = if prior.factor().iter().all(|f| *f == 0.0) {
            DMatrix::zeros(n, 0)
        } else {
            prior.factor().clone()
        };
        let alone = prior.independent().map(|s| s.hypot(RESOLUTION));
        Ok(Self {
            chart: chart.clone(),
            mean: gaussian.prior_mean().clone(),
            covariance: Covariance::new(factor, prior.blocks().to_vec(), alone)?,
            amplitudes,
        })
    }

    /// ln of the density of each vector, on whatever branches their phases stand.
    pub fn logarithms(&self, vectors: &[&DVector<f64>]) -> Result<Vec<f64>> {
        let n = self.mean.len();
        let (phases, after) = self.chart.starts();
        // Without a factor moduli, phases and the rest are independent, and only phases count in some demonstrations and not in others.
        let parts = if self.covariance.factor().ncols() == 0 {
            vec![0..phases, phases..after, after..n]
        } else {
            vec![0..n; 1]
        };
        let is_low: Vec<bool> = (0..n).map(|i| self.chart.is_low(i, MOST_COUNTED)).collect();
        let mut known: BTreeMap<Vec<bool>, Density> = BTreeMap::new();
        let mut logarithms = Vec::with_capacity(vectors.len());
        for x in vectors {
            let deviations: Vec<f64> = (0..n)
                .map(|i| {
                    let deviation = x[i] - self.mean[i];
                    if (phases..after).contains(&i) {
                        principal(deviation)
                    } else {
                        deviation
                    }
                })
                .collect();
            let mut counts = is_low.clone();
            for (amplitude, counts) in self.amplitudes.iter().zip(&mut counts[phases..after]) {
                *counts &= amplitude.as_ref().is_some_and(|a| a.is_seen(x));
            }
            let told = |counts: &[bool]| counts.iter().filter(|counts| **counts).count();
            let blind = (told(&is_low) - told(&counts)) as f64;
            let mut logarithm = -blind * libm::log(std::f64::consts::TAU);
            for part in &parts {
                let of_part = (0..n).map(|i| counts[i] && part.contains(&i)).collect();
                let density = match known.entry(of_part) {
                    Entry::Occupied(known) => known.into_mut(),
                    Entry::Vacant(new) => {
                        let density = self.density(new.key())?;
                        new.insert(density)
                    }
                };
                logarithm += density.log(&deviations, 1.0, 1.0);
            }
            logarithms.push(logarithm);
        }
        Ok(logarithms)
    }

    /// Of the coordinates that count.
    fn density(&self, counts: &[bool]) -> Result<Density> {
        let counts: Vec<f64> = counts.iter().map(|c| f64::from(u8::from(*c))).collect();
        let nothing = DVector::zeros(counts.len());
        Ok(Density::new(&self.covariance.rescaled(&counts, &nothing)?))
    }
}

impl Amplitude {
    /// Of the phase at index `own` of D K: its modulus, times that of the one it is relative to.
    fn of(chart: &LogPolar, gaussian: &Gaussian, own: usize) -> Self {
        let harmonics = chart.harmonics();
        let (d, k) = (own / harmonics, own % harmonics);
        let mut row = Vec::new();
        let anchor = chart.phases().anchor(d, k).map(|(anchor, _)| anchor);
        for modulus in std::iter::once(own).chain(anchor) {
            let swing = chart.tail().map(|tail| tail + modulus / harmonics);
            for entry in std::iter::once(modulus).chain(swing) {
                add_to_row(&mut row, 1.0, &[(entry, 1.0)]);
            }
        }
        let least = if chart.phase_form() == PhaseForm::Principal {
            f64::NEG_INFINITY
        } else {
            let deviation = gaussian.deviation_of(&row);
            libm::log(FAINT) + gaussian.mean_of(&row) + 1.5 * deviation * deviation
        };
        Self { row, least }
    }

    fn is_seen(&self, x: &DVector<f64>) -> bool {
        self.row.iter().map(|(i, c)| c * x[*i]).sum::<f64>() >= self.least
    }
}

impl FourierMovementPrimitive {
    /// ln of the density of a demonstration, with respect to all coordinates of its chart: logarithms, and angles on the circle \[nats\]. Given observations it is
    /// the density of what they leave open, and that of a demonstration for which an exact one does not hold is 0.
    ///
    /// # Errors
    /// When the demonstration has other joints, another period or another number of harmonics, or is of cycles where the model is not.
    pub fn log_density(&self, example: &Example) -> Result<f64> {
        let x = self.chart().vector_of(example)?;
        let prior = Likelihood::of(self.chart(), self.gaussian())?.logarithms(&[&x])?[0];
        // Bayes' rule: p(x | b) = p(b | x) p(x) / p(b).
        let observations: Vec<LinearObservation> =
            self.gaussian().observations().cloned().collect();
        if observations.is_empty() {
            return Ok(prior);
        }
        let unconditioned = Self {
            gaussian: self.gaussian().prior(),
            chart: self.chart().clone(),
        };
        let holds: f64 = observations.iter().map(|o| self.holds(o, &x)).sum();
        Ok(prior + holds - unconditioned.linear_evidence(&observations))
    }

    /// ln p(b | x): of an exact observation 0 where it holds.
    fn holds(&self, observation: &LinearObservation, x: &DVector<f64>) -> f64 {
        let (phases, after) = self.chart().starts();
        let is_angle = |(i, _): &(usize, f64)| (phases..after).contains(i);
        let found: f64 = observation.row.iter().map(|(i, c)| c * x[*i]).sum();
        let residual = if observation.row.iter().any(is_angle) {
            principal(found - observation.value)
        } else {
            found - observation.value
        };
        match observation.deviation {
            0.0 if residual.abs() <= HOLDS => 0.0,
            0.0 => f64::NEG_INFINITY,
            s => {
                let squared = (residual / s).powi(2) + libm::log(std::f64::consts::TAU);
                -0.5 * squared - libm::log(s)
            }
        }
    }

    /// ln of the density of the observations' values, given those before.
    pub(super) fn linear_evidence(&self, observations: &[LinearObservation]) -> f64 {
        let independent = self.gaussian().prior_covariance().independent();
        let (phases, after) = self.chart().starts();
        let is_uniform = |i: usize| (phases..after).contains(&i) && independent[i] >= UNIFORM;
        self.gaussian()
            .surprise(observations, is_uniform, UNIFORM)
            .log_density
    }
}

//! [`Scatter`]: what a set of waves says of mean and spread, before anything is assumed of covariance.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::chart::{LogPolar, OffsetForm, PhaseForm, Phases, principal};
use super::covariance::dot;
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::Wave;

/// Of a demonstration: what all others together must be worth.
const ALONE: f64 = 1e-3;

/// Of a squared resultant: ln of it is that of a uniform angle.
const SHORTEST: f64 = 1e-12;

/// Probability with which a phase that is uniform is taken for one that is not.
const UNIFORMITY_LEVEL: f64 = 0.05;

/// Of fewer demonstrations than this no spread whatever would reject uniformity at that level: there is no test.
const FEWEST_FOR_TEST: usize = 3;

/// The standard deviation \[rad\] of a phase that is uniform: wrapped, such a normal density is uniform to 6e-9.
pub(super) const UNIFORM: f64 = std::f64::consts::TAU;

/// A coordinate that spreads less than this does not vary.
const STILL: f64 = 1e-12;

/// Mean, standard deviation and direction of each of n coordinates over M waves.
///
/// The correlation of coordinates i and j is the product of their directions, unit vectors in R^M (zero for what does not vary). For an angle
/// with weights v_m (amplitudes: at zero amplitude there is no phase), sum 1, effective number N = 1 / sum v_m^2 and resultant
/// R = |sum v_m exp(i phi_m)|, the mean is the direction of the resultant and the direction that of sqrt(v_m) delta_m, delta_m the deviation in
/// (-pi, pi]. Its variance is -ln R'^2, that of the wrapped normal with this resultant (Mardia and Jupp, Directional Statistics, 2000,
/// section 3.5.7), with R'^2 = (N R^2 - 1) / (N - 1), which is free of the bias that a random walk of N steps gives R^2. Where Rayleigh's test
/// (section 6.3.1) on N demonstrations does not reject it, the angle is uniform: on its own, with a standard deviation of a whole turn.
pub(super) struct Scatter {
    pub chart: LogPolar,
    pub mean: DVector<f64>,
    /// n standard deviations; 0 for a uniform phase.
    pub deviations: Vec<f64>,
    /// M x n.
    pub directions: DMatrix<f64>,
    /// The phases that are uniform, by index of x.
    pub uniform: Vec<usize>,
}

impl Scatter {
    /// Of at least two waves of one shape, with phases and offsets in the given forms.
    pub fn of(waves: &[Wave], form: PhaseForm, offsets: &[OffsetForm]) -> Result<Self> {
        let (Some(first), true) = (waves.first(), waves.len() > 1) else {
            return Err(
                Error::new(ErrorKind::Shape, format!("{} demonstrations", waves.len()))
                    .expected("at least two"),
            );
        };
        let (joints, harmonics) = (first.joints().len(), first.harmonics());
        let reference = strongest_joint(waves);
        let plain = LogPolar::of(first).with_offsets(offsets.to_vec());
        let principal_form = form == PhaseForm::Principal;
        // Once with branches about zero, to find where the branches must lie.
        let zeros = vec![0.0; joints * harmonics];
        let chart = plain.with_phases(Phases::new(form, reference, harmonics, zeros));
        let vectors = waves
            .iter()
            .map(|wave| chart.vector(wave))
            .collect::<Result<Vec<_>>>()?;
        let n = chart.dimension();
        let (phases, after) = chart.starts();
        let mut scatter = Self {
            mean: DVector::zeros(n),
            deviations: vec![0.0; n],
            directions: DMatrix::zeros(waves.len(), n),
            uniform: Vec::new(),
            chart,
        };
        for i in 0..n {
            let values: Vec<f64> = vectors.iter().map(|x| x[i]).collect();
            if (phases..after).contains(&i) && !principal_form {
                let d = (i - phases) / harmonics;
                let own = i - phases;
                let other = match scatter.chart.phases().relative_to(d) {
                    Some(reference) => reference * harmonics + own % harmonics,
                    None => own,
                };
                // Moduli as the chart has them: exp of ln r.
                let weights: Vec<f64> = vectors
                    .iter()
                    .map(|x| {
                        let product = if other == own {
                            x[own]
                        } else {
                            x[own] + x[other]
                        };
                        product.exp()
                    })
                    .collect();
                scatter.set_angle(i, &values, &weights);
            } else {
                scatter.set_number(i, &values);
            }
        }
        if !principal_form {
            let centres = scatter.mean.as_slice()[phases..after].to_vec();
            let centred = Phases::new(form, reference, harmonics, centres);
            scatter.chart = scatter.chart.with_phases(centred);
        }
        Ok(scatter)
    }

    fn set_number(&mut self, i: usize, values: &[f64]) {
        let count = values.len() as f64;
        // Relative to the first, so that values far from zero lose nothing to cancellation.
        let shift = values.iter().map(|v| v - values[0]).sum::<f64>() / count;
        let deviations: Vec<f64> = values.iter().map(|v| (v - values[0]) - shift).collect();
        self.mean[i] = values[0] + shift;
        let spread = (dot(&deviations, &deviations) / count).sqrt();
        self.set_direction(i, &deviations, spread);
    }

    fn set_angle(&mut self, i: usize, values: &[f64], weights: &[f64]) {
        let total: f64 = weights.iter().sum();
        let shares: Vec<f64> = weights.iter().map(|w| w / total).collect();
        let resultant: Complex<f64> = values
            .iter()
            .zip(&shares)
            .map(|(phase, share)| Complex::from_polar(*share, *phase))
            .sum();
        let centre = resultant.arg();
        self.mean[i] = centre;
        let effective = 1.0 / dot(&shares, &shares);
        // 1 for angles that are all the same, but for rounding.
        let length = resultant.norm().min(1.0);
        if values.len() >= FEWEST_FOR_TEST
            && (-effective * length * length).exp() > UNIFORMITY_LEVEL
        {
            self.uniform.push(i);
            return;
        }
        let scaled: Vec<f64> = values
            .iter()
            .zip(&shares)
            .map(|(phase, share)| share.sqrt() * principal(phase - centre))
            .collect();
        let others = effective - 1.0;
        if others < ALONE {
            // One demonstration alone has this harmonic: it tells where the phase is, and nothing of its spread.
            self.uniform.push(i);
            return;
        }
        // Rounding may exceed 1 for angles that are all the same.
        let square = ((effective * length * length - 1.0) / others).clamp(SHORTEST, 1.0);
        self.set_direction(i, &scaled, (-square.ln()).sqrt());
    }

    fn set_direction(&mut self, i: usize, deviations: &[f64], spread: f64) {
        let norm = dot(deviations, deviations).sqrt();
        if !(spread > STILL && norm > STILL) {
            return;
        }
        self.deviations[i] = spread;
        for (direction, deviation) in self.directions.column_mut(i).iter_mut().zip(deviations) {
            *direction = deviation / norm;
        }
    }

    /// M.
    pub fn count(&self) -> usize {
        self.directions.nrows()
    }

    /// The correlation of coordinates `i` and `j`.
    pub fn correlation(&self, i: usize, j: usize) -> f64 {
        let n = self.count();
        let all = self.directions.as_slice();
        dot(&all[i * n..][..n], &all[j * n..][..n])
    }
}

/// The joint with most energy over all waves and harmonics: its phases are the best known.
fn strongest_joint(waves: &[Wave]) -> usize {
    let energy = |d: usize| {
        waves
            .iter()
            .map(|w| w.weights().row(d).norm_squared())
            .sum::<f64>()
    };
    (0..waves[0].joints().len())
        .map(|d| (d, energy(d)))
        .fold(
            (0, -1.0),
            |best, next| if next.1 > best.1 { next } else { best },
        )
        .0
}

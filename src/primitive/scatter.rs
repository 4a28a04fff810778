//! [`Scatter`]: what a set of waves says of mean and spread, before anything is assumed of covariance.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::chart::{ChartForm, FLOOR, LogPolar, PhaseForm, principal};
use super::example::Example;
use crate::error::{Error, ErrorKind, Result};
use crate::vectors::dot;

/// Of a demonstration: what all others together must be worth.
const ALONE: f64 = 1e-3;

/// Of a squared resultant: ln of it is that of a uniform angle.
const SHORTEST: f64 = 1e-12;

/// Of the mean amplitude: below it a phase is not what the spread was learned for.
const FAINT: f64 = 0.1;

/// Probability with which a phase that is uniform is taken for one that is not.
const UNIFORMITY_LEVEL: f64 = 0.05;

/// Of effectively fewer demonstrations than this no spread whatever would reject uniformity at that level: there is no test.
const FEWEST_FOR_TEST: f64 = 3.0;

/// The standard deviation \[rad\] of a phase that is uniform: wrapped, such a normal density is uniform to 6e-9.
pub(super) const UNIFORM: f64 = std::f64::consts::TAU;

/// A coordinate that spreads less than this does not vary.
const STILL: f64 = 1e-12;

/// Demonstrations as vectors of one chart, with branches about zero, and the amplitudes that their phases are weighted by.
pub(super) struct Charted {
    pub chart: LogPolar,
    /// M of them.
    pub vectors: Vec<DVector<f64>>,
    /// Of each demonstration D K.
    amplitudes: Vec<Vec<f64>>,
}

impl Charted {
    /// Of at least two demonstrations of one shape.
    pub fn of(examples: &[Example], form: &ChartForm) -> Result<Self> {
        let (chart, vectors) = charted(examples, form)?;
        let (phases, after) = chart.starts();
        let amplitudes = examples
            .iter()
            .map(|example| {
                let of = |own| amplitude(&chart, example, own);
                (0..after - phases).map(of).collect()
            })
            .collect();
        Ok(Self {
            chart,
            vectors,
            amplitudes,
        })
    }

    /// What they say where demonstration m counts `shares[m]` times, of 0 to 1; not all of them 0.
    pub fn scatter(&self, shares: &[f64]) -> Scatter {
        let chart = self.chart.clone();
        let n = chart.dimension();
        let (phases, after) = chart.starts();
        let is_circular = chart.phase_form() != PhaseForm::Principal;
        let total: f64 = shares.iter().sum();
        let mut scatter = Scatter {
            mean: DVector::zeros(n),
            deviations: vec![0.0; n],
            directions: DMatrix::zeros(self.vectors.len(), n),
            count: total * total / dot(shares, shares),
            uniform: Vec::new(),
            amplitudes: vec![0.0; after - phases],
            chart,
        };
        for i in 0..n {
            let values: Vec<f64> = self.vectors.iter().map(|x| x[i]).collect();
            if (phases..after).contains(&i) && is_circular {
                let own = i - phases;
                let amplitudes: Vec<f64> = self.amplitudes.iter().map(|a| a[own]).collect();
                let products = amplitudes.iter().zip(shares).map(|(a, r)| a * r);
                let weights: Vec<f64> = products.collect();
                scatter.amplitudes[own] = dot(&weights, &amplitudes) / weights.iter().sum::<f64>();
                scatter.set_angle(i, &values, &weights);
            } else {
                scatter.set_number(i, &values, shares);
            }
        }
        if is_circular {
            let centres = scatter.mean.as_slice()[phases..after].to_vec();
            scatter.chart = scatter.chart.about(centres);
        }
        scatter
    }
}

/// What the phase at index `own` of D K is weighted by: the modulus, times that of the one it is relative to.
fn amplitude(chart: &LogPolar, example: &Example, own: usize) -> f64 {
    let harmonics = chart.harmonics();
    let modulus = |i: usize| {
        let weight = example.wave.weights()[(i / harmonics, i % harmonics)];
        weight.norm().max(FLOOR)
    };
    let anchor = chart.phases().anchor(own / harmonics, own % harmonics);
    modulus(own) * anchor.map_or(1.0, |(anchor, _)| modulus(anchor))
}

/// Mean, standard deviation and direction of each of n coordinates over M waves, each of which counts a share r of 0 to 1 (1 but for mixtures).
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
    /// How many demonstrations they are worth: (sum r)^2 / sum r^2 of their shares r (Kish, Survey Sampling, 1965, section 11.7); M where all count whole.
    pub count: f64,
    /// The phases that are uniform, by index of x.
    pub uniform: Vec<usize>,
    /// Of each phase, the mean of the amplitudes that it was weighted by, by the same weights; D K of them.
    amplitudes: Vec<f64>,
}

impl Scatter {
    /// Of at least two demonstrations of one shape, all of which count whole.
    pub fn of(examples: &[Example], form: &ChartForm) -> Result<Self> {
        Self::weighted(examples, &vec![1.0; examples.len()], form)
    }

    /// The same with a share for each.
    pub fn weighted(examples: &[Example], shares: &[f64], form: &ChartForm) -> Result<Self> {
        Ok(Charted::of(examples, form)?.scatter(shares))
    }

    /// Whether a demonstration has so little amplitude at coordinate `i` that its phase there tells nothing.
    pub fn is_faint(&self, example: &Example, i: usize) -> bool {
        let (phases, after) = self.chart.starts();
        let is_angle =
            self.chart.phase_form() != PhaseForm::Principal && (phases..after).contains(&i);
        is_angle
            && amplitude(&self.chart, example, i - phases) < FAINT * self.amplitudes[i - phases]
    }

    fn set_number(&mut self, i: usize, values: &[f64], shares: &[f64]) {
        let count: f64 = shares.iter().sum();
        let weighted = || values.iter().zip(shares);
        // Relative to the first, so that values far from zero lose nothing to cancellation.
        let shift = weighted().map(|(v, r)| r * (v - values[0])).sum::<f64>() / count;
        let deviations: Vec<f64> = weighted()
            .map(|(v, r)| r.sqrt() * ((v - values[0]) - shift))
            .collect();
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
        if effective >= FEWEST_FOR_TEST && rayleigh(effective, length) > UNIFORMITY_LEVEL {
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
}

/// The chart of at least two demonstrations of one shape with branches about zero, and their vectors in it.
pub(super) fn charted(
    examples: &[Example],
    form: &ChartForm,
) -> Result<(LogPolar, Vec<DVector<f64>>)> {
    let (Some(first), true) = (examples.first(), examples.len() > 1) else {
        return Err(Error::new(
            ErrorKind::Shape,
            format!("{} demonstrations", examples.len()),
        )
        .expected("at least two"));
    };
    let (joints, harmonics) = (first.wave.joints().clone(), first.wave.harmonics());
    if harmonics == 0 {
        return Err(
            Error::new(ErrorKind::Shape, "waves without harmonics").expected("at least one")
        );
    }
    let reference = strongest_joint(examples);
    let centres = vec![0.0; joints.len() * harmonics];
    let shape = (first.wave.period(), harmonics);
    let chart = LogPolar::in_form(joints, shape, form, reference, centres);
    let vectors = examples
        .iter()
        .map(|example| chart.vector_of(example))
        .collect::<Result<Vec<_>>>()?;
    Ok((chart, vectors))
}

/// The probability that N uniform angles have a resultant of this length or more, to O(N^-2) (Mardia and Jupp, equation (6.3.4)).
fn rayleigh(n: f64, length: f64) -> f64 {
    let z = n * length * length;
    let first = (2.0 * z - z * z) / (4.0 * n);
    let second =
        (24.0 * z - 132.0 * z.powi(2) + 76.0 * z.powi(3) - 9.0 * z.powi(4)) / (288.0 * n * n);
    // Far in the tail the series is no longer small, and the probability is nothing.
    (-z).exp() * (1.0 + first - second).max(0.0)
}

/// The joint with most energy over all waves and harmonics: its phases are the best known.
fn strongest_joint(examples: &[Example]) -> usize {
    let energy = |d: usize| {
        examples
            .iter()
            .map(|e| e.wave.weights().row(d).norm_squared())
            .sum::<f64>()
    };
    (0..examples[0].wave.joints().len())
        .map(|d| (d, energy(d)))
        .fold(
            (0, -1.0),
            |best, next| if next.1 > best.1 { next } else { best },
        )
        .0
}

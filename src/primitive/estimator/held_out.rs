//! [`HeldOut`]: how probable a left-out demonstration is, given one thing about it.

use nalgebra::DVector;

use super::Estimator;
use super::density::Density;
use crate::error::Result;
use crate::primitive::chart::{ChartForm, principal};
use crate::primitive::covariance::Covariance;
use crate::primitive::example::Example;
use crate::primitive::scatter::Scatter;

/// The weights that are tried.
const STEPS: usize = 20;

/// Added to the variance of each standardised coordinate where a covariance has no inverse: maximum likelihood.
const RIDGE: f64 = 1e-6;

/// Of each kind of coordinate no more are scored, the lowest harmonics of every joint: time and memory grow with their cube and square.
const MOST_SCORED: usize = 1500;

/// A demonstration left out of the estimate.
///
/// Its score is the density of its vector given its own largest modulus, in nats a dimension: coordinates in units of the standard
/// deviations of the others, phases wrapped about their conditional mean; uniform phases are not counted, nor those
/// of a tenth or less of the amplitude that their spread was weighted by. Conditional, because that is what a primitive
/// is for, and because joint density prefers estimators that forget how the joints go together (which is what conditioning uses).
pub struct HeldOut {
    scatter: Scatter,
    /// The left-out vector, standardised.
    z: Vec<f64>,
    /// 1 for the coordinates that are scored, 0 for phases without amplitude and for very high harmonics.
    counted: Vec<f64>,
    /// Its largest modulus.
    dominant: usize,
}

impl HeldOut {
    /// Each demonstration left out once.
    ///
    /// # Errors
    /// When there are fewer than three, or they make no primitive.
    pub fn each(examples: &[Example], form: &ChartForm) -> Result<Vec<Self>> {
        Self::each_weighted(examples, &vec![1.0; examples.len()], form)
    }

    /// The same where each counts a share of 0 to 1.
    fn each_weighted(examples: &[Example], shares: &[f64], form: &ChartForm) -> Result<Vec<Self>> {
        (0..examples.len())
            .map(|m| {
                let (mut rest, mut shares) = (examples.to_vec(), shares.to_vec());
                let left_out = rest.remove(m);
                shares.remove(m);
                Self::against(Scatter::weighted(&rest, &shares, form)?, &left_out)
            })
            .collect()
    }

    /// `example` against what `rest` say.
    ///
    /// # Errors
    /// Those of [`each`](Self::each).
    pub fn new(rest: &[Example], example: &Example, form: &ChartForm) -> Result<Self> {
        Self::against(Scatter::of(rest, form)?, example)
    }

    fn against(scatter: Scatter, example: &Example) -> Result<Self> {
        let x = scatter.chart.vector_of(example)?;
        let counted: Vec<f64> = (0..x.len())
            .map(|i| {
                let is_scored =
                    scatter.chart.is_low(i, MOST_SCORED) && !scatter.is_faint(example, i);
                f64::from(u8::from(is_scored))
            })
            .collect();
        // Of cycles, the largest swing.
        let sizes = match scatter.chart.tail() {
            None => 0..scatter.chart.starts().0,
            Some(tail) => tail..tail + scatter.chart.joints().len(),
        };
        let dominant = sizes
            .filter(|i| scatter.deviations[*i] > 0.0 && counted[*i] > 0.0)
            .fold(None, |best: Option<usize>, i| {
                if best.is_none_or(|b| x[i] > x[b]) {
                    Some(i)
                } else {
                    best
                }
            })
            .unwrap_or(0);
        let z = (0..x.len())
            .map(|i| {
                if scatter.deviations[i] > 0.0 {
                    (x[i] - scatter.mean[i]) / scatter.deviations[i]
                } else {
                    0.0
                }
            })
            .collect();
        Ok(Self {
            scatter,
            z,
            counted,
            dominant,
        })
    }

    /// The score of an estimator [nats a dimension]; without a weight, the Kronecker estimator has the target alone.
    ///
    /// # Errors
    /// When the demonstrations admit no such estimate.
    pub fn score(&self, estimator: Estimator) -> Result<f64> {
        let covariance = self.correlation(estimator)?;
        let covariance = if estimator == Estimator::MaximumLikelihood {
            let ridge = DVector::from_fn(self.z.len(), |i, _| {
                let varies = self.scatter.deviations[i] > 0.0 && self.counted[i] > 0.0;
                if varies { RIDGE.sqrt() } else { 0.0 }
            });
            covariance.rescaled(&vec![1.0; self.z.len()], &ridge)?
        } else {
            covariance
        };
        Ok(self.conditional(
            &self.column(&covariance),
            &Density::new(&covariance),
            1.0,
            1.0,
        ))
    }

    /// The scores of the Kronecker estimator for each of [`weights`]: its covariance is linear in the weight, and so is what one coordinate says of the others.
    fn scores(&self) -> Result<Vec<f64>> {
        let weight = Some(0.5);
        let half = self.correlation(Estimator::Kronecker { weight })?;
        let target = self.correlation(Estimator::Kronecker { weight: None })?;
        let density = Density::new(&half);
        let (half, target) = (self.column(&half), self.column(&target));
        Ok(weights()
            .map(|a| {
                let at = |(h, t): (&f64, &f64)| 2.0 * (1.0 - a) * h + (2.0 * a - 1.0) * t;
                let column: Vec<f64> = half.iter().zip(&target).map(at).collect();
                self.conditional(&column, &density, 2.0 * (1.0 - a), 2.0 * a)
            })
            .collect())
    }

    /// Of the coordinates that are counted.
    fn correlation(&self, estimator: Estimator) -> Result<Covariance> {
        let alone = DVector::zeros(self.z.len());
        estimator
            .correlation(&self.scatter)?
            .rescaled(&self.counted, &alone)
    }

    /// The covariances of all coordinates with the dominant one.
    fn column(&self, covariance: &Covariance) -> Vec<f64> {
        let mut row = vec![0.0; self.z.len()];
        row[self.dominant] = 1.0;
        let mut column = vec![0.0; self.z.len()];
        covariance.apply(&covariance.apply_transposed(&row), &mut column);
        column
    }

    fn conditional(&self, column: &[f64], density: &Density, f: f64, t: f64) -> f64 {
        let n = self.z.len();
        let variance = column[self.dominant];
        if variance <= 0.0 {
            return 0.0;
        }
        let (phases, offsets) = self.scatter.chart.starts();
        let mut deviation: Vec<f64> = (0..n)
            .map(|i| {
                let left = self.z[i] - column[i] / variance * self.z[self.dominant];
                let scale = self.scatter.deviations[i];
                if (phases..offsets).contains(&i) && scale > 0.0 {
                    principal(left * scale) / scale
                } else {
                    left
                }
            })
            .collect();
        // In the precision matrix the block of the others is the inverse of their conditional covariance.
        deviation[self.dominant] = 0.0;
        let of_dominant = -0.5 * (std::f64::consts::TAU * variance).ln();
        let others = density.count.saturating_sub(1).max(1) as f64;
        (density.log(&deviation, f, t) - of_dominant) / others
    }
}

/// 0.05, 0.10, .., 1.
pub(crate) fn weights() -> impl Iterator<Item = f64> {
    (1..=STEPS).map(|i| i as f64 / STEPS as f64)
}

impl Estimator {
    /// With its weight: that which makes left-out waves, conditioned on their own dominant modulus, most probable on average.
    /// Other estimators are as they were.
    ///
    /// # Errors
    /// Those of [`HeldOut::each`].
    pub fn chosen(self, examples: &[Example], form: &ChartForm) -> Result<Self> {
        self.chosen_for(examples, &vec![1.0; examples.len()], form)
    }

    /// The same where each counts a share of 0 to 1.
    pub(in crate::primitive) fn chosen_for(
        self,
        examples: &[Example],
        shares: &[f64],
        form: &ChartForm,
    ) -> Result<Self> {
        if self != (Self::Kronecker { weight: None }) {
            return Ok(self);
        }
        // With two demonstrations nothing can be left out: the target carries most.
        if examples.len() < 3 {
            return Ok(Self::Kronecker { weight: Some(1.0) });
        }
        let mut sums = [0.0; STEPS];
        let left_out = HeldOut::each_weighted(examples, shares, form)?;
        for (left_out, share) in left_out.iter().zip(shares) {
            for (sum, score) in sums.iter_mut().zip(left_out.scores()?) {
                *sum += share * score;
            }
        }
        let best = weights()
            .zip(sums)
            .fold((1.0, f64::NEG_INFINITY), |best, next| {
                if next.1 > best.1 { next } else { best }
            });
        Ok(Self::Kronecker {
            weight: Some(best.0),
        })
    }
}

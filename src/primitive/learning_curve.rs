//! [`LearningCurve`]: how many demonstrations are enough, and what each of them is worth.

use rand::seq::SliceRandom;

use super::chart::ChartForm;
use super::example::Example;
use super::{Estimator, FourierMovementPrimitive, LinearObservation, stream};
use crate::error::{Error, ErrorKind, Result};

/// A model of fewer says nothing of spread.
const FEWEST: usize = 3;

/// A rise within so many standard errors is none.
const CERTAIN: f64 = 2.0;

/// The mean of values and its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs)]
pub struct SampleMean {
    pub mean: f64,
    pub error: f64,
}

impl SampleMean {
    fn of(values: &[f64]) -> Self {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        Self {
            mean,
            error: (squares / (count - 1.0).max(1.0) / count).sqrt(),
        }
    }

    /// Whether it is positive beyond twice its error.
    pub fn is_certain(self) -> bool {
        self.mean > CERTAIN * self.error
    }
}

/// How probable models of so many demonstrations make one that they have not seen.
#[derive(Debug, Clone, PartialEq)]
pub struct CurvePoint {
    /// How many were learned from.
    pub demonstrations: usize,
    /// Of left-out ones \[nats a dimension\]; the error is over the left-out demonstrations.
    pub density: SampleMean,
}

/// Held-out conditional density against the number of demonstrations.
///
/// Each demonstration is left out in turn, and so many of the others, in an order drawn at random and the same for all numbers, are learned from. The score is the
/// density of the left-out demonstration given its own largest modulus (of cycles, swing) \[nats a dimension\], as for
/// [`HeldOut`](super::HeldOut); in rad and logarithms, and not in standard deviations of the others, which differ from number to number.
#[derive(Debug, Clone, PartialEq)]
pub struct LearningCurve {
    points: Vec<CurvePoint>,
    last_doubling: Option<SampleMean>,
}

impl LearningCurve {
    /// Of at least four demonstrations, each left out against `draws` orders of the others.
    ///
    /// # Errors
    /// When there are fewer, or no draws, or some of them make no primitive.
    pub fn of(
        examples: &[Example],
        form: &ChartForm,
        estimator: Estimator,
        draws: u64,
        seed: u64,
    ) -> Result<Self> {
        let count = examples.len();
        if count <= FEWEST || draws == 0 {
            let found = format!("{count} demonstrations, {draws} draws");
            return Err(Error::new(ErrorKind::Shape, found).expected(format!(
                "at least {} demonstrations and one draw: one is left out, and {FEWEST} make a model",
                FEWEST + 1
            )));
        }
        let sizes = sizes(count - 1);
        // Size by size, demonstration by demonstration.
        let mut scores = vec![vec![0.0; count]; sizes.len()];
        for draw in 0..draws {
            let mut order: Vec<usize> = (0..count).collect();
            order.shuffle(&mut stream(seed, draw));
            for left_out in 0..count {
                let others = order.iter().filter(|m| **m != left_out);
                let others: Vec<Example> = others.map(|m| examples[*m].clone()).collect();
                for (scores, size) in scores.iter_mut().zip(&sizes) {
                    let score = score(&others[..*size], &examples[left_out], form, estimator)?;
                    scores[left_out] += score / draws as f64;
                }
            }
        }
        let half = sizes
            .iter()
            .position(|size| *size == (count - 1).div_ceil(2));
        let last_doubling = half.filter(|half| *half > 0).map(|half| {
            let pairs = scores[0].iter().zip(&scores[half]);
            SampleMean::of(&pairs.map(|(all, half)| all - half).collect::<Vec<_>>())
        });
        let points = sizes.iter().zip(&scores).rev();
        Ok(Self {
            points: points
                .map(|(size, scores)| CurvePoint {
                    demonstrations: *size,
                    density: SampleMean::of(scores),
                })
                .collect(),
            last_doubling,
        })
    }

    /// From few demonstrations to all but one.
    pub fn points(&self) -> &[CurvePoint] {
        &self.points
    }

    /// What all but one demonstration gave over half as many, left-out demonstration by left-out demonstration; none of fewer than six.
    pub fn last_doubling(&self) -> Option<SampleMean> {
        self.last_doubling
    }

    /// What twice as many would give: half of what the last doubling gave, if the curve falls short of its end by a share of 1/M, as estimates of spread do.
    pub fn next_doubling(&self) -> Option<SampleMean> {
        self.last_doubling.map(|last| SampleMean {
            mean: last.mean / 2.0,
            error: last.error / 2.0,
        })
    }

    /// What each demonstration is worth to the others: by how much a model makes another one more probable for having learned from it too, all the rest being learned
    /// from \[nats a dimension\], with the standard error over the others. One that is worth less than nothing spoils the set.
    ///
    /// # Errors
    /// When there are fewer than five, or some of them make no primitive.
    pub fn worth(
        examples: &[Example],
        form: &ChartForm,
        estimator: Estimator,
    ) -> Result<Vec<SampleMean>> {
        let count = examples.len();
        if count < FEWEST + 2 {
            return Err(
                Error::new(ErrorKind::Shape, format!("{count} demonstrations")).expected(format!(
                    "at least {}: two are left out, and {FEWEST} make a model",
                    FEWEST + 2
                )),
            );
        }
        // The weight is a matter of the set.
        let estimator = estimator.chosen(examples, form)?;
        let without = |left_out: &[usize]| -> Vec<Example> {
            let kept = (0..count).filter(|m| !left_out.contains(m));
            kept.map(|m| examples[m].clone()).collect()
        };
        let with_all = (0..count)
            .map(|m| score(&without(&[m]), &examples[m], form, estimator))
            .collect::<Result<Vec<f64>>>()?;
        let mut gains = vec![Vec::with_capacity(count - 1); count];
        for m in 0..count {
            for j in 0..m {
                let primitive =
                    FourierMovementPrimitive::from_examples(&without(&[m, j]), form, estimator)?;
                for (scored, missing) in [(m, j), (j, m)] {
                    let poorer = primitive.conditional_log_density(&examples[scored])?;
                    gains[missing].push(with_all[scored] - poorer);
                }
            }
        }
        Ok(gains.iter().map(|gains| SampleMean::of(gains)).collect())
    }
}

fn score(
    rest: &[Example],
    example: &Example,
    form: &ChartForm,
    estimator: Estimator,
) -> Result<f64> {
    FourierMovementPrimitive::from_examples(rest, form, estimator)?.conditional_log_density(example)
}

/// From `most` down to three, each some 1/sqrt(2) of the one before, so that every other one is half.
fn sizes(most: usize) -> Vec<usize> {
    let mut sizes = Vec::new();
    let mut whole = most;
    while whole >= FEWEST {
        let between = (whole as f64 * std::f64::consts::FRAC_1_SQRT_2).round() as usize;
        sizes.extend([whole, between]);
        whole = whole.div_ceil(2);
    }
    sizes.retain(|size| *size >= FEWEST);
    sizes.dedup();
    sizes
}

impl FourierMovementPrimitive {
    /// ln of the density of a demonstration given its own largest modulus, or of cycles swing \[nats a dimension\].
    fn conditional_log_density(&self, example: &Example) -> Result<f64> {
        let chart = self.chart();
        let x = chart.vector_of(example)?;
        let sizes = match chart.tail() {
            None => 0..chart.starts().0,
            Some(tail) => tail..tail + chart.joints().len(),
        };
        let varies = |i: &usize| self.gaussian().standard_deviation(*i) > 0.0;
        let dominant = sizes.filter(varies).max_by(|a, b| x[*a].total_cmp(&x[*b]));
        let all = self.log_density(example)?;
        let Some(dominant) = dominant else {
            return Ok(all / x.len() as f64);
        };
        let own = self.linear_evidence(&[LinearObservation {
            row: vec![(dominant, 1.0)],
            value: x[dominant],
            deviation: 0.0,
        }]);
        Ok((all - own) / (x.len() - 1) as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::sizes;

    #[test]
    fn every_size_has_its_half() {
        assert_eq!(sizes(14), [14, 10, 7, 5, 4, 3]);
        for most in 3..60 {
            let sizes = sizes(most);
            assert_eq!(sizes[0], most);
            assert!(sizes.windows(2).all(|s| s[0] > s[1]), "{sizes:?}");
            assert!(most.div_ceil(2) < 3 || sizes.contains(&most.div_ceil(2)));
        }
    }
}

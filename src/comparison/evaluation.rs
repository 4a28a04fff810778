//! One model on one left-out demonstration after the other.

use std::time::Instant;

use super::bootstrap::Estimate;
use super::yardstick::{Measured, Yardstick};
use super::{Compared, ComparisonOptions, DISTANCES, energy, statistic};
use crate::baseline::{GestureModel, ModelKind, Wish};
use crate::demonstration::{Recording, Variation};
use crate::error::Result;
use crate::primitive::stream;

/// Draws given something about the left-out demonstration, or nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conditioned {
    /// Root mean square of ln (drawn / left out) of the dominant joint's swing: what was asked for, or what follows.
    pub swing_off: Estimate,
    /// The same of the frequency.
    pub frequency_off: Estimate,
    /// In the order of [`Distance::ALL`](crate::Distance::ALL).
    pub distances: [Estimate; DISTANCES],
}

/// How long it took \[s\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seconds {
    /// To learn from all demonstrations but those of a fold.
    pub learn: f64,
    /// To condition, where the model can be.
    pub condition: Option<f64>,
    /// To draw one motion.
    pub draw: f64,
}

/// Of one fold.
pub(super) struct FoldOutcome {
    pub names: Vec<String>,
    /// Rows of statistics of the left-out demonstrations.
    pub truths: Vec<Vec<f64>>,
    /// In the order of [`ModelKind::ALL`].
    pub models: Vec<Evaluation>,
}

/// Of one model, over left-out demonstrations.
#[derive(Default, Clone)]
pub(super) struct Evaluation {
    /// Rows of statistics.
    rows: Vec<Vec<f64>>,
    /// As drawn, given the swing, given the frequency: how far off both are, and distances.
    given: [Given; 3],
    learn: Vec<f64>,
    condition: Vec<f64>,
    draw: Vec<f64>,
}

/// Of the swing and of the frequency, and distances.
type Off = ([f64; 2], [f64; DISTANCES]);

#[derive(Default, Clone)]
struct Given {
    rows: Vec<Off>,
    refused: Option<String>,
}

/// Learns all models without the demonstrations of fold `k`, and looks at these.
pub(super) fn fold(
    recordings: &[Recording],
    joint: usize,
    k: usize,
    folds: usize,
    options: &ComparisonOptions,
) -> Result<FoldOutcome> {
    let of_fold = |(i, r): (usize, &Recording)| (i % folds == k).then(|| (i, r.clone()));
    let left_out: Vec<(usize, Recording)> =
        recordings.iter().enumerate().filter_map(of_fold).collect();
    let learned: Vec<Recording> = recordings
        .iter()
        .enumerate()
        .filter(|(i, _)| i % folds != k)
        .map(|(_, r)| r.clone())
        .collect();
    let yardsticks = left_out
        .iter()
        .map(|(_, truth)| Yardstick::new(&learned, truth, joint))
        .collect::<Result<Vec<_>>>()?;
    let truths = left_out
        .iter()
        .zip(&yardsticks)
        .map(|((_, truth), yardstick)| yardstick.measure(truth.positions().clone()))
        .collect::<Result<Vec<_>>>()?;
    let models = ModelKind::ALL
        .into_iter()
        .map(|kind| {
            let named = |e: crate::error::Error| e.at(kind.name());
            let mut evaluation = Evaluation::default();
            let start = Instant::now();
            let model = kind.learn(&learned, options.resolution).map_err(named)?;
            evaluation.learn.push(start.elapsed().as_secs_f64());
            for (((i, truth), yardstick), measured) in left_out.iter().zip(&yardsticks).zip(&truths)
            {
                let one = LeftOutOne {
                    index: *i as u64,
                    truth,
                    yardstick,
                    measured,
                    joint,
                    options,
                };
                evaluation.add(&*model, &one).map_err(named)?;
            }
            Ok(evaluation)
        })
        .collect::<Result<Vec<_>>>()?;
    Ok(FoldOutcome {
        names: left_out.iter().map(|(_, r)| r.name().to_owned()).collect(),
        truths: truths
            .iter()
            .map(|t| statistic::row(std::slice::from_ref(t), joint))
            .collect(),
        models,
    })
}

/// A left-out demonstration, and how it is looked at.
struct LeftOutOne<'a> {
    index: u64,
    truth: &'a Recording,
    yardstick: &'a Yardstick<'a>,
    measured: &'a Measured,
    joint: usize,
    options: &'a ComparisonOptions,
}

impl LeftOutOne<'_> {
    /// The same random numbers for every model: what differs is the model.
    fn draws(&self, model: &dyn GestureModel) -> Result<(Vec<Measured>, f64)> {
        let mut seconds = 0.0;
        let first = self.index * self.options.draws;
        let motions = (first..first + self.options.draws)
            .map(|i| {
                let start = Instant::now();
                let positions = model.draw(self.truth.times(), &mut stream(self.options.seed, i));
                seconds += start.elapsed().as_secs_f64();
                self.yardstick.measure(positions)
            })
            .collect::<Result<Vec<_>>>()?;
        Ok((motions, seconds / self.options.draws as f64))
    }

    fn variation(&self) -> Result<Variation> {
        Variation::of(self.truth)
    }

    /// How far off swing and frequency are, and distances.
    fn compared(&self, motions: &mut [Measured]) -> Result<Off> {
        let truth = self.variation()?;
        let off = |of: &dyn Fn(&Variation) -> f64| {
            let logarithms: Vec<f64> = motions
                .iter()
                .filter_map(|m| Some((of(m.variation.as_ref().ok()?) / of(&truth)).ln()))
                .collect();
            let square: f64 = logarithms.iter().map(|l| l * l).sum();
            (square / logarithms.len() as f64).sqrt()
        };
        let (swing, frequency) = (off(&|v| v.swing[self.joint]), off(&|v| v.frequency));
        let distances = std::array::from_fn(|i| {
            let vectors: Vec<Vec<Vec<f64>>> = motions
                .iter_mut()
                .map(|m| std::mem::take(&mut m.vectors[i]))
                .collect();
            energy::distance(&vectors, &self.measured.vectors[i])
        });
        Ok(([swing, frequency], distances))
    }
}

impl Evaluation {
    fn add(&mut self, model: &dyn GestureModel, one: &LeftOutOne<'_>) -> Result<()> {
        let (mut motions, seconds) = one.draws(model)?;
        self.draw.push(seconds);
        self.rows.push(statistic::row(&motions, one.joint));
        self.given[0].rows.push(one.compared(&mut motions)?);
        let truth = one.variation()?;
        let wishes = [
            Wish::Swing {
                joint: one.truth.joints().name(one.joint).to_owned(),
                swing: truth.swing[one.joint],
            },
            Wish::Frequency(truth.frequency),
        ];
        for (given, wish) in self.given[1..].iter_mut().zip(&wishes) {
            let start = Instant::now();
            match model.condition(wish) {
                Err(error) => given.refused = Some(error.to_string()),
                Ok(model) => {
                    self.condition.push(start.elapsed().as_secs_f64());
                    let (mut motions, _) = one.draws(&*model)?;
                    given.rows.push(one.compared(&mut motions)?);
                }
            }
        }
        Ok(())
    }

    /// Of folds, one after the other.
    pub fn gathered<'a>(folds: impl Iterator<Item = &'a Self>) -> Self {
        let mut all = Self::default();
        for fold in folds {
            all.rows.extend(fold.rows.iter().cloned());
            for (given, more) in all.given.iter_mut().zip(&fold.given) {
                given.rows.extend(&more.rows);
                given.refused = given.refused.take().or_else(|| more.refused.clone());
            }
            all.learn.extend(&fold.learn);
            all.condition.extend(&fold.condition);
            all.draw.extend(&fold.draw);
        }
        all
    }

    /// Distance number `i` to each left-out demonstration, as drawn.
    pub fn distances(&self, i: usize) -> impl Iterator<Item = f64> {
        self.given[0].rows.iter().map(move |row| row.1[i])
    }

    pub fn compared(&self, kind: ModelKind, joint: usize, options: &ComparisonOptions) -> Compared {
        let mean = |given: &Given, of: &dyn Fn(&Off) -> f64| {
            let values: Vec<f64> = given.rows.iter().map(of).collect();
            Estimate::of_mean(&values, options.confidence, options.seed)
        };
        let distances = |given: &Given| std::array::from_fn(|i| mean(given, &|off| off.1[i]));
        let given = |given: &Given| match &given.refused {
            Some(reason) => Err(reason.clone()),
            None => Ok(Conditioned {
                swing_off: mean(given, &|off| off.0[0]),
                frequency_off: mean(given, &|off| off.0[1]),
                distances: distances(given),
            }),
        };
        Compared {
            kind,
            statistics: statistic::estimates(&self.rows, joint, options),
            distances: distances(&self.given[0]),
            given: [
                given(&self.given[0]),
                given(&self.given[1]),
                given(&self.given[2]),
            ],
            seconds: Seconds {
                learn: median(&self.learn),
                condition: (!self.condition.is_empty()).then(|| median(&self.condition)),
                draw: median(&self.draw),
            },
        }
    }
}

fn median(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => f64::NAN,
        n => (values[n / 2] + values[(n - 1) / 2]) / 2.0,
    }
}

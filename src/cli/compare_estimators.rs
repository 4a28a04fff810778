//! `undulate compare-estimators`.

use clap::Args;
use serde_json::json;

use super::assumptions::Assumptions;
use super::recordings::Recordings;
use super::{Outcome, output};
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::Wave;
use crate::primitive::{
    Coordinate, Estimator, FourierMovementPrimitive, HeldOut, LearnOptions, Observation,
};

/// Compare the estimators of the covariance on recordings: how probable they make a left-out demonstration, and what they do to the coupling of two joints.
#[derive(Args)]
#[command(
    after_help = "Every demonstration is left out once, conditioned on its own largest modulus, and scored by the density of all the rest of it\n\
    (nats a dimension, in units of the standard deviations of the others; higher is better). The coupling is that of the two joints that\n\
    move most, at the harmonic at which the first is strongest: an estimator that loses it cannot move one joint by asking for the other.\n\n\
    Examples:\n  \
    undulate compare-estimators recordings/\n  \
    undulate compare-estimators --between elbow_flexion,wrist_deviation --harmonic 10"
)]
pub(super) struct Arguments {
    #[command(flatten)]
    recordings: Recordings,
    /// The highest harmonic, K.
    #[arg(long, short = 'k', value_name = "K", default_value_t = 25)]
    harmonics: usize,
    #[command(flatten)]
    assumptions: Assumptions,
    /// The two joints whose coupling is shown: the first is asked for, the second follows.
    #[arg(long, value_name = "A,B", value_delimiter = ',')]
    between: Option<Vec<String>>,
    /// The harmonic at which it is shown.
    #[arg(long, value_name = "K")]
    harmonic: Option<usize>,
}

/// What one estimator came to.
struct Row {
    estimator: Estimator,
    scores: Vec<f64>,
    correlation: f64,
    /// Median modulus of the second joint once the first is given \[rad\].
    follows: f64,
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    let demonstrations = arguments.recordings.demonstrations()?;
    let waves = demonstrations.fit(arguments.harmonics)?;
    if waves.len() < 3 {
        return Err(
            Error::new(ErrorKind::Shape, format!("{} demonstrations", waves.len()))
                .expected("at least three: one is left out, and two make a model"),
        );
    }
    let options = arguments.assumptions.options();
    let examples = options.examples(&waves)?;
    let form = options.form(&examples)?;
    let (first, second) = joints(arguments, &waves)?;
    let k = arguments
        .harmonic
        .unwrap_or_else(|| strongest(&waves, first));
    let names = waves[0].joints();
    let (one, other) = (
        Coordinate::modulus(names.name(first), k),
        Coordinate::modulus(names.name(second), k),
    );
    let asked = waves
        .iter()
        .map(|w| w.weights()[(first, k.saturating_sub(1).min(arguments.harmonics - 1))].norm())
        .fold(0.0, f64::max);

    let bar = output::progress(waves.len() as u64, "leaving out demonstrations");
    let mut scores = vec![Vec::new(); Estimator::ALL.len()];
    for left_out in 0..waves.len() {
        let mut rest = examples.clone();
        let example = rest.remove(left_out);
        let held_out = HeldOut::new(&rest, &example, &form)?;
        for (scores, estimator) in scores.iter_mut().zip(Estimator::ALL) {
            // The weight is chosen without the demonstration that is scored.
            let estimator = estimator.chosen(&rest, &form)?;
            scores.push(held_out.score(estimator)?);
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    let rows = Estimator::ALL
        .into_iter()
        .zip(scores)
        .map(|(estimator, scores)| {
            let estimator = estimator.chosen(&examples, &form)?;
            let options = LearnOptions {
                estimator,
                ..options
            };
            let primitive = FourierMovementPrimitive::from_waves(&waves, &options)?;
            let given = primitive.condition(&[Observation::of(one.clone(), asked)])?;
            Ok(Row {
                estimator,
                scores,
                correlation: primitive.correlation(&one, &other)?,
                follows: given.median(&other)?,
            })
        })
        .collect::<Result<Vec<_>>>()?;

    let value = json!({
        "demonstrations": waves.len(),
        "given": one.to_string(),
        "given_rad": asked,
        "follows": other.to_string(),
        "estimators": rows.iter().map(|row| {
            let (difference, error) = paired(&row.scores, &rows[0].scores);
            json!({
                "estimator": row.estimator.to_string(),
                "density": mean(&row.scores),
                "difference": difference,
                "standard_error": error,
                "correlation": row.correlation,
                "median_rad": row.follows,
            })
        }).collect::<Vec<_>>(),
    });
    output::report(json, &value, || {
        let table: Vec<Vec<String>> = rows.iter().map(|row| cells(row, &rows[0])).collect();
        let follows = format!("{other} [deg]");
        format!(
            "{} demonstrations, each left out once; {other} as {one} is given its largest demonstrated value, {} deg\n\n{}",
            waves.len(),
            output::degrees(asked),
            output::table(
                &[
                    "estimator",
                    "density [nats/dim]",
                    "less the default",
                    "correlation",
                    &follows
                ],
                &table
            )
        )
    });
    Ok(Outcome::Done)
}

fn cells(row: &Row, default: &Row) -> Vec<String> {
    let (difference, error) = paired(&row.scores, &default.scores);
    let number = |x: f64| {
        if x.abs() < 1e3 {
            format!("{x:.2}")
        } else {
            format!("{x:.1e}")
        }
    };
    vec![
        row.estimator.to_string(),
        number(mean(&row.scores)),
        if row.estimator == default.estimator {
            String::new()
        } else {
            format!("{} +- {}", number(difference), number(error))
        },
        format!("{:.2}", row.correlation),
        output::degrees(row.follows),
    ]
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Mean of the paired differences, and its standard error.
fn paired(a: &[f64], b: &[f64]) -> (f64, f64) {
    let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    let centre = mean(&differences);
    let count = differences.len() as f64;
    let variance = differences
        .iter()
        .map(|d| (d - centre).powi(2))
        .sum::<f64>()
        / (count - 1.0).max(1.0);
    (centre, (variance / count).sqrt())
}

fn joints(arguments: &Arguments, waves: &[Wave]) -> Result<(usize, usize)> {
    let joints = waves[0].joints();
    match arguments.between.as_deref() {
        None => {}
        Some([one, other]) => return Ok((joints.index(one)?, joints.index(other)?)),
        Some(names) => {
            return Err(
                Error::new(ErrorKind::Setting, format!("--between {}", names.join(",")))
                    .expected("two joints, A,B"),
            );
        }
    }
    let energy = |d: usize| {
        waves
            .iter()
            .map(|w| w.weights().row(d).norm_squared())
            .sum::<f64>()
    };
    let mut order: Vec<usize> = (0..joints.len()).collect();
    order.sort_by(|a, b| energy(*b).total_cmp(&energy(*a)));
    match order.as_slice() {
        [one, other, ..] => Ok((*one, *other)),
        _ => Err(Error::new(ErrorKind::Shape, "one joint has no coupling")
            .expected("recordings of two joints or more")),
    }
}

/// The harmonic of a joint with most energy over all waves.
fn strongest(waves: &[Wave], joint: usize) -> usize {
    let energy = |k: &usize| {
        waves
            .iter()
            .map(|w| w.weights()[(joint, k - 1)].norm_sqr())
            .sum::<f64>()
    };
    (1..=waves[0].harmonics())
        .max_by(|a, b| energy(a).total_cmp(&energy(b)))
        .unwrap_or(1)
}

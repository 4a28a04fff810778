//! `undulate condition`.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::{Outcome, output, read_model};
use crate::error::Result;
use crate::primitive::{FourierMovementPrimitive, Observation, Quantity, Unit};

/// Standard deviations within which a condition is nothing unusual.
const USUAL: f64 = 3.0;

/// Condition a model on amplitudes, phases and postures.
#[derive(Args)]
#[command(
    after_help = "A condition is `modulus:JOINT:K=VALUE` (half the amplitude of harmonic K), `phase:JOINT:K=VALUE` or `offset:JOINT=VALUE`,\n\
    with a value in deg or rad.\n\n\
    Example:\n  \
    undulate condition model.json --given modulus:elbow_flexion:10=5deg -o large.json"
)]
pub(super) struct Arguments {
    /// The model file.
    model: PathBuf,
    /// A value that every sampled wave shall have; may be given several times.
    #[arg(long, value_name = "CONDITION", required = true)]
    given: Vec<Observation>,
    /// The model file to write.
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    let primitive = read_model(&arguments.model)?;
    let conditioned = primitive.condition(&arguments.given)?;
    let distance = primitive.mahalanobis(&arguments.given)?;
    let usual = USUAL * (arguments.given.len() as f64).sqrt();
    if distance > usual {
        output::warn(format!(
            "the conditions lie {distance:.1} standard deviations from the demonstrations, more than {usual:.1}: the rest of the wave is extrapolated, moduli exponentially; look at what `undulate sample` draws"
        ));
    }
    output::write(&arguments.output, conditioned.to_json().as_bytes())?;
    let value = json!({
        "model": arguments.output,
        "given": arguments.given.iter().map(|o| observation_json(&primitive, o)).collect::<Vec<_>>(),
        "mahalanobis_distance": distance,
        "rank_before": primitive.gaussian().rank(),
        "rank": conditioned.gaussian().rank(),
    });
    let rows = arguments
        .given
        .iter()
        .map(|o| observation_row(&primitive, o))
        .collect::<Result<Vec<_>>>()?;
    output::report(json, &value, || {
        format!(
            "{}\n{distance:.1} standard deviations from the demonstrations; {} of {} independent directions of variation are left\nwrote {}",
            output::table(&["condition", "", "value", "median before"], &rows),
            conditioned.gaussian().rank(),
            primitive.gaussian().rank(),
            arguments.output.display()
        )
    });
    Ok(Outcome::Done)
}

/// One observation, with the actual frequency of its harmonic.
pub(super) fn observation_json(
    primitive: &FourierMovementPrimitive,
    observation: &Observation,
) -> Value {
    json!({
        "quantity": observation.quantity.to_string(),
        "value": observation.value,
        "deviation": observation.deviation,
        "frequency_hz": frequency(primitive, observation),
    })
}

fn observation_row(
    primitive: &FourierMovementPrimitive,
    observation: &Observation,
) -> Result<Vec<String>> {
    let (unit, before) = match &observation.quantity {
        Quantity::One(coordinate) => (coordinate.unit(), Some(primitive.median(coordinate)?)),
        Quantity::Sum(_) => (Unit::Number, None),
    };
    let (scale, unit) = unit.told();
    let told = |x: f64| format!("{:.2} {unit}", scale * x).trim_end().to_owned();
    let mut value = told(observation.value);
    if observation.deviation > 0.0 {
        value.push_str(&format!(" +- {}", told(observation.deviation)));
    }
    Ok(vec![
        observation.quantity.to_string(),
        frequency(primitive, observation).map_or(String::new(), |f| format!("{f:.3} Hz")),
        value,
        before.map_or(String::new(), told),
    ])
}

/// k/T of the harmonic that is meant.
fn frequency(primitive: &FourierMovementPrimitive, observation: &Observation) -> Option<f64> {
    let Quantity::One(coordinate) = &observation.quantity else {
        return None;
    };
    let chart = primitive.chart();
    let k = chart.harmonic(coordinate.harmonic()?).ok()?;
    chart.period().map(|period| k as f64 / period)
}

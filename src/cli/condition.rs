//! `undulate condition`.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::{Outcome, output, read_model};
use crate::error::Result;
use crate::primitive::Observation;

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
    let period = primitive.chart().period();
    let value = json!({
        "model": arguments.output,
        "given": arguments.given.iter().map(|o| json!({"coordinate": o.coordinate.to_string(), "value_rad": o.value})).collect::<Vec<_>>(),
        "mahalanobis_distance": distance,
        "rank_before": primitive.gaussian().rank(),
        "rank": conditioned.gaussian().rank(),
    });
    let mut rows = Vec::new();
    for observation in &arguments.given {
        let index = primitive.chart().index(&observation.coordinate)?;
        let hertz = observation.coordinate.harmonic().map(|k| k as f64 / period);
        rows.push(vec![
            observation.coordinate.to_string(),
            hertz.map_or(String::new(), |f| format!("{f:.2} Hz")),
            format!("{:.2} deg", observation.value.to_degrees()),
            format!(
                "{:.2} deg",
                observation
                    .coordinate
                    .value(primitive.gaussian().mean()[index])
                    .to_degrees()
            ),
        ]);
    }
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

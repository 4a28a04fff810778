//! `undulate condition`.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::{Outcome, output, read_model};
use crate::error::Result;
use crate::primitive::Observation;

/// Condition a model on amplitudes, phases and postures.
#[derive(Args)]
#[command(
    after_help = "A condition is `modulus:JOINT:K=VALUE` (half the amplitude of harmonic K), `phase:JOINT:K=VALUE` or `offset:JOINT=VALUE`,\n\
    with a value in deg or rad.\n\n\
    Example:\n  \
    undulate condition model.json --given modulus:elbow_flexion:10=5deg --given offset:wrist_deviation=0deg -o large.json"
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
    output::write(&arguments.output, conditioned.to_json().as_bytes())?;
    let period = primitive.chart().period();
    let value = json!({
        "model": arguments.output,
        "given": arguments.given.iter().map(|o| json!({"coordinate": o.coordinate.to_string(), "value_rad": o.value})).collect::<Vec<_>>(),
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
            "{}\n{} of {} directions are left\nwrote {}",
            output::table(&["condition", "", "value", "median before"], &rows),
            conditioned.gaussian().rank(),
            primitive.gaussian().rank(),
            arguments.output.display()
        )
    });
    Ok(Outcome::Done)
}

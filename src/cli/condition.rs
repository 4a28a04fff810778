//! `undulate condition`.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::wishes::Wishes;
use super::{Model, Outcome, output};
use crate::error::{Error, ErrorKind, Result};
use crate::primitive::{FourierMovementPrimitive, Mixture, Observation, Quantity, Unit};

/// Standard deviations within which a condition is nothing unusual.
const USUAL: f64 = 3.0;

/// Condition a model on amplitudes, phases, postures, tempo: exactly, or within a standard deviation.
#[derive(Args)]
#[command(after_help = "Conditions:\n  \
    modulus:JOINT:K=5deg            half the amplitude of harmonic K; K may be a frequency, 1.5Hz\n  \
    phase:JOINT:K=0.5rad            its phase; phase:JOINT/JOINT:K=30deg the phase between two joints\n  \
    offset:JOINT=10deg              the posture\n  \
    ratio:JOINT:K/JOINT:K=0.9       of two moduli\n  \
    sum:2*COORDINATE-1*COORDINATE=0.3   any linear row over ln moduli, phases [rad], offsets [rad]\n\
    and of models of cycles:\n  \
    frequency=2.5Hz, swing:JOINT=10deg, jitter:amplitude=5%, jitter:tempo=3%\n\
    `+-VALUE` (or +-10%) behind a value makes it a wish with a standard deviation.\n\n\
    Examples:\n  \
    undulate condition model.json --given modulus:elbow_flexion:10=5deg -o large.json\n  \
    undulate condition mixture.json --rename a=slow --rename b=fast -o named.json\n  \
    undulate condition named.json --component slow -o slow.json\n  \
    undulate condition lively.json --tempo 1.2x --size 0.8x --more wrist_deviation -o quick.json")]
pub(super) struct Arguments {
    /// The model file.
    model: PathBuf,
    #[command(flatten)]
    wishes: Wishes,
    /// Of a mixture, the model of one kind alone.
    #[arg(long, value_name = "NAME", conflicts_with = "rename")]
    component: Option<String>,
    /// Of a mixture, another name for a kind; may be given several times.
    #[arg(long, value_name = "NAME=NEW")]
    rename: Vec<String>,
    /// The model file to write.
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    let primitive = match (Model::read(&arguments.model)?, &arguments.component) {
        (Model::Many(mixture), None) => return of_mixture(&mixture, arguments, json),
        (Model::Many(mixture), Some(name)) => mixture.component(name)?.primitive.clone(),
        (Model::One(primitive), None) if arguments.rename.is_empty() => *primitive,
        (Model::One(_), _) => {
            return Err(Error::new(
                ErrorKind::Setting,
                "--component or --rename, and a model of one kind",
            )
            .expected("a mixture, as `undulate learn --kinds auto` writes it"));
        }
    };
    let given = arguments.wishes.observations(&primitive)?;
    if given.is_empty() && arguments.component.is_none() {
        return Err(Error::new(ErrorKind::Setting, "no condition")
            .expected("--given, --tempo, --size, --more or --livelier"));
    }
    let conditioned = primitive.condition(&given)?;
    let distance = primitive.mahalanobis(&given)?;
    warn_if_unusual(distance, given.len(), "the demonstrations");
    output::write(&arguments.output, conditioned.to_json().as_bytes())?;
    let value = json!({
        "model": arguments.output,
        "given": given.iter().map(|o| observation_json(&primitive, o)).collect::<Vec<_>>(),
        "mahalanobis_distance": distance,
        "rank_before": primitive.gaussian().rank(),
        "rank": conditioned.gaussian().rank(),
    });
    let rows = given
        .iter()
        .map(|o| observation_row(&primitive, &conditioned, o))
        .collect::<Result<Vec<_>>>()?;
    output::report(json, &value, || {
        if given.is_empty() {
            return format!("wrote {}", arguments.output.display());
        }
        format!(
            "{}\n{distance:.1} standard deviations from the demonstrations; {} of {} independent directions of variation are left\nwrote {}",
            output::table(&["condition", "", "value", "median before", "after"], &rows),
            conditioned.gaussian().rank(),
            primitive.gaussian().rank(),
            arguments.output.display()
        )
    });
    Ok(Outcome::Done)
}

/// What is farther than usual from `whom` is said to be.
fn warn_if_unusual(distance: f64, conditions: usize, whom: &str) {
    let usual = USUAL * (conditions as f64).sqrt();
    if distance > usual {
        output::warn(format!(
            "the conditions lie {distance:.1} standard deviations from {whom}, more than {usual:.1}, which is 3 for each at once: the rest of the wave is extrapolated, moduli exponentially; look at what `undulate sample` draws"
        ));
    }
}

/// Conditions every kind, and weighs it by how probable it made what is given; with new names where they are asked for.
fn of_mixture(mixture: &Mixture, arguments: &Arguments, json: bool) -> Result<Outcome> {
    let mut renamed = mixture.clone();
    for rename in &arguments.rename {
        let (from, to) = rename.split_once('=').ok_or_else(|| {
            Error::new(ErrorKind::Setting, format!("--rename {rename}"))
                .expected("two names, OLD=NEW")
        })?;
        renamed = renamed.renamed(from, to)?;
    }
    let given = arguments.wishes.without_knobs()?;
    if given.is_empty() && arguments.rename.is_empty() {
        return Err(Error::new(ErrorKind::Setting, "no condition")
            .expected("--given, --component or --rename"));
    }
    let conditioned = if given.is_empty() {
        renamed.clone()
    } else {
        renamed.condition(given)?
    };
    output::write(&arguments.output, conditioned.to_json().as_bytes())?;
    let after = |name: &str| conditioned.component(name).map_or(0.0, |c| c.weight);
    let kinds = renamed.components();
    let distances = kinds
        .iter()
        .map(|c| c.primitive.mahalanobis(given))
        .collect::<Result<Vec<_>>>()?;
    let nearest = distances.iter().copied().fold(f64::INFINITY, f64::min);
    warn_if_unusual(nearest, given.len(), "every kind");
    let value = json!({
        "model": arguments.output,
        "given": given.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "kinds": kinds.iter().zip(&distances).map(|(c, distance)| json!({
            "name": c.name,
            "weight_before": c.weight,
            "weight": after(&c.name),
            "mahalanobis_distance": distance,
        })).collect::<Vec<_>>(),
    });
    output::report(json, &value, || {
        let percent = |x: f64| format!("{:.1} %", 100.0 * x);
        let rows: Vec<Vec<String>> = kinds
            .iter()
            .zip(&distances)
            .map(|(c, distance)| {
                let away = if given.is_empty() {
                    String::new()
                } else {
                    format!("{distance:.1} standard deviations")
                };
                let weights = [percent(c.weight), percent(after(&c.name))];
                [&[c.name.clone()][..], &weights, &[away]].concat()
            })
            .collect();
        format!(
            "{}\nwrote {}",
            output::table(&["kind", "weight before", "after", "given, from it"], &rows),
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
    conditioned: &FourierMovementPrimitive,
    observation: &Observation,
) -> Result<Vec<String>> {
    let unit = match &observation.quantity {
        Quantity::One(coordinate) => coordinate.unit(),
        Quantity::Sum(_) => Unit::Number,
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
        told(primitive.median_of(observation)?),
        told(conditioned.median_of(observation)?),
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

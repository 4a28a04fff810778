//! What drawn waves shall be like, as arguments.

use clap::Args;

use super::output;
use crate::error::{Error, ErrorKind, Result};
use crate::primitive::{FourierMovementPrimitive, Observation, Quantity};

/// Conditions, exact or not, and knobs that are translated into such.
#[derive(Args)]
pub(super) struct Wishes {
    /// A condition, such as modulus:elbow:10=5deg, modulus:elbow:1.5Hz=5deg+-1deg, offset:wrist=10deg, ratio:wrist:10/elbow:10=0.9,
    /// or of cycles frequency=2.5Hz, swing:elbow=10deg, jitter:amplitude=5%; may be given several times.
    #[arg(long, value_name = "CONDITION")]
    given: Vec<Observation>,
    /// So many times as fast, such as 1.2x: the frequency.
    #[arg(long, value_name = "FACTOR", value_parser = factor)]
    tempo: Option<f64>,
    /// So many times as large: the swing of every joint (this and the other knobs: models of cycles).
    #[arg(long, value_name = "FACTOR", value_parser = factor)]
    size: Option<f64>,
    /// More of a joint: one standard deviation above its median swing, on top of --size; may be given several times.
    #[arg(long, value_name = "JOINT")]
    more: Vec<String>,
    /// So many times as much variation from cycle to cycle.
    #[arg(long, value_name = "FACTOR", value_parser = factor)]
    livelier: Option<f64>,
}

impl Wishes {
    /// The conditions, for a mixture: a knob turns what one kind of wave does.
    pub fn without_knobs(&self) -> Result<&[Observation]> {
        let turned = [
            (self.tempo.is_some(), "--tempo"),
            (self.size.is_some(), "--size"),
            (!self.more.is_empty(), "--more"),
            (self.livelier.is_some(), "--livelier"),
        ];
        match turned.iter().find(|(is_turned, _)| *is_turned) {
            None => Ok(&self.given),
            Some((_, knob)) => Err(Error::new(
                ErrorKind::Unsupported,
                format!("{knob} of a mixture, whose kinds have each their own tempo and size"),
            )
            .expected("conditions (--given)")
            .help(
                "or take one kind out: `undulate condition MIXTURE --component NAME -o one.json`",
            )),
        }
    }

    /// All of them as observations of a primitive; knobs are told as what they are translated to. The more specific has the last word: `--more` acts on top of
    /// `--size`, and a condition in the place of a knob that sets the same quantity.
    pub fn observations(&self, primitive: &FourierMovementPrimitive) -> Result<Vec<Observation>> {
        let mut knobs: Vec<Observation> = Vec::new();
        let mut told = Vec::new();
        if let Some(factor) = self.tempo {
            told.push((format!("--tempo {factor}x"), primitive.at_tempo(factor)?));
        }
        if let Some(factor) = self.size {
            told.push((format!("--size {factor}x"), primitive.at_size(factor)?));
        }
        if let Some(factor) = self.livelier {
            told.push((format!("--livelier {factor}x"), primitive.livelier(factor)?));
        }
        for (_, translated) in &told {
            translated.iter().for_each(|o| put(&mut knobs, o.clone()));
        }
        for joint in &self.more {
            let mut more = primitive.with_more(joint)?;
            if let Some(sized) = knobs.iter().find(|k| k.quantity == more.quantity) {
                let Quantity::One(coordinate) = &more.quantity else {
                    continue;
                };
                more.value *= sized.value / primitive.median(coordinate)?;
            }
            put(&mut knobs, more.clone());
            told.push((format!("--more {joint}"), vec![more]));
        }
        for (knob, translated) in told {
            let words: Vec<String> = translated.iter().map(ToString::to_string).collect();
            output::note(format!("{knob} is {}", words.join(", ")));
        }
        knobs.retain(|knob| {
            self.given
                .iter()
                .all(|given| given.quantity != knob.quantity)
        });
        knobs.extend(self.given.iter().cloned());
        Ok(knobs)
    }
}

/// In the place of an observation of the same quantity, if there is one.
fn put(observations: &mut Vec<Observation>, new: Observation) {
    match observations.iter_mut().find(|o| o.quantity == new.quantity) {
        Some(old) => *old = new,
        None => observations.push(new),
    }
}

/// `1.2x` or `1.2`.
fn factor(text: &str) -> Result<f64> {
    let number = text.trim();
    match number.strip_suffix('x').unwrap_or(number).parse::<f64>() {
        Ok(factor) if factor > 0.0 && factor.is_finite() => Ok(factor),
        _ => Err(Error::new(ErrorKind::Setting, format!("`{text}`"))
            .expected("a positive factor such as 1.2x")),
    }
}

//! What drawn waves shall be like, as arguments.

use clap::Args;

use super::output;
use crate::error::{Error, ErrorKind, Result};
use crate::primitive::{FourierMovementPrimitive, Observation};

/// Conditions, exact or not, and knobs that are translated into such.
#[derive(Args)]
pub(super) struct Wishes {
    /// A condition, such as modulus:elbow:10=5deg, modulus:elbow:1.5Hz=5deg+-1deg, offset:wrist=10deg, ratio:wrist:10/elbow:10=0.9,
    /// or of cycles frequency=2.5Hz, swing:elbow=10deg, jitter:amplitude=5%; may be given several times.
    #[arg(long, value_name = "CONDITION")]
    given: Vec<Observation>,
    /// So many times as fast, such as 1.2x.
    #[arg(long, value_name = "FACTOR", value_parser = factor)]
    tempo: Option<f64>,
    /// So many times as large, all joints.
    #[arg(long, value_name = "FACTOR", value_parser = factor)]
    size: Option<f64>,
    /// More of a joint: one standard deviation above its median amplitude; may be given several times.
    #[arg(long, value_name = "JOINT")]
    more: Vec<String>,
    /// So many times as much variation from cycle to cycle (models of cycles).
    #[arg(long, value_name = "FACTOR", value_parser = factor)]
    livelier: Option<f64>,
}

impl Wishes {
    /// All of them as observations of a primitive; knobs are told as what they are translated to.
    pub fn observations(&self, primitive: &FourierMovementPrimitive) -> Result<Vec<Observation>> {
        let mut observations = self.given.clone();
        let mut add = |knob: String, translated: Vec<Observation>| {
            let words: Vec<String> = translated.iter().map(ToString::to_string).collect();
            output::note(format!("{knob} is {}", words.join(", ")));
            observations.extend(translated);
        };
        if let Some(factor) = self.tempo {
            add(format!("--tempo {factor}x"), primitive.at_tempo(factor)?);
        }
        if let Some(factor) = self.size {
            add(format!("--size {factor}x"), primitive.at_size(factor)?);
        }
        for joint in &self.more {
            add(format!("--more {joint}"), vec![primitive.with_more(joint)?]);
        }
        if let Some(factor) = self.livelier {
            add(format!("--livelier {factor}x"), primitive.livelier(factor)?);
        }
        Ok(observations)
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

//! Model files: of one primitive, or of a mixture.

use std::path::Path;

use rand::Rng;
use rand::distr::Distribution;

use super::read_text;
use super::wishes::Wishes;
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::{Joints, Wave};
use crate::primitive::{FourierMovementPrimitive, Mixture};

/// What waves are drawn from.
pub(super) enum Model {
    One(Box<FourierMovementPrimitive>),
    Many(Mixture),
}

impl Model {
    pub fn read(path: &Path) -> Result<Self> {
        let text = read_text(path)?;
        let model = if Mixture::is_file(&text) {
            Mixture::from_json(&text).map(Self::Many)
        } else {
            FourierMovementPrimitive::from_json(&text).map(|one| Self::One(Box::new(one)))
        };
        model.map_err(|e| {
            e.help("`undulate learn` writes a model file")
                .at(path.display().to_string())
        })
    }

    /// The only primitive, for what a mixture cannot do.
    pub fn one(self) -> Result<FourierMovementPrimitive> {
        match self {
            Self::One(primitive) => Ok(*primitive),
            Self::Many(mixture) => {
                let names: Vec<&str> = mixture
                    .components()
                    .iter()
                    .map(|c| c.name.as_str())
                    .collect();
                Err(Error::new(
                    ErrorKind::Unsupported,
                    format!("a mixture of {} kinds of wave", names.len()),
                )
                .expected("a model of one kind")
                .help(format!(
                    "`undulate condition MIXTURE --component NAME -o one.json` takes one out: {}",
                    names.join(", ")
                )))
            }
        }
    }

    pub fn conditioned(self, wishes: &Wishes) -> Result<Self> {
        match self {
            Self::One(primitive) => {
                let conditioned = primitive.condition(&wishes.observations(&primitive)?)?;
                Ok(Self::One(Box::new(conditioned)))
            }
            Self::Many(mixture) => match wishes.without_knobs()? {
                [] => Ok(Self::Many(mixture)),
                given => mixture.condition(given).map(Self::Many),
            },
        }
    }

    pub fn joints(&self) -> &Joints {
        match self {
            Self::One(primitive) => primitive.chart().joints(),
            Self::Many(mixture) => mixture.joints(),
        }
    }

    /// T \[s\], where it is common to all waves.
    pub fn period(&self) -> Option<f64> {
        match self {
            Self::One(primitive) => primitive.chart().period(),
            Self::Many(mixture) => mixture.components()[0].primitive.chart().period(),
        }
    }
}

impl Distribution<Wave> for Model {
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> Wave {
        match self {
            Self::One(primitive) => primitive.sample(rng),
            Self::Many(mixture) => mixture.sample(rng),
        }
    }
}

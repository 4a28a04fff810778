//! The file of a mixture: the primitives' own objects, with names and weights.

use serde::{Deserialize, Serialize};

use super::{Component, Mixture};
use crate::document;
use crate::error::Result;
use crate::primitive::FourierMovementPrimitive;
use crate::primitive::file::ModelFile;

/// What the format calls itself.
const MIXTURE: &str = "undulate mixture";
/// The version that is written.
const VERSION: u64 = 1;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct MixtureFile {
    format: String,
    version: u64,
    components: Vec<ComponentEntry>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ComponentEntry {
    name: String,
    weight: f64,
    /// As a model file of its own.
    model: ModelFile,
}

impl Mixture {
    /// The file, version 1.
    pub fn to_json(&self) -> String {
        let components = self.components().iter().map(|c| ComponentEntry {
            name: c.name.clone(),
            weight: c.weight,
            model: c.primitive.to_file(),
        });
        document::write(&MixtureFile {
            format: MIXTURE.to_owned(),
            version: VERSION,
            components: components.collect(),
        })
    }

    /// Reads the file of a mixture; numbers come back bit for bit.
    ///
    /// # Errors
    /// When the text is no such file, is cut short, of a later version, or its numbers make no mixture.
    pub fn from_json(text: &str) -> Result<Self> {
        let file: MixtureFile = document::read(text, MIXTURE, VERSION)?;
        let components = file
            .components
            .into_iter()
            .map(|entry| {
                let primitive = FourierMovementPrimitive::from_file(entry.model)
                    .map_err(|e| e.at(format!("component `{}`", entry.name)))?;
                Ok(Component {
                    name: entry.name,
                    weight: entry.weight,
                    primitive,
                })
            })
            .collect::<Result<_>>()?;
        Self::new(components)
    }

    /// Whether a text calls itself a mixture; what is wrong with it is said when it is read.
    pub fn is_file(text: &str) -> bool {
        document::version(text, MIXTURE, u64::MAX).is_ok()
    }
}

//! The model file: versioned JSON.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::{FourierMovementPrimitive, Gaussian, LogPolar};
use crate::document::{self, VERSION};
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::{Joints, Wave};

/// What the format calls itself.
const MODEL: &str = "undulate model";

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ModelFile {
    format: String,
    version: u64,
    /// How phases enter the vector: `principal`, their values in (-pi, pi].
    phases: Phases,
    /// How offsets enter the vector: `signed`, as they are.
    offsets: Offsets,
    joints: Vec<String>,
    period_s: f64,
    harmonics: usize,
    /// n = 2DK + D numbers in the order of `LogPolar`.
    mean: Vec<f64>,
    /// r columns of n numbers each: the covariance is the sum of their outer products.
    factor: Vec<Vec<f64>>,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Phases {
    Principal,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Offsets {
    Signed,
}

impl FourierMovementPrimitive {
    /// The model file, version 1.
    pub fn to_json(&self) -> String {
        document::write(&ModelFile {
            format: MODEL.to_owned(),
            version: VERSION,
            phases: Phases::Principal,
            offsets: Offsets::Signed,
            joints: self.chart.joints().iter().cloned().collect(),
            period_s: self.chart.period(),
            harmonics: self.chart.harmonics(),
            mean: self.gaussian.mean().as_slice().to_vec(),
            factor: self
                .gaussian
                .factor()
                .column_iter()
                .map(|c| c.iter().copied().collect())
                .collect(),
        })
    }

    /// Reads a model file; numbers come back bit for bit.
    ///
    /// # Errors
    /// When the text is not a model file, is cut short, of a later version, or its numbers make no primitive.
    pub fn from_json(text: &str) -> Result<Self> {
        let file: ModelFile = document::read(text, MODEL)?;
        let joints = Joints::new(file.joints)?;
        // Through a wave of zeros, whose constructor checks the period.
        let blank = Wave::new(
            joints.clone(),
            file.period_s,
            DVector::zeros(joints.len()),
            DMatrix::zeros(joints.len(), 0),
        )?;
        let n = file.mean.len();
        // Before anything of that size is made.
        let expected = file
            .harmonics
            .checked_mul(2)
            .and_then(|k| k.checked_add(1))
            .and_then(|k| k.checked_mul(joints.len()));
        if file.harmonics == 0 || expected != Some(n) || file.factor.iter().any(|c| c.len() != n) {
            return Err(Error::new(
                ErrorKind::Shape,
                format!(
                    "{} joints, {} harmonics, a mean of {n} numbers, or a column of the factor of another length",
                    joints.len(),
                    file.harmonics
                ),
            )
            .expected("2 D K + D numbers in the mean and in each column"));
        }
        let factor = DMatrix::from_fn(n, file.factor.len(), |i, j| file.factor[j][i]);
        let gaussian = Gaussian::new(DVector::from_vec(file.mean), factor)?;
        Self::new(
            LogPolar::new(joints, blank.period(), file.harmonics),
            gaussian,
        )
    }
}

//! The wave file: versioned JSON.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use serde::{Deserialize, Serialize};

use super::{Joints, Wave};
use crate::document;
use crate::error::{Error, ErrorKind, Result};

/// What the format calls itself.
const WAVE: &str = "undulate wave";
/// The version that is written; all from 1 to it are read.
const VERSION: u64 = 1;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WaveFile {
    format: String,
    version: u64,
    joints: Vec<String>,
    period_s: f64,
    offsets_rad: Vec<f64>,
    /// A row a joint, `[re, im]` for each harmonic 1..=K: half the amplitude.
    weights_rad: Vec<Vec<[f64; 2]>>,
}

impl Wave {
    /// The wave file, version 1.
    pub fn to_json(&self) -> String {
        document::write(&WaveFile {
            format: WAVE.to_owned(),
            version: VERSION,
            joints: self.joints().iter().cloned().collect(),
            period_s: self.period(),
            offsets_rad: self.offsets().as_slice().to_vec(),
            weights_rad: self
                .weights()
                .row_iter()
                .map(|row| row.iter().map(|w| [w.re, w.im]).collect())
                .collect(),
        })
    }

    /// Reads a wave file; numbers come back bit for bit.
    ///
    /// # Errors
    /// When the text is not a wave file, is cut short, of a later version, or its numbers make no wave.
    pub fn from_json(text: &str) -> Result<Self> {
        let file: WaveFile = document::read(text, WAVE, VERSION)?;
        let joints = Joints::new(file.joints)?;
        let harmonics = file.weights_rad.first().map_or(0, Vec::len);
        let rows = &file.weights_rad;
        if rows.len() != joints.len() || rows.iter().any(|r| r.len() != harmonics) {
            return Err(
                Error::new(ErrorKind::Shape, "rows of weights of different lengths")
                    .expected("one row a joint, one pair a harmonic"),
            );
        }
        let weights = DMatrix::from_fn(joints.len(), harmonics, |d, k| {
            let [re, im] = rows[d][k];
            Complex::new(re, im)
        });
        let offsets = DVector::from_vec(file.offsets_rad);
        Self::new(joints, file.period_s, offsets, weights)
    }
}

//! What stands in a model file, entry by entry.

use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

use super::shape;
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::{Interval, Joints};
use crate::primitive::observation::SMALLEST_DEVIATION;
use crate::primitive::{Kronecker, LinearObservation, OffsetForm, PhaseForm};

/// Coefficients of a row are 1, or count harmonics.
const MOST_HARMONICS: f64 = 1e6;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::primitive) struct ModelFile {
    pub(super) format: String,
    pub(super) version: u64,
    pub(super) joints: Vec<String>,
    /// T, where it is common to all waves; else `cycles`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) period_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) cycles: Option<CyclesEntry>,
    pub(super) harmonics: usize,
    pub(super) phases: PhasesEntry,
    /// One a joint: `signed`, `positive` or `negative`.
    pub(super) offsets: Vec<OffsetEntry>,
    /// n numbers in the order of `LogPolar`.
    pub(super) mean: Vec<f64>,
    /// r columns of n numbers each: the covariance is the sum of their outer products, ..
    pub(super) factor: Vec<Vec<f64>>,
    /// .. of Kronecker blocks, ..
    pub(super) blocks: Vec<BlockEntry>,
    /// .. and of what coordinates do alone: index and standard deviation.
    pub(super) independent: Vec<(usize, f64)>,
    pub(super) observations: Vec<ObservationEntry>,
}

/// How many cycles a drawn wave has, and how they follow each other.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CyclesEntry {
    pub count: usize,
    pub amplitude_correlation: f64,
    pub tempo_correlation: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub residual: Option<ResidualEntry>,
}

/// What drawn waves have besides their cycles: the number of the lowest band, and of each the columns of L.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ResidualEntry {
    pub lowest_band: i32,
    pub largest_size_rad: f64,
    pub factors: Vec<Vec<Vec<f64>>>,
}

/// Version 1: principal phases, signed offsets, a factor, and conditioning already worked in.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ModelFile1 {
    #[serde(rename = "format")]
    pub _format: String,
    #[serde(rename = "version")]
    pub _version: u64,
    #[serde(rename = "phases")]
    pub _phases: Principal,
    #[serde(rename = "offsets")]
    pub _offsets: Signed,
    pub joints: Vec<String>,
    pub period_s: f64,
    pub harmonics: usize,
    pub mean: Vec<f64>,
    pub factor: Vec<Vec<f64>>,
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Principal {
    Principal,
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Signed {
    Signed,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "lowercase")]
pub(super) enum PhasesEntry {
    Principal,
    /// D K branch centres \[rad\].
    Recentred {
        centres_rad: Vec<f64>,
    },
    Relative {
        reference: String,
        centres_rad: Vec<f64>,
    },
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum OffsetEntry {
    Signed,
    Positive,
    Negative,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BlockEntry {
    pub start: usize,
    pub correlation: Vec<Vec<f64>>,
    pub decay: f64,
    pub deviations: Vec<f64>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ObservationEntry {
    pub row: Vec<(usize, f64)>,
    pub value: f64,
    pub deviation: f64,
}

impl PhasesEntry {
    pub fn parts(self, joints: &Joints, angles: usize) -> Result<(PhaseForm, usize, Vec<f64>)> {
        let (form, reference, centres) = match self {
            Self::Principal => return Ok((PhaseForm::Principal, 0, vec![0.0; angles])),
            Self::Recentred { centres_rad } => (PhaseForm::Recentred, 0, centres_rad),
            Self::Relative {
                reference,
                centres_rad,
            } => (PhaseForm::Relative, joints.index(&reference)?, centres_rad),
        };
        let turn = Interval::within(std::f64::consts::TAU);
        if centres.len() != angles || centres.iter().any(|c| !turn.contains(*c)) {
            return Err(shape(format!("{} branch centres", centres.len()))
                .expected(format!("{angles} angles, D K of them")));
        }
        Ok((form, reference, centres))
    }
}

impl OffsetEntry {
    pub fn form(self) -> OffsetForm {
        match self {
            Self::Signed => OffsetForm::Signed,
            Self::Positive => OffsetForm::Positive,
            Self::Negative => OffsetForm::Negative,
        }
    }
}

impl BlockEntry {
    pub fn block(self) -> Result<Kronecker> {
        let m = self.correlation.len();
        if self.correlation.iter().any(|row| row.len() != m) {
            return Err(shape("a correlation matrix that is not square".into()));
        }
        let correlation = DMatrix::from_fn(m, m, |i, j| self.correlation[i][j]);
        Kronecker::new(self.start, correlation, self.decay, self.deviations)
    }
}

impl ObservationEntry {
    pub fn observation(self, n: usize) -> Result<LinearObservation> {
        let coefficients = Interval::within(MOST_HARMONICS);
        let within = |(i, c): &(usize, f64)| *i < n && coefficients.contains(*c);
        let size = self
            .row
            .iter()
            .fold(0.0, |size: f64, (_, c)| size.max(c.abs()));
        let is_row = size >= 1.0 && self.row.iter().all(within);
        let deviation = self.deviation == 0.0 || self.deviation >= SMALLEST_DEVIATION;
        if !is_row || !self.value.is_finite() || !self.deviation.is_finite() || !deviation {
            return Err(Error::new(
                ErrorKind::Value,
                "an observation that is none of these coordinates",
            ));
        }
        Ok(LinearObservation {
            row: self.row,
            value: self.value,
            deviation: self.deviation,
        })
    }
}

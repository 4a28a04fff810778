//! The model file: versioned JSON. What is written is what was learned and what was observed since; the rest follows from it, bit for bit.

mod entries;

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use super::observation::MOST_OBSERVATIONS;
use super::{
    ChartForm, Covariance, Cycles, FourierMovementPrimitive, Gaussian, LogPolar, OffsetForm,
    PhaseForm,
};
use crate::document;
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::{Autoregression, CycleResidual, Joints, Wave};
pub(super) use entries::ModelFile;
use entries::{
    BlockEntry, CyclesEntry, ModelFile1, ObservationEntry, OffsetEntry, PhasesEntry, ResidualEntry,
};

/// What the format calls itself.
const MODEL: &str = "undulate model";
/// The version that is written.
const VERSION: u64 = 2;

impl FourierMovementPrimitive {
    /// The model file, version 2.
    pub fn to_json(&self) -> String {
        document::write(&self.to_file())
    }

    pub(super) fn to_file(&self) -> ModelFile {
        let (chart, gaussian) = (&self.chart, &self.gaussian);
        let covariance = gaussian.prior_covariance();
        let centres_rad = chart.phases().centres().to_vec();
        let columns = |m: &DMatrix<f64>| -> Vec<Vec<f64>> {
            m.column_iter()
                .map(|c| c.iter().copied().collect())
                .collect()
        };
        let independent = covariance.independent().iter().copied().enumerate();
        ModelFile {
            format: MODEL.to_owned(),
            version: VERSION,
            joints: chart.joints().iter().cloned().collect(),
            period_s: chart.period(),
            cycles: chart.cycles().map(|cycles| CyclesEntry {
                count: cycles.count(),
                amplitude_correlation: cycles.amplitude().coefficient(),
                tempo_correlation: cycles.tempo().coefficient(),
                residual: cycles.residual().map(|residual| ResidualEntry {
                    lowest_band: residual.lowest(),
                    largest_size_rad: residual.largest(),
                    factors: residual.factors().iter().map(&columns).collect(),
                }),
            }),
            harmonics: chart.harmonics(),
            phases: match (chart.phase_form(), chart.reference()) {
                (PhaseForm::Relative, Some(reference)) => PhasesEntry::Relative {
                    reference: reference.to_owned(),
                    centres_rad,
                },
                (PhaseForm::Recentred, _) => PhasesEntry::Recentred { centres_rad },
                _ => PhasesEntry::Principal,
            },
            offsets: chart
                .offset_forms()
                .iter()
                .map(|form| match form {
                    OffsetForm::Signed => OffsetEntry::Signed,
                    OffsetForm::Positive => OffsetEntry::Positive,
                    OffsetForm::Negative => OffsetEntry::Negative,
                })
                .collect(),
            mean: gaussian.prior_mean().as_slice().to_vec(),
            factor: columns(covariance.factor()),
            blocks: covariance
                .blocks()
                .iter()
                .map(|block| BlockEntry {
                    start: block.start(),
                    correlation: columns(block.correlation()),
                    decay: block.decay(),
                    deviations: block.deviations().to_vec(),
                })
                .collect(),
            independent: independent.filter(|(_, s)| *s > 0.0).collect(),
            observations: gaussian
                .observations()
                .map(|o| ObservationEntry {
                    row: o.row.clone(),
                    value: o.value,
                    deviation: o.deviation,
                })
                .collect(),
        }
    }

    /// Reads a model file of any version; numbers come back bit for bit.
    ///
    /// # Errors
    /// When the text is not a model file, is cut short, of a later version, or its numbers make no primitive.
    pub fn from_json(text: &str) -> Result<Self> {
        if document::version(text, MODEL, VERSION)? == 1 {
            let file: ModelFile1 = document::read(text, MODEL, VERSION)?;
            let entries = (file.joints, file.harmonics, file.mean.len());
            let chart = chart(
                entries,
                Some(file.period_s),
                None,
                OffsetsAndPhases::paper(),
            )?;
            let factor = factor(&file.factor, file.mean.len())?;
            return Self::new(chart, Gaussian::new(DVector::from_vec(file.mean), factor)?);
        }
        Self::from_file(document::read(text, MODEL, VERSION)?)
    }

    /// Of the version that is written.
    pub(super) fn from_file(file: ModelFile) -> Result<Self> {
        if (file.format.as_str(), file.version) != (MODEL, VERSION) {
            let found = format!("`{}` of version {}", file.format, file.version);
            return Err(Error::new(ErrorKind::Syntax, found)
                .expected(format!("`{MODEL}` of version {VERSION}")));
        }
        let n = file.mean.len();
        let entries = (file.joints, file.harmonics, n);
        let forms = OffsetsAndPhases {
            offsets: Some(file.offsets),
            phases: file.phases,
        };
        let chart = chart(entries, file.period_s, file.cycles, forms)?;
        let blocks = file
            .blocks
            .into_iter()
            .map(BlockEntry::block)
            .collect::<Result<_>>()?;
        let mut independent = DVector::zeros(n);
        for (i, s) in file.independent {
            *independent
                .get_mut(i)
                .ok_or_else(|| shape(format!("coordinate {i} of {n}")))? = s;
        }
        let covariance = Covariance::new(factor(&file.factor, n)?, blocks, independent)?;
        let gaussian = Gaussian::structured(DVector::from_vec(file.mean), covariance)?;
        if file.observations.len() > MOST_OBSERVATIONS {
            return Err(shape(format!("{} observations", file.observations.len()))
                .expected(format!("at most {MOST_OBSERVATIONS}")));
        }
        // Before the observations are worked in: they need a sound one.
        let prior = Self::new(chart.clone(), gaussian)?;
        let observations = file
            .observations
            .into_iter()
            .map(|o| o.observation(n))
            .collect::<Result<Vec<_>>>()?;
        let gaussian = prior.gaussian.replay(&observations).map_err(|c| {
            Error::new(
                ErrorKind::Infeasible,
                format!(
                    "observation {} contradicts those before it",
                    c.observation + 1
                ),
            )
        })?;
        Self::new(chart, gaussian)
    }
}

fn shape(what: String) -> Error {
    Error::new(ErrorKind::Shape, what)
}

struct OffsetsAndPhases {
    offsets: Option<Vec<OffsetEntry>>,
    phases: PhasesEntry,
}

impl OffsetsAndPhases {
    fn paper() -> Self {
        Self {
            offsets: None,
            phases: PhasesEntry::Principal,
        }
    }
}

/// The chart of these joints and harmonics, for a mean of so many numbers.
fn chart(
    (names, harmonics, n): (Vec<String>, usize, usize),
    period: Option<f64>,
    cycles: Option<CyclesEntry>,
    forms: OffsetsAndPhases,
) -> Result<LogPolar> {
    let joints = Joints::new(names)?;
    // Before anything of that size is made.
    let angles = harmonics
        .checked_mul(joints.len())
        .filter(|angles| *angles > 0 && *angles <= n / 2)
        .ok_or_else(|| {
            shape(format!(
                "{} joints, {harmonics} harmonics, a mean of {n} numbers",
                joints.len()
            ))
            .expected("2 D K + D numbers in the mean, or 2 D K + 2 D + 3 of cycles")
        })?;
    let period = match (period, &cycles) {
        (Some(period), None) => {
            // Through a wave of zeros, whose constructor checks the period.
            let offsets = DVector::zeros(joints.len());
            let blank = DMatrix::zeros(joints.len(), 0);
            Wave::new(joints.clone(), period, offsets, blank)?.period()
        }
        (None, Some(_)) => 1.0,
        _ => {
            return Err(
                shape("a period and cycles, or neither".into()).expected("`period_s` or `cycles`")
            );
        }
    };
    // What is wrong in a file is no setting of the user's.
    let cycles = cycles
        .map(|entry| {
            let amplitude = Autoregression::new(entry.amplitude_correlation)?;
            let tempo = Autoregression::new(entry.tempo_correlation)?;
            let cycles = Cycles::new(entry.count, harmonics, amplitude, tempo)?;
            let residual = entry.residual.map(|r| residual(&r, joints.len()));
            Ok(Arc::new(match residual.transpose()? {
                Some(residual) => cycles.with_residual(residual),
                None => cycles,
            }))
        })
        .transpose()
        .map_err(|e: Error| Error::new(ErrorKind::Value, e.to_string()))?;
    let offsets: Vec<OffsetForm> = match forms.offsets {
        None => vec![OffsetForm::Signed; joints.len()],
        Some(entries) => entries.into_iter().map(OffsetEntry::form).collect(),
    };
    if offsets.len() != joints.len() {
        return Err(shape(format!("{} forms of offsets", offsets.len())).expected("one a joint"));
    }
    let (phases, reference, centres) = forms.phases.parts(&joints, angles)?;
    let form = ChartForm {
        phases,
        offsets,
        cycles,
    };
    let chart = LogPolar::in_form(joints, (period, harmonics), &form, reference, centres);
    if chart.dimension() != n {
        return Err(shape(format!("a mean of {n} numbers")).expected(format!(
            "{}, 2 D K + D, or of cycles 2 D K + 2 D + 3",
            chart.dimension()
        )));
    }
    Ok(chart)
}

fn residual(entry: &ResidualEntry, joints: usize) -> Result<CycleResidual> {
    let factors = entry.factors.iter().map(|columns| {
        if columns.len() != joints || columns.iter().any(|c| c.len() != joints) {
            return Err(shape("a factor of the residual of another size".into())
                .expected(format!("{joints} columns of {joints}")));
        }
        Ok(DMatrix::from_fn(joints, joints, |i, j| columns[j][i]))
    });
    CycleResidual::new(
        entry.lowest_band,
        factors.collect::<Result<_>>()?,
        entry.largest_size_rad,
    )
}

fn factor(columns: &[Vec<f64>], n: usize) -> Result<DMatrix<f64>> {
    if columns.iter().any(|c| c.len() != n) {
        return Err(shape("a column of the factor of another length".into())
            .expected("2 D K + D numbers in each column"));
    }
    Ok(DMatrix::from_fn(n, columns.len(), |i, j| columns[j][i]))
}

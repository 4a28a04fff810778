//! What is assumed when a primitive is learned.

use super::chart::{OffsetForm, PhaseForm};
use super::scatter::Scatter;
use super::{Estimator, FourierMovementPrimitive, Gaussian, LogPolar};
use crate::demonstration::Demonstrations;
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::{Joints, Wave};

/// How offsets enter the vector.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Offsets {
    /// As they are: the paper's main variant.
    #[default]
    Signed,
    /// The logarithm of their modulus: the paper's other variant, for joints whose offset has one sign in all demonstrations.
    Logarithmic,
    /// Joint by joint, whichever makes the demonstrations more probable.
    ByData,
}

/// How a primitive is learned from waves. The default is what we recommend; [`paper`](Self::paper) is Algorithm 1 to the letter.
///
/// ```
/// use undulate::{Estimator, FourierMovementPrimitive, LearnOptions, synthetic};
///
/// let waves = synthetic(0)?.fit(25)?;
/// let paper = FourierMovementPrimitive::from_waves(&waves, &LearnOptions::paper())?;
/// assert_eq!(paper.gaussian().rank(), 14);
/// let options = LearnOptions { estimator: Estimator::Kronecker { weight: Some(0.4) }, ..LearnOptions::default() };
/// let primitive = FourierMovementPrimitive::from_waves(&waves, &options)?;
/// assert_eq!(primitive.gaussian().rank(), 255);
/// # Ok::<(), undulate::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LearnOptions {
    /// How phases enter the vector.
    pub phases: PhaseForm,
    /// How offsets do.
    pub offsets: Offsets,
    /// How the covariance is estimated.
    pub estimator: Estimator,
    /// Start every wave where the harmonic with most energy over all waves has phase zero, before anything else.
    pub align: bool,
}

impl LearnOptions {
    /// Principal phases, signed offsets, maximum likelihood (Panteris, Manschitz and Calinon, HRI 2020, Algorithm 1).
    pub fn paper() -> Self {
        Self {
            phases: PhaseForm::Principal,
            offsets: Offsets::Signed,
            estimator: Estimator::MaximumLikelihood,
            align: false,
        }
    }

    /// The form of each joint's offset that these options give to `waves`.
    ///
    /// # Errors
    /// When logarithms are asked for, and the offsets of a joint have both signs.
    pub fn offset_forms(&self, waves: &[Wave]) -> Result<Vec<OffsetForm>> {
        OffsetEvidence::of(waves)
            .iter()
            .map(|evidence| match self.offsets {
                Offsets::Signed => Ok(OffsetForm::Signed),
                Offsets::ByData => Ok(evidence.preferred()),
                Offsets::Logarithmic => evidence.logarithmic.ok_or_else(|| {
                    Error::new(
                        ErrorKind::Infeasible,
                        format!(
                            "offsets from {:.1} to {:.1} deg have no common sign: no logarithm",
                            evidence.lowest.to_degrees(),
                            evidence.highest.to_degrees()
                        ),
                    )
                    .expected("one sign in all demonstrations")
                    .help("learn with --offsets signed, or by-data")
                    .at(format!("joint `{}`", evidence.joint))
                }),
            })
            .collect()
    }
}

/// What the waves say of the two variants of a joint's offset.
#[derive(Debug, Clone, PartialEq)]
pub struct OffsetEvidence {
    /// The joint.
    pub joint: String,
    /// The lowest and the highest offset \[rad\].
    pub lowest: f64,
    #[allow(missing_docs)]
    pub highest: f64,
    /// The logarithmic form, if all have one sign.
    pub logarithmic: Option<OffsetForm>,
    /// Log-likelihood of a log-normal fit less that of a normal fit \[nats over all waves\]; 0 where one does not exist.
    pub advantage: f64,
}

impl OffsetEvidence {
    /// Joint by joint.
    pub fn of(waves: &[Wave]) -> Vec<Self> {
        let joints = waves.first().map(|w| w.joints().clone());
        let names = joints.iter().flat_map(Joints::iter);
        names
            .enumerate()
            .map(|(d, joint)| {
                let offsets: Vec<f64> = waves.iter().map(|w| w.offsets()[d]).collect();
                let logarithmic = OffsetForm::logarithmic(&offsets);
                Self {
                    joint: joint.clone(),
                    lowest: offsets.iter().copied().fold(f64::INFINITY, f64::min),
                    highest: offsets.iter().copied().fold(f64::NEG_INFINITY, f64::max),
                    advantage: logarithmic.map_or(0.0, |_| advantage(&offsets)),
                    logarithmic,
                }
            })
            .collect()
    }

    /// The logarithm where it exists and is the more probable, else signed.
    pub fn preferred(&self) -> OffsetForm {
        match self.logarithmic {
            Some(form) if self.advantage > 0.0 => form,
            _ => OffsetForm::Signed,
        }
    }
}

/// The maximised normal log-likelihood is -M (ln sd + const); a log-normal one has the Jacobian -sum ln |o| besides.
fn advantage(offsets: &[f64]) -> f64 {
    let logarithms: Vec<f64> = offsets.iter().map(|o| o.abs().ln()).collect();
    let spread = |values: &[f64]| {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count).sqrt()
    };
    let (plain, logarithmic) = (spread(offsets), spread(&logarithms));
    if plain <= 0.0 || logarithmic <= 0.0 {
        return 0.0;
    }
    let count = offsets.len() as f64;
    count * (plain.ln() - logarithmic.ln()) - logarithms.iter().sum::<f64>()
}

impl FourierMovementPrimitive {
    /// Learns from demonstrations with harmonics 0..=K and the default [`LearnOptions`].
    ///
    /// # Errors
    /// Those of [`Demonstrations::fit`] and [`from_waves`](Self::from_waves).
    pub fn learn(demonstrations: &Demonstrations, harmonics: usize) -> Result<Self> {
        Self::learn_with(demonstrations, harmonics, &LearnOptions::default())
    }

    /// Learns from demonstrations with harmonics 0..=K: least squares, log-polar chart, Gaussian (Algorithm 1).
    ///
    /// # Errors
    /// Those of [`Demonstrations::fit`] and [`from_waves`](Self::from_waves).
    pub fn learn_with(
        demonstrations: &Demonstrations,
        harmonics: usize,
        options: &LearnOptions,
    ) -> Result<Self> {
        Self::from_waves(&demonstrations.fit(harmonics)?, options)
    }

    /// Learns from waves that are fitted already.
    ///
    /// # Errors
    /// When there are fewer than two, they differ in joints, period or harmonics, or the options do not fit them.
    pub fn from_waves(waves: &[Wave], options: &LearnOptions) -> Result<Self> {
        if waves.len() < 2 {
            return Err(
                Error::new(ErrorKind::Shape, format!("{} demonstrations", waves.len()))
                    .expected("at least two"),
            );
        }
        let chart = LogPolar::of(&waves[0]);
        for wave in waves {
            chart.vector(wave)?;
        }
        let aligned;
        let waves = if options.align {
            aligned = super::start::aligned(waves);
            &aligned
        } else {
            waves
        };
        let offsets = options.offset_forms(waves)?;
        if (options.phases, options.estimator)
            == (PhaseForm::Principal, Estimator::MaximumLikelihood)
        {
            // To the letter, and with the fewest columns.
            let chart = chart.with_offsets(offsets);
            let vectors = waves
                .iter()
                .map(|wave| chart.vector(wave))
                .collect::<Result<Vec<_>>>()?;
            return Self::new(chart, Gaussian::maximum_likelihood(&vectors)?);
        }
        let estimator = options.estimator.chosen(waves, options.phases, &offsets)?;
        let scatter = Scatter::of(waves, options.phases, &offsets)?;
        let gaussian = estimator.gaussian(&scatter)?;
        Self::new(scatter.chart, gaussian)
    }
}

//! What is assumed when a primitive is learned.

use std::sync::Arc;

use super::chart::{ChartForm, Cycles, OffsetForm, PhaseForm};
use super::example::Example;
use super::scatter::{Scatter, charted};
use super::{Estimator, FourierMovementPrimitive, Gaussian};
use crate::demonstration::{CycleFits, Demonstrations};
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::{Joints, Wave};

/// A demonstration that counts less than this counts for nothing, and costs a column.
const NO_SHARE: f64 = 1e-9;

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
    /// Start every wave of a common period where the harmonic with most energy over all waves has phase zero, before anything else. (Cycles have their start
    /// as a coordinate.)
    pub align: bool,
    /// Draw waves of cycles with their [`CycleResidual`](crate::CycleResidual) too: what posture sways and joints differ from cycle to cycle on their own. Plain cycles are smoother,
    /// and near what a robot is built for; with it they are near what people do.
    pub residual: bool,
}

impl LearnOptions {
    /// Principal phases, signed offsets, maximum likelihood (Panteris, Manschitz and Calinon, HRI 2020, Algorithm 1).
    pub fn paper() -> Self {
        Self {
            phases: PhaseForm::Principal,
            offsets: Offsets::Signed,
            estimator: Estimator::MaximumLikelihood,
            align: false,
            residual: false,
        }
    }

    /// Fitted demonstrations as these options take them: aligned, if asked for.
    ///
    /// # Errors
    /// When they are to be aligned, and differ in joints or harmonics.
    pub fn examples(&self, waves: &[Wave]) -> Result<Vec<Example>> {
        let examples = waves.iter().map(Example::from).collect();
        if self.align {
            super::start::aligned(examples)
        } else {
            Ok(examples)
        }
    }

    /// The form of the chart that these options give to demonstrations of a common period.
    ///
    /// # Errors
    /// When logarithms are asked for, and the offsets of a joint have both signs.
    pub fn form(&self, examples: &[Example]) -> Result<ChartForm> {
        let offsets = OffsetEvidence::of(examples)
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
            .collect::<Result<_>>()?;
        Ok(ChartForm {
            phases: self.phases,
            offsets,
            cycles: None,
        })
    }

    /// The form of the chart of cycles: `count` of them in a drawn wave, following each other as in `fits`.
    ///
    /// # Errors
    /// Those of [`form`](Self::form), and when there is no cycle, or more than a thousand.
    pub fn form_of_cycles(&self, fits: &CycleFits, count: usize) -> Result<ChartForm> {
        let examples: Vec<Example> = fits.fits().iter().map(Example::from).collect();
        let harmonics = fits.fits().first().map_or(1, |fit| fit.wave.harmonics());
        let mut cycles = Cycles::new(count, harmonics, fits.amplitude(), fits.tempo())?;
        if self.residual {
            cycles = cycles.with_residual(fits.residual().clone());
        }
        Ok(ChartForm {
            cycles: Some(Arc::new(cycles)),
            ..self.form(&examples)?
        })
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
    pub fn of(examples: &[Example]) -> Vec<Self> {
        let joints = examples.first().map(|e| e.wave.joints().clone());
        let names = joints.iter().flat_map(Joints::iter);
        names
            .enumerate()
            .map(|(d, joint)| {
                let offsets: Vec<f64> = examples.iter().map(|e| e.wave.offsets()[d]).collect();
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
        let examples = options.examples(waves)?;
        let form = options.form(&examples)?;
        Self::from_examples(&examples, &form, options.estimator)
    }

    /// Learns from recordings of which each has its own frequency; a drawn wave has `count` cycles.
    ///
    /// # Errors
    /// When there are fewer than two, there is no cycle or more than a thousand, or the options do not fit them.
    pub fn from_cycles(fits: &CycleFits, count: usize, options: &LearnOptions) -> Result<Self> {
        let examples: Vec<Example> = fits.fits().iter().map(Example::from).collect();
        let form = options.form_of_cycles(fits, count)?;
        Self::from_examples(&examples, &form, options.estimator)
    }

    /// Of the form that is given.
    pub(super) fn from_examples(
        examples: &[Example],
        form: &ChartForm,
        estimator: Estimator,
    ) -> Result<Self> {
        Self::from_shares(examples, &vec![1.0; examples.len()], form, estimator)
    }

    /// Learns from demonstrations each of which counts a share of 0 to 1.
    pub(super) fn from_shares(
        examples: &[Example],
        shares: &[f64],
        form: &ChartForm,
        estimator: Estimator,
    ) -> Result<Self> {
        let (examples, shares): (Vec<Example>, Vec<f64>) = examples
            .iter()
            .zip(shares)
            .filter(|(_, share)| **share > NO_SHARE)
            .map(|(example, share)| (example.clone(), *share))
            .unzip();
        let plain =
            (form.phases, estimator) == (PhaseForm::Principal, Estimator::MaximumLikelihood);
        if plain && shares.iter().all(|share| *share == 1.0) {
            // To the letter, and with the fewest columns.
            let (chart, vectors) = charted(&examples, form)?;
            return Self::new(chart, Gaussian::maximum_likelihood(&vectors)?);
        }
        let estimator = estimator.chosen_for(&examples, &shares, form)?;
        let scatter = Scatter::weighted(&examples, &shares, form)?;
        let gaussian = estimator.gaussian(&scatter)?;
        Self::new(scatter.chart, gaussian)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// The log density of all under the normal law that makes them most probable.
    fn normal(values: &[f64]) -> f64 {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count;
        let density = |v: &f64| -0.5 * ((v - mean).powi(2) / variance + (TAU * variance).ln());
        values.iter().map(density).sum()
    }

    #[test]
    fn the_advantage_of_a_logarithm_is_by_how_much_more_probable_the_offsets_are() {
        for offsets in [
            [0.1, 0.2, 0.4, 0.8],
            [-1.0, -1.1, -1.2, -1.3],
            [2.0, 2.1, 2.0, 2.2],
        ] {
            // A density of the offset itself: that of its logarithm, over the offset.
            let logarithms = offsets.map(|o: f64| o.abs().ln());
            let expected = normal(&logarithms) - logarithms.iter().sum::<f64>() - normal(&offsets);
            assert!((advantage(&offsets) - expected).abs() < 1e-9, "{offsets:?}");
        }
    }
}

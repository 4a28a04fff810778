//! [`Posterior`]: waves of a primitive that meet a likelihood, with what says whether the draws may be trusted.

use nalgebra::DVector;

use super::collapsed::Collapsed;
use super::{Target, WeightGradient};
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::Wave;
use crate::posterior::{Diagnostics, EllipticalSlice, Hamiltonian, Schedule, Transition, run};
use crate::primitive::{FourierMovementPrimitive, stream};

/// Draws of a primitive given a likelihood of the wave, by chains that each started on its own.
///
/// What a draw is used for is what to [`diagnose`](Self::diagnose); [`diagnostics`](Self::diagnostics) looks at what most uses depend on.
#[derive(Debug, Clone)]
pub struct Posterior {
    primitive: FourierMovementPrimitive,
    /// Of each chain, of each draw, the latent numbers of the wave.
    latent: Vec<Vec<Vec<f64>>>,
    log_likelihoods: Vec<Vec<f64>>,
    /// What the draws are judged by unless the caller says otherwise.
    targets: Vec<Target>,
}

impl FourierMovementPrimitive {
    /// Waves that meet `targets`, draws from the primitive given them: by slice sampling for a few via-points, by Hamiltonian Monte Carlo else, and
    /// by slice sampling where each wave has its own frequency. Given via-points alone, offsets are integrated out.
    ///
    /// ```
    /// use undulate::posterior::Schedule;
    /// use undulate::{FourierMovementPrimitive, Target, synthetic};
    ///
    /// let primitive = FourierMovementPrimitive::learn(&synthetic(0)?, 12)?;
    /// let target: Target = "elbow_flexion@1.2s=120deg+-2deg".parse()?;
    /// let schedule = Schedule { draws: 200, ..Schedule::default() };
    /// let posterior = primitive.towards(&[target.clone()], &schedule, 7)?;
    /// let reached = target.measure(&posterior.wave(0, 0)?)?.to_degrees();
    /// assert!((reached - 120.0).abs() < 10.0, "{reached}");
    /// println!("{}", posterior.diagnostics()?); // says so if the chains have not mixed
    /// # Ok::<(), undulate::Error>(())
    /// ```
    ///
    /// # Errors
    /// When a target is none of this primitive's joints or its numbers are none, the schedule is out of its range, or no draw of the
    /// primitive comes near enough to start from.
    pub fn towards(&self, targets: &[Target], schedule: &Schedule, seed: u64) -> Result<Posterior> {
        let joints: Vec<usize> = targets
            .iter()
            .map(|target| target.joint(self.chart().joints()))
            .collect::<Result<_>>()?;
        if let Some(period) = self.chart().period() {
            let blank = self.mean_wave();
            for target in targets {
                target.check_band(&blank).map_err(|e| {
                    let highest = self.chart().harmonics() as f64 / period;
                    e.expected(format!(
                        "a band within {:.3} to {highest:.3} Hz",
                        1.0 / period
                    ))
                })?;
            }
        }
        let mut posterior = if let Some(collapsed) = Collapsed::of(self, targets) {
            collapsed.posterior(schedule, seed)?
        } else if self.chart().cycles().is_some() {
            let log_likelihood = |wave: &Wave| {
                let each = targets.iter().zip(&joints);
                each.map(|(target, joint)| target.log_likelihood(wave, *joint))
                    .sum()
            };
            self.posterior(log_likelihood, schedule, seed)?
        } else {
            let log_likelihood = |wave: &Wave, gradient: &mut WeightGradient| {
                let each = targets.iter().zip(&joints);
                each.map(|(target, joint)| target.with_gradient(wave, *joint, gradient))
                    .sum()
            };
            self.posterior_by_gradient(log_likelihood, schedule, seed)?
        };
        posterior.targets = targets.to_vec();
        Ok(posterior)
    }

    /// The primitive given any log-likelihood of a wave, by elliptical slice sampling (Murray, Adams and MacKay 2010) over the standard normal numbers
    /// of a draw. Minus infinity says that a wave is impossible; chain c has the random numbers of `stream(seed, c)`.
    ///
    /// # Errors
    /// When the log-likelihood is NaN or plus infinity, a thousand draws of the primitive are all impossible, or the schedule is out of its range.
    pub fn posterior(
        &self,
        mut log_likelihood: impl FnMut(&Wave) -> f64,
        schedule: &Schedule,
        seed: u64,
    ) -> Result<Posterior> {
        let mut spare = vec![0.0; self.latent()];
        let transition = EllipticalSlice::new(self.latent(), |z: &DVector<f64>| {
            spare.copy_from_slice(z.as_slice());
            log_likelihood(&self.wave_at(&mut spare))
        });
        self.chains(transition, schedule, seed)
    }

    /// The same for a log-likelihood that adds its gradient in the weights to its second argument, which is zero when it is called: by Hamiltonian
    /// Monte Carlo, which pays where many things are observed, or tightly.
    ///
    /// The amplitude of a band of frequencies, which no single modulus tells:
    ///
    /// ```
    /// use undulate::posterior::Schedule;
    /// use undulate::{FourierMovementPrimitive, Wave, WeightGradient, synthetic};
    ///
    /// let primitive = FourierMovementPrimitive::learn(&synthetic(0)?, 25)?;
    /// let (elbow, band) = (3, 8..=12);
    /// let amplitude = |wave: &Wave| -> f64 {
    ///     2.0 * band.clone().map(|k| wave.weights()[(elbow, k - 1)].norm_sqr()).sum::<f64>().sqrt()
    /// };
    /// let (aim, deviation) = (10f64.to_radians(), 1f64.to_radians());
    /// let log_likelihood = |wave: &Wave, gradient: &mut WeightGradient| {
    ///     let found = amplitude(wave);
    ///     let residual = (aim - found) / deviation;
    ///     for k in band.clone() {
    ///         let weight = wave.weights()[(elbow, k - 1)];
    ///         gradient.weights[(elbow, k - 1)] += weight * (4.0 * residual / (deviation * found));
    ///     }
    ///     -0.5 * residual * residual
    /// };
    /// let schedule = Schedule { draws: 200, ..Schedule::default() };
    /// let posterior = primitive.posterior_by_gradient(log_likelihood, &schedule, 7)?;
    /// let wave = posterior.wave(0, 199)?;
    /// assert!((amplitude(&wave) - aim).abs() < 5.0 * deviation);
    /// # Ok::<(), undulate::Error>(())
    /// ```
    ///
    /// # Errors
    /// Those of [`posterior`](Self::posterior), when a gradient is not finite, or each wave has its own frequency.
    pub fn posterior_by_gradient(
        &self,
        mut log_likelihood: impl FnMut(&Wave, &mut WeightGradient) -> f64,
        schedule: &Schedule,
        seed: u64,
    ) -> Result<Posterior> {
        let chart = self.chart();
        if chart.cycles().is_some() {
            return Err(Error::new(
                ErrorKind::Unsupported,
                "gradients through waves that each have their own frequency",
            )
            .expected("a model learned with --period common, or a likelihood without a gradient"));
        }
        let mut spare = vec![0.0; self.latent()];
        let mut slope = WeightGradient::zeros(chart.joints().len(), chart.harmonics());
        let transition = Hamiltonian::new(self.latent(), |z: &[f64], gradient: &mut [f64]| {
            spare.copy_from_slice(z);
            let wave = self.wave_at(&mut spare);
            slope.clear();
            let value = log_likelihood(&wave, &mut slope);
            if !slope.is_of(chart) {
                // A gradient of other waves: told as the number that it is not.
                slope = WeightGradient::zeros(chart.joints().len(), chart.harmonics());
                return f64::NAN;
            }
            gradient.copy_from_slice(&slope.latent(self, &wave));
            value
        });
        self.chains(transition, schedule, seed)
    }

    fn chains(
        &self,
        mut transition: impl Transition,
        schedule: &Schedule,
        seed: u64,
    ) -> Result<Posterior> {
        let draws = run(&mut transition, schedule, |chain| stream(seed, chain))?;
        let chains = draws.chains().iter();
        let latent = chains
            .clone()
            .map(|c| c.z().column_iter().map(|z| z.as_slice().to_vec()).collect())
            .collect();
        let log_likelihoods = chains.map(|c| c.log_likelihoods().to_vec()).collect();
        Ok(Posterior::new(self, latent, log_likelihoods))
    }
}

impl Posterior {
    pub(super) fn new(
        primitive: &FourierMovementPrimitive,
        latent: Vec<Vec<Vec<f64>>>,
        log_likelihoods: Vec<Vec<f64>>,
    ) -> Self {
        Self {
            primitive: primitive.clone(),
            latent,
            log_likelihoods,
            targets: Vec::new(),
        }
    }

    /// How many chains there are.
    pub fn chains(&self) -> usize {
        self.latent.len()
    }

    /// How many draws each chain has.
    pub fn draws(&self) -> usize {
        self.latent.first().map_or(0, Vec::len)
    }

    /// Draw number `draw` of chain `chain`.
    ///
    /// # Errors
    /// When there is no such draw.
    pub fn wave(&self, chain: usize, draw: usize) -> Result<Wave> {
        let latent = self.latent.get(chain).and_then(|draws| draws.get(draw));
        let latent = latent.ok_or_else(|| {
            Error::new(ErrorKind::Setting, format!("draw {draw} of chain {chain}")).expected(
                format!("{} draws of {} chains", self.draws(), self.chains()),
            )
        })?;
        Ok(self.primitive.wave_at(&mut latent.clone()))
    }

    /// A scalar of each draw, a series for each chain.
    pub fn series(&self, mut statistic: impl FnMut(&Wave) -> f64) -> Vec<Vec<f64>> {
        let mut of = |latent: &Vec<f64>| statistic(&self.primitive.wave_at(&mut latent.clone()));
        self.latent
            .iter()
            .map(|draws| draws.iter().map(&mut of).collect())
            .collect()
    }

    /// R-hat and effective sample sizes of a statistic of the waves (Vehtari et al. 2021).
    ///
    /// # Errors
    /// When the statistic of a draw is not finite.
    pub fn diagnose(&self, statistic: impl FnMut(&Wave) -> f64) -> Result<Diagnostics> {
        Diagnostics::of(&self.series(statistic))
    }

    /// The worst of the log-likelihood, of what the targets aim at, and of the size (logarithm of the energy) and the offset of every joint; what is the same in all
    /// draws has nothing to show. Draws that have not mixed say so ([`Diagnostics::mixed`]).
    ///
    /// # Errors
    /// When there are too few draws.
    pub fn diagnostics(&self) -> Result<Diagnostics> {
        let joints = self.primitive.chart().joints();
        let targets = self
            .targets
            .iter()
            .map(|target| Ok((target, target.joint(joints)?)))
            .collect::<Result<Vec<_>>>()?;
        let statistics = |wave: &Wave| -> Vec<f64> {
            let energies = wave.weights().row_iter().map(|row| row.norm_squared());
            let sizes = energies.map(|e| e.max(f64::MIN_POSITIVE).ln());
            let offsets = wave.offsets().iter().copied();
            let aims = targets.iter().map(|(target, d)| target.value(wave, *d));
            sizes.chain(offsets).chain(aims).collect()
        };
        let mut series = vec![vec![Vec::new(); self.chains()]; 2 * joints.len() + targets.len()];
        for (chain, draws) in self.latent.iter().enumerate() {
            for latent in draws {
                let wave = self.primitive.wave_at(&mut latent.clone());
                for (series, value) in series.iter_mut().zip(statistics(&wave)) {
                    series[chain].push(value);
                }
            }
        }
        let first = Diagnostics::of(&series[0])?;
        series
            .iter()
            .chain([&self.log_likelihoods])
            .try_fold(first, |worst, series| judged(worst, series))
    }
}

/// The worse of both, unless the series never changes.
fn judged(worst: Diagnostics, series: &[Vec<f64>]) -> Result<Diagnostics> {
    let mut values = series.iter().flatten();
    let first = values.next();
    if values.all(|v| Some(v) == first) {
        return Ok(worst);
    }
    Ok(worst.worse(&Diagnostics::of(series)?))
}

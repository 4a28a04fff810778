//! Where drawn waves come from: a primitive or a mixture, or the posterior of a primitive given targets.

use rand::distr::Distribution;
use serde_json::{Value, json};

use super::{Model, output};
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::Wave;
use crate::posterior::{Diagnostics, Schedule};
use crate::primitive::{Posterior, Start, Target, stream};

/// Standard deviations of a target that the draws may be off on average before that is worth a word.
const MISSED: f64 = 2.0;

/// Waves by number.
pub(super) struct Source {
    model: Model,
    posterior: Option<(Posterior, Diagnostics)>,
    /// Of each target, as text, mean and standard deviation of what the draws reach \[rad\].
    reached: Vec<(String, f64, f64)>,
    seed: u64,
    start: Start,
}

impl Source {
    /// Runs the chains where there are targets.
    pub fn new(model: Model, targets: &[Target], seed: u64, start: Start) -> Result<Self> {
        if targets.is_empty() {
            return Ok(Self {
                model,
                posterior: None,
                reached: Vec::new(),
                seed,
                start,
            });
        }
        if start != Start::Kept {
            return Err(Error::new(
                ErrorKind::Setting,
                "--start with --towards: another start moves what was aimed at",
            )
            .expected("one of the two"));
        }
        let primitive = model.one()?;
        let bar = output::progress(1, "following chains");
        let schedule = Schedule {
            warm_up: 1000,
            draws: 3000,
            ..Schedule::default()
        };
        let posterior = primitive.towards(targets, &schedule, seed)?;
        bar.finish_and_clear();
        let diagnostics = posterior.diagnostics()?;
        if !diagnostics.mixed() {
            return Err(Error::new(
                ErrorKind::Infeasible,
                format!("the chains have not mixed, and their draws are none of the posterior: {diagnostics}"),
            )
            .expected("targets that the demonstrations come near")
            .help("aim at less, or with larger standard deviations (`+-5deg`)"));
        }
        let mut reached = Vec::new();
        for target in targets {
            target.measure(&posterior.wave(0, 0)?)?;
            let values = posterior
                .series(|wave| target.measure(wave).unwrap_or(f64::NAN))
                .concat();
            let count = values.len() as f64;
            let mean = values.iter().sum::<f64>() / count;
            let square = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count;
            let (aim, deviation) = target.aim();
            let told = format!(
                "towards {target}: drawn {} +- {} deg",
                output::degrees(mean),
                output::degrees(square.sqrt())
            );
            if (mean - aim).abs() > MISSED * deviation {
                output::warn(format!(
                    "{told}, and so missed: it contradicts what else is asked, or lies far from what was demonstrated"
                ));
            } else {
                output::note(told);
            }
            reached.push((target.to_string(), mean, square.sqrt()));
        }
        Ok(Self {
            model: Model::One(Box::new(primitive)),
            posterior: Some((posterior, diagnostics)),
            reached,
            seed,
            start,
        })
    }

    /// Wave number `index`: of a posterior, from its chains in turn, as far apart in each as the draws allow.
    pub fn wave(&self, index: u64) -> Result<Wave> {
        let Some((posterior, _)) = &self.posterior else {
            let mut rng = stream(self.seed, index);
            let wave = self.model.sample(&mut rng);
            return Ok(self.start.apply(&wave, &mut rng));
        };
        let (chains, draws) = (posterior.chains() as u64, posterior.draws() as u64);
        if index >= chains * draws {
            return Err(Error::new(
                ErrorKind::Infeasible,
                format!(
                    "all {} draws towards the targets are used up",
                    chains * draws
                ),
            )
            .expected("draws that can be used")
            .help("aim at what the robot can do, or widen --within"));
        }
        let draw = spread(index / chains, draws);
        posterior.wave((index % chains) as usize, draw as usize)
    }

    /// What the chains came to.
    pub fn diagnostics(&self) -> Option<&Diagnostics> {
        self.posterior.as_ref().map(|(_, diagnostics)| diagnostics)
    }

    pub fn reached_json(&self) -> Value {
        self.reached
            .iter()
            .map(|(target, mean, deviation)| {
                json!({"target": target, "mean_rad": mean, "standard_deviation_rad": deviation})
            })
            .collect()
    }

    pub fn diagnostics_json(&self) -> Value {
        self.diagnostics().map_or(Value::Null, |d| {
            json!({
                "r_hat": d.r_hat(),
                "bulk_ess": d.bulk_ess(),
                "tail_ess": d.tail_ess(),
                "mixed": d.mixed(),
            })
        })
    }
}

/// Number `i` of `n`, every number once and neighbours far apart: multiplication by a number without a factor in common with n.
fn spread(i: u64, n: u64) -> u64 {
    let common = |mut a: u64, mut b: u64| {
        while b > 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    // Near the golden section of n.
    let mut step = (n as f64 * 0.618) as u64;
    while common(step.max(1), n) > 1 {
        step += 1;
    }
    (i * step.max(1)) % n
}

#[cfg(test)]
mod tests {
    #[test]
    fn every_number_comes_once() {
        for n in [1, 2, 7, 1000] {
            let mut seen: Vec<u64> = (0..n).map(|i| super::spread(i, n)).collect();
            seen.sort_unstable();
            assert_eq!(seen, (0..n).collect::<Vec<_>>());
        }
    }
}

//! Where drawn waves come from: a primitive, or its posterior given targets.

use rand::distr::Distribution;
use serde_json::{Value, json};

use super::output;
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::Wave;
use crate::posterior::{Diagnostics, Schedule};
use crate::primitive::{FourierMovementPrimitive, Posterior, Start, Target, stream};

/// Waves by number.
pub(super) struct Source {
    primitive: FourierMovementPrimitive,
    posterior: Option<(Posterior, Diagnostics)>,
    seed: u64,
    start: Start,
}

impl Source {
    /// Runs the chains where there are targets, and says so if they have not mixed.
    pub fn new(
        primitive: FourierMovementPrimitive,
        targets: &[Target],
        seed: u64,
        start: Start,
    ) -> Result<Self> {
        if targets.is_empty() {
            return Ok(Self {
                primitive,
                posterior: None,
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
        let bar = output::progress(1, "following chains");
        let posterior = primitive.towards(targets, &Schedule::default(), seed)?;
        bar.finish_and_clear();
        let diagnostics = posterior.diagnostics()?;
        if !diagnostics.mixed() {
            output::warn(format!(
                "the chains have NOT mixed ({diagnostics}): these draws are not to be trusted; ask for less, or with larger standard deviations"
            ));
        }
        for target in targets {
            output::note(format!("towards {target}"));
        }
        Ok(Self {
            primitive,
            posterior: Some((posterior, diagnostics)),
            seed,
            start,
        })
    }

    /// Wave number `index`: of a posterior, from its chains in turn, as far apart in each as the draws allow.
    pub fn wave(&self, index: u64) -> Result<Wave> {
        let Some((posterior, _)) = &self.posterior else {
            let mut rng = stream(self.seed, index);
            let wave = self.primitive.sample(&mut rng);
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

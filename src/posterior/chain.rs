//! [`run`]: several chains of one transition, from draws of the prior, with diagnostics.

use nalgebra::DMatrix;
use rand::Rng;

use super::{Diagnostics, Transition};
use crate::error::{Error, ErrorKind, Result};
use crate::normal;

/// Fewer chains cannot tell a posterior from the place they started at (Vehtari et al. 2021, section 4.1).
const LEAST_CHAINS: usize = 4;

/// Fewer draws a chain are too few for its halves to have autocorrelations.
const LEAST_DRAWS: usize = 4;

/// Draws of the prior that are tried as a start before the likelihood counts as zero everywhere.
const MOST_STARTS: usize = 1000;

/// Numbers that fit into memory, in all: 8 GB.
const MOST_NUMBERS: f64 = 1e9;

/// How many chains of what length.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Schedule {
    /// Number of chains; 4 by default, which is also the least.
    pub chains: usize,
    /// Transitions before the first draw is kept, in which a sampler adapts; 500 by default.
    pub warm_up: usize,
    /// Draws kept of each chain; 1000 by default, at least 4.
    pub draws: usize,
    /// Transitions for each draw that is kept; 1 by default.
    pub thinning: usize,
}

impl Default for Schedule {
    fn default() -> Self {
        Self {
            chains: LEAST_CHAINS,
            warm_up: 500,
            draws: 1000,
            thinning: 1,
        }
    }
}

impl Schedule {
    fn check(&self, dimension: usize) -> Result<()> {
        let least = |name: &str, found: usize, least: usize| {
            if found < least {
                return Err(Error::new(ErrorKind::Setting, format!("{found} {name}"))
                    .expected(format!("at least {least}")));
            }
            Ok(())
        };
        least("chains", self.chains, LEAST_CHAINS)?;
        least("draws a chain", self.draws, LEAST_DRAWS)?;
        least("transitions a draw", self.thinning, 1)?;
        let numbers = self.chains as f64 * self.draws as f64 * (dimension as f64 + 1.0);
        if numbers > MOST_NUMBERS {
            return Err(Error::new(
                ErrorKind::Setting,
                format!(
                    "{} chains of {} draws in {dimension} dimensions, {numbers:.1e} numbers",
                    self.chains, self.draws
                ),
            )
            .expected(format!("at most {MOST_NUMBERS:.0e} numbers"))
            .help("thin the chains"));
        }
        Ok(())
    }
}

/// What transitions cost.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Effort {
    /// Transitions made.
    pub transitions: u64,
    /// Evaluations of the log-likelihood, with its gradient where the sampler uses one.
    pub evaluations: u64,
    /// Sum of the transitions' acceptance probabilities; of Hamiltonian ones, those of their first trajectories.
    pub acceptance_sum: f64,
    /// Trajectories that lost the energy: where they do so often, the draws avoid a region that the target does not.
    pub divergent: u64,
}

impl Effort {
    /// Mean acceptance probability; 0 when there was no transition.
    pub fn acceptance(&self) -> f64 {
        self.acceptance_sum / (self.transitions as f64).max(1.0)
    }

    fn since(&self, earlier: &Self) -> Self {
        Self {
            transitions: self.transitions - earlier.transitions,
            evaluations: self.evaluations - earlier.evaluations,
            acceptance_sum: self.acceptance_sum - earlier.acceptance_sum,
            divergent: self.divergent - earlier.divergent,
        }
    }
}

/// One chain after its warm-up.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    z: DMatrix<f64>,
    log_likelihoods: Vec<f64>,
    effort: Effort,
}

impl Chain {
    /// The draws z (n x draws), a column each, in the order of the chain.
    pub fn z(&self) -> &DMatrix<f64> {
        &self.z
    }

    /// L of each draw.
    pub fn log_likelihoods(&self) -> &[f64] {
        &self.log_likelihoods
    }

    /// What the draws cost, without the warm-up.
    pub fn effort(&self) -> &Effort {
        &self.effort
    }
}

/// Draws of several chains of equal length.
#[derive(Debug, Clone, PartialEq)]
pub struct Draws {
    chains: Vec<Chain>,
}

impl Draws {
    /// The chains, at least four.
    pub fn chains(&self) -> &[Chain] {
        &self.chains
    }

    /// A scalar of each draw: one series a chain, in its order.
    pub fn series(&self, mut statistic: impl FnMut(&[f64]) -> f64) -> Vec<Vec<f64>> {
        let of = |chain: &Chain| {
            let columns = chain.z.column_iter();
            columns.map(|z| statistic(z.as_slice())).collect()
        };
        self.chains.iter().map(of).collect()
    }

    /// Have the chains mixed, as far as `statistic` shows? What a draw is used for is the statistic to ask for: a
    /// position at a via-point, a peak.
    ///
    /// # Errors
    /// When the statistic of a draw is not finite.
    pub fn diagnose(&self, statistic: impl FnMut(&[f64]) -> f64) -> Result<Diagnostics> {
        Diagnostics::of(&self.series(statistic))
    }

    /// Have the chains mixed? The worst of the log-likelihood and of every latent coordinate; of the order of a
    /// millisecond for each.
    ///
    /// # Errors
    /// None for draws that [`run`] made.
    pub fn diagnostics(&self) -> Result<Diagnostics> {
        let series: Vec<&[f64]> = self.chains.iter().map(Chain::log_likelihoods).collect();
        let mut worst = Diagnostics::of(&series)?;
        // A likelihood that is flat has no series to judge: constant, and rightly so.
        if series.concat().iter().all(|l| *l == series[0][0]) {
            worst = self.diagnose(|z| crate::vectors::dot(z, z))?;
        }
        for i in 0..self.chains[0].z.nrows() {
            worst = worst.worse(&self.diagnose(|z| z[i])?);
        }
        Ok(worst)
    }
}

/// Runs `schedule.chains` chains of `transition`, one after the other, chain c with the random numbers of `stream(c)` alone: the
/// same chain whatever the others are. Each starts from the first draw of the prior N(0, I) that has positive
/// likelihood, which is wider than the posterior, as R-hat wants it.
///
/// # Errors
/// When the schedule is out of its range, none of 1000 draws of the prior has positive likelihood, or the likelihood
/// or its gradient is no number.
pub fn run<T: Transition, R: Rng>(
    transition: &mut T,
    schedule: &Schedule,
    mut stream: impl FnMut(u64) -> R,
) -> Result<Draws> {
    schedule.check(transition.dimension())?;
    let mut chains = Vec::with_capacity(schedule.chains);
    for c in 0..schedule.chains {
        let mut rng = stream(c as u64);
        let chain = run_one(transition, schedule, &mut rng);
        chains.push(chain.map_err(|e| e.at(format!("chain {c}")))?);
    }
    Ok(Draws { chains })
}

fn run_one<T: Transition, R: Rng>(
    transition: &mut T,
    schedule: &Schedule,
    rng: &mut R,
) -> Result<Chain> {
    start(transition, rng).map_err(|e| e.at("start"))?;
    for done in 0..schedule.warm_up {
        let step = transition.step(rng);
        step.map_err(|e| e.at(format!("warm-up transition {done}")))?;
        transition.adapt(done, schedule.warm_up);
    }
    let before = transition.effort();
    let mut z = DMatrix::zeros(transition.dimension(), schedule.draws);
    let mut log_likelihoods = Vec::with_capacity(schedule.draws);
    for draw in 0..schedule.draws {
        for _ in 0..schedule.thinning {
            let step = transition.step(rng);
            step.map_err(|e| e.at(format!("draw {draw}")))?;
        }
        let mut column = z.column_mut(draw);
        column.as_mut_slice().copy_from_slice(transition.position());
        log_likelihoods.push(transition.log_likelihood());
    }
    Ok(Chain {
        z,
        log_likelihoods,
        effort: transition.effort().since(&before),
    })
}

fn start<T: Transition, R: Rng>(transition: &mut T, rng: &mut R) -> Result<()> {
    let mut z = vec![0.0; transition.dimension()];
    for _ in 0..MOST_STARTS {
        normal::fill(rng, &mut z);
        if transition.start(&z)? {
            return Ok(());
        }
    }
    Err(Error::new(
        ErrorKind::Infeasible,
        format!("impossible: none of {MOST_STARTS} draws of the prior has positive likelihood"),
    )
    .help("widen the conditions, or give log-likelihoods that say how far off a draw is"))
}

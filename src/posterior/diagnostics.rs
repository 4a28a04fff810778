//! [`Diagnostics`]: have the chains mixed, and how many independent draws are theirs worth?

use std::fmt;

use super::effective::{effective_sample_size, potential_scale_reduction};
use super::rank::normal_scores;
use crate::error::{Error, ErrorKind, Result};

/// Chains that mixed have an R-hat below this (Vehtari et al. 2021, section 4.3) ..
const HIGHEST_R_HAT: f64 = 1.01;

/// .. and effective samples of at least this number a chain: with fewer, R-hat itself is not to be trusted (the same).
const LEAST_ESS: f64 = 100.0;

/// Fewer draws a chain have no halves with an autocorrelation.
const LEAST_DRAWS: usize = 4;

/// The quantiles whose effective sample size is the tails'.
const TAILS: [f64; 2] = [0.05, 0.95];

/// Convergence of a scalar over several chains: Vehtari, Gelman, Simpson, Carpenter and Buerkner, "Rank-normalization,
/// folding, and localization: an improved R-hat for assessing convergence of MCMC", Bayesian Analysis 16(2), 2021.
///
/// ```
/// use undulate::Diagnostics;
///
/// // Two chains that stay where they started.
/// let near = |place: f64| (0..100).map(move |i| place + f64::from(i * 37 % 100) * 1e-3).collect::<Vec<_>>();
/// let diagnostics = Diagnostics::of(&[near(0.0), near(1.0)])?;
/// assert!(!diagnostics.mixed());
/// assert!(diagnostics.to_string().contains("NOT MIXED"));
/// # Ok::<(), undulate::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Diagnostics {
    r_hat: f64,
    bulk_ess: f64,
    tail_ess: f64,
    chains: usize,
    draws: usize,
}

impl Diagnostics {
    /// Of one series a chain, at least two chains of equal length of at least four. Chains are halved, so that one that
    /// drifts disagrees with itself; of an odd number of draws the middle one is left out.
    ///
    /// # Errors
    /// When there are fewer, the lengths differ, or a number is not finite.
    pub fn of<S: AsRef<[f64]>>(chains: &[S]) -> Result<Self> {
        let draws = chains.first().map_or(0, |chain| chain.as_ref().len());
        if chains.len() < 2 || draws < LEAST_DRAWS {
            return Err(Error::new(
                ErrorKind::Shape,
                format!("{} chains of {draws} draws", chains.len()),
            )
            .expected(format!(
                "at least two chains of at least {LEAST_DRAWS} draws"
            )));
        }
        for (c, chain) in chains.iter().enumerate() {
            let chain = chain.as_ref();
            if chain.len() != draws {
                return Err(
                    Error::new(ErrorKind::Shape, format!("{} draws", chain.len()))
                        .expected(format!("{draws}, as in the first chain"))
                        .at(format!("chain {c}")),
                );
            }
            if let Some(i) = chain.iter().position(|x| !x.is_finite()) {
                return Err(
                    Error::new(ErrorKind::Value, format!("statistic is {}", chain[i]))
                        .expected("a finite number")
                        .at(format!("draw {i}"))
                        .at(format!("chain {c}")),
                );
            }
        }
        let half = draws / 2;
        let halves = |value: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let both = chains.iter().flat_map(|chain| {
                let chain = chain.as_ref();
                chain[..half].iter().chain(&chain[draws - half..])
            });
            both.map(|x| value(*x)).collect()
        };
        let split = |values: Vec<f64>| -> Vec<Vec<f64>> {
            values.chunks(half).map(<[f64]>::to_vec).collect()
        };
        let kept = halves(&|x| x);
        let middle = quantile(&sorted(kept.iter().copied()), 0.5);
        let ranked = split(normal_scores(&kept));
        let folded = split(normal_scores(&halves(&|x| (x - middle).abs())));
        let all = sorted(chains.iter().flat_map(|c| c.as_ref().iter().copied()));
        let tail = TAILS.map(|p| {
            let bound = quantile(&all, p);
            effective_sample_size(&split(halves(&|x| f64::from(u8::from(x <= bound)))))
        });
        let r_hats = [&ranked, &folded].map(|halves| potential_scale_reduction(halves));
        Ok(Self {
            // `max` would forget that one of them is not a number.
            r_hat: if r_hats[0].is_nan() || r_hats[0] > r_hats[1] {
                r_hats[0]
            } else {
                r_hats[1]
            },
            bulk_ess: effective_sample_size(&ranked),
            tail_ess: tail[0].min(tail[1]),
            chains: chains.len(),
            draws,
        })
    }

    /// Rank-normalised split R-hat, the larger of the one for the location and the one for the scale (folded): 1 when the
    /// chains agree. Not a number when the statistic is the same in all draws, without bound when it is in each chain.
    pub fn r_hat(&self) -> f64 {
        self.r_hat
    }

    /// Independent draws that would give the statistic's centre as well.
    pub fn bulk_ess(&self) -> f64 {
        self.bulk_ess
    }

    /// Independent draws that would give its 5 % and 95 % quantiles as well, the worse of the two.
    pub fn tail_ess(&self) -> f64 {
        self.tail_ess
    }

    /// Number of chains.
    pub fn chains(&self) -> usize {
        self.chains
    }

    /// Number of draws of each chain.
    pub fn draws(&self) -> usize {
        self.draws
    }

    /// Whether the draws may be used as draws of the posterior: R-hat below 1.01, and bulk and tail effective sample sizes of
    /// at least 100 a chain. A statistic that is the same in all draws has shown nothing: not mixed.
    pub fn mixed(&self) -> bool {
        let least = LEAST_ESS * self.chains as f64;
        self.r_hat < HIGHEST_R_HAT && self.bulk_ess >= least && self.tail_ess >= least
    }

    /// The worse of both in each respect, for several statistics of the same draws.
    #[must_use]
    pub fn worse(&self, other: &Self) -> Self {
        let worse = |a: f64, b: f64, is_worse: bool| if a.is_nan() || is_worse { a } else { b };
        Self {
            r_hat: worse(self.r_hat, other.r_hat, self.r_hat > other.r_hat),
            bulk_ess: worse(
                self.bulk_ess,
                other.bulk_ess,
                self.bulk_ess < other.bulk_ess,
            ),
            tail_ess: worse(
                self.tail_ess,
                other.tail_ess,
                self.tail_ess < other.tail_ess,
            ),
            chains: self.chains,
            draws: self.draws.min(other.draws),
        }
    }
}

/// A line for people; it says so when the chains have not mixed.
impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "R-hat {:.3}, effective samples {:.0} (bulk) and {:.0} (tail) of {} x {} draws",
            self.r_hat, self.bulk_ess, self.tail_ess, self.chains, self.draws
        )?;
        if !self.mixed() {
            write!(
                f,
                ": NOT MIXED, not to be used as draws of the posterior (R-hat must be below {HIGHEST_R_HAT}, both effective samples at least {:.0})",
                LEAST_ESS * self.chains as f64
            )?;
        }
        Ok(())
    }
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Quantile `p` of sorted values, between them linearly (type 7 of Hyndman and Fan 1996).
fn quantile(sorted: &[f64], p: f64) -> f64 {
    let n = sorted.len() as f64;
    let place = n * p + (1.0 - p);
    let below = place.clamp(1.0, n - 1.0).floor();
    let share = (place - below).clamp(0.0, 1.0);
    let at = below as usize;
    (1.0 - share) * sorted[at - 1] + share * sorted[at]
}

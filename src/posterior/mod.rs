//! Markov chains for a target over standard normal latent vectors:
//!
//! ```text
//! pi(z) ~ N(z; 0, I_n) exp(L(z)),   z in R^n, L the log-likelihood, up to a constant
//! ```
//!
//! | sampler | needs | suits |
//! |---|---|---|
//! | [`EllipticalSlice`] | L | likelihoods without a gradient, weak or of few dimensions; nothing to tune |
//! | [`Hamiltonian`] | L and its gradient | tight observations: a few directions narrow, all others as the prior has them |
//!
//! Both move along the ellipses on which the prior is constant in energy, so neither slows down with n as such; what slows
//! them down is how much narrower than the prior the likelihood is. [`run`] makes several chains of either, from draws of
//! the prior, and its [`Draws`] carry [`Diagnostics`]: draws of chains that have not mixed say so.
//!
//! ```
//! use undulate::posterior::{Hamiltonian, Schedule, run};
//! use undulate::stream;
//!
//! // z_0 + z_1 was observed to be 2, with standard deviation 0.1.
//! let mut transition = Hamiltonian::new(2, |z: &[f64], gradient: &mut [f64]| {
//!     let residual = (2.0 - z[0] - z[1]) / 0.1;
//!     gradient.fill(residual / 0.1);
//!     -0.5 * residual * residual
//! });
//! let draws = run(&mut transition, &Schedule::default(), |chain| stream(7, chain))?;
//! let sum = draws.series(|z| z[0] + z[1]);
//! assert!(draws.diagnostics()?.mixed());
//! let mean = sum.concat().iter().sum::<f64>() / 4000.0;
//! assert!((mean - 2.0 / (1.0 + 0.1 * 0.1 / 2.0)).abs() < 0.02);
//! # Ok::<(), undulate::Error>(())
//! ```

mod chain;
mod diagnostics;
mod effective;
mod elliptical;
mod hamiltonian;
mod options;
mod rank;
mod reference;
mod step_size;

use rand::Rng;

pub use chain::{Chain, Draws, Effort, Schedule, run};
pub use diagnostics::Diagnostics;
pub use elliptical::EllipticalSlice;
pub use hamiltonian::Hamiltonian;
pub use options::HamiltonianOptions;

use crate::error::{Error, ErrorKind, Result};

/// A Markov transition that leaves N(z; 0, I_n) exp(L(z)) as it is, with the state it is in.
pub trait Transition {
    /// n.
    fn dimension(&self) -> usize;

    /// Puts the state at `z` (n) and forgets what was adapted; false, when L(z) is minus infinity there: no chain can
    /// start where the target has no density.
    ///
    /// # Errors
    /// When L is NaN or plus infinity, or its gradient is not finite.
    fn start(&mut self, z: &[f64]) -> Result<bool>;

    /// One transition.
    ///
    /// # Errors
    /// When L is NaN or plus infinity at a place it was asked for, or its gradient is not finite.
    fn step<R: Rng + ?Sized>(&mut self, rng: &mut R) -> Result<()>;

    /// Learns from transition number `done` of `total` in warm-up, which was just made. Not called afterwards: a
    /// transition that goes on learning from its path does not leave the target as it is.
    fn adapt(&mut self, done: usize, total: usize);

    /// z (n).
    fn position(&self) -> &[f64];

    /// L(z).
    fn log_likelihood(&self) -> f64;

    /// What was spent since [`start`](Self::start).
    fn effort(&self) -> Effort;
}

/// L as a sampler may use it: finite, or minus infinity for what is impossible.
fn checked(log_likelihood: f64) -> Result<f64> {
    if log_likelihood.is_nan() || log_likelihood == f64::INFINITY {
        return Err(Error::new(
            ErrorKind::Value,
            format!("log-likelihood is {log_likelihood}"),
        )
        .expected("a finite number, or -inf for what is impossible"));
    }
    Ok(log_likelihood)
}

/// Uniform on (0, 1], in steps of 2^-53.
fn uniform<R: Rng + ?Sized>(rng: &mut R) -> f64 {
    ((rng.next_u64() >> 11) + 1) as f64 * (1.0 / (1u64 << 53) as f64)
}

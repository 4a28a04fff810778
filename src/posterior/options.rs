//! [`HamiltonianOptions`]: how trajectories are made.

use std::f64::consts::FRAC_PI_2;

use crate::error::{Error, ErrorKind, Result};

/// How trajectories are made.
#[derive(Debug, Clone, PartialEq)]
pub struct HamiltonianOptions {
    /// Mean length of a trajectory \[rad\]; a quarter turn by default, after which a Gaussian has forgotten its start.
    pub angle: f64,
    /// Lengths are uniform on `angle` (1 +- `jitter`), so that no direction returns to its start every time; 0.3 by default.
    pub jitter: f64,
    /// Mean acceptance probability that the step size is adapted to; 0.9 by default, since where a nonlinear observation is
    /// steeper than on average larger steps stick.
    pub acceptance: f64,
    /// Most gradients a trajectory; when steps are too small for that, trajectories are shorter. 100 by default.
    pub most_steps: usize,
    /// Most directions in which the posterior's width is learned; 16 by default, 0 leaves the prior's. Fewer are safer for
    /// many observations that are far from linear in z.
    pub directions: usize,
}

impl Default for HamiltonianOptions {
    fn default() -> Self {
        Self {
            angle: FRAC_PI_2,
            jitter: 0.3,
            acceptance: 0.9,
            most_steps: 100,
            directions: 16,
        }
    }
}

impl HamiltonianOptions {
    pub(super) fn check(&self) -> Result<()> {
        let check = |name: &str, value: f64, fits: bool, expected: &str| {
            if fits {
                return Ok(());
            }
            Err(Error::new(
                ErrorKind::Setting,
                format!("{name} of trajectories is {value}"),
            )
            .expected(expected))
        };
        check(
            "angle",
            self.angle,
            self.angle > 0.0 && self.angle < 100.0,
            "an angle above 0 and below 100 rad",
        )?;
        check(
            "jitter",
            self.jitter,
            (0.0..1.0).contains(&self.jitter),
            "a share from 0 to below 1",
        )?;
        check(
            "acceptance",
            self.acceptance,
            self.acceptance > 0.0 && self.acceptance < 1.0,
            "a probability between 0 and 1",
        )?;
        check(
            "number of steps",
            self.most_steps as f64,
            self.most_steps > 0,
            "at least 1",
        )
    }
}

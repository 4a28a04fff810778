//! What stands between a motion and its execution: limits of the joints, and self-collision.

mod given;
mod limits;

pub use given::{JointLimit, JointLimits};
pub use limits::{LimitSource, LimitUse, limits, limits_with, without_velocity_limit};

use crate::collision::{CollisionModel, MotionClearance};
use crate::error::{Reason, Result};
use crate::fourier::Wave;
use crate::robot::Robot;

/// What is known of a wave on a robot before it is executed.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// Every limit and its use.
    pub limits: Vec<LimitUse>,
    /// Clearance along one period; not looked at when a limit is broken.
    pub collision: Option<MotionClearance>,
}

impl Verdict {
    /// Puts one period of `wave` through limits and, if they hold, self-collision on a grid of `step` \[m\].
    ///
    /// # Errors
    /// Those of [`limits`] and [`CollisionModel::check_motion`].
    pub fn of(robot: &Robot, collision: &CollisionModel, wave: &Wave, step: f64) -> Result<Self> {
        let limits = limits(robot, wave)?;
        let within = limits.iter().all(|l| l.excess() == 0.0);
        let collision = if within {
            Some(collision.check_motion(robot, wave, step)?)
        } else {
            None
        };
        Ok(Self { limits, collision })
    }

    /// The limits that are broken.
    pub fn broken(&self) -> impl Iterator<Item = &LimitUse> {
        self.limits.iter().filter(|l| l.excess() > 0.0)
    }

    /// Why it does not pass, each reason once, in the order of [`Reason::ALL`]; none when it passes.
    pub fn reasons(&self) -> Vec<Reason> {
        let mut reasons: Vec<Reason> = self.limits.iter().filter_map(LimitUse::reason).collect();
        match &self.collision {
            Some(c) if c.is_free() => {}
            Some(_) => reasons.push(Reason::SelfCollision),
            // Not looked at: by itself that is no answer.
            None if reasons.is_empty() => reasons.push(Reason::Undecided),
            None => {}
        }
        reasons.sort_unstable();
        reasons.dedup();
        reasons
    }

    /// Whether no limit is broken and no sample touches.
    pub fn passes(&self) -> bool {
        self.reasons().is_empty()
    }
}

//! What stands between a motion and its execution: limits of the joints, and self-collision.

mod given;
mod limits;

pub use given::{JointLimit, JointLimits};
pub use limits::{LimitSource, LimitUse, limits, limits_with, without_velocity_limit};

use crate::collision::{Certification, CollisionModel};
use crate::error::{Reason, Result};
use crate::motion::Motion;
use crate::robot::Robot;

/// What is known of a wave on a robot before it is executed.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// Every limit and its use.
    pub limits: Vec<LimitUse>,
    /// Whether it keeps clear of itself and of the scene; not looked at when a limit is broken.
    pub collision: Option<Certification>,
}

impl Verdict {
    /// Puts a motion through the limits that the robot gives and, if they hold, the proof that every pair stays farther apart than
    /// `margin` \[m\].
    ///
    /// # Errors
    /// Those of [`limits`] and [`CollisionModel::certify`].
    pub fn of<M: Motion>(
        robot: &Robot,
        collision: &CollisionModel,
        motion: &M,
        margin: f64,
    ) -> Result<Self> {
        let limits = limits(robot, motion)?;
        let within = limits.iter().all(|l| l.excess() == 0.0);
        let collision = if within {
            Some(collision.certify(motion, margin, &[])?)
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
            Some(Certification::Clear { .. }) => {}
            Some(Certification::Collides { witness, .. }) => reasons.push(match witness {
                near if near.distance > 0.0 => Reason::Clearance,
                near if near.is_with_scene => Reason::SceneCollision,
                _ => Reason::SelfCollision,
            }),
            Some(Certification::Undecided { .. }) => reasons.push(Reason::Undecided),
            // Not looked at: by itself that is no answer.
            None if reasons.is_empty() => reasons.push(Reason::Undecided),
            None => {}
        }
        reasons.sort_unstable();
        reasons.dedup();
        reasons
    }

    /// Whether no limit is broken and nothing touches, for certain.
    pub fn passes(&self) -> bool {
        self.reasons().is_empty()
    }
}

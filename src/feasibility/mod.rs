//! What stands between a motion and its execution: limits of the joints, and collision with itself and its surroundings.

mod assessment;
mod efforts;
mod given;
mod limits;
mod mend;
mod passage;
mod player;

pub use assessment::{Assessment, Bounded, Worst};
pub use efforts::{EffortUse, efforts};
pub use given::{JointLimit, JointLimits};
pub use limits::{LimitSource, LimitUse, limits, limits_with, without_velocity_limit};
pub use mend::{Change, Means, Mended, mend};
pub use passage::{Passages, Performance};
pub use player::{Plan, Planner, Player};

use std::collections::BTreeMap;

use crate::collision::{Certification, CollisionModel, MinimumClearance, Moment, Prover};
use crate::error::{Reason, Result};
use crate::motion::Motion;
use crate::robot::Robot;

/// What is asked of a motion besides the limits that the robot gives.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CheckOptions {
    /// Limits of the caller's.
    pub limits: JointLimits,
    /// Every checked pair must stay farther apart than this \[m\].
    pub margin: f64,
    /// While each joint is within its entry of the motion \[rad, m\]; no entries: exactly on it.
    pub tolerance: Vec<f64>,
    /// Looks for the smallest clearance of the motion, to this accuracy \[m\].
    pub accuracy: Option<f64>,
}

/// What is known of a motion on a robot before it is executed.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// Every limit and its use.
    pub limits: Vec<LimitUse>,
    /// What it takes of every joint's effort, as estimated; `None` when that was not looked at, as of a robot without masses.
    pub efforts: Option<Vec<EffortUse>>,
    /// Whether it keeps clear of itself and of the scene; `None` when that was not looked at.
    pub collision: Option<Certification>,
    /// Where it touches the scene, if `collision` is of the robot with itself, or itself, if that is with the scene: one does not hide the other.
    pub touches_too: Option<Moment>,
    /// Where it comes nearest to touching, if that was asked for.
    pub clearance: Option<MinimumClearance>,
}

impl Verdict {
    /// Puts a motion through the limits that the robot gives and, if they hold, its efforts and the proof that every pair stays farther apart
    /// than `margin` \[m\].
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
        let mut verdict = Self {
            limits,
            efforts: None,
            collision: None,
            touches_too: None,
            clearance: None,
        };
        if verdict.broken().next().is_none() {
            verdict.efforts = known_efforts(robot, motion)?;
            verdict.collision = Some(collision.certify(motion, margin, &[])?);
        }
        Ok(verdict)
    }

    /// Puts a motion through all that `options` ask for, whether or not an earlier part of it is broken.
    ///
    /// # Errors
    /// Those of [`limits_with`], [`Prover::certify`] and [`Prover::minimum_clearance`].
    pub fn with<M: Motion>(
        robot: &Robot,
        prover: &mut Prover<'_>,
        motion: &M,
        options: &CheckOptions,
    ) -> Result<Self> {
        let mut verdict = Self {
            limits: limits_with(robot, motion, &options.limits)?,
            efforts: known_efforts(robot, motion)?,
            collision: Some(prover.certify(motion, options.margin, &options.tolerance)?),
            touches_too: None,
            clearance: options
                .accuracy
                .map(|accuracy| prover.minimum_clearance(motion, accuracy))
                .transpose()?,
        };
        if let Some(Certification::Collides { witness, .. }) = &verdict.collision {
            let with_scene = verdict.worst(witness).is_with_scene;
            verdict.touches_too = prover.touches(motion, !with_scene)?;
        }
        Ok(verdict)
    }

    /// The limits that are broken.
    pub fn broken(&self) -> impl Iterator<Item = &LimitUse> {
        self.limits.iter().filter(|l| l.excess() > 0.0)
    }

    /// Why it does not pass, each reason once, in the order of [`Reason::ALL`]; none when it passes. Of collisions it is the
    /// worst that is known.
    pub fn reasons(&self) -> Vec<Reason> {
        let mut reasons: Vec<Reason> = self.limits.iter().filter_map(LimitUse::reason).collect();
        let efforts = self.efforts.iter().flatten();
        reasons.extend(efforts.filter_map(EffortUse::reason));
        match &self.collision {
            Some(Certification::Clear { .. }) => {}
            Some(Certification::Collides { witness, .. }) => {
                reasons.push(touching(self.worst(witness)));
                reasons.extend(self.touches_too.as_ref().map(touching));
            }
            Some(Certification::Undecided { .. }) => reasons.push(Reason::Undecided),
            // Not looked at: by itself that is no answer.
            None if reasons.is_empty() => reasons.push(Reason::Undecided),
            None => {}
        }
        reasons.sort_unstable();
        reasons.dedup();
        reasons
    }

    /// Where it is nearest to touching, as far as is known.
    fn worst<'a>(&'a self, witness: &'a Moment) -> &'a Moment {
        let nearest = self.clearance.as_ref().map(|c| &c.at);
        nearest
            .filter(|at| at.distance < witness.distance)
            .unwrap_or(witness)
    }

    /// What does not pass, where and by how much, in words: the worst of each kind.
    pub fn faults(&self) -> Vec<String> {
        let mut faults: Vec<(Reason, f64, String)> = Vec::new();
        let of_limits = self.broken().filter_map(|limit| {
            let reached = match limit.worst_time() == limit.lower_time {
                true => limit.range.lower,
                false => limit.range.upper,
            };
            let what = format!(
                "{} reaches {reached:.4} at {:.3} s, limit {:.4} .. {:.4}",
                limit.joint,
                limit.worst_time(),
                limit.limit.lower,
                limit.limit.upper
            );
            Some((limit.reason()?, limit.excess(), what))
        });
        faults.extend(of_limits);
        let of_efforts = self.efforts.iter().flatten().filter_map(|effort| {
            let what = format!(
                "{} takes {:.2} .. {:.2} at {:.3} s, limit {:.2}",
                effort.joint,
                effort.range.lower,
                effort.range.upper,
                effort.worst_time(),
                effort.limit?
            );
            Some((effort.reason()?, effort.excess(), what))
        });
        faults.extend(of_efforts);
        let mut worst: BTreeMap<Reason, (f64, String)> = BTreeMap::new();
        for (reason, excess, what) in faults {
            let known = worst.entry(reason).or_default();
            if known.1.is_empty() || excess > known.0 {
                *known = (excess, what);
            }
        }
        let told = worst.into_iter();
        let mut told: Vec<String> = told.map(|(r, (_, what))| format!("{r}: {what}")).collect();
        match &self.collision {
            Some(Certification::Collides { witness, .. }) => {
                let worst = self.worst(witness);
                let distance = worst.distance + worst.padding;
                told.push(format!(
                    "{}: {} and {} are {:.4} m {} at {:.3} s",
                    touching(worst),
                    worst.pair.0,
                    worst.pair.1,
                    distance.abs(),
                    if distance > 0.0 {
                        "apart"
                    } else {
                        "deep in each other"
                    },
                    worst.time
                ));
            }
            Some(Certification::Undecided { stretches, .. }) => {
                told.extend(stretches.first().map(|stretch| {
                    format!(
                        "undecided: {} and {} from {:.4} to {:.4} s",
                        stretch.pair.0, stretch.pair.1, stretch.from, stretch.to
                    )
                }));
            }
            _ => {}
        }
        told
    }

    /// Whether no limit is broken and nothing touches, for certain.
    pub fn passes(&self) -> bool {
        self.reasons().is_empty()
    }
}

/// What such a distance breaks.
fn touching(near: &Moment) -> Reason {
    // Distances are less the padding, within which nothing meets yet.
    match near {
        near if near.distance + near.padding > 0.0 => Reason::Clearance,
        near if near.is_with_scene => Reason::SceneCollision,
        _ => Reason::SelfCollision,
    }
}

/// Those of a robot that has masses.
fn known_efforts<M: Motion>(robot: &Robot, motion: &M) -> Result<Option<Vec<EffortUse>>> {
    match robot.require_dynamics() {
        Ok(()) => efforts(robot, motion).map(Some),
        Err(_) => Ok(None),
    }
}

/// Whether a motion keeps the limits of positions, velocities, accelerations and efforts.
fn keeps_limits<M: Motion>(robot: &Robot, motion: &M, options: &CheckOptions) -> Result<bool> {
    let limits = limits_with(robot, motion, &options.limits)?;
    if limits.iter().any(|limit| limit.excess() > 0.0) {
        return Ok(false);
    }
    let efforts = known_efforts(robot, motion)?;
    Ok(efforts
        .iter()
        .flatten()
        .all(|effort| effort.excess() == 0.0))
}

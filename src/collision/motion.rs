//! Clearance along a motion, on a grid fine enough for a stated distance.

use nalgebra::Isometry3;

use super::{Clearance, CollisionModel};
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::{Derivative, State, Wave};
use crate::robot::{JointKind, Robot};

/// More samples than this are no check but a mistake in the units.
const MOST_SAMPLES: f64 = 1e7;

/// What a check of one period found.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionClearance {
    /// The smallest distance among the samples, or 0 with the first pair that touches.
    pub clearance: Clearance,
    /// When \[s\].
    pub time: f64,
    /// How many configurations were looked at.
    pub samples: usize,
    /// No point of a body moves farther than this between two samples \[m\].
    pub step: f64,
}

impl MotionClearance {
    /// Whether no sample touched.
    pub fn is_free(&self) -> bool {
        self.clearance.distance > 0.0
    }
}

impl CollisionModel {
    /// Looks at one period of `wave` on a grid so fine that no point of any body moves farther than `step` \[m\] between
    /// two samples; stops at the first that touches. Between the samples nothing is proven: a free answer with clearance
    /// above `step` is free throughout all the same, since each of two bodies is within `step`/2 of a sample.
    ///
    /// # Errors
    /// When the wave is not of the robot's joints, no pair is checked, the step is not positive, or the motion is too
    /// fast for it to be sampled.
    pub fn check_motion(&self, robot: &Robot, wave: &Wave, step: f64) -> Result<MotionClearance> {
        robot.require_joints(wave.joints())?;
        if !(step.is_finite() && step > 0.0) {
            return Err(Error::new(ErrorKind::Setting, format!("step of {step} m"))
                .expected("a positive distance"));
        }
        let speed = robot.speed_bound(wave);
        let samples = (speed * wave.period() / step).ceil().max(1.0);
        if samples > MOST_SAMPLES {
            return Err(Error::new(
                ErrorKind::Infeasible,
                format!("a point of the robot may move at {speed:.3e} m/s: {samples:.1e} samples"),
            )
            .expected(format!("at most {MOST_SAMPLES:.0e}"))
            .help("check the units of the wave, or take a larger step"));
        }
        let samples = samples as usize;
        let mut poses = vec![Isometry3::identity(); robot.bodies().len()];
        let mut state = State::zeros(wave.joints().len());
        let mut best = None;
        let mut bound = f64::INFINITY;
        for n in 0..samples {
            let time = wave.period() * n as f64 / samples as f64;
            wave.state_into(time, &mut state);
            robot.body_poses_into(state.position.as_slice(), &mut poses);
            if let Some((distance, pair)) = self.nearest(&poses, bound) {
                bound = distance;
                best = Some((time, distance, pair));
                if distance <= 0.0 {
                    break;
                }
            }
        }
        let Some((time, distance, pair)) = best else {
            return Err(Error::new(
                ErrorKind::Infeasible,
                "no pair of bodies is checked: those with collision shapes are neighbours or left out",
            )
            .help("add collision shapes to the URDF, or leave out fewer pairs")
            .at(format!("robot `{}`", robot.name())));
        };
        Ok(MotionClearance {
            clearance: Clearance {
                distance,
                pair: pair.names.clone(),
            },
            time,
            samples,
            step,
        })
    }
}

impl Robot {
    /// A bound on the speed \[m/s\] of every point of every body during a wave: over the joints below it, peak rate times
    /// the longest distance that the point can have from the joint in any configuration.
    fn speed_bound(&self, wave: &Wave) -> f64 {
        let rates: Vec<f64> = (0..wave.joints().len())
            .map(|j| wave.range(j, Derivative::Velocity).magnitude())
            .collect();
        let extents: Vec<f64> = (0..wave.joints().len())
            .map(|j| wave.range(j, Derivative::Position).magnitude())
            .collect();
        let mut fastest: f64 = 0.0;
        for (b, body) in self.bodies().iter().enumerate() {
            let mut reach = body
                .collision
                .iter()
                .map(|s| s.pose.translation.vector.norm() + s.shape.radius())
                .fold(0.0, f64::max);
            let mut speed = 0.0;
            let mut at = b;
            while let Some(joint) = &self.bodies()[at].joint {
                let rate = joint.multiplier.abs() * rates[joint.index];
                match joint.kind {
                    JointKind::Revolute => speed += rate * reach,
                    JointKind::Prismatic => {
                        speed += rate;
                        reach += joint.multiplier.abs() * extents[joint.index] + joint.offset.abs();
                    }
                }
                reach += joint.origin.translation.vector.norm();
                at = self.bodies()[at].parent;
            }
            fastest = fastest.max(speed);
        }
        fastest
    }
}

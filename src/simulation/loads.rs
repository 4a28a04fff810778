//! What acts on the joints besides motors and gravity: damping, friction, pushes.

use nalgebra::{Point3, Vector3};

use super::options::{Push, Pushed, SimulationOptions};
use crate::error::Result;
use crate::robot::{Frame, JointKind, Robot};

/// Times are rounded: what is to begin by so small a share of a step after the step does, begins with it.
pub(super) const EARLY: f64 = 1e-6;

/// Damping and friction of a body's joint.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Losses {
    /// \[N m s/rad, N s/m\]
    pub damping: f64,
    /// \[N m, N\]
    pub friction: f64,
}

impl Losses {
    /// As the URDF has them, by body.
    pub fn of_model(robot: &Robot) -> Vec<Self> {
        Self::of(robot, None, None)
    }

    /// As the plant has them, by body.
    pub fn of_plant(robot: &Robot, options: &SimulationOptions) -> Vec<Self> {
        Self::of(robot, options.damping, options.friction)
    }

    fn of(robot: &Robot, damping: Option<f64>, friction: Option<f64>) -> Vec<Self> {
        let mut losses = vec![Self::default(); robot.bodies().len()];
        for (body, joint) in robot.moving() {
            losses[body] = Self {
                damping: damping.unwrap_or(joint.properties.damping),
                friction: friction.unwrap_or(joint.properties.friction),
            };
        }
        losses
    }

    /// What they take at a rate.
    pub fn at(self, rate: f64) -> f64 {
        let sign = if rate == 0.0 { 0.0 } else { rate.signum() };
        self.damping * rate + self.friction * sign
    }
}

/// A push whose names have been looked up.
#[derive(Debug, Clone)]
pub(super) struct Load {
    pub on: On,
    from: f64,
    to: f64,
}

#[derive(Debug, Clone)]
pub(super) enum On {
    /// A force in the base frame at a point in the body's.
    Body {
        body: usize,
        at: Point3<f64>,
        force: Vector3<f64>,
    },
    /// Along the joint of a body.
    Joint { body: usize, effort: f64 },
}

impl Load {
    pub fn of(robot: &Robot, push: &Push) -> Result<Self> {
        let on = match &push.on {
            Pushed::Link { link, at, force } => {
                let link = robot.link(link)?;
                On::Body {
                    body: link.body,
                    at: link.pose * at,
                    force: *force,
                }
            }
            Pushed::Joint { joint, effort } => {
                let index = robot.joints().index(joint)?;
                let own = |j: &crate::robot::BodyJoint| j.index == index && j.is_commanded;
                let body = robot.moving().find(|(_, j)| own(j)).map_or(0, |(b, _)| b);
                On::Joint {
                    body,
                    effort: *effort,
                }
            }
        };
        Ok(Self {
            on,
            from: push.from,
            to: push.to,
        })
    }

    /// In a step that begins at `time`, of a simulation in steps of `dt`.
    pub fn acts(&self, time: f64, dt: f64) -> bool {
        let early = EARLY * dt;
        self.from <= time + early && time + early < self.to
    }

    /// Adds what it does along the joint of every body, given the frames of the bodies.
    pub fn add_to(&self, robot: &Robot, frames: &[Frame], efforts: &mut [f64]) {
        match &self.on {
            On::Joint { body, effort } => efforts[*body] += effort,
            On::Body { body, at, force } => {
                let point = frames[*body].rotation * at.coords + frames[*body].origin;
                let mut i = *body;
                while let Some(joint) = &robot.bodies()[i].joint {
                    let axis = frames[i].rotation * joint.axis.into_inner();
                    efforts[i] += match joint.kind {
                        JointKind::Revolute => axis.dot(&(point - frames[i].origin).cross(force)),
                        JointKind::Prismatic => axis.dot(force),
                    };
                    i = robot.bodies()[i].parent;
                }
            }
        }
    }
}

/// Forces of bodies' joints as forces of the commanded joints that move them.
pub(super) fn gathered(robot: &Robot, efforts: &[f64], forces: &mut [f64]) {
    forces.fill(0.0);
    for (body, joint) in robot.moving() {
        forces[joint.index] += joint.multiplier * efforts[body];
    }
}

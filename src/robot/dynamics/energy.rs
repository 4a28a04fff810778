//! Kinetic and potential energy.

use nalgebra::Vector3;

use super::Dynamics;
use crate::robot::Robot;

impl Dynamics {
    /// Kinetic energy \[J\] of all bodies at velocity `v`: from their twists in the base frame, apart from the mass matrix.
    pub fn kinetic_energy(&mut self, robot: &Robot, q: &[f64], v: &[f64]) -> f64 {
        let (frames, twists) = self.kinematics.move_bodies(robot, q, v);
        let moving = robot.steps.iter().zip(frames).zip(twists).skip(1);
        moving
            .map(|((step, frame), twist)| {
                let inertia = &step.inertia;
                let w = frame.rotation.tr_mul(&twist.angular);
                let linear = frame.rotation.tr_mul(&twist.linear);
                0.5 * inertia.mass * linear.norm_squared()
                    + linear.dot(&w.cross(&inertia.moment))
                    + 0.5 * w.dot(&(inertia.inertia * w))
            })
            .sum()
    }

    /// Potential energy \[J\] of the bodies that move under `gravity` \[m/s^2\]; 0 for masses at the base's origin.
    pub fn potential_energy(&mut self, robot: &Robot, q: &[f64], gravity: &Vector3<f64>) -> f64 {
        self.kinematics.frames(robot, q);
        self.lifted(robot, gravity)
    }

    /// The potential energy of bodies whose frames are known.
    pub(super) fn lifted(&self, robot: &Robot, gravity: &Vector3<f64>) -> f64 {
        let frames = self.kinematics.last_frames();
        let moving = robot.steps.iter().zip(frames).skip(1);
        moving
            .map(|(step, frame)| {
                let inertia = &step.inertia;
                let moment = frame.origin * inertia.mass + frame.rotation * inertia.moment;
                -gravity.dot(&moment)
            })
            .sum()
    }
}

//! Inverse dynamics: the recursive Newton-Euler algorithm.

use nalgebra::Vector3;

use super::{BodyState, Dynamics, Wrench};
use crate::robot::{JointKind, Robot};

impl Dynamics {
    /// Generalized forces tau = M(q) a + C(q, v) v + g(q) \[N m, N\] for position, velocity and acceleration of each joint
    /// under `gravity` \[m/s^2\] (Luh, Walker and Paul 1980; Featherstone 2008, section 5.3). Damping and friction are
    /// not in it. Bodies without mass count as massless. Panics when a slice has not one entry a joint.
    pub fn inverse(
        &mut self,
        robot: &Robot,
        q: &[f64],
        v: &[f64],
        a: &[f64],
        gravity: &Vector3<f64>,
    ) -> &[f64] {
        self.place(robot, q);
        self.newton_euler(robot, v, Some(a), gravity);
        &self.forces
    }

    /// The forces g(q) \[N m, N\] that hold the robot still against `gravity` \[m/s^2\].
    pub fn gravity_forces(&mut self, robot: &Robot, q: &[f64], gravity: &Vector3<f64>) -> &[f64] {
        self.place(robot, q);
        let still = std::mem::take(&mut self.still);
        self.newton_euler(robot, &still, None, gravity);
        self.still = still;
        &self.forces
    }

    /// What [`inverse`](Self::inverse) found for the joint of each body \[N m, N\], mimicking joints apart from those they
    /// mimic. Forward dynamics and gravity forces overwrite it.
    pub fn body_efforts(&self) -> &[f64] {
        &self.efforts
    }

    /// The recursion for bodies that have been placed; `None` for no acceleration.
    pub(super) fn newton_euler(
        &mut self,
        robot: &Robot,
        v: &[f64],
        a: Option<&[f64]>,
        gravity: &Vector3<f64>,
    ) {
        let joints = self.forces.len();
        assert_eq!(v.len(), joints, "one velocity a joint");
        assert!(
            a.is_none_or(|a| a.len() == joints),
            "one acceleration a joint"
        );
        self.bodies[0].acceleration = -gravity;
        self.bodies[0].wrench = Wrench::zero();
        for (i, step) in robot.steps.iter().enumerate().skip(1) {
            let rate = step.multiplier * v[step.index];
            let acceleration = a.map_or(0.0, |a| step.multiplier * a[step.index]);
            let (placed, parent) = (&self.placed[i], &self.bodies[step.parent]);
            let (w, r) = (parent.angular_velocity, &placed.arm);
            let turning = parent.angular_acceleration;
            let carried = parent.acceleration + turning.cross(r) + w.cross(&w.cross(r));
            let turn = placed.axis * rate;
            let (angular_velocity, angular_acceleration, linear) = match step.kind {
                JointKind::Revolute => (
                    w + turn,
                    turning + placed.axis * acceleration + w.cross(&turn),
                    carried,
                ),
                JointKind::Prismatic => (
                    w,
                    turning,
                    carried + placed.axis * acceleration + 2.0 * w.cross(&turn),
                ),
            };
            let wrench = placed
                .inertia
                .wrench(&angular_velocity, &angular_acceleration, &linear);
            self.bodies[i] = BodyState {
                angular_velocity,
                angular_acceleration,
                acceleration: linear,
                wrench,
            };
        }
        self.forces.fill(0.0);
        for (i, step) in robot.steps.iter().enumerate().skip(1).rev() {
            let (placed, wrench) = (&self.placed[i], self.bodies[i].wrench);
            let effort = wrench.along(step.kind, &placed.axis);
            self.efforts[i] = effort;
            self.forces[step.index] += step.multiplier * effort;
            self.bodies[step.parent]
                .wrench
                .add(&wrench.carried(&placed.arm));
        }
    }
}

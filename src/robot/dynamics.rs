//! Inverse dynamics: the recursive Newton-Euler algorithm.

use nalgebra::{Isometry3, Matrix3, Vector3};

use super::{Inertial, JointKind, Robot};

/// Acceleration of gravity in the base frame \[m/s^2\]: the base stands upright, z up.
pub const GRAVITY: Vector3<f64> = Vector3::new(0.0, 0.0, -9.81);

/// Workspace of the inverse dynamics of one robot; nothing is allocated once it exists.
#[derive(Debug, Clone)]
pub struct Dynamics {
    bodies: Vec<BodyState>,
    /// Generalized forces of the last call, an entry a joint.
    forces: Vec<f64>,
    /// The force along each body's own joint in the last call; it differs from `forces` where joints mimic others.
    efforts: Vec<f64>,
}

/// Everything of one body in its own frame.
#[derive(Debug, Clone)]
struct BodyState {
    /// In the parent's frame.
    pose: Isometry3<f64>,
    rotation: Matrix3<f64>,
    angular_velocity: Vector3<f64>,
    angular_acceleration: Vector3<f64>,
    /// Of the frame's origin, gravity included as an upward acceleration of the base.
    acceleration: Vector3<f64>,
    force: Vector3<f64>,
    /// About the frame's origin.
    moment: Vector3<f64>,
}

impl Dynamics {
    /// A workspace for `robot`.
    pub fn new(robot: &Robot) -> Self {
        let still = BodyState {
            pose: Isometry3::identity(),
            rotation: Matrix3::identity(),
            angular_velocity: Vector3::zeros(),
            angular_acceleration: Vector3::zeros(),
            acceleration: Vector3::zeros(),
            force: Vector3::zeros(),
            moment: Vector3::zeros(),
        };
        Self {
            bodies: vec![still; robot.bodies().len()],
            forces: vec![0.0; robot.joints().len()],
            efforts: vec![0.0; robot.bodies().len()],
        }
    }

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
        assert!(
            q.len() == self.forces.len() && v.len() == q.len() && a.len() == q.len(),
            "one entry a joint"
        );
        let base = &mut self.bodies[0];
        base.acceleration = -gravity;
        base.force = Vector3::zeros();
        base.moment = Vector3::zeros();
        for (i, body) in robot.bodies().iter().enumerate().skip(1) {
            let Some(joint) = &body.joint else { continue };
            let pose = joint.pose(q);
            let rate = joint.multiplier * v[joint.index];
            let acceleration = joint.multiplier * a[joint.index];
            let axis = joint.axis.into_inner();
            let parent = &self.bodies[body.parent];
            let rotation = pose.rotation.to_rotation_matrix().into_inner();
            let r = pose.translation.vector;
            let w = rotation.tr_mul(&parent.angular_velocity);
            let origin = parent.acceleration
                + parent.angular_acceleration.cross(&r)
                + parent
                    .angular_velocity
                    .cross(&parent.angular_velocity.cross(&r));
            let turning = rotation.tr_mul(&parent.angular_acceleration);
            let carried = rotation.tr_mul(&origin);
            let (angular_velocity, angular_acceleration, linear) = match joint.kind {
                JointKind::Revolute => (
                    w + axis * rate,
                    turning + axis * acceleration + w.cross(&axis) * rate,
                    carried,
                ),
                JointKind::Prismatic => (
                    w,
                    turning,
                    carried + axis * acceleration + 2.0 * w.cross(&axis) * rate,
                ),
            };
            let (force, moment) = body.inertial.as_ref().map_or_else(
                || (Vector3::zeros(), Vector3::zeros()),
                |inertial| inertial.wrench(&angular_velocity, &angular_acceleration, &linear),
            );
            self.bodies[i] = BodyState {
                pose,
                rotation,
                angular_velocity,
                angular_acceleration,
                acceleration: linear,
                force,
                moment,
            };
        }
        self.forces.fill(0.0);
        for (i, body) in robot.bodies().iter().enumerate().skip(1).rev() {
            let Some(joint) = &body.joint else { continue };
            let state = &self.bodies[i];
            let effort = match joint.kind {
                JointKind::Revolute => joint.axis.dot(&state.moment),
                JointKind::Prismatic => joint.axis.dot(&state.force),
            };
            self.efforts[i] = effort;
            self.forces[joint.index] += joint.multiplier * effort;
            let force = state.rotation * state.force;
            let moment =
                state.rotation * state.moment + state.pose.translation.vector.cross(&force);
            let parent = &mut self.bodies[body.parent];
            parent.force += force;
            parent.moment += moment;
        }
        &self.forces
    }

    /// What [`inverse`](Self::inverse) found for the joint of each body \[N m, N\], mimicking joints apart from those they mimic.
    pub fn body_efforts(&self) -> &[f64] {
        &self.efforts
    }

    /// The diagonal of the mass matrix \[kg m^2, kg\]: the force that gives one joint unit acceleration while all else rests.
    pub fn mass_diagonal(&mut self, robot: &Robot, q: &[f64]) -> Vec<f64> {
        let still = vec![0.0; q.len()];
        (0..q.len())
            .map(|j| {
                let mut unit = still.clone();
                unit[j] = 1.0;
                self.inverse(robot, q, &still, &unit, &Vector3::zeros())[j]
            })
            .collect()
    }
}

impl Inertial {
    /// Force and moment about the body's origin that give it this motion (Newton, Euler).
    fn wrench(
        &self,
        angular_velocity: &Vector3<f64>,
        angular_acceleration: &Vector3<f64>,
        acceleration: &Vector3<f64>,
    ) -> (Vector3<f64>, Vector3<f64>) {
        let (w, c) = (angular_velocity, &self.center);
        let force =
            self.mass * (acceleration + angular_acceleration.cross(c) + w.cross(&w.cross(c)));
        let moment = self.inertia * angular_acceleration + w.cross(&(self.inertia * w));
        (force, moment + c.cross(&force))
    }
}

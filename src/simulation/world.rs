//! The robot as a Rapier multibody.

use nalgebra::{Isometry3, Vector3};
use rapier3d::dynamics::{
    GenericJoint, GenericJointBuilder, JointAxesMask, JointAxis, MassProperties, MotorModel,
    Multibody, MultibodyJointHandle, RigidBodyBuilder, RigidBodyHandle, SpringCoefficients,
};
use rapier3d::math::{Matrix, Pose, Rotation, Vector};
use rapier3d::pipeline::PhysicsWorld;

use super::loads::Losses;
use crate::error::{Error, ErrorKind, Result};
use crate::robot::{Body, BodyJoint, GRAVITY, JointKind, Robot};

/// Iterations of the constraint solver within a step. With 8, motors near their limits are resolved, but not those of joints that move each
/// other much (shoulder and forearm about nearly one axis): large waves of 3 Hz are then tracked six times worse than by a solver that is
/// exact, with 16 by 1 % at most. More than one outer step leaves a jitter of 1e-3 rad/s.
pub(super) const SOLVER_ITERATIONS: usize = 16;

/// What a stop corrects in a step of what a joint is beyond it.
const STOP: f64 = 0.02;

/// Damping ratio of stops: they give way by less than STOP^-1 / (2 STOP_DAMPING)^2 of what they hold.
const STOP_DAMPING: f64 = 1000.0;

/// A robot on its fixed base in a Rapier world with gravity: one multibody, one link a body, without colliders
/// (whether a motion touches is the business of the collision model).
pub struct MultibodyWorld {
    world: PhysicsWorld,
    bodies: Vec<RigidBodyHandle>,
    /// By body, the base left out.
    joints: Vec<MultibodyJointHandle>,
    axes: Vec<JointAxis>,
}

impl MultibodyWorld {
    /// `robot` at configuration `q` with the rates `v`, integrated in steps of `time_step` \[s\].
    ///
    /// # Errors
    /// When the robot lacks masses, or Rapier will not have its joints.
    pub fn new(robot: &Robot, q: &[f64], v: &[f64], time_step: f64) -> Result<Self> {
        robot.require_dynamics()?;
        let mut world = PhysicsWorld {
            gravity: Vector::new(GRAVITY.x, GRAVITY.y, GRAVITY.z),
            ..PhysicsWorld::default()
        };
        let parameters = &mut world.integration_parameters;
        parameters.dt = time_step;
        parameters.num_solver_iterations = 1;
        parameters.num_internal_pgs_iterations = SOLVER_ITERATIONS;
        parameters.num_internal_stabilization_iterations = 0;
        parameters.max_ccd_substeps = 0;

        let bodies: Vec<RigidBodyHandle> = robot
            .bodies()
            .iter()
            .map(|body| world.bodies.insert(rigid_body(body)))
            .collect();
        let mut joints = Vec::new();
        let mut axes = Vec::new();
        for (i, body) in robot.bodies().iter().enumerate().skip(1) {
            let Some(joint) = &body.joint else { continue };
            let limits = joint.properties.position;
            let limits = limits.map(|l| [l.lower, l.upper]);
            let (axis, data) = generic_joint(joint, limits, time_step);
            let handle = world
                .multibody_joints
                .insert(bodies[body.parent], bodies[i], data, true)
                .ok_or_else(|| {
                    Error::new(ErrorKind::Infeasible, "the multibody cannot take the joint")
                        .at(format!("joint `{}`", joint.name))
                })?;
            joints.push(handle);
            axes.push(axis);
        }
        // Masses are known to Rapier only after this; without it the first step is taken without any.
        for handle in &bodies {
            world.bodies[*handle].recompute_mass_properties_from_colliders(&world.colliders);
        }
        let mut this = Self {
            world,
            bodies,
            joints,
            axes,
        };
        this.place(robot, q, v);
        Ok(this)
    }

    fn place(&mut self, robot: &Robot, q: &[f64], v: &[f64]) {
        let moving: Vec<&BodyJoint> = robot.moving().map(|(_, joint)| joint).collect();
        let Some(first) = self.joints.first().copied() else {
            return;
        };
        let world = &mut self.world;
        let Some((multibody, _)) = world.multibody_joints.get_mut(first) else {
            return;
        };
        multibody.set_self_contacts_enabled(false);
        // The base is fixed: this call removes its six degrees of freedom, and only then do indices hold.
        multibody.forward_kinematics(&world.bodies, true);
        let at: Vec<usize> = (0..moving.len()).map(|j| index(multibody, j)).collect();
        let mut displacement = vec![0.0; multibody.ndofs()];
        for (j, joint) in moving.iter().enumerate() {
            displacement[at[j]] = joint.position(q);
            multibody.generalized_velocity_mut()[at[j]] = joint.multiplier * v[joint.index];
            // Rapier starts with a damping of its own.
            multibody.damping_mut()[at[j]] = joint.properties.damping;
            multibody.frictions_mut()[at[j]] = joint.properties.friction;
            multibody.armature_mut()[at[j]] = 0.0;
        }
        multibody.apply_displacements(&displacement);
        multibody.forward_kinematics(&world.bodies, false);
        multibody.update_rigid_bodies(&mut world.bodies, true);
    }

    /// Iterations of the solver within a step, in place of 16.
    pub(super) fn set_solver_iterations(&mut self, iterations: usize) {
        self.world
            .integration_parameters
            .num_internal_pgs_iterations = iterations;
    }

    /// Damping and friction of the joints, by body, in place of the URDF's.
    pub(super) fn set_losses(&mut self, losses: &[Losses]) {
        for (body, joint) in self.joints.iter().enumerate() {
            let Some((multibody, link)) = self.world.multibody_joints.get_mut(*joint) else {
                continue;
            };
            if let Some(at) = multibody.link(link).map(|link| link.assembly_id()) {
                multibody.damping_mut()[at] = losses[body + 1].damping;
                multibody.frictions_mut()[at] = losses[body + 1].friction;
            }
        }
    }

    /// Takes off all forces that were added.
    pub(super) fn clear_forces(&mut self) {
        for handle in &self.bodies {
            self.world.bodies[*handle].reset_forces(false);
            self.world.bodies[*handle].reset_torques(false);
        }
    }

    /// A force on a body at a point, in the base frame \[N, m\].
    pub(super) fn add_force(&mut self, body: usize, force: &Vector3<f64>, at: &Vector3<f64>) {
        self.world.bodies[self.bodies[body]].add_force_at_point(
            Vector::new(force.x, force.y, force.z),
            Vector::new(at.x, at.y, at.z),
            true,
        );
    }

    /// A torque on a body, in the base frame \[N m\].
    pub(super) fn add_torque(&mut self, body: usize, torque: &Vector3<f64>) {
        let torque = Vector::new(torque.x, torque.y, torque.z);
        self.world.bodies[self.bodies[body]].add_torque(torque, true);
    }

    /// A body that Rapier has disabled because its state is not finite.
    pub(super) fn quarantined(&self) -> Option<usize> {
        let quarantine = self.world.physics_pipeline.quarantine();
        if quarantine.is_empty() {
            return None;
        }
        let found = self
            .bodies
            .iter()
            .position(|b| quarantine.bodies().contains(b));
        Some(found.unwrap_or(0))
    }

    /// Sets the motor of the joint of body `body` (1 or more): a spring of stiffness `kp` to `position`, a damper `kd` to
    /// `velocity`, together at most `effort`.
    pub(super) fn set_motor(&mut self, body: usize, position: f64, velocity: f64, motor: Motor) {
        let axis = self.axes[body - 1];
        let joint = self.joints[body - 1];
        if let Some((multibody, link)) = self.world.multibody_joints.get_mut(joint)
            && let Some(link) = multibody.link_mut(link)
        {
            link.joint
                .data
                .set_motor(axis, position, velocity, motor.stiffness, motor.damping)
                .set_motor_model(axis, MotorModel::ForceBased)
                .set_motor_max_force(axis, motor.effort);
        }
    }

    /// One time step.
    pub fn step(&mut self) {
        self.arm_stops();
        self.world.step();
    }

    /// Leaves in the step only the stops that matter to it: those that a joint is beyond, and those that a motor's velocity would take it
    /// beyond, which Rapier clamps. The others would be solved for in every iteration, within bounds of zero and zero.
    fn arm_stops(&mut self) {
        let dt = self.world.integration_parameters.dt;
        for (handle, axis) in self.joints.iter().zip(&self.axes) {
            let Some((multibody, link)) = self.world.multibody_joints.get_mut(*handle) else {
                continue;
            };
            let Some(joint) = multibody.link_mut(link).map(|link| &mut link.joint) else {
                continue;
            };
            let position = joint.coords()[*axis as usize];
            let data = &mut joint.data;
            let (limits, motor) = (&data.limits[*axis as usize], &data.motors[*axis as usize]);
            // A little further than Rapier would, whose roundings are others.
            let aim = position + 1.001 * motor.target_vel * dt;
            let is_within = |at: f64| limits.min < at && at < limits.max;
            let matters = !(is_within(position) && is_within(aim));
            data.limit_axes.set(JointAxesMask::from(*axis), matters);
        }
    }

    /// Position and rate of the joint of body `body` (1 or more).
    pub fn joint_state(&self, body: usize) -> (f64, f64) {
        let Some((multibody, id)) = self.world.multibody_joints.get(self.joints[body - 1]) else {
            return (f64::NAN, f64::NAN);
        };
        let Some(link) = multibody.link(id) else {
            return (f64::NAN, f64::NAN);
        };
        let coordinate = match self.axes[body - 1] {
            JointAxis::LinX => 0,
            _ => 3,
        };
        (
            link.joint().coords()[coordinate],
            multibody.generalized_velocity()[link.assembly_id()],
        )
    }

    /// The pose of each body in the base frame, as Rapier has it.
    pub fn body_poses(&self) -> Vec<Isometry3<f64>> {
        self.bodies
            .iter()
            .map(|handle| {
                let pose = self.world.bodies[*handle].position();
                let (t, r) = (pose.translation, pose.rotation);
                Isometry3::from_parts(
                    nalgebra::Translation3::new(t.x, t.y, t.z),
                    nalgebra::UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(
                        r.w, r.x, r.y, r.z,
                    )),
                )
            })
            .collect()
    }
}

/// Gains and limit of a motor, which gives in a step what its spring and damper would at the end of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motor {
    /// \[N m/rad\]
    pub stiffness: f64,
    /// \[N m s/rad\]
    pub damping: f64,
    /// \[N m\]
    pub effort: f64,
}

/// Where the joint number `joint` stands in the multibody's vectors: links are in the order of insertion, after the root.
fn index(multibody: &Multibody, joint: usize) -> usize {
    multibody
        .link(joint + 1)
        .map_or(joint, |link| link.assembly_id())
}

fn rigid_body(body: &Body) -> RigidBodyBuilder {
    let Some(inertial) = body.inertial.as_ref().filter(|_| body.joint.is_some()) else {
        return RigidBodyBuilder::fixed();
    };
    let c = &inertial.center;
    let i = &inertial.inertia;
    let column = |j: usize| Vector::new(i[(0, j)], i[(1, j)], i[(2, j)]);
    RigidBodyBuilder::dynamic()
        .additional_mass_properties(MassProperties::with_inertia_matrix(
            Vector::new(c.x, c.y, c.z),
            inertial.mass,
            Matrix::from_cols(column(0), column(1), column(2)),
        ))
        .can_sleep(false)
}

/// Rapier's joints turn about, or slide along, the x axis of a frame: b takes x to the joint's axis.
///
/// By default a stop gives back in one step all that a joint is beyond it, and so as much speed as it came with. Here it gives back
/// [`STOP`] of it a step; the high damping ratio keeps the stop hard, and with it friction, which has the same coefficients.
fn generic_joint(
    joint: &BodyJoint,
    limits: Option<[f64; 2]>,
    time_step: f64,
) -> (JointAxis, GenericJoint) {
    let a = joint.axis.into_inner();
    let b = Pose::from_parts(
        Vector::new(0.0, 0.0, 0.0),
        GenericJoint::complete_ang_frame(Vector::new(a.x, a.y, a.z)),
    );
    let (t, r) = (
        &joint.origin.translation.vector,
        &joint.origin.rotation.coords,
    );
    let origin = Pose::from_parts(
        Vector::new(t.x, t.y, t.z),
        Rotation::from_xyzw(r.x, r.y, r.z, r.w),
    );
    let (axis, locked) = match joint.kind {
        JointKind::Revolute => (JointAxis::AngX, JointAxesMask::LOCKED_REVOLUTE_AXES),
        JointKind::Prismatic => (JointAxis::LinX, JointAxesMask::LOCKED_PRISMATIC_AXES),
    };
    let mut builder = GenericJointBuilder::new(locked)
        .contacts_enabled(false)
        .softness(SpringCoefficients {
            natural_frequency: STOP / (1.0 - STOP) * 2.0 * STOP_DAMPING
                / (std::f64::consts::TAU * time_step),
            damping_ratio: STOP_DAMPING,
        })
        .local_frame1(origin * b)
        .local_frame2(b);
    if let Some(limits) = limits {
        builder = builder.limits(axis, limits);
    }
    (axis, builder.build())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shipped;

    #[test]
    fn stops_that_are_left_out_change_no_bit() {
        let robot = shipped::robot("wave_arm").unwrap();
        let world = || {
            let mut world = MultibodyWorld::new(
                &robot,
                &robot.rest(),
                &[1.5, -2.0, 2.0, -1.0, 3.0, 2.0],
                1e-3,
            );
            // Three joints fall, three are driven, one of them beyond its stop.
            for (body, aim) in [(1, 0.3), (2, 40.0), (3, -0.2)] {
                let motor = Motor {
                    stiffness: 100.0,
                    damping: 10.0,
                    effort: 40.0,
                };
                world.as_mut().unwrap().set_motor(body, aim, aim, motor);
            }
            world.unwrap()
        };
        let (mut all, mut some) = (world(), world());
        let states = |world: &MultibodyWorld| -> Vec<(f64, f64)> {
            (1..=6).map(|body| world.joint_state(body)).collect()
        };
        let is_armed = |world: &MultibodyWorld, body: usize| {
            let (multibody, link) = world
                .world
                .multibody_joints
                .get(world.joints[body - 1])
                .unwrap();
            let joint = &multibody.link(link).unwrap().joint().data;
            !joint.limit_axes.is_empty()
        };
        let mut armed = [0; 7];
        for n in 0..2000 {
            all.world.step();
            some.step();
            assert_eq!(states(&all), states(&some), "step {n}");
            let stops = (1..=6).filter(|body| is_armed(&some, *body)).count();
            armed[stops] += 1;
        }
        assert!(
            armed[0] > 0 && armed[1..].iter().sum::<i32>() > 100,
            "{armed:?}"
        );
    }
}

//! The plant in Rapier.

use nalgebra::{DVector, Vector3};

use super::controller::{Command, Gains};
use super::loads::{Load, Losses, On, gathered};
use super::options::{Control, SimulationOptions};
use super::plant::{Integrator, PlantState};
use super::semi_implicit::SemiImplicit;
use super::world::{Motor, MultibodyWorld};
use crate::error::{Error, ErrorKind, Result};
use crate::robot::{Dynamics, Frame, JointKind, Robot};

/// How far a body may be from where the joints have it, as a share of a metre or a radian.
const DRIFT: f64 = 1e-6;

/// A multibody with springs and dampers at its joints; they are implicit in the step, so they act at every one, about a target
/// that moves on between messages of the controller.
pub(super) struct RapierPlant<'r> {
    robot: &'r Robot,
    world: MultibodyWorld,
    dt: f64,
    /// Of the controller.
    period: f64,
    motors: Option<Vec<Motor>>,
    losses: Vec<Losses>,
    loads: Vec<Load>,
    dynamics: Dynamics,
    frames: Vec<Frame>,
    /// Of the last message, by body: where the motor aims at in a step, and how fast. Where is moved by the feed-forward over the stiffness.
    targets: Vec<[f64; 2]>,
    /// By body, and by joint.
    pushed: Vec<f64>,
    forces: Vec<f64>,
    /// By body, all that acted along its joint but losses.
    acted: Vec<f64>,
    inverse: SemiImplicit,
    before: PlantState,
    /// From one message to the next.
    rate: DVector<f64>,
    acceleration: DVector<f64>,
}

impl<'r> RapierPlant<'r> {
    /// `inertia` is what each joint moves in the posture that gains are for.
    pub fn new(
        robot: &'r Robot,
        options: &SimulationOptions,
        inertia: &[f64],
        period: f64,
        start: &PlantState,
    ) -> Result<Self> {
        let (q, v) = (start.position.as_slice(), start.velocity.as_slice());
        let losses = Losses::of_plant(robot, options);
        let mut world = MultibodyWorld::new(robot, q, v, options.time_step)?;
        world.set_solver_iterations(options.solver_iterations);
        world.set_losses(&losses);
        let motors = robot.moving().map(|(_, joint)| {
            let own = inertia[joint.index] / joint.multiplier.powi(2).max(f64::MIN_POSITIVE);
            let Gains { stiffness, damping } = Gains::critical(own, options.bandwidth);
            let limit = joint.properties.effort.filter(|_| options.effort_limits);
            Motor {
                stiffness,
                damping,
                effort: limit.unwrap_or(f64::MAX),
            }
        });
        let bodies = robot.bodies().len();
        Ok(Self {
            robot,
            world,
            dt: options.time_step,
            period,
            motors: (options.control != Control::Free).then(|| motors.collect()),
            inverse: SemiImplicit::new(robot, &losses),
            losses,
            loads: options
                .pushes
                .iter()
                .map(|push| Load::of(robot, push))
                .collect::<Result<_>>()?,
            dynamics: Dynamics::new(robot),
            frames: vec![Frame::identity(); bodies],
            targets: vec![[0.0; 2]; bodies],
            pushed: vec![0.0; bodies],
            forces: vec![0.0; q.len()],
            acted: vec![0.0; bodies],
            before: start.clone(),
            rate: DVector::zeros(q.len()),
            acceleration: DVector::zeros(q.len()),
        })
    }

    /// What the motors gave in the step to `state`, and what was worked in it.
    ///
    /// Rapier does not tell: it is what a spring and damper at the end of the step give, within their limit. What else acted along a joint
    /// at its stop, the stop gave.
    fn account(&mut self, state: &mut PlantState) {
        let (robot, before, dt) = (self.robot, &self.before, self.dt);
        let is_at_stop = robot.moving().any(|(_, joint)| {
            let is_outside = |q: &DVector<f64>| {
                let q = joint.position(q.as_slice());
                let range = joint.properties.position;
                range.is_some_and(|r| q <= r.lower || q >= r.upper)
            };
            is_outside(&before.position) || is_outside(&state.position)
        });
        if is_at_stop {
            self.acceleration.copy_from(&state.velocity);
            self.acceleration -= &before.velocity;
            self.acceleration /= dt;
            gathered(robot, &self.pushed, &mut self.forces);
            let motion = [&before.position, &before.velocity, &self.acceleration];
            let all = self.inverse.efforts(robot, motion, Some(&self.forces), dt);
            self.acted.copy_from_slice(all);
        }
        for (n, (body, joint)) in robot.moving().enumerate() {
            let (old, new) = (before.velocity[joint.index], state.velocity[joint.index]);
            let rate = joint.multiplier * new;
            let effort = self.motors.as_ref().map_or(0.0, |motors| {
                let (motor, [aim, speed]) = (motors[n], self.targets[body]);
                let off = aim - joint.position(state.position.as_slice());
                (motor.stiffness * off + motor.damping * (speed - rate))
                    .clamp(-motor.effort, motor.effort)
            });
            if joint.is_commanded {
                state.effort[joint.index] = effort;
            }
            let lost = self.losses[body].at(rate);
            // Over the way of the mean rate, impulses do what they change of the kinetic energy.
            let way = joint.multiplier * 0.5 * (old + new) * dt;
            state.work.motors += effort * way;
            state.work.losses -= lost * way;
            state.work.pushes += self.pushed[body] * way;
            if is_at_stop {
                state.work.stops += (self.acted[body] + lost - self.pushed[body] - effort) * way;
            }
        }
    }

    /// Hands the pushes of a step to Rapier, and notes what they do along the joints.
    fn push(&mut self, time: f64) {
        self.pushed.fill(0.0);
        if self.loads.is_empty() {
            return;
        }
        self.world.clear_forces();
        let q = self.before.position.as_slice();
        self.robot.body_frames_into(q, &mut self.frames);
        for load in self.loads.iter().filter(|l| l.acts(time, self.dt)) {
            load.add_to(self.robot, &self.frames, &mut self.pushed);
            match &load.on {
                On::Body { body, at, force } => {
                    let frame = &self.frames[*body];
                    let point = frame.rotation * at.coords + frame.origin;
                    self.world.add_force(*body, force, &point);
                }
                On::Joint { body, effort } => {
                    add_effort(&mut self.world, self.robot, &self.frames, *body, *effort);
                }
            }
        }
    }
}

/// An effort along the joint of a body: on the body, and against it on its parent.
fn add_effort(
    world: &mut MultibodyWorld,
    robot: &Robot,
    frames: &[Frame],
    body: usize,
    effort: f64,
) {
    let Some(joint) = &robot.bodies()[body].joint else {
        return;
    };
    let frame = &frames[body];
    let along: Vector3<f64> = frame.rotation * joint.axis.into_inner() * effort;
    let parent = robot.bodies()[body].parent;
    match joint.kind {
        JointKind::Revolute => {
            world.add_torque(body, &along);
            world.add_torque(parent, &-along);
        }
        JointKind::Prismatic => {
            world.add_force(body, &along, &frame.origin);
            world.add_force(parent, &-along, &frame.origin);
        }
    }
}

impl Integrator for RapierPlant<'_> {
    fn receive(&mut self, command: &Command) {
        let [from, to] = &command.position;
        self.rate.copy_from(to);
        self.rate -= from;
        self.rate /= self.period;
        let Some(motors) = &self.motors else { return };
        for ((body, joint), motor) in self.robot.moving().zip(motors) {
            let position = joint.position(command.position[0].as_slice());
            self.targets[body] = [
                position + command.forward[body] / motor.stiffness,
                joint.multiplier * self.rate[joint.index],
            ];
        }
    }

    fn step(&mut self, time: f64, state: &mut PlantState) -> Result<[f64; 2]> {
        self.before.copy_from(state);
        if let Some(motors) = &self.motors {
            for ((body, _), motor) in self.robot.moving().zip(motors) {
                let [target, speed] = &mut self.targets[body];
                self.world.set_motor(body, *target, *speed, *motor);
                *target += *speed * self.dt;
            }
        }
        self.push(time);
        self.world.step();
        for (body, joint) in self.robot.moving() {
            if joint.is_commanded {
                let (position, rate) = self.world.joint_state(body);
                state.position[joint.index] = position;
                state.velocity[joint.index] = rate;
            }
        }
        if let Some(body) = self.world.quarantined() {
            return Err(Error::new(
                ErrorKind::Infeasible,
                format!(
                    "Rapier has taken link `{}` out of the simulation",
                    self.robot.bodies()[body].name
                ),
            )
            .expected("a position and velocity that are finite"));
        }
        self.account(state);
        Ok(self.before.energies(self.robot, &mut self.dynamics))
    }

    fn energies(&mut self, state: &PlantState) -> [f64; 2] {
        state.energies(self.robot, &mut self.dynamics)
    }

    fn require_sound(&mut self, state: &PlantState) -> Result<()> {
        let poses = self.robot.body_poses(state.position.as_slice());
        let theirs = self.world.body_poses();
        // Motors hold joints that mimic others, no gears: these may be a little off.
        let mut geared = vec![false; poses.len()];
        for (i, (ours, theirs)) in poses.iter().zip(theirs).enumerate().skip(1) {
            let body = &self.robot.bodies()[i];
            let mimics = body.joint.as_ref().is_some_and(|j| !j.is_commanded);
            geared[i] = mimics || geared[body.parent];
            if geared[i] {
                continue;
            }
            let apart = (ours.translation.vector - theirs.translation.vector).norm();
            let turned = 2.0 * ours.rotation.rotation_to(&theirs.rotation).imag().norm();
            let size = 1.0 + ours.translation.vector.norm();
            if !(apart <= DRIFT * size && turned <= DRIFT) {
                return Err(Error::new(
                    ErrorKind::Infeasible,
                    format!(
                        "link `{}` has drifted by {apart:.1e} m and {turned:.1e} rad from where its joints have it",
                        body.name
                    ),
                )
                .expected("bodies that their joints hold together"));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shipped;

    fn plant(robot: &Robot) -> (RapierPlant<'_>, PlantState) {
        let state = PlantState::new(DVector::from_vec(robot.rest()), DVector::zeros(6));
        let options = SimulationOptions {
            control: Control::Free,
            ..SimulationOptions::default()
        };
        let plant = RapierPlant::new(robot, &options, &[1.0; 6], 1e-3, &state).unwrap();
        (plant, state)
    }

    #[test]
    fn a_body_that_rapier_takes_out_is_told() {
        let robot = shipped::robot("wave_arm").unwrap();
        let (mut plant, mut state) = plant(&robot);
        plant.step(0.0, &mut state).unwrap();
        plant
            .world
            .add_force(3, &Vector3::repeat(f64::NAN), &Vector3::zeros());
        // Rapier looks at bodies after a step, so that the numbers may be told first.
        let told = (0..3).find_map(|_| plant.step(1e-3, &mut state).err());
        match told {
            Some(error) => assert!(
                error.to_string().contains("out of the simulation"),
                "{error}"
            ),
            None => assert!(!state.is_finite()),
        }
    }

    #[test]
    fn bodies_away_from_their_joints_are_told() {
        let robot = shipped::robot("wave_arm").unwrap();
        let (mut plant, mut state) = plant(&robot);
        plant.step(0.0, &mut state).unwrap();
        plant.require_sound(&state).unwrap();
        state.position[2] += 1e-4;
        let error = plant.require_sound(&state).unwrap_err();
        assert!(error.to_string().contains("has drifted by"), "{error}");
    }
}

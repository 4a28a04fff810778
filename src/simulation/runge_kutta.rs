//! The plant on this crate's own dynamics.

use nalgebra::DVector;

use super::controller::Command;
use super::drive::Drive;
use super::impulses::Impulses;
use super::loads::{Load, Losses, gathered};
use super::options::{Control, SimulationOptions};
use super::plant::{Integrator, PlantState};
use crate::error::Result;
use crate::robot::{Dynamics, Frame, GRAVITY, Robot};

/// The classical Runge-Kutta method: how far into the step each slope is taken, and what it counts.
const STAGES: [(f64, f64); 4] = [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)];

/// Motors know of friction what they were told so many times over: else those of a joint that it holds count on a motion that does not come, and give by
/// an eighth too little at 12 Hz and a millisecond. Each time leaves an eighth of what was left.
const RUBBED: usize = 3;

/// M(q) a = tau - C v - g - D v + pushes + friction, with the motors' tau held from one message of the controller to the next.
pub(super) struct RungeKutta<'r> {
    robot: &'r Robot,
    dt: f64,
    /// None where the robot falls freely.
    drive: Option<Drive>,
    damping: Vec<f64>,
    friction: Vec<f64>,
    loads: Vec<Load>,
    dynamics: Dynamics,
    impulses: Impulses,
    frames: Vec<Frame>,
    /// By body.
    efforts: Vec<f64>,
    /// Of motors and friction, held over the step.
    tau: DVector<f64>,
    rubbing: DVector<f64>,
    pushed: Vec<f64>,
    total: Vec<f64>,
    slopes: [[DVector<f64>; 2]; 4],
    q: DVector<f64>,
    v: DVector<f64>,
    response: DVector<f64>,
}

impl<'r> RungeKutta<'r> {
    /// `inertia` is what each joint moves in the posture that gains are for; a message holds for `hold` steps.
    pub fn new(
        robot: &'r Robot,
        options: &SimulationOptions,
        inertia: &[f64],
        hold: usize,
    ) -> Result<Self> {
        let (joints, bodies) = (robot.joints().len(), robot.bodies().len());
        let zeros = || DVector::zeros(joints);
        let losses = Losses::of_plant(robot, options);
        let (mut damping, mut friction) = (vec![0.0; joints], vec![0.0; joints]);
        for (body, joint) in robot.moving() {
            // Rates and forces both pass the gears.
            damping[joint.index] += joint.multiplier.powi(2) * losses[body].damping;
            friction[joint.index] += joint.multiplier.abs() * losses[body].friction;
        }
        Ok(Self {
            robot,
            dt: options.time_step,
            drive: (options.control != Control::Free)
                .then(|| Drive::new(robot, options, inertia, hold)),
            damping,
            friction,
            loads: options
                .pushes
                .iter()
                .map(|push| Load::of(robot, push))
                .collect::<Result<_>>()?,
            dynamics: Dynamics::new(robot),
            impulses: Impulses::new(robot),
            frames: vec![Frame::identity(); bodies],
            efforts: vec![0.0; bodies],
            tau: zeros(),
            rubbing: zeros(),
            pushed: vec![0.0; joints],
            total: vec![0.0; joints],
            slopes: std::array::from_fn(|_| [zeros(), zeros()]),
            q: zeros(),
            v: zeros(),
            response: zeros(),
        })
    }

    /// The forces of pushes at `self.q`, in a step that begins at `time`.
    fn push(&mut self, time: f64) {
        if self.loads.is_empty() {
            return;
        }
        self.efforts.fill(0.0);
        self.robot
            .body_frames_into(self.q.as_slice(), &mut self.frames);
        for load in self.loads.iter().filter(|l| l.acts(time, self.dt)) {
            load.add_to(self.robot, &self.frames, &mut self.efforts);
        }
        gathered(self.robot, &self.efforts, &mut self.pushed);
    }

    /// Slope number `k` at (`self.q`, `self.v`).
    fn slope(&mut self, k: usize, time: f64) -> Result<()> {
        self.push(time);
        for j in 0..self.total.len() {
            let lost = self.rubbing[j] - self.damping[j] * self.v[j];
            self.total[j] = self.tau[j] + lost + self.pushed[j];
        }
        let (q, v) = (self.q.as_slice(), self.v.as_slice());
        let a = self
            .dynamics
            .forward(self.robot, q, v, &self.total, &GRAVITY)?;
        let [rates, accelerations] = &mut self.slopes[k];
        rates.copy_from(&self.v);
        accelerations.as_mut_slice().copy_from_slice(a);
        Ok(())
    }

    /// Finds the motors' torques, with friction as it is known.
    fn drive(&mut self) -> Result<()> {
        match &mut self.drive {
            Some(drive) => drive.torques([&self.q, &self.v, &self.rubbing], &mut self.tau),
            None => Ok(()),
        }
    }

    /// Finds friction, as impulses over the step on the velocities that motors would come to at its end without.
    fn rub(&mut self) {
        self.impulses.clear();
        for (j, friction) in self.friction.iter().enumerate() {
            let most = friction * self.dt;
            self.impulses.add(j, [-most, most]);
        }
        self.response.copy_from(&self.tau);
        self.dynamics.respond(self.response.as_mut_slice());
        self.response += &self.slopes[0][1];
        self.response *= self.dt;
        self.response += &self.v;
        self.impulses
            .bring_to_rest(&self.dynamics, &mut self.response);
        for (j, impulse) in self.impulses.all() {
            self.rubbing[j] = impulse / self.dt;
        }
    }

    /// What motors, losses and pushes do at (`self.q`, `self.v`) \[W\].
    fn powers(&self) -> [f64; 3] {
        let mut powers = [0.0; 3];
        for (j, v) in self.v.iter().enumerate() {
            powers[0] += self.tau[j] * v;
            powers[1] += (self.rubbing[j] - self.damping[j] * v) * v;
            powers[2] += self.pushed[j] * v;
        }
        powers
    }

    /// Joints that are beyond a stop and go on are put back to it, and stopped as by a plastic impact.
    fn stop(&mut self, state: &mut PlantState) -> Result<()> {
        let robot = self.robot;
        let beyond = |j: usize, q: f64, v: f64| {
            let range = robot.properties(j).position?;
            match q {
                q if q < range.lower && v <= 0.0 => Some((range.lower, [0.0, f64::MAX])),
                q if q > range.upper && v >= 0.0 => Some((range.upper, [f64::MIN, 0.0])),
                _ => None,
            }
        };
        let joints = 0..self.total.len();
        let is_any = |j| beyond(j, state.position[j], state.velocity[j]).is_some();
        if !joints.clone().any(is_any) {
            return Ok(());
        }
        let [kinetic, potential] = self.energies(state);
        self.impulses.clear();
        for j in joints {
            if let Some((stop, inward)) = beyond(j, state.position[j], state.velocity[j]) {
                state.position[j] = stop;
                self.impulses.add(j, inward);
            }
        }
        self.total.fill(0.0);
        let (q, v) = (state.position.as_slice(), state.velocity.as_slice());
        self.dynamics.forward(robot, q, v, &self.total, &GRAVITY)?;
        self.impulses
            .bring_to_rest(&self.dynamics, &mut state.velocity);
        let after = self.energies(state);
        state.work.stops += after[0] + after[1] - kinetic - potential;
        Ok(())
    }
}

impl Integrator for RungeKutta<'_> {
    fn receive(&mut self, command: &Command) {
        if let Some(drive) = &mut self.drive {
            drive.receive(self.robot, command);
        }
    }

    fn step(&mut self, time: f64, state: &mut PlantState) -> Result<[f64; 2]> {
        let dt = self.dt;
        self.q.copy_from(&state.position);
        self.v.copy_from(&state.velocity);
        self.tau.fill(0.0);
        self.rubbing.fill(0.0);
        self.slope(0, time)?;
        let energies = self
            .dynamics
            .energies(self.robot, self.v.as_slice(), &GRAVITY);
        // The first slope is without motors and friction, so that they can be chosen; then they are added.
        if let Some(drive) = &mut self.drive {
            drive.begin(&self.dynamics, &self.slopes[0][1]);
        }
        self.drive()?;
        if self.friction.iter().any(|f| *f > 0.0) {
            self.rub();
            for _ in 0..RUBBED {
                self.drive()?;
                self.rub();
            }
        }
        self.response.copy_from(&self.tau);
        self.response += &self.rubbing;
        self.dynamics.respond(self.response.as_mut_slice());
        self.slopes[0][1] += &self.response;
        let mut powers = [self.powers(); 4];
        for k in 1..4 {
            let ahead = STAGES[k].0 * dt;
            self.q.copy_from(&state.position);
            self.q.axpy(ahead, &self.slopes[k - 1][0], 1.0);
            self.v.copy_from(&state.velocity);
            self.v.axpy(ahead, &self.slopes[k - 1][1], 1.0);
            self.slope(k, time)?;
            powers[k] = self.powers();
        }
        for (k, (_, weight)) in STAGES.iter().enumerate() {
            let share = weight * dt / 6.0;
            state.position.axpy(share, &self.slopes[k][0], 1.0);
            state.velocity.axpy(share, &self.slopes[k][1], 1.0);
            state.work.motors += share * powers[k][0];
            state.work.losses += share * powers[k][1];
            state.work.pushes += share * powers[k][2];
        }
        state.effort.copy_from(&self.tau);
        self.stop(state)?;
        Ok(energies)
    }

    fn energies(&mut self, state: &PlantState) -> [f64; 2] {
        state.energies(self.robot, &mut self.dynamics)
    }

    fn require_sound(&mut self, _: &PlantState) -> Result<()> {
        // Positions and velocities are all that there is.
        Ok(())
    }
}

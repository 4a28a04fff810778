//! [`Simulation`]: a robot and how its motions are executed.

use nalgebra::{DMatrix, DVector};

use super::controller::{Controller, postures};
use super::energy::Energy;
use super::event::events;
use super::options::{Control, Plant, Schedule, SimulationOptions};
use super::plant::{Integrator, PlantState, not_finite};
use super::rapier::RapierPlant;
use super::runge_kutta::RungeKutta;
use super::{Rollout, observer, stability};
use crate::error::Result;
use crate::fourier::State;
use crate::motion::Motion;
use crate::parallel;
use crate::robot::{Dynamics, Robot};

/// Steps from one look at the plant's soundness to the next.
const LOOK: usize = 250;

/// Executes motions on a robot, under gravity, with the damping, friction, position and effort limits of its URDF.
///
/// Each joint has a spring and damper, critically damped about the inertia that it moves in the motion's mean posture. A motion that
/// repeats is started on its own position and velocity, another at rest where it begins. The same motion and options give the same
/// bits, whatever else is done and on however many threads.
///
/// ```
/// use undulate::nalgebra::{DMatrix, DVector};
/// use undulate::{Plant, Simulation, SimulationOptions, Wave, shipped};
///
/// let robot = shipped::robot("wave_arm")?;
/// let still = Wave::new(robot.joints().clone(), 0.2, DVector::from_element(6, 0.3), DMatrix::zeros(6, 1))?;
/// for plant in [Plant::Rapier, Plant::Rk4] {
///     let simulation = Simulation::new(&robot, SimulationOptions { plant, ..SimulationOptions::default() })?;
///     assert!(simulation.run(&still)?.rms_error().max() < 1e-6);
/// }
/// # Ok::<(), undulate::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Simulation<'r> {
    /// As the controller knows it.
    robot: &'r Robot,
    /// Where something is carried, the robot with it.
    loaded: Option<Robot>,
    options: SimulationOptions,
}

impl<'r> Simulation<'r> {
    /// # Errors
    /// When the robot lacks masses, an option is out of its range, or a name in the options is not the robot's.
    pub fn new(robot: &'r Robot, options: SimulationOptions) -> Result<Self> {
        robot.require_dynamics()?;
        options.require(robot)?;
        let loaded = match &options.payload {
            Some(load) => Some(robot.carrying(&load.link, load.mass, &load.center)?),
            None => None,
        };
        Ok(Self {
            robot,
            loaded,
            options,
        })
    }

    /// How motions are executed.
    pub fn options(&self) -> &SimulationOptions {
        &self.options
    }

    /// Executes `motion`.
    ///
    /// # Errors
    /// When the motion is not of the robot's joints; when the duration is no whole number of steps, a push comes after it, or the gains cannot be
    /// stable with them, before anything is simulated; and when the simulation leaves the finite numbers, or bodies their joints.
    pub fn run<M: Motion>(&self, motion: &M) -> Result<Rollout> {
        let (robot, options) = (self.robot, &self.options);
        robot.require_joints(motion.joints())?;
        let schedule = options.schedule(motion)?;
        options.require_in_time(schedule)?;
        let period = schedule.hold as f64 * options.time_step;
        let postures = postures(motion);
        let mean = postures.iter().sum::<DVector<f64>>() / postures.len() as f64;
        let inertia = Dynamics::new(robot).mass_diagonal(robot, mean.as_slice());
        if options.observer && options.control == Control::FeedForward {
            let model = (robot, 1.0 + options.torque_error);
            let (loaded, bandwidth) = (self.loaded.as_ref(), options.bandwidth);
            observer::require_stable(model, loaded, &postures, bandwidth, period)?;
        }
        let plant = self.loaded.as_ref().unwrap_or(robot);
        let controller = Controller::new(robot, motion, options, period);
        let (position, velocity) = controller.start();
        let start = PlantState::new(position, velocity);
        let rollout = match options.plant {
            Plant::Rapier => {
                let plant = RapierPlant::new(plant, options, &inertia, period, &start)?;
                self.drive(plant, controller, motion, schedule, start)
            }
            Plant::Rk4 => {
                stability::require(plant, options, &postures)?;
                let plant = RungeKutta::new(plant, options, &inertia, schedule.hold)?;
                self.drive(plant, controller, motion, schedule, start)
            }
        };
        rollout.map_err(|e| e.at(format!("robot `{}`", robot.name())))
    }

    /// Executes every motion, on `threads` threads; `of` makes of each rollout what is to be kept of it, by its number. Results are in
    /// the order of the motions, and the same whatever the number of threads.
    pub fn run_all<M: Motion, R: Send>(
        &self,
        motions: &[M],
        threads: usize,
        of: impl Fn(usize, Result<Rollout>) -> R + Sync,
    ) -> Vec<R> {
        let mut all = Vec::with_capacity(motions.len());
        parallel::in_order(
            motions.len(),
            threads,
            || (),
            |(), n| of(n, self.run(&motions[n])),
            |result| all.push(result),
        );
        all
    }

    fn drive<P: Integrator, M: Motion>(
        &self,
        mut plant: P,
        mut controller: Controller<'_, M>,
        motion: &M,
        Schedule { steps, hold }: Schedule,
        start: PlantState,
    ) -> Result<Rollout> {
        let (robot, dt) = (self.robot, self.options.time_step);
        let joints = robot.joints().len();
        let table = || DMatrix::zeros(steps + 1, joints);
        let mut rollout = Rollout {
            joints: robot.joints().clone(),
            kinds: (0..joints).map(|j| robot.joint(j).kind).collect(),
            times: (0..=steps).map(|n| n as f64 * dt).collect(),
            reference: table(),
            position: table(),
            velocity: table(),
            torque: table(),
            saturated: vec![0; joints],
            energy: Energy::with_capacity(steps + 1),
            events: Vec::new(),
        };
        let mut state = start;
        let mut wanted = State::zeros(joints);
        let mut gave = DVector::zeros(joints);
        for n in 0..steps {
            let time = n as f64 * dt;
            if n % hold == 0 {
                gave /= hold as f64;
                let command = controller.next(n / hold, [&state.position, &state.velocity, &gave]);
                gave.fill(0.0);
                plant.receive(command);
                rollout
                    .reference
                    .row_mut(n)
                    .tr_copy_from(&command.position[0]);
            } else {
                motion.state_into(time, &mut wanted);
                rollout.reference.row_mut(n).tr_copy_from(&wanted.position);
            }
            rollout.position.row_mut(n).tr_copy_from(&state.position);
            rollout.velocity.row_mut(n).tr_copy_from(&state.velocity);
            let work = state.work;
            let energies = plant.step(time, &mut state).map_err(|e| e.at(at(time)))?;
            rollout.energy.push(energies, &work);
            rollout.torque.row_mut(n).tr_copy_from(&state.effort);
            gave += &state.effort;
            if !state.is_finite() {
                return Err(not_finite().at(at(time + dt)));
            }
            if (n + 1) % LOOK == 0 || n + 1 == steps {
                plant
                    .require_sound(&state)
                    .map_err(|e| e.at(at(time + dt)))?;
            }
        }
        motion.state_into(steps as f64 * dt, &mut wanted);
        rollout
            .reference
            .row_mut(steps)
            .tr_copy_from(&wanted.position);
        rollout
            .position
            .row_mut(steps)
            .tr_copy_from(&state.position);
        rollout
            .velocity
            .row_mut(steps)
            .tr_copy_from(&state.velocity);
        rollout.torque.row_mut(steps).tr_copy_from(&state.effort);
        rollout.energy.push(plant.energies(&state), &state.work);
        events(robot, &mut rollout);
        Ok(rollout)
    }
}

fn at(time: f64) -> String {
    format!("{time:.3} s")
}

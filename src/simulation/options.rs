//! [`SimulationOptions`]: how a motion is executed, and what is otherwise than the robot's model has it.

use nalgebra::{Point3, Vector3};

use super::loads::EARLY;
use super::world::SOLVER_ITERATIONS;
use crate::error::{Error, ErrorKind, Result};
use crate::motion::Motion;
use crate::robot::Robot;

/// Stiffer than this against their damping, saturated motors limit-cycle: kd / kp must be at least this \[s\].
const LEAST_DAMPING_TIME: f64 = 0.02;

/// Beyond so many steps a rollout does not fit into memory.
const MOST_STEPS: f64 = 1e6;

/// Times are whole multiples of others to this share.
const WHOLE: f64 = 1e-9;

/// What integrates the equations of motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Plant {
    /// A Rapier multibody: semi-implicit Euler, first order; motors, friction and stops are constraints, solved by iteration.
    /// Joints that mimic others are moved by motors of their own.
    Rapier,
    /// The classical Runge-Kutta method of fourth order on this crate's forward dynamics. Motor torques are held over a step,
    /// and friction too: the force of each joint that brings it nearest to rest at the step's end. Stops are plastic impacts
    /// between steps. Joints that mimic others are geared to them.
    Rk4,
}

/// What the motors do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Control {
    /// Springs and dampers to the motion, fed the torque that the robot's model says the motion needs, and what it is seen to miss.
    FeedForward,
    /// Springs and dampers alone.
    Feedback,
    /// Nothing: the robot falls from the motion's start.
    Free,
}

/// Something heavy fixed to a link, of which the controller does not know.
#[derive(Debug, Clone, PartialEq)]
pub struct Payload {
    /// The link that carries it.
    pub link: String,
    /// \[kg\]
    pub mass: f64,
    /// Where it is concentrated, in the link's frame \[m\].
    pub center: Point3<f64>,
}

/// What pushes.
#[derive(Debug, Clone, PartialEq)]
pub enum Pushed {
    /// A link, with a force at a point of it.
    Link {
        /// Its name.
        link: String,
        /// In the link's frame \[m\].
        at: Point3<f64>,
        /// In the base frame \[N\].
        force: Vector3<f64>,
    },
    /// A joint, besides its motor and whatever that may give.
    Joint {
        /// Its name.
        joint: String,
        /// \[N m, N\]
        effort: f64,
    },
}

/// A push from outside, of which the controller does not know: constant in every step that begins from `from` on and before `to`.
#[derive(Debug, Clone, PartialEq)]
pub struct Push {
    /// What is pushed, and how.
    pub on: Pushed,
    /// \[s\]
    pub from: f64,
    /// \[s\]
    pub to: f64,
}

/// How a motion is executed. The controller knows the robot as its URDF describes it; what is said of damping, friction, torque,
/// payload and pushes here holds for the plant alone.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulationOptions {
    /// What integrates; Rapier by default.
    pub plant: Plant,
    /// Step of the integration \[s\]; 1 ms by default.
    pub time_step: f64,
    /// How often the controller sends \[s\], a whole number of steps; every step when `None`, the default.
    pub controller_period: Option<f64>,
    /// How long \[s\], a whole number of steps. When `None`, the default: the motion from start to end or one period of it, to
    /// the next whole step.
    pub duration: Option<f64>,
    /// Feed-forward and feedback by default.
    pub control: Control,
    /// Natural frequency of each critically damped position loop \[Hz\]; 12 by default.
    pub bandwidth: f64,
    /// Whether motors give no more than their effort limits; yes by default.
    pub effort_limits: bool,
    /// Iterations of Rapier's constraint solver in a step; 16 by default. What they leave unsolved shrinks by a third or more in each.
    pub solver_iterations: usize,
    /// Viscous damping of every joint \[N m s/rad, N s/m\] in place of the URDF's.
    pub damping: Option<f64>,
    /// Coulomb friction of every joint \[N m, N\] in place of the URDF's.
    pub friction: Option<f64>,
    /// Whether what the feed-forward misses is observed and fed forward too, three times as fast as the position loops: else springs yield to
    /// it. Yes by default; without feed-forward there is none.
    pub observer: bool,
    /// By what share all torques of the controller's model are too large; 0 by default.
    pub torque_error: f64,
    /// What is carried.
    pub payload: Option<Payload>,
    /// What comes from outside.
    pub pushes: Vec<Push>,
}

impl Default for SimulationOptions {
    fn default() -> Self {
        Self {
            plant: Plant::Rapier,
            time_step: 1e-3,
            controller_period: None,
            duration: None,
            control: Control::FeedForward,
            bandwidth: 12.0,
            effort_limits: true,
            solver_iterations: SOLVER_ITERATIONS,
            damping: None,
            friction: None,
            observer: true,
            torque_error: 0.0,
            payload: None,
            pushes: Vec::new(),
        }
    }
}

/// Whole numbers of steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Schedule {
    /// Of the rollout.
    pub steps: usize,
    /// From one message of the controller to the next.
    pub hold: usize,
}

impl SimulationOptions {
    /// What can be told without a motion.
    pub(super) fn require(&self, robot: &Robot) -> Result<()> {
        if !(self.time_step > 0.0 && self.time_step <= 0.02) {
            return refuse(
                format!("time step of {} s", self.time_step),
                "more than 0, at most 0.02 s",
            );
        }
        let stiffest = 1.0 / (std::f64::consts::PI * LEAST_DAMPING_TIME);
        let most = if self.effort_limits {
            stiffest
        } else {
            f64::MAX
        };
        if !(self.bandwidth > 0.0 && self.bandwidth <= most) {
            return refuse(
                format!("bandwidth of {} Hz", self.bandwidth),
                &format!(
                    "more than 0, at most {stiffest:.1} Hz: stiffer motors limit-cycle when they saturate"
                ),
            );
        }
        // At w dt = 1 a loop of one joint whose torque is held over the step is unstable (its map has an eigenvalue of -1). What is
        // implicit in the step remains stable, but is no longer the loop that was asked for.
        let resolved = 1.0 / (std::f64::consts::TAU * self.time_step);
        if self.bandwidth >= resolved {
            return refuse(
                format!(
                    "a bandwidth of {} Hz with a time step of {} s",
                    self.bandwidth, self.time_step
                ),
                &format!(
                    "below {resolved:.3} Hz: a stiffer loop is unstable, or damped by the integration alone"
                ),
            );
        }
        if !(1..=1000).contains(&self.solver_iterations) {
            return refuse(
                format!("{} iterations of the solver", self.solver_iterations),
                "1 to 1000",
            );
        }
        for (what, value) in [("damping", self.damping), ("friction", self.friction)] {
            if let Some(value) = value.filter(|v| !(*v >= 0.0 && v.is_finite())) {
                return refuse(format!("{what} of {value}"), "zero or more");
            }
        }
        if !(self.torque_error > -1.0 && self.torque_error.is_finite()) {
            return refuse(
                format!("a torque error of {}", self.torque_error),
                "a share above -1: 0.05 for 5 % too much",
            );
        }
        if let Some(period) = self.controller_period {
            self.whole(period, "controller period")?;
        }
        self.pushes.iter().try_for_each(|push| push.require(robot))
    }

    /// # Errors
    /// When the duration is no whole number of steps, or they are too many.
    pub(super) fn schedule<M: Motion>(&self, motion: &M) -> Result<Schedule> {
        let steps = match self.duration {
            Some(duration) => self.whole(duration, "duration")?,
            None => {
                let steps = motion.duration() / self.time_step;
                let whole = steps.round();
                let whole = if is_whole(steps) { whole } else { steps.ceil() };
                self.few(whole.max(1.0), motion.duration(), "duration")?
            }
        };
        let hold = match self.controller_period {
            Some(period) => self.whole(period, "controller period")?,
            None => 1,
        };
        Ok(Schedule { steps, hold })
    }

    /// # Errors
    /// When a push acts in no step.
    pub(super) fn require_in_time(&self, Schedule { steps, .. }: Schedule) -> Result<()> {
        for Push { from, to, .. } in &self.pushes {
            let first = (from / self.time_step - EARLY).ceil().max(0.0);
            if first >= steps as f64 || first + EARLY >= to / self.time_step {
                return refuse(
                    format!("a push from {from} s to {to} s, in which no step begins"),
                    &format!(
                        "one within {} s, of a time step of {} s or more",
                        steps as f64 * self.time_step,
                        self.time_step
                    ),
                );
            }
        }
        Ok(())
    }

    /// How many steps `time` is.
    fn whole(&self, time: f64, what: &str) -> Result<usize> {
        let steps = self.few(time / self.time_step, time, what)?;
        if is_whole(time / self.time_step) && steps > 0 {
            return Ok(steps);
        }
        let near = |n: f64| n * self.time_step;
        let (below, above) = (
            (time / self.time_step).floor(),
            (time / self.time_step).ceil(),
        );
        let expected = match below {
            0.0 => format!("at least one time step, {} s", near(1.0)),
            _ => format!(
                "a whole number of time steps: {} s or {} s",
                near(below),
                near(above)
            ),
        };
        refuse(
            format!(
                "{what} of {time} s with a time step of {} s",
                self.time_step
            ),
            &expected,
        )
    }

    fn few(&self, steps: f64, time: f64, what: &str) -> Result<usize> {
        if time > 0.0 && steps <= MOST_STEPS {
            return Ok(steps.round() as usize);
        }
        refuse(
            format!("{what} of {time} s"),
            &format!("a positive time of at most {MOST_STEPS:e} steps"),
        )
    }
}

impl Push {
    fn require(&self, robot: &Robot) -> Result<()> {
        let numbers = match &self.on {
            Pushed::Link { link, at, force } => {
                if robot.link(link)?.body == 0 {
                    let error = Error::new(ErrorKind::Infeasible, "a push on a link of the base");
                    return Err(error
                        .expected("a link that moves")
                        .at(format!("link `{link}`")));
                }
                at.iter().chain(force.iter()).copied().collect()
            }
            Pushed::Joint { joint, effort } => {
                robot.joints().index(joint)?;
                vec![*effort]
            }
        };
        if !numbers.iter().all(|x| x.is_finite()) {
            return refuse("a push that is not finite".to_owned(), "finite numbers");
        }
        if !(self.from >= 0.0 && self.from < self.to) {
            return refuse(
                format!("a push from {} s to {} s", self.from, self.to),
                "a stretch of time from 0 on",
            );
        }
        Ok(())
    }
}

fn is_whole(x: f64) -> bool {
    (x - x.round()).abs() <= WHOLE * x.abs().max(1.0)
}

pub(super) fn refuse<T>(what: String, expected: &str) -> Result<T> {
    Err(Error::new(ErrorKind::Setting, what).expected(expected.to_owned()))
}

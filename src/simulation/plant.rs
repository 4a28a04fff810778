//! What two plants have in common.

use nalgebra::DVector;

use super::controller::Command;
use super::energy::Work;
use crate::error::{Error, ErrorKind, Result};
use crate::robot::{Dynamics, GRAVITY, Robot};

/// What is said where a simulation has come to no numbers.
pub(super) fn not_finite() -> Error {
    Error::new(
        ErrorKind::Infeasible,
        "the simulation leaves the finite numbers",
    )
    .help("a motion beyond the robot's limits does this, as do a large time step and absurd masses or pushes")
}

/// The state of a plant between two steps.
#[derive(Debug, Clone)]
pub(super) struct PlantState {
    /// \[rad, m\]
    pub position: DVector<f64>,
    /// \[rad/s, m/s\]
    pub velocity: DVector<f64>,
    /// What the motors gave in the step before \[N m, N\].
    pub effort: DVector<f64>,
    /// Since the start.
    pub work: Work,
}

impl PlantState {
    pub fn new(position: DVector<f64>, velocity: DVector<f64>) -> Self {
        Self {
            effort: DVector::zeros(position.len()),
            position,
            velocity,
            work: Work::default(),
        }
    }

    /// Without allocation.
    pub fn copy_from(&mut self, other: &Self) {
        self.position.copy_from(&other.position);
        self.velocity.copy_from(&other.velocity);
        self.effort.copy_from(&other.effort);
        self.work = other.work;
    }

    /// Kinetic and potential energy \[J\].
    pub fn energies(&self, robot: &Robot, dynamics: &mut Dynamics) -> [f64; 2] {
        let (q, v) = (self.position.as_slice(), self.velocity.as_slice());
        dynamics.energies_at(robot, q, v, &GRAVITY)
    }

    pub fn is_finite(&self) -> bool {
        let Work {
            motors,
            losses,
            pushes,
            stops,
        } = self.work;
        let numbers = self.position.iter().chain(&self.velocity);
        let is_finite = numbers.chain(&self.effort).all(|x| x.is_finite());
        is_finite && (motors + losses + pushes + stops).is_finite()
    }
}

/// A robot that moves under gravity, motors and what else acts on it.
pub(super) trait Integrator {
    /// Takes a message of the controller.
    fn receive(&mut self, command: &Command);

    /// One time step from `time` on; kinetic and potential energy \[J\] at its start.
    ///
    /// # Errors
    /// When the plant has failed.
    fn step(&mut self, time: f64, state: &mut PlantState) -> Result<[f64; 2]>;

    /// Kinetic and potential energy \[J\].
    fn energies(&mut self, state: &PlantState) -> [f64; 2];

    /// # Errors
    /// When what the plant believes of itself does not fit together.
    fn require_sound(&mut self, state: &PlantState) -> Result<()>;
}

//! One condition: drawn until it is executable, and executed.

use rand::distr::Distribution;

use crate::collision::{CollisionModel, MinimumClearance};
use crate::error::{Error, ErrorKind, Result};
use crate::feasibility::Verdict;
use crate::fourier::Wave;
use crate::primitive::{FourierMovementPrimitive, Observation, stream};
use crate::retarget::JointMap;
use crate::robot::Robot;
use crate::simulation::{Rollout, Simulation, SimulationOptions};

/// Draws after which a condition is given up.
const MOST_DRAWS: u64 = 1000;

/// One condition, from the observation to the rollout.
pub(super) struct Case {
    pub name: &'static str,
    pub observation: Observation,
    pub primitive: FourierMovementPrimitive,
    /// As drawn, in learned joints; the first is executed.
    pub waves: Vec<Wave>,
    pub draws: u64,
    pub verdict: Verdict,
    pub clearance: MinimumClearance,
    pub rollout: Rollout,
}

/// Of smallest distances \[m\].
const ACCURACY: f64 = 1e-4;

/// What every condition is tried on.
pub(super) struct Bench<'a> {
    pub robot: &'a Robot,
    pub collision: &'a CollisionModel,
    pub map: &'a JointMap,
    pub seed: u64,
}

impl Bench<'_> {
    /// Conditions, draws two executable waves, and executes the first.
    pub fn case(
        &self,
        prior: &FourierMovementPrimitive,
        name: &'static str,
        observation: Observation,
    ) -> Result<Case> {
        let primitive = prior.condition(std::slice::from_ref(&observation))?;
        let mut draws = 0;
        let (first, verdict) = self.redraw(&primitive, &mut draws)?;
        let (second, _) = self.redraw(&primitive, &mut draws)?;
        let mapped = self.map.apply(&first, self.robot)?;
        let clearance = self.collision.minimum_clearance(&mapped, ACCURACY)?;
        let simulation = Simulation::new(self.robot, SimulationOptions::default())?;
        let rollout = simulation.run(&mapped)?;
        Ok(Case {
            name,
            observation,
            primitive,
            waves: vec![first, second],
            draws,
            verdict,
            clearance,
            rollout,
        })
    }

    /// The next draw that breaks no limit and touches nothing.
    fn redraw(
        &self,
        primitive: &FourierMovementPrimitive,
        draws: &mut u64,
    ) -> Result<(Wave, Verdict)> {
        while *draws < MOST_DRAWS {
            let wave = primitive.sample(&mut stream(self.seed, *draws));
            *draws += 1;
            let mapped = self.map.apply(&wave, self.robot)?;
            let verdict = Verdict::of(self.robot, self.collision, &mapped, 0.0)?;
            if verdict.passes() {
                return Ok((wave, verdict));
            }
        }
        Err(Error::new(
            ErrorKind::Infeasible,
            format!("none of {MOST_DRAWS} draws is executable"),
        )
        .expected("a wave within the robot's limits"))
    }
}

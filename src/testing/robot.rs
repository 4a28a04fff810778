//! Properties of a robot's motions, a line each.

use crate::collision::CollisionModel;
use crate::error::{Error, ErrorKind, Result};
use crate::feasibility::{Verdict, efforts, limits};
use crate::motion::Motion;
#[cfg(feature = "simulation")]
use crate::robot::JointKind;
use crate::robot::Robot;
#[cfg(feature = "simulation")]
use crate::simulation::Simulation;

/// Does a motion keep the limits that the robot's file gives? Those of positions and velocities by rigorous bounds over the whole motion, not by
/// samples; those of efforts, where the robot has masses, as [`efforts`] estimates them.
///
/// ```
/// use undulate::testing::proptest::prelude::*;
/// use undulate::testing::{keeps_limits, waves_of};
/// use undulate::{FourierMovementPrimitive, LearnOptions, shipped, synthetic};
///
/// let greeting = FourierMovementPrimitive::learn_with(&synthetic(0)?, 12, &LearnOptions::paper())?;
/// let robot = shipped::robot("wave_arm")?;
/// let map = shipped::map("wave_arm_demonstrator")?;
/// let config = ProptestConfig::with_cases(8);
/// # // The paper's Gaussian draws what a robot cannot do, seldom: not in a test of the documentation.
/// # let rng_seed = undulate::testing::proptest::test_runner::RngSeed::Fixed(1);
/// # let config = ProptestConfig { rng_seed, ..config };
/// proptest!(config, |(wave in waves_of(&greeting))| {
///     // A tenth as large as it was demonstrated.
///     let small = wave.scaled(&vec![0.1; wave.joints().len()])?;
///     keeps_limits(&robot, &map.apply(&small, &robot)?)?;
/// });
/// # Ok::<(), undulate::Error>(())
/// ```
///
/// # Errors
/// The worst of each kind of limit: joint, value, time and limit.
///
/// # Panics
/// When the `motion` is not of the robot's joints.
#[track_caller]
pub fn keeps_limits<M: Motion>(robot: &Robot, motion: &M) -> Result<()> {
    let limits = match limits(robot, motion) {
        Ok(limits) => limits,
        Err(e) => panic!("motion: {e}"),
    };
    let efforts = efforts(robot, motion).ok();
    without_fault(&Verdict {
        limits,
        efforts,
        collision: None,
        touches_too: None,
        clearance: None,
    })
}

/// Do all checked pairs of links, and of links and the scene, stay farther apart than `margin` \[m\]? Passes only by proof, between samples too
/// ([`Prover::certify`](crate::Prover::certify)): what can be neither proven nor refuted fails.
///
/// ```
/// use undulate::testing::keeps_clear;
/// use undulate::{CollisionModel, CollisionOptions, FourierMovementPrimitive, shipped, synthetic};
///
/// let greeting = FourierMovementPrimitive::learn(&synthetic(0)?, 12)?;
/// let robot = shipped::robot("wave_arm")?;
/// let wave = shipped::map("wave_arm_demonstrator")?.apply(&greeting.mean_wave(), &robot)?;
/// let collision = CollisionModel::new(&robot, &CollisionOptions::default())?;
/// keeps_clear(&collision, &wave, 0.005)?;
/// let error = keeps_clear(&collision, &wave, 0.5).unwrap_err().to_string();
/// assert!(error.contains(" m apart at ") && error.ends_with("expected more than 0.5 m"), "{error}");
/// # Ok::<(), undulate::Error>(())
/// ```
///
/// # Errors
/// A pair, its distance, the time and the margin; or where nothing could be proven.
///
/// # Panics
/// When `margin` is negative or no number, the `motion` is not of the robot's joints, or the model checks no pair.
#[track_caller]
pub fn keeps_clear<M: Motion>(collision: &CollisionModel, motion: &M, margin: f64) -> Result<()> {
    require_length("margin", margin);
    let found = match collision.certify(motion, margin, &[]) {
        Ok(found) => found,
        Err(e) if e.kind() == ErrorKind::Name => panic!("motion: {e}"),
        Err(e) => panic!("collision: {e}"),
    };
    let verdict = Verdict {
        limits: Vec::new(),
        efforts: None,
        collision: Some(found),
        touches_too: None,
        clearance: None,
    };
    without_fault(&verdict).map_err(|e| e.expected(format!("more than {margin} m")))
}

/// Does every joint stay within `tolerance` \[rad, m\] of the motion while it is executed, between the steps of time too
/// ([`Rollout::tolerance`](crate::Rollout::tolerance))? It is what a certificate of the motion has to allow for.
///
/// ```
/// use undulate::testing::tracks_within;
/// use undulate::{FourierMovementPrimitive, Simulation, SimulationOptions, shipped, synthetic};
///
/// let greeting = FourierMovementPrimitive::learn(&synthetic(0)?, 12)?;
/// let robot = shipped::robot("wave_arm")?;
/// let wave = shipped::map("wave_arm_demonstrator")?.apply(&greeting.mean_wave(), &robot)?;
/// let simulation = Simulation::new(&robot, SimulationOptions::default())?;
/// tracks_within(&simulation, &wave, 1e-3)?;
/// let error = tracks_within(&simulation, &wave, 1e-9).unwrap_err().to_string();
/// assert!(error.ends_with("expected at most 0.000000001 rad"), "{error}");
/// # Ok::<(), undulate::Error>(())
/// ```
///
/// # Errors
/// The joint that leaves its tolerance the farthest, how far it is off, when and what was allowed; and those of
/// [`Simulation::run`], a simulation that leaves the finite numbers among them.
///
/// # Panics
/// When `tolerance` is negative or no number, or the `motion` is not of the robot's joints.
#[cfg(feature = "simulation")]
#[track_caller]
pub fn tracks_within<M: Motion>(
    simulation: &Simulation<'_>,
    motion: &M,
    tolerance: f64,
) -> Result<()> {
    require_length("tolerance", tolerance);
    let rollout = match simulation.run(motion) {
        Ok(rollout) => rollout,
        Err(e) if e.kind() == ErrorKind::Name => panic!("motion: {e}"),
        Err(e) => return Err(e),
    };
    let off = nalgebra::DVector::from(rollout.tolerance());
    let (joint, most) = off.argmax();
    if most <= tolerance {
        return Ok(());
    }
    let error = rollout.position.column(joint) - rollout.reference.column(joint);
    let unit = match rollout.kinds[joint] {
        JointKind::Revolute => "rad",
        JointKind::Prismatic => "m",
    };
    Err(
        Error::new(ErrorKind::Infeasible, format!("off by {most:.6} {unit}"))
            .expected(format!("at most {tolerance} {unit}"))
            .at(format!("at {:.3} s", rollout.times[error.iamax()]))
            .at(format!("joint `{}`", rollout.joints.name(joint))),
    )
}

fn without_fault(verdict: &Verdict) -> Result<()> {
    let faults = verdict.faults();
    if faults.is_empty() {
        return Ok(());
    }
    let error = Error::new(ErrorKind::Infeasible, faults.join("; "));
    Err(match verdict.reasons().first() {
        Some(reason) => error.because(*reason),
        None => error,
    })
}

#[track_caller]
fn require_length(name: &str, value: f64) {
    assert!(
        value >= 0.0 && value.is_finite(),
        "{name} = {value}: a number from 0 on"
    );
}

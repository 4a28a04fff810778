//! Whether damping can be stable at a time step, before anything moves.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::loads::Losses;
use super::options::{SimulationOptions, refuse};
use crate::error::{Error, ErrorKind, Result};
use crate::robot::{Dynamics, Robot};

/// Explicit Runge-Kutta of fourth order damps x' = -a x while a dt is below this.
const RUNGE_KUTTA: f64 = 2.785;

/// # Errors
/// When damping is too strong for Runge-Kutta at the time step about one of `postures`.
pub(super) fn require(
    robot: &Robot,
    options: &SimulationOptions,
    postures: &[DVector<f64>],
) -> Result<()> {
    let losses = Losses::of_plant(robot, options);
    let mut damping = vec![0.0; robot.joints().len()];
    for (body, joint) in robot.moving() {
        damping[joint.index] += joint.multiplier.powi(2) * losses[body].damping;
    }
    if damping.iter().all(|d| *d == 0.0) {
        return Ok(());
    }
    let mut dynamics = Dynamics::new(robot);
    let mut fastest = 0.0_f64;
    let mut lightest = (0.0, 0);
    for posture in postures {
        let mass = dynamics.mass_matrix(robot, posture.as_slice());
        fastest = fastest.max(largest(mass, &damping, robot)?);
        for (joint, damping) in damping.iter().enumerate() {
            let alone = damping / mass[(joint, joint)];
            if alone > lightest.0 {
                lightest = (alone, joint);
            }
        }
    }
    if fastest * options.time_step < RUNGE_KUTTA {
        return Ok(());
    }
    let joint = robot.joints().name(lightest.1);
    let refused: Result<()> = refuse(
        format!(
            "the joints' damping is unstable with a time step of {} s, first that of `{joint}`",
            options.time_step
        ),
        &format!("below {:.3e} s", RUNGE_KUTTA / fastest),
    );
    refused.map_err(|e| e.help("take a smaller step (--time-step), or the other plant"))
}

/// The largest eigenvalue of M^-1 diag(d): that of L^-1 diag(d) L^-T, which is symmetric.
fn largest(mass: &DMatrix<f64>, diagonal: &[f64], robot: &Robot) -> Result<f64> {
    let singular = || {
        Error::new(ErrorKind::Infeasible, "a singular mass matrix")
            .expected("joints that each move some inertia")
            .at(format!("robot `{}`", robot.name()))
    };
    let factor = mass.clone().cholesky().ok_or_else(singular)?;
    let roots = DVector::from_iterator(diagonal.len(), diagonal.iter().map(|d| d.sqrt()));
    let mut half = DMatrix::from_diagonal(&roots);
    if !factor.l_dirty().solve_lower_triangular_mut(&mut half) {
        return Err(singular());
    }
    Ok(SymmetricEigen::new(&half * half.transpose())
        .eigenvalues
        .max())
}

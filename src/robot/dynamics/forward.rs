//! Forward dynamics: the accelerations that forces give.

use nalgebra::{DMatrix, Vector3};

use super::Dynamics;
use crate::error::{Error, ErrorKind, Result};
use crate::robot::Robot;

impl Dynamics {
    /// Accelerations a \[rad/s^2, m/s^2\] of the joints under generalized forces `tau` \[N m, N\] and `gravity` \[m/s^2\]:
    /// M(q) a = tau - C(q, v) v - g(q), by Cholesky's factor of the mass matrix (Featherstone 2008, section 6.1). Damping,
    /// friction and limits are not in it.
    ///
    /// # Errors
    /// When the mass matrix is singular to rounding here, or nothing of it is finite; the message names the joint. A robot
    /// that [`Robot::require_dynamics`] refuses is one of these; another may be in single configurations.
    pub fn forward(
        &mut self,
        robot: &Robot,
        q: &[f64],
        v: &[f64],
        tau: &[f64],
        gravity: &Vector3<f64>,
    ) -> Result<&[f64]> {
        self.place(robot, q);
        assert_eq!(tau.len(), self.forces.len(), "one force a joint");
        self.newton_euler(robot, v, None, gravity);
        self.composite_bodies(robot);
        self.factor.copy_from(&self.mass);
        if let Err(joint) = factorise(&mut self.factor) {
            return Err(singular(robot, joint));
        }
        for ((a, tau), bias) in self.accelerations.iter_mut().zip(tau).zip(&self.forces) {
            *a = tau - bias;
        }
        solve(&self.factor, &mut self.accelerations);
        Ok(&self.accelerations)
    }
}

#[cold]
fn singular(robot: &Robot, joint: usize) -> Error {
    Error::new(
        ErrorKind::Infeasible,
        format!(
            "joint `{}` moves no inertia of its own in this configuration",
            robot.joints().name(joint)
        ),
    )
    .expected("a mass matrix that is positive definite")
    .help("give every link that moves a mass and an inertia")
    .at(format!("robot `{}`", robot.name()))
}

/// L with L L^T = A in the lower triangle of A, column by column; the column at fault where a pivot is lost in rounding.
pub(crate) fn factorise(a: &mut DMatrix<f64>) -> std::result::Result<(), usize> {
    let n = a.nrows();
    for j in 0..n {
        let least = n as f64 * f64::EPSILON * a[(j, j)];
        for k in 0..j {
            let factor = a[(j, k)];
            for i in j..n {
                a[(i, j)] -= a[(i, k)] * factor;
            }
        }
        let pivot = a[(j, j)];
        // Also where the pivot is no number.
        if !(pivot > least && pivot.is_finite()) {
            return Err(j);
        }
        let root = pivot.sqrt();
        for i in j..n {
            a[(i, j)] /= root;
        }
    }
    Ok(())
}

/// x with L L^T x = b, in place.
pub(crate) fn solve(l: &DMatrix<f64>, x: &mut [f64]) {
    let n = x.len();
    for j in 0..n {
        x[j] /= l[(j, j)];
        for i in j + 1..n {
            x[i] -= l[(i, j)] * x[j];
        }
    }
    for j in (0..n).rev() {
        for i in j + 1..n {
            x[j] -= l[(i, j)] * x[i];
        }
        x[j] /= l[(j, j)];
    }
}

//! Forward dynamics: the accelerations that forces give.

use nalgebra::{DMatrix, Vector3};

use super::Dynamics;
use crate::error::{Error, ErrorKind, Result};
use crate::robot::Robot;

impl Dynamics {
    /// Accelerations a \[rad/s^2, m/s^2\] of the joints under generalized forces `tau` \[N m, N\] and `gravity` \[m/s^2\]:
    /// M(q) a = tau - C(q, v) v - g(q), by Cholesky's factors of the mass matrix (Featherstone 2008, section 6.1). Damping,
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

/// Cholesky's factors without roots: U^T D U = A, U with ones on its diagonal. Column by column in the upper triangle of A, with 1 / D in the
/// place of the ones; the column at fault where a pivot is lost in rounding.
pub(crate) fn factorise(a: &mut DMatrix<f64>) -> std::result::Result<(), usize> {
    let n = a.nrows();
    let a = a.as_mut_slice();
    // Of the arms that there are most, without loops.
    match n {
        6 => factorise_of(6, a),
        7 => factorise_of(7, a),
        n => factorise_of(n, a),
    }
}

#[inline(always)]
fn factorise_of(n: usize, a: &mut [f64]) -> std::result::Result<(), usize> {
    let a = &mut a[..n * n];
    for j in 0..n {
        let (before, column) = a.split_at_mut(j * n);
        let least = n as f64 * f64::EPSILON * column[j];
        // First D U, then U.
        for i in 1..j {
            let (above, own) = column.split_at_mut(i);
            own[0] -= dot(&before[i * n..][..i], above);
        }
        for i in 0..j {
            let entry = column[i] * before[i * n + i];
            column[j] -= column[i] * entry;
            column[i] = entry;
        }
        // Also where the pivot is no number.
        if !(column[j] > least && column[j].is_normal()) {
            return Err(j);
        }
        column[j] = column[j].recip();
    }
    Ok(())
}

/// x with U^T D U x = b, in place.
pub(crate) fn solve(u: &DMatrix<f64>, x: &mut [f64]) {
    let (n, u) = (x.len(), u.as_slice());
    match n {
        6 => solve_of(6, u, x),
        7 => solve_of(7, u, x),
        n => solve_of(n, u, x),
    }
}

#[inline(always)]
fn solve_of(n: usize, u: &[f64], x: &mut [f64]) {
    let (u, x) = (&u[..n * n], &mut x[..n]);
    for j in 1..n {
        let (above, own) = x.split_at_mut(j);
        own[0] -= dot(&u[j * n..][..j], above);
    }
    for j in 0..n {
        x[j] *= u[j * n + j];
    }
    for j in (1..n).rev() {
        let (above, own) = x.split_at_mut(j);
        for (x, u) in above.iter_mut().zip(&u[j * n..]) {
            *x -= u * own[0];
        }
    }
}

#[inline]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

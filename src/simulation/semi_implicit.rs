//! What takes Rapier's multibody from one velocity to another in a step.

use nalgebra::{DMatrix, DVector};

use super::loads::Losses;
use crate::robot::{Dynamics, GRAVITY, Robot, factorise, solve};

/// Inverse dynamics of a step of Rapier, which takes v' = v + dt (a + A^-1 tau) and q' = q + dt v'. M, C and g are of (q, v), damping is of
/// v', so that A = M + dt D; and what comes without motors is linearly implicit in Coriolis forces: (A + dt K) a = -c - D v + pushes, with
/// c = C v + g and K its derivative with respect to v.
///
/// So tau = A ((v' - v) / dt - a). To first order in dt K, with u = A^-1 (c + D v - pushes), this is inverse dynamics of (q, v,
/// (v' - v) / dt) and damping of v', less pushes and less dt K u. As c is quadratic in v, dt K u is c(v + dt u / 2) - c(v - dt u / 2)
/// exactly. Where gravity is large against the inertia of a mode, this is what matters most.
pub(super) struct SemiImplicit {
    dynamics: Dynamics,
    damping: DVector<f64>,
    matrix: DMatrix<f64>,
    /// dt u / 2.
    half: DVector<f64>,
    shifted: DVector<f64>,
    efforts: Vec<f64>,
}

impl SemiImplicit {
    pub fn new(robot: &Robot, losses: &[Losses]) -> Self {
        let joints = robot.joints().len();
        let mut damping = DVector::zeros(joints);
        for (body, joint) in robot.moving() {
            damping[joint.index] += joint.multiplier.powi(2) * losses[body].damping;
        }
        Self {
            dynamics: Dynamics::new(robot),
            damping,
            matrix: DMatrix::zeros(joints, joints),
            half: DVector::zeros(joints),
            shifted: DVector::zeros(joints),
            efforts: vec![0.0; robot.bodies().len()],
        }
    }

    /// The mass matrix of the posture that was asked about last.
    pub fn last_mass_matrix(&self) -> &DMatrix<f64> {
        self.dynamics.last_mass_matrix()
    }

    /// Along the joint of each body, damping, friction and pushes left out; `pushed` are forces of the joints.
    pub fn efforts(
        &mut self,
        robot: &Robot,
        [q, v, a]: [&DVector<f64>; 3],
        pushed: Option<&[f64]>,
        dt: f64,
    ) -> &[f64] {
        let dynamics = &mut self.dynamics;
        self.matrix
            .copy_from(dynamics.mass_matrix(robot, q.as_slice()));
        let forces = dynamics.inverse_again(robot, v.as_slice(), Some(a.as_slice()), &GRAVITY);
        for j in 0..self.half.len() {
            let inertial: f64 = self
                .matrix
                .column(j)
                .iter()
                .zip(a)
                .map(|(m, a)| m * a)
                .sum();
            self.half[j] = forces[j] - inertial + self.damping[j] * v[j];
            self.half[j] -= pushed.map_or(0.0, |p| p[j]);
        }
        self.efforts.copy_from_slice(dynamics.body_efforts());
        for (j, damping) in self.damping.iter().enumerate() {
            self.matrix[(j, j)] += dt * damping;
        }
        // What is singular is found out where it is integrated.
        if factorise(&mut self.matrix).is_ok() {
            solve(&self.matrix, self.half.as_mut_slice());
            self.half *= 0.5 * dt;
        } else {
            self.half.fill(0.0);
        }
        for sign in [1.0, -1.0] {
            self.shifted.copy_from(v);
            self.shifted.axpy(sign, &self.half, 1.0);
            dynamics.inverse_again(robot, self.shifted.as_slice(), None, &GRAVITY);
            for (own, shifted) in self.efforts.iter_mut().zip(dynamics.body_efforts()) {
                *own -= sign * shifted;
            }
        }
        &self.efforts
    }
}

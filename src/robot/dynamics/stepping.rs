//! What a plant asks for besides accelerations, from what they left in the workspace.

use nalgebra::{DMatrix, Vector3};

pub(crate) use super::forward::{factorise, solve};

use super::Dynamics;
use crate::robot::Robot;

impl Dynamics {
    /// [`inverse`](Self::inverse) for the configuration that was asked about last, whatever was asked; `None` for no acceleration.
    pub(crate) fn inverse_again(
        &mut self,
        robot: &Robot,
        v: &[f64],
        a: Option<&[f64]>,
        gravity: &Vector3<f64>,
    ) -> &[f64] {
        self.newton_euler(robot, v, a, gravity);
        &self.forces
    }

    /// Makes of `forces` what they add to the accelerations of the configuration that [`forward`](Self::forward) was asked about
    /// last: M(q)^-1 times them.
    pub(crate) fn respond(&self, forces: &mut [f64]) {
        solve(&self.factor, forces);
    }

    /// The mass matrix of that configuration.
    pub(crate) fn last_mass_matrix(&self) -> &DMatrix<f64> {
        &self.mass
    }

    /// Kinetic and potential energy \[J\] at `q` and `v`.
    pub(crate) fn energies_at(
        &mut self,
        robot: &Robot,
        q: &[f64],
        v: &[f64],
        gravity: &Vector3<f64>,
    ) -> [f64; 2] {
        let kinetic = self.kinetic_energy(robot, q, v);
        [kinetic, self.lifted(robot, gravity)]
    }

    /// Kinetic and potential energy \[J\] of the configuration that [`forward`](Self::forward) was asked about last, at
    /// velocity `v`: from the mass matrix and the composite bodies that it left, for next to nothing.
    pub(crate) fn energies(&self, robot: &Robot, v: &[f64], gravity: &Vector3<f64>) -> [f64; 2] {
        let mut kinetic = 0.0;
        for (i, a) in v.iter().enumerate() {
            let row: f64 = v[..i]
                .iter()
                .zip(&self.mass.as_slice()[i * v.len()..])
                .map(|(b, m)| b * m)
                .sum();
            kinetic += a * (row + 0.5 * self.mass[(i, i)] * a);
        }
        let on_base = robot.steps.iter().enumerate().skip(1);
        let potential = on_base
            .filter(|(_, step)| step.parent == 0)
            .map(|(i, _)| {
                let all = &self.composites[i];
                -gravity.dot(&(self.placed[i].arm * all.mass + all.moment))
            })
            .sum();
        [kinetic, potential]
    }
}

//! Impulses along joints that bring velocities to rest, each within bounds: friction and stops.

use nalgebra::{DMatrix, DVector};

use crate::robot::{Dynamics, Robot};

/// Sweeps over the joints; the error falls geometrically, faster the less the joints move each other.
const SWEEPS: usize = 50;

/// Smaller changes of a velocity end the sweeps \[rad/s, m/s\].
const STILL: f64 = 1e-14;

/// For some joints bounds on an impulse \[N m s, N s\], and the impulses that were found.
pub(super) struct Impulses {
    /// Joint, least and largest impulse, impulse.
    rows: Vec<(usize, [f64; 2], f64)>,
    /// Columns of the inverse of the mass matrix, in the order of `rows`.
    response: DMatrix<f64>,
}

impl Impulses {
    pub fn new(robot: &Robot) -> Self {
        let joints = robot.joints().len();
        Self {
            rows: Vec::with_capacity(joints),
            response: DMatrix::zeros(joints, joints),
        }
    }

    pub fn clear(&mut self) {
        self.rows.clear();
    }

    pub fn add(&mut self, joint: usize, bounds: [f64; 2]) {
        self.rows.push((joint, bounds, 0.0));
    }

    /// Each joint and its impulse.
    pub fn all(&self) -> impl Iterator<Item = (usize, f64)> {
        self.rows
            .iter()
            .map(|(joint, _, impulse)| (*joint, *impulse))
    }

    /// Changes `velocity` by impulses that bring each of the joints as near to rest as its bounds allow, all at once: projected
    /// Gauss-Seidel on the linear complementarity problem of Moreau's time stepping ("Unilateral contact and dry friction in
    /// finite freedom dynamics", 1988). The mass matrix is that of the configuration for which `dynamics` found accelerations
    /// last.
    pub fn bring_to_rest(&mut self, dynamics: &Dynamics, velocity: &mut DVector<f64>) {
        for (i, (joint, ..)) in self.rows.iter().enumerate() {
            let mut column = self.response.column_mut(i);
            column.fill(0.0);
            column[*joint] = 1.0;
            dynamics.respond(column.as_mut_slice());
        }
        for _ in 0..SWEEPS {
            let mut most = 0.0_f64;
            for (i, (joint, [least, largest], impulse)) in self.rows.iter_mut().enumerate() {
                let own = self.response[(*joint, i)];
                let wanted = (*impulse - velocity[*joint] / own).clamp(*least, *largest);
                let change = wanted - *impulse;
                *impulse = wanted;
                velocity.axpy(change, &self.response.column(i), 1.0);
                most = most.max((change * own).abs());
            }
            if most <= STILL {
                break;
            }
        }
    }
}

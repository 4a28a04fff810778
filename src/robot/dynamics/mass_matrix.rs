//! The mass matrix: the composite-rigid-body algorithm.

use nalgebra::DMatrix;

use super::{Dynamics, Placed, SpatialInertia, place};
use crate::robot::Robot;
use crate::robot::kinematics::Step;

impl Dynamics {
    /// The mass matrix M(q) of the commanded joints \[kg m^2, kg m, kg\], joints x joints: exactly symmetric, and positive
    /// definite where every joint moves some inertia that the others cannot hold still. The kinetic energy is v^T M v / 2.
    /// Composite rigid bodies (Featherstone 2008, section 6.2, table 6.2); with a gear matrix G of the mimics' multipliers
    /// it is G^T M_bodies G, summed entry by entry.
    pub fn mass_matrix(&mut self, robot: &Robot, q: &[f64]) -> &DMatrix<f64> {
        self.place(robot, q);
        self.composite_bodies(robot);
        &self.mass
    }

    /// The diagonal of the mass matrix \[kg m^2, kg\]: the force that gives one joint unit acceleration while all else rests.
    pub fn mass_diagonal(&mut self, robot: &Robot, q: &[f64]) -> Vec<f64> {
        self.mass_matrix(robot, q)
            .diagonal()
            .iter()
            .copied()
            .collect()
    }

    /// The mass matrix for bodies that have been placed.
    pub(super) fn composite_bodies(&mut self, robot: &Robot) {
        let mass = &mut self.mass;
        mass.fill(0.0);
        composite_bodies(
            &robot.steps,
            &self.placed,
            &mut self.composites,
            |_| true,
            |a, b, value| {
                mass[(a, b)] += value;
                // Where two bodies follow one joint, a = b, and their product counts twice all the same.
                mass[(b, a)] += value;
            },
        );
    }
}

/// The diagonal alone, in memory and (but for mimics) time proportional to the number of bodies.
pub(in crate::robot) fn mass_diagonal(robot: &Robot, q: &[f64]) -> Vec<f64> {
    let steps = &robot.steps;
    let mut placed = vec![Placed::base(); steps.len()];
    place(robot, q, &mut placed);
    let mut followers = vec![0; q.len()];
    for step in &steps[1..] {
        followers[step.index] += 1;
    }
    let mut composites = vec![SpatialInertia::zero(); steps.len()];
    let mut diagonal = vec![0.0; q.len()];
    composite_bodies(
        steps,
        &placed,
        &mut composites,
        |step| followers[step.index] > 1,
        |a, b, value| {
            if a == b {
                diagonal[a] += 2.0 * value;
            }
        },
    );
    diagonal
}

/// Calls `entry` with half of each diagonal entry, and with each other entry of one triangle of the bodies' mass matrix,
/// multipliers multiplied in; the rest of a body's row is left out where `whole` says so.
fn composite_bodies(
    steps: &[Step],
    placed: &[Placed],
    composites: &mut [SpatialInertia],
    whole: impl Fn(&Step) -> bool,
    mut entry: impl FnMut(usize, usize, f64),
) {
    for (composite, placed) in composites.iter_mut().zip(placed) {
        composite.clone_from(&placed.inertia);
    }
    for (i, step) in steps.iter().enumerate().skip(1).rev() {
        let Placed { axis, arm, .. } = &placed[i];
        let mut wrench = composites[i].starting(step.kind, axis);
        let own = step.multiplier * step.multiplier * wrench.along(step.kind, axis);
        entry(step.index, step.index, 0.5 * own);
        if step.parent == 0 {
            continue;
        }
        let carried = composites[i].carried(arm);
        composites[step.parent].add(&carried);
        if !whole(step) {
            continue;
        }
        let mut body = i;
        while steps[body].parent != 0 {
            wrench = wrench.carried(&placed[body].arm);
            body = steps[body].parent;
            let above = &steps[body];
            let along = wrench.along(above.kind, &placed[body].axis);
            let value = step.multiplier * above.multiplier * along;
            entry(step.index, above.index, value);
        }
    }
}

//! Least squares on the Fourier weights of a robot's joints: Levenberg's method on the normal equations.

use nalgebra::{DMatrix, DVector, Matrix3xX, Vector3};

use super::arm::Pointing;
use crate::fourier::Interval;
use crate::robot::{Kinematics, Robot};

/// A step is damped by this share of the largest diagonal entry at first.
const DAMPING: f64 = 1e-3;

/// Damping beyond this share leaves no step that double precision could see.
const STIFFEST: f64 = 1e15;

/// A descent ends with a step that gains less than this share of the cost.
const GAIN: f64 = 1e-9;

/// A cost below this is rounding: errors of 1e-14 rad.
const NOTHING: f64 = 1e-28;

/// What is to be least, a mean over instants n:
///
/// ```text
/// sum_m weight_m |d_m(q(t_n)) - target_{n,m}|^2  +  stiffness^2 sum_j excess_j(q(t_n))^2  +  pull^2 |offsets - rest|^2
/// ```
///
/// with q = basis x parameters, and excess how far a joint is beyond its limits. Parameters are basis functions x active joints; the
/// first basis function is 1.
pub(super) struct Problem<'a> {
    pub robot: &'a Robot,
    pub pointers: &'a [Pointing<'a>],
    /// Joints that move a pointer; the others are at rest.
    pub active: &'a [usize],
    pub limits: &'a [Option<Interval>],
    pub rest: &'a [f64],
    /// Instants x functions.
    pub basis: DMatrix<f64>,
    /// Instants, pointers.
    pub targets: Vec<Vec<Vector3<f64>>>,
    pub stiffness: f64,
    pub pull: f64,
}

/// The cost about some parameters: cost + gradient . step + step . hessian step / 2, halved.
struct Quadratic {
    cost: f64,
    gradient: DVector<f64>,
    hessian: DMatrix<f64>,
}

impl Problem<'_> {
    /// The parameters after at most so many steps downhill, and their cost.
    pub fn descend(&self, mut parameters: DMatrix<f64>, steps: usize) -> (DMatrix<f64>, f64) {
        let mut kinematics = Kinematics::new(self.robot);
        let mut damping = DAMPING;
        let mut now = self.quadratic(&mut kinematics, &parameters);
        for _ in 0..steps {
            let scale = now.hessian.diagonal().amax();
            if now.cost < NOTHING || scale == 0.0 {
                break;
            }
            let mut growth = 2.0;
            let (next, cost, expected) = loop {
                if damping > STIFFEST {
                    return (parameters, now.cost);
                }
                let mut damped = now.hessian.clone();
                for i in 0..damped.nrows() {
                    damped[(i, i)] += damping * scale;
                }
                if let Some(factor) = damped.cholesky() {
                    let step = -factor.solve(&now.gradient);
                    let change = DMatrix::from_column_slice(
                        parameters.nrows(),
                        parameters.ncols(),
                        step.as_slice(),
                    );
                    let next = &parameters + change;
                    let cost = self.cost(&mut kinematics, &next);
                    if cost < now.cost {
                        // What the quadratic promised.
                        let expected =
                            -step.dot(&now.gradient) + damping * scale * step.norm_squared();
                        break (next, cost, expected);
                    }
                }
                damping *= growth;
                growth *= 2.0;
            };
            // Nielsen's rule: by how well the quadratic foretold the gain (Madsen, Nielsen and Tingleff, "Methods for non-linear
            // least squares problems", 2004, section 3.2).
            let ratio = (now.cost - cost) / expected;
            damping *= (1.0 - (2.0 * ratio - 1.0).powi(3)).max(1.0 / 3.0);
            let gained = now.cost - cost;
            parameters = next;
            if gained < GAIN * cost {
                return (parameters, cost);
            }
            now = self.quadratic(&mut kinematics, &parameters);
        }
        (parameters, now.cost)
    }

    pub fn cost(&self, kinematics: &mut Kinematics, parameters: &DMatrix<f64>) -> f64 {
        let positions = &self.basis * parameters;
        let mut q = self.rest.to_vec();
        let mut sum = 0.0;
        for (n, targets) in self.targets.iter().enumerate() {
            for (a, joint) in self.active.iter().enumerate() {
                q[*joint] = positions[(n, a)];
                let excess = self.excess(*joint, q[*joint]);
                sum += self.stiffness * self.stiffness * excess * excess;
            }
            for (pointer, target) in self.pointers.iter().zip(targets) {
                let direction = pointer.direction(self.robot, kinematics, &q);
                sum += pointer.weight * (direction - target).norm_squared();
            }
        }
        sum / self.targets.len() as f64 + self.pulled(parameters)
    }

    /// How far a position is beyond the limits, with its sign.
    fn excess(&self, joint: usize, position: f64) -> f64 {
        self.limits[joint].map_or(0.0, |l| position - position.max(l.lower).min(l.upper))
    }

    fn pulled(&self, parameters: &DMatrix<f64>) -> f64 {
        let offsets = parameters.row(0);
        let away = self.active.iter().zip(offsets.iter());
        self.pull * self.pull * away.map(|(j, x)| (x - self.rest[*j]).powi(2)).sum::<f64>()
    }

    fn quadratic(&self, kinematics: &mut Kinematics, parameters: &DMatrix<f64>) -> Quadratic {
        let (instants, functions, d) = (self.targets.len(), self.basis.ncols(), self.active.len());
        let positions = &self.basis * parameters;
        let mut q = self.rest.to_vec();
        let mut rates = Matrix3xX::zeros(self.robot.joints().len());
        let mut sum = 0.0;
        // Of each instant, the derivatives by the positions then: of the cost by each, and by each two, halved.
        let mut slopes = DMatrix::<f64>::zeros(instants, d);
        let mut curvatures = DMatrix::<f64>::zeros(instants, d * d);
        for (n, targets) in self.targets.iter().enumerate() {
            for (a, joint) in self.active.iter().enumerate() {
                q[*joint] = positions[(n, a)];
                let excess = self.excess(*joint, q[*joint]);
                let stiff = self.stiffness * self.stiffness;
                sum += stiff * excess * excess;
                if excess != 0.0 {
                    slopes[(n, a)] += stiff * excess;
                    curvatures[(n, a * d + a)] += stiff;
                }
            }
            for (pointer, target) in self.pointers.iter().zip(targets) {
                let direction = pointer.linearised(self.robot, kinematics, &q, &mut rates);
                let error = direction - target;
                sum += pointer.weight * error.norm_squared();
                for (a, joint) in self.active.iter().enumerate() {
                    let rate = rates.column(*joint) * pointer.weight;
                    slopes[(n, a)] += rate.dot(&error);
                    for (b, other) in self.active[..=a].iter().enumerate() {
                        curvatures[(n, a * d + b)] += rate.dot(&rates.column(*other));
                    }
                }
            }
        }
        let share = 1.0 / instants as f64;
        let mut gradient = DVector::zeros(functions * d);
        let mut hessian = DMatrix::zeros(functions * d, functions * d);
        let size = (functions, functions);
        for a in 0..d {
            let slope = self.basis.tr_mul(&slopes.column(a)) * share;
            gradient
                .rows_mut(a * functions, functions)
                .copy_from(&slope);
            for b in 0..=a {
                let mut weighted = self.basis.clone();
                for (n, mut row) in weighted.row_iter_mut().enumerate() {
                    row *= curvatures[(n, a * d + b)] * share;
                }
                let block = self.basis.tr_mul(&weighted);
                let (at, across) = (a * functions, b * functions);
                hessian.view_mut((at, across), size).copy_from(&block);
                hessian.view_mut((across, at), size).copy_from(&block);
            }
            let at = a * functions;
            let pull = self.pull * self.pull;
            gradient[at] += pull * (parameters[(0, a)] - self.rest[self.active[a]]);
            hessian[(at, at)] += pull;
        }
        Quadratic {
            cost: sum * share + self.pulled(parameters),
            gradient,
            hessian,
        }
    }
}

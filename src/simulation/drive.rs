//! The motors of the plant by Runge-Kutta.

use nalgebra::{DMatrix, DVector};

use super::controller::{Command, Gains};
use super::loads::gathered;
use super::options::SimulationOptions;
use super::plant::not_finite;
use crate::error::Result;
use crate::robot::{Dynamics, Robot, factorise, solve};

/// Springs, dampers and feed-forward whose torques are held over a step, chosen for what they bring about at its end: the stable
/// proportional-derivative control of Tan, Liu and Turk ("Stable proportional-derivative controllers", 2011).
///
/// With the acceleration a held over the step, position and velocity at its end are q + dt v + dt^2 a / 2 and v + dt a. Torques that are
/// the springs' there solve (M + dt Kd + dt^2 Kp / 2) a = M a0 + forward + Kp (r - q - dt v) + Kd (s - v), a0 being what comes without
/// motors. For a mode of M whose loop has k = mu w^2 dt^2 / n and c = 2 mu w dt / n, n = 1 + 2 mu w dt + mu w^2 dt^2 / 2, the map of a
/// step has trace 2 - 3 k / 2 - c and determinant 1 - c - k / 2, and Jury's criterion holds whatever mu, w and dt are. Torques of the
/// state at the start of the step would be unstable where others yield as one joint accelerates: mu is 67 in a posture of `wave_arm`
/// whose shoulder and forearm turn about nearly the same axis, and 12 Hz would need steps of 0.2 ms.
pub(super) struct Drive {
    dt: f64,
    gains: Vec<Gains>,
    /// Of the motors, by joint.
    limits: Vec<f64>,
    /// The last message, and the steps since, of how many.
    position: [DVector<f64>; 2],
    velocity: [DVector<f64>; 2],
    forward: Vec<f64>,
    taken: usize,
    hold: usize,
    matrix: DMatrix<f64>,
    right: Vec<f64>,
    /// What motors must bear, and the mass matrix, in the middle of the step.
    needed: DVector<f64>,
    mass: DMatrix<f64>,
    /// Both at the start of the step before.
    before: Option<(DVector<f64>, DMatrix<f64>)>,
    acceleration: DVector<f64>,
    is_saturated: Vec<bool>,
}

impl Drive {
    /// `inertia` is what each joint moves in the posture that gains are for; a message holds for `hold` steps.
    pub fn new(robot: &Robot, options: &SimulationOptions, inertia: &[f64], hold: usize) -> Self {
        let joints = inertia.len();
        let pair = || [DVector::zeros(joints), DVector::zeros(joints)];
        Self {
            dt: options.time_step,
            gains: inertia
                .iter()
                .map(|own| Gains::critical(*own, options.bandwidth))
                .collect(),
            limits: (0..joints)
                .map(|j| robot.properties(j).effort.filter(|_| options.effort_limits))
                .map(|limit| limit.unwrap_or(f64::INFINITY))
                .collect(),
            position: pair(),
            velocity: pair(),
            forward: vec![0.0; joints],
            taken: 0,
            hold,
            matrix: DMatrix::zeros(joints, joints),
            right: vec![0.0; joints],
            needed: DVector::zeros(joints),
            mass: DMatrix::zeros(joints, joints),
            before: None,
            acceleration: DVector::zeros(joints),
            is_saturated: vec![false; joints],
        }
    }

    pub fn receive(&mut self, robot: &Robot, command: &Command) {
        for (own, sent) in self.position.iter_mut().zip(&command.position) {
            own.copy_from(sent);
        }
        for (own, sent) in self.velocity.iter_mut().zip(&command.velocity) {
            own.copy_from(sent);
        }
        gathered(robot, &command.forward, &mut self.forward);
        self.taken = 0;
    }

    /// Begins a step, where `dynamics` found these accelerations without motors and friction.
    pub fn begin(&mut self, dynamics: &Dynamics, free_accelerations: &DVector<f64>) {
        self.taken += 1;
        self.look_ahead(dynamics.last_mass_matrix(), free_accelerations);
    }

    /// The torques of a step from (q, v), with friction as it is known. Motors at their limits give that, and the others are solved for again.
    ///
    /// # Errors
    /// When nothing of it is finite.
    pub fn torques(
        &mut self,
        [q, v, rubbing]: [&DVector<f64>; 3],
        tau: &mut DVector<f64>,
    ) -> Result<()> {
        let share = self.taken as f64 / self.hold as f64;
        let dt = self.dt;
        self.is_saturated.fill(false);
        // What the motors give were the acceleration 0.
        for (j, gains) in self.gains.iter().enumerate() {
            let [p, s] = [&self.position, &self.velocity]
                .map(|[from, to]| from[j] + share * (to[j] - from[j]));
            tau[j] = self.forward[j]
                + gains.stiffness * (p - q[j] - dt * v[j])
                + gains.damping * (s - v[j]);
            self.right[j] = tau[j];
        }
        loop {
            self.matrix.copy_from(&self.mass);
            for (j, gains) in self.gains.iter().enumerate() {
                let own = if self.is_saturated[j] {
                    0.0
                } else {
                    self.slope(gains)
                };
                self.matrix[(j, j)] += own;
                self.acceleration[j] = self.needed[j] + tau[j] + rubbing[j];
            }
            if factorise(&mut self.matrix).is_err() {
                return Err(not_finite());
            }
            solve(&self.matrix, self.acceleration.as_mut_slice());
            let mut is_new = false;
            for (j, gains) in self.gains.iter().enumerate() {
                if self.is_saturated[j] {
                    continue;
                }
                let wanted = self.right[j] - self.slope(gains) * self.acceleration[j];
                if wanted.abs() > self.limits[j] {
                    self.is_saturated[j] = true;
                    is_new = true;
                    tau[j] = wanted.clamp(-self.limits[j], self.limits[j]);
                }
            }
            if !is_new {
                break;
            }
        }
        for (j, gains) in self.gains.iter().enumerate() {
            if !self.is_saturated[j] {
                tau[j] = self.right[j] - self.slope(gains) * self.acceleration[j];
            }
        }
        Ok(())
    }

    /// What motors must bear and the mass matrix in the middle of the step: they go on as they did in the step before.
    fn look_ahead(&mut self, mass: &DMatrix<f64>, free_accelerations: &DVector<f64>) {
        for (j, needed) in self.needed.iter_mut().enumerate() {
            let row = mass.column(j);
            *needed = row.iter().zip(free_accelerations).map(|(m, a)| m * a).sum();
        }
        self.mass.copy_from(mass);
        match &mut self.before {
            None => self.before = Some((self.needed.clone(), self.mass.clone())),
            Some((needed, mass)) => {
                let ahead = |now: &mut [f64], before: &mut [f64]| {
                    for (now, before) in now.iter_mut().zip(before) {
                        let step = *now - *before;
                        *before = *now;
                        *now += 0.5 * step;
                    }
                };
                ahead(self.needed.as_mut_slice(), needed.as_mut_slice());
                ahead(self.mass.as_mut_slice(), mass.as_mut_slice());
            }
        }
    }

    /// What acceleration takes off a torque.
    fn slope(&self, gains: &Gains) -> f64 {
        self.dt * gains.damping + 0.5 * self.dt * self.dt * gains.stiffness
    }
}

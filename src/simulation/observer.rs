//! What the torque model misses, told from what the joints did.

use nalgebra::{DMatrix, DVector};

use crate::robot::Robot;

/// So many times as fast as the position loops. Faster would keep less of what the model misses, in proportion, and bear less of a wrong mass
/// matrix: the loop is stable while no direction has 2 / `share` times the inertia by the model that it has, which is 9.9 for loops of 12 Hz
/// and messages every millisecond.
const SPEED: f64 = 3.0;

/// A disturbance observer (Ohnishi, Shibata and Murakami, "Motion control for advanced mechatronics", 1996).
///
/// Over the last period the motors gave tau, and the joints accelerated by a: by the model, what was fed forward and M (a - a of the motion)
/// account for it, and the rest is what the model misses. That passes a low-pass of first order and is fed forward too. With a right
/// mass matrix the position loops are what they were, and what acts on the joints moves them as before, but behind a high-pass: at loops of 12 Hz a
/// wave of 1.5 Hz keeps a twenty-fourth of its error.
///
/// As it is told what motors gave, and not what they were to give, limits of effort do not wind it up. Joints that others mimic
/// are left out: what the motors of those bear is not told.
pub(super) struct Observer {
    period: f64,
    /// Of what is missed now, in a period.
    share: f64,
    is_observed: Vec<bool>,
    /// Of the last message: what motors are to give for the motion, by the model; the inertia and acceleration that this is for, and the velocity that
    /// it found.
    expected: DVector<f64>,
    mass: DMatrix<f64>,
    acceleration: DVector<f64>,
    velocity: DVector<f64>,
    missing: DVector<f64>,
}

impl Observer {
    /// For position loops of `bandwidth` \[Hz\] and messages every `period` \[s\].
    pub fn new(robot: &Robot, bandwidth: f64, period: f64) -> Self {
        let joints = robot.joints().len();
        let mut is_observed = vec![true; joints];
        for (_, joint) in robot.moving() {
            is_observed[joint.index] &= joint.is_commanded;
        }
        let zeros = || DVector::zeros(joints);
        Self {
            period,
            share: -(-SPEED * std::f64::consts::TAU * bandwidth * period).exp_m1(),
            is_observed,
            expected: zeros(),
            mass: DMatrix::zeros(joints, joints),
            acceleration: zeros(),
            velocity: zeros(),
            missing: zeros(),
        }
    }

    /// Takes in that the joints have come to `velocity`, and that motors `gave` so much since the last message, on average.
    pub fn see(&mut self, velocity: &DVector<f64>, gave: &DVector<f64>) {
        for (j, missing) in self.missing.iter_mut().enumerate() {
            if !self.is_observed[j] {
                continue;
            }
            let mut accounted = self.expected[j];
            for (i, mass) in self.mass.column(j).iter().enumerate() {
                let came = (velocity[i] - self.velocity[i]) / self.period;
                accounted += mass * (came - self.acceleration[i]);
            }
            *missing += self.share * (gave[j] - accounted - *missing);
        }
    }

    /// Notes what a message is for: the efforts of the motion by the model, whose mass matrix is `scale` times `mass`.
    pub fn expect(
        &mut self,
        efforts: &[f64],
        (mass, scale): (&DMatrix<f64>, f64),
        acceleration: &DVector<f64>,
        velocity: &DVector<f64>,
    ) {
        self.expected.as_mut_slice().copy_from_slice(efforts);
        self.mass.copy_from(mass);
        self.mass *= scale;
        self.acceleration.copy_from(acceleration);
        self.velocity.copy_from(velocity);
    }

    /// What is to be added along the joint of each \[N m, N\].
    pub fn missing(&self) -> &DVector<f64> {
        &self.missing
    }
}

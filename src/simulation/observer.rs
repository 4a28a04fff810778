//! What the torque model misses, told from what the joints did.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::options::refuse;
use crate::error::{Error, Result};
use crate::robot::{Dynamics, Robot};

/// So many times as fast as the position loops. Faster would keep less of what the model misses, in proportion, and bear less of a wrong mass
/// matrix.
const SPEED: f64 = 3.0;

/// So much heavier than by the model may what a joint moves be. A mode whose inertia is r times the model's has, with the observer g times as fast as its
/// loop of w, the polynomial r s^3 + (g + 2) w s^2 + (1 + 2 g) w^2 s + g w^3, which is stable for r < (g + 2) (1 + 2 g) / g (Routh). A tenth is kept
/// for messages that come now and then.
const HEAVIEST: f64 = 0.9 * (SPEED + 2.0) * (1.0 + 2.0 * SPEED) / SPEED;

/// A disturbance observer (Ohnishi, Shibata and Murakami, "Motion control for advanced mechatronics", 1996).
///
/// Over the last period the motors gave tau, and the joints accelerated by a: by the model, what was fed forward and M (a - a of the motion)
/// account for it, and the rest is what the model misses. That passes a low-pass of first order and is fed forward too. With a right
/// mass matrix the position loops are what they were, and what acts on the joints moves them as before, but behind a high-pass: at loops of 12 Hz a
/// wave of 1.5 Hz keeps a twenty-fourth of its error.
///
/// As it is told what motors gave, and not what they were to give, limits of effort do not wind it up. At its stop a joint is not observed, and what it missed fades: what the
/// stop bears is not told. Joints that others mimic are left out: neither is what the motors of those bear.
pub(super) struct Observer {
    period: f64,
    /// Of what is missed now, in a period.
    share: f64,
    is_observed: Vec<bool>,
    /// Between its stops, by joint.
    ranges: Vec<[f64; 2]>,
    /// Of the last message: what motors are to give for the motion, by the model; the inertia and acceleration that this is for, and the velocity that
    /// it found.
    expected: DVector<f64>,
    mass: DMatrix<f64>,
    acceleration: DVector<f64>,
    velocity: DVector<f64>,
    missing: DVector<f64>,
}

/// What of a difference is taken in with each message, `period` \[s\] after the last.
fn share(bandwidth: f64, period: f64) -> f64 {
    -(-SPEED * std::f64::consts::TAU * bandwidth * period).exp_m1()
}

/// # Errors
/// When in one of `postures` what the `plant` moves is so much heavier than by the `model`, whose torques are `scale` times as large, or so much lighter,
/// that the observer cannot be stable with loops of `bandwidth` \[Hz\] and messages every `period` \[s\].
pub(super) fn require_stable(
    (model, scale): (&Robot, f64),
    plant: Option<&Robot>,
    postures: &[DVector<f64>],
    bandwidth: f64,
    period: f64,
) -> Result<()> {
    let mut range = [f64::INFINITY, 0.0_f64];
    match plant {
        None => range = [scale.recip(); 2],
        Some(plant) => {
            let [mut by_model, mut there] = [model, plant].map(Dynamics::new);
            for q in postures {
                let masses = [
                    by_model.mass_matrix(model, q.as_slice()),
                    there.mass_matrix(plant, q.as_slice()),
                ];
                for ratio in ratios(masses).into_iter().flatten() {
                    range = [range[0].min(ratio / scale), range[1].max(ratio / scale)];
                }
            }
        }
    }
    let help = "take the observer off (--no-observer)";
    if range[1] > HEAVIEST {
        let what = format!(
            "the observer is unstable: what is moved has up to {:.1} times the inertia by the model",
            range[1]
        );
        return refuse(what, &format!("up to {HEAVIEST:.1} times"))
            .map_err(|e: Error| e.help(format!("{help}, or carry less")));
    }
    let lightest = share(bandwidth, period) / 2.0;
    if range[0] < lightest {
        let what = format!(
            "the observer is unstable: what is moved has down to {:.3} of the inertia by the model",
            range[0]
        );
        return refuse(
            what,
            &format!("at least {lightest:.3} with a message every {period} s"),
        )
        .map_err(|e: Error| e.help(format!("{help}, or send messages more often")));
    }
    Ok(())
}

/// Of two mass matrices, by mode the second's inertia over the first's: eigenvalues of L^-1 B L^-T, with A = L L^T. None where A is singular.
fn ratios([a, b]: [&DMatrix<f64>; 2]) -> Option<Vec<f64>> {
    let factor = a.clone().cholesky()?;
    let mut half = b.clone();
    factor.l_dirty().solve_lower_triangular_mut(&mut half);
    let mut whole = half.transpose();
    factor.l_dirty().solve_lower_triangular_mut(&mut whole);
    let eigenvalues = SymmetricEigen::new(whole).eigenvalues;
    Some(eigenvalues.iter().copied().collect())
}

impl Observer {
    /// For position loops of `bandwidth` \[Hz\] and messages every `period` \[s\].
    pub fn new(robot: &Robot, bandwidth: f64, period: f64) -> Self {
        let joints = robot.joints().len();
        let ranges = (0..joints).map(|j| match robot.properties(j).position {
            Some(range) => [range.lower, range.upper],
            None => [f64::NEG_INFINITY, f64::INFINITY],
        });
        let mut is_observed = vec![true; joints];
        for (_, joint) in robot.moving() {
            is_observed[joint.index] &= joint.is_commanded;
        }
        let zeros = || DVector::zeros(joints);
        Self {
            period,
            share: share(bandwidth, period),
            is_observed,
            ranges: ranges.collect(),
            expected: zeros(),
            mass: DMatrix::zeros(joints, joints),
            acceleration: zeros(),
            velocity: zeros(),
            missing: zeros(),
        }
    }

    /// Takes in that the joints have come to a position and velocity, and that motors `gave` so much since the last message, on average.
    pub fn see(&mut self, [position, velocity, gave]: [&DVector<f64>; 3]) {
        for (j, missing) in self.missing.iter_mut().enumerate() {
            let [lower, upper] = self.ranges[j];
            if !self.is_observed[j] {
                continue;
            }
            if !(lower < position[j] && position[j] < upper) {
                *missing -= self.share * *missing;
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

//! [`Wave`]: one periodic joint motion.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::{Interval, Joints, PeriodGrid};
use crate::error::{Error, ErrorKind, Result};

/// Which time derivative of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Derivative {
    /// rad
    Position,
    /// rad/s
    Velocity,
    /// rad/s^2
    Acceleration,
    /// rad/s^3
    Jerk,
}

impl Derivative {
    /// How often position is differentiated: 0 to 3.
    pub fn order(self) -> i32 {
        self as i32
    }
}

/// Position and its first three time derivatives at one instant, one entry a joint
/// (rad, rad/s, rad/s^2, rad/s^3).
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)] // the four names say it
pub struct State {
    pub position: DVector<f64>,
    pub velocity: DVector<f64>,
    pub acceleration: DVector<f64>,
    pub jerk: DVector<f64>,
}

impl State {
    /// All zero, for `joints` joints: the workspace of [`Wave::state_into`].
    pub fn zeros(joints: usize) -> Self {
        let zero = DVector::zeros(joints);
        Self {
            position: zero.clone(),
            velocity: zero.clone(),
            acceleration: zero.clone(),
            jerk: zero,
        }
    }
}

/// One periodic motion of named joints, a finite Fourier series with K harmonics:
///
/// ```text
/// y_d(t) = w_{d,0} + 2 Re sum_{k=1..K} w_{d,k} exp(i k w t),   w = 2 pi / T
/// ```
///
/// Motions are real, so w_{d,-k} is the conjugate of w_{d,k}, and only k >= 0 is stored.
///
/// ```
/// use nalgebra::{dmatrix, dvector};
/// use num_complex::Complex;
/// use undulate::{Joints, Wave};
///
/// // 0.3 + 0.2 cos(2 pi t / 2): the weight is half the amplitude.
/// let wave = Wave::new(
///     Joints::new(["elbow"])?,
///     2.0,
///     dvector![0.3],
///     dmatrix![Complex::new(0.1, 0.0)],
/// )?;
/// assert!((wave.position(0.0)[0] - 0.5).abs() < 1e-15);
/// assert!((wave.position(1.0)[0] - 0.1).abs() < 1e-15);
/// # Ok::<(), undulate::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Wave {
    joints: Joints,
    period: f64,
    offsets: DVector<f64>,
    weights: DMatrix<Complex<f64>>,
}

impl Wave {
    /// A wave of `period` seconds: `offsets` holds w_{d,0} (D, rad), `weights` w_{d,k} (D x K, rad; column k-1 is harmonic k).
    ///
    /// # Errors
    /// When the period is not within 1e-9 to 1e9 s, a weight is not finite or beyond 1e100 rad, or the sizes do not fit.
    pub fn new(
        joints: Joints,
        period: f64,
        offsets: DVector<f64>,
        weights: DMatrix<Complex<f64>>,
    ) -> Result<Self> {
        check_period(period)?;
        if offsets.len() != joints.len() || weights.nrows() != joints.len() {
            return Err(Error::new(
                ErrorKind::Shape,
                format!(
                    "{} joints, {} offsets, weights of {} rows",
                    joints.len(),
                    offsets.len(),
                    weights.nrows()
                ),
            )
            .expected("one offset and one row of weights a joint"));
        }
        let fits = |x: f64| x.abs() <= LARGEST_WEIGHT;
        for (d, joint) in joints.iter().enumerate() {
            let row = weights.row(d);
            if !(fits(offsets[d]) && row.iter().all(|w| fits(w.re) && fits(w.im))) {
                return Err(Error::new(
                    ErrorKind::Value,
                    "a Fourier weight is not finite, or no angle",
                )
                .at(format!("joint `{joint}`")));
            }
        }
        Ok(Self {
            joints,
            period,
            offsets,
            weights,
        })
    }

    /// The joints' names.
    pub fn joints(&self) -> &Joints {
        &self.joints
    }

    /// T \[s\].
    pub fn period(&self) -> f64 {
        self.period
    }

    /// The highest harmonic, K.
    pub fn harmonics(&self) -> usize {
        self.weights.ncols()
    }

    /// w_{d,0} \[rad\], D of them: the posture about which the joints wave.
    pub fn offsets(&self) -> &DVector<f64> {
        &self.offsets
    }

    /// w_{d,k} \[rad\], D x K; column k-1 is harmonic k.
    pub fn weights(&self) -> &DMatrix<Complex<f64>> {
        &self.weights
    }

    /// Fundamental angular frequency w = 2 pi / T \[rad/s\].
    pub fn angular_frequency(&self) -> f64 {
        std::f64::consts::TAU / self.period
    }

    /// Positions at time `t` \[s\], any real number (D, rad).
    pub fn position(&self, t: f64) -> DVector<f64> {
        self.state(t).position
    }

    /// Position of joint number `joint` at time `t` \[s\]: that of [`position`](Self::position), at the cost of one joint.
    pub(crate) fn position_of(&self, joint: usize, t: f64) -> f64 {
        let step = self.rotation(t);
        let mut rotation = step;
        let mut position = self.offsets[joint];
        for weight in self.weights.row(joint).iter() {
            position += (weight * rotation * 2.0).re;
            rotation *= step;
        }
        position
    }

    /// Position to jerk at time `t` \[s\].
    pub fn state(&self, t: f64) -> State {
        let mut state = State::zeros(self.joints.len());
        self.state_into(t, &mut state);
        state
    }

    /// [`state`](Self::state) without allocation. Panics when `state` was made for another number of joints.
    pub fn state_into(&self, t: f64, state: &mut State) {
        state.position.copy_from(&self.offsets);
        state.velocity.fill(0.0);
        state.acceleration.fill(0.0);
        state.jerk.fill(0.0);
        let step = self.rotation(t);
        let w = self.angular_frequency();
        let mut rotation = step;
        // Slices of one length, so that nothing is checked within.
        let joints = self.joints.len();
        let [p, v, a, j] = [
            &mut state.position,
            &mut state.velocity,
            &mut state.acceleration,
            &mut state.jerk,
        ]
        .map(|series| &mut series.as_mut_slice()[..joints]);
        for (k, column) in self.weights.as_slice().chunks_exact(joints).enumerate() {
            let kw = (k + 1) as f64 * w;
            let twice = rotation * 2.0;
            let [square, cube] = [kw * kw, kw * kw * kw];
            for d in 0..joints {
                // z = 2 w_{d,k} exp(i k w t); differentiating multiplies by i k w.
                let z = column[d] * twice;
                p[d] += z.re;
                v[d] -= kw * z.im;
                a[d] -= square * z.re;
                j[d] += cube * z.im;
            }
            rotation *= step;
        }
    }

    /// exp(i w t), reduced to one period first so that a late `t` loses nothing but its own rounding.
    fn rotation(&self, t: f64) -> Complex<f64> {
        let turns = t / self.period;
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * (turns - libm::floor(turns)));
        Complex::new(cos, sin)
    }

    /// A derivative on a grid over one period (N x D): row n is time n T / N.
    pub fn on_grid(&self, grid: &PeriodGrid, derivative: Derivative) -> DMatrix<f64> {
        grid.evaluate(self, derivative)
    }

    /// The same motion, `factor` times as slow: y(t / factor).
    ///
    /// # Errors
    /// When the period that comes of it is none (see [`new`](Self::new)).
    pub fn slowed(&self, factor: f64) -> Result<Self> {
        check_period(self.period * factor)?;
        Ok(Self {
            period: self.period * factor,
            ..self.clone()
        })
    }

    /// The motion of each joint about its offset, times its entry of `factors`.
    ///
    /// # Errors
    /// When there is not one finite factor a joint, or a weight grows beyond what one may be.
    pub fn scaled(&self, factors: &[f64]) -> Result<Self> {
        self.require_one_each(factors)?;
        let mut weights = self.weights.clone();
        for (mut row, factor) in weights.row_iter_mut().zip(factors) {
            row.apply(|weight| *weight *= *factor);
        }
        let offsets = self.offsets.clone();
        Self::new(self.joints.clone(), self.period, offsets, weights)
    }

    /// The same motion about offsets that lie elsewhere, by an entry of `shifts` \[rad\] a joint.
    ///
    /// # Errors
    /// When there is not one finite shift a joint.
    pub fn shifted(&self, shifts: &[f64]) -> Result<Self> {
        self.require_one_each(shifts)?;
        let offsets = &self.offsets + DVector::from_column_slice(shifts);
        Self::new(
            self.joints.clone(),
            self.period,
            offsets,
            self.weights.clone(),
        )
    }

    fn require_one_each(&self, numbers: &[f64]) -> Result<()> {
        if numbers.len() == self.joints.len() {
            return Ok(());
        }
        Err(
            Error::new(ErrorKind::Shape, format!("{} numbers", numbers.len()))
                .expected(format!("one for each of {} joints", self.joints.len())),
        )
    }

    /// The same motion started `delay` seconds into it: y(t + delay), so w_k becomes w_k exp(i k w delay). A delay that is no finite
    /// number is none.
    #[must_use]
    pub fn advanced(&self, delay: f64) -> Self {
        if !delay.is_finite() {
            return self.clone();
        }
        let step = self.rotation(delay);
        let mut rotation = step;
        let mut weights = self.weights.clone();
        for mut column in weights.column_iter_mut() {
            column.apply(|weight| *weight *= rotation);
            rotation *= step;
        }
        Self {
            weights,
            ..self.clone()
        }
    }
}

/// Periods and weights within these, with as many harmonics as fit in memory, have finite derivatives.
const PERIODS: Interval = Interval {
    lower: 1e-9,
    upper: 1e9,
};
const LARGEST_WEIGHT: f64 = 1e100;

pub(super) fn check_period(period: f64) -> Result<()> {
    if PERIODS.contains(period) {
        Ok(())
    } else {
        Err(
            Error::new(ErrorKind::Value, format!("period of {period} s")).expected(format!(
                "a number of seconds from {:e} to {:e}",
                PERIODS.lower, PERIODS.upper
            )),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{dmatrix, dvector};

    /// 0.1 + 0.6 cos(w t) - 0.4 sin(w t) + 0.2 cos(3 w t), T = 1.5 s.
    fn wave() -> Wave {
        Wave::new(
            Joints::new(["a"]).unwrap(),
            1.5,
            dvector![0.1],
            dmatrix![
                Complex::new(0.3, 0.2),
                Complex::ZERO,
                Complex::new(0.1, 0.0)
            ],
        )
        .unwrap()
    }

    #[test]
    fn state_is_the_series_and_its_derivatives_in_closed_form() {
        let wave = wave();
        let w = wave.angular_frequency();
        for i in 0..40 {
            let t = -3.0 + 0.21 * f64::from(i);
            let ((s, c), (s3, c3)) = ((w * t).sin_cos(), (3.0 * w * t).sin_cos());
            let state = wave.state(t);
            let expected = [
                0.1 + 0.6 * c - 0.4 * s + 0.2 * c3,
                w * (-0.6 * s - 0.4 * c - 0.6 * s3),
                w * w * (-0.6 * c + 0.4 * s - 1.8 * c3),
                w.powi(3) * (0.6 * s + 0.4 * c + 5.4 * s3),
            ];
            let found = [
                &state.position,
                &state.velocity,
                &state.acceleration,
                &state.jerk,
            ];
            for (order, (found, expected)) in found.iter().zip(expected).enumerate() {
                let scale = (3.0 * w).powi(order as i32);
                assert!(
                    (found[0] - expected).abs() < 1e-13 * scale,
                    "order {order} at {t}"
                );
            }
        }
    }

    #[test]
    fn a_late_time_is_reduced_to_its_period() {
        let wave = wave();
        let (a, b) = (wave.position(0.4), wave.position(0.4 + 1.5 * 1048576.0));
        assert!((a[0] - b[0]).abs() < 1e-8);
    }

    #[test]
    fn what_is_not_a_wave_is_refused() {
        let joints = Joints::new(["a"]).unwrap();
        let w = dmatrix![Complex::new(0.1, 0.0)];
        for period in [0.0, -1.0, 1e-300, f64::NAN, f64::INFINITY] {
            assert!(Wave::new(joints.clone(), period, dvector![0.0], w.clone()).is_err());
        }
        let error = Wave::new(joints.clone(), 1.0, dvector![f64::NAN], w.clone()).unwrap_err();
        assert!(error.to_string().contains("joint `a`"));
        assert!(Wave::new(joints, 1.0, dvector![0.0, 1.0], w).is_err());
    }
}

//! [`Recording`]: one demonstration as it was recorded.

use nalgebra::DMatrix;

use crate::error::{Error, ErrorKind, Result};
use crate::fourier::Joints;

/// One recording: joint positions at strictly increasing times.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    pub(super) name: String,
    pub(super) joints: Joints,
    pub(super) times: Vec<f64>,
    pub(super) positions: DMatrix<f64>,
}

impl Recording {
    /// A recording called `name` (usually its file): `times` \[s\] (N), `positions` \[rad\] (N x D).
    ///
    /// # Errors
    /// When there are fewer than two samples, sizes do not fit, a number is not finite, or a time does not come
    /// after the one before it.
    pub fn new(
        name: impl Into<String>,
        joints: Joints,
        times: Vec<f64>,
        positions: DMatrix<f64>,
    ) -> Result<Self> {
        let name = name.into();
        let check = || {
            if times.len() < 2 {
                return Err(
                    Error::new(ErrorKind::Shape, format!("{} samples", times.len()))
                        .expected("at least two"),
                );
            }
            if positions.nrows() != times.len() || positions.ncols() != joints.len() {
                return Err(Error::new(
                    ErrorKind::Shape,
                    format!("positions of {} x {}", positions.nrows(), positions.ncols()),
                )
                .expected(format!(
                    "{} times x {} joints",
                    times.len(),
                    joints.len()
                )));
            }
            for (n, t) in times.iter().enumerate() {
                if !t.is_finite() {
                    return Err(Error::new(ErrorKind::Value, format!("time is {t}"))
                        .at(format!("sample {}", n + 1)));
                }
                if n > 0 && *t <= times[n - 1] {
                    return Err(Error::new(
                        ErrorKind::Value,
                        format!("time {t} s does not come after {} s", times[n - 1]),
                    )
                    .expected("strictly increasing times")
                    .at(format!("sample {}", n + 1)));
                }
            }
            for (d, joint) in joints.iter().enumerate() {
                if let Some(n) = positions.column(d).iter().position(|p| !p.is_finite()) {
                    return Err(Error::new(
                        ErrorKind::Value,
                        format!("position is {}", positions[(n, d)]),
                    )
                    .at(format!("sample {}, joint `{joint}`", n + 1)));
                }
            }
            Ok(())
        };
        check().map_err(|e| e.at(name.clone()))?;
        Ok(Self {
            name,
            joints,
            times,
            positions,
        })
    }

    /// What it is called in messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The joints' names.
    pub fn joints(&self) -> &Joints {
        &self.joints
    }

    /// Time stamps \[s\], N of them.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Positions \[rad\], N x D.
    pub fn positions(&self) -> &DMatrix<f64> {
        &self.positions
    }

    /// From the first to the last stamp \[s\].
    pub fn span(&self) -> f64 {
        self.times[self.times.len() - 1] - self.times[0]
    }

    /// Without jumps of 2 pi: whole turns are taken out of every step of more than half a turn.
    #[must_use]
    pub fn unwrapped(&self) -> Self {
        let mut positions = self.positions.clone();
        for mut column in positions.column_iter_mut() {
            super::pieces::unwrap(column.as_mut_slice());
        }
        Self {
            positions,
            ..self.clone()
        }
    }

    /// Without the straight line through each joint's positions (least squares, its value at mid-time kept):
    /// a slow drift of posture is no part of a periodic gesture, and would leak into every harmonic.
    #[must_use]
    pub fn without_drift(&self) -> Self {
        let middle = self.times.iter().sum::<f64>() / self.times.len() as f64;
        let spread: f64 = self.times.iter().map(|t| (t - middle).powi(2)).sum();
        let mut positions = self.positions.clone();
        for mut column in positions.column_iter_mut() {
            let slope = self
                .times
                .iter()
                .zip(column.iter())
                .map(|(t, y)| (t - middle) * y)
                .sum::<f64>()
                / spread;
            for (y, t) in column.iter_mut().zip(&self.times) {
                *y -= slope * (t - middle);
            }
        }
        Self {
            positions,
            ..self.clone()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_removed_and_its_middle_stays() {
        let times: Vec<f64> = (0..50).map(|n| 0.1 * f64::from(n)).collect();
        let positions = DMatrix::from_fn(50, 1, |n, _| 0.4 + 0.3 * times[n]);
        let straight = Recording::new("r", Joints::new(["a"]).unwrap(), times, positions).unwrap();
        let flat = straight.without_drift();
        let middle = 0.4 + 0.3 * 2.45;
        assert!(flat.positions.iter().all(|p| (p - middle).abs() < 1e-12));
    }
}

//! [`StrokeProMp`]: a movement from a beginning to an end.

use nalgebra::{DMatrix, DVector};
use rand::Rng;

use super::aligned::{Aligned, aligned};
use super::{GestureModel, Wish, gaussian};
use crate::demonstration::{Demonstrations, Duration, Recording};
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::Joints;
use crate::primitive::{Gaussian, LinearObservation};

/// Added to the mean diagonal entry of the normal equations, as a share of it.
const RIDGE: f64 = 1e-6;

/// Standard deviation of a base in distances of centres. Of 1, weights of neighbours cancel each other, and what varies among them runs away in draws.
pub(super) const WIDTH: f64 = 0.6;

/// Harmonics by which the start of a recording is found.
const HARMONICS: usize = 1;

/// A probabilistic movement primitive (Paraschos, Daniel, Peters and Neumann, "Using probabilistic movement primitives in robotics", Autonomous Robots 42, 2018)
/// of normalised radial bases along a phase from 0 to 1.
///
/// Recordings begin where the dominant joint first turns, and are cut to a common duration, as long as keeps most of (recordings) x (duration);
/// weights by ridge regression, a Gaussian over them ([`Estimator::Kronecker`](crate::Estimator)'s shrinkage with joints x neighbouring bases). It passes through a position at a time. It
/// knows no tempo and no amplitude, so neither can be asked for; and it ends: after its duration the arm stands still.
pub struct StrokeProMp {
    joints: Joints,
    duration: f64,
    bases: usize,
    /// The joint by which recordings are aligned.
    dominant: usize,
    gaussian: Gaussian,
}

impl StrokeProMp {
    /// Learns from recordings with so many bases a joint.
    ///
    /// # Errors
    /// When there are fewer than two recordings with a rhythm and of a common duration, or fewer than two bases.
    pub fn learn(recordings: &[Recording], bases: usize) -> Result<Self> {
        if bases < 2 {
            return Err(
                Error::new(ErrorKind::Setting, format!("{bases} bases")).expected("at least two")
            );
        }
        let (aligned, dominant) = aligned(recordings, HARMONICS)?;
        let begun = aligned
            .iter()
            .map(|a| from(a.recording, a.start))
            .collect::<Result<Vec<_>>>()?;
        let demonstrations = Demonstrations::new(begun, Duration::Auto)?;
        let duration = demonstrations.period();
        let vectors: Vec<DVector<f64>> = demonstrations
            .recordings()
            .iter()
            .map(|r| weights(r, duration, bases))
            .collect::<Result<_>>()?;
        let joints = demonstrations.joints().clone();
        Ok(Self {
            gaussian: gaussian::shrunk(&vectors, &[(joints.len(), bases)])?,
            joints,
            duration,
            bases,
            dominant,
        })
    }

    /// How long it lasts \[s\].
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Over the weights, joint by joint.
    pub fn gaussian(&self) -> &Gaussian {
        &self.gaussian
    }
}

impl GestureModel for StrokeProMp {
    fn draw(&self, times: &[f64], rng: &mut dyn Rng) -> DMatrix<f64> {
        let x = self.gaussian.sample(rng);
        let phases = phases(times, self.duration);
        let w = DMatrix::from_column_slice(self.bases, self.joints.len(), x.as_slice());
        design(&phases, self.bases) * w
    }

    fn log_density(&self, demonstration: &Recording) -> Option<f64> {
        let aligned = Aligned::of(demonstration, self.dominant, HARMONICS)?;
        let begun = from(demonstration, aligned.start).ok()?;
        let x = weights(&begun, self.duration, self.bases).ok()?;
        Some(gaussian::log_density(&self.gaussian, &x))
    }

    fn condition(&self, wish: &Wish) -> Result<Box<dyn GestureModel>> {
        let Wish::Position {
            joint,
            time,
            position,
        } = wish
        else {
            return Err(wish.refused("a stroke has no rhythm"));
        };
        let d = self.joints.index(joint)?;
        let row = design(&[(time / self.duration).clamp(0.0, 1.0)], self.bases);
        Ok(Box::new(Self {
            gaussian: given(
                &self.gaussian,
                d * self.bases,
                row.row(0).iter(),
                *position,
                wish,
            )?,
            joints: self.joints.clone(),
            ..*self
        }))
    }
}

/// The Gaussian given that weights from `start` on, times `row`, are `value`.
pub(super) fn given<'a>(
    gaussian: &Gaussian,
    start: usize,
    row: impl Iterator<Item = &'a f64>,
    value: f64,
    wish: &Wish,
) -> Result<Gaussian> {
    let row = row.enumerate().map(|(i, r)| (start + i, *r)).collect();
    let observation = LinearObservation {
        row,
        value,
        deviation: 0.0,
    };
    gaussian
        .condition(&[observation])
        .map_err(|_| wish.refused("it contradicts what is certain already"))
}

/// The samples from so long after the first.
fn from(recording: &Recording, start: f64) -> Result<Recording> {
    let times = recording.times();
    let first = times.partition_point(|t| t - times[0] < start);
    Recording::new(
        recording.name(),
        recording.joints().clone(),
        times[first..].to_vec(),
        recording
            .positions()
            .rows(first, times.len() - first)
            .into_owned(),
    )
}

/// From 0 at the first time to 1 after `duration`, and 1 from there on.
fn phases(times: &[f64], duration: f64) -> Vec<f64> {
    let start = times.first().copied().unwrap_or(0.0);
    times
        .iter()
        .map(|t| ((t - start) / duration).min(1.0))
        .collect()
}

/// N x B: Gaussian bases with centres from 0 to 1, normalised to sum 1.
fn design(phases: &[f64], bases: usize) -> DMatrix<f64> {
    let apart = 1.0 / (bases - 1) as f64;
    let mut design = DMatrix::from_fn(phases.len(), bases, |n, b| {
        (-0.5 * ((phases[n] - b as f64 * apart) / (WIDTH * apart)).powi(2)).exp()
    });
    for mut row in design.row_iter_mut() {
        let sum = row.sum();
        row /= sum;
    }
    design
}

fn weights(recording: &Recording, duration: f64, bases: usize) -> Result<DVector<f64>> {
    ridge(
        &design(&phases(recording.times(), duration), bases),
        recording.positions(),
    )
}

/// Ridge regression of N x D positions on an N x B design: weights, joint by joint. The mean is kept out of the penalty.
pub(super) fn ridge(design: &DMatrix<f64>, positions: &DMatrix<f64>) -> Result<DVector<f64>> {
    let mut gram = design.tr_mul(design);
    let share = RIDGE * gram.trace() / gram.nrows() as f64;
    for i in 0..gram.nrows() {
        gram[(i, i)] += share;
    }
    let refuse = || Error::new(ErrorKind::Infeasible, "weights that no regression finds");
    let mean = positions.row_mean();
    let mut centred = positions.clone();
    for mut row in centred.row_iter_mut() {
        row -= &mean;
    }
    let cholesky = gram.cholesky().ok_or_else(refuse)?;
    let mut w = cholesky.solve(&design.tr_mul(&centred));
    // Bases sum to 1 everywhere, so a constant is the same weight in all.
    for (mut column, mean) in w.column_iter_mut().zip(mean.iter()) {
        column.add_scalar_mut(*mean);
    }
    Ok(DVector::from_column_slice(w.as_slice()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motion_in_the_span_is_found_again_but_for_the_ridge() {
        let phases: Vec<f64> = (0..200).map(|n| f64::from(n) / 199.0).collect();
        let design = design(&phases, 12);
        let w = DMatrix::from_fn(12, 2, |b, d| 1.0 + ((3 * b + 5 * d) as f64).sin());
        let found = ridge(&design, &(&design * &w)).unwrap();
        let found = DMatrix::from_column_slice(12, 2, found.as_slice());
        assert!((&design * &found - &design * &w).amax() < 1e-4);
        // A constant is no matter of the ridge.
        let found = ridge(&design, &DMatrix::from_element(200, 1, 7.0)).unwrap();
        assert!(found.iter().all(|w| (w - 7.0).abs() < 1e-12));
    }
}

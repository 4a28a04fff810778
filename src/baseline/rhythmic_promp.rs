//! [`RhythmicProMp`]: a cycle that repeats itself.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};
use rand::Rng;

use super::aligned::{Aligned, aligned};
use super::stroke_promp::{WIDTH, given, ridge};
use super::{GestureModel, Wish, gaussian};
use crate::demonstration::Recording;
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::Joints;
use crate::primitive::Gaussian;

/// A probabilistic movement primitive (Paraschos, Daniel, Peters and Neumann, "Using probabilistic movement primitives in robotics", Autonomous Robots 42, 2018)
/// of normalised von Mises bases along the phase of a cycle.
///
/// Each recording, its straight drift taken out, is fitted along the phase of its own tempo, 0 where the dominant joint turns; weights by ridge regression, and
/// a Gaussian over weights and ln frequency ([`Estimator::Kronecker`](crate::Estimator)'s shrinkage with joints x neighbouring bases). The frequency is our addition: with it a draw has a tempo of its own,
/// a tempo can be asked for, and the weights follow as linearly as they can. It has no amplitude that could be asked for, and all cycles of a draw are the same.
pub struct RhythmicProMp {
    joints: Joints,
    bases: usize,
    /// The joint by which recordings are aligned.
    dominant: usize,
    gaussian: Gaussian,
}

impl RhythmicProMp {
    /// Learns from recordings with so many bases a joint.
    ///
    /// # Errors
    /// When there are fewer than two recordings with a rhythm, or fewer than three bases.
    pub fn learn(recordings: &[Recording], bases: usize) -> Result<Self> {
        if bases < 3 {
            return Err(
                Error::new(ErrorKind::Setting, format!("{bases} bases")).expected("at least three")
            );
        }
        let (aligned, dominant) = aligned(recordings, (bases - 1) / 2)?;
        let vectors = aligned
            .iter()
            .map(|a| weights(a, bases))
            .collect::<Result<Vec<_>>>()?;
        let joints = aligned[0].recording.joints().clone();
        Ok(Self {
            gaussian: gaussian::shrunk(&vectors, &[(joints.len(), bases), (1, 1)])?,
            joints,
            bases,
            dominant,
        })
    }

    /// Over the weights, joint by joint, and ln frequency.
    pub fn gaussian(&self) -> &Gaussian {
        &self.gaussian
    }

    fn frequency(&self) -> usize {
        self.joints.len() * self.bases
    }
}

impl GestureModel for RhythmicProMp {
    fn draw(&self, times: &[f64], rng: &mut dyn Rng) -> DMatrix<f64> {
        let x = self.gaussian.sample(rng);
        let at = self.frequency();
        let frequency = x[at].exp();
        let start = times.first().copied().unwrap_or(0.0);
        let phases: Vec<f64> = times
            .iter()
            .map(|t| TAU * frequency * (t - start))
            .collect();
        let w = DMatrix::from_column_slice(self.bases, self.joints.len(), &x.as_slice()[..at]);
        design(&phases, self.bases) * w
    }

    fn log_density(&self, demonstration: &Recording) -> Option<f64> {
        let aligned = Aligned::of(demonstration, self.dominant, (self.bases - 1) / 2)?;
        let x = weights(&aligned, self.bases).ok()?;
        Some(gaussian::log_density(&self.gaussian, &x))
    }

    fn condition(&self, wish: &Wish) -> Result<Box<dyn GestureModel>> {
        let Wish::Frequency(frequency) = wish else {
            return Err(wish.refused("weights hold shape and size together, and no time"));
        };
        if !(frequency.is_finite() && *frequency > 0.0) {
            return Err(wish.refused("it is no frequency"));
        }
        let row = [1.0];
        let value = frequency.ln();
        Ok(Box::new(Self {
            gaussian: given(&self.gaussian, self.frequency(), row.iter(), value, wish)?,
            joints: self.joints.clone(),
            ..*self
        }))
    }
}

/// N x B: exp(kappa (cos(phase - c_b) - 1)) about B centres around the circle, about as wide as a stroke's, normalised to sum 1.
fn design(phases: &[f64], bases: usize) -> DMatrix<f64> {
    let apart = TAU / bases as f64;
    let concentration = (WIDTH * apart).powi(-2);
    let mut design = DMatrix::from_fn(phases.len(), bases, |n, b| {
        (concentration * ((phases[n] - b as f64 * apart).cos() - 1.0)).exp()
    });
    for mut row in design.row_iter_mut() {
        let sum = row.sum();
        row /= sum;
    }
    design
}

fn weights(aligned: &Aligned<'_>, bases: usize) -> Result<DVector<f64>> {
    let flat = aligned.recording.without_drift();
    let start = flat.times()[0] + aligned.start;
    let phases: Vec<f64> = flat
        .times()
        .iter()
        .map(|t| TAU * aligned.frequency * (t - start))
        .collect();
    let w = ridge(&design(&phases, bases), flat.positions())?;
    Ok(w.push(aligned.frequency.ln()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bases_repeat_with_the_cycle_and_span_its_lowest_harmonics() {
        let phases: Vec<f64> = (0..90).map(|n| TAU * f64::from(n) / 90.0).collect();
        let later: Vec<f64> = phases.iter().map(|p| p + 3.0 * TAU).collect();
        assert!((design(&phases, 9) - design(&later, 9)).amax() < 1e-12);
        // What nine bases see of a harmonic h is mixed with 9 - h, the more the nearer these are.
        let y = DMatrix::from_fn(90, 2, |n, h| 0.5 + ((h + 1) as f64 * phases[n]).cos());
        let w = ridge(&design(&phases, 9), &y).unwrap();
        let found = design(&phases, 9) * DMatrix::from_column_slice(9, 2, w.as_slice());
        let missed = |d: usize| (found.column(d) - y.column(d)).amax();
        assert!(
            missed(0) < 0.02 && missed(1) < 0.1,
            "{} {}",
            missed(0),
            missed(1)
        );
    }
}

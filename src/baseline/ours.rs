//! Our own models behind the interface of the baselines.

use nalgebra::DMatrix;
use rand::Rng;
use rand::distr::Distribution;

use super::{GestureModel, Wish};
use crate::demonstration::{CycleFits, Demonstrations, Duration, Recording};
use crate::error::Result;
use crate::fourier::Wave;
use crate::primitive::{Coordinate, FourierMovementPrimitive, LearnOptions, Observation};

/// Each recording's own tempo; a drawn wave has as many cycles as the longest recording.
pub(super) fn cycle(
    recordings: &[Recording],
    harmonics: usize,
    residual: bool,
) -> Result<FourierMovementPrimitive> {
    let fits = CycleFits::new(recordings, harmonics)?;
    let longest = fits.fits().iter().map(|fit| fit.cycles).fold(1.0, f64::max);
    let options = LearnOptions {
        residual,
        ..LearnOptions::default()
    };
    FourierMovementPrimitive::from_cycles(&fits, longest.ceil() as usize, &options)
}

/// The period for which (recordings kept) x T is largest.
pub(super) fn common_period(
    recordings: &[Recording],
    harmonics: usize,
) -> Result<FourierMovementPrimitive> {
    let demonstrations = Demonstrations::new(recordings.to_vec(), Duration::Auto)?;
    FourierMovementPrimitive::learn(&demonstrations, harmonics)
}

/// A wave's positions at times of which the first is its start (N x D).
pub(super) fn positions(wave: &Wave, times: &[f64]) -> DMatrix<f64> {
    let start = times.first().copied().unwrap_or(0.0);
    DMatrix::from_fn(times.len(), wave.joints().len(), |n, d| {
        wave.position_of(d, times[n] - start)
    })
}

impl GestureModel for FourierMovementPrimitive {
    fn draw(&self, times: &[f64], rng: &mut dyn Rng) -> DMatrix<f64> {
        positions(&self.sample(rng), times)
    }

    fn condition(&self, wish: &Wish) -> Result<Box<dyn GestureModel>> {
        if self.chart().cycles().is_none() {
            return Err(wish.refused("with a common period it is spread over harmonics"));
        }
        let observation = match wish {
            Wish::Swing { joint, swing } => {
                let joint = joint.clone();
                Observation::of(Coordinate::Swing { joint }, *swing)
            }
            Wish::Frequency(frequency) => Observation::of(Coordinate::Frequency, *frequency),
            Wish::Position { .. } => {
                return Err(wish.refused("it is no linear row; `Posterior` samples it"));
            }
        };
        Ok(Box::new(FourierMovementPrimitive::condition(
            self,
            &[observation],
        )?))
    }
}

//! Waves of a primitive.

use std::fmt;
use std::ops::Deref;
use std::sync::Arc;

use num_complex::Complex;
use proptest::prelude::*;
use statrs::function::gamma::gamma_ur;

use super::super::gaussian::Whitening;
use super::latent::{Draw, Latent};
use crate::fourier::Wave;
use crate::primitive::FourierMovementPrimitive;

/// Harmonics below this share of a joint's largest are not printed.
const UNHEARD: f64 = 1e-6;

/// Waves as a primitive draws them. They shrink towards its mean: first the latent vector z as a whole, by halving, then its
/// entries to 0, one by one, then what is left as a whole again. So the counterexample is the most typical wave that fails along its own direction, with the
/// fewest entries that it takes: towards where the property fails soonest a search by draws cannot look. Then to fewest joints that move and
/// fewest harmonics, by silencing one after the other. (A wave with silenced parts is no draw any more: where a joint must have the amplitude
/// that a condition says, silence is another failure. [`DrawnWave::is_drawn`] tells.)
///
/// ```
/// use proptest::prelude::*;
/// use proptest::test_runner::{TestError, TestRunner};
/// use undulate::testing::waves_of;
/// use undulate::{Derivative, FourierMovementPrimitive, LearnOptions, synthetic};
///
/// let primitive =
///     FourierMovementPrimitive::learn_with(&synthetic(0)?, 12, &LearnOptions::paper())?;
/// let outcome = TestRunner::deterministic().run(&waves_of(&primitive), |wave| {
///     let elbow = wave.joints().index("elbow_flexion")?;
///     let range = wave.range(elbow, Derivative::Velocity);
///     prop_assert!(range.upper < 0.01, "the elbow moves at {} rad/s", range.upper);
///     Ok(())
/// });
/// // The mean is as fast: nothing needs to be untypical, and no other joint to move.
/// let Err(TestError::Fail(_, wave)) = outcome else { panic!("{outcome:?}") };
/// assert_eq!(wave.mahalanobis(), 0.0);
/// assert_eq!(wave.moving(), ["elbow_flexion"]);
/// # Ok::<(), undulate::Error>(())
/// ```
pub fn waves_of(primitive: &FourierMovementPrimitive) -> impl Strategy<Value = DrawnWave> + use<> {
    let primitive = Arc::new(primitive.clone());
    let chart = primitive.chart();
    // Waves of cycles that differ are spread over harmonics of their ring, none of which means anything alone.
    let harmonics = chart.cycles().map_or(chart.harmonics(), |_| 0);
    let latent = Latent {
        entries: primitive.latent(),
        parts: chart.joints().len() + harmonics,
    };
    latent.prop_map(move |draw| DrawnWave::of(primitive.clone(), draw))
}

/// A [`Wave`] that a primitive has drawn, and how typical it is. It prints its Mahalanobis distance, where each joint is, and what moves it.
#[derive(Clone)]
pub struct DrawnWave {
    primitive: Arc<FourierMovementPrimitive>,
    z: Vec<f64>,
    silent: Vec<bool>,
    wave: Wave,
}

impl DrawnWave {
    fn of(primitive: Arc<FourierMovementPrimitive>, draw: Draw) -> Self {
        let Draw { mut z, silent } = draw;
        let drawn = primitive.wave_at(&mut z);
        let wave = if silent.contains(&true) {
            silenced(&drawn, &silent)
        } else {
            drawn
        };
        Self {
            primitive,
            z,
            silent,
            wave,
        }
    }

    /// The wave.
    pub fn wave(&self) -> &Wave {
        &self.wave
    }

    /// How far the draw is from the mean, in standard deviations: sqrt((x - mu)^T Sigma^+ (x - mu)), together with the numbers that make
    /// cycles differ where there are cycles. Of waves with silenced parts it is that of the draw before.
    pub fn mahalanobis(&self) -> f64 {
        let gaussian = self.primitive.gaussian();
        let (latent, cycles) = self.z.split_at(gaussian.latent());
        let x = gaussian.at_latent(&mut latent.to_vec());
        let white = Whitening::of(gaussian).projected(&(x - gaussian.mean()));
        let cycles: f64 = cycles.iter().map(|z| z * z).sum();
        (white.norm_squared() + cycles).sqrt()
    }

    /// What share of all draws is farther from the mean than so many standard deviations: chi-square of as many degrees as numbers are drawn.
    fn share_beyond(&self, distance: f64) -> f64 {
        let gaussian = self.primitive.gaussian();
        let degrees = gaussian.rank() + self.z.len() - gaussian.latent();
        match degrees {
            0 => 1.0,
            degrees => gamma_ur(degrees as f64 / 2.0, distance.powi(2) / 2.0),
        }
    }

    /// Whether it is a draw as it is, no part of it silenced.
    pub fn is_drawn(&self) -> bool {
        !self.silent.contains(&true)
    }

    /// The joints that move.
    pub fn moving(&self) -> Vec<&str> {
        let moves = |d: &usize| {
            self.wave
                .weights()
                .row(*d)
                .iter()
                .any(|w| *w != Complex::ZERO)
        };
        let joints = (0..self.wave.joints().len()).filter(moves);
        joints.map(|d| self.wave.joints().name(d)).collect()
    }

    /// The harmonics that are there.
    pub fn harmonics_heard(&self) -> Vec<usize> {
        let columns = self.wave.weights().column_iter().enumerate();
        columns
            .filter(|(_, column)| column.iter().any(|w| *w != Complex::ZERO))
            .map(|(k, _)| k + 1)
            .collect()
    }
}

impl Deref for DrawnWave {
    type Target = Wave;
    fn deref(&self) -> &Wave {
        &self.wave
    }
}

impl fmt::Debug for DrawnWave {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let before = if self.is_drawn() {
            ""
        } else {
            " before parts were silenced"
        };
        let distance = self.mahalanobis();
        let farther = 100.0 * self.share_beyond(distance);
        write!(
            f,
            "a wave of period {} s, Mahalanobis distance {distance:.4} ({farther:.3} % of draws are farther from the mean){before}",
            self.period(),
        )?;
        for (d, joint) in self.joints().iter().enumerate() {
            write!(f, "\n  {joint}: about {:.4} rad", self.offsets()[d])?;
            let row = self.weights().row(d);
            let least = UNHEARD * row.iter().map(|w| w.norm()).fold(0.0, f64::max);
            let heard = row.iter().enumerate().filter(|(_, w)| w.norm() > least);
            for (n, (k, w)) in heard.enumerate() {
                let before = if n == 0 {
                    "; half the amplitude [rad] and phase of harmonics"
                } else {
                    ","
                };
                write!(f, "{before} {}: {:.3e} {:.3}", k + 1, w.norm(), w.arg())?;
            }
        }
        Ok(())
    }
}

/// The wave without the motion of some joints (first) and some harmonics (after them).
fn silenced(wave: &Wave, silent: &[bool]) -> Wave {
    let (joints, harmonics) = silent.split_at(wave.joints().len());
    let mut weights = wave.weights().clone();
    for (d, _) in joints.iter().enumerate().filter(|(_, silent)| **silent) {
        weights.row_mut(d).fill(Complex::ZERO);
    }
    for (k, _) in harmonics.iter().enumerate().filter(|(_, silent)| **silent) {
        weights.column_mut(k).fill(Complex::ZERO);
    }
    Wave::new(
        wave.joints().clone(),
        wave.period(),
        wave.offsets().clone(),
        weights,
    )
    .expect("smaller weights than a wave's")
}

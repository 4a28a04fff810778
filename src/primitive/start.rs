//! Where in its cycle a wave starts.

use std::str::FromStr;

use num_complex::Complex;
use rand::{Rng, RngExt};

use super::example::Example;
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::Wave;
use crate::units::parse_angle_with_unit;

/// Where in its period a drawn wave starts.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Start {
    /// Where it was drawn to: as the demonstrations did.
    #[default]
    Kept,
    /// Anywhere, uniformly.
    Redrawn,
    /// Where the wave's largest weight has this phase \[rad\]: 0 is that joint's upper turning point.
    Fixed(f64),
}

impl Start {
    /// The wave started there; as it is, where the phase is no number.
    pub fn apply<R: Rng + ?Sized>(self, wave: &Wave, rng: &mut R) -> Wave {
        match self {
            Self::Kept => wave.clone(),
            Self::Redrawn => wave.advanced(wave.period() * rng.random::<f64>()),
            Self::Fixed(phase) => {
                let (k, weight) = wave
                    .weights()
                    .column_iter()
                    .enumerate()
                    .flat_map(|(k, column)| column.iter().map(|w| (k + 1, *w)).collect::<Vec<_>>())
                    .fold((1, Complex::ZERO), |best, next| {
                        if next.1.norm_sqr() > best.1.norm_sqr() {
                            next
                        } else {
                            best
                        }
                    });
                wave.advanced(delay(wave, k, weight, phase))
            }
        }
    }
}

/// After which harmonic k, now of this weight, has that phase.
fn delay(wave: &Wave, k: usize, weight: Complex<f64>, phase: f64) -> f64 {
    (phase - libm::atan2(weight.im, weight.re)) / (k as f64 * wave.angular_frequency())
}

/// The demonstrations, each started where the joint and harmonic with most energy over all of them has phase zero.
pub(super) fn aligned(examples: Vec<Example>) -> Result<Vec<Example>> {
    let Some(first) = examples.first() else {
        return Ok(examples);
    };
    let shape = |e: &Example| (e.wave.joints().len(), e.wave.harmonics());
    let (joints, harmonics) = shape(first);
    if harmonics == 0 {
        return Err(Error::new(ErrorKind::Shape, "waves without harmonics"));
    }
    if examples.iter().any(|e| shape(e) != (joints, harmonics)) {
        return Err(Error::new(
            ErrorKind::Shape,
            "demonstrations of different joints or harmonics",
        ));
    }
    let energy = |d: usize, k: usize| -> f64 {
        examples
            .iter()
            .map(|e| e.wave.weights()[(d, k)].norm_sqr())
            .sum()
    };
    let (d, k) = (0..joints)
        .flat_map(|d| (0..harmonics).map(move |k| (d, k)))
        .fold((0, 0), |best, next| {
            if energy(next.0, next.1) > energy(best.0, best.1) {
                next
            } else {
                best
            }
        });
    let start = |e: &Example| {
        let wave = &e.wave;
        Example {
            wave: wave.advanced(delay(wave, k + 1, wave.weights()[(d, k)], 0.0)),
            ..e.clone()
        }
    };
    Ok(examples.iter().map(start).collect())
}

impl FromStr for Start {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        match text {
            "kept" => Ok(Self::Kept),
            "redrawn" => Ok(Self::Redrawn),
            _ => parse_angle_with_unit(text).map(Self::Fixed).map_err(|_| {
                Error::new(ErrorKind::Setting, format!("start `{text}`"))
                    .expected("kept, redrawn, or a phase such as 0deg")
            }),
        }
    }
}

//! Targets in time and space: what a wave is to do that is not linear in its vector.

mod collapsed;
mod gradient;
mod parse;
mod posterior;

use crate::error::{Error, ErrorKind, Result};
use crate::fourier::{Joints, Wave};

pub use gradient::WeightGradient;
pub use posterior::Posterior;

/// Something that a wave is to do, with a standard deviation.
///
/// As text `elbow@1.2s=90deg+-2deg` (at 1.2 s the elbow is at 90 deg) or `elbow:1.2Hz..1.8Hz=10deg+-1deg` (its amplitude in that band).
#[derive(Debug, Clone, PartialEq)]
pub enum Target {
    /// A joint passes a position at a time.
    ViaPoint(ViaPoint),
    /// A joint moves so much within a band of frequencies.
    Band(Band),
}

/// y_d(t) = `position` +- `deviation` \[rad\].
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)]
pub struct ViaPoint {
    pub joint: String,
    /// \[s\]
    pub time: f64,
    /// \[rad\]
    pub position: f64,
    /// \[rad\]
    pub deviation: f64,
}

/// 2 sqrt(sum |w_{d,k}|^2) over the harmonics from `low` to `high` = `amplitude` +- `deviation` \[rad\]: of a tone that is not
/// exactly on a harmonic, or that wanders about one, this is the amplitude, and no single modulus is.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)]
pub struct Band {
    pub joint: String,
    /// \[Hz\]
    pub low: f64,
    /// \[Hz\]
    pub high: f64,
    /// \[rad\]
    pub amplitude: f64,
    /// \[rad\]
    pub deviation: f64,
}

impl Target {
    /// Checks the numbers, and finds the joint.
    fn joint(&self, joints: &Joints) -> Result<usize> {
        let (joint, numbers, deviation) = match self {
            Self::ViaPoint(p) => (&p.joint, [p.time, p.position, 0.0], p.deviation),
            Self::Band(b) => (&b.joint, [b.low, b.high, b.amplitude], b.deviation),
        };
        let place = |e: Error| e.at("target");
        if numbers.iter().any(|n| !n.is_finite()) {
            let what = "a time, position, frequency or amplitude that is no number";
            return Err(place(Error::new(ErrorKind::Value, what)));
        }
        if !(deviation > 0.0 && deviation.is_finite()) {
            return Err(place(
                Error::new(
                    ErrorKind::Value,
                    format!("a standard deviation of {deviation} rad"),
                )
                .expected("a positive one: what is not linear cannot be met exactly"),
            ));
        }
        if let Self::Band(b) = self
            && !(b.low < b.high && b.amplitude > 0.0)
        {
            return Err(place(
                Error::new(
                    ErrorKind::Value,
                    format!(
                        "an amplitude of {} rad from {} to {} Hz",
                        b.amplitude, b.low, b.high
                    ),
                )
                .expected("a positive one, the lower frequency first"),
            ));
        }
        joints.index(joint).map_err(place)
    }

    /// Whether a wave has a harmonic in the band.
    fn check_band(&self, wave: &Wave) -> Result<()> {
        match self {
            Self::Band(band) if band.harmonics(wave).is_empty() => Err(Error::new(
                ErrorKind::Name,
                format!("no harmonic from {} to {} Hz", band.low, band.high),
            )
            .at(format!("target `{self}`"))),
            _ => Ok(()),
        }
    }

    /// What is aimed at, of a wave \[rad\].
    ///
    /// # Errors
    /// When the wave has no such joint.
    pub fn measure(&self, wave: &Wave) -> Result<f64> {
        let joint = self.joint(wave.joints())?;
        Ok(self.value(wave, joint))
    }

    fn value(&self, wave: &Wave, joint: usize) -> f64 {
        match self {
            Self::ViaPoint(point) => wave.position_of(joint, point.time),
            Self::Band(band) => band.measure(wave, joint),
        }
    }

    /// The value, and its standard deviation \[rad\].
    pub fn aim(&self) -> (f64, f64) {
        match self {
            Self::ViaPoint(p) => (p.position, p.deviation),
            Self::Band(b) => (b.amplitude, b.deviation),
        }
    }

    /// -(value - aim)^2 / (2 deviation^2).
    fn log_likelihood(&self, wave: &Wave, joint: usize) -> f64 {
        let (aim, deviation) = self.aim();
        -0.5 * ((self.value(wave, joint) - aim) / deviation).powi(2)
    }

    /// The same, its gradient added to `gradient`.
    fn with_gradient(&self, wave: &Wave, joint: usize, gradient: &mut WeightGradient) -> f64 {
        let (aim, deviation) = self.aim();
        let value = self.value(wave, joint);
        let residual = (aim - value) / deviation;
        let slope = residual / deviation;
        match self {
            Self::ViaPoint(point) => gradient.add_position(wave, joint, point.time, slope),
            Self::Band(band) if value > 0.0 => {
                // d value / d w = 4 w / value, as a vector (Re, Im).
                for k in band.harmonics(wave) {
                    let weight = wave.weights()[(joint, k)];
                    gradient.weights[(joint, k)] += weight * (4.0 * slope / value);
                }
            }
            Self::Band(_) => {}
        }
        -0.5 * residual * residual
    }
}

impl Band {
    /// Indices of the harmonics within.
    fn harmonics(&self, wave: &Wave) -> std::ops::Range<usize> {
        let at = |hertz: f64| (hertz * wave.period()).clamp(0.0, wave.harmonics() as f64 + 1.0);
        // Frequencies that people write have few digits, harmonics have not: an end may be missed by rounding.
        let first = (at(self.low) - 1e-6).ceil().max(1.0) as usize;
        let last = ((at(self.high) + 1e-6).floor() as usize).min(wave.harmonics());
        first - 1..last.max(first - 1)
    }

    fn measure(&self, wave: &Wave, joint: usize) -> f64 {
        let square: f64 = self
            .harmonics(wave)
            .map(|k| wave.weights()[(joint, k)].norm_sqr())
            .sum();
        2.0 * libm::sqrt(square)
    }
}

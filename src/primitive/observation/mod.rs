//! What a user may ask of a wave: values of its coordinates, exact or with a standard deviation.

mod parse;

use std::fmt;

use super::LogPolar;
use super::gaussian::LinearObservation;
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::Interval;

/// Which harmonic: its number k, or its frequency k/T, for which a quarter of the spacing is near enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Harmonic {
    /// k, from 1.
    Number(usize),
    /// \[Hz\]
    Hertz(f64),
}

impl From<usize> for Harmonic {
    fn from(k: usize) -> Self {
        Self::Number(k)
    }
}

impl fmt::Display for Harmonic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(k) => write!(f, "{k}"),
            Self::Hertz(hertz) => write!(f, "{hertz}Hz"),
        }
    }
}

/// One quantity of a wave, by name: a linear function a^T x of its vector in a chart (the logarithm of it, for moduli and ratios).
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)] // of the fields: the variants say it
pub enum Coordinate {
    /// |w_{d,k}| \[rad\]: half the amplitude of harmonic k of a joint.
    Modulus { joint: String, harmonic: Harmonic },
    /// Arg w_{d,k} \[rad\].
    Phase { joint: String, harmonic: Harmonic },
    /// Arg w_{d,k} - Arg w_{e,k} \[rad\], joint d against joint e: who leads.
    RelativePhase {
        joint: String,
        to: String,
        harmonic: Harmonic,
    },
    /// w_{d,0} \[rad\]: the posture of a joint.
    Offset { joint: String },
    /// |w_{d,k}| / |w_{e,l}|.
    Ratio {
        joint: String,
        harmonic: Harmonic,
        to: String,
        to_harmonic: Harmonic,
    },
    /// Half of peak to peak of a joint's cycle, mean over the cycles of a wave \[rad\]. Of cycles only, as all that follow.
    Swing { joint: String },
    /// Cycles a second, mean over a wave \[Hz\].
    Frequency,
    /// How lively a wave is: standard deviation of ln amplitude or ln tempo from cycle to cycle (0.05 is 5 %).
    Jitter(JitterOf),
    /// |w_{d,h}| over the joint's swing.
    Shape { joint: String, harmonic: Harmonic },
    /// Arg w_{d,h} - h Arg w_{ref,1} \[rad\]: a phase that does not depend on the start.
    LockedPhase { joint: String, harmonic: Harmonic },
}

/// What varies from cycle to cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum JitterOf {
    Amplitude,
    Tempo,
}

/// In what a coordinate is told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// rad; as text degrees or radians.
    Angle,
    /// Hz
    Hertz,
    /// A plain number.
    Number,
    /// A plain number; as text per cent.
    Share,
}

impl Unit {
    /// For people: the factor from the number, and what to write behind it.
    pub(crate) fn told(self) -> (f64, &'static str) {
        match self {
            Self::Angle => (1f64.to_degrees(), "deg"),
            Self::Hertz => (1.0, "Hz"),
            Self::Number => (1.0, ""),
            Self::Share => (100.0, "%"),
        }
    }
}

impl Coordinate {
    /// |w_{d,k}|.
    pub fn modulus(joint: impl Into<String>, harmonic: impl Into<Harmonic>) -> Self {
        let (joint, harmonic) = (joint.into(), harmonic.into());
        Self::Modulus { joint, harmonic }
    }

    /// Arg w_{d,k}.
    pub fn phase(joint: impl Into<String>, harmonic: impl Into<Harmonic>) -> Self {
        let (joint, harmonic) = (joint.into(), harmonic.into());
        Self::Phase { joint, harmonic }
    }

    /// Arg w_{d,k} - Arg w_{e,k}.
    pub fn relative_phase(
        joint: impl Into<String>,
        to: impl Into<String>,
        harmonic: impl Into<Harmonic>,
    ) -> Self {
        Self::RelativePhase {
            joint: joint.into(),
            to: to.into(),
            harmonic: harmonic.into(),
        }
    }

    /// |w_{d,k}| / |w_{e,k}|.
    pub fn ratio(
        joint: impl Into<String>,
        to: impl Into<String>,
        harmonic: impl Into<Harmonic>,
    ) -> Self {
        let harmonic = harmonic.into();
        Self::Ratio {
            joint: joint.into(),
            harmonic,
            to: to.into(),
            to_harmonic: harmonic,
        }
    }

    /// The (first) harmonic, where there is one.
    pub fn harmonic(&self) -> Option<Harmonic> {
        match self {
            Self::Modulus { harmonic, .. }
            | Self::Phase { harmonic, .. }
            | Self::RelativePhase { harmonic, .. }
            | Self::Ratio { harmonic, .. }
            | Self::Shape { harmonic, .. }
            | Self::LockedPhase { harmonic, .. } => Some(*harmonic),
            Self::Offset { .. } | Self::Swing { .. } | Self::Frequency | Self::Jitter(_) => None,
        }
    }

    /// In what it is told.
    pub fn unit(&self) -> Unit {
        match self {
            Self::Ratio { .. } | Self::Shape { .. } => Unit::Number,
            Self::Frequency => Unit::Hertz,
            Self::Jitter(_) => Unit::Share,
            _ => Unit::Angle,
        }
    }

    /// Whether it is its logarithm that is linear in x (but for offsets, whose form the chart knows).
    pub(super) fn is_logarithmic(&self) -> bool {
        !matches!(
            self,
            Self::Phase { .. }
                | Self::RelativePhase { .. }
                | Self::LockedPhase { .. }
                | Self::Offset { .. }
        )
    }
}

impl fmt::Display for Coordinate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Modulus { joint, harmonic } => write!(f, "modulus:{joint}:{harmonic}"),
            Self::Phase { joint, harmonic } => write!(f, "phase:{joint}:{harmonic}"),
            Self::RelativePhase {
                joint,
                to,
                harmonic,
            } => write!(f, "phase:{joint}/{to}:{harmonic}"),
            Self::Offset { joint } => write!(f, "offset:{joint}"),
            Self::Ratio {
                joint,
                harmonic,
                to,
                to_harmonic,
            } => write!(f, "ratio:{joint}:{harmonic}/{to}:{to_harmonic}"),
            Self::Swing { joint } => write!(f, "swing:{joint}"),
            Self::Frequency => f.write_str("frequency"),
            Self::Jitter(JitterOf::Amplitude) => f.write_str("jitter:amplitude"),
            Self::Jitter(JitterOf::Tempo) => f.write_str("jitter:tempo"),
            Self::Shape { joint, harmonic } => write!(f, "shape:{joint}:{harmonic}"),
            Self::LockedPhase { joint, harmonic } => write!(f, "lock:{joint}:{harmonic}"),
        }
    }
}

/// What is observed.
#[derive(Debug, Clone, PartialEq)]
pub enum Quantity {
    /// A coordinate, in its own unit.
    One(Coordinate),
    /// Any linear row: a sum of coordinates times coefficients, as they stand in x: logarithms of moduli \[ln rad\] and ratios, angles \[rad\].
    Sum(Vec<(f64, Coordinate)>),
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::One(coordinate) => coordinate.fmt(f),
            Self::Sum(terms) => {
                f.write_str("sum:")?;
                for (i, (factor, coordinate)) in terms.iter().enumerate() {
                    let plus = if i > 0 && *factor >= 0.0 { "+" } else { "" };
                    write!(f, "{plus}{factor}*{coordinate}")?;
                }
                Ok(())
            }
        }
    }
}

/// A quantity and the value it is to have, exactly or with a standard deviation.
///
/// As text, angles always with a unit: `modulus:elbow:10=5deg`, `modulus:elbow:1.5Hz=5deg+-0.5deg`, `phase:elbow:10=-0.5rad`,
/// `phase:wrist/elbow:10=30deg`, `ratio:wrist:10/elbow:10=0.9`, `offset:wrist=10deg+-2deg`,
/// `sum:1*modulus:elbow:10-2*modulus:wrist:10=0.3`; of cycles `frequency=2.5Hz`, `swing:elbow=10deg`, `jitter:amplitude=5%`, `jitter:tempo=3%`.
///
/// ```
/// use undulate::{Coordinate, Observation};
///
/// let observation: Observation = "modulus:elbow:10=5deg".parse()?;
/// assert_eq!(observation, Observation::modulus("elbow", 10, 5f64.to_radians()));
/// let lead: Observation = "phase:wrist/elbow:10=0.5rad+-0.1rad".parse()?;
/// assert_eq!(lead, Observation::of(Coordinate::relative_phase("wrist", "elbow", 10), 0.5).within(0.1));
/// # Ok::<(), undulate::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    /// What is observed.
    pub quantity: Quantity,
    /// Its value: rad, or a plain number for ratios; as it stands in x for sums.
    pub value: f64,
    /// Standard deviation in the same unit, 0 for an exact value. Of a modulus or a ratio it acts on the logarithm: deviation / value.
    pub deviation: f64,
}

impl Observation {
    /// An exact value of a coordinate.
    pub fn of(coordinate: Coordinate, value: f64) -> Self {
        Self {
            quantity: Quantity::One(coordinate),
            value,
            deviation: 0.0,
        }
    }

    /// |w_{d,k}| = `value` \[rad\], half the amplitude.
    pub fn modulus(joint: impl Into<String>, harmonic: impl Into<Harmonic>, value: f64) -> Self {
        Self::of(Coordinate::modulus(joint, harmonic), value)
    }

    /// Arg w_{d,k} = `value` \[rad\], modulo 2 pi.
    pub fn phase(joint: impl Into<String>, harmonic: impl Into<Harmonic>, value: f64) -> Self {
        Self::of(Coordinate::phase(joint, harmonic), value)
    }

    /// w_{d,0} = `value` \[rad\].
    pub fn offset(joint: impl Into<String>, value: f64) -> Self {
        let joint = joint.into();
        Self::of(Coordinate::Offset { joint }, value)
    }

    /// A sum of coordinates times coefficients, as they stand in x, equals `value`.
    pub fn sum(terms: Vec<(f64, Coordinate)>, value: f64) -> Self {
        Self {
            quantity: Quantity::Sum(terms),
            value,
            deviation: 0.0,
        }
    }

    /// The same with a standard deviation.
    #[must_use]
    pub fn within(self, deviation: f64) -> Self {
        Self { deviation, ..self }
    }

    /// The linear observation over x that it is in a chart.
    pub(super) fn linear(&self, chart: &LogPolar) -> Result<LinearObservation> {
        let refuse = |what: String, expected: &str| {
            Err(Error::new(ErrorKind::Value, what).expected(expected))
        };
        let exact = self.deviation == 0.0;
        if !(exact || self.deviation.is_finite() && self.deviation > 0.0) {
            return refuse(
                format!("standard deviation is {}", self.deviation),
                "a positive number, or none for an exact value",
            );
        }
        let (row, value, deviation) = match &self.quantity {
            Quantity::One(coordinate) => {
                let value = chart.charted(coordinate, self.value)?;
                let scale = if chart.is_logarithmic(coordinate)? {
                    self.value.abs()
                } else {
                    1.0
                };
                (chart.row(coordinate)?, value, self.deviation / scale)
            }
            Quantity::Sum(terms) => {
                let mut row: Vec<(usize, f64)> = Vec::new();
                for (factor, coordinate) in terms {
                    for (i, c) in chart.row(coordinate)? {
                        match row.iter_mut().find(|(j, _)| *j == i) {
                            Some(entry) => entry.1 += factor * c,
                            None => row.push((i, factor * c)),
                        }
                    }
                }
                row.retain(|(_, c)| *c != 0.0);
                if row.is_empty() || row.iter().any(|(_, c)| !c.is_finite()) {
                    return refuse(
                        "a sum of nothing".into(),
                        "coefficients that leave something",
                    );
                }
                (row, self.value, self.deviation)
            }
        };
        if !Interval::within(LARGEST_VALUE).contains(value) {
            return refuse(
                format!("value is {}", self.value),
                "a number that a wave can have",
            );
        }
        if !exact && deviation < SMALLEST_DEVIATION {
            return refuse(
                format!("standard deviation is {}", self.deviation),
                "more than rounding, or none for an exact value",
            );
        }
        Ok(LinearObservation {
            row,
            value,
            deviation,
        })
    }
}

/// No quantity of a wave is larger as it stands in a vector.
const LARGEST_VALUE: f64 = 200.0;

/// Below this a standard deviation is no different from none.
const SMALLEST_DEVIATION: f64 = 1e-9;

impl fmt::Display for Observation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (scale, unit) = match &self.quantity {
            Quantity::One(coordinate) => coordinate.unit().told(),
            Quantity::Sum(_) => Unit::Number.told(),
        };
        write!(f, "{}={:.4}{unit}", self.quantity, scale * self.value)?;
        if self.deviation > 0.0 {
            write!(f, "+-{:.4}{unit}", scale * self.deviation)?;
        }
        Ok(())
    }
}

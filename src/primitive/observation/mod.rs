//! What a user may ask of a wave: values of its coordinates, exact or with a standard deviation.

mod coordinate;
mod parse;

use std::fmt;

pub use coordinate::{Coordinate, Harmonic, JitterOf, Unit};

use super::LogPolar;
use super::chart::add_to_row;
use super::gaussian::LinearObservation;
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::Interval;

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
    /// Standard deviation in the same unit, 0 for an exact value. Of what is learned as a logarithm (a modulus, a ratio, some
    /// offsets) it acts on that: deviation / |value|.
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
                    add_to_row(&mut row, *factor, &chart.row(coordinate)?);
                }
                if row.is_empty() || row.iter().any(|(_, c)| !c.is_finite()) {
                    return refuse(
                        "a sum of nothing".into(),
                        "coefficients that leave something",
                    );
                }
                (row, self.value, self.deviation)
            }
        };
        // Thresholds of rank and consistency are meant for rows of about unit size.
        let size = row.iter().fold(0.0, |size: f64, (_, c)| size.max(c.abs()));
        let scale = if matches!(self.quantity, Quantity::Sum(_)) {
            size
        } else {
            1.0
        };
        let row = row.into_iter().map(|(i, c)| (i, c / scale)).collect();
        let (value, deviation) = (value / scale, deviation / scale);
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

/// A primitive has no more: their number enters the time that they take with its cube.
pub(super) const MOST_OBSERVATIONS: usize = 1000;

/// No quantity of a wave is larger as it stands in a vector.
const LARGEST_VALUE: f64 = 200.0;

/// Below this a standard deviation is no different from none.
pub(super) const SMALLEST_DEVIATION: f64 = 1e-9;

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

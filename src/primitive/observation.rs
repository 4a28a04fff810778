//! What a user may ask of a wave: values of its coordinates, with units.

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, ErrorKind, Result};
use crate::units::parse_angle_with_unit;

/// One coordinate of a wave, by name.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Coordinate {
    /// |w_{d,k}| \[rad\]: half the amplitude of harmonic k of a joint.
    #[allow(missing_docs)]
    Modulus { joint: String, harmonic: usize },
    /// Arg w_{d,k} \[rad\].
    #[allow(missing_docs)]
    Phase { joint: String, harmonic: usize },
    /// w_{d,0} \[rad\]: the posture of a joint.
    #[allow(missing_docs)]
    Offset { joint: String },
}

impl Coordinate {
    /// k, where there is one.
    pub fn harmonic(&self) -> Option<usize> {
        match self {
            Self::Modulus { harmonic, .. } | Self::Phase { harmonic, .. } => Some(*harmonic),
            Self::Offset { .. } => None,
        }
    }

    /// The quantity \[rad\] of an entry of x: exp for a modulus, the entry itself otherwise.
    pub fn value(&self, charted: f64) -> f64 {
        match self {
            Self::Modulus { .. } => libm::exp(charted),
            Self::Phase { .. } | Self::Offset { .. } => charted,
        }
    }
}

impl fmt::Display for Coordinate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Modulus { joint, harmonic } => write!(f, "modulus:{joint}:{harmonic}"),
            Self::Phase { joint, harmonic } => write!(f, "phase:{joint}:{harmonic}"),
            Self::Offset { joint } => write!(f, "offset:{joint}"),
        }
    }
}

/// A coordinate and the value it is to have, exactly.
///
/// As text, always with a unit: `modulus:elbow:10=5deg`, `phase:elbow:10=-0.5rad`, `offset:wrist=10deg`.
///
/// ```
/// use undulate::{Coordinate, Observation};
///
/// let observation: Observation = "modulus:elbow:10=5deg".parse()?;
/// assert_eq!(observation, Observation::modulus("elbow", 10, 5f64.to_radians()));
/// # Ok::<(), undulate::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    /// What is observed.
    pub coordinate: Coordinate,
    /// Its value \[rad\].
    pub value: f64,
}

impl Observation {
    /// |w_{d,k}| = `value` \[rad\], half the amplitude.
    pub fn modulus(joint: impl Into<String>, harmonic: usize, value: f64) -> Self {
        let joint = joint.into();
        Self {
            coordinate: Coordinate::Modulus { joint, harmonic },
            value,
        }
    }

    /// Arg w_{d,k} = `value` \[rad\], modulo 2 pi.
    pub fn phase(joint: impl Into<String>, harmonic: usize, value: f64) -> Self {
        let joint = joint.into();
        Self {
            coordinate: Coordinate::Phase { joint, harmonic },
            value,
        }
    }

    /// w_{d,0} = `value` \[rad\].
    pub fn offset(joint: impl Into<String>, value: f64) -> Self {
        Self {
            coordinate: Coordinate::Offset {
                joint: joint.into(),
            },
            value,
        }
    }

    /// The value in the chart: the logarithm of a modulus, the principal value of a phase.
    pub(super) fn charted(&self) -> Result<f64> {
        let refuse = |expected: &str| {
            Err(
                Error::new(ErrorKind::Value, format!("value is {}", self.value))
                    .expected(expected)
                    .at(self.coordinate.to_string()),
            )
        };
        if !self.value.is_finite() {
            return refuse("a finite number");
        }
        match self.coordinate {
            Coordinate::Modulus { .. } if self.value <= 0.0 => refuse("a positive modulus"),
            Coordinate::Modulus { .. } => Ok(libm::log(self.value)),
            Coordinate::Phase { .. } => Ok(principal(self.value)),
            Coordinate::Offset { .. } => Ok(self.value),
        }
    }
}

/// The representative of an angle in (-pi, pi].
pub(super) fn principal(angle: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    let turned = angle - TAU * libm::round(angle / TAU);
    if turned <= -PI {
        turned + TAU
    } else if turned > PI {
        turned - TAU
    } else {
        turned
    }
}

impl FromStr for Observation {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        parse(text).map_err(|e| e.at(format!("condition `{text}`")))
    }
}

fn parse(text: &str) -> Result<Observation> {
    let grammar = "`modulus:JOINT:K=VALUE`, `phase:JOINT:K=VALUE` or `offset:JOINT=VALUE` with a value like 5deg or 0.1rad";
    let malformed = |what: String| Error::new(ErrorKind::Syntax, what).expected(grammar);
    let (address, value) = text
        .rsplit_once('=')
        .ok_or_else(|| malformed("no `=`".into()))?;
    let (quantity, rest) = address
        .split_once(':')
        .ok_or_else(|| malformed("no `:` after the quantity".into()))?;
    let value = parse_angle_with_unit(value)?;
    let harmonic = || {
        let (joint, k) = rest
            .rsplit_once(':')
            .ok_or_else(|| malformed(format!("`{quantity}` without a harmonic")))?;
        let k: usize = k
            .trim()
            .parse()
            .map_err(|_| malformed(format!("harmonic `{k}`")))?;
        Ok((joint.trim().to_owned(), k))
    };
    match quantity.trim() {
        "modulus" => harmonic().map(|(joint, k)| Observation::modulus(joint, k, value)),
        "phase" => harmonic().map(|(joint, k)| Observation::phase(joint, k, value)),
        "offset" => Ok(Observation::offset(rest.trim(), value)),
        other => Err(malformed(format!("quantity `{other}`"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn text_is_read_and_written() {
        for text in [
            "modulus:a:b:10=0.25rad",
            "phase:elbow:3=-1rad",
            "offset:wrist=0.5rad",
        ] {
            let observation: Observation = text.parse().unwrap();
            assert_eq!(
                format!("{}={}rad", observation.coordinate, observation.value),
                text
            );
        }
        let degrees: Observation = "phase:elbow:3 = 180 deg".parse().unwrap();
        assert_eq!(degrees.value, PI);
    }

    #[test]
    fn malformed_text_is_refused_with_the_grammar() {
        for text in [
            "",
            "modulus:elbow:10",
            "modulus:elbow=5deg",
            "size:elbow:1=1",
            "modulus:elbow:x=1",
            "modulus:elbow:1=5grad",
            "modulus:elbow:1=5",
            "modulus:elbow:1=NaN",
            "modulus:elbow:-1=1",
        ] {
            let error = text.parse::<Observation>().unwrap_err();
            assert_eq!(error.kind(), ErrorKind::Syntax, "{text}");
        }
    }

    #[test]
    fn principal_values_are_half_open() {
        assert_eq!(principal(PI), PI);
        assert_eq!(principal(-PI), PI);
        assert!((principal(7.0 * PI + 0.1) - (0.1 - PI)).abs() < 1e-14);
    }
}

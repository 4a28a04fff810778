//! The choices of a chart, as people name them.

use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

use super::{Cycles, FLOOR};
use crate::elementary::exp;
use crate::error::{Error, ErrorKind, Result};

/// How phases enter the vector.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum PhaseForm {
    /// Principal values in (-pi, pi], as numbers: the paper. Breaks where phases straddle +-pi.
    Principal,
    /// Angles about their amplitude-weighted circular mean, joint by joint. Fits demonstrations that all start at the same point of
    /// the cycle; else joints lose their relation.
    Recentred,
    /// The phases of a reference joint, and of all others relative to it, each about its circular mean. Of cycles, all phases relative to the
    /// first harmonic of the reference joint, times the harmonic.
    #[default]
    Relative,
}

impl PhaseForm {
    const NAMES: [(&'static str, Self); 3] = [
        ("principal", Self::Principal),
        ("recentred", Self::Recentred),
        ("relative", Self::Relative),
    ];
}

impl fmt::Display for PhaseForm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = Self::NAMES.iter().find(|n| n.1 == *self);
        f.write_str(name.map_or("", |n| n.0))
    }
}

impl FromStr for PhaseForm {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let named = Self::NAMES.iter().find(|n| n.0 == text);
        named.map(|n| n.1).ok_or_else(|| {
            Error::new(ErrorKind::Setting, format!("phases `{text}`"))
                .expected("principal, recentred or relative")
        })
    }
}

/// How waves become vectors: all the choices of a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct ChartForm {
    /// How phases enter.
    pub phases: PhaseForm,
    /// How each joint's offset does.
    pub offsets: Vec<OffsetForm>,
    /// How cycles follow each other, where the period is one cycle and not common to all.
    pub cycles: Option<Arc<Cycles>>,
}

/// How a joint's offset w_{d,0} \[rad\] enters the vector.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum OffsetForm {
    /// As it is.
    Signed,
    /// ln w_{d,0}: every demonstration's is positive, and so is every draw's.
    Positive,
    /// ln(-w_{d,0}): every demonstration's is negative, and so is every draw's.
    Negative,
}

impl OffsetForm {
    /// The logarithmic form of offsets, if they all have one sign.
    pub fn logarithmic(offsets: &[f64]) -> Option<Self> {
        if offsets.iter().all(|o| *o > FLOOR) {
            Some(Self::Positive)
        } else if offsets.iter().all(|o| *o < -FLOOR) {
            Some(Self::Negative)
        } else {
            None
        }
    }

    pub(crate) fn charted(self, offset: f64) -> Result<f64> {
        let magnitude = match self {
            Self::Signed => return Ok(offset),
            Self::Positive => offset,
            Self::Negative => -offset,
        };
        if magnitude > 0.0 {
            return Ok(libm::log(magnitude.max(FLOOR)));
        }
        Err(
            Error::new(ErrorKind::Infeasible, format!("an offset of {offset} rad"))
                .expected(format!("a {self} one: its logarithm is learned"))
                .help("learn with --offsets signed"),
        )
    }

    pub(crate) fn value(self, charted: f64) -> f64 {
        match self {
            Self::Signed => charted,
            Self::Positive => exp(charted),
            Self::Negative => -exp(charted),
        }
    }
}

impl fmt::Display for OffsetForm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Signed => "signed",
            Self::Positive => "positive",
            Self::Negative => "negative",
        })
    }
}

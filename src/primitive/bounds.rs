//! Draws that never leave given joint intervals.

use std::cmp::Ordering;
use std::str::FromStr;

use rand::distr::Distribution;

use super::{FourierMovementPrimitive, stream};
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::{Derivative, Interval, Joints, Wave};
use crate::units::parse_angle_with_unit;

/// Draws after which bounds are thought hopeless if none was within: a share of 1 % and more is missed with a probability below 1e-4.
const HOPELESS: u64 = 1000;

/// A joint and the interval \[rad\] in which it is to stay. As text `elbow=20deg..130deg`.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)]
pub struct Bound {
    pub joint: String,
    pub interval: Interval,
}

/// Intervals of joints that a wave is not to leave, at any time.
#[derive(Debug, Clone, PartialEq)]
pub struct Bounds {
    intervals: Vec<(usize, Interval)>,
}

/// What came of drawing within bounds.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundedDraws {
    /// The waves that stay within, in the order in which they were drawn, each with the number of its stream.
    pub waves: Vec<(u64, Wave)>,
    /// How many were drawn for them.
    pub draws: u64,
}

impl BoundedDraws {
    /// Share of the draws that stay within.
    pub fn acceptance(&self) -> f64 {
        self.waves.len() as f64 / self.draws as f64
    }
}

impl Bounds {
    /// # Errors
    /// When a joint does not exist, or an interval is empty.
    pub fn new(joints: &Joints, bounds: &[Bound]) -> Result<Self> {
        let intervals = bounds
            .iter()
            .map(|bound| {
                if bound.interval.lower.partial_cmp(&bound.interval.upper) != Some(Ordering::Less) {
                    return Err(Error::new(
                        ErrorKind::Value,
                        format!(
                            "an interval from {:.3} to {:.3} deg",
                            bound.interval.lower.to_degrees(),
                            bound.interval.upper.to_degrees()
                        ),
                    )
                    .expected("the lower end first")
                    .at(format!("bounds of `{}`", bound.joint)));
                }
                Ok((joints.index(&bound.joint)?, bound.interval))
            })
            .collect::<Result<_>>()?;
        Ok(Self { intervals })
    }

    /// Whether the wave stays within, over its whole period: by its exact range ([`Wave::range`]), which may refuse a wave that comes
    /// within 1e-6 of its amplitude of a bound, and never admits one that leaves it.
    pub fn admit(&self, wave: &Wave) -> bool {
        self.intervals.iter().all(|(joint, interval)| {
            let range = wave.range(*joint, Derivative::Position);
            interval.lower <= range.lower && range.upper <= interval.upper
        })
    }
}

impl FourierMovementPrimitive {
    /// `count` waves within `bounds`, from the streams of `seed` from number `first` on (see [`stream`]): draws that leave them are rejected, so what
    /// is drawn is the primitive given that the wave stays within.
    ///
    /// # Errors
    /// When it is hopeless: none of the first thousand draws stays within, or on the whole fewer than one of a thousand.
    pub fn sample_within(
        &self,
        bounds: &Bounds,
        count: usize,
        seed: u64,
        first: u64,
    ) -> Result<BoundedDraws> {
        let mut waves: Vec<(u64, Wave)> = Vec::new();
        let mut draws = 0;
        while waves.len() < count {
            if draws >= HOPELESS.saturating_mul(waves.len() as u64 + 1) {
                return Err(Error::new(
                    ErrorKind::Infeasible,
                    format!("{} of {draws} draws stay within the bounds", waves.len()),
                )
                .expected("at least one of a thousand")
                .help("widen the bounds, or condition on smaller amplitudes or another posture"));
            }
            let index = first.wrapping_add(draws);
            draws += 1;
            let wave = self.sample(&mut stream(seed, index));
            if bounds.admit(&wave) {
                waves.push((index, wave));
            }
        }
        Ok(BoundedDraws { waves, draws })
    }
}

impl FromStr for Bound {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let malformed = || {
            Error::new(ErrorKind::Syntax, format!("bound `{text}`"))
                .expected("JOINT=LOW..HIGH, such as elbow=20deg..130deg")
        };
        let (joint, interval) = text.rsplit_once('=').ok_or_else(malformed)?;
        let (lower, upper) = interval.split_once("..").ok_or_else(malformed)?;
        Ok(Self {
            joint: joint.trim().to_owned(),
            interval: Interval {
                lower: parse_angle_with_unit(lower)?,
                upper: parse_angle_with_unit(upper)?,
            },
        })
    }
}

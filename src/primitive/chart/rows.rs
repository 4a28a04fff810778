//! What people observe, as linear rows over x.

use super::phases::branch;
use super::{LogPolar, OffsetForm};
use crate::error::{Error, ErrorKind, Result};
use crate::primitive::observation::{Coordinate, Harmonic};

/// A frequency this far from a harmonic, in harmonics, is that harmonic.
const NEAR: f64 = 0.25;

impl LogPolar {
    /// The number of a harmonic.
    ///
    /// # Errors
    /// When it is not within 1..=K, or a frequency that is more than a quarter of the spacing from any; the message names both neighbours.
    pub fn harmonic(&self, harmonic: Harmonic) -> Result<usize> {
        let hertz = |k: usize| k as f64 / self.period();
        let within = |k: usize| {
            if k == 0 || k > self.harmonics() {
                return Err(
                    Error::new(ErrorKind::Name, format!("no harmonic {k}")).expected(format!(
                        "1 to {}, where {} is {:.2} Hz",
                        self.harmonics(),
                        self.harmonics(),
                        hertz(self.harmonics())
                    )),
                );
            }
            Ok(k)
        };
        match harmonic {
            Harmonic::Number(k) => within(k),
            Harmonic::Hertz(f) => {
                let turns = f * self.period();
                if !(turns >= 0.0 && turns < self.harmonics() as f64 + 1.0) {
                    return Err(
                        Error::new(ErrorKind::Name, format!("{f} Hz")).expected(format!(
                            "{:.3} to {:.3} Hz",
                            hertz(1),
                            hertz(self.harmonics())
                        )),
                    );
                }
                let nearest = turns.round();
                if (turns - nearest).abs() > NEAR {
                    let below = turns.floor() as usize;
                    return Err(Error::new(
                        ErrorKind::Name,
                        format!("{f} Hz lies between two harmonics"),
                    )
                    .expected(format!(
                        "near {:.3} Hz (k = {below}) or {:.3} Hz (k = {})",
                        hertz(below),
                        hertz(below + 1),
                        below + 1
                    ))
                    .help(format!(
                        "with T = {:.3} s there is one every {:.3} Hz",
                        self.period(),
                        hertz(1)
                    )));
                }
                within(nearest as usize)
            }
        }
    }

    fn address(&self, joint: &str, harmonic: Harmonic) -> Result<(usize, usize)> {
        Ok((self.joints().index(joint)?, self.harmonic(harmonic)? - 1))
    }

    /// The entries of a of a coordinate a^T x that are not zero, by index.
    ///
    /// # Errors
    /// When the joint or the harmonic is not of this chart.
    pub fn row(&self, coordinate: &Coordinate) -> Result<Vec<(usize, f64)>> {
        let (phases, offsets) = self.starts();
        let modulus = |joint: &str, harmonic| {
            let (d, k) = self.address(joint, harmonic)?;
            Ok::<_, Error>((d * self.harmonics() + k, 1.0))
        };
        let phase = |joint: &str, harmonic| {
            let (d, k) = self.address(joint, harmonic)?;
            let row = self.phases().row(d, k);
            Ok::<_, Error>(
                row.into_iter()
                    .map(|(i, c)| (phases + i, c))
                    .collect::<Vec<_>>(),
            )
        };
        let row = match coordinate {
            Coordinate::Modulus { joint, harmonic } => vec![modulus(joint, *harmonic)?],
            Coordinate::Phase { joint, harmonic } => phase(joint, *harmonic)?,
            Coordinate::RelativePhase {
                joint,
                to,
                harmonic,
            } => difference(phase(joint, *harmonic)?, phase(to, *harmonic)?),
            Coordinate::Offset { joint } => vec![(offsets + self.joints().index(joint)?, 1.0)],
            Coordinate::Ratio {
                joint,
                harmonic,
                to,
                to_harmonic,
            } => difference(
                vec![modulus(joint, *harmonic)?],
                vec![modulus(to, *to_harmonic)?],
            ),
        };
        if row.is_empty() {
            return Err(Error::new(ErrorKind::Name, "a quantity relative to itself")
                .expected("two different ones")
                .at(coordinate.to_string()));
        }
        Ok(row)
    }

    /// Whether it is the logarithm of the coordinate that is linear in x.
    pub(in crate::primitive) fn is_logarithmic(&self, coordinate: &Coordinate) -> Result<bool> {
        Ok(match coordinate {
            Coordinate::Modulus { .. } | Coordinate::Ratio { .. } => true,
            Coordinate::Phase { .. } | Coordinate::RelativePhase { .. } => false,
            Coordinate::Offset { joint } => {
                self.offset_forms()[self.joints().index(joint)?] != OffsetForm::Signed
            }
        })
    }

    /// b of a coordinate's value: the logarithm of a modulus or ratio, the representative of a phase nearest to its branch centre.
    ///
    /// # Errors
    /// When the coordinate is not of this chart, or the value none of its quantity.
    pub fn charted(&self, coordinate: &Coordinate, value: f64) -> Result<f64> {
        let refuse = |expected: &str| {
            Err(Error::new(ErrorKind::Value, format!("value is {value}")).expected(expected))
        };
        if !value.is_finite() {
            return refuse("a finite number");
        }
        match coordinate {
            Coordinate::Modulus { .. } | Coordinate::Ratio { .. } if value <= 0.0 => {
                refuse("a positive number: its logarithm is learned")
            }
            Coordinate::Modulus { .. } | Coordinate::Ratio { .. } => Ok(libm::log(value)),
            Coordinate::Phase { .. } | Coordinate::RelativePhase { .. } => {
                let (start, _) = self.starts();
                let centre = self
                    .row(coordinate)?
                    .iter()
                    .map(|(i, c)| c * self.phases().centres()[i - start])
                    .sum();
                Ok(branch(value, centre))
            }
            Coordinate::Offset { joint } => {
                let form = self.offset_forms()[self.joints().index(joint)?];
                form.charted(value)
            }
        }
    }

    /// The quantity of a value a^T x of the row of a coordinate: rad, or a plain number for a ratio.
    ///
    /// # Errors
    /// When the coordinate is not of this chart.
    pub fn value(&self, coordinate: &Coordinate, charted: f64) -> Result<f64> {
        Ok(match coordinate {
            Coordinate::Modulus { .. } | Coordinate::Ratio { .. } => libm::exp(charted),
            Coordinate::Phase { .. } | Coordinate::RelativePhase { .. } => charted,
            Coordinate::Offset { joint } => {
                self.offset_forms()[self.joints().index(joint)?].value(charted)
            }
        })
    }
}

/// a - b, entries that cancel left out.
fn difference(a: Vec<(usize, f64)>, b: Vec<(usize, f64)>) -> Vec<(usize, f64)> {
    let mut row = a;
    for (i, c) in b {
        match row.iter_mut().find(|(j, _)| *j == i) {
            Some(entry) => entry.1 -= c,
            None => row.push((i, -c)),
        }
    }
    row.retain(|(_, c)| *c != 0.0);
    row
}

//! What people observe, as linear rows over x.

use super::phases::branch;
use super::{LogPolar, OffsetForm};
use crate::error::{Error, ErrorKind, Result};
use crate::primitive::observation::{Coordinate, Harmonic, JitterOf};

/// A frequency this far from a harmonic, in harmonics, is that harmonic.
const NEAR: f64 = 0.25;

/// Frequencies that people write have few digits, k/T has not.
const ROUNDING: f64 = 1e-9;

impl LogPolar {
    /// The number of a harmonic.
    ///
    /// # Errors
    /// When it is not within 1..=K, or a frequency that is more than a quarter of the spacing from any; the message names both neighbours.
    pub fn harmonic(&self, harmonic: Harmonic) -> Result<usize> {
        let within = |k: usize| {
            if k == 0 || k > self.harmonics() {
                let last = self.harmonics();
                let hertz = self.period().map_or(String::new(), |period| {
                    format!(", where {last} is {:.2} Hz", last as f64 / period)
                });
                return Err(Error::new(ErrorKind::Name, format!("no harmonic {k}"))
                    .expected(format!("1 to {last}{hertz}")));
            }
            Ok(k)
        };
        match harmonic {
            Harmonic::Number(k) => within(k),
            Harmonic::Hertz(f) => {
                let Some(period) = self.period() else {
                    return Err(Error::new(
                        ErrorKind::Name,
                        format!("{f} Hz: every wave has its own frequency"),
                    )
                    .expected("the number of a harmonic of the cycle, or `frequency=VALUE`"));
                };
                let hertz = |k: usize| k as f64 / period;
                let turns = f * period;
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
                if (turns - nearest).abs() > NEAR * (1.0 + ROUNDING) {
                    let below = turns.floor() as usize;
                    let neighbours: Vec<String> = [below, below + 1]
                        .into_iter()
                        .filter(|k| (1..=self.harmonics()).contains(k))
                        .map(|k| format!("{:.3} Hz (k = {k})", hertz(k)))
                        .collect();
                    return Err(
                        Error::new(ErrorKind::Name, format!("{f} Hz lies on no harmonic"))
                            .expected(format!("near {}", neighbours.join(" or ")))
                            .help(format!(
                                "with T = {period:.3} s there is one every {:.3} Hz",
                                hertz(1)
                            )),
                    );
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
        let tail = |expected: &str| {
            self.tail().ok_or_else(|| {
                Error::new(
                    ErrorKind::Unsupported,
                    format!("{coordinate} in a model whose period is common to all waves"),
                )
                .expected(expected)
                .help("or learn with --period cycle")
            })
        };
        let joints = self.joints().len();
        let row = match coordinate {
            Coordinate::Modulus { joint, .. } if self.tail().is_some() => {
                return Err(Error::new(
                    ErrorKind::Unsupported,
                    "the modulus of a wave whose cycles vary",
                )
                .expected(format!("`swing:{joint}=VALUE`, half of peak to peak")));
            }
            Coordinate::Ratio { joint, to, .. } if self.tail().is_some() && joint != to => {
                return Err(Error::new(
                    ErrorKind::Unsupported,
                    "a ratio of moduli of two joints whose cycles vary",
                )
                .expected(format!("`sum:1*swing:{joint}-1*swing:{to}=LOGARITHM`")));
            }
            Coordinate::Shape { joint, harmonic } => {
                tail("`modulus:JOINT:K=VALUE`")?;
                vec![modulus(joint, *harmonic)?]
            }
            Coordinate::LockedPhase { joint, harmonic } => {
                tail("`phase:JOINT/JOINT:K=VALUE`")?;
                let (d, k) = self.address(joint, *harmonic)?;
                if self.phases().anchor(d, k).is_none() {
                    return Err(Error::new(
                        ErrorKind::Name,
                        "the phase of the reference joint itself",
                    )
                    .expected("phases that are relative, and another joint or harmonic"));
                }
                vec![(phases + d * self.harmonics() + k, 1.0)]
            }
            Coordinate::Swing { joint } => {
                let start = tail("`modulus:JOINT:K=VALUE`, half the amplitude of a harmonic")?;
                vec![(start + self.joints().index(joint)?, 1.0)]
            }
            Coordinate::Frequency => {
                vec![(tail("`modulus:JOINT:2.5Hz=VALUE`")? + joints, 1.0)]
            }
            Coordinate::Jitter(of) => {
                let level = match of {
                    JitterOf::Amplitude => 1,
                    JitterOf::Tempo => 2,
                };
                vec![(tail("a phase or a modulus")? + joints + level, 1.0)]
            }
            Coordinate::Modulus { joint, harmonic } => vec![modulus(joint, *harmonic)?],
            Coordinate::Phase { joint, harmonic } => phase(joint, *harmonic)?,
            Coordinate::RelativePhase {
                joint,
                to,
                harmonic,
            } => difference(phase(joint, *harmonic)?, &phase(to, *harmonic)?),
            Coordinate::Offset { joint } => vec![(offsets + self.joints().index(joint)?, 1.0)],
            Coordinate::Ratio {
                joint,
                harmonic,
                to,
                to_harmonic,
            } => difference(
                vec![modulus(joint, *harmonic)?],
                &[modulus(to, *to_harmonic)?],
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
    pub(crate) fn is_logarithmic(&self, coordinate: &Coordinate) -> Result<bool> {
        match coordinate {
            Coordinate::Offset { joint } => {
                Ok(self.offset_forms()[self.joints().index(joint)?] != OffsetForm::Signed)
            }
            _ => Ok(coordinate.is_logarithmic()),
        }
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
            Coordinate::Offset { joint } => {
                self.offset_forms()[self.joints().index(joint)?].charted(value)
            }
            _ if coordinate.is_logarithmic() => {
                if value > 0.0 {
                    Ok(libm::log(value))
                } else {
                    refuse("a positive number: its logarithm is learned")
                }
            }
            _ => {
                let (start, _) = self.starts();
                let centre = self
                    .row(coordinate)?
                    .iter()
                    .map(|(i, c)| c * self.phases().centres()[i - start])
                    .sum();
                Ok(branch(value, centre))
            }
        }
    }

    /// The quantity of a value a^T x of the row of a coordinate: rad, or a plain number for a ratio.
    ///
    /// # Errors
    /// When the coordinate is not of this chart.
    pub fn value(&self, coordinate: &Coordinate, charted: f64) -> Result<f64> {
        Ok(match coordinate {
            Coordinate::Offset { joint } => {
                self.offset_forms()[self.joints().index(joint)?].value(charted)
            }
            _ if coordinate.is_logarithmic() => libm::exp(charted),
            _ => charted,
        })
    }
}

/// row + factor a, entries that cancel left out.
pub(in crate::primitive) fn add_to_row(
    row: &mut Vec<(usize, f64)>,
    factor: f64,
    a: &[(usize, f64)],
) {
    for (i, c) in a {
        match row.iter_mut().find(|(j, _)| j == i) {
            Some(entry) => entry.1 += factor * c,
            None => row.push((*i, factor * c)),
        }
    }
    row.retain(|(_, c)| *c != 0.0);
}

/// a - b.
fn difference(mut a: Vec<(usize, f64)>, b: &[(usize, f64)]) -> Vec<(usize, f64)> {
    add_to_row(&mut a, -1.0, b);
    a
}

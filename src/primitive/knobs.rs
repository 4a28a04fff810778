//! Wishes as people have them, translated into observations of models whose period is a cycle.
//!
//! With a common period there is no row over x that is a tempo or a size: every wave has its energy about harmonics of its own. Knobs on such
//! models are refused, and say so.

use super::{Coordinate, FourierMovementPrimitive, JitterOf, Observation};
use crate::error::{Error, ErrorKind, Result};

impl FourierMovementPrimitive {
    /// `factor` times as fast: the frequency.
    ///
    /// # Errors
    /// When the factor is not positive, or the period is common.
    pub fn at_tempo(&self, factor: f64) -> Result<Vec<Observation>> {
        Ok(vec![self.times(Coordinate::Frequency, factor)?])
    }

    /// `factor` times as large: the swing of every joint; one that stands still stands still at any size.
    ///
    /// # Errors
    /// When the factor is not positive, or the period is common.
    pub fn at_size(&self, factor: f64) -> Result<Vec<Observation>> {
        let mut sized = Vec::new();
        for joint in self.chart().joints() {
            let joint = joint.clone();
            let swing = Coordinate::Swing { joint };
            let observation = self.times(swing.clone(), factor)?;
            if self.standard_deviation(&swing)? > 0.0 {
                sized.push(observation);
            }
        }
        Ok(sized)
    }

    /// More of a joint: a standard deviation above the median of its swing.
    ///
    /// # Errors
    /// When there is no such joint, or the period is common.
    pub fn with_more(&self, joint: &str) -> Result<Observation> {
        self.chart().joints().index(joint)?;
        self.need_cycles()?;
        let joint = joint.to_owned();
        let swing = Coordinate::Swing { joint };
        let factor = self.standard_deviation(&swing)?.exp();
        self.times(swing, factor)
    }

    /// `factor` times as lively: the jitter of amplitude and of tempo.
    ///
    /// # Errors
    /// When the factor is not positive, or the period is common.
    pub fn livelier(&self, factor: f64) -> Result<Vec<Observation>> {
        [JitterOf::Amplitude, JitterOf::Tempo]
            .into_iter()
            .map(|of| self.times(Coordinate::Jitter(of), factor))
            .collect()
    }

    fn times(&self, coordinate: Coordinate, factor: f64) -> Result<Observation> {
        if !(factor > 0.0 && factor.is_finite()) {
            return Err(
                Error::new(ErrorKind::Setting, format!("a factor of {factor}"))
                    .expected("a positive number"),
            );
        }
        self.need_cycles()?;
        let median = self.median(&coordinate)?;
        Ok(Observation::of(coordinate, factor * median))
    }

    fn need_cycles(&self) -> Result<()> {
        if self.chart().cycles().is_some() {
            return Ok(());
        }
        Err(Error::new(
            ErrorKind::Unsupported,
            "a knob of a model whose period is common to all waves: none of its numbers is a tempo or a size",
        )
        .expected("a model learned with --period cycle")
        .help("or condition on moduli at the frequencies that you want, such as modulus:JOINT:1.5Hz=5deg"))
    }
}

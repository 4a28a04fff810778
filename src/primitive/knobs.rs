//! Wishes as people have them, translated into observations.

use super::{Coordinate, FourierMovementPrimitive, Harmonic, JitterOf, Observation};
use crate::error::{Error, ErrorKind, Result};

/// A wish is heard if it comes this near, in harmonics.
const NEAR: f64 = 0.25;

impl FourierMovementPrimitive {
    /// `factor` times as fast.
    ///
    /// Of cycles, the frequency times the factor. With a common period, the largest median modulus, at harmonic k, moves to
    /// harmonic `factor` k, and what was there moves to k.
    ///
    /// # Errors
    /// When the factor is not positive, or `factor` k is no harmonic, or k itself; the message names the neighbours.
    pub fn at_tempo(&self, factor: f64) -> Result<Vec<Observation>> {
        check(factor)?;
        if self.chart().cycles().is_some() {
            let frequency = self.median(&Coordinate::Frequency)?;
            return Ok(vec![Observation::of(
                Coordinate::Frequency,
                factor * frequency,
            )]);
        }
        let mut strongest = (String::new(), 0, 0.0);
        for joint in self.chart().joints() {
            let (k, modulus) = self.strongest(joint)?;
            if modulus > strongest.2 {
                strongest = (joint.clone(), k, modulus);
            }
        }
        let (joint, k, modulus) = strongest;
        let target = factor * k as f64;
        let nearest = target.round();
        if (target - nearest).abs() > NEAR || nearest < 1.0 || nearest as usize == k {
            let below = (target.floor() as usize).max(1);
            let reached = |to: usize| format!("{:.3}x (k = {to})", to as f64 / k as f64);
            return Err(Error::new(
                ErrorKind::Setting,
                format!("a tempo of {factor}x takes harmonic {k} to {target:.2}"),
            )
            .expected(format!("near {} or {}", reached(below), reached(below + 1)))
            .help("or learn with --period cycle, where every tempo is a number"));
        }
        let to = nearest as usize;
        let there = self.median_modulus(&joint, to)?;
        Ok(vec![
            Observation::modulus(joint.clone(), to, modulus),
            Observation::modulus(joint, k, there),
        ])
    }

    /// `factor` times as large: every joint's swing, or with a common period its largest median modulus.
    ///
    /// # Errors
    /// When the factor is not positive.
    pub fn at_size(&self, factor: f64) -> Result<Vec<Observation>> {
        check(factor)?;
        self.chart()
            .joints()
            .iter()
            .map(|joint| {
                let amplitude = self.amplitude(joint)?;
                let median = self.median(&amplitude)?;
                Ok(Observation::of(amplitude, factor * median))
            })
            .collect()
    }

    /// More of a joint: a standard deviation above the median of its swing, or with a common period of its largest median modulus.
    ///
    /// # Errors
    /// When there is no such joint.
    pub fn with_more(&self, joint: &str) -> Result<Observation> {
        let amplitude = self.amplitude(joint)?;
        let above = self.standard_deviation(&amplitude)?.exp();
        let median = self.median(&amplitude)?;
        Ok(Observation::of(amplitude, above * median))
    }

    /// `factor` times as lively: the jitter of amplitude and of tempo.
    ///
    /// # Errors
    /// When the factor is not positive, or the period is common.
    pub fn livelier(&self, factor: f64) -> Result<Vec<Observation>> {
        check(factor)?;
        [JitterOf::Amplitude, JitterOf::Tempo]
            .into_iter()
            .map(|of| {
                let jitter = Coordinate::Jitter(of);
                let median = self.median(&jitter)?;
                Ok(Observation::of(jitter, factor * median))
            })
            .collect()
    }

    /// How large a joint's motion is.
    fn amplitude(&self, joint: &str) -> Result<Coordinate> {
        if self.chart().cycles().is_some() {
            let joint = joint.to_owned();
            self.chart().joints().index(&joint)?;
            return Ok(Coordinate::Swing { joint });
        }
        let (k, _) = self.strongest(joint)?;
        Ok(Coordinate::modulus(joint, k))
    }

    /// The harmonic of a joint's largest median modulus, and that.
    fn strongest(&self, joint: &str) -> Result<(usize, f64)> {
        let mut best = (1, 0.0);
        for k in 1..=self.chart().harmonics() {
            let modulus = self.median_modulus(joint, Harmonic::Number(k))?;
            if modulus > best.1 {
                best = (k, modulus);
            }
        }
        Ok(best)
    }
}

fn check(factor: f64) -> Result<()> {
    if factor > 0.0 && factor.is_finite() {
        return Ok(());
    }
    Err(
        Error::new(ErrorKind::Setting, format!("a factor of {factor}"))
            .expected("a positive number"),
    )
}

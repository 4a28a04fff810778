//! Wishes as people have them, translated into observations.

use super::{Coordinate, FourierMovementPrimitive, JitterOf, Observation, Quantity};
use crate::error::{Error, ErrorKind, Result};

impl FourierMovementPrimitive {
    /// `factor` times as fast: of cycles, the frequency.
    ///
    /// # Errors
    /// When the factor is not positive, or the period is common: there every wave has its energy about harmonics of its own, and no row over x is its tempo.
    pub fn at_tempo(&self, factor: f64) -> Result<Vec<Observation>> {
        check(factor)?;
        self.need_cycles("a tempo")?;
        let frequency = self.median(&Coordinate::Frequency)?;
        Ok(vec![Observation::of(
            Coordinate::Frequency,
            factor * frequency,
        )])
    }

    /// `factor` times as large: of cycles, every joint's swing. With a common period, of every joint the mean of its log moduli, each
    /// weighted by its expected energy E|w_k|^2.
    ///
    /// # Errors
    /// When the factor is not positive.
    pub fn at_size(&self, factor: f64) -> Result<Vec<Observation>> {
        check(factor)?;
        let mut sized = Vec::new();
        for joint in self.chart().joints() {
            // A joint that stands still stands still at any size.
            if self.spread_of_size(joint)? > 0.0 {
                sized.push(self.resized(joint, factor)?);
            }
        }
        Ok(sized)
    }

    /// More of a joint: a standard deviation above the median of what [`at_size`](Self::at_size) scales.
    ///
    /// # Errors
    /// When there is no such joint.
    pub fn with_more(&self, joint: &str) -> Result<Observation> {
        self.resized(joint, self.spread_of_size(joint)?.exp())
    }

    /// `factor` times as lively: the jitter of amplitude and of tempo.
    ///
    /// # Errors
    /// When the factor is not positive, or the period is common.
    pub fn livelier(&self, factor: f64) -> Result<Vec<Observation>> {
        check(factor)?;
        self.need_cycles("liveliness")?;
        [JitterOf::Amplitude, JitterOf::Tempo]
            .into_iter()
            .map(|of| {
                let jitter = Coordinate::Jitter(of);
                let median = self.median(&jitter)?;
                Ok(Observation::of(jitter, factor * median))
            })
            .collect()
    }

    fn need_cycles(&self, what: &str) -> Result<()> {
        if self.chart().cycles().is_some() {
            return Ok(());
        }
        Err(Error::new(
            ErrorKind::Unsupported,
            format!("{what} of a model whose period is common to all waves"),
        )
        .expected("a model learned with --period cycle")
        .help("or condition on moduli at the frequencies you want"))
    }

    /// How large a joint's motion is, as one row.
    fn size(&self, joint: &str) -> Result<Observation> {
        if self.chart().cycles().is_some() {
            let joint = joint.to_owned();
            let swing = Coordinate::Swing { joint };
            let median = self.median(&swing)?;
            return Ok(Observation::of(swing, median));
        }
        let moduli: Vec<Coordinate> = (1..=self.chart().harmonics())
            .map(|k| Coordinate::modulus(joint, k))
            .collect();
        let energies = moduli
            .iter()
            .map(|modulus| {
                let spread = self.standard_deviation(modulus)?;
                // E exp(2 l) of a normal l.
                Ok((self.median(modulus)? * spread.powi(2).exp()).powi(2))
            })
            .collect::<Result<Vec<f64>>>()?;
        let total: f64 = energies.iter().sum();
        let terms = energies.iter().map(|e| e / total).zip(moduli).collect();
        let mut size = Observation::sum(terms, 0.0);
        size.value = self.median_of(&size)?;
        Ok(size)
    }

    /// Standard deviation of the logarithm of a joint's size.
    fn spread_of_size(&self, joint: &str) -> Result<f64> {
        let size = self.size(joint)?;
        // Rows are scaled to unit size.
        let scale = match &size.quantity {
            Quantity::One(_) => 1.0,
            Quantity::Sum(terms) => terms.iter().fold(0.0, |s: f64, (c, _)| s.max(c.abs())),
        };
        Ok(scale
            * self
                .gaussian()
                .deviation_of(&size.linear(self.chart())?.row))
    }

    fn resized(&self, joint: &str, factor: f64) -> Result<Observation> {
        let mut size = self.size(joint)?;
        if self.chart().cycles().is_some() {
            size.value *= factor;
        } else {
            size.value += factor.ln();
        }
        Ok(size)
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

//! [`FourierMovementPrimitive`]: a distribution over waves, learned from demonstrations.

mod chart;
mod file;
mod gaussian;
mod observation;

use std::fmt;

use rand::distr::Distribution;
use rand::rngs::ChaCha8Rng;
use rand::{Rng, SeedableRng};

pub use chart::LogPolar;
pub use gaussian::Gaussian;
pub use observation::{Coordinate, Observation};

use crate::demonstration::Demonstrations;
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::Wave;

/// Beyond exp of this, a weight or its derivative may overflow.
const LARGEST_LOGARITHM: f64 = 300.0;

/// A Gaussian over the log moduli, phases and offsets of waves
/// (Panteris, Manschitz and Calinon, "Learning, Generating and Adapting Wave Gestures for Expressive Human-Robot
/// Interaction", HRI 2020 Companion, doi 10.1145/3371382.3378286).
///
/// Learn it, condition it (again a primitive), draw [`Wave`]s from it:
///
/// ```
/// use rand::distr::Distribution;
/// use undulate::{FourierMovementPrimitive, Observation, stream, synthetic};
///
/// let primitive = FourierMovementPrimitive::learn(&synthetic(0)?, 25)?;
/// let larger = primitive.condition(&[Observation::modulus("elbow_flexion", 10, 5f64.to_radians())])?;
/// let wave = larger.sample(&mut stream(7, 0));
/// assert!((wave.weights()[(3, 9)].norm() - 5f64.to_radians()).abs() < 1e-12);
/// # Ok::<(), undulate::Error>(())
/// ```
#[derive(Clone, PartialEq)]
pub struct FourierMovementPrimitive {
    chart: LogPolar,
    gaussian: Gaussian,
}

impl FourierMovementPrimitive {
    /// Learns from demonstrations with harmonics 0..=K: least squares, log-polar chart, maximum likelihood (Algorithm 1).
    ///
    /// # Errors
    /// Those of [`Demonstrations::fit`] and [`from_waves`](Self::from_waves).
    pub fn learn(demonstrations: &Demonstrations, harmonics: usize) -> Result<Self> {
        Self::from_waves(&demonstrations.fit(harmonics)?)
    }

    /// Learns from waves that are fitted already.
    ///
    /// # Errors
    /// When there are fewer than two, or they differ in joints, period or harmonics.
    pub fn from_waves(waves: &[Wave]) -> Result<Self> {
        let Some(first) = waves.first() else {
            return Err(Error::new(ErrorKind::Shape, "no waves").expected("at least two"));
        };
        let chart = LogPolar::of(first);
        let vectors = waves
            .iter()
            .map(|wave| chart.vector(wave))
            .collect::<Result<Vec<_>>>()?;
        Self::new(chart, Gaussian::maximum_likelihood(&vectors)?)
    }

    /// A primitive of a given Gaussian in a chart.
    ///
    /// # Errors
    /// When the dimensions differ, or draws of the Gaussian could overflow.
    pub fn new(chart: LogPolar, gaussian: Gaussian) -> Result<Self> {
        if gaussian.dimension() != chart.dimension() {
            return Err(Error::new(
                ErrorKind::Shape,
                format!("a Gaussian of {} dimensions", gaussian.dimension()),
            )
            .expected(format!("{}, 2 D K + D", chart.dimension())));
        }
        // So that a draw is a wave, whatever the random numbers.
        for i in 0..gaussian.dimension() {
            if gaussian.mean()[i].abs() + gaussian.reach(i) > LARGEST_LOGARITHM {
                let place = chart
                    .coordinate(i)
                    .map_or_else(String::new, |c| c.to_string());
                return Err(Error::new(
                    ErrorKind::Value,
                    format!(
                        "mean {} with standard deviation {} can overflow",
                        gaussian.mean()[i],
                        gaussian.standard_deviation(i)
                    ),
                )
                .help("check the units of the demonstrations, or leave out what does not belong to them")
                .at(place));
            }
        }
        Ok(Self { chart, gaussian })
    }

    /// Joints, period, harmonics, and where each coordinate stands.
    pub fn chart(&self) -> &LogPolar {
        &self.chart
    }

    /// The Gaussian over the coordinates of the chart.
    pub fn gaussian(&self) -> &Gaussian {
        &self.gaussian
    }

    /// The primitive given exact values of some coordinates (equation (2)); any number of them, in any order.
    ///
    /// # Errors
    /// When a coordinate does not exist, a value is no value of its quantity, or it contradicts what is certain already:
    /// other observations, or, at rank M - 1, the demonstrations themselves.
    pub fn condition(&self, observations: &[Observation]) -> Result<Self> {
        let rows = self.rows(observations)?;
        for (i, row) in rows.iter().enumerate() {
            if rows[..i]
                .iter()
                .any(|other| other.0 == row.0 && other.1 != row.1)
            {
                return Err(Error::new(
                    ErrorKind::Infeasible,
                    "given twice, with different values",
                )
                .at(format!("condition {}", observations[i].coordinate)));
            }
        }
        let gaussian = self.gaussian.condition(&rows).map_err(|c| {
            let observation = &observations[c.observation];
            let certain = observation.coordinate.value(c.certain);
            Error::new(
                ErrorKind::Infeasible,
                format!(
                    "{:.4} deg contradicts what is certain already, {:.4} deg (a difference of {:.3e} rad)",
                    observation.value.to_degrees(),
                    certain.to_degrees(),
                    observation.value - certain
                ),
            )
            .expected("a value that the other conditions and the demonstrations leave open")
            .help(format!(
                "the model varies in {} directions (demonstrations less one, less earlier conditions), this coordinate by a standard deviation of {:.3e}: drop a condition, or learn from more demonstrations",
                self.gaussian.rank(),
                c.prior_deviation
            ))
            .at(format!("condition {}", observation.coordinate))
        })?;
        Self::new(self.chart.clone(), gaussian)
    }

    /// How far the values lie from the mean of the primitive, in standard deviations (Mahalanobis distance of the observed
    /// coordinates together). Log moduli extrapolate exponentially: far beyond 3 for one value, or 3 sqrt(m) for m of
    /// them, what the rest of the wave becomes is no longer what the demonstrations showed.
    ///
    /// # Errors
    /// When a coordinate does not exist or a value is no value of its quantity.
    pub fn mahalanobis(&self, observations: &[Observation]) -> Result<f64> {
        Ok(self.gaussian.mahalanobis(&self.rows(observations)?))
    }

    /// Index and charted value of each observation.
    fn rows(&self, observations: &[Observation]) -> Result<Vec<(usize, f64)>> {
        observations
            .iter()
            .map(|o| {
                let index = self.chart.index(&o.coordinate);
                let index = index.map_err(|e| e.at(format!("condition {}", o.coordinate)))?;
                let value = o.charted()?;
                // As far from the overflow as a learned mean must be.
                if value.abs() > LARGEST_LOGARITHM {
                    return Err(
                        Error::new(ErrorKind::Value, format!("value is {}", o.value))
                            .at(o.coordinate.to_string()),
                    );
                }
                Ok((index, value))
            })
            .collect()
    }

    /// exp(mu) of |w_{d,k}| \[rad\]: the median modulus.
    ///
    /// # Errors
    /// When the joint or harmonic does not exist.
    pub fn median_modulus(&self, joint: &str, harmonic: usize) -> Result<f64> {
        let joint = joint.to_owned();
        let index = self.chart.index(&Coordinate::Modulus { joint, harmonic })?;
        Ok(libm::exp(self.gaussian.mean()[index]))
    }

    /// The wave at the mean of the Gaussian: median moduli, mean phases and offsets.
    pub fn mean_wave(&self) -> Wave {
        self.wave(self.gaussian.mean())
    }

    fn wave(&self, x: &nalgebra::DVector<f64>) -> Wave {
        self.chart
            .wave(x)
            .expect("`new` admits only Gaussians whose every draw is a wave")
    }
}

/// In a line: thousands of numbers help nobody.
impl fmt::Debug for FourierMovementPrimitive {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("FourierMovementPrimitive")
            .field("joints", self.chart.joints())
            .field("period", &self.chart.period())
            .field("harmonics", &self.chart.harmonics())
            .field("rank", &self.gaussian.rank())
            .finish()
    }
}

/// Draws waves; the same generator state gives the same wave on every machine.
impl Distribution<Wave> for FourierMovementPrimitive {
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> Wave {
        self.wave(&self.gaussian.sample(rng))
    }
}

/// The generator of sample number `index` of seed `seed`: one stream a sample, so that sample k is the same wave
/// whether it is drawn first, last, or on another machine.
pub fn stream(seed: u64, index: u64) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(index);
    rng
}

//! [`FourierMovementPrimitive`]: a distribution over waves, learned from demonstrations.

mod bounds;
mod chart;
mod covariance;
mod estimator;
mod example;
mod file;
mod gaussian;
mod knobs;
mod kronecker;
mod learn;
mod learning_curve;
mod likelihood;
mod lone;
mod mixture;
mod moments;
mod observation;
mod scatter;
mod start;
mod start_spread;
mod target;

use std::fmt;

use nalgebra::DVector;
use rand::distr::Distribution;
use rand::rngs::ChaCha8Rng;
use rand::{Rng, SeedableRng};

pub use bounds::{Bound, BoundedDraws, Bounds};
pub use chart::{ChartForm, Cycles, Jitter, LogPolar, OffsetForm, PhaseForm};
pub use covariance::Covariance;
pub(crate) use estimator::{Density, block, weights};
pub use estimator::{Estimator, HeldOut};
pub use example::Example;
pub use gaussian::{Gaussian, LinearObservation};
pub use kronecker::Kronecker;
pub use learn::{LearnOptions, OffsetEvidence, Offsets};
pub use learning_curve::{CurvePoint, LearningCurve, SampleMean};
pub use lone::{LoneEnd, Seen};
pub use mixture::{Component, Grouping, GroupingOptions, HeldOutKinds, Kinds, Mixture};
pub use moments::TrajectoryMoments;
pub use observation::{Coordinate, Harmonic, JitterOf, Observation, Quantity, Unit};
pub use start::Start;
pub use start_spread::StartSpread;
pub use target::{Band, Posterior, Target, ViaPoint, WeightGradient};

use crate::error::{Error, ErrorKind, Result};
use crate::fourier::{Interval, Wave};
use crate::normal;
use gaussian::Contradiction;
use observation::MOST_OBSERVATIONS;

/// A draw farther from the mean than this many standard deviations has a probability below 1e-300.
const FARTHEST: f64 = 38.0;

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
            .expected(format!("{}", chart.dimension())));
        }
        let prior = gaussian.prior_covariance();
        for i in 0..gaussian.dimension() {
            let deviation = prior.variance(i).sqrt();
            // A draw of a frequency beyond its limit is drawn at it, which does no harm.
            let reach = if chart.frequency() == Some(i) {
                0.0
            } else {
                FARTHEST
            };
            let farthest = gaussian.prior_mean()[i].abs() + reach * deviation;
            if !Interval::within(chart.limit(i)).contains(farthest) {
                let place = chart
                    .coordinate(i)
                    .map_or_else(String::new, |c| c.to_string());
                return Err(Error::new(
                    ErrorKind::Value,
                    format!(
                        "mean {} with standard deviation {deviation} can overflow",
                        gaussian.prior_mean()[i],
                    ),
                )
                .help("is it practically zero in some demonstrations and not in others? take fewer harmonics, leave out a joint that stands still, or check the units")
                .at(place));
            }
        }
        Self { chart, gaussian }.within_bounds()
    }

    /// If no observation has moved the mean to where a weight may overflow.
    fn within_bounds(self) -> Result<Self> {
        let mean = self.gaussian.mean();
        match (0..mean.len()).find(|i| !Interval::within(self.chart.limit(*i)).contains(mean[*i])) {
            None => Ok(self),
            Some(i) => Err(Error::new(
                ErrorKind::Infeasible,
                format!("the conditions move a coordinate to {:.1e}", mean[i]),
            )
            .expected(format!("at most {}", self.chart.limit(i)))
            .help("ask for values nearer to the demonstrations, or with a standard deviation")
            .at(self
                .chart
                .coordinate(i)
                .map_or_else(String::new, |c| c.to_string()))),
        }
    }

    /// Joints, period, harmonics, and where each coordinate stands.
    pub fn chart(&self) -> &LogPolar {
        &self.chart
    }

    /// The Gaussian over the coordinates of the chart.
    pub fn gaussian(&self) -> &Gaussian {
        &self.gaussian
    }

    /// The primitive given values of some coordinates, exact or with standard deviations (equation (2)); any number of them, in any order.
    ///
    /// # Errors
    /// When a coordinate does not exist, a value is no value of its quantity, or contradicts what is certain already (other observations, or, at
    /// rank M - 1, the demonstrations themselves), or there are more than a thousand of them in all.
    pub fn condition(&self, observations: &[Observation]) -> Result<Self> {
        let all = self.gaussian.observations().len() + observations.len();
        if all > MOST_OBSERVATIONS {
            return Err(Error::new(ErrorKind::Setting, format!("{all} conditions"))
                .expected(format!("at most {MOST_OBSERVATIONS}")));
        }
        let linear = self.linear(observations)?;
        let gaussian = self
            .gaussian
            .condition(&linear)
            .map_err(|c| self.refused(&observations[c.observation], &linear[c.observation], &c))?;
        Self {
            chart: self.chart.clone(),
            gaussian,
        }
        .within_bounds()
    }

    fn refused(
        &self,
        observation: &Observation,
        linear: &LinearObservation,
        contradiction: &Contradiction,
    ) -> Error {
        let told = |charted: f64| match &observation.quantity {
            Quantity::One(coordinate) => {
                let value = self.chart.value(coordinate, charted).unwrap_or(charted);
                let (scale, unit) = coordinate.unit().told();
                format!("{:.4} {unit}", scale * value).trim_end().to_owned()
            }
            Quantity::Sum(_) => format!("{charted:.4}"),
        };
        let what = if contradiction.prior_deviation > 0.0 {
            "contradicts what is certain already"
        } else {
            "lies in a direction without variance"
        };
        Error::new(
            ErrorKind::Infeasible,
            format!(
                "{} {what}, {} (a residual of {:.3e} as it stands in the vector)",
                told(linear.value),
                told(contradiction.certain),
                linear.value - contradiction.certain
            ),
        )
        .expected("a value that the other conditions and the demonstrations leave open")
        .help(format!(
            "the model varies in at most {} directions, this quantity by a standard deviation of {:.3e} before: drop a condition, condition the model as it was before that was fixed, or learn with another estimator or from more demonstrations",
            self.gaussian.rank(),
            contradiction.prior_deviation
        ))
        .at(format!("condition {observation}"))
    }

    /// How far the values lie from what the primitive expects of them, in standard deviations (Mahalanobis distance of the observed
    /// quantities together). Log moduli extrapolate exponentially: far beyond 3 for one value, or 3 sqrt(m) for m of
    /// them, what the rest of the wave becomes is no longer what the demonstrations showed.
    ///
    /// # Errors
    /// When a coordinate does not exist or a value is no value of its quantity.
    pub fn mahalanobis(&self, observations: &[Observation]) -> Result<f64> {
        Ok(self.gaussian.mahalanobis(&self.linear(observations)?))
    }

    /// ln of the density that the primitive gives these values together, those of logarithms with respect to ln: what a mixture weighs its components by. Angles count
    /// on the branch on which they are observed; a uniform one has density 1 / (2 pi).
    ///
    /// # Errors
    /// When a coordinate does not exist or a value is no value of its quantity.
    pub fn log_evidence(&self, observations: &[Observation]) -> Result<f64> {
        Ok(self.linear_evidence(&self.linear(observations)?))
    }

    /// The observations over the vector of the chart.
    fn linear(&self, observations: &[Observation]) -> Result<Vec<LinearObservation>> {
        observations
            .iter()
            .map(|o| {
                o.linear(&self.chart)
                    .map_err(|e| e.at(format!("condition {}", o.quantity)))
            })
            .collect()
    }

    /// The median of a coordinate: rad, or a plain number for a ratio.
    ///
    /// # Errors
    /// When the coordinate does not exist.
    pub fn median(&self, coordinate: &Coordinate) -> Result<f64> {
        let row = self.chart.row(coordinate)?;
        self.chart.value(coordinate, self.gaussian.mean_of(&row))
    }

    /// The median of what an observation observes, in its unit; of a sum as it stands in the vector.
    ///
    /// # Errors
    /// When a coordinate does not exist.
    pub fn median_of(&self, observation: &Observation) -> Result<f64> {
        match &observation.quantity {
            Quantity::One(coordinate) => self.median(coordinate),
            Quantity::Sum(terms) => terms
                .iter()
                .map(|(c, coordinate)| Ok(c * self.gaussian.mean_of(&self.chart.row(coordinate)?)))
                .sum(),
        }
    }

    /// Standard deviation of a coordinate as it stands in the vector: of the logarithm of a modulus or a ratio, of an angle \[rad\].
    ///
    /// # Errors
    /// When the coordinate does not exist.
    pub fn standard_deviation(&self, coordinate: &Coordinate) -> Result<f64> {
        Ok(self.gaussian.deviation_of(&self.chart.row(coordinate)?))
    }

    /// Correlation of two coordinates as they stand in the vector; 0 where one does not vary.
    ///
    /// # Errors
    /// When a coordinate does not exist.
    pub fn correlation(&self, one: &Coordinate, other: &Coordinate) -> Result<f64> {
        let (a, b) = (self.chart.row(one)?, self.chart.row(other)?);
        let scale = self.gaussian.deviation_of(&a) * self.gaussian.deviation_of(&b);
        if scale > 0.0 {
            Ok(self.gaussian.covariance_of(&a, &b) / scale)
        } else {
            Ok(0.0)
        }
    }

    /// exp(mu) of |w_{d,k}| \[rad\]: the median modulus.
    ///
    /// # Errors
    /// When the joint or harmonic does not exist.
    pub fn median_modulus(&self, joint: &str, harmonic: impl Into<Harmonic>) -> Result<f64> {
        self.median(&Coordinate::modulus(joint, harmonic))
    }

    /// The wave at the mean of the Gaussian: median moduli or swings, mean phases and offsets; of cycles the steady one, whose period is one cycle.
    pub fn mean_wave(&self) -> Wave {
        self.steady(&self.within_limits(self.gaussian.mean().clone()))
    }

    /// Keeps every draw a wave; it acts beyond [`FARTHEST`] standard deviations.
    fn within_limits(&self, mut x: DVector<f64>) -> DVector<f64> {
        for (i, x) in x.iter_mut().enumerate() {
            let limit = self.chart.limit(i);
            *x = x.clamp(-limit, limit);
        }
        x
    }

    fn steady(&self, x: &DVector<f64>) -> Wave {
        self.chart
            .wave(x)
            .expect("`new` admits only Gaussians whose every draw is a wave")
    }

    /// How many standard normal numbers make a wave.
    pub(crate) fn latent(&self) -> usize {
        let cycles = self.chart.cycles();
        self.gaussian.latent() + cycles.map_or(0, |cycles| cycles.latent(self.chart.harmonics()))
    }

    /// The wave of so many standard normal numbers.
    pub(crate) fn wave_at(&self, z: &mut [f64]) -> Wave {
        let (gaussian, normals) = z.split_at_mut(self.gaussian.latent());
        let x = self.within_limits(self.gaussian.at_latent(gaussian));
        let steady = self.steady(&x);
        let (Some(cycles), Some(tail)) = (self.chart.cycles(), self.chart.tail()) else {
            return steady;
        };
        let after = tail + self.chart.joints().len();
        cycles
            .enliven(&steady, [x[after + 1], x[after + 2]], normals)
            .expect("deviations and periods are kept within bounds")
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
        let mut z = vec![0.0; self.latent()];
        normal::fill(rng, &mut z);
        self.wave_at(&mut z)
    }
}

/// The generator of sample number `index` of seed `seed`: one stream a sample, so that sample k is the same wave
/// whether it is drawn first, last, or on another machine.
pub fn stream(seed: u64, index: u64) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(index);
    rng
}

//! [`Mixture`]: several kinds of wave at once, a primitive for each.

mod expectation;
mod file;
mod grouping;
mod starts;

use rand::distr::Distribution;
use rand::{Rng, RngExt};

pub use grouping::{Grouping, GroupingOptions, HeldOutKinds, Kinds};

use super::chart::ChartForm;
use super::example::Example;
use super::{Estimator, FourierMovementPrimitive, Observation};
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::{Joints, Wave};

/// No mixture has more components.
const MOST_COMPONENTS: usize = 100;

/// Weights may miss the sum of 1 by this much.
const ROUNDING: f64 = 1e-9;

/// One kind of wave.
#[derive(Debug, Clone, PartialEq)]
pub struct Component {
    /// What people call it.
    pub name: String,
    /// The probability that a drawn wave is of this kind.
    pub weight: f64,
    /// The waves of this kind.
    pub primitive: FourierMovementPrimitive,
}

/// A mixture of primitives of the same joints, period and harmonics: each drawn wave is of one kind.
///
/// Every component has its own chart: its own branches, about its own circular means, and its own reference joint. Their densities can be compared all
/// the same, for the maps between such charts keep volumes.
///
/// ```
/// use rand::distr::Distribution;
/// use undulate::*;
///
/// // Two demonstrators, told apart by what they do.
/// let waves = [synthetic(0)?.fit(25)?, synthetic(1)?.fit(25)?].concat();
/// let options = LearnOptions::default();
/// let examples = options.examples(&waves)?;
/// let form = options.form(&examples)?;
/// let labels: Vec<&str> = (0..30).map(|m| if m < 15 { "ann" } else { "bob" }).collect();
/// let mixture = Mixture::learn(&examples, &form, options.estimator, &Grouping::labelled(&labels)?)?;
/// let large = mixture.condition(&[Observation::modulus("elbow_flexion", 10, 5f64.to_radians())])?;
/// assert!(large.sample(&mut stream(7, 0)).offsets()[0] > 0.0);
/// assert_eq!(mixture.component("bob")?.weight, 0.5);
/// # Ok::<(), undulate::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Mixture {
    components: Vec<Component>,
}

impl Mixture {
    /// A mixture of given components.
    ///
    /// # Errors
    /// When there is none, or more than a hundred, names are empty or the same, weights are no probabilities that sum to 1, or the primitives differ in joints,
    /// period, harmonics or in how offsets enter.
    pub fn new(components: Vec<Component>) -> Result<Self> {
        if !(1..=MOST_COMPONENTS).contains(&components.len()) {
            return Err(
                Error::new(ErrorKind::Shape, format!("{} components", components.len()))
                    .expected(format!("from 1 to {MOST_COMPONENTS}")),
            );
        }
        for (i, component) in components.iter().enumerate() {
            let at = |e: Error| e.at(format!("component `{}`", component.name));
            if component.name.is_empty() || component.name.chars().any(char::is_control) {
                return Err(at(
                    Error::new(ErrorKind::Name, "no name").expected("a name in one line")
                ));
            }
            if components[..i].iter().any(|c| c.name == component.name) {
                return Err(at(Error::new(
                    ErrorKind::Name,
                    "two components of one name",
                )
                .expected("a name for each")));
            }
            if !(0.0..=1.0).contains(&component.weight) {
                return Err(at(Error::new(
                    ErrorKind::Value,
                    format!("a weight of {}", component.weight),
                )
                .expected("from 0 to 1")));
            }
            alike(&components[0].primitive, &component.primitive).map_err(at)?;
        }
        let sum: f64 = components.iter().map(|c| c.weight).sum();
        if (sum - 1.0).abs() > ROUNDING {
            return Err(
                Error::new(ErrorKind::Value, format!("weights that sum to {sum}"))
                    .expected("probabilities, that sum to 1"),
            );
        }
        Ok(Self { components })
    }

    /// A primitive for each kind of a grouping, learned from all demonstrations by their responsibilities; its weight is their mean. A form of the chart is
    /// common to all kinds.
    ///
    /// # Errors
    /// When the grouping is of another number of demonstrations, or a kind makes no primitive: of fewer than two demonstrations, for instance.
    pub fn learn(
        examples: &[Example],
        form: &ChartForm,
        estimator: Estimator,
        grouping: &Grouping,
    ) -> Result<Self> {
        if grouping.responsibilities().nrows() != examples.len() {
            return Err(Error::new(
                ErrorKind::Shape,
                format!(
                    "a grouping of {} demonstrations",
                    grouping.responsibilities().nrows()
                ),
            )
            .expected(format!("{}", examples.len())));
        }
        let kinds = grouping
            .names()
            .iter()
            .zip(grouping.responsibilities().column_iter());
        let components = kinds
            .map(|(name, shares)| {
                let shares: Vec<f64> = shares.iter().copied().collect();
                let primitive =
                    FourierMovementPrimitive::from_shares(examples, &shares, form, estimator)
                        .map_err(|e| e.at(format!("kind `{name}`")))?;
                Ok(Component {
                    name: name.clone(),
                    weight: shares.iter().sum::<f64>() / examples.len() as f64,
                    primitive,
                })
            })
            .collect::<Result<_>>()?;
        Self::new(components)
    }

    /// The components, at least one.
    pub fn components(&self) -> &[Component] {
        &self.components
    }

    /// The component of a name.
    ///
    /// # Errors
    /// When there is none; the message names those that there are.
    pub fn component(&self, name: &str) -> Result<&Component> {
        self.components
            .iter()
            .find(|c| c.name == name)
            .ok_or_else(|| {
                let names: Vec<&str> = self.components.iter().map(|c| c.name.as_str()).collect();
                Error::new(ErrorKind::Name, format!("no component `{name}`"))
                    .expected(names.join(", "))
            })
    }

    /// The same with another name for one.
    ///
    /// # Errors
    /// When there is no such component, or another has the new name.
    pub fn renamed(&self, from: &str, to: &str) -> Result<Self> {
        self.component(from)?;
        let mut components = self.components.clone();
        for component in components.iter_mut().filter(|c| c.name == from) {
            to.clone_into(&mut component.name);
        }
        Self::new(components)
    }

    /// The joints' names.
    pub fn joints(&self) -> &Joints {
        self.components[0].primitive.chart().joints()
    }

    /// The mixture given values of some coordinates: every component is conditioned, and its weight multiplied by the density that it gave these
    /// values ([`FourierMovementPrimitive::log_evidence`]). A component that rules them out is dropped.
    ///
    /// # Errors
    /// Those of [`FourierMovementPrimitive::condition`], where they hold for all components.
    pub fn condition(&self, observations: &[Observation]) -> Result<Self> {
        let mut kept = Vec::new();
        let mut refused = None;
        for component in &self.components {
            match component.primitive.condition(observations) {
                Ok(primitive) => {
                    let evidence = component.primitive.log_evidence(observations)?;
                    kept.push((component, evidence, primitive));
                }
                Err(error) if error.kind() == ErrorKind::Infeasible => refused = Some(error),
                Err(error) => return Err(error),
            }
        }
        if let (Some(error), true) = (refused, kept.is_empty()) {
            return Err(error);
        }
        let logarithms: Vec<f64> = kept
            .iter()
            .map(|(c, e, _)| libm::log(c.weight) + e)
            .collect();
        let (_, weights) = normalized(&logarithms).ok_or_else(|| {
            Error::new(
                ErrorKind::Infeasible,
                "no component gives these values any probability",
            )
            .expected("values nearer to the demonstrations")
        })?;
        let components =
            kept.into_iter()
                .zip(weights)
                .map(|((component, _, primitive), weight)| Component {
                    name: component.name.clone(),
                    weight,
                    primitive,
                });
        Self::new(components.collect())
    }

    /// ln of the density of a demonstration \[nats\]; see [`FourierMovementPrimitive::log_density`].
    ///
    /// # Errors
    /// When the demonstration is none of this shape.
    pub fn log_density(&self, example: &Example) -> Result<f64> {
        Ok(normalized(&self.logarithms(example)?).map_or(f64::NEG_INFINITY, |(sum, _)| sum))
    }

    /// The probability that a demonstration is of each kind (their sum is 1).
    ///
    /// # Errors
    /// When the demonstration is none of this shape, or none that the mixture could draw.
    pub fn responsibilities(&self, example: &Example) -> Result<Vec<f64>> {
        let normalized = normalized(&self.logarithms(example)?);
        normalized
            .map(|(_, responsibilities)| responsibilities)
            .ok_or_else(|| {
                Error::new(
                    ErrorKind::Infeasible,
                    "a demonstration for which what is given does not hold",
                )
                .expected("one that the mixture could draw")
            })
    }

    fn logarithms(&self, example: &Example) -> Result<Vec<f64>> {
        self.components
            .iter()
            .map(|c| Ok(libm::log(c.weight) + c.primitive.log_density(example)?))
            .collect()
    }
}

/// ln of the sum of exponentials, and the share of each; `None` where all are 0.
fn normalized(logarithms: &[f64]) -> Option<(f64, Vec<f64>)> {
    let largest = logarithms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if largest == f64::NEG_INFINITY {
        return None;
    }
    let shares: Vec<f64> = logarithms.iter().map(|l| libm::exp(l - largest)).collect();
    let sum: f64 = shares.iter().sum();
    let shares = shares.iter().map(|s| s / sum).collect();
    Some((largest + libm::log(sum), shares))
}

/// Whether the waves of two primitives have one shape, and their densities one measure.
fn alike(one: &FourierMovementPrimitive, other: &FourierMovementPrimitive) -> Result<()> {
    let told = |p: &FourierMovementPrimitive| {
        let chart = p.chart();
        let period = chart.period();
        format!(
            "{}, {} harmonics of {}, offsets {}",
            chart.joints().listed(),
            chart.harmonics(),
            period.map_or("a cycle".to_owned(), |t| format!("{t} s")),
            chart
                .offset_forms()
                .iter()
                .map(ToString::to_string)
                .collect::<Vec<_>>()
                .join(", ")
        )
    };
    let (a, b) = (one.chart(), other.chart());
    let same = (a.joints(), a.period(), a.harmonics(), a.offset_forms())
        == (b.joints(), b.period(), b.harmonics(), b.offset_forms());
    if same {
        return Ok(());
    }
    Err(Error::new(ErrorKind::Shape, format!("waves of {}", told(other))).expected(told(one)))
}

/// Draws a kind by its weight, then a wave from its primitive with the numbers that follow: the same generator state gives the same wave on every machine. A
/// mixture of one draws what its primitive draws.
impl Distribution<Wave> for Mixture {
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> Wave {
        let mut left = if self.components.len() > 1 {
            rng.random::<f64>()
        } else {
            0.0
        };
        for component in &self.components {
            if left < component.weight {
                return component.primitive.sample(rng);
            }
            left -= component.weight;
        }
        // What rounding left of the sum of weights belongs to the likeliest.
        let likeliest = self
            .components
            .iter()
            .fold(&self.components[0], |best, next| {
                if next.weight > best.weight {
                    next
                } else {
                    best
                }
            });
        likeliest.primitive.sample(rng)
    }
}

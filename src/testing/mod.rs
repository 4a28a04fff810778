//! Property tests of gestures and robots (feature `testing`): strategies for proptest, and statistical assertions with a stated
//! probability of a false alarm and a known power.
//!
//! ```
//! use std::sync::LazyLock;
//!
//! use undulate::rand::distr::Distribution;
//! use undulate::testing::proptest::prelude::*;
//! use undulate::testing::{Family, gaussian, observations, refute_above, seeds, waves_of};
//! use undulate::{Derivative, FourierMovementPrimitive, Observation, synthetic};
//!
//! /// One false alarm in a million runs of the two statistical tests, however many cases PROPTEST_CASES asks for.
//! const FAMILY: Family = Family::new(1e-6, 2);
//!
//! static GREETING: LazyLock<FourierMovementPrimitive> =
//!     LazyLock::new(|| FourierMovementPrimitive::learn(&synthetic(0).unwrap(), 12).unwrap());
//!
//! fn gentle() -> FourierMovementPrimitive {
//!     GREETING.condition(&[Observation::modulus("elbow_flexion", 10, 0.05)]).unwrap()
//! }
//!
//! proptest! {
//! # #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(4) })]
//! #   /*
//!     #[test]
//! #   */
//!     fn gentle_waves_are_gentle(wave in waves_of(&gentle())) {
//!         let elbow = wave.joints().index("elbow_flexion")?;
//!         prop_assert!(wave.weights()[(elbow, 9)].norm() < 0.0501);
//!     }
//!
//! #   /*
//!     #[test]
//! #   */
//!     fn draws_are_as_they_are_conditioned(asked in observations(&GREETING, 0..=2), seed in seeds()) {
//!         let conditioned = GREETING.condition(&asked)?;
//!         let draws: Vec<_> = (0..500).map(|k| conditioned.gaussian().sample(&mut seed.stream(k))).collect();
//!         gaussian(&draws, conditioned.gaussian(), FAMILY.case()).map_err(|alarm| alarm.of(seed))?;
//!     }
//!
//! #   /*
//!     #[test]
//! #   */
//!     fn few_waves_are_hasty(seed in seeds()) {
//!         let is_hasty = |k: &u64| {
//!             let wave = GREETING.sample(&mut seed.stream(*k));
//!             (0..wave.joints().len()).any(|d| wave.range(d, Derivative::Velocity).upper > 17.0)
//!         };
//!         let failures = (0..50).filter(is_hasty).count() as u64;
//!         refute_above(failures, 50, 0.05, FAMILY.case()).map_err(|alarm| alarm.of(seed))?;
//!     }
//! }
//! # gentle_waves_are_gentle();
//! # draws_are_as_they_are_conditioned();
//! # few_waves_are_hasty();
//! ```
//!
//! # Strategies
//!
//! Each says what it draws and to what it shrinks: fewer joints first, then simpler ones. Numbers from a range go to the least of it or stay
//! about where they were drawn; the boundary between what fails and what passes is sought for [`waves_of`] alone, along the way to the mean.
//!
//! # Statistical assertions
//!
//! | asked | test | of true samples |
//! |---|---|---|
//! | [`mean`] | Hotelling's T^2 | exact for normal vectors |
//! | [`bounded_mean`] | Hoeffding | a bound, for any numbers within a support |
//! | [`covariance`] | chi-square in every axis and diagonal | exact for normal vectors, Bonferroni over directions |
//! | [`gaussian`] | mean, variance, shape, normality, succession, span | exact, or a few percent below, each of five fifths |
//! | [`distribution`] | Kolmogorov and Smirnov, Massart's bound | a few percent below |
//! | [`quantile`] | binomial | exact but for its steps |
//! | [`circular_mean`], [`circular_spread`] | Hoeffding, of sine and cosine | a bound, for any angles |
//! | [`independence`] | Kendall's tau, sub-Gaussian | a bound, for any pairs |
//! | [`energy`] | two samples, by permutation | exact but for its steps |
//!
//! Each takes the probability of a false alarm and returns an [`Alarm`], which is an error: `?` in a property fails it. Its text has the
//! statistic, its bounds, N, the seed if it was told ([`Alarm::of`]), and the smallest discrepancy that N samples are enough to catch with
//! 99 % power. `tests/calibration` measures both: alarms on true samples, and on samples that are off by just that.
//! A [`Family`] keeps one budget for many tests and all their cases, [`retest`] keeps it with fewer samples. A statistical case
//! draws from its [`Seed`] and nothing else, so that shrinking meets the same failure again.
//!
//! # Two claims about a probability
//!
//! | | passes | fails | for |
//! |---|---|---|---|
//! | [`demonstrate_below`] | only on evidence that it is at most p | also when there is too little evidence | a promise: "falls at most once in a hundred" |
//! | [`refute_above`] | also when there is too little evidence | only on evidence that it is above p | a guard of what is known to hold, which must not cry wolf |
//!
//! Between them lies what the trials leave open: there the first fails and the second passes.
//!
//! # Properties of a robot's motions
//!
//! | asked | by |
//! |---|---|
//! | `keeps_limits` (feature `robot`) | rigorous bounds over the whole motion; efforts as estimated |
//! | `keeps_clear` (feature `robot`) | proof, between samples too |
//! | `tracks_within` (feature `simulation`) | execution |
//! | [`fails_at_most`], and of a primitive's waves [`fails_rarely`] | [`demonstrate_below`], of independent draws |
//!
//! Each returns an error that says which joint or pair, when, by how much and what was allowed.
//!
//! # Panics
//!
//! Wrong arguments (a probability outside 0..1, no samples or too few to mean anything, a strategy that can produce nothing) panic
//! and name the argument: they are mistakes in a test, not input.

/// The version whose strategies these are.
pub use proptest;

mod alarm;
mod argument;
mod circular;
mod covariance;
mod distribution;
mod energy;
mod failures;
mod family;
mod gaussian;
mod independence;
mod law;
mod mean;
mod probability;
mod quantile;
#[cfg(feature = "robot")]
mod robot;
mod seed;
mod sequential;
mod strategy;

pub use alarm::{Alarm, Power};
pub use circular::{circular_mean, circular_spread};
pub use covariance::covariance;
pub use distribution::distribution;
pub use energy::energy;
pub use failures::{Failures, fails_at_most, fails_rarely};
pub use family::Family;
pub use gaussian::gaussian;
pub use independence::independence;
pub use mean::{bounded_mean, mean};
pub use probability::{demonstrate_below, refute_above};
pub use quantile::quantile;
#[cfg(feature = "simulation")]
pub use robot::tracks_within;
#[cfg(feature = "robot")]
pub use robot::{keeps_clear, keeps_limits};
pub use seed::{Seed, seeds};
pub use sequential::retest;
pub use strategy::*;

//! Promises about how rarely something fails.

use std::fmt;

use rand::distr::Distribution;
use rand::rngs::ChaCha8Rng;

use super::alarm::Alarm;
use super::probability::demonstrate_below;
use super::seed::Seed;
use crate::error::Error;
use crate::fourier::Wave;
use crate::primitive::FourierMovementPrimitive;

/// Is it demonstrated at `confidence` that `has_failed` is true with probability `p` at most? Asked in so many independent `trials`, trial k with the
/// generator [`Seed::stream`] (k), and judged by [`demonstrate_below`].
///
/// ```
/// use undulate::rand::RngExt;
/// use undulate::testing::{Seed, fails_at_most};
///
/// fails_at_most(0.03, 0.99, 1000, Seed(1), |rng| rng.random::<f64>() < 0.01)?;
/// // One in a hundred is what it is, and nothing that could be demonstrated.
/// let alarm = fails_at_most(0.01, 0.99, 1000, Seed(1), |rng| rng.random::<f64>() < 0.01).unwrap_err();
/// assert_eq!(alarm.seed, Some(Seed(1)));
/// # Ok::<(), undulate::testing::Alarm>(())
/// ```
///
/// # Errors
/// When it is not demonstrated.
///
/// # Panics
/// When `p` or `confidence` is not within 0..1, or so few `trials` that even none failing would demonstrate nothing.
#[track_caller]
pub fn fails_at_most(
    p: f64,
    confidence: f64,
    trials: u64,
    seed: Seed,
    mut has_failed: impl FnMut(&mut ChaCha8Rng) -> bool,
) -> Result<(), Alarm> {
    // Of no failures first: trials that are too few are told of before they are made.
    demonstrate_below(0, trials, p, confidence)?;
    let failures = (0..trials).filter(|k| has_failed(&mut seed.stream(*k)));
    let failures = failures.count() as u64;
    demonstrate_below(failures, trials, p, confidence).map_err(|alarm| alarm.of(seed))
}

/// Do a primitive's waves fail a property with probability `p` at most, demonstrated at `confidence` by so many draws? Draw k is
/// `primitive.sample(&mut seed.stream(k))`.
///
/// ```
/// use undulate::testing::{Seed, fails_rarely, keeps_limits};
/// use undulate::{FourierMovementPrimitive, shipped, synthetic};
///
/// let greeting = FourierMovementPrimitive::learn(&synthetic(0)?, 12)?;
/// let robot = shipped::robot("wave_arm")?;
/// let map = shipped::map("wave_arm_demonstrator")?;
/// fails_rarely(&greeting, 0.2, 0.99, 100, Seed(7), |wave| keeps_limits(&robot, &map.apply(wave, &robot)?))?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When it is not demonstrated; with the first draw that failed, and why.
///
/// # Panics
/// Those of [`fails_at_most`].
#[track_caller]
pub fn fails_rarely(
    primitive: &FourierMovementPrimitive,
    p: f64,
    confidence: f64,
    trials: u64,
    seed: Seed,
    mut property: impl FnMut(&Wave) -> Result<(), Error>,
) -> Result<(), Failures> {
    let (mut first, mut draw, mut failures) = (None, 0, 0);
    let outcome = fails_at_most(p, confidence, trials, seed, |rng| {
        let why = property(&primitive.sample(rng)).err();
        let has_failed = why.is_some();
        first = first.take().or(why.map(|why| (draw, why)));
        draw += 1;
        failures += u64::from(has_failed);
        has_failed
    });
    outcome.map_err(|alarm| Failures {
        alarm,
        failures,
        first,
    })
}

/// Why a primitive's waves are not believed to fail so rarely.
#[derive(Clone, PartialEq)]
pub struct Failures {
    /// What is not demonstrated.
    pub alarm: Alarm,
    /// How many draws failed.
    pub failures: u64,
    /// The number of the first draw that failed, and why it did; `None` when none did.
    pub first: Option<(u64, Error)>,
}

impl fmt::Display for Failures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&self.alarm, f)?;
        match &self.first {
            Some((draw, why)) => write!(
                f,
                "; {} draws fail, draw {draw} first: {why}",
                self.failures
            ),
            None => Ok(()),
        }
    }
}

impl fmt::Debug for Failures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl std::error::Error for Failures {}

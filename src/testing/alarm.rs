//! [`Alarm`]: what an assertion says when it fails.

use std::fmt;

use super::Seed;

/// Why samples are not believed to be what they should be. Its text says all of it, also where `unwrap` prints it.
///
/// ```
/// use undulate::testing::{Seed, refute_above};
///
/// let alarm = refute_above(30, 300, 0.01, 1e-6).unwrap_err().of(Seed(7));
/// assert_eq!(
///     alarm.to_string(),
///     "lower bound of a probability: 0.036844 is outside 0 .. 0.010000 with N = 300, seed 7; \
///      with 99 % power: a probability of 0.083205"
/// );
/// ```
#[derive(Clone, PartialEq)]
pub struct Alarm {
    /// What is off, such as `mean` or `variance`.
    pub what: &'static str,
    /// The statistic that was out of bounds.
    pub statistic: f64,
    /// The bounds.
    pub bounds: (f64, f64),
    /// Number of samples.
    pub samples: usize,
    /// The seed of the samples, if it was told ([`of`](Self::of)).
    pub seed: Option<Seed>,
    /// What the test could see at this number of samples.
    pub power: Power,
}

/// The smallest discrepancy that a test catches with 99 % power.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Power {
    /// Of what: words that go before the number.
    pub of: &'static str,
    /// How much.
    pub smallest: f64,
}

impl Power {
    /// Nothing has to be estimated, so every violation is seen.
    pub(super) const CERTAIN: Self = Self {
        of: "whatever is out of bounds",
        smallest: 0.0,
    };
}

impl Alarm {
    /// The same, of samples of this seed.
    #[must_use]
    pub fn of(self, seed: Seed) -> Self {
        Self {
            seed: Some(seed),
            ..self
        }
    }

    /// If a statistic is out of its bounds; one that is no number is.
    pub(super) fn unless_within(
        what: &'static str,
        statistic: f64,
        bounds: (f64, f64),
        samples: usize,
        power: impl FnOnce() -> Power,
    ) -> Result<(), Self> {
        if (bounds.0..=bounds.1).contains(&statistic) {
            return Ok(());
        }
        Err(Self {
            what,
            statistic,
            bounds,
            samples,
            seed: None,
            power: power(),
        })
    }

    /// If one of the values of so many samples is no finite number: it would be lost in sums and comparisons.
    pub(super) fn unless_finite<'a>(
        values: impl IntoIterator<Item = &'a f64>,
        samples: usize,
    ) -> Result<(), Self> {
        let worst = values.into_iter().find(|x| !x.is_finite());
        let within = (f64::MIN, f64::MAX);
        let statistic = worst.copied().unwrap_or(0.0);
        Self::unless_within("a sample", statistic, within, samples, || Power::CERTAIN)
    }
}

impl fmt::Display for Alarm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [low, high] = [self.bounds.0, self.bounds.1].map(number);
        write!(
            f,
            "{}: {} is outside {low} .. {high} with N = {}",
            self.what,
            number(self.statistic),
            self.samples
        )?;
        if let Some(Seed(seed)) = self.seed {
            write!(f, ", seed {seed}")?;
        }
        let Power { of, smallest } = self.power;
        write!(f, "; with 99 % power: {of}")?;
        if self.power == Power::CERTAIN {
            return Ok(());
        }
        write!(f, " {}", number(smallest))
    }
}

impl fmt::Debug for Alarm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// Six digits behind the point where they are enough to tell it, and not three hundred before it.
fn number(x: f64) -> String {
    match x.abs() {
        0.0 => "0".to_owned(),
        1e-3..1e9 => format!("{x:.6}"),
        _ => format!("{x:.5e}"),
    }
}

impl std::error::Error for Alarm {}

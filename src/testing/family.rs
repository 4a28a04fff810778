//! [`Family`]: one budget of false alarms for many tests.

use proptest::test_runner::Config;

/// Tests that together raise a false alarm with at most a budgeted probability: each gets an equal share of it, and each case of a proptest
/// run an equal share of its test's (Bonferroni, so it holds however the tests depend on each other).
///
/// The number of cases is that of proptest's default configuration, so the shares follow `PROPTEST_CASES`: ten times as many cases are ten
/// times as strict each, and the whole run stays within its budget. What proptest tries while it shrinks comes after an alarm, and
/// changes its probability no more.
///
/// ```
/// use undulate::testing::{Family, Seed, bounded_mean};
/// use undulate::rand::RngExt;
///
/// const FAMILY: Family = Family::new(1e-6, 3);
///
/// let mut rng = Seed(1).rng();
/// let samples: Vec<f64> = (0..1000).map(|_| rng.random()).collect();
/// bounded_mean(&samples, (0.0, 1.0), 0.5, FAMILY.test())?;
/// // In each case of a property:
/// bounded_mean(&samples, (0.0, 1.0), 0.5, FAMILY.case())?;
/// # Ok::<(), undulate::testing::Alarm>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Family {
    budget: f64,
    tests: u32,
}

impl Family {
    /// A budget for so many tests.
    ///
    /// # Panics
    /// When `budget` is not within 0..1 or `tests` is 0; of a constant, at compile time.
    #[track_caller]
    pub const fn new(budget: f64, tests: u32) -> Self {
        assert!(
            budget > 0.0 && budget < 1.0,
            "budget: a probability between 0 and 1, without the ends"
        );
        assert!(tests > 0, "tests: at least one");
        Self { budget, tests }
    }

    /// The share of a test that runs once.
    pub const fn test(&self) -> f64 {
        self.budget / self.tests as f64
    }

    /// The share of a case of a property test that runs as often as proptest does by default.
    pub fn case(&self) -> f64 {
        self.case_of(&Config::default())
    }

    /// The share of a case of a property test that is configured otherwise.
    pub fn case_of(&self, config: &Config) -> f64 {
        self.test() / f64::from(config.cases.max(1))
    }
}

//! The sequential retest of Gandy and Scott.

use super::alarm::Alarm;
use super::argument::require_probability;

/// Each round draws so many times as many samples as the one before it.
const GROWTH: usize = 2;

/// A check that looks again, with more samples, where a first look leaves doubt (Gandy and Scott, "Unit testing for MCMC and other Monte
/// Carlo methods", 2021). With k rounds, beta = `false_alarm` / k and gamma = beta^(1/k), round i checks new samples, of which
/// `draw` is told how many:
///
/// * an alarm at level beta_i = beta / gamma^(i-1) is the outcome;
/// * no alarm at level gamma + beta_i, and all is well;
/// * anything between, and round i + 1 draws twice as many.
///
/// Most true samplers are done after one small round, and a broken one that the first round misses is met by larger ones: the same power
/// takes fewer samples on average than a single check. `check` gets samples and a level, and must raise its alarm at every level above
/// one at which it does; all assertions of this module do.
///
/// The probability of a false alarm is at most `false_alarm`: let B_i = (k - i + 1) beta_i bound it from round i on, which is right for
/// i = k, where the last level is beta_k = gamma. In round i let r be the probability of an alarm and c that of going on. The levels of
/// `check` say r <= beta_i and r + c <= gamma + beta_i, so r + c B_(i+1) is largest for r = beta_i and c = gamma as long as
/// B_(i+1) <= 1, and then it is beta_i + gamma (k - i) beta_i / gamma = B_i. B_1 is `false_alarm`. B_(i+1) is j gamma^j with j = k - i,
/// below 1 for gamma <= 1/2, which is asked for. The samples of a true sampler are then less than n / (1 - 2 gamma) on average, where
/// levels are exact.
///
/// ```
/// use undulate::rand::RngExt;
/// use undulate::testing::{Seed, distribution, retest};
///
/// let mut rng = Seed(3).rng();
/// retest(
///     1e-6,
///     5,
///     100,
///     |n| -> Vec<f64> { (0..n).map(|_| rng.random()).collect() },
///     |samples, level| distribution(samples, |x| x.clamp(0.0, 1.0), level),
/// )?;
/// # Ok::<(), undulate::testing::Alarm>(())
/// ```
///
/// # Errors
/// The alarm of the round that was sure.
///
/// # Panics
/// When `false_alarm` is not within 0..1, `rounds` is 0 or more than leaves gamma at most 1/2, or the check panics at so few
/// `samples`.
#[track_caller]
pub fn retest<S>(
    false_alarm: f64,
    rounds: u32,
    samples: usize,
    mut draw: impl FnMut(usize) -> S,
    check: impl Fn(&S, f64) -> Result<(), Alarm>,
) -> Result<(), Alarm> {
    require_probability("false_alarm", false_alarm);
    assert!(rounds > 0, "rounds: at least one");
    assert!(samples > 0, "samples: at least one");
    let mut level = false_alarm / f64::from(rounds);
    let doubt = level.powf(1.0 / f64::from(rounds));
    assert!(
        rounds == 1 || doubt <= 0.5,
        "rounds = {rounds}: too many for a false alarm of {false_alarm}, every second check would be in doubt"
    );
    let mut count = samples;
    for round in 1..=rounds {
        let drawn = draw(count);
        check(&drawn, level)?;
        if round == rounds || check(&drawn, doubt + level).is_ok() {
            break;
        }
        level /= doubt;
        count = count.saturating_mul(GROWTH);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use super::super::alarm::Power;
    use super::*;

    /// One that is in doubt in every round: what it draws, and the levels at which it is checked.
    #[test]
    fn doubt_takes_twice_as_many_samples_at_a_level_that_is_raised() {
        let levels = RefCell::new(Vec::new());
        let mut counts = Vec::new();
        // beta = 1e-6, gamma = 1e-2.
        let outcome = retest(
            3e-6,
            3,
            100,
            |n| counts.push(n),
            |(), level| {
                levels.borrow_mut().push(level);
                let is_doubt = level > 1e-2;
                Alarm::unless_within("doubt", 1.0, (0.0, 0.0), 1, || Power::CERTAIN)
                    .or_else(|alarm| if is_doubt { Err(alarm) } else { Ok(()) })
            },
        );
        assert!(outcome.is_ok());
        assert_eq!(counts, [100, 200, 400]);
        let expected = [1e-6, 1e-2 + 1e-6, 1e-4, 1e-2 + 1e-4, 1e-2];
        for (found, expected) in levels.borrow().iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-9, "{levels:?}");
        }
        assert_eq!(levels.borrow().len(), expected.len());
    }
}

//! Levels of variation, each from little: what is error of an estimate, and what is variety.
//!
//! The model learns a Gaussian over ln s, s the level of one demonstration. A mean square of few independent values is
//! skewed, so its logarithm is too small on average and scatters. Both follow from the number n of independent values that
//! would scatter as it does (Satterthwaite 1946): n = (tr K)^2 / tr K^2, K the covariance of the values. The bias,
//! (psi(n/2) - ln(n/2)) / 2, is taken away. The variance psi'(n/2) / 4 is no variety of demonstrations: see [`pooled`].

/// A smaller level than this, 0.1 %, is no person's, and a recording would not show it.
pub(super) const LEAST_LEVEL: f64 = 1e-3;

/// One recording's ln level.
#[derive(Debug, Clone, Copy)]
pub(super) struct LogLevel {
    value: f64,
    /// Variance of its error.
    scatter: f64,
}

impl LogLevel {
    /// Of a root mean square over `independent` values.
    pub(super) fn of_mean_square(level: f64, independent: f64) -> Self {
        let half = independent / 2.0;
        Self {
            value: level.ln() - (digamma(half) - half.ln()) / 2.0,
            scatter: trigamma(half) / 4.0,
        }
    }
}

/// The levels of all, of which each is what its own recording and the others tell.
///
/// What is seen of ln s scatters by more than the ln s themselves, by the error of each estimate. Between them lies the
/// variance tau^2 (DerSimonian and Laird 1986); each ln s is drawn to the common mean by sqrt(tau^2 / (tau^2 + error^2)), so
/// that their spread is tau (Louis 1984). Drawn to the mean less, a model of them would take errors for variety; more, as
/// the best guess for each alone would be, and it would lack variety.
pub(super) fn pooled(logs: &[LogLevel]) -> Vec<f64> {
    let mean = |between: f64| {
        let weights = logs.iter().map(|l| 1.0 / (between + l.scatter));
        let sum: f64 = logs.iter().map(|l| l.value / (between + l.scatter)).sum();
        sum / weights.sum::<f64>()
    };
    let centre = mean(0.0);
    let weights: Vec<f64> = logs.iter().map(|l| 1.0 / l.scatter).collect();
    let (sum, squares) = weights
        .iter()
        .fold((0.0, 0.0), |(sum, squares), w| (sum + w, squares + w * w));
    let excess: f64 = logs
        .iter()
        .map(|l| (l.value - centre).powi(2) / l.scatter)
        .sum::<f64>()
        - (logs.len() - 1) as f64;
    let room = sum - squares / sum;
    let between = if room > 0.0 {
        (excess / room).max(0.0)
    } else {
        0.0
    };
    let centre = mean(between);
    logs.iter()
        .map(|l| {
            let keep = (between / (between + l.scatter)).sqrt();
            (centre + keep * (l.value - centre)).exp().max(LEAST_LEVEL)
        })
        .collect()
}

/// psi(x), x > 0: the recursion up to 10, then the asymptotic series.
fn digamma(mut x: f64) -> f64 {
    let mut sum = 0.0;
    while x < 10.0 {
        sum -= 1.0 / x;
        x += 1.0;
    }
    let r = 1.0 / (x * x);
    sum + x.ln() - 0.5 / x - r * (1.0 / 12.0 - r * (1.0 / 120.0 - r / 252.0))
}

/// psi'(x), x > 0.
fn trigamma(mut x: f64) -> f64 {
    let mut sum = 0.0;
    while x < 10.0 {
        sum += 1.0 / (x * x);
        x += 1.0;
    }
    let r = 1.0 / (x * x);
    sum + 1.0 / x + r / 2.0 + r / x * (1.0 / 6.0 - r * (1.0 / 30.0 - r / 42.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digamma_and_trigamma_have_their_known_values() {
        let euler = 0.577_215_664_901_532_9;
        assert!((digamma(1.0) + euler).abs() < 1e-9);
        assert!((digamma(0.5) + euler + 4f64.ln()).abs() < 1e-9);
        let square = std::f64::consts::PI.powi(2);
        assert!((trigamma(1.0) - square / 6.0).abs() < 1e-9);
        assert!((trigamma(0.5) - square / 2.0).abs() < 1e-9);
    }

    /// 4000 levels of the same demonstrator, each a mean square of four normal numbers that are, as quantiles, exact.
    #[test]
    fn what_is_all_error_comes_out_alike_and_unbiased() {
        // Chi square with 2 degrees of freedom is exponential: its quantiles have a closed form.
        let logs: Vec<LogLevel> = (0..4000)
            .map(|i| {
                let quantile = -2.0 * (1.0 - (f64::from(i) + 0.5) / 4000.0).ln();
                LogLevel::of_mean_square(0.1 * (quantile / 2.0).sqrt(), 2.0)
            })
            .collect();
        let levels = pooled(&logs);
        assert!(
            levels.iter().all(|s| (s / 0.1 - 1.0).abs() < 0.03),
            "{:?}",
            &levels[..3]
        );
    }

    #[test]
    fn variety_keeps_its_spread_and_one_alone_its_level() {
        // ln levels of spread 0.5 with an error of variance 0.25: seen with spread sqrt(0.5).
        let seen = [-1.0, -0.5, 0.0, 0.5, 1.0];
        let logs = seen.map(|x| LogLevel {
            value: -2.0 + x,
            scatter: 0.25,
        });
        let levels: Vec<f64> = pooled(&logs).iter().map(|s| s.ln() + 2.0).collect();
        let variance: f64 = levels.iter().map(|x| x * x).sum::<f64>() / 4.0;
        assert!((variance - (0.625 - 0.25)).abs() < 1e-12, "{levels:?}");
        assert!((pooled(&logs[..1])[0].ln() + 3.0).abs() < 1e-12);
    }
}

//! Levels and memory of cycle-to-cycle variation, estimated from short series seen through a window.
//!
//! What demodulation shows of a modulation x(u), u in cycles, is a linear image of it: smoothed by the window, sampled
//! where windows fit, its mean taken out, all of which makes it smaller and slower. For a stationary modulation of
//! standard deviation s, spectral density S over frequencies up to 1/2 a cycle, and responses R_i(nu) of the values i to
//! exp(2 pi i nu u),
//!
//! ```text
//! E mean_i (x_i - mean x)^2                       = s^2 int S(nu) G_0(nu) d nu
//! E mean_i (x_i - mean x)(x_{i+1 cycle} - mean x) = s^2 int S(nu) G_1(nu) d nu
//! G_k(nu) = mean over i of Re (R_i - mean R) conj(R_{i + k cycles} - mean R)
//! ```
//!
//! exactly, whatever the number of cycles, the stamps and the gaps. So the level is what makes the left side, measured,
//! equal the right, and a wave with that level measures on average as the demonstration does.
//!
//! The model learns a Gaussian over ln s. A mean square of few independent values is skewed, so its logarithm is too
//! small on average and scatters; both follow from the number n of independent values that would scatter alike
//! (Satterthwaite 1946): n = (tr K)^2 / tr K^2, K the covariance of the values. The bias, (psi(n/2) - ln(n/2)) / 2, is
//! taken away. The scatter, psi'(n/2) / 4, is no variation between demonstrations: see [`levels`].

use nalgebra::DMatrix;
use num_complex::Complex;

use super::demodulation::{self, CENTRES, Window};
use crate::error::Result;
use crate::fourier::Autoregression;

/// Quadrature points for frequencies from 0 to 1/2 a cycle: many enough for series of a hundred cycles.
const FREQUENCIES: usize = 256;

/// Coefficients beyond these are not told apart from drift, or from noise, by recordings of ten cycles.
const COEFFICIENTS: [f64; 2] = [-0.9, 0.9];

/// Before anything is seen, as much is known about a coefficient as so many cycles of independent variation would tell:
/// demonstrations of three cycles leave it there.
const PRIOR_CYCLES: f64 = 10.0;

/// A smaller level than this, 0.1 %, is no person's, and a recording would not show it.
const LEAST_LEVEL: f64 = 1e-3;

/// Every so many windows, half a cycle, tell as much about the scatter as all; and not more of them than this.
const THINNING: usize = CENTRES / 2;
const MOST_THINNED: usize = 200;

/// A series along a recording: its second moments, and their gains.
#[derive(Debug, Clone)]
pub(super) struct Series {
    /// Mean square about the mean, and mean product of values a cycle apart.
    moments: [f64; 2],
    /// G_0 and G_1 at the quadrature points.
    gains: [Vec<f64>; 2],
    /// Of some of the values, R_i - mean R at each quadrature point; and how many they stand for.
    thinned: Vec<Vec<Complex<f64>>>,
    share: f64,
    /// How much of a say it has in what is common to all: the pairs of values a cycle apart, in cycles.
    cycles: f64,
}

/// One recording's ln level.
struct LogLevel {
    value: f64,
    /// Variance of its error.
    scatter: f64,
}

fn frequency(q: usize) -> f64 {
    (q as f64 + 0.5) / (2 * FREQUENCIES) as f64
}

/// Responses of the windows' phasors to exp(2 pi i nu u), window by window, for one frequency.
fn responses(windows: &[Window], cycles: &[f64], nu: f64) -> Vec<Complex<f64>> {
    let turn: Vec<Complex<f64>> = cycles
        .iter()
        .map(|u| Complex::cis(std::f64::consts::TAU * nu * u))
        .collect();
    windows
        .iter()
        .map(|w| {
            w.weights
                .iter()
                .zip(&turn[w.first..])
                .map(|(a, b)| b * a)
                .sum()
        })
        .collect()
}

impl Series {
    /// ln amplitude, a value a window; `cycles` are the samples' times in cycles.
    pub(super) fn amplitude(windows: &[Window], cycles: &[f64], values: &[f64]) -> Self {
        let steps: Vec<usize> = windows.iter().map(|w| w.step).collect();
        Self::new(&steps, values, |nu| responses(windows, cycles, nu))
    }

    /// ln tempo, a value a pair of windows one cycle apart: the phase it gains on the mean tempo, in cycles.
    pub(super) fn tempo(windows: &[Window], cycles: &[f64], phases: &[f64]) -> Self {
        let pairs = demodulation::a_cycle_apart(windows);
        let steps: Vec<usize> = pairs.iter().map(|(i, _)| windows[*i].step).collect();
        let values: Vec<f64> = pairs
            .iter()
            .map(|(i, j)| (phases[*j] - phases[*i]) / std::f64::consts::TAU)
            .collect();
        Self::new(&steps, &values, |nu| {
            let seen = responses(windows, cycles, nu);
            // Phase in cycles is the integral of the deviation of tempo.
            let integral = Complex::new(0.0, -1.0 / (std::f64::consts::TAU * nu));
            pairs
                .iter()
                .map(|(i, j)| (seen[*j] - seen[*i]) * integral)
                .collect()
        })
    }

    fn new(steps: &[usize], values: &[f64], responses: impl Fn(f64) -> Vec<Complex<f64>>) -> Self {
        let count = values.len() as f64;
        let pairs = demodulation::pairs(steps.iter().copied(), CENTRES);
        let apart = pairs.len().max(1) as f64;
        let mean = values.iter().sum::<f64>() / count;
        let moments = [
            values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count,
            pairs
                .iter()
                .map(|(i, j)| (values[*i] - mean) * (values[*j] - mean))
                .sum::<f64>()
                / apart,
        ];
        let mut gains = [Vec::new(), Vec::new()];
        let mut thinned = Vec::new();
        for q in 0..FREQUENCIES {
            let mut seen = responses(frequency(q));
            let mean = seen.iter().sum::<Complex<f64>>() / count;
            seen.iter_mut().for_each(|r| *r -= mean);
            gains[0].push(seen.iter().map(|r| r.norm_sqr()).sum::<f64>() / count);
            gains[1].push(
                pairs
                    .iter()
                    .map(|(i, j)| (seen[*i] * seen[*j].conj()).re)
                    .sum::<f64>()
                    / apart,
            );
            thinned.push(
                seen.into_iter()
                    .step_by(THINNING)
                    .take(MOST_THINNED)
                    .collect(),
            );
        }
        let all = values.len().div_ceil(THINNING);
        Self {
            moments,
            gains,
            thinned,
            share: all.min(MOST_THINNED) as f64 / all as f64,
            cycles: pairs.len() as f64 / CENTRES as f64,
        }
    }

    /// int S(nu) G_k(nu) d nu.
    fn expected(&self, k: usize, density: &[f64]) -> f64 {
        let sum: f64 = self.gains[k].iter().zip(density).map(|(g, s)| g * s).sum();
        sum / FREQUENCIES as f64
    }

    /// ln s, the standard deviation of the modulation of which this was seen.
    fn log_level(&self, density: &[f64]) -> LogLevel {
        let expected = self.expected(0, density);
        let level = (self.moments[0] / expected).sqrt().max(LEAST_LEVEL);
        // tr K and tr K^2 over the thinned values.
        let count = self.thinned[0].len();
        let mut covariance = DMatrix::<f64>::zeros(count, count);
        for (seen, s) in self.thinned.iter().zip(density) {
            for i in 0..count {
                for j in 0..=i {
                    covariance[(i, j)] += s * (seen[i] * seen[j].conj()).re;
                }
            }
        }
        let trace = covariance.trace();
        let squares: f64 = (0..count)
            .map(|i| {
                let off: f64 = (0..i).map(|j| covariance[(i, j)].powi(2)).sum();
                2.0 * off + covariance[(i, i)].powi(2)
            })
            .sum();
        let independent = (trace * trace / squares / self.share).max(1.0);
        let half = independent / 2.0;
        LogLevel {
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
pub(super) fn levels(series: &[&Series], process: &Autoregression) -> Vec<f64> {
    let density = densities(process);
    let logs: Vec<LogLevel> = series.iter().map(|s| s.log_level(&density)).collect();
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

fn densities(process: &Autoregression) -> Vec<f64> {
    (0..FREQUENCIES)
        .map(|q| process.density(frequency(q)))
        .collect()
}

/// The autoregression common to all: the one whose expected correlation of values one cycle apart, mean over the series
/// weighted by their cycles, is the measured one, with [`PRIOR_CYCLES`] more that say 0. The expected correlation grows with
/// the coefficient, so halving finds it.
pub(super) fn common(series: &[&Series]) -> Result<Autoregression> {
    let mut measured = 0.0;
    let mut used = Vec::new();
    for series in series {
        if series.moments[0] > LEAST_LEVEL * LEAST_LEVEL && series.cycles > 0.0 {
            measured += series.cycles * series.moments[1] / series.moments[0];
            used.push(series);
        }
    }
    let expected = |coefficient: f64| -> Result<f64> {
        let density = densities(&Autoregression::new(coefficient)?);
        let seen: f64 = used
            .iter()
            .map(|s| s.cycles * s.expected(1, &density) / s.expected(0, &density))
            .sum();
        Ok(seen + PRIOR_CYCLES * coefficient)
    };
    let [mut low, mut high] = COEFFICIENTS;
    for _ in 0..40 {
        let middle = (low + high) / 2.0;
        if expected(middle)? < measured {
            low = middle;
        } else {
            high = middle;
        }
    }
    Autoregression::new((low + high) / 2.0)
}

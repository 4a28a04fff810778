//! Levels and memory of cycle-to-cycle variation, estimated from short series seen through a window.
//!
//! What demodulation shows of a modulation x(u), u in cycles, is a linear image of it: smoothed by the window, sampled
//! where windows fit, its mean taken out, all of which makes it smaller and slower. For a stationary modulation of
//! standard deviation s, spectral density S over frequencies up to 1/2 a cycle, and responses R_i(nu) of the values i to
//! exp(2 pi i nu u),
//!
//! ```text
//! E mean_i (x_i - mean x)^2 = s^2 int S(nu) G(nu) d nu,   G(nu) = mean_i |R_i(nu) - mean R(nu)|^2
//! ```
//!
//! exactly, whatever the number of cycles, the stamps and the gaps. So the level is what makes the left side, measured,
//! equal the right, and a wave with that level measures on average as the demonstration does. In the same way the
//! coefficient is what makes the expected correlation of values one cycle apart equal the measured one.

use nalgebra::{DMatrix, SymmetricEigen};
use num_complex::Complex;

use super::demodulation::{self, CENTRES, Window};
use super::level::{LEAST_LEVEL, LogLevel};
use crate::error::Result;
use crate::fourier::Autoregression;

/// Quadrature points for frequencies from 0 to 1/2 a cycle: many enough for series of a hundred cycles.
const FREQUENCIES: usize = 256;

/// Coefficients beyond these are not told apart by recordings of ten cycles: what is slower than a memory of three cycles
/// shows as a recording's mean, which is learned as its amplitude and tempo, and the level would be a guess.
const COEFFICIENTS: [f64; 2] = [-0.7, 0.7];

/// Before anything is seen, as much is known about a coefficient as so many cycles of independent variation would tell:
/// demonstrations of three cycles leave it there.
const PRIOR_CYCLES: f64 = 10.0;

/// Every so many windows, half a cycle, tell as much about the scatter as all; and not more of them than this.
const THINNING: usize = CENTRES / 2;
const MOST_THINNED: usize = 120;

/// A series along a recording: its second moments, and their gains.
#[derive(Debug, Clone)]
pub(super) struct Series {
    /// Mean square about the mean.
    moment: f64,
    /// G at the quadrature points.
    gain: Vec<f64>,
    /// Values half a cycle apart, which scatter as all do.
    thinned: Thinned,
    /// How much of a say it has in what is common to all: the pairs of values a cycle apart, in cycles.
    cycles: f64,
}

/// Some values of a series, about their mean.
#[derive(Debug, Clone)]
struct Thinned {
    /// R_i - mean R, at each quadrature point.
    responses: Vec<Vec<Complex<f64>>>,
    /// Places of values a cycle apart.
    pairs: Vec<(usize, usize)>,
    /// mean (x_i x_{i + 1 cycle}) / mean x_i^2.
    correlation: f64,
    /// How many of all there would be.
    share: f64,
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
        let mean = values.iter().sum::<f64>() / count;
        let moment = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
        let mut gain = Vec::new();
        let all: Vec<usize> = (0..values.len()).step_by(THINNING).collect();
        let some = &all[..all.len().min(MOST_THINNED)];
        let mut thinned = Vec::new();
        for q in 0..FREQUENCIES {
            let mut seen = responses(frequency(q));
            let mean = seen.iter().sum::<Complex<f64>>() / count;
            seen.iter_mut().for_each(|r| *r -= mean);
            gain.push(seen.iter().map(|r| r.norm_sqr()).sum::<f64>() / count);
            let mut seen: Vec<Complex<f64>> = some.iter().map(|i| seen[*i]).collect();
            let mean = seen.iter().sum::<Complex<f64>>() / seen.len() as f64;
            seen.iter_mut().for_each(|r| *r -= mean);
            thinned.push(seen);
        }
        let x: Vec<f64> = some.iter().map(|i| values[*i]).collect();
        let mean = x.iter().sum::<f64>() / x.len() as f64;
        let near = demodulation::pairs(some.iter().map(|i| steps[*i]), CENTRES);
        let product: f64 = near
            .iter()
            .map(|(i, j)| (x[*i] - mean) * (x[*j] - mean))
            .sum();
        let square: f64 = x.iter().map(|x| (x - mean).powi(2)).sum();
        Self {
            moment,
            gain,
            thinned: Thinned {
                responses: thinned,
                correlation: product / near.len().max(1) as f64 * x.len() as f64 / square,
                pairs: near,
                share: x.len() as f64 / all.len() as f64,
            },
            cycles: pairs.len() as f64 / CENTRES as f64,
        }
    }

    /// int S(nu) G(nu) d nu.
    fn expected(&self, density: &[f64]) -> f64 {
        let sum: f64 = self.gain.iter().zip(density).map(|(g, s)| g * s).sum();
        sum / FREQUENCIES as f64
    }

    /// ln s, the standard deviation of the modulation of which this was seen.
    pub(super) fn log_level(&self, process: &Autoregression) -> LogLevel {
        let density = densities(process);
        let level = (self.moment / self.expected(&density))
            .sqrt()
            .max(LEAST_LEVEL);
        let covariance = self.thinned.covariance(&density);
        let scatter = covariance.norm_squared() * self.thinned.share;
        let independent = (covariance.trace().powi(2) / scatter).max(1.0);
        LogLevel::of_mean_square(level, independent)
    }
}

impl Thinned {
    /// Of values of level 1, K.
    fn covariance(&self, density: &[f64]) -> DMatrix<f64> {
        let count = self.responses[0].len();
        let mut covariance = DMatrix::zeros(count, count);
        for (seen, s) in self.responses.iter().zip(density) {
            for i in 0..count {
                for j in 0..=i {
                    covariance[(i, j)] += s / FREQUENCIES as f64 * (seen[i] * seen[j].conj()).re;
                }
            }
        }
        covariance.fill_upper_triangle_with_lower_triangle();
        covariance
    }

    /// E of the correlation, a ratio of quadratic forms of normal values and so not the ratio of their means. With
    /// K = U diag(l) U^T (Magnus 1986, his theorem 6 with one form and its denominator)
    ///
    /// ```text
    /// E (x^T A x / x^T x) = sum_i (U^T A U)_ii l_i int_0^inf (1 + 2 t l_i)^-1 prod_j (1 + 2 t l_j)^-1/2 dt
    /// ```
    fn expected_correlation(&self, density: &[f64]) -> f64 {
        const POINTS: usize = 200;
        let covariance = self.covariance(density);
        let count = covariance.nrows() as f64;
        let trace = covariance.trace();
        let eigen = SymmetricEigen::new(covariance / trace);
        let values: Vec<f64> = eigen.eigenvalues.iter().map(|l| l.max(0.0)).collect();
        let mut integrals = vec![0.0; values.len()];
        for n in 0..POINTS {
            // t = u / (1 - u)
            let u = (n as f64 + 0.5) / POINTS as f64;
            let t = u / (1.0 - u);
            let product: f64 = values.iter().map(|l| 1.0 + 2.0 * t * l).product();
            let common = 1.0 / (product.sqrt() * (1.0 - u).powi(2));
            for (integral, l) in integrals.iter_mut().zip(&values) {
                *integral += l * common / (1.0 + 2.0 * t * l);
            }
        }
        // For A = I the sum is 1, and the quadrature's own error goes with it.
        let one: f64 = integrals.iter().sum();
        let sum: f64 = self
            .pairs
            .iter()
            .map(|(i, j)| {
                let (a, b) = (eigen.eigenvectors.row(*i), eigen.eigenvectors.row(*j));
                a.iter()
                    .zip(b.iter())
                    .zip(&integrals)
                    .map(|((a, b), x)| a * b * x)
                    .sum::<f64>()
            })
            .sum();
        sum / one * count / self.pairs.len() as f64
    }
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
    let used: Vec<&Series> = series
        .iter()
        .copied()
        .filter(|s| s.moment > LEAST_LEVEL * LEAST_LEVEL && !s.thinned.pairs.is_empty())
        .collect();
    let measured: f64 = used.iter().map(|s| s.cycles * s.thinned.correlation).sum();
    let expected = |coefficient: f64| -> Result<f64> {
        let density = densities(&Autoregression::new(coefficient)?);
        let seen: f64 = used
            .iter()
            .map(|s| s.cycles * s.thinned.expected_correlation(&density))
            .sum();
        Ok(seen + PRIOR_CYCLES * coefficient)
    };
    let [mut low, mut high] = COEFFICIENTS;
    for _ in 0..16 {
        let middle = (low + high) / 2.0;
        if expected(middle)? < measured {
            low = middle;
        } else {
            high = middle;
        }
    }
    Autoregression::new((low + high) / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn window(step: usize) -> Window {
        // As narrow as can be: it sees the modulation itself, at its centre.
        Window {
            step,
            centre: step as f64 / CENTRES as f64,
            cycle: step..step + 1,
            first: step,
            weights: vec![1.0],
            phasors: Vec::new(),
            offsets: Vec::new(),
        }
    }

    /// With values one cycle apart and no window, n values of a white series have n - 1 degrees of freedom:
    /// E mean (x - mean x)^2 = s^2 (n - 1) / n.
    #[test]
    fn gains_are_those_of_a_sample_variance_where_nothing_is_smoothed() {
        let windows: Vec<Window> = (0..6).map(|i| window(i * CENTRES)).collect();
        let cycles: Vec<f64> = (0..6 * CENTRES)
            .map(|n| n as f64 / CENTRES as f64)
            .collect();
        let values = [0.1, -0.2, 0.3, 0.0, -0.1, 0.2];
        let series = Series::amplitude(&windows, &cycles, &values);
        let white = densities(&Autoregression::new(0.0).unwrap());
        assert!((series.expected(&white) - 5.0 / 6.0).abs() < 1e-12);
    }
}

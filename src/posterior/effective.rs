//! Effective sample size and potential scale reduction of series as they are; [`Diagnostics`](super::Diagnostics) ranks
//! and halves them first.

use num_complex::Complex;
use realfft::RealFftPlanner;

/// Series whose range is below this are constant.
const CONSTANT: f64 = 1e-15;

/// The number of independent draws that would give the mean as well as these autocorrelated ones, for chains of equal
/// length N >= 4: Vehtari et al. 2021, equations (10) to (13), Geyer's initial monotone sequence, at most
/// S log10 S (S draws in all: antithetic draws can be worth more than independent ones). S for a constant.
pub(super) fn effective_sample_size(chains: &[Vec<f64>]) -> f64 {
    let (m, n) = (chains.len() as f64, chains[0].len());
    let total = m * n as f64;
    let all = || chains.iter().flatten();
    let range = all().fold(f64::NEG_INFINITY, |a, b| a.max(*b))
        - all().fold(f64::INFINITY, |a, b| a.min(*b));
    if range < CONSTANT {
        return total;
    }
    let autocovariance = mean_autocovariance(chains);
    let means: Vec<f64> = chains.iter().map(|chain| mean(chain)).collect();
    let within = autocovariance[0] * n as f64 / (n as f64 - 1.0);
    let between = if chains.len() > 1 {
        variance(&means)
    } else {
        0.0
    };
    let pooled = autocovariance[0] + between;
    let rho = |lag: usize| 1.0 - (within - autocovariance[lag]) / pooled;

    // Geyer's initial positive sequence: lags in pairs, as long as their sums are positive.
    let mut correlations = vec![0.0; n];
    correlations[0] = 1.0;
    correlations[1] = rho(1);
    let (mut even, mut odd) = (1.0, correlations[1]);
    let mut lag = 1;
    while lag + 3 < n && even + odd > 0.0 {
        (even, odd) = (rho(lag + 1), rho(lag + 2));
        if even + odd >= 0.0 {
            correlations[lag + 1] = even;
            correlations[lag + 2] = odd;
        }
        lag += 2;
    }
    // Lags up to here count twice, the next one once: a better estimate for antithetic chains. Where the first pair is
    // negative already there is no lag but the zeroth, which counts once.
    let pairs = lag as i64 - 2;
    if even > 0.0 {
        correlations[(pairs + 1) as usize] = even;
    }
    // Initial monotone sequence: no sum of a pair above the one before it.
    let mut lag = 1;
    while (lag as i64) <= pairs - 2 {
        let before = correlations[lag - 1] + correlations[lag];
        if correlations[lag + 1] + correlations[lag + 2] > before {
            correlations[lag + 1] = before / 2.0;
            correlations[lag + 2] = before / 2.0;
        }
        lag += 2;
    }
    let twice = (pairs + 1) as usize;
    let tau = -1.0 + 2.0 * correlations[..twice].iter().sum::<f64>() + correlations[twice];
    total / tau.max(1.0 / total.log10())
}

/// sqrt(((N-1)/N W + B/N) / W): how much wider all chains together are than each (Gelman and Rubin 1992; Vehtari et al.
/// 2021, equations (1) to (4)). Not a number for constants.
pub(super) fn potential_scale_reduction(chains: &[Vec<f64>]) -> f64 {
    let n = chains[0].len() as f64;
    let means: Vec<f64> = chains.iter().map(|chain| mean(chain)).collect();
    let variances: Vec<f64> = chains.iter().map(|chain| variance(chain)).collect();
    ((n * variance(&means) / mean(&variances) + n - 1.0) / n).sqrt()
}

/// Mean over the chains of sum_t (x_t - mean)(x_{t+lag} - mean) / N, lag = 0..N, by Wiener and Khinchin: the spectra of chains
/// padded to twice their length, so that nothing wraps around.
fn mean_autocovariance(chains: &[Vec<f64>]) -> Vec<f64> {
    let n = chains[0].len();
    let padded = (2 * n).next_power_of_two();
    let mut planner = RealFftPlanner::new();
    let forward = planner.plan_fft_forward(padded);
    let inverse = planner.plan_fft_inverse(padded);
    let mut signal = forward.make_input_vec();
    let mut spectrum = forward.make_output_vec();
    let mut power = vec![Complex::ZERO; spectrum.len()];
    for chain in chains {
        let mean = mean(chain);
        signal.fill(0.0);
        for (s, x) in signal.iter_mut().zip(chain) {
            *s = x - mean;
        }
        forward
            .process(&mut signal, &mut spectrum)
            .expect("buffers that the plan made");
        for (p, s) in power.iter_mut().zip(&spectrum) {
            p.re += s.norm_sqr();
        }
    }
    // The inverse is linear: one for the sum of all spectra.
    inverse
        .process(&mut power, &mut signal)
        .expect("buffers that the plan made, of a spectrum that is real");
    let scale = 1.0 / (padded as f64 * n as f64 * chains.len() as f64);
    signal.truncate(n);
    signal.iter().map(|c| c * scale).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// With N - 1.
fn variance(values: &[f64]) -> f64 {
    let mean = mean(values);
    let squares: f64 = values.iter().map(|x| (x - mean) * (x - mean)).sum();
    squares / (values.len() as f64 - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn autocovariances_are_their_definition() {
        let chains = [
            vec![1.0, 4.0, 2.0, 8.0, 5.0],
            vec![0.0, 1.0, -1.0, 3.0, 2.0],
        ];
        let found = mean_autocovariance(&chains);
        for lag in 0..5 {
            let of = |x: &Vec<f64>| {
                let mean = mean(x);
                let sum: f64 = (0..5 - lag)
                    .map(|t| (x[t] - mean) * (x[t + lag] - mean))
                    .sum();
                sum / 5.0
            };
            let expected = (of(&chains[0]) + of(&chains[1])) / 2.0;
            assert!((found[lag] - expected).abs() < 1e-14);
        }
    }
}

//! Means with standard errors, compared.
//!
//! A mean over C chains has the standard error sd / sqrt(bulk effective sample size). All statistics of a comparison share `FALSE_ALARM` (Bonferroni).

use statrs::distribution::{ContinuousCDF, Normal};
use undulate::{Diagnostics, Posterior, Wave};

/// Of each comparison.
const FALSE_ALARM: f64 = 1e-3;

/// A mean and its standard error.
#[derive(Clone, Copy)]
pub struct Estimate {
    pub mean: f64,
    pub error: f64,
}

/// The largest |z|, or the statistic that is off.
pub fn compare(names: &[String], found: &[Estimate], expected: &[Estimate]) -> Result<f64, String> {
    let tail = FALSE_ALARM / (2.0 * names.len() as f64);
    let most = Normal::standard().inverse_cdf(1.0 - tail);
    let mut largest = 0.0_f64;
    for (name, (found, expected)) in names.iter().zip(found.iter().zip(expected)) {
        let z = (found.mean - expected.mean) / found.error.hypot(expected.error);
        if z.is_nan() || z.abs() > most {
            let (found, expected) = (found.mean, expected.mean);
            return Err(format!(
                "{name}: {found} for {expected}, z = {z:.2}, at most {most:.2}"
            ));
        }
        largest = largest.max(z.abs());
    }
    Ok(largest)
}

/// Means over the draws, of as many statistics as `of` has.
pub fn means(posterior: &Posterior, of: impl Fn(&Wave) -> Vec<f64>) -> Vec<Estimate> {
    let mut series: Vec<Vec<Vec<f64>>> = Vec::new();
    for chain in 0..posterior.chains() {
        for draw in 0..posterior.draws() {
            let values = of(&posterior.wave(chain, draw).unwrap());
            series.resize(values.len(), vec![Vec::new(); posterior.chains()]);
            for (series, value) in series.iter_mut().zip(values) {
                series[chain].push(value);
            }
        }
    }
    let estimate = |chains: &Vec<Vec<f64>>| {
        let all = chains.concat();
        let count = all.len() as f64;
        let mean = all.iter().sum::<f64>() / count;
        let variance = all.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let effective = Diagnostics::of(chains).unwrap().bulk_ess();
        Estimate {
            mean,
            error: (variance / effective).sqrt(),
        }
    };
    series.iter().map(estimate).collect()
}

//! Assertions with samples for them that are true, or off.

use nalgebra::{DMatrix, DVector, dmatrix, dvector};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use undulate::Gaussian;
use undulate::testing::{
    bounded_mean, circular_mean, circular_spread, covariance, distribution, gaussian, independence,
    mean, quantile, refute_above,
};

use super::Outcome;

/// An assertion, and samples for it that are off by some discrepancy, in the terms in which it states its power.
pub struct Case {
    pub name: &'static str,
    /// What the alarm calls off then.
    pub what: &'static str,
    /// What the assertion would call no discrepancy.
    pub none: f64,
    /// Whether its rate of false alarms is what is asked, or only bounded by it.
    pub is_exact: bool,
    /// Whether its power is what it states, or no less than that.
    pub is_sharp: bool,
    /// A discrepancy that is noticed in any case.
    pub gross: f64,
    pub check: fn(&mut ChaCha8Rng, f64, f64) -> Outcome,
}

pub const CASES: [Case; 15] = [
    Case {
        name: "mean",
        what: "mean",
        none: 0.0,
        is_exact: true,
        is_sharp: true,
        gross: 9.0,
        check: |rng, off, level| {
            // In standard deviations along the first column of the factor.
            let samples = draws(&plane(), 60, rng, |x, factor| x + factor.column(0) * off);
            mean(&samples, plane().mean(), level)
        },
    },
    Case {
        name: "covariance",
        what: "variance",
        none: 1.0,
        is_exact: true,
        is_sharp: true,
        gross: 8.0,
        check: |rng, off, level| {
            // A ratio of variances along the first axis that is tested.
            let cholesky = plane().covariance().cholesky().unwrap().l();
            let samples = draws(&plane(), 100, rng, |x, _| widened(&x, &cholesky, off));
            covariance(&samples, &plane().covariance(), level)
        },
    },
    Case {
        name: "gaussian, variance",
        what: "variance",
        none: 1.0,
        is_exact: true,
        is_sharp: true,
        gross: 2.5,
        check: |rng, off, level| {
            let samples = draws(&plane(), 100, rng, |x, factor| widened(&x, factor, off));
            gaussian(&samples, &plane(), level)
        },
    },
    Case {
        name: "gaussian, mean",
        what: "mean",
        none: 0.0,
        is_exact: true,
        is_sharp: true,
        gross: 9.0,
        check: |rng, off, level| {
            let samples = draws(&plane(), 101, rng, |x, factor| x + factor.column(0) * off);
            gaussian(&samples, &plane(), level)
        },
    },
    Case {
        name: "gaussian, succession",
        what: "succession",
        none: 0.0,
        is_exact: true,
        is_sharp: true,
        gross: 0.95,
        check: |rng, off, level| {
            let mut samples = draws(&plane(), 100, rng, |x, _| x - plane().mean());
            for pair in samples.chunks_exact_mut(2) {
                pair[1] = &pair[0] * off + &pair[1] * (1.0 - off * off).sqrt();
            }
            samples.iter_mut().for_each(|x| *x += plane().mean());
            gaussian(&samples, &plane(), level)
        },
    },
    Case {
        name: "distribution",
        what: "distribution",
        none: 0.0,
        is_exact: true,
        is_sharp: false,
        gross: 0.9,
        check: |rng, off, level| {
            // No sample below `off`.
            let samples = numbers(200, rng, |u| off + (1.0 - off) * u);
            distribution(&samples, |x| x.clamp(0.0, 1.0), level)
        },
    },
    Case {
        name: "quantile",
        what: "samples up to the quantile",
        none: 0.0,
        is_exact: true,
        is_sharp: true,
        gross: 0.6,
        check: |rng, off, level| {
            let samples = numbers(400, rng, |u| u * 0.9 / (0.9 - off));
            quantile(&samples, 0.9, 0.9, level)
        },
    },
    Case {
        name: "bounded mean",
        what: "mean",
        none: 0.0,
        is_exact: false,
        is_sharp: false,
        gross: 0.6,
        check: |rng, off, level| {
            let samples = numbers(200, rng, |u| f64::from(u8::from(u < 0.3 + off)));
            bounded_mean(&samples, (0.0, 1.0), 0.3, level)
        },
    },
    Case {
        name: "circular mean",
        what: "mean direction (sine)",
        none: 0.0,
        is_exact: false,
        is_sharp: false,
        gross: 1.5,
        check: |rng, off, level| {
            let angles: Vec<f64> = normals(200, rng).map(|z| 7.0 + off + 0.4 * z).collect();
            circular_mean(&angles, 7.0, resultant(0.4), level)
        },
    },
    Case {
        name: "circular spread",
        what: "resultant length",
        none: 0.0,
        is_exact: false,
        is_sharp: false,
        gross: 0.9,
        check: |rng, off, level| {
            let deviation = (-2.0 * (resultant(0.4) - off).ln()).sqrt();
            let angles: Vec<f64> = normals(200, rng).map(|z| 7.0 + deviation * z).collect();
            circular_spread(&angles, 7.0, resultant(0.4), level)
        },
    },
    Case {
        name: "independence",
        what: "Kendall's tau",
        none: 0.0,
        is_exact: false,
        is_sharp: false,
        gross: 0.95,
        check: |rng, off, level| {
            // Of normal numbers tau is 2 / pi asin(correlation).
            let correlation = (off * std::f64::consts::FRAC_PI_2).sin();
            let rest = (1.0 - correlation * correlation).sqrt();
            let x: Vec<f64> = normals(100, rng).collect();
            let noise = normals(100, rng).collect::<Vec<f64>>();
            let y: Vec<f64> = x
                .iter()
                .zip(noise)
                .map(|(x, e)| correlation * x + rest * e)
                .collect();
            independence(&x, &y, level)
        },
    },
    Case {
        name: "probability above",
        what: "lower bound of a probability",
        none: 0.2,
        is_exact: true,
        is_sharp: true,
        gross: 0.5,
        check: |rng, off, level| {
            let failures = failures(500, 0.2 + off, rng);
            refute_above(failures, 500, 0.2, level)
        },
    },
    Case {
        name: "covariance, less of it",
        what: "variance",
        none: 1.0,
        is_exact: true,
        is_sharp: true,
        gross: 8.0,
        check: |rng, off, level| {
            let cholesky = plane().covariance().cholesky().unwrap().l();
            let samples = draws(&plane(), 60, rng, |x, _| narrowed(&x, &cholesky, off));
            covariance(&samples, &plane().covariance(), level)
        },
    },
    Case {
        name: "gaussian, less variance",
        what: "variance",
        none: 1.0,
        is_exact: true,
        is_sharp: true,
        gross: 2.5,
        check: |rng, off, level| {
            let samples = draws(&plane(), 60, rng, |x, factor| narrowed(&x, factor, off));
            gaussian(&samples, &plane(), level)
        },
    },
    Case {
        name: "bounded mean, lower",
        what: "mean",
        none: 0.0,
        is_exact: false,
        is_sharp: false,
        gross: 0.6,
        check: |rng, off, level| {
            let samples = numbers(200, rng, |u| f64::from(u8::from(u < 0.7 - off)));
            bounded_mean(&samples, (0.0, 1.0), 0.7, level)
        },
    },
];

/// Correlated; the columns of its factor are its axes.
fn plane() -> Gaussian {
    Gaussian::new(dvector![1.0, -2.0], dmatrix![0.4, -0.15; 0.3, 0.2]).unwrap()
}

fn draws(
    gaussian: &Gaussian,
    count: usize,
    rng: &mut ChaCha8Rng,
    off: impl Fn(DVector<f64>, &DMatrix<f64>) -> DVector<f64>,
) -> Vec<DVector<f64>> {
    let factor = gaussian.factor();
    (0..count)
        .map(|_| off(gaussian.sample(rng), &factor))
        .collect()
}

/// The draw with the variance of its first latent number smaller by 1 and this.
fn narrowed(x: &DVector<f64>, factor: &DMatrix<f64>, by: f64) -> DVector<f64> {
    widened(x, factor, 1.0 / (1.0 + by) - 1.0)
}

/// The draw with the variance of its first latent number larger by this share.
fn widened(x: &DVector<f64>, factor: &DMatrix<f64>, by: f64) -> DVector<f64> {
    let inverse = factor.clone().try_inverse().unwrap();
    let z = inverse.row(0).dot(&(x - plane().mean()).transpose());
    x + factor.column(0) * (z * ((1.0 + by).sqrt() - 1.0))
}

pub fn numbers(count: usize, rng: &mut ChaCha8Rng, of: impl Fn(f64) -> f64) -> Vec<f64> {
    (0..count).map(|_| of(rng.random())).collect()
}

fn normals(count: usize, rng: &mut ChaCha8Rng) -> impl Iterator<Item = f64> {
    let line = Gaussian::new(dvector![0.0], dmatrix![1.0]).unwrap();
    (0..count).map(move |_| line.sample(rng)[0])
}

pub fn failures(trials: u64, probability: f64, rng: &mut ChaCha8Rng) -> u64 {
    (0..trials)
        .filter(|_| rng.random::<f64>() < probability)
        .count() as u64
}

/// Of a normal law of this standard deviation, wrapped.
pub fn resultant(deviation: f64) -> f64 {
    (-deviation * deviation / 2.0).exp()
}

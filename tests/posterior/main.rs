//! The samplers against the prior, a closed form, quadrature and themselves (simulation-based calibration); each test
//! also meets a sampler that is broken on purpose, and catches it.
//!
//! Means are tested with the spread between independent chains: for C chains, (mean over chains - expected) / (sd over
//! chains / sqrt C) is Student's t with C - 1 degrees of freedom whatever the autocorrelation within a chain (chain means
//! of hundreds of draws are normal enough). `FALSE_ALARM` is shared by the statistics of a test (Bonferroni).

mod broken;
mod calibration;
mod refused;

use broken::{Fault, broken};
use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, StudentsT};
use undulate::posterior::{
    Draws, EllipticalSlice, Hamiltonian, HamiltonianOptions, Schedule, Transition, run,
};
use undulate::stream;

/// Of each call of `means_agree` or `ranks_are_uniform`.
const FALSE_ALARM: f64 = 1e-6;

/// Many short chains: the spread between them is the yardstick.
fn schedule(thinning: usize) -> Schedule {
    Schedule {
        chains: 40,
        warm_up: 200,
        draws: 150,
        thinning,
    }
}

type Statistic<'a> = (String, Box<dyn Fn(&[f64]) -> f64 + 'a>, f64);

/// Do the draws mix, and are the means of the statistics what they should be?
fn means_agree(draws: &Draws, statistics: &[Statistic]) -> std::result::Result<(), String> {
    let chains = draws.chains().len() as f64;
    let student = StudentsT::new(0.0, 1.0, chains - 1.0).unwrap();
    let most = student.inverse_cdf(1.0 - FALSE_ALARM / (2.0 * statistics.len() as f64));
    for (name, statistic, expected) in statistics {
        let series = draws.series(statistic);
        let means: Vec<f64> = series
            .iter()
            .map(|chain| chain.iter().sum::<f64>() / chain.len() as f64)
            .collect();
        let mean = means.iter().sum::<f64>() / chains;
        let variance = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (chains - 1.0);
        let t = (mean - expected) / (variance / chains).sqrt();
        // Chains that never moved have no spread.
        if t.is_nan() || t.abs() > most {
            return Err(format!(
                "{name}: {mean} for {expected}, t = {t:.2}, at most {most:.2}"
            ));
        }
        let diagnostics = draws.diagnose(statistic).unwrap();
        if diagnostics.r_hat() > 1.05 || diagnostics.r_hat().is_nan() {
            return Err(format!("{name}: {diagnostics}"));
        }
    }
    Ok(())
}

/// Means, variances and covariances of N(mean, covariance).
fn moments<'a>(mean: &'a DVector<f64>, covariance: &DMatrix<f64>) -> Vec<Statistic<'a>> {
    let mut statistics: Vec<Statistic> = Vec::new();
    for i in 0..mean.len() {
        statistics.push((format!("mean {i}"), Box::new(move |z| z[i]), mean[i]));
        for j in 0..=i {
            let product = move |z: &[f64]| (z[i] - mean[i]) * (z[j] - mean[j]);
            statistics.push((
                format!("covariance {i} {j}"),
                Box::new(product),
                covariance[(i, j)],
            ));
        }
    }
    statistics
}

/// A target with its gradient: L of z, which writes dL/dz.
type Target = fn(&[f64], &mut [f64]) -> f64;

fn elliptical(n: usize, target: Target) -> impl Transition {
    let mut gradient = vec![0.0; n];
    EllipticalSlice::new(n, move |z: &DVector<f64>| {
        target(z.as_slice(), &mut gradient)
    })
}

fn hamiltonian(n: usize, target: Target) -> impl Transition {
    Hamiltonian::new(n, target)
}

/// Steps so large that trajectories of the second chance matter.
fn coarse(n: usize, target: Target, acceptance: f64) -> impl Transition {
    let options = HamiltonianOptions {
        acceptance,
        directions: 0,
        ..HamiltonianOptions::default()
    };
    Hamiltonian::new(n, target).with_options(options).unwrap()
}

fn draws(mut transition: impl Transition, seed: u64, thinning: usize) -> Draws {
    run(&mut transition, &schedule(thinning), |c| stream(seed, c)).unwrap()
}

/// Seed 1, N = 40 chains of 150 draws, false alarm 1e-6 each.
#[test]
fn a_flat_likelihood_returns_the_prior() {
    let flat: Target = |_, gradient| {
        gradient.fill(0.0);
        3.0
    };
    let mean = DVector::zeros(5);
    let statistics = moments(&mean, &DMatrix::identity(5, 5));
    let check = |draws: Draws| means_agree(&draws, &statistics);
    check(draws(elliptical(5, flat), 1, 2)).unwrap();
    check(draws(hamiltonian(5, flat), 1, 1)).unwrap();
    check(draws(broken(5, flat, Fault::Axis), 1, 2)).unwrap_err();
    check(draws(broken(5, flat, Fault::Momentum), 1, 1)).unwrap_err();
}

/// The observations of `linear`: their rows, values and standard deviation.
const ROWS: [[f64; 6]; 2] = [
    [0.6, -0.3, 0.5, 0.2, 0.0, 0.1],
    [0.1, 0.4, 0.3, -0.7, 0.2, 0.0],
];
const VALUES: [f64; 2] = [1.2, -0.7];
const DEVIATION: f64 = 0.1;

fn linear(z: &[f64], gradient: &mut [f64]) -> f64 {
    gradient.fill(0.0);
    let mut value = 0.0;
    for (row, y) in ROWS.iter().zip(VALUES) {
        let mean: f64 = row.iter().zip(z).map(|(a, z)| a * z).sum();
        let residual = (y - mean) / DEVIATION;
        value -= 0.5 * residual * residual;
        for (g, a) in gradient.iter_mut().zip(row) {
            *g += residual / DEVIATION * a;
        }
    }
    value
}

/// Seed 2, N = 40 chains of 150 draws, false alarm 1e-6 each.
#[test]
fn a_linear_gaussian_likelihood_returns_the_closed_form() {
    // Kalman's update: covariance I - A^T (A A^T + s^2 I)^-1 A, mean A^T (A A^T + s^2 I)^-1 y.
    let a = DMatrix::from_fn(2, 6, |i, j| ROWS[i][j]);
    let noise = DMatrix::identity(2, 2) * DEVIATION.powi(2);
    let gain = a.transpose() * (&a * a.transpose() + noise).try_inverse().unwrap();
    let mean = &gain * DVector::from_column_slice(&VALUES);
    let covariance = DMatrix::identity(6, 6) - gain * &a;
    let mut statistics = moments(&mean, &covariance);
    // What the observations hold: narrow, and so hidden in the covariances of coordinates.
    for (i, row) in ROWS.iter().enumerate() {
        let row = DVector::from_column_slice(row);
        let variance = row.dot(&(&covariance * &row));
        let mean = &mean;
        let deviation = move |z: &[f64]| {
            let along = |(a, (z, m)): (&f64, (&f64, &f64))| a * (z - m);
            row.iter().zip(z.iter().zip(mean)).map(along).sum::<f64>()
        };
        let square = Box::new(move |z: &[f64]| deviation(z).powi(2));
        statistics.push((format!("variance of observation {i}"), square, variance));
    }
    let check = |draws: Draws| means_agree(&draws, &statistics);
    check(draws(elliptical(6, linear), 2, 15)).unwrap();
    check(draws(hamiltonian(6, linear), 2, 1)).unwrap();
    check(draws(coarse(6, linear, 0.6), 2, 4)).unwrap();
    check(draws(broken(6, linear, Fault::Halving), 2, 15)).unwrap_err();
    check(draws(broken(6, linear, Fault::Threshold), 2, 15)).unwrap_err();
    // Stable below a step of 2 x 0.1 / |a| = 0.23.
    check(draws(broken(6, linear, Fault::NoMetropolis(0.15)), 2, 1)).unwrap_err();
    let wrong_sign: Target = |z, gradient| {
        let value = linear(z, gradient);
        gradient.iter_mut().for_each(|g| *g = -*g);
        value
    };
    check(draws(hamiltonian(6, wrong_sign), 2, 1)).unwrap_err();
}

/// A crescent: z_1 + z_0^2 / 2 observed to be 1 with standard deviation 0.4, and nothing left of z_0 = -1.
fn crescent(z: &[f64], gradient: &mut [f64]) -> f64 {
    if z[0] < -1.0 {
        return f64::NEG_INFINITY;
    }
    let residual = (1.0 - z[1] - 0.5 * z[0] * z[0]) / 0.4;
    gradient[0] = residual / 0.4 * z[0];
    gradient[1] = residual / 0.4;
    -0.5 * residual * residual
}

/// Seed 3, N = 40 chains of 150 draws, false alarm 1e-6 each.
#[test]
fn a_crescent_agrees_with_quadrature() {
    // Midpoints in z_0, which starts at the jump; errors of 1e-5, the chains' are 1e-2.
    let names = ["z0", "z1", "z0^2", "z1^2", "z0 z1", "cos 3 z0"];
    let of: [fn(&[f64]) -> f64; 6] = [
        |z| z[0],
        |z| z[1],
        |z| z[0] * z[0],
        |z| z[1] * z[1],
        |z| z[0] * z[1],
        |z| (3.0 * z[0]).cos(),
    ];
    let (mut sums, mut total) = ([0.0; 6], 0.0);
    let (step, points) = (0.01, 700);
    for i in 0..points {
        for j in 0..2 * points {
            let z = [
                -1.0 + step * (i as f64 + 0.5),
                step * (j as f64 - points as f64),
            ];
            let mut gradient = [0.0; 2];
            let logarithm = crescent(&z, &mut gradient) - 0.5 * (z[0] * z[0] + z[1] * z[1]);
            let weight = logarithm.exp();
            total += weight;
            for (sum, f) in sums.iter_mut().zip(of) {
                *sum += weight * f(&z);
            }
        }
    }
    let statistics: Vec<Statistic> = (0..6)
        .map(|i| -> Statistic { (names[i].to_owned(), Box::new(of[i]), sums[i] / total) })
        .collect();
    let check = |draws: Draws| means_agree(&draws, &statistics);
    check(draws(elliptical(2, crescent), 3, 6)).unwrap();
    check(draws(hamiltonian(2, crescent), 3, 2)).unwrap();
    check(draws(coarse(2, crescent, 0.2), 3, 4)).unwrap();
    check(draws(broken(2, crescent, Fault::Halving), 3, 6)).unwrap_err();
    let everywhere: Target = |z, gradient| crescent(&[z[0].abs(), z[1]], gradient);
    check(draws(elliptical(2, everywhere), 3, 6)).unwrap_err();
    check(draws(hamiltonian(2, everywhere), 3, 2)).unwrap_err();
}

/// Tight observations in as many dimensions as a learned primitive has: seed 6, the default schedule.
#[test]
fn tight_observations_in_many_dimensions_mix() {
    const N: usize = 269;
    let likelihood = |z: &[f64], gradient: &mut [f64]| {
        gradient.fill(0.0);
        let mut value = 0.0;
        for o in 0..3 {
            // Each sees twenty dimensions, through one log modulus and one phase.
            let part = o * 20..o * 20 + 10;
            let modulus = (0.1 * z[part.clone()].iter().sum::<f64>()).exp();
            let phase = 0.5 + 0.1 * z[part.end..part.end + 10].iter().sum::<f64>();
            let residual = (0.6 - modulus * phase.cos()) / 0.03;
            value -= 0.5 * residual * residual;
            for i in part.clone() {
                gradient[i] += residual / 0.03 * 0.1 * modulus * phase.cos();
                gradient[i + 10] -= residual / 0.03 * 0.1 * modulus * phase.sin();
            }
        }
        value
    };
    let mut transition = Hamiltonian::new(N, likelihood);
    let draws = run(&mut transition, &Schedule::default(), |c| stream(6, c)).unwrap();
    let diagnostics = draws.diagnostics().unwrap();
    assert!(diagnostics.mixed(), "{diagnostics}");
    for chain in draws.chains() {
        let effort = chain.effort();
        assert!((0.6..0.98).contains(&effort.acceptance()), "{effort:?}");
        assert!(
            effort.evaluations < 20 * effort.transitions && effort.divergent == 0,
            "{effort:?}"
        );
    }
}

#[test]
fn a_chain_depends_on_its_stream_alone() {
    let of = |chains: usize| {
        let schedule = Schedule {
            chains,
            warm_up: 50,
            draws: 20,
            thinning: 2,
        };
        let mut transition = Hamiltonian::new(6, linear);
        let draws = run(&mut transition, &schedule, |c| stream(7, c)).unwrap();
        let mut transition = elliptical(6, linear);
        (
            draws,
            run(&mut transition, &schedule, |c| stream(7, c)).unwrap(),
        )
    };
    let ((four, slices_of_four), (six, slices_of_six)) = (of(4), of(6));
    assert_eq!(four.chains(), &six.chains()[..4]);
    assert_eq!(slices_of_four.chains(), &slices_of_six.chains()[..4]);
    assert_ne!(four.chains()[0], four.chains()[1]);
    assert_eq!(four.chains()[0].z().shape(), (6, 20));
    let mut gradient = [0.0; 6];
    let last = four.chains()[3].z().column(19);
    assert_eq!(
        four.chains()[3].log_likelihoods()[19],
        linear(last.as_slice(), &mut gradient)
    );
}

/// Warm-up learns by iteration, and still: the same bits on every machine.
#[test]
fn a_seed_gives_the_same_draws_everywhere() {
    let last = |draws: Draws| draws.chains()[3].z().column(149)[0];
    let found = [
        last(draws(elliptical(6, linear), 9, 1)),
        last(draws(hamiltonian(6, linear), 9, 1)),
    ];
    assert_eq!(found, [0.9039884639765124, 1.6567990902828136]);
}

//! Simulation-based calibration of both samplers.

use nalgebra::DVector;
use rand::Rng;
use statrs::distribution::{ChiSquared, ContinuousCDF};
use undulate::posterior::{Draws, EllipticalSlice, Hamiltonian, Schedule, run};
use undulate::{rand, stream};

use crate::FALSE_ALARM;
use crate::broken::normals;

/// Simulation-based calibration (Talts, Betancourt, Simpson, Vehtari and Gelman, arXiv 1804.06788): when z is drawn from
/// the prior and y from the likelihood, the rank of a scalar of z among as many posterior draws is uniform. Seed 4,
/// N = 600 simulations, ranks among 63 draws of 4 chains in 16 bins, chi-square, false alarm 1e-6 each.
fn ranks_are_uniform(
    sampler: impl Fn([f64; 2], &Schedule, u64) -> Draws,
    thinning: usize,
) -> std::result::Result<(), String> {
    const SIMULATIONS: usize = 600;
    let schedule = Schedule {
        chains: 4,
        warm_up: 60,
        draws: 16,
        thinning,
    };
    let statistics: [fn(&[f64]) -> f64; 2] = [|z| observed(z)[0], |z| observed(z)[1] + z[0]];
    let mut counts = [[0.0; 16]; 2];
    for simulation in 0..SIMULATIONS as u64 {
        let mut rng = stream(4, simulation);
        let z = normals(&mut rng, 3);
        let noise = normals(&mut rng, 2);
        let mean = observed(&z);
        let y = [mean[0] + NOISE * noise[0], mean[1] + NOISE * noise[1]];
        let draws = sampler(y, &schedule, simulation);
        for (counts, statistic) in counts.iter_mut().zip(statistics) {
            let all = draws.series(statistic).concat();
            let rank = all[1..].iter().filter(|s| **s < statistic(&z)).count();
            counts[rank / 4] += 1.0;
        }
    }
    let expected = SIMULATIONS as f64 / 16.0;
    let chi_square = ChiSquared::new(15.0).unwrap();
    let most = chi_square.inverse_cdf(1.0 - FALSE_ALARM / 2.0);
    for counts in counts {
        let statistic: f64 = counts
            .iter()
            .map(|c: &f64| (c - expected).powi(2) / expected)
            .sum();
        if statistic > most {
            return Err(format!(
                "chi-square {statistic:.1}, at most {most:.1}: {counts:?}"
            ));
        }
    }
    Ok(())
}

const NOISE: f64 = 0.3;

/// What is seen of z in a simulation: two observations, as of moduli and phases.
fn observed(z: &[f64]) -> [f64; 2] {
    [
        (0.5 * z[0]).exp() * (0.7 * z[1]).cos(),
        (0.5 * z[1]).exp() * (0.7 * z[2]).sin(),
    ]
}

fn seen(z: &[f64], y: [f64; 2], gradient: &mut [f64]) -> f64 {
    let mean = observed(z);
    let residuals = [(y[0] - mean[0]) / NOISE, (y[1] - mean[1]) / NOISE];
    let slopes = [
        [
            0.5 * mean[0],
            -0.7 * (0.5 * z[0]).exp() * (0.7 * z[1]).sin(),
            0.0,
        ],
        [
            0.0,
            0.5 * mean[1],
            0.7 * (0.5 * z[1]).exp() * (0.7 * z[2]).cos(),
        ],
    ];
    for i in 0..3 {
        gradient[i] = (residuals[0] * slopes[0][i] + residuals[1] * slopes[1][i]) / NOISE;
    }
    -0.5 * (residuals[0] * residuals[0] + residuals[1] * residuals[1])
}

/// The generator of the chains of a simulation: not the one that made its data.
fn chain_stream(simulation: u64, chain: u64) -> impl Rng {
    stream(5, simulation * 4 + chain)
}

#[test]
fn calibrated_ranks_of_elliptical_slices_are_uniform() {
    let sampler = |share: f64| {
        move |y: [f64; 2], schedule: &Schedule, simulation: u64| {
            let mut gradient = [0.0; 3];
            let likelihood = |z: &DVector<f64>| share * seen(z.as_slice(), y, &mut gradient);
            let mut transition = EllipticalSlice::new(3, likelihood);
            run(&mut transition, schedule, |c| chain_stream(simulation, c)).unwrap()
        }
    };
    ranks_are_uniform(sampler(1.0), 12).unwrap();
    // A likelihood that counts each observation twice: draws too narrow.
    ranks_are_uniform(sampler(2.0), 12).unwrap_err();
}

#[test]
fn calibrated_ranks_of_trajectories_are_uniform() {
    let sampler = |share: f64| {
        move |y: [f64; 2], schedule: &Schedule, simulation: u64| {
            let likelihood = |z: &[f64], gradient: &mut [f64]| {
                let value = seen(z, y, gradient);
                gradient.iter_mut().for_each(|g| *g *= share);
                share * value
            };
            let mut transition = Hamiltonian::new(3, likelihood);
            run(&mut transition, schedule, |c| chain_stream(simulation, c)).unwrap()
        }
    };
    ranks_are_uniform(sampler(1.0), 2).unwrap();
    ranks_are_uniform(sampler(2.0), 2).unwrap_err();
}

//! Posteriors of a learned primitive against importance sampling from it, against closed forms, and what is refused.
//!
//! An importance-weighted mean of N draws x_i with weights w_i has the standard error of a ratio, sqrt(sum w_i^2 (x_i - mean)^2) / sum w_i.

use std::sync::OnceLock;

use rand::distr::Distribution;
use undulate::posterior::Schedule;
use undulate::{
    FourierMovementPrimitive, Posterior, Target, Wave, WeightGradient, stream, synthetic,
};

mod closed_forms;
mod estimates;

use estimates::{Estimate, compare, means};

/// Joints of the demonstrator.
const ROTATION: usize = 2;
const ELBOW: usize = 3;
const WRIST: usize = 4;

fn primitive() -> &'static FourierMovementPrimitive {
    static LEARNED: OnceLock<FourierMovementPrimitive> = OnceLock::new();
    LEARNED.get_or_init(|| FourierMovementPrimitive::learn(&synthetic(0).unwrap(), 25).unwrap())
}

/// Positions: the first two are those of the via-points.
const POSITIONS: [(usize, f64); 8] = [
    (ELBOW, 1.2),
    (WRIST, 2.9),
    (ELBOW, 0.3),
    (ELBOW, 2.9),
    (ELBOW, 5.0),
    (WRIST, 1.2),
    (WRIST, 4.1),
    (ROTATION, 1.2),
];
const MODULI: [(usize, usize); 6] = [
    (ELBOW, 10),
    (ELBOW, 15),
    (WRIST, 10),
    (WRIST, 20),
    (WRIST, 1),
    (ROTATION, 10),
];
/// Where in `measured` the amplitude of the elbow from 1.2 to 1.8 Hz is: harmonics 8 to 12.
const BAND: usize = POSITIONS.len();

/// By its definition, position by position and not by the library.
fn measured(wave: &Wave) -> Vec<f64> {
    static TURNS: OnceLock<Vec<Vec<(f64, f64)>>> = OnceLock::new();
    let turns = TURNS.get_or_init(|| {
        let angle = |t: f64, k: usize| std::f64::consts::TAU * k as f64 * t / wave.period();
        let of = |(_, t): &(usize, f64)| (1..=25).map(|k| angle(*t, k).sin_cos()).collect();
        POSITIONS.iter().map(of).collect()
    });
    let (offsets, weights) = (wave.offsets(), wave.weights());
    let mut values: Vec<f64> = Vec::with_capacity(32);
    for ((d, _), turns) in POSITIONS.iter().zip(turns) {
        let terms = turns.iter().enumerate().map(|(k, (sin, cos))| {
            let weight = weights[(*d, k)];
            weight.re * cos - weight.im * sin
        });
        values.push(offsets[*d] + 2.0 * terms.sum::<f64>());
    }
    let squares = (8..=12).map(|k| weights[(ELBOW, k - 1)].norm_sqr());
    values.push(2.0 * squares.sum::<f64>().sqrt());
    values.extend(MODULI.map(|(d, k)| weights[(d, k - 1)].norm().ln()));
    values.extend([ROTATION, ELBOW, WRIST].map(|d| offsets[d]));
    for k in [10, 20] {
        let lag = weights[(WRIST, k - 1)] * weights[(ELBOW, k - 1)].conj();
        values.extend([lag.re / lag.norm(), lag.im / lag.norm()]);
    }
    // Spread, not only place.
    values.extend([0, 1, BAND].map(|i| values[i].powi(2)));
    values
}

fn names() -> Vec<String> {
    let positions = POSITIONS.map(|(d, t)| format!("joint {d} at {t} s"));
    let moduli = MODULI.map(|(d, k)| format!("ln |w_{d},{k}|"));
    let offsets = [ROTATION, ELBOW, WRIST].map(|d| format!("offset of joint {d}"));
    let lags = [10, 20].map(|k| ["cos", "sin"].map(|f| format!("{f} of the wrist's lag at {k}")));
    let mut names = positions.to_vec();
    names.push("band".into());
    names.extend(moduli.into_iter().chain(offsets).chain(lags.concat()));
    let squares = [0, 1, BAND].map(|i| format!("square of {}", names[i]));
    names.extend(squares);
    names
}

/// N = 150000 draws of the primitive, seed 1.
fn prior() -> &'static Vec<Vec<f64>> {
    static DRAWS: OnceLock<Vec<Vec<f64>>> = OnceLock::new();
    DRAWS.get_or_init(|| {
        let mut rng = stream(1, 0);
        let draw = |_| measured(&primitive().sample(&mut rng));
        (0..150_000).map(draw).collect()
    })
}

/// Weighted by a likelihood of what is measured.
fn importance(log_likelihood: impl Fn(&[f64]) -> f64) -> Vec<Estimate> {
    let draws = prior();
    let weights: Vec<f64> = draws.iter().map(|x| log_likelihood(x).exp()).collect();
    let total: f64 = weights.iter().sum();
    let square: f64 = weights.iter().map(|w| w * w).sum();
    let kish = total * total / square;
    println!("importance sampling is worth {kish:.0} draws");
    assert!(kish >= 5000.0, "{kish}");
    let estimate = |i: usize| {
        let pairs = || draws.iter().map(|x| x[i]).zip(&weights);
        let mean = pairs().map(|(x, w)| w * x).sum::<f64>() / total;
        let spread = pairs().map(|(x, w)| (w * (x - mean)).powi(2));
        Estimate {
            mean,
            error: spread.sum::<f64>().sqrt() / total,
        }
    };
    (0..draws[0].len()).map(estimate).collect()
}

/// -(x - aim)^2 / (2 sd^2) of degrees.
fn gaussian(x: f64, aim: f64, deviation: f64) -> f64 {
    -0.5 * ((x.to_degrees() - aim) / deviation).powi(2)
}

const AIMS: [f64; 2] = [116.0, 5.0];

fn via_points(deviation: f64) -> [Target; 2] {
    let [elbow, wrist] = AIMS;
    [
        format!("elbow_flexion@1.2s={elbow}deg+-{deviation}deg"),
        format!("wrist_deviation@2.9s={wrist}deg+-{deviation}deg"),
    ]
    .map(|text| text.parse().unwrap())
}

fn of_points(x: &[f64]) -> f64 {
    gaussian(x[0], AIMS[0], 2.0) + gaussian(x[1], AIMS[1], 2.0)
}

fn schedule(draws: usize, thinning: usize) -> Schedule {
    Schedule {
        draws,
        thinning,
        ..Schedule::default()
    }
}

fn agrees(what: &str, posterior: &Posterior, expected: &[Estimate]) -> Result<(), String> {
    println!("{what}: {}", posterior.diagnostics().unwrap());
    let largest = compare(&names(), &means(posterior, measured), expected)?;
    println!("{what}: |z| at most {largest:.2}");
    Ok(())
}

/// Seeds 2, N = 4 chains of 1500 draws; false alarm 1e-3.
#[test]
fn slices_without_offsets_agree_with_importance_sampling() {
    let expected = importance(of_points);
    let towards = |deviation| {
        let targets = via_points(deviation);
        primitive().towards(&targets, &schedule(1500, 1), 2)
    };
    agrees("slices", &towards(2.0).unwrap(), &expected).unwrap();
    let caught = agrees("sd 4 deg", &towards(4.0).unwrap(), &expected).unwrap_err();
    println!("sd 4 deg: {caught}");
}

/// Seed 3, N = 4 chains of 500 draws; false alarm 1e-3.
#[test]
fn trajectories_agree_with_importance_sampling() {
    let run = |deviation: f64| {
        let log_likelihood = |wave: &Wave, gradient: &mut WeightGradient| {
            let mut value = 0.0;
            for ((d, t), aim) in POSITIONS.into_iter().zip(AIMS) {
                let found = wave.position(t)[d];
                let slope = (aim.to_radians() - found) / deviation.to_radians().powi(2);
                gradient.add_position(wave, d, t, slope);
                value += gaussian(found, aim, deviation);
            }
            value
        };
        primitive().posterior_by_gradient(log_likelihood, &schedule(500, 1), 3)
    };
    let expected = importance(of_points);
    agrees("trajectories", &run(2.0).unwrap(), &expected).unwrap();
    // Twice the same with twice the variance, which are too many points for slices.
    let twice = [via_points(8f64.sqrt()), via_points(8f64.sqrt())].concat();
    let posterior = primitive().towards(&twice, &schedule(500, 1), 3).unwrap();
    agrees("without offsets", &posterior, &expected).unwrap();
    agrees("sd 4 deg", &run(4.0).unwrap(), &expected).unwrap_err();
}

/// Seed 4, N = 4 chains of 800 draws, each of 20 slices; false alarm 1e-3.
#[test]
fn plain_slices_agree_with_importance_sampling() {
    let run = |deviation: f64| {
        let log_likelihood = |wave: &Wave| {
            let points = POSITIONS.into_iter().zip(AIMS);
            points
                .map(|((d, t), aim)| gaussian(wave.position(t)[d], aim, deviation))
                .sum()
        };
        primitive().posterior(log_likelihood, &schedule(800, 20), 4)
    };
    let expected = importance(of_points);
    agrees("plain slices", &run(2.0).unwrap(), &expected).unwrap();
    agrees("sd 4 deg", &run(4.0).unwrap(), &expected).unwrap_err();
}

/// Seed 5, N = 4 chains of 500 draws; false alarm 1e-3.
#[test]
fn amplitudes_in_a_band_agree_with_importance_sampling() {
    let band = |deviation: f64| {
        let text = format!("elbow_flexion:1.2Hz..1.8Hz=10deg+-{deviation}deg");
        primitive().towards(&[text.parse().unwrap()], &schedule(500, 1), 5)
    };
    let expected = importance(|x| gaussian(x[BAND], 10.0, 1.0));
    agrees("band", &band(1.0).unwrap(), &expected).unwrap();
    agrees("sd 2 deg", &band(2.0).unwrap(), &expected).unwrap_err();
}

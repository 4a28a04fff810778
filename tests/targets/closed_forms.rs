//! Posteriors with a closed form: the prior itself, and linear conditioning. And what is no posterior.

use undulate::posterior::Schedule;
use undulate::{FourierMovementPrimitive, Observation, Posterior, Target, Wave, WeightGradient};

use super::estimates::{Estimate, compare, means};
use super::{ELBOW, primitive, schedule, via_points};

/// Of every fifth coordinate of the vector, and of all offsets, two numbers with known means: of an angle x ~ N(m, s^2), which is known up to whole
/// turns, cos(x - m) and sin(x - m), with means exp(-s^2 / 2) and 0; of others x - m and (x - m)^2.
fn coordinates() -> impl Iterator<Item = (usize, bool)> {
    let chart = primitive().chart();
    let angles = chart.joints().len() * chart.harmonics();
    let of = move |i: usize| (i, (angles..2 * angles).contains(&i));
    (0..chart.dimension())
        .filter(move |i| i % 5 == 0 || *i >= 2 * angles)
        .map(of)
}

/// Do the draws have the moments of the vector of `expected`?
fn has_moments(posterior: &Posterior, expected: &FourierMovementPrimitive) -> Result<f64, String> {
    let (chart, gaussian) = (expected.chart(), expected.gaussian());
    let of = |wave: &Wave| {
        let x = chart.vector(wave).unwrap() - gaussian.mean();
        let pairs = coordinates().flat_map(|(i, is_angle)| {
            if is_angle {
                [x[i].cos(), x[i].sin()]
            } else {
                [x[i], x[i] * x[i]]
            }
        });
        pairs.collect::<Vec<f64>>()
    };
    let exact = |mean: f64| Estimate { mean, error: 0.0 };
    let (mut names, mut moments) = (Vec::new(), Vec::new());
    for (i, is_angle) in coordinates() {
        let variance = gaussian.standard_deviation(i).powi(2);
        let name = chart.coordinate(i).unwrap();
        names.extend([format!("{name}, first"), format!("{name}, second")]);
        moments.extend(if is_angle {
            [(-0.5 * variance).exp(), 0.0].map(exact)
        } else {
            [0.0, variance].map(exact)
        });
    }
    compare(&names, &means(posterior, of), &moments)
}

fn elbow_offset() -> FourierMovementPrimitive {
    let observation = Observation::offset("elbow_flexion", 2.0).within(0.05);
    primitive().condition(&[observation]).unwrap()
}

/// Seeds 6 and 7, N = 4 chains of 500 draws; false alarm 1e-3 each.
#[test]
fn a_flat_likelihood_returns_the_prior() {
    let slices = primitive().posterior(|_| 1.5, &schedule(500, 1), 6);
    let flat = |_: &Wave, _: &mut WeightGradient| 1.5;
    let trajectories = primitive().posterior_by_gradient(flat, &schedule(500, 1), 7);
    for posterior in [slices.unwrap(), trajectories.unwrap()] {
        has_moments(&posterior, primitive()).unwrap();
        has_moments(&posterior, &elbow_offset()).unwrap_err();
    }
}

/// Seed 8, N = 4 chains of 1000 draws; false alarm 1e-3.
#[test]
fn a_likelihood_of_an_offset_is_an_inexact_condition() {
    let log_likelihood = |wave: &Wave, gradient: &mut WeightGradient| {
        let residual = (2.0 - wave.offsets()[ELBOW]) / 0.05;
        gradient.offsets[ELBOW] += residual / 0.05;
        -0.5 * residual * residual
    };
    let posterior = primitive().posterior_by_gradient(log_likelihood, &schedule(1000, 1), 8);
    let posterior = posterior.unwrap();
    has_moments(&posterior, &elbow_offset()).unwrap();
    has_moments(&posterior, primitive()).unwrap_err();
}

#[test]
fn a_run_too_short_says_so() {
    let short = Schedule {
        warm_up: 0,
        ..schedule(10, 1)
    };
    let posterior = primitive().towards(&via_points(2.0), &short, 9).unwrap();
    let diagnostics = posterior.diagnostics().unwrap();
    assert!(!diagnostics.mixed() && diagnostics.to_string().contains("NOT MIXED"));
}

#[test]
fn likelihoods_that_are_none_are_refused_by_name() {
    let schedule = schedule(4, 1);
    let refusal = |value: f64| {
        let plain = primitive().posterior(|_| value, &schedule, 1).unwrap_err();
        let gradient = |_: &Wave, _: &mut WeightGradient| value;
        let error = primitive().posterior_by_gradient(gradient, &schedule, 1);
        assert_eq!(plain.to_string(), error.unwrap_err().to_string());
        plain.to_string()
    };
    assert!(refusal(f64::NAN).contains("log-likelihood is NaN"));
    assert!(refusal(f64::INFINITY).contains("log-likelihood is inf"));
    assert!(refusal(f64::NEG_INFINITY).contains("none of 1000 draws"));
    let slope = |_: &Wave, gradient: &mut WeightGradient| {
        gradient.offsets[0] = f64::NAN;
        0.0
    };
    let error = primitive().posterior_by_gradient(slope, &schedule, 1);
    let error = error.unwrap_err().to_string();
    assert!(error.contains("gradient of the log-likelihood is NaN"));
    for text in ["knee@1s=5deg+-1deg", "elbow_flexion@1s=5deg+-0deg"] {
        let target: Target = text.parse().unwrap();
        let error = primitive().towards(&[target], &schedule, 1).unwrap_err();
        assert!(error.to_string().starts_with("target"), "{error}");
    }
}

//! Weights of a conditioned mixture against Bayes' rule on dense matrices.

use nalgebra::{DMatrix, DVector};
use undulate::{
    Coordinate, Estimator, Example, FourierMovementPrimitive, Mixture, Observation, Quantity,
};

use crate::dense::log_normal;
use crate::toy;

fn observations() -> Vec<Observation> {
    vec![
        Observation::modulus("elbow", 1, 0.12),
        Observation::offset("shoulder", 0.4).within(0.1),
        Observation::of(Coordinate::relative_phase("elbow", "shoulder", 1), -3.0),
    ]
}

fn coordinate(observation: &Observation) -> &Coordinate {
    match &observation.quantity {
        Quantity::One(coordinate) => coordinate,
        Quantity::Sum(_) => panic!("none here"),
    }
}

/// ln N(b; A mu, A Sigma A^T + noise).
fn evidence(primitive: &FourierMovementPrimitive, observations: &[Observation]) -> f64 {
    let chart = primitive.chart();
    let mut rows = DMatrix::zeros(observations.len(), chart.dimension());
    let mut noise = DMatrix::zeros(observations.len(), observations.len());
    let mut values = DVector::zeros(observations.len());
    for (m, o) in observations.iter().enumerate() {
        for (i, c) in chart.row(coordinate(o)).unwrap() {
            rows[(m, i)] = c;
        }
        values[m] = chart.charted(coordinate(o), o.value).unwrap();
        noise[(m, m)] = o.deviation * o.deviation;
    }
    let gaussian = primitive.gaussian();
    let sigma = &rows * gaussian.covariance() * rows.transpose() + noise;
    log_normal(&(values - rows * gaussian.mean()), &sigma)
}

/// Whether weights follow from those before and from the evidence.
fn are_bayes(before: &Mixture, weights: &[f64], observations: &[Observation]) -> bool {
    let joint: Vec<f64> = before
        .components()
        .iter()
        .map(|c| c.weight * evidence(&c.primitive, observations).exp())
        .collect();
    let sum: f64 = joint.iter().sum();
    let pairs = joint.iter().zip(weights);
    let error = pairs.map(|(j, w)| (j / sum - w).abs()).fold(0.0, f64::max);
    println!("weights {weights:?}, off by {error:.1e}");
    error < 1e-11
}

fn weights(mixture: &Mixture) -> Vec<f64> {
    mixture.components().iter().map(|c| c.weight).collect()
}

#[test]
fn weights_are_those_of_bayes() {
    for estimator in [
        Estimator::default(),
        Estimator::Oas,
        Estimator::MaximumLikelihood,
    ] {
        let mixture = toy::labelled([12, 16], 2.0, estimator);
        let observations = observations();
        let conditioned = mixture.condition(&observations).unwrap();
        assert!(are_bayes(&mixture, &weights(&conditioned), &observations));
        // What is not looked at, or not made a probability, is seen.
        assert!(!are_bayes(&mixture, &weights(&mixture), &observations));
        let raw = mixture
            .components()
            .iter()
            .map(|c| c.weight * c.primitive.log_evidence(&observations).unwrap().exp());
        assert!(!are_bayes(
            &mixture,
            &raw.collect::<Vec<_>>(),
            &observations
        ));
        // One after the other, and the other way round.
        let mut sequence = mixture.clone();
        for observation in observations.iter().rev() {
            sequence = sequence
                .condition(std::slice::from_ref(observation))
                .unwrap();
        }
        for (one, other) in weights(&sequence).iter().zip(weights(&conditioned)) {
            assert!((one - other).abs() < 1e-11, "{one} {other}");
        }
        // Each component is conditioned by itself.
        for (before, after) in mixture.components().iter().zip(conditioned.components()) {
            let alone = before.primitive.condition(&observations).unwrap();
            assert_eq!(after.primitive, alone);
        }
    }
}

#[test]
fn a_value_that_only_one_kind_has_leaves_that_one() {
    let mixture = toy::labelled([12, 16], 6.0, Estimator::default());
    let large = [Observation::modulus("elbow", 1, 0.35)];
    let conditioned = mixture.condition(&large).unwrap();
    assert!(conditioned.component("large").unwrap().weight > 0.999);
    // Nobody's.
    assert!(
        mixture
            .condition(&[Observation::modulus("hip", 1, 0.1)])
            .is_err()
    );
    assert!(
        mixture
            .condition(&[Observation::modulus("elbow", 1, -0.1)])
            .is_err()
    );
}

#[test]
fn densities_follow_bayes_rule_and_responsibilities_sum_to_one() {
    let mixture = toy::labelled([12, 16], 2.0, Estimator::default());
    let wish = [Observation::offset("shoulder", 0.2).within(0.05)];
    let conditioned = mixture.condition(&wish).unwrap();
    for wave in toy::waves([5, 5], 2.0, 9) {
        let example = Example::from(&wave);
        let shares = mixture.responsibilities(&example).unwrap();
        assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        // p(x) / p(x | b) = p(b) / p(b | x).
        let residual = (wave.offsets()[0] - 0.2) / 0.05;
        let of_wish = -0.5 * (residual * residual + std::f64::consts::TAU.ln()) - 0.05f64.ln();
        let terms = mixture
            .components()
            .iter()
            .map(|c| c.weight * c.primitive.log_evidence(&wish).unwrap().exp());
        let expected = mixture.log_density(&example).unwrap() + of_wish - terms.sum::<f64>().ln();
        let found = conditioned.log_density(&example).unwrap();
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        // An exact value that it has not.
        let exact = mixture
            .condition(&[Observation::offset("shoulder", 0.2)])
            .unwrap();
        assert_eq!(exact.log_density(&example).unwrap(), f64::NEG_INFINITY);
        assert!(exact.responsibilities(&example).is_err());
    }
}

#[test]
fn the_density_is_that_of_a_dense_gaussian_with_phases_on_the_circle() {
    let mixture = toy::labelled([12, 16], 2.0, Estimator::default());
    for wave in toy::waves([5, 5], 2.0, 9) {
        for component in mixture.components() {
            let (chart, gaussian) = (component.primitive.chart(), component.primitive.gaussian());
            let n = chart.dimension();
            let mut deviation = chart.vector(&wave).unwrap() - gaussian.mean();
            for i in 4..8 {
                let turns = (deviation[i] / std::f64::consts::TAU).round();
                deviation[i] -= turns * std::f64::consts::TAU;
            }
            let sigma = gaussian.covariance() + DMatrix::identity(n, n) * 1e-6;
            let expected = log_normal(&deviation, &sigma);
            let found = component
                .primitive
                .log_density(&Example::from(&wave))
                .unwrap();
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        }
    }
}

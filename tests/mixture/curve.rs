//! Learning curves, and what a demonstration is worth.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use undulate::{
    Estimator, Example, FourierMovementPrimitive, LearnOptions, LearningCurve, LoneEnd, Seen, Wave,
};

use crate::dense::log_normal;
use crate::toy;

const TARGET: Estimator = Estimator::Kronecker { weight: Some(1.0) };

/// ln p(x | its largest modulus) a dimension, of a model without faint or uniform phases.
fn conditional(primitive: &FourierMovementPrimitive, wave: &Wave) -> f64 {
    let (chart, gaussian) = (primitive.chart(), primitive.gaussian());
    let n = chart.dimension();
    let x = chart.vector(wave).unwrap();
    let mut deviation = &x - gaussian.mean();
    for i in 4..8 {
        deviation[i] -= (deviation[i] / std::f64::consts::TAU).round() * std::f64::consts::TAU;
    }
    let sigma = gaussian.covariance();
    let all = log_normal(&deviation, &(&sigma + DMatrix::identity(n, n) * 1e-6));
    let largest = (0..4).max_by(|a, b| x[*a].total_cmp(&x[*b])).unwrap();
    let own = log_normal(
        &DVector::from_element(1, deviation[largest]),
        &DMatrix::from_element(1, 1, sigma[(largest, largest)]),
    );
    (all - own) / (n - 1) as f64
}

#[test]
fn the_last_point_is_each_demonstration_against_all_others() {
    let waves = toy::waves([12, 0], 0.0, 4);
    let (examples, form) = toy::form(&waves);
    let curve = LearningCurve::of(&examples, &form, TARGET, 1, 0).unwrap();
    let options = LearnOptions {
        estimator: TARGET,
        ..LearnOptions::default()
    };
    let scores = (0..waves.len()).map(|m| {
        let mut rest = waves.clone();
        let left_out = rest.remove(m);
        conditional(
            &FourierMovementPrimitive::from_waves(&rest, &options).unwrap(),
            &left_out,
        )
    });
    let expected = scores.sum::<f64>() / waves.len() as f64;
    let last = curve.points().last().unwrap();
    assert_eq!(last.demonstrations, waves.len() - 1);
    let error = (last.density.mean - expected).abs();
    assert!(error < 1e-8, "{} {expected}", last.density.mean);
}

#[test]
fn more_demonstrations_are_seen_to_help_as_long_as_they_do() {
    let sizes = |count| {
        let (examples, form) = toy::form(&toy::waves([count, 0], 0.0, 6));
        LearningCurve::of(&examples, &form, TARGET, 4, 0).unwrap()
    };
    let (few, many) = (sizes(9), sizes(60));
    println!("{:?}\n{:?}", few.last_doubling(), many.last_doubling());
    let rise = |curve: &LearningCurve| curve.last_doubling().unwrap().mean;
    assert!(few.last_doubling().unwrap().is_certain());
    assert!(rise(&many) < 0.3 * rise(&few));
    let next = few.next_doubling().unwrap();
    assert_eq!(next.mean, rise(&few) / 2.0);
    assert!(sizes(4).last_doubling().is_none());
    let (examples, form) = toy::form(&toy::waves([3, 0], 0.0, 6));
    assert!(LearningCurve::of(&examples, &form, TARGET, 4, 0).is_err());
    assert!(LearningCurve::worth(&examples, &form, TARGET).is_err());
}

#[test]
fn a_demonstration_that_spoils_the_set_is_worth_least() {
    let mut waves = toy::waves([14, 0], 0.0, 8);
    // The elbow the other way round, and bent.
    let spoilt = &waves[5];
    let mut weights = spoilt.weights().clone();
    weights.row_mut(1).apply(|w| *w *= Complex::new(-3.0, 0.0));
    let offsets = spoilt.offsets() + DVector::from_vec(vec![0.0, 1.5]);
    waves[5] = Wave::new(spoilt.joints().clone(), spoilt.period(), offsets, weights).unwrap();
    let (examples, form) = toy::form(&waves);
    let worth = LearningCurve::worth(&examples, &form, TARGET).unwrap();
    for (m, w) in worth.iter().enumerate() {
        println!("{m}: {:.4} +- {:.4}", w.mean, w.error);
    }
    let least = (0..worth.len()).min_by(|a, b| worth[*a].mean.total_cmp(&worth[*b].mean));
    assert_eq!(least, Some(5));
    assert!(worth[5].mean < -2.0 * worth[5].error);
}

#[test]
fn the_lonely_end_is_told() {
    let waves = toy::waves([10, 0], 0.0, 2);
    let mut slow = waves[3].clone();
    let scaled = DVector::from_vec(vec![-2.5, slow.offsets()[1]]);
    slow = Wave::new(
        slow.joints().clone(),
        slow.period(),
        scaled,
        slow.weights().clone(),
    )
    .unwrap();
    let mut examples: Vec<Example> = waves.iter().map(Example::from).collect();
    examples[3] = Example::from(&slow);
    let ends = LoneEnd::all(&examples).unwrap();
    let first = &ends[0];
    assert_eq!(first.seen, Seen::Posture("shoulder".into()));
    assert!(!first.is_high && first.value == -2.5 && first.demonstration == 3);
    let offsets: Vec<f64> = examples.iter().map(|e| e.wave.offsets()[0]).collect();
    let mean = offsets.iter().sum::<f64>() / 10.0;
    let squares: f64 = offsets.iter().map(|o| (o - mean).powi(2)).sum();
    let leverage = 0.1 + (-2.5 - mean).powi(2) / squares;
    assert!((first.leverage - leverage).abs() < 1e-12);
    assert!(ends.windows(2).all(|e| e[0].leverage >= e[1].leverage));
    assert!(
        ends.iter()
            .all(|e| (0.1..=1.0 + 1e-12).contains(&e.leverage))
    );
    // All have one tempo: nothing to record.
    assert!(ends.iter().all(|e| e.seen != Seen::Tempo));
    assert!(LoneEnd::all(&examples[..2]).is_err());
}

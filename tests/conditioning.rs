//! Conditioning against the textbook Schur complement in double-double arithmetic (`common/schur.rs`), on observations whose rows are
//! made from the definition of the chart (`common/asked.rs`).

use nalgebra::{DMatrix, DVector};
use rand::distr::Distribution;
use undulate::testing::{Seed, gaussian};
use undulate::{
    Estimator, FourierMovementPrimitive, Gaussian, LearnOptions, LinearObservation, Observation,
    OffsetForm, Offsets, stream, synthetic,
};

#[path = "common/asked.rs"]
mod asked;
#[path = "common/double_double.rs"]
mod double_double;
#[path = "common/schur.rs"]
mod schur;
use asked::{Asked, asked};
use schur::{Moments, TEXTBOOK, Textbook, error, schur};

/// Of means and covariances, normwise; as they are, and in units of the prior's standard deviations.
const TOLERANCE: f64 = 1e-9;

const HARMONICS: usize = 25;

fn learned(estimator: Estimator, harmonics: usize) -> FourierMovementPrimitive {
    let options = match estimator {
        Estimator::MaximumLikelihood => LearnOptions::paper(),
        estimator => LearnOptions {
            estimator,
            ..LearnOptions::default()
        },
    };
    FourierMovementPrimitive::learn_with(&synthetic(0).unwrap(), harmonics, &options).unwrap()
}

fn kronecker() -> Estimator {
    Estimator::Kronecker { weight: Some(0.4) }
}

fn exact(_: usize) -> f64 {
    0.0
}

/// Every third has a standard deviation.
fn mixed(i: usize) -> f64 {
    if i % 3 == 2 {
        0.05 + 0.01 * (i % 7) as f64
    } else {
        0.0
    }
}

fn split(asked: &[Asked]) -> (Vec<Observation>, Vec<LinearObservation>) {
    asked.iter().cloned().unzip()
}

fn agrees(what: &str, primitive: &FourierMovementPrimitive, asked: &[Asked]) {
    let (observations, linear) = split(asked);
    let prior = primitive.gaussian();
    let found = Moments::of(&primitive.condition(&observations).unwrap());
    let error = error(prior, &found, &schur(prior, &linear, &TEXTBOOK));
    println!("{what}, {} observations: {error:.1e}", asked.len());
    assert!(error < TOLERANCE, "{what}: {error:e}");
}

#[test]
fn structured_covariances_are_conditioned_as_the_textbook_says() {
    let estimators = [kronecker(), Estimator::LowRankKronecker, Estimator::Oas];
    for estimator in estimators {
        let primitive = learned(estimator, HARMONICS);
        let (all_exact, some) = (asked(&primitive, exact), asked(&primitive, mixed));
        agrees(&format!("{estimator}, exact"), &primitive, &all_exact[..1]);
        // One in seven: all kinds, harmonics 1 to 19.
        let few: Vec<Asked> = some.iter().step_by(7).take(14).cloned().collect();
        agrees(&format!("{estimator}, mixed"), &primitive, &few);
        agrees(&format!("{estimator}, mixed"), &primitive, &some);
        agrees(&format!("{estimator}, exact"), &primitive, &all_exact);
    }
}

#[test]
fn offsets_that_are_learned_as_logarithms_are_conditioned_as_such() {
    let options = LearnOptions {
        estimator: kronecker(),
        offsets: Offsets::ByData,
        ..LearnOptions::default()
    };
    let primitive =
        FourierMovementPrimitive::learn_with(&synthetic(0).unwrap(), 5, &options).unwrap();
    let forms = primitive.chart().offset_forms();
    assert!(forms.iter().any(|form| *form != OffsetForm::Signed));
    let all = asked(&primitive, |i| mixed(i) + 0.05);
    let offsets: Vec<Asked> = all.into_iter().skip(4).step_by(5).collect();
    agrees("logarithmic offsets", &primitive, &offsets);
}

/// The 14 of the observations that a pivoted QR of the standardised rows A F picks, and the condition number of V = A Sigma A^T for them.
fn well_conditioned(primitive: &FourierMovementPrimitive, asked: &[Asked]) -> (Vec<Asked>, f64) {
    let factor = primitive.gaussian().factor();
    let rows = asked.iter().map(|(_, linear)| {
        let mut row = DVector::zeros(factor.ncols());
        for (i, c) in &linear.row {
            row.axpy(*c, &factor.row(*i).transpose(), 1.0);
        }
        row.normalize()
    });
    let rows = DMatrix::from_columns(&rows.collect::<Vec<_>>());
    let mut left = rows.clone();
    let mut picked = Vec::new();
    while picked.len() < factor.ncols() {
        let norms = left.column_iter().map(|c| c.norm());
        let best = DVector::from_iterator(left.ncols(), norms).imax();
        let direction = left.column(best).normalize();
        let shares = left.tr_mul(&direction);
        left.ger(-1.0, &direction, &shares, 1.0);
        left.column_mut(best).fill(0.0);
        picked.push(best);
    }
    let singular = rows.select_columns(&picked).singular_values();
    let condition = (singular.max() / singular.min()).powi(2);
    (
        picked.iter().map(|i| asked[*i].clone()).collect(),
        condition,
    )
}

#[test]
fn the_fourteen_directions_of_fifteen_demonstrations_are_conditioned_as_the_textbook_says() {
    let primitive = learned(Estimator::MaximumLikelihood, HARMONICS);
    let all_exact = asked(&primitive, exact);
    agrees("ml, exact", &primitive, &all_exact[..1]);
    let (fourteen, condition) = well_conditioned(&primitive, &all_exact);
    println!("condition number of the standardised V: {condition:.1e}");
    assert!(condition < 1e4, "{condition:e}");
    // Nothing is left to vary.
    agrees("ml, exact", &primitive, &fourteen);
    agrees(
        "ml, inexact",
        &primitive,
        &asked(&primitive, |i| mixed(i) + 0.05),
    );
    // One hundred exact values that no combination of fifteen demonstrations has.
    let (mut observations, _) = split(&all_exact);
    for observation in observations.iter_mut().step_by(5) {
        observation.value *= 1.1;
    }
    let refused = primitive.condition(&observations).unwrap_err().to_string();
    let named = |o: &Observation| refused.contains(&format!("condition {o}"));
    assert!(observations.iter().any(named), "{refused}");
    for word in ["contradicts", "a residual of "] {
        assert!(refused.contains(word), "{refused}");
    }
    println!("{refused}");
}

#[test]
fn a_wrong_textbook_does_not_agree() {
    let primitive = learned(kronecker(), HARMONICS);
    let (observations, linear) = split(&asked(&primitive, mixed)[..14]);
    let found = Moments::of(&primitive.condition(&observations).unwrap());
    let wrong_sign = Textbook {
        sign: 1.0,
        ..TEXTBOOK
    };
    let variance_for_deviation = Textbook {
        variance: |deviation| deviation.powi(4),
        ..TEXTBOOK
    };
    for twin in [wrong_sign, variance_for_deviation] {
        let prior = primitive.gaussian();
        let error = error(prior, &found, &schur(prior, &linear, &twin));
        println!("broken: {error:.1e}");
        assert!(error > 1e3 * TOLERANCE, "{error:e}");
    }
}

#[test]
fn order_does_not_matter_and_what_is_exact_is_met() {
    for estimator in [kronecker(), Estimator::LowRankKronecker, Estimator::Oas] {
        let primitive = learned(estimator, HARMONICS);
        let (observations, linear) = split(&asked(&primitive, mixed));
        let batch = primitive.condition(&observations).unwrap();
        let one_by_one = |order: &mut dyn Iterator<Item = &Observation>| {
            order.fold(primitive.clone(), |given, o| {
                given.condition(std::slice::from_ref(o)).unwrap()
            })
        };
        let expected = Moments::of(&batch);
        for (what, other) in [
            ("one by one", one_by_one(&mut observations.iter())),
            ("reversed", one_by_one(&mut observations.iter().rev())),
        ] {
            let error = error(primitive.gaussian(), &Moments::of(&other), &expected);
            println!("{estimator}, {what}: {error:.1e}");
            assert!(error < TOLERANCE, "{estimator}, {what}: {error:e}");
        }
        // A mu' = b and A Sigma' A^T = 0, in units of the prior's standard deviations of A x.
        let prior = primitive.gaussian().prior_covariance().dense();
        let along = |sigma: &DMatrix<f64>, a: &LinearObservation, b: &LinearObservation| -> f64 {
            let pairs = a.row.iter().flat_map(|x| b.row.iter().map(move |y| (x, y)));
            pairs.map(|((i, c), (j, d))| c * d * sigma[(*i, *j)]).sum()
        };
        let (mut worst_mean, mut worst_covariance) = (0f64, 0f64);
        let exact: Vec<_> = linear.iter().filter(|o| o.deviation == 0.0).collect();
        for a in &exact {
            let unit = along(&prior, a, a).sqrt();
            let mean: f64 = a.row.iter().map(|(i, c)| c * expected.mean[*i]).sum();
            worst_mean = worst_mean.max((mean - a.value).abs() / (unit + a.value.abs()));
            for b in &exact {
                let left = along(&expected.covariance, a, b);
                let units = unit * along(&prior, b, b).sqrt();
                worst_covariance = worst_covariance.max(left.abs() / units);
            }
        }
        println!(
            "{estimator}: A mu' = b to {worst_mean:.1e}, A Sigma' A^T = 0 to {worst_covariance:.1e}"
        );
        assert!(worst_mean < 1e-12 && worst_covariance < 1e-12);
    }
}

#[test]
fn a_conditioned_primitive_comes_back_from_its_file_to_the_last_bit() {
    let primitive = learned(kronecker(), HARMONICS);
    let (observations, _) = split(&asked(&primitive, mixed));
    // In two batches, so that the file holds the order of elimination and not that of the call.
    let conditioned = primitive.condition(&observations[..9]).unwrap();
    let conditioned = conditioned.condition(&observations[9..]).unwrap();
    let text = conditioned.to_json();
    let read = FourierMovementPrimitive::from_json(&text).unwrap();
    assert_eq!(read, conditioned);
    assert_eq!(read.to_json(), text);
    let bits = |primitive: &FourierMovementPrimitive| -> Vec<u64> {
        let wave = primitive.sample(&mut stream(3, 0));
        let weights = wave.weights().iter().flat_map(|w| [w.re, w.im]);
        let numbers = weights.chain(wave.offsets().iter().copied());
        numbers.map(f64::to_bits).collect()
    };
    assert_eq!(bits(&read), bits(&conditioned));
}

/// Probability that true draws raise an alarm.
const FALSE_ALARM: f64 = 1e-6;
const DRAWS: u64 = 4000;
const SEED: u64 = 20;

#[test]
fn draws_have_the_mean_and_covariance_that_the_textbook_states() {
    let primitive = learned(kronecker(), 3);
    let asked = asked_of_three_harmonics(&primitive);
    let (observations, linear) = split(&asked);
    let prior = primitive.gaussian();
    let stated = schur(prior, &linear, &TEXTBOOK);
    // A factor of the oracle's covariance; the exact observation leaves one direction without variance.
    let eigen = stated.covariance.symmetric_eigen();
    let roots = eigen
        .eigenvalues
        .map(|v| if v > 1e-12 { v.sqrt() } else { 0.0 });
    let factor = &eigen.eigenvectors * DMatrix::from_diagonal(&roots);
    let stated = Gaussian::new(stated.mean, factor).unwrap();
    let draws = |primitive: &FourierMovementPrimitive| -> Vec<DVector<f64>> {
        let draw = |k| primitive.gaussian().sample(&mut stream(SEED, k));
        (0..DRAWS).map(draw).collect()
    };
    let conditioned = primitive.condition(&observations).unwrap();
    gaussian(&draws(&conditioned), &stated, FALSE_ALARM)
        .unwrap_or_else(|alarm| panic!("{}", alarm.of(Seed(SEED))));

    // A sampler that forgets the noise of the inexact observation in Matheron's rule, and one that forgets to project at all.
    let exactly: Vec<Observation> = observations.into_iter().map(|o| o.within(0.0)).collect();
    let mut forgetful = draws(&primitive.condition(&exactly).unwrap());
    let shift = stated.mean() - primitive.condition(&exactly).unwrap().gaussian().mean();
    forgetful.iter_mut().for_each(|x| *x += &shift);
    let alarm = gaussian(&forgetful, &stated, FALSE_ALARM).unwrap_err();
    assert_eq!(alarm.what, "variance", "{alarm}");
    let mut unprojected = draws(&primitive);
    let shift = stated.mean() - prior.mean();
    unprojected.iter_mut().for_each(|x| *x += &shift);
    let alarm = gaussian(&unprojected, &stated, FALSE_ALARM).unwrap_err();
    assert_eq!(alarm.what, "span", "{alarm}");
}

/// One exact modulus, and one ratio with a standard deviation of the size of its own.
fn asked_of_three_harmonics(primitive: &FourierMovementPrimitive) -> Vec<Asked> {
    let asked = asked(primitive, |i| if i == 2 { 0.3 } else { 0.0 });
    vec![asked[0].clone(), asked[2].clone()]
}

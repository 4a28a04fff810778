//! Expectation maximisation against the same on dense matrices.

use undulate::{
    Estimator, FourierMovementPrimitive, Grouping, GroupingOptions, Kinds, LearnOptions, Mixture,
    PhaseForm, synthetic,
};

use crate::dense::{Twin, expectation_maximization};
use crate::toy;

/// Whether every step, and what it came to, is that of the plain formulas; kinds that overlap, so that nothing is all or nothing.
fn agrees(twin: Twin) -> bool {
    let mut agrees = true;
    for (apart, seed) in [(1.5, 1), (2.0, 2), (3.0, 5)] {
        let waves = toy::waves([9, 12], apart, seed);
        let (examples, form) = toy::form(&waves);
        let guess = toy::guess(waves.len(), seed);
        let found = Grouping::refine(&examples, &form, guess.clone()).unwrap();
        let steps = found.log_likelihoods().len();
        assert!(steps > 2, "{steps}");
        let plain = expectation_maximization(&waves, &guess, steps, twin);
        let error = |(a, b): (&f64, &f64)| (a - b).abs() / (1.0 + b.abs());
        let of_steps = found.log_likelihoods().iter().zip(&plain.log_likelihoods);
        let of_steps = of_steps.map(error).fold(0.0, f64::max);
        // By weight, as they are told.
        let mut expected = plain.responsibilities;
        if expected.column(0).sum() < expected.column(1).sum() {
            expected.swap_columns(0, 1);
        }
        let of_shares = (found.responsibilities() - expected).amax();
        println!("{steps} steps: log-likelihoods {of_steps:.1e}, responsibilities {of_shares:.1e}");
        agrees &= of_steps < 1e-10 && of_shares < 1e-8;
    }
    agrees
}

#[test]
fn steps_are_those_of_the_formulas() {
    assert!(agrees(Twin::Sound));
}

#[test]
fn other_formulas_are_caught() {
    assert!(!agrees(Twin::PhasesNotWrapped));
    assert!(!agrees(Twin::NotNormalized));
    assert!(!agrees(Twin::NotPooled));
}

#[test]
fn the_likelihood_rises_and_probabilities_sum_to_one() {
    for seed in 0..10 {
        let waves = toy::waves([7, 9], 2.0, seed);
        let (examples, form) = toy::form(&waves);
        let guess = toy::guess(waves.len(), seed);
        let Ok(found) = Grouping::refine(&examples, &form, guess) else {
            continue;
        };
        let rises = found.log_likelihoods().windows(2).all(|l| l[1] > l[0]);
        assert!(rises, "{:?}", found.log_likelihoods());
        for row in found.responsibilities().row_iter() {
            assert!((row.sum() - 1.0).abs() < 1e-12);
        }
        let kinds = found.responsibilities().column_iter();
        assert!(kinds.map(|kind| kind.sum()).all(|sum| sum >= 2.5));
    }
}

#[test]
fn one_kind_is_the_plain_primitive() {
    let waves = synthetic(2).unwrap().fit(8).unwrap();
    for phases in [
        PhaseForm::Relative,
        PhaseForm::Recentred,
        PhaseForm::Principal,
    ] {
        for estimator in Estimator::ALL {
            let options = LearnOptions {
                phases,
                estimator,
                ..LearnOptions::default()
            };
            let examples = options.examples(&waves).unwrap();
            let form = options.form(&examples).unwrap();
            let one = GroupingOptions {
                kinds: Kinds::Number(1),
                ..GroupingOptions::default()
            };
            let grouping = Grouping::find(&examples, &form, &one).unwrap();
            let mixture = Mixture::learn(&examples, &form, estimator, &grouping).unwrap();
            let plain = FourierMovementPrimitive::from_waves(&waves, &options).unwrap();
            assert_eq!(
                mixture.components()[0].primitive,
                plain,
                "{phases} {estimator}"
            );
            assert_eq!(mixture.components()[0].weight, 1.0);
        }
    }
}

#[test]
fn known_kinds_are_the_primitives_of_their_demonstrations() {
    let waves = toy::waves([6, 8], 4.0, 3);
    let mixture = toy::labelled([6, 8], 4.0, Estimator::default());
    for (name, own) in [("small", &waves[..6]), ("large", &waves[6..])] {
        let plain = FourierMovementPrimitive::from_waves(own, &LearnOptions::default()).unwrap();
        let component = mixture.component(name).unwrap();
        assert_eq!(component.primitive, plain);
        assert_eq!(component.weight, own.len() as f64 / 14.0);
    }
    let error = mixture.component("huge").unwrap_err().to_string();
    assert!(error.contains("small, large"), "{error}");
}

#[test]
fn a_kind_that_collapses_is_refused() {
    let waves = toy::waves([6, 2], 30.0, 1);
    let (examples, form) = toy::form(&waves);
    let of = |kinds| {
        let options = GroupingOptions {
            kinds: Kinds::Number(kinds),
            ..GroupingOptions::default()
        };
        Grouping::find(&examples, &form, &options)
    };
    // Hardly of a kind, all of them: as many as you like are none.
    let faint = nalgebra::DMatrix::from_fn(8, 2, |_, c| [1.0 - 1e-6, 1e-6][c]);
    let error = Grouping::refine(&examples, &form, faint)
        .unwrap_err()
        .to_string();
    assert!(error.contains("left with 0.0"), "{error}");
    // Two of them are far from all others, so every start leaves them alone.
    let error = of(2).unwrap_err().to_string();
    assert!(error.contains("one of 2 kinds is left with 2.0"), "{error}");
    assert!(of(3).unwrap_err().to_string().contains("3 kinds of 8"));
    assert!(of(0).is_err());
    let found = Grouping::find(&examples, &form, &GroupingOptions::default()).unwrap();
    assert_eq!(found.names(), ["a"]);
}

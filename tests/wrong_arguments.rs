//! Wrong arguments to assertions and strategies panic and are named; wrong samples raise an alarm.

use std::panic::{AssertUnwindSafe, catch_unwind};

use nalgebra::{DMatrix, DVector, dmatrix, dvector};
use undulate::testing::{
    Family, Seed, bounded_mean, circular_mean, circular_spread, covariance, covariances,
    demonstrate_below, demonstrations, distribution, energy, factors, gaussian, gaussians,
    independence, mean, observations, primitives, quantile, refute_above, retest, trees, waves,
};
use undulate::{FourierMovementPrimitive, Gaussian, LearnOptions, synthetic};

/// Whether the call panics, and names the argument; what it says.
fn names(argument: &str, call: impl FnOnce()) -> String {
    let panic = catch_unwind(AssertUnwindSafe(call)).expect_err(argument);
    let message = panic.downcast_ref::<String>().cloned();
    let message = message.or(panic.downcast_ref::<&str>().map(|m| (*m).to_owned()));
    let message = message.unwrap_or_default();
    assert!(
        message.starts_with(argument),
        "expected `{argument}`: {message}"
    );
    message
}

#[test]
fn wrong_arguments_of_assertions_are_named() {
    let line = Gaussian::new(dvector![0.0], dmatrix![1.0]).unwrap();
    let few = vec![dvector![0.0]; 3];
    let two = [0.5, 0.5];
    let zero = dvector![0.0];
    for wrong in [0.0, 1.0, -0.1, f64::NAN] {
        let samples: Vec<DVector<f64>> = vec![dvector![0.0]; 100];
        let numbers = [0.5; 100];
        names("false_alarm", || drop(gaussian(&samples, &line, wrong)));
        names("false_alarm", || drop(mean(&samples, &zero, wrong)));
        names("false_alarm", || {
            drop(covariance(&samples, &dmatrix![1.0], wrong))
        });
        names("false_alarm", || {
            drop(bounded_mean(&numbers, (0.0, 1.0), 0.5, wrong))
        });
        names("false_alarm", || drop(distribution(&numbers, |x| x, wrong)));
        names("false_alarm", || drop(quantile(&numbers, 0.5, 0.5, wrong)));
        names("probability", || drop(quantile(&numbers, wrong, 0.5, 0.1)));
        names("false_alarm", || {
            drop(circular_mean(&numbers, 0.0, 0.5, wrong))
        });
        names("resultant", || {
            drop(circular_spread(&numbers, 0.0, wrong, 0.1))
        });
        names("false_alarm", || {
            drop(independence(&numbers, &numbers, wrong))
        });
        names("false_alarm", || {
            drop(energy(&samples, &samples, 99, Seed(0), wrong))
        });
        names("confidence", || drop(demonstrate_below(0, 9, 0.5, wrong)));
        names("p", || drop(refute_above(0, 9, wrong, 0.1)));
        names("budget", || _ = Family::new(wrong, 1));
        names("false_alarm", || {
            drop(retest(wrong, 2, 9, |_| (), |(), _| Ok(())))
        });
    }
    // Too few to mean anything.
    names("samples", || drop(gaussian(&few, &line, 0.01)));
    names("samples", || drop(mean(&few, &zero, 0.01)));
    names("samples", || drop(covariance(&few, &dmatrix![1.0], 0.01)));
    for numbers in [&two[..], &[]] {
        names("samples", || {
            drop(bounded_mean(numbers, (0.0, 1.0), 0.5, 0.01))
        });
        names("samples", || drop(distribution(numbers, |x| x, 0.01)));
        names("samples", || drop(quantile(numbers, 0.5, 0.5, 0.01)));
        names("samples", || drop(circular_mean(numbers, 0.0, 0.5, 0.01)));
        names("samples", || drop(circular_spread(numbers, 0.0, 0.5, 0.01)));
        names("samples", || drop(independence(numbers, numbers, 0.01)));
    }
    names("samples", || drop(energy(&few, &few, 999, Seed(0), 0.01)));
    names("permutations", || {
        drop(energy(&few, &few, 98, Seed(0), 0.01))
    });
    names("trials", || drop(demonstrate_below(0, 10, 0.01, 0.99)));
    names("trials", || drop(refute_above(0, 1, 0.1, 0.01)));
    names("trials", || drop(refute_above(0, 0, 0.1, 0.01)));
    names("failures", || drop(refute_above(3, 2, 0.1, 0.01)));
    // Of another kind.
    names("samples", || {
        drop(gaussian(&[dvector![0.0, 0.0]], &line, 0.01))
    });
    names("covariance", || {
        drop(covariance(&few, &DMatrix::zeros(1, 1), 0.01))
    });
    // Half of it would not be looked at.
    names("covariance", || {
        let skew = DMatrix::from_row_slice(2, 2, &[1.0, 0.9, 0.0, 1.0]);
        drop(covariance(&vec![dvector![0.0, 1.0]; 99], &skew, 0.01))
    });
    names("mean", || {
        let none = dvector![f64::NAN];
        drop(mean(&vec![dvector![0.0]; 99], &none, 0.01))
    });
    names("mean", || drop(bounded_mean(&two, (0.0, 1.0), 1.0, 0.01)));
    names("support", || {
        drop(bounded_mean(&two, (1.0, 0.0), 0.5, 0.01))
    });
    names("distribution", || {
        drop(distribution(&[2.0; 100], |x| x, 0.01))
    });
    names("y", || drop(independence(&two, &[], 0.01)));
    names("tests", || _ = Family::new(0.1, 0));
    names("rounds", || drop(retest(0.1, 0, 9, |_| (), |(), _| Ok(()))));
    names("rounds", || drop(retest(0.5, 9, 9, |_| (), |(), _| Ok(()))));
}

/// An assertion about numbers, or about the vectors of one entry that they are.
type Assertion<'a> = &'a dyn Fn(&[f64], &[DVector<f64>]);

/// What is said to be needed is enough, and one less is not.
#[test]
fn too_few_samples_are_told_how_many_are_needed() {
    let line = Gaussian::new(dvector![0.5], dmatrix![1.0]).unwrap();
    let assertions: [Assertion; 10] = [
        &|_, x| drop(gaussian(x, &line, 0.01)),
        &|_, x| drop(mean(x, line.mean(), 0.01)),
        &|_, x| drop(covariance(x, &dmatrix![1.0], 0.01)),
        &|x, _| drop(bounded_mean(x, (0.0, 1.0), 0.5, 0.01)),
        &|x, _| drop(distribution(x, |x| x, 0.01)),
        &|x, _| drop(quantile(x, 0.2, 0.5, 0.01)),
        &|x, _| drop(circular_mean(x, 0.5, 0.2, 0.01)),
        &|x, _| drop(circular_spread(x, 0.5, 0.2, 0.01)),
        &|x, _| drop(independence(x, x, 0.01)),
        &|_, x| drop(energy(x, x, 99, Seed(0), 0.01)),
    ];
    for assertion in assertions {
        // True draws for some: what comes after the first test is reached.
        let asked = |n: usize| {
            let vectors: Vec<DVector<f64>> = (0..n)
                .map(|k| line.sample(&mut Seed(1).stream(k as u64)))
                .collect();
            let numbers: Vec<f64> = vectors.iter().map(|x| x[0].clamp(0.0, 1.0)).collect();
            assertion(&numbers, &vectors);
        };
        let needed = |n: usize| -> usize {
            let told = names("samples", || asked(n));
            let (_, needed) = told.split_once("at least ").expect("a number");
            needed.split(' ').next().unwrap().parse().unwrap()
        };
        let enough = needed(2);
        asked(enough);
        for too_few in [0, 1, enough - 1] {
            assert_eq!(needed(too_few), enough);
        }
    }
}

#[test]
#[allow(clippy::reversed_empty_ranges)]
fn strategies_that_can_draw_nothing_name_the_argument() {
    let options = LearnOptions::paper();
    let learned =
        FourierMovementPrimitive::learn_with(&synthetic(0).unwrap(), 5, &options).unwrap();
    names("joints", || _ = waves(0..=2, 1..=2));
    names("joints", || _ = waves(3..=2, 1..=2));
    names("harmonics", || _ = waves(1..=2, 0..=0));
    names("joints", || _ = primitives(2..=1, 1..=2, 1));
    names("joints", || _ = trees(0..=0));
    names("recordings", || _ = demonstrations(1..=1, 1..=1, 1..=3));
    names("dimension", || _ = gaussians(0, 1));
    names("rank", || _ = factors(2, 3, 1.0));
    names("condition", || _ = covariances(2, 2, 0.5));
    names("condition", || _ = covariances(2, 1, 2.0));
    names("count", || _ = observations(&learned, 1..=99));
}

#[test]
fn no_sample_that_is_no_number_passes() {
    let mut numbers = vec![0.5; 400];
    numbers[7] = f64::NAN;
    let vectors: Vec<DVector<f64>> = numbers.iter().map(|x| dvector![*x]).collect();
    let line = Gaussian::new(dvector![0.5], DMatrix::zeros(1, 1)).unwrap();
    for outcome in [
        gaussian(&vectors, &line, 0.01),
        mean(&vectors, &dvector![0.5], 0.01),
        covariance(&vectors, &dmatrix![1.0], 0.01),
        bounded_mean(&numbers, (0.0, 1.0), 0.5, 0.01),
        distribution(&numbers, |x| x, 0.01),
        quantile(&numbers, 0.5, 0.5, 0.01),
        circular_mean(&numbers, 0.5, 0.9, 0.01),
        circular_spread(&numbers, 0.5, 0.9, 0.01),
        independence(&numbers, &numbers, 0.01),
        energy(&vectors, &vectors, 99, Seed(0), 0.01),
    ] {
        let alarm = outcome.unwrap_err();
        assert_eq!(alarm.what, "a sample", "{alarm}");
    }
}

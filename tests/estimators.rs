//! Estimators of the covariance: the default against every other by the density of left-out demonstrations, shrinkage weights against the papers'
//! formulas on dense matrices, and demonstrations that say next to nothing.

mod common;

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use rand::distr::Distribution;
use undulate::{
    CsvOptions, Demonstrations, Duration, Estimator, Example, FourierMovementPrimitive, HeldOut,
    LearnOptions, PhaseForm, Recording, Wave, stream, synthetic,
};

/// How much worse than another the default may be \[nats a dimension\], beyond two standard errors.
const ALLOWED: f64 = 0.05;

const OTHERS: [Estimator; 6] = [
    Estimator::LedoitWolf,
    Estimator::Oas,
    Estimator::LowRankKronecker,
    Estimator::MaximumLikelihood,
    Estimator::Kronecker { weight: Some(0.4) },
    Estimator::Kronecker { weight: Some(1.0) },
];

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Each demonstration left out once, the default's weight chosen without it. Whether the default is nowhere worse.
fn default_is_no_worse(what: &str, demonstrations: &Demonstrations, harmonics: usize) -> bool {
    is_no_worse(Estimator::default(), what, demonstrations, harmonics)
}

fn is_no_worse(
    ours: Estimator,
    what: &str,
    demonstrations: &Demonstrations,
    harmonics: usize,
) -> bool {
    let waves = demonstrations.fit(harmonics).unwrap();
    let examples: Vec<Example> = waves.iter().map(Example::from).collect();
    let form = LearnOptions::default().form(&examples).unwrap();
    let mut scores = vec![Vec::new(); 1 + OTHERS.len()];
    for m in 0..examples.len() {
        let mut rest = examples.clone();
        let left_out = rest.remove(m);
        let held_out = HeldOut::new(&rest, &left_out, &form).unwrap();
        let ours = ours.chosen(&rest, &form).unwrap();
        for (scores, estimator) in scores.iter_mut().zip([ours].iter().chain(&OTHERS)) {
            scores.push(held_out.score(*estimator).unwrap());
        }
    }
    let count = waves.len() as f64;
    println!(
        "{what}, {count} demonstrations: {ours} {:.3} nats a dimension",
        mean(&scores[0])
    );
    let mut holds = true;
    for (estimator, other) in OTHERS.iter().zip(&scores[1..]) {
        let pairs = scores[0].iter().zip(other);
        let differences: Vec<f64> = pairs.map(|(ours, theirs)| ours - theirs).collect();
        let centre = mean(&differences);
        let squares: f64 = differences.iter().map(|d| (d - centre).powi(2)).sum();
        let error = (squares / (count - 1.0) / count).sqrt();
        let holds_here = centre >= -ALLOWED - 2.0 * error;
        let verdict = if holds_here { "" } else { "  TOO LITTLE" };
        println!("  less {estimator}: {centre:.3} +- {error:.3}{verdict}");
        holds &= holds_here;
    }
    holds
}

#[test]
fn the_default_is_no_worse_on_the_first_demonstrator() {
    let demonstrations = synthetic(0).unwrap();
    assert!(default_is_no_worse("seed 0", &demonstrations, 25));
    // Another default is caught.
    let other = Estimator::Kronecker { weight: Some(0.4) };
    assert!(!is_no_worse(other, "seed 0", &demonstrations, 25));
}

#[test]
fn the_default_is_no_worse_on_the_second_demonstrator() {
    assert!(default_is_no_worse("seed 1", &synthetic(1).unwrap(), 25));
}

#[test]
fn the_default_is_no_worse_on_real_recordings() {
    let Some(shared) = common::shared("estimators on real recordings") else {
        return;
    };
    let root = shared.join("waves");
    let lists = std::fs::read_dir(root.join("sets")).unwrap();
    let mut lists: Vec<_> = lists.map(|entry| entry.unwrap().path()).collect();
    lists.sort();
    let mut holds = true;
    for list in &lists[..5] {
        let files = Recording::files_listed(list, Some(&root)).unwrap();
        let open = |file| Recording::open(file, &CsvOptions::default()).unwrap();
        let recordings = files.iter().map(|file| open(file)).collect();
        let demonstrations = Demonstrations::new(recordings, Duration::Auto).unwrap();
        let samples = demonstrations.recordings().iter().map(|r| r.times().len());
        let harmonics = samples.min().unwrap().saturating_sub(2) / 2;
        let name = list.file_stem().unwrap().to_string_lossy();
        holds &= default_is_no_worse(&name, &demonstrations, harmonics.min(25));
    }
    assert!(holds);
}

fn learned(waves: &[Wave], phases: PhaseForm, estimator: Estimator) -> FourierMovementPrimitive {
    let options = LearnOptions {
        phases,
        estimator,
        ..LearnOptions::default()
    };
    FourierMovementPrimitive::from_waves(waves, &options).unwrap()
}

/// Ledoit and Wolf 2004, lemma 3.2 to 3.4: m, d^2, b^2 of the rows of X (n x p), with norms |A|^2 = tr(A A^T) / p.
fn ledoit_wolf(x: &DMatrix<f64>) -> f64 {
    let (n, p) = (x.nrows() as f64, x.ncols() as f64);
    let s = x.tr_mul(x) / n;
    let m = s.trace() / p;
    let d = (&s - DMatrix::identity(x.ncols(), x.ncols()) * m).norm_squared() / p;
    let each = x.row_iter().map(|row| {
        let product = row.transpose() * row;
        (product - &s).norm_squared() / p
    });
    let b = (each.sum::<f64>() / (n * n)).min(d);
    b / d
}

/// Chen, Wiesel, Eldar and Hero 2010, equation (23).
fn oas(x: &DMatrix<f64>) -> f64 {
    let (n, p) = (x.nrows() as f64, x.ncols() as f64);
    let s = x.tr_mul(x) / n;
    let (square, trace) = ((&s * &s).trace(), s.trace());
    let numerator = (1.0 - 2.0 / p) * square + trace * trace;
    (numerator / ((n + 1.0 - 2.0 / p) * (square - trace * trace / p))).min(1.0)
}

#[test]
fn shrinkage_weights_are_the_papers() {
    // Many harmonics of few demonstrations, and few of many.
    for (waves, harmonics) in [(15, 12), (6, 25), (15, 1)] {
        let waves = &synthetic(2).unwrap().fit(harmonics).unwrap()[..waves];
        // Principal phases are plain numbers: the vectors are all there is to it.
        let of = |estimator| learned(waves, PhaseForm::Principal, estimator);
        let chart = of(Estimator::Oas).chart().clone();
        let rows: Vec<_> = waves
            .iter()
            .map(|w| chart.vector(w).unwrap().transpose())
            .collect();
        let mut x = DMatrix::from_rows(&rows);
        let count = x.nrows() as f64;
        let mut scales = Vec::new();
        for mut column in x.column_iter_mut() {
            let centre = column.mean();
            column.add_scalar_mut(-centre);
            let scale = column.norm() / count.sqrt();
            column /= scale;
            scales.push(scale);
        }
        let scales = DMatrix::from_diagonal(&DVector::from_vec(scales));
        let correlation = x.tr_mul(&x) / count;
        let weights = [
            (Estimator::LedoitWolf, ledoit_wolf(&x)),
            (Estimator::Oas, oas(&x)),
        ];
        for (estimator, weight) in weights {
            assert!(weight > 0.01 && weight < 0.999, "{estimator}: {weight}");
            let shrunk =
                &correlation * (1.0 - weight) + DMatrix::identity(x.ncols(), x.ncols()) * weight;
            let expected = &scales * shrunk * &scales;
            let found = of(estimator).gaussian().covariance();
            let error = (&found - &expected).norm() / expected.norm();
            println!("{estimator} of {count} x {harmonics}: weight {weight:.4}, {error:.1e}");
            assert!(error < 1e-12, "{estimator}: {error:e}");
        }
    }
}

#[test]
fn all_estimators_keep_the_standard_deviations() {
    let waves = synthetic(2).unwrap().fit(25).unwrap();
    let of = |estimator| learned(&waves, PhaseForm::default(), estimator);
    let deviations = |estimator| -> Vec<f64> {
        let covariance = of(estimator).gaussian().covariance();
        covariance.diagonal().iter().map(|v| v.sqrt()).collect()
    };
    let expected = deviations(Estimator::MaximumLikelihood);
    for estimator in [Estimator::default()].into_iter().chain(OTHERS) {
        for (found, expected) in deviations(estimator).iter().zip(&expected) {
            let error = (found - expected).abs();
            assert!(error < 1e-12 * (1.0 + expected), "{estimator}: {error:e}");
        }
    }
}

/// A draw of every estimator, all numbers finite.
fn draws(waves: &[Wave]) -> Vec<(Estimator, Wave)> {
    let of = |estimator| {
        let primitive = learned(waves, PhaseForm::default(), estimator);
        let wave = primitive.sample(&mut stream(1, 0));
        let all = |w: &Wave| {
            let offsets = w.offsets().iter().all(|o| o.is_finite());
            offsets && w.weights().iter().all(|w| w.norm_sqr().is_finite())
        };
        assert!(all(&wave), "{estimator}");
        (estimator, wave)
    };
    let estimators = [Estimator::default()].into_iter().chain(OTHERS);
    estimators.map(of).collect()
}

/// The largest modulus of a difference.
fn distance(a: &Wave, b: &Wave) -> f64 {
    let offsets = (a.offsets() - b.offsets()).amax();
    let weights = a.weights() - b.weights();
    weights.iter().fold(offsets, |most, w| most.max(w.norm()))
}

#[test]
fn two_demonstrations_are_enough() {
    let waves = synthetic(0).unwrap().fit(8).unwrap();
    draws(&waves[..2]);
    let error = FourierMovementPrimitive::from_waves(&waves[..1], &LearnOptions::default());
    let error = error.unwrap_err().to_string();
    assert!(
        error.contains("1 demonstrations") && error.contains("at least two"),
        "{error}"
    );
    assert!(FourierMovementPrimitive::from_waves(&[], &LearnOptions::default()).is_err());
}

#[test]
fn identical_demonstrations_are_drawn_again() {
    let wave = synthetic(0).unwrap().fit(8).unwrap().swap_remove(0);
    for count in [2, 3, 5] {
        for (estimator, drawn) in draws(&vec![wave.clone(); count]) {
            let error = distance(&drawn, &wave);
            assert!(error < 1e-10, "{estimator}, {count}: {error:e}");
        }
    }
}

#[test]
fn a_harmonic_that_vanishes_stays_nothing() {
    let waves = synthetic(0).unwrap().fit(8).unwrap();
    let without = |wave: &Wave, value: f64| {
        let mut weights = wave.weights().clone();
        weights[(1, 4)] = Complex::new(value, 0.0);
        let offsets = wave.offsets().clone();
        Wave::new(wave.joints().clone(), wave.period(), offsets, weights).unwrap()
    };
    for value in [0.0, f64::MIN_POSITIVE, 1e-200] {
        let all: Vec<Wave> = waves.iter().map(|wave| without(wave, value)).collect();
        for (estimator, drawn) in draws(&all) {
            let modulus = drawn.weights()[(1, 4)].norm();
            assert!(modulus < 1e-11, "{estimator}: {modulus:e}");
        }
        // In one demonstration only.
        let mut one = waves.clone();
        one[0] = without(&one[0], value);
        draws(&one);
        // In half of them: logarithms from -2 to -27, of which nothing follows.
        let mut half = waves.clone();
        for wave in &mut half[..7] {
            *wave = without(wave, value);
        }
        let error = FourierMovementPrimitive::from_waves(&half, &LearnOptions::default());
        let error = error.unwrap_err().to_string();
        assert!(
            error.starts_with("modulus:shoulder_abduction:5: mean"),
            "{error}"
        );
    }
}

#[test]
fn the_weight_that_is_chosen_scores_best() {
    let waves = synthetic(0).unwrap().fit(4).unwrap();
    let examples: Vec<Example> = waves.iter().map(Example::from).collect();
    let form = LearnOptions::default().form(&examples).unwrap();
    let each = HeldOut::each(&examples, &form).unwrap();
    let score = |weight: f64| -> f64 {
        let weight = Some(weight);
        let scores = each
            .iter()
            .map(|held_out| held_out.score(Estimator::Kronecker { weight }).unwrap());
        scores.sum()
    };
    let chosen = Estimator::Kronecker { weight: None }.chosen(&examples, &form);
    let Estimator::Kronecker { weight: Some(best) } = chosen.unwrap() else {
        panic!("no weight");
    };
    let most = score(best);
    for weight in (1..=20).map(|step| f64::from(step) / 20.0) {
        assert!(score(weight) <= most + 1e-9, "{weight}, chosen {best}");
    }
    for weight in [0.0, -0.5, 1.5, f64::NAN] {
        let refused = each[0].score(Estimator::Kronecker {
            weight: Some(weight),
        });
        assert!(refused.is_err(), "{weight}");
    }
}

//! Phases are angles: what a start, a constant offset or a branch cut must not change.

use num_complex::Complex;
use rand::RngExt;
use undulate::{
    Coordinate, Estimator, FourierMovementPrimitive, LearnOptions, Observation, PhaseForm, Start,
    Wave, stream, synthetic,
};

const HARMONICS: usize = 25;
const ELBOW: usize = 3;
const WRIST: usize = 4;

fn turned(wave: &Wave, phase: impl Fn(usize, usize) -> f64) -> Wave {
    let mut weights = wave.weights().clone();
    for d in 0..weights.nrows() {
        for k in 0..weights.ncols() {
            weights[(d, k)] *= Complex::cis(phase(d, k));
        }
    }
    let joints = wave.joints().clone();
    Wave::new(joints, wave.period(), wave.offsets().clone(), weights).unwrap()
}

fn learned(waves: &[Wave], phases: PhaseForm) -> FourierMovementPrimitive {
    let options = LearnOptions {
        phases,
        estimator: Estimator::Kronecker { weight: Some(0.5) },
        ..LearnOptions::default()
    };
    FourierMovementPrimitive::from_waves(waves, &options).unwrap()
}

/// Of principal phases, relative to their covariance, by the same change.
fn change(waves: &[Wave], phases: PhaseForm) -> f64 {
    let moved: Vec<Wave> = waves
        .iter()
        .map(|w| turned(w, |d, k| 0.9 * d as f64 - 0.37 * (k * k) as f64))
        .collect();
    let (before, after) = (learned(waves, phases), learned(&moved, phases));
    let sigma = before.gaussian().covariance();
    (after.gaussian().covariance() - &sigma).norm() / sigma.norm()
}

#[test]
fn a_constant_phase_leaves_the_covariance_as_it_is_and_moves_the_mean() {
    let waves = synthetic(3).unwrap().fit(HARMONICS).unwrap();
    for phases in [PhaseForm::Recentred, PhaseForm::Relative] {
        let moved = change(&waves, phases);
        assert!(moved < 1e-9, "{phases}: {moved:e}");
    }
    // The paper's phases are numbers, and some cross the cut.
    assert!(change(&waves, PhaseForm::Principal) > 0.05);

    let shift = |_: usize, k: usize| 0.8 + 0.1 * k as f64;
    let moved: Vec<Wave> = waves.iter().map(|w| turned(w, shift)).collect();
    let (before, after) = (
        learned(&waves, PhaseForm::Recentred),
        learned(&moved, PhaseForm::Recentred),
    );
    for k in 1..=HARMONICS {
        let phase = Coordinate::phase("elbow_flexion", k);
        let moved = after.median(&phase).unwrap() - before.median(&phase).unwrap();
        let expected = shift(0, k - 1);
        assert!(Complex::cis(moved - expected).arg().abs() < 1e-9, "{k}");
    }
}

/// Started anywhere in the period, each on its own.
fn started_anywhere(waves: &[Wave], seed: u64) -> Vec<Wave> {
    let mut rng = stream(seed, 0);
    waves
        .iter()
        .map(|w| w.advanced(w.period() * rng.random::<f64>()))
        .collect()
}

/// sqrt(-2 ln R) of angles.
fn circular_spread(angles: &[f64]) -> f64 {
    let sum: Complex<f64> = angles.iter().map(|a| Complex::cis(*a)).sum();
    (-2.0 * (sum.norm() / angles.len() as f64).ln()).sqrt()
}

#[test]
fn the_wrist_keeps_its_phase_to_the_elbow_whatever_the_starts() {
    let asked = 5f64.to_radians();
    // The truth: of a thousand and more demonstrators, those whose elbow has about this modulus at 1.5 Hz.
    let mut relative = Vec::new();
    for seed in 1000..1300 {
        for wave in synthetic(seed).unwrap().fit(12).unwrap() {
            let (elbow, wrist) = (wave.weights()[(ELBOW, 9)], wave.weights()[(WRIST, 9)]);
            if (elbow.norm().ln() - asked.ln()).abs() < 0.15 {
                relative.push((wrist / elbow).arg());
            }
        }
    }
    let truth = circular_spread(&relative);
    let given = [Observation::modulus("elbow_flexion", 10, asked)];
    let lag = Coordinate::relative_phase("wrist_deviation", "elbow_flexion", 10);
    let spread = |options: &LearnOptions, sets: u64| {
        let spreads = (0..sets).map(|seed| {
            let waves = synthetic(seed).unwrap().fit(HARMONICS).unwrap();
            let waves = started_anywhere(&waves, seed);
            let primitive = FourierMovementPrimitive::from_waves(&waves, options).unwrap();
            let conditioned = primitive.condition(&given).unwrap();
            conditioned.standard_deviation(&lag).unwrap()
        });
        spreads.sum::<f64>() / sets as f64
    };
    let ours = spread(&LearnOptions::default(), 20);
    let recentred = LearnOptions {
        phases: PhaseForm::Recentred,
        estimator: Estimator::Kronecker { weight: Some(0.9) },
        ..LearnOptions::default()
    };
    let recentred = spread(&recentred, 5);
    println!(
        "wrist-elbow phase at k = 10 given the elbow: truth {truth:.3} rad ({} demonstrations), relative {ours:.3} ({:.2} times), recentred {recentred:.3}",
        relative.len(),
        ours / truth
    );
    assert!(relative.len() > 100);
    assert!(ours < 1.3 * truth && ours > 0.5 * truth);
    // The twin: phases that do not know of each other.
    assert!(recentred > 3.0 * truth);
}

#[test]
fn a_phase_observed_at_its_branch_cut_is_the_same_from_both_sides() {
    let waves = synthetic(0).unwrap().fit(HARMONICS).unwrap();
    for phases in [
        PhaseForm::Principal,
        PhaseForm::Recentred,
        PhaseForm::Relative,
    ] {
        let primitive = learned(&waves, phases);
        let phase = Coordinate::phase("shoulder_rotation", 9);
        let start = primitive.chart().row(&phase).unwrap();
        // Half a turn from the branch centre, which is the mean of circular statistics.
        let centre: f64 = match phases {
            PhaseForm::Principal => 0.0,
            _ => start
                .iter()
                .map(|(i, c)| c * primitive.gaussian().mean()[*i])
                .sum(),
        };
        let at = |value: f64| {
            let observation = Observation::of(phase.clone(), value);
            primitive.condition(&[observation]).unwrap()
        };
        let (upper, lower) = (
            at(centre + std::f64::consts::PI),
            at(centre - std::f64::consts::PI),
        );
        let (a, b) = (upper.gaussian().mean(), lower.gaussian().mean());
        // On one side of the cut or the other, by the last bit of the centre; then all of it.
        let apart = (a - b).norm();
        assert!(apart < 1e-9 * a.norm(), "{phases}: {apart}");
        let nearby = at(centre + std::f64::consts::PI + 1e-9);
        assert!(nearby.gaussian().mean().iter().all(|m| m.is_finite()));
    }
}

#[test]
fn every_form_of_phases_comes_back_from_its_file_and_names_its_coordinates() {
    let waves = synthetic(3).unwrap().fit(4).unwrap();
    let cycles = include_str!("fixtures/model_v2_cycles.json");
    let mut primitives = vec![FourierMovementPrimitive::from_json(cycles).unwrap()];
    for phases in [
        PhaseForm::Principal,
        PhaseForm::Recentred,
        PhaseForm::Relative,
    ] {
        primitives.push(learned(&waves, phases));
    }
    for primitive in &primitives {
        let (chart, text) = (primitive.chart(), primitive.to_json());
        let read = FourierMovementPrimitive::from_json(&text).unwrap();
        assert_eq!(read.chart().phase_form(), chart.phase_form());
        assert_eq!(read.to_json(), text);
        for i in 0..primitive.gaussian().mean().len() {
            let coordinate = chart.coordinate(i).unwrap();
            assert_eq!(
                chart.row(&coordinate).unwrap(),
                [(i, 1.0)],
                "{i}: {coordinate}"
            );
        }
    }
    // Of cycles the modulus is no entry, nor is it one of their logarithms.
    let chart = primitives[0].chart();
    let modulus = Coordinate::modulus(chart.joints().iter().next().unwrap(), 1);
    let error = chart.row(&modulus).unwrap_err().to_string();
    assert!(error.contains("whose cycles vary"), "{error}");
}

#[test]
fn a_start_is_read_from_its_text() {
    let start = |text: &str| text.parse::<Start>();
    assert_eq!(start("kept").unwrap(), Start::Kept);
    assert_eq!(start("redrawn").unwrap(), Start::Redrawn);
    let quarter = std::f64::consts::FRAC_PI_2;
    assert_eq!(start("90deg").unwrap(), Start::Fixed(quarter));
    let error = start("later").unwrap_err().to_string();
    assert!(error.contains("start `later`"), "{error}");
}

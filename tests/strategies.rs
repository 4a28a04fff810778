//! Strategies draw what they say, and shrink to what they say.

use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, TestError, TestRunner};
use rand::RngExt;
use undulate::testing::{
    DrawnWave, covariances, demonstrate_below, demonstrations, gaussians, hostile, hostile_bytes,
    observations, primitives, refute_above, seeds, waves, waves_of,
};
use undulate::{
    FourierMovementPrimitive, Gaussian, LearnOptions, LogPolar, Observation, Quantity, stream,
    synthetic,
};

fn config() -> Config {
    Config {
        failure_persistence: None,
        ..Config::default()
    }
}

/// What a property that fails shrinks to.
fn counterexample<S: Strategy>(strategy: S, fails: impl Fn(&S::Value) -> bool) -> S::Value {
    let outcome = TestRunner::new_with_rng(config(), deterministic())
        .run(&strategy, |value| {
            prop_assert!(!fails(&value));
            Ok(())
        })
        .unwrap_err();
    match outcome {
        TestError::Fail(_, value) => value,
        TestError::Abort(why) => panic!("{why}"),
    }
}

fn deterministic() -> proptest::test_runner::TestRng {
    proptest::test_runner::TestRng::deterministic_rng(Default::default())
}

fn learned() -> FourierMovementPrimitive {
    FourierMovementPrimitive::learn_with(&synthetic(0).unwrap(), 12, &LearnOptions::paper())
        .unwrap()
}

/// |w_{d,k}| of the elbow's strongest harmonic.
fn swing(wave: &DrawnWave) -> f64 {
    let elbow = wave.joints().index("elbow_flexion").unwrap();
    wave.weights()
        .row(elbow)
        .iter()
        .map(|w| w.norm())
        .fold(0.0, f64::max)
}

#[test]
fn a_wave_shrinks_to_the_most_typical_that_fails() {
    let primitive = learned();
    let mean = counterexample(waves_of(&primitive), |_| true);
    assert_eq!(mean.mahalanobis(), 0.0);
    assert!(mean.moving().is_empty() && mean.harmonics_heard().is_empty());

    // A swing that is rare: the draw that had it by chance was far from the mean in all directions.
    let typical = swing(&counterexample(waves_of(&primitive), |w| w.is_drawn()));
    let limit = 1.3 * typical;
    let wave = counterexample(waves_of(&primitive), |wave| swing(wave) > limit);
    assert!(swing(&wave) > limit && swing(&wave) < 1.1 * limit);
    assert_eq!(wave.moving(), ["elbow_flexion"]);
    assert_eq!(wave.harmonics_heard().len(), 1);
    let rank = primitive.gaussian().rank() as f64;
    assert!(wave.mahalanobis() > 0.1 && wave.mahalanobis() < 0.8 * rank.sqrt());
    let text = format!("{wave:?}");
    let told = format!("Mahalanobis distance {:.4}", wave.mahalanobis());
    assert!(
        text.starts_with("a wave of period") && text.contains(&told),
        "{text}"
    );
}

#[test]
fn a_wave_that_is_drawn_has_the_distance_of_its_vector() {
    // Rank 3 in five dimensions, and less by the condition; phases stay within their branch.
    let mut rng = stream(1, 0);
    let factor = DMatrix::from_fn(5, 3, |_, _| rng.random_range(-0.2..0.2));
    let chart = LogPolar::of(&counterexample(waves(1..=1, 2..=2), |_| true));
    let gaussian = Gaussian::new(DVector::zeros(5), factor).unwrap();
    let conditioned = FourierMovementPrimitive::new(chart, gaussian)
        .and_then(|p| p.condition(&[Observation::offset("joint_0", 0.1)]))
        .unwrap();
    let sigma = conditioned.gaussian().covariance();
    let inverse = sigma.pseudo_inverse(1e-12).unwrap();
    let mut runner = TestRunner::new_with_rng(config(), deterministic());
    runner
        .run(&waves_of(&conditioned), |wave| {
            let x = conditioned.chart().vector(wave.wave())?;
            let off = x - conditioned.gaussian().mean();
            let expected = off.dot(&(&inverse * &off)).sqrt();
            prop_assert!((wave.mahalanobis() / expected - 1.0).abs() < 1e-6);
            Ok(())
        })
        .unwrap();
}

#[test]
fn waves_of_cycles_and_of_dense_covariances_are_drawn_too() {
    let primitive = FourierMovementPrimitive::learn(&synthetic(0).unwrap(), 4).unwrap();
    let wave = counterexample(waves_of(&primitive), |_| true);
    assert_eq!(wave.mahalanobis(), 0.0);
    let text = include_str!("fixtures/model_v2_cycles.json");
    let cycles = FourierMovementPrimitive::from_json(text).unwrap();
    let wave = counterexample(waves_of(&cycles), |wave| wave.period() > 0.0);
    assert!(wave.mahalanobis() < 1e-9 && wave.moving().is_empty());
    // What makes its cycles differ counts, two numbers a cycle. Seed fixed, N = 2000, false alarm 3e-7: five standard deviations of the mean.
    let mut runner = TestRunner::new_with_rng(config(), deterministic());
    let strategy = waves_of(&cycles);
    let squares = (0..2000).map(|_| {
        let tree = strategy.new_tree(&mut runner).unwrap();
        tree.current().mahalanobis().powi(2)
    });
    let mean = squares.sum::<f64>() / 2000.0;
    let degrees = (cycles.gaussian().rank() + 2 * cycles.chart().cycles().unwrap().count()) as f64;
    let allowed = 5.0 * (2.0 * degrees / 2000.0).sqrt();
    assert!((mean - degrees).abs() < allowed, "{mean}, {degrees}");
}

/// A strategy that is done lets others go on.
#[test]
fn what_is_drawn_beside_a_wave_shrinks_too() {
    let primitive = learned();
    let is_heard = |wave: &DrawnWave| wave.harmonics_heard().contains(&10);
    let beside = (waves_of(&primitive), 0..100_000u32);
    let (wave, number) = counterexample(beside, |(wave, x)| is_heard(wave) && *x >= 3);
    assert_eq!((wave.harmonics_heard(), number), (vec![10], 3));
    let before = (0..100_000u32, waves_of(&primitive));
    let (number, wave) = counterexample(before, |(x, wave)| is_heard(wave) && *x >= 3);
    assert_eq!((wave.harmonics_heard(), number), (vec![10], 3));
}

#[test]
fn observations_shrink_to_few_exact_ones_at_the_mean() {
    let primitive = learned();
    let observed = counterexample(observations(&primitive, 0..=8), |all| all.len() >= 2);
    assert_eq!(observed.len(), 2);
    let mean = primitive.gaussian().mean();
    for observation in &observed {
        let Quantity::One(coordinate) = &observation.quantity else {
            panic!("{observation:?}")
        };
        assert_eq!(observation.deviation, 0.0);
        let chart = primitive.chart();
        let at = (0..chart.dimension()).find(|i| chart.coordinate(*i).as_ref() == Some(coordinate));
        let expected = chart.value(coordinate, mean[at.unwrap()]).unwrap();
        assert_eq!(observation.value, expected);
    }
}

/// Within the tries that proptest takes by default.
#[test]
fn primitives_and_demonstrations_shrink_to_the_least() {
    let primitive = counterexample(primitives(1..=2, 1..=3, 4), |_| true);
    let chart = primitive.chart();
    assert_eq!((chart.joints().len(), chart.harmonics()), (1, 1));
    let gaussian = primitive.gaussian();
    assert_eq!(
        (gaussian.mean().amax(), gaussian.factor().amax()),
        (0.0, 0.0)
    );
    let shown = counterexample(demonstrations(1..=3, 1..=3, 3..=6), |_| true);
    assert_eq!((shown.joints().len(), shown.recordings().len()), (1, 3));
    for one in shown.recordings() {
        assert_eq!(one.positions(), shown.recordings()[0].positions());
    }
}

#[test]
fn a_seed_stays_while_the_rest_shrinks() {
    let first = std::cell::Cell::new(None);
    let (count, seed) = counterexample((1..1000usize, seeds()), |(_, seed)| {
        let seed_of_first = first.get().unwrap_or(*seed);
        first.set(Some(seed_of_first));
        assert_eq!(seed_of_first, *seed);
        true
    });
    assert_eq!((count, Some(seed)), (1, first.get()));
    let (mut a, mut b) = (seed.rng(), stream(seed.0, 0));
    assert_eq!(a.random::<u64>(), b.random::<u64>());
}

#[test]
fn waves_shrink_to_little_and_gaussians_to_nothing() {
    let wave = counterexample(waves(1..=4, 1..=6), |_| true);
    assert_eq!((wave.joints().len(), wave.harmonics()), (1, 1));
    let weight = wave.weights()[(0, 0)];
    assert!((weight.re - (-4.0f64).exp()).abs() < 1e-15 && weight.im == 0.0);
    let gaussian = counterexample(gaussians(3, 2), |_| true);
    assert_eq!(
        (gaussian.mean().amax(), gaussian.factor().amax()),
        (0.0, 0.0)
    );
}

proptest! {
    #![proptest_config(Config { cases: 64, ..config() })]

    #[test]
    fn covariances_have_rank_and_condition(
        (rank, matrix, condition) in (2..=5usize, 0.0..8.0f64).prop_flat_map(|(rank, digits)| {
            let condition = 10f64.powf(digits);
            (Just(rank), covariances(5, rank, condition), Just(condition))
        })
    ) {
        let mut values: Vec<f64> = matrix.symmetric_eigenvalues().iter().copied().collect();
        values.sort_by(|a, b| b.total_cmp(a));
        prop_assert!((values[0] - 1.0).abs() < 1e-12);
        prop_assert!((values[rank - 1] * condition - 1.0).abs() < 1e-14 * condition + 1e-9);
        prop_assert!(values[rank..].iter().all(|v| v.abs() < 1e-14));
    }

    #[test]
    fn observations_are_such_that_a_primitive_has_them(
        (primitive, asked) in primitives(1..=2, 1..=3, 5)
            .prop_filter("of full rank", |p| p.gaussian().factor().singular_values().min() > 1e-3)
            .prop_flat_map(|p| (Just(p.clone()), observations(&p, 1..=3)))
    ) {
        let conditioned = primitive.condition(&asked)?;
        for observation in asked.iter().filter(|o| o.deviation == 0.0) {
            let turn = conditioned.median_of(observation)? - observation.value;
            let off = turn - std::f64::consts::TAU * (turn / std::f64::consts::TAU).round();
            prop_assert!(off.abs() < 1e-9);
        }
    }

    #[test]
    fn demonstrations_are_whole_periods(demonstrations in demonstrations(1..=3, 1..=4, 2..=5)) {
        prop_assert!(demonstrations.left_out().is_empty());
        for wave in demonstrations.fit(4)? {
            prop_assert_eq!(wave.period(), demonstrations.period());
        }
    }
}

#[test]
fn most_hostile_texts_are_another_text_and_many_bytes_are_none() {
    let plain = "a = 1.5\nb = [2, 3]\n";
    let mut runner = TestRunner::new_with_rng(config(), deterministic());
    let (mut same, mut no_text) = (0, 0);
    for _ in 0..400 {
        let tree = hostile_bytes(Just(plain.to_owned())).new_tree(&mut runner);
        let bytes = tree.unwrap().current().to_vec();
        same += u64::from(bytes == plain.as_bytes());
        no_text += u64::from(String::from_utf8(bytes).is_err());
    }
    refute_above(same, 400, 0.1, 1e-6).unwrap();
    demonstrate_below(400 - no_text, 400, 0.9, 1.0 - 1e-6).unwrap();
}

#[test]
fn a_hostile_text_shrinks_to_the_damage_that_matters_and_prints_little() {
    let plain = "a = [1]\n".to_owned();
    let deep = counterexample(hostile(Just(plain.clone())), |text| {
        text.matches('[').count() > 5000
    });
    // The opening that was there, and five thousand or half as many of two each.
    assert!(deep.matches('[').count() <= 5002, "{deep:?}");
    let text = format!("{deep:?}");
    assert!(
        text.len() < 3000 && text.contains(" times at byte ") && text.contains("more"),
        "{text}"
    );
    let short = counterexample(hostile(Just(plain)), |_| true);
    assert!(
        format!("{short:?}").starts_with("cut off after 0 bytes: "),
        "{short:?}"
    );
}

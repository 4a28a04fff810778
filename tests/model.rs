//! Deterministic identities of the model, and its draws.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use proptest::prelude::*;
use rand::RngExt;
use rand::distr::Distribution;
use undulate::testing::{Seed, gaussian, gaussians, primitives, waves};
use undulate::{
    Bound, Bounds, Coordinate, Derivative, ErrorKind, FourierBasis, FourierMovementPrimitive,
    Gaussian, Interval, LearnOptions, LogPolar, Observation, PeriodGrid, Wave, stream, synthetic,
};

/// The literal system of Algorithm 1: (Phi (x) I_D) w = y over k = -K..K, by the complex normal equations' SVD-free twin, LU.
/// D x (2K+1), column k + K.
fn kronecker(wave: &Wave, times: &[f64], samples: &DMatrix<f64>) -> DMatrix<Complex<f64>> {
    let (d, k) = (samples.ncols(), wave.harmonics() as i32);
    let unknowns = (2 * k + 1) as usize;
    let phi = DMatrix::from_fn(times.len(), unknowns, |n, j| {
        let angle = f64::from(j as i32 - k) * wave.angular_frequency() * times[n];
        Complex::new(angle.cos(), angle.sin())
    });
    let system = phi.kronecker(&DMatrix::<Complex<f64>>::identity(d, d));
    let y = DVector::from_iterator(
        d * times.len(),
        samples.row_iter().flat_map(|row| {
            row.iter()
                .map(|y| Complex::new(*y, 0.0))
                .collect::<Vec<_>>()
        }),
    );
    let adjoint = system.adjoint();
    let solution = (&adjoint * &system).lu().solve(&(&adjoint * y)).unwrap();
    DMatrix::from_fn(d, unknowns, |joint, j| solution[j * d + joint])
}

fn stamps(kind: usize, period: f64, points: usize, seed: u64) -> Vec<f64> {
    let mut rng = stream(seed, 0);
    (0..points)
        .map(|n| match kind {
            0 => period * n as f64 / points as f64,
            1 => period * n as f64 / (points - 1) as f64,
            _ => period * (n as f64 + 0.6 * rng.random::<f64>()) / points as f64,
        })
        .collect()
}

fn distance(a: &Wave, b: &Wave) -> f64 {
    (a.weights() - b.weights()).norm() + (a.offsets() - b.offsets()).norm()
}

proptest! {
    #[test]
    fn the_chart_goes_there_and_back(wave in waves(1..=4, 1..=6)) {
        let chart = LogPolar::of(&wave);
        let x = chart.vector(&wave).unwrap();
        prop_assert!(distance(&wave, &chart.wave(&x).unwrap()) < 1e-14);
        let again = chart.vector(&chart.wave(&x).unwrap()).unwrap();
        prop_assert!((again - x).amax() < 1e-12);
    }

    #[test]
    fn addresses_are_a_bijection(wave in waves(1..=4, 1..=6)) {
        let chart = LogPolar::of(&wave);
        for i in 0..chart.dimension() {
            prop_assert_eq!(chart.row(&chart.coordinate(i).unwrap()).unwrap(), vec![(i, 1.0)]);
        }
        prop_assert_eq!(chart.coordinate(chart.dimension()), None);
    }

    #[test]
    fn every_grid_agrees_with_the_literal_kronecker_solve(
        wave in waves(1..=3, 1..=4), kind in 0..3usize, extra in 0..8usize, seed in 0..1000u64,
    ) {
        let points = 2 * wave.harmonics() + 4 + extra;
        let times = stamps(kind, wave.period(), points, seed);
        // Not band-limited: what is beyond K must be projected away, the same in both.
        let mut rng = stream(seed, 1);
        let samples = DMatrix::from_fn(points, wave.joints().len(), |_, _| rng.random::<f64>() - 0.5);
        let basis = FourierBasis::new(wave.period(), wave.harmonics()).unwrap();
        let fitted = basis.fit(wave.joints(), &times, &samples).unwrap();
        let literal = kronecker(&wave, &times, &samples);
        let k = wave.harmonics();
        for d in 0..samples.ncols() {
            prop_assert!((literal[(d, k)] - fitted.offsets()[d]).norm() < 1e-9);
            for h in 1..=k {
                prop_assert!((literal[(d, k + h)] - fitted.weights()[(d, h - 1)]).norm() < 1e-9);
                // Conjugate symmetry, which is why only k >= 0 is stored.
                prop_assert!((literal[(d, k - h)] - literal[(d, k + h)].conj()).norm() < 1e-9);
            }
        }
    }

    #[test]
    fn a_band_limited_motion_is_found_again(
        wave in waves(1..=3, 1..=6), kind in 0..3usize, seed in 0..1000u64,
    ) {
        let times = stamps(kind, wave.period(), 2 * wave.harmonics() + 9, seed);
        let samples = DMatrix::from_fn(times.len(), wave.joints().len(), |n, d| wave.position(times[n])[d]);
        let basis = FourierBasis::new(wave.period(), wave.harmonics()).unwrap();
        prop_assert!(distance(&wave, &basis.fit(wave.joints(), &times, &samples).unwrap()) < 1e-10);
    }

    #[test]
    fn energy_is_that_of_the_weights(wave in waves(1..=3, 1..=6)) {
        // Parseval: the mean of y^2 over a period is w_0^2 + 2 sum |w_k|^2.
        let points = 2 * wave.harmonics() + 1;
        let y = wave.on_grid(&PeriodGrid::new(points, wave.harmonics()), Derivative::Position);
        for d in 0..y.ncols() {
            let mean = y.column(d).norm_squared() / points as f64;
            let weights = wave.offsets()[d].powi(2) + 2.0 * wave.weights().row(d).norm_squared();
            prop_assert!((mean - weights).abs() < 1e-12 * (1.0 + weights));
        }
    }

    #[test]
    fn starting_later_shifts_time(wave in waves(1..=2, 1..=6), delay in -20.0..20.0f64, t in -5.0..5.0f64) {
        let later = wave.advanced(delay);
        prop_assert!((later.position(t) - wave.position(t + delay)).amax() < 1e-11);
    }

    #[test]
    fn derivatives_are_limits_of_differences(wave in waves(1..=2, 1..=4), t in 0.0..5.0f64) {
        let h = 1e-5 * wave.period() / wave.harmonics() as f64;
        let (before, at, after) = (wave.state(t - h), wave.state(t), wave.state(t + h));
        for (d, _) in wave.joints().iter().enumerate() {
            let pairs = [
                (before.position[d], after.position[d], at.velocity[d], 1),
                (before.velocity[d], after.velocity[d], at.acceleration[d], 2),
                (before.acceleration[d], after.acceleration[d], at.jerk[d], 3),
            ];
            for (low, high, derivative, order) in pairs {
                let difference = (high - low) / (2.0 * h);
                let scale = wave.harmonic_sum(d, order) + (low.abs() + high.abs()) * 1e-10 / h;
                prop_assert!((difference - derivative).abs() < 1e-4 * scale, "{} {}", difference, derivative);
            }
        }
    }

    #[test]
    fn the_grid_is_the_series_at_its_points(wave in waves(1..=3, 1..=7), points in 1..40usize) {
        let grid = PeriodGrid::new(points, wave.harmonics());
        for derivative in [Derivative::Position, Derivative::Velocity, Derivative::Acceleration, Derivative::Jerk] {
            let values = wave.on_grid(&grid, derivative);
            for (n, t) in grid.times(wave.period()).into_iter().enumerate() {
                let state = wave.state(t);
                let expected = match derivative {
                    Derivative::Position => state.position,
                    Derivative::Velocity => state.velocity,
                    Derivative::Acceleration => state.acceleration,
                    Derivative::Jerk => state.jerk,
                };
                for d in 0..expected.len() {
                    let scale = 2.0 + wave.harmonic_sum(d, derivative.order());
                    prop_assert!((values[(n, d)] - expected[d]).abs() < 1e-12 * scale);
                }
            }
        }
    }

    #[test]
    fn enclosures_hold_and_ranges_are_tight(
        wave in waves(1..=2, 1..=6), middle in -3.0..6.0f64, half in 0.0..2.0f64,
    ) {
        for derivative in [Derivative::Position, Derivative::Velocity, Derivative::Acceleration] {
            for d in 0..wave.joints().len() {
                let value = |t: f64| {
                    let state = wave.state(t);
                    match derivative {
                        Derivative::Position => state.position[d],
                        Derivative::Velocity => state.velocity[d],
                        _ => state.acceleration[d],
                    }
                };
                let enclosure = wave.enclosure(d, derivative, middle, half);
                let range = wave.range(d, derivative);
                let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
                for i in 0..=200 {
                    let share = f64::from(i) / 200.0;
                    let inside = value(middle + half * (2.0 * share - 1.0));
                    prop_assert!(enclosure.contains(inside), "{:?} {}", enclosure, inside);
                    let anywhere = value(wave.period() * share);
                    prop_assert!(range.contains(anywhere), "{:?} {}", range, anywhere);
                    (low, high) = (low.min(anywhere), high.max(anywhere));
                }
                // 200 samples of at most 6 harmonics miss a peak by at most S2 (T/400)^2 / 2.
                let missed = wave.harmonic_sum(d, derivative.order() + 2) * (wave.period() / 400.0).powi(2) / 2.0;
                let allowed = missed + 1e-5 * wave.harmonic_sum(d, derivative.order());
                prop_assert!(range.upper - high <= allowed && low - range.lower <= allowed);
            }
        }
    }

    #[test]
    fn model_and_wave_files_keep_every_bit(primitive in primitives(1..=3, 1..=4, 3)) {
        let read = FourierMovementPrimitive::from_json(&primitive.to_json()).unwrap();
        prop_assert_eq!(&read, &primitive);
        let wave = primitive.mean_wave();
        prop_assert_eq!(Wave::from_json(&wave.to_json()).unwrap(), wave);
    }

    #[test]
    fn conditioning_is_exact_and_the_textbook_schur_complement(
        primitive in primitives(1..=2, 1..=3, 5), picks in prop::collection::btree_set(0..6usize, 1..=3), z in prop::collection::vec(-1.0..1.0f64, 5),
    ) {
        let prior = primitive.gaussian();
        // Values that can be reached.
        let target = prior.mean() + prior.factor() * DVector::from_vec(z);
        let rows: Vec<usize> = picks.into_iter().filter(|i| *i < prior.dimension()).collect();
        let observations: Vec<Observation> = rows.iter().map(|i| {
            let coordinate = primitive.chart().coordinate(*i).unwrap();
            let value = primitive.chart().value(&coordinate, target[*i]).unwrap();
            Observation::of(coordinate, value)
        }).collect();
        prop_assume!(!rows.is_empty());
        let a = DMatrix::from_fn(rows.len(), prior.dimension(), |r, i| f64::from(u8::from(rows[r] == i)));
        let sigma = prior.covariance();
        let s = &a * &sigma * a.transpose();
        // A nearly singular Schur complement is not what is compared here.
        let eigenvalues = s.clone().symmetric_eigenvalues();
        prop_assume!(eigenvalues.min() > 1e-4 * eigenvalues.max());
        let conditioned = primitive.condition(&observations).unwrap();
        let posterior = conditioned.gaussian();
        let charted = DVector::from_iterator(rows.len(), rows.iter().zip(&observations).map(|(i, o)| {
            match primitive.chart().coordinate(*i).unwrap() {
                Coordinate::Modulus { .. } => o.value.ln(),
                Coordinate::Phase { .. } => (o.value + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI,
                _ => o.value,
            }
        }));
        let gain = (&sigma * a.transpose()) * s.try_inverse().unwrap();
        let mean = prior.mean() + &gain * (&charted - &a * prior.mean());
        let covariance = &sigma - &gain * &a * &sigma;
        prop_assert!((posterior.mean() - &mean).amax() < 1e-9 * (1.0 + mean.amax()));
        prop_assert!((posterior.covariance() - covariance).amax() < 1e-10);
        // The Mahalanobis distance by its definition.
        let deviation = &charted - &a * prior.mean();
        let squared = deviation.dot(&(&a * &sigma * a.transpose()).try_inverse().unwrap().tr_mul(&deviation));
        let distance = primitive.mahalanobis(&observations).unwrap();
        prop_assert!((distance - squared.sqrt()).abs() < 1e-6 * (1.0 + distance));
        // Exact: the observed rows to the last bit.
        for (r, i) in rows.iter().enumerate() {
            prop_assert_eq!(posterior.standard_deviation(*i), 0.0);
            prop_assert!((posterior.mean()[*i] - charted[r]).abs() < 1e-15);
        }
        // In any order, one by one.
        let mut one_by_one = primitive.clone();
        for observation in observations.iter().rev() {
            one_by_one = one_by_one.condition(std::slice::from_ref(observation)).unwrap();
        }
        prop_assert!((one_by_one.gaussian().mean() - posterior.mean()).amax() < 1e-9);
        prop_assert!((one_by_one.gaussian().covariance() - posterior.covariance()).amax() < 1e-10);
        // Never wider, in any direction.
        let narrowing = (sigma - posterior.covariance()).symmetric_eigenvalues();
        prop_assert!(narrowing.min() > -1e-12);
        prop_assert_eq!(posterior.rank(), prior.rank() - rows.len());
    }

    #[test]
    fn maximum_likelihood_is_the_moments(gaussian in gaussians(7, 4), seed in 0..1000u64) {
        let mut rng = stream(seed, 0);
        let vectors: Vec<DVector<f64>> = (0..5).map(|_| gaussian.sample(&mut rng)).collect();
        let fitted = Gaussian::maximum_likelihood(&vectors).unwrap();
        let mean = vectors.iter().sum::<DVector<f64>>() / 5.0;
        let covariance = vectors.iter().map(|x| (x - &mean) * (x - &mean).transpose()).sum::<DMatrix<f64>>() / 5.0;
        prop_assert!((fitted.mean() - mean).amax() < 1e-14);
        prop_assert!((fitted.covariance() - covariance).amax() < 1e-13);
    }
}

/// Probability that one of the statistical tests below raises a false alarm.
const FALSE_ALARM: f64 = 1e-6;
const DRAWS: usize = 4000;
const SEED: u64 = 20;

fn learned() -> FourierMovementPrimitive {
    FourierMovementPrimitive::learn_with(&synthetic(0).unwrap(), 25, &LearnOptions::paper())
        .unwrap()
}

fn conditioned() -> FourierMovementPrimitive {
    learned()
        .condition(&[
            Observation::modulus("elbow_flexion", 10, 5f64.to_radians()),
            Observation::offset("wrist_deviation", 0.0),
        ])
        .unwrap()
}

fn draws(
    g: &Gaussian,
    twin: impl Fn(&Gaussian, &DVector<f64>) -> DVector<f64>,
) -> Vec<DVector<f64>> {
    (0..DRAWS)
        .map(|k| twin(g, &g.sample(&mut stream(SEED, k as u64))))
        .collect()
}

#[test]
fn draws_have_the_mean_and_covariance_of_their_primitive() {
    for primitive in [learned(), conditioned()] {
        let g = primitive.gaussian();
        gaussian(&draws(g, |_, x| x.clone()), g, FALSE_ALARM)
            .unwrap_or_else(|alarm| panic!("{}", alarm.of(Seed(SEED))));
    }
}

#[test]
fn draws_of_a_broken_sampler_do_not() {
    for primitive in [learned(), conditioned()] {
        let g = primitive.gaussian();
        let caught = |twin: &dyn Fn(&Gaussian, &DVector<f64>) -> DVector<f64>, what: &str| {
            let alarm = gaussian(&draws(g, twin), g, FALSE_ALARM).unwrap_err();
            assert_eq!(alarm.what, what, "{alarm}");
        };
        // 1/(M-1) for 1/M is a variance larger by 15/14, below what this N detects; a quarter more is not.
        caught(
            &|g, x| g.mean() + (x - g.mean()) * 1.25f64.sqrt(),
            "variance",
        );
        caught(
            &|g, x| g.mean() + (x - g.mean()) * 0.75f64.sqrt(),
            "variance",
        );
        // Half a standard deviation off along the first column.
        caught(&|g, x| x + g.factor().column(0) * 0.5, "mean");
        // Columns mixed up: the same spread in the wrong directions leaves them correlated.
        caught(
            &|g, x| {
                let z = g
                    .factor()
                    .clone()
                    .svd(true, true)
                    .solve(&(x - g.mean()), 1e-12)
                    .unwrap();
                let mut turned = z.clone();
                turned[0] = (z[0] + z[1]) / 2f64.sqrt();
                g.mean() + g.factor() * turned
            },
            "variance",
        );
        // Noise on one coordinate alone.
        caught(
            &|_, x| {
                let mut y = x.clone();
                y[3] += 1e-3;
                y
            },
            "span",
        );
    }
}

#[test]
fn waves_are_the_charted_draws_and_conditioned_ones_have_the_value() {
    let primitive = conditioned();
    for k in 0..50 {
        let wave = primitive.sample(&mut stream(SEED, k));
        let x = primitive.gaussian().sample(&mut stream(SEED, k));
        assert_eq!(wave, primitive.chart().wave(&x).unwrap());
        assert!((wave.weights()[(3, 9)].norm() - 5f64.to_radians()).abs() < 1e-15);
        assert_eq!(wave.offsets()[4], 0.0);
    }
}

#[test]
fn contradictions_and_foreign_names_are_refused_by_name() {
    let conditioned = conditioned();
    let refuse = |observation: Observation, words: &[&str]| {
        let error = conditioned
            .condition(&[observation])
            .unwrap_err()
            .to_string();
        for word in words {
            assert!(error.contains(word), "{error}");
        }
    };
    refuse(
        Observation::modulus("elbow_flexion", 10, 0.1),
        &["modulus:elbow_flexion:10", "contradicts", "5.0000 deg"],
    );
    refuse(
        Observation::modulus("elbow_flexion", 26, 0.1),
        &["no harmonic 26", "1 to 25"],
    );
    refuse(
        Observation::modulus("elbow", 10, 0.1),
        &["no joint `elbow`", "elbow_flexion"],
    );
    refuse(
        Observation::modulus("elbow_flexion", 9, 0.0),
        &["positive number"],
    );
    refuse(
        Observation::modulus("elbow_flexion", 9, f64::NAN),
        &["finite"],
    );
    // Fifteen demonstrations leave fourteen directions.
    let fifteen: Vec<Observation> = (1..=15)
        .map(|k| Observation::modulus("elbow_flexion", k, 0.01))
        .collect();
    let error = learned().condition(&fifteen).unwrap_err().to_string();
    assert!(error.contains("contradicts"), "{error}");
}

#[test]
fn broken_model_files_are_refused() {
    let text = learned().to_json();
    let read = |text: &str| {
        FourierMovementPrimitive::from_json(text)
            .unwrap_err()
            .to_string()
    };
    assert!(read(&text[..text.len() / 2]).contains("cut short"));
    assert!(read("").contains("cut short"));
    assert!(
        read(&text.replace("\"version\":2", "\"version\":3"))
            .contains("version 3, expected 1 to 2")
    );
    assert!(read(&text.replace("undulate model", "something")).contains("format `something`"));
    assert!(read(&text.replace("\"harmonics\":25", "\"harmonics\":24")).contains("2 D K + D"));
    assert!(
        read(&text.replace("\"harmonics\":25", "\"harmonics\":18446744073709551615"))
            .contains("2 D K + D")
    );
    assert!(read(&text.replacen("\"mean\":[", "\"mean\":[1e400,", 1)).contains("line 1"));
    assert!(read(&text.replacen("\"mean\":[-", "\"mean\":[-999", 1)).contains("overflow"));
}

#[test]
fn one_demonstration_and_differing_waves_are_refused() {
    let waves = synthetic(0).unwrap().fit(5).unwrap();
    assert!(
        FourierMovementPrimitive::from_waves(&waves[..1], &LearnOptions::paper())
            .unwrap_err()
            .to_string()
            .contains("at least two")
    );
    let other = synthetic(0).unwrap().fit(6).unwrap();
    assert!(
        FourierMovementPrimitive::from_waves(
            &[waves[0].clone(), other[0].clone()],
            &LearnOptions::paper()
        )
        .is_err()
    );
}

#[test]
fn rows_and_columns_that_are_missing_are_refused() {
    let wave = synthetic(0).unwrap().fit(2).unwrap().remove(0);
    let basis = FourierBasis::new(wave.period(), 2).unwrap();
    let times: Vec<f64> = stamps(0, wave.period(), 20, 0);
    let joints = wave.joints();
    let samples = |rows: usize, columns: usize| DMatrix::zeros(rows, columns);
    assert!(
        basis
            .fit(joints, &times, &samples(20, joints.len()))
            .is_ok()
    );
    for (rows, columns) in [(19, joints.len()), (20, joints.len() - 1), (20, 0)] {
        let error = basis.fit(joints, &times, &samples(rows, columns));
        assert_eq!(error.unwrap_err().kind(), ErrorKind::Shape);
    }
    let mut file: serde_json::Value = serde_json::from_str(&wave.to_json()).unwrap();
    let whole = file["weights_rad"].clone();
    let rows = |rows: &serde_json::Value| rows.as_array().unwrap().clone();
    let mut fewer = rows(&whole);
    fewer.pop();
    let mut ragged = rows(&whole);
    ragged[1].as_array_mut().unwrap().pop();
    for broken in [fewer, ragged] {
        file["weights_rad"] = broken.into();
        let error = Wave::from_json(&file.to_string()).unwrap_err();
        assert!(error.to_string().contains("rows of weights"), "{error}");
    }
}

#[test]
fn draws_within_bounds_are_those_draws_that_stay_within() {
    let primitive = learned();
    let joints = primitive.chart().joints();
    let range = |wave: &Wave| wave.range(3, Derivative::Position);
    let mut highest: Vec<f64> = (0..20)
        .map(|k| range(&primitive.sample(&mut stream(9, k))).upper)
        .collect();
    highest.sort_by(f64::total_cmp);
    let within = |upper: f64| {
        let lower = -100.0;
        let bound = Bound {
            joint: "elbow_flexion".to_owned(),
            interval: Interval { lower, upper },
        };
        let bounds = Bounds::new(joints, &[bound]).unwrap();
        primitive.sample_within(&bounds, 8, 9, 0)
    };
    let found = within(highest[14]).unwrap();
    assert!(found.waves.len() == 8 && (8..=20).contains(&found.draws));
    for (number, wave) in &found.waves {
        assert_eq!(*wave, primitive.sample(&mut stream(9, *number)));
        assert!(range(wave).upper <= highest[14]);
    }
    let hopeless = within(-99.0).unwrap_err();
    assert!(
        hopeless.to_string().contains("0 of 1000 draws"),
        "{hopeless}"
    );
}

#[test]
fn a_grid_has_the_points_that_were_asked_for() {
    for points in [1, 2, 7, 100] {
        let grid = PeriodGrid::new(points, 3);
        assert_eq!((grid.points(), grid.times(1.0).len()), (points, points));
    }
}

#[test]
fn the_longest_series_of_cycles_takes_as_long_whatever_their_number() {
    let text = include_str!("fixtures/model_v2_cycles.json");
    let longest = |count: f64| -> f64 {
        let text = text.replacen("\"count\":3", &format!("\"count\":{count}"), 1);
        let primitive = FourierMovementPrimitive::from_json(&text).unwrap();
        let (chart, mut x) = (primitive.chart(), primitive.gaussian().mean().clone());
        let frequency = |i: &usize| chart.coordinate(*i) == Some(Coordinate::Frequency);
        let i = (0..x.len()).find(frequency).unwrap();
        x[i] = -1e3;
        let refused = chart.wave(&x).unwrap_err().to_string();
        let limit = refused.split("within +-").nth(1).expect(&refused);
        let digits = |c: char| !c.is_ascii_digit() && c != '.';
        let slowest = limit.split(digits).next().unwrap().parse::<f64>().unwrap();
        slowest + count.ln()
    };
    assert!((longest(3.0) - longest(4.0)).abs() < 1e-9);
}

//! Mean and covariance of trajectories against quadrature over the latent numbers, an independent implementation
//! (`tests/oracle/moments.py`), and draws.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use rand::distr::Distribution;
use serde_json::{Value, json};
use undulate::Derivative::{Acceleration, Jerk, Position, Velocity};
use undulate::{
    Coordinate, Covariance, FourierMovementPrimitive, Gaussian, Joints, Kronecker, LogPolar,
    Observation, OffsetForm, StartSpread, TrajectoryMoments, Wave, stream,
};

#[path = "common/quadrature.rs"]
mod quadrature;
use quadrature::{Instants, quadrature, trajectory};

/// Mean and covariance of all joints at all instants, as the library states them.
fn stated(moments: &TrajectoryMoments, instants: &Instants) -> (DVector<f64>, DMatrix<f64>) {
    let joints = moments.joints().len();
    let size = joints * instants.len();
    let mut mean = DVector::zeros(size);
    let mut covariance = DMatrix::zeros(size, size);
    for (i, one) in instants.iter().enumerate() {
        let at = moments.mean(one.0, one.1);
        mean.rows_mut(i * joints, joints).copy_from(&at);
        for (j, other) in instants.iter().enumerate() {
            let block = moments.covariance(*one, *other);
            let mut view = covariance.view_mut((i * joints, j * joints), (joints, joints));
            view.copy_from(&block);
        }
    }
    (mean, covariance)
}

/// One joint, one harmonic, an offset as it is.
fn smallest() -> FourierMovementPrimitive {
    let weights = DMatrix::from_element(1, 1, Complex::new(0.1, 0.2));
    let joints = Joints::new(["elbow"]).unwrap();
    let wave = Wave::new(joints, 2.5, DVector::zeros(1), weights).unwrap();
    let mean = DVector::from_vec(vec![-0.7, 1.1, 0.4]);
    #[rustfmt::skip]
    let factor = DMatrix::from_row_slice(3, 3, &[
        0.35, 0.10, -0.20,
        -0.15, 0.40, 0.25,
        0.20, -0.30, 0.15,
    ]);
    let gaussian = Gaussian::new(mean, factor).unwrap();
    FourierMovementPrimitive::new(LogPolar::of(&wave), gaussian).unwrap()
}

/// A model file of a factor of so many columns, deterministic and correlated.
fn of_factor(
    joints: &[&str],
    harmonics: usize,
    phases: Value,
    offsets: &[&str],
    rank: usize,
) -> FourierMovementPrimitive {
    let n = (2 * harmonics + 1) * joints.len();
    let entry = |i: usize, j: usize| 0.3 * (1.0 + 1.7 * i as f64 + 2.9 * (j * j) as f64).sin();
    let columns: Vec<Vec<f64>> = (0..rank)
        .map(|j| (0..n).map(|i| entry(i, j)).collect())
        .collect();
    let mean: Vec<f64> = (0..n).map(|i| -0.5 - 0.4 * (i % 3) as f64).collect();
    let file = json!({
        "format": "undulate model", "version": 2, "joints": joints, "period_s": 1.6, "harmonics": harmonics,
        "phases": phases, "offsets": offsets, "mean": mean, "factor": columns, "blocks": [], "independent": [],
        "observations": [],
    });
    FourierMovementPrimitive::from_json(&file.to_string()).unwrap()
}

#[test]
fn quadrature_over_the_latent_numbers_agrees() {
    let given_a_phase = Observation::phase("elbow", 1, 0.8).within(0.3);
    let relative = json!({"relative": {"reference": "wrist", "centres_rad": [0.0, 0.0]}});
    let cases = [
        ("one harmonic, signed", smallest()),
        (
            "given a phase",
            smallest().condition(&[given_a_phase]).unwrap(),
        ),
        (
            "two harmonics, positive",
            of_factor(&["elbow"], 2, json!("principal"), &["positive"], 3),
        ),
        (
            "two harmonics, signed",
            of_factor(&["elbow"], 2, json!("principal"), &["signed"], 3),
        ),
        (
            "relative phases",
            of_factor(&["elbow", "wrist"], 1, relative, &["negative", "signed"], 4),
        ),
    ];
    let instants = [
        (0.3, Position),
        (1.0, Position),
        (1.0, Velocity),
        (1.4, Acceleration),
        (0.3, Jerk),
    ];
    for (name, primitive) in cases {
        for start in [
            StartSpread::None,
            StartSpread::Uniform,
            StartSpread::Normal(0.08),
        ] {
            let (mean, covariance) = stated(&primitive.moments(start).unwrap(), &instants);
            let (expected_mean, expected) = quadrature(&primitive, start, &instants);
            let mut worst = 0f64;
            for i in 0..mean.len() {
                let scale = (expected[(i, i)] + expected_mean[i].powi(2)).sqrt();
                worst = worst.max((mean[i] - expected_mean[i]).abs() / scale);
                for j in 0..mean.len() {
                    let scale = (expected[(i, i)] * expected[(j, j)]).sqrt();
                    worst = worst.max((covariance[(i, j)] - expected[(i, j)]).abs() / scale);
                }
            }
            println!("{name}, {start:?}: {worst:.1e}");
            assert!(worst < 1e-12, "{name}, {start:?}: {worst:e}");
        }
    }
}

fn fixture() -> FourierMovementPrimitive {
    FourierMovementPrimitive::from_json(include_str!("fixtures/model_v2.json")).unwrap()
}

#[test]
fn numpy_agrees() {
    let oracle: Value = serde_json::from_str(include_str!("oracle/moments.json")).unwrap();
    let numbers = |v: &Value| -> Vec<f64> { serde_json::from_value(v.clone()).unwrap() };
    let instants: Vec<_> = numbers(&oracle["times"])
        .into_iter()
        .flat_map(|t| [(t, Position), (t, Velocity)])
        .collect();
    for start in oracle["starts"].as_array().unwrap() {
        let spread = match start["spread"].as_str().unwrap() {
            "none" => StartSpread::None,
            "uniform" => StartSpread::Uniform,
            _ => StartSpread::Normal(start["deviation"].as_f64().unwrap()),
        };
        let (mean, covariance) = stated(&fixture().moments(spread).unwrap(), &instants);
        let expected_mean = DVector::from_vec(numbers(&start["mean"]));
        let rows = start["covariance"].as_array().unwrap().iter();
        let expected: Vec<f64> = rows.flat_map(numbers).collect();
        let expected = DMatrix::from_row_slice(mean.len(), mean.len(), &expected);
        let errors = (
            (mean - &expected_mean).norm() / expected_mean.norm(),
            (covariance - &expected).norm() / expected.norm(),
        );
        println!(
            "{spread:?}: mean {:.1e}, covariance {:.1e}",
            errors.0, errors.1
        );
        assert!(errors.0 < 1e-9 && errors.1 < 1e-9, "{spread:?}: {errors:?}");
    }
}

#[test]
fn grids_are_what_they_are_point_by_point() {
    let moments = fixture().moments(StartSpread::Normal(0.1)).unwrap();
    let (points, joints) = (11, moments.joints().len());
    let time = |n: usize| moments.period() * n as f64 / points as f64;
    for derivative in [Position, Velocity, Acceleration, Jerk] {
        let (mean, deviation) = moments.on_grid(points, derivative);
        let covariance = moments.covariance_on_grid(points, derivative);
        assert_eq!(covariance, covariance.transpose());
        let close = |a: f64, b: f64, scale: f64| assert!((a - b).abs() < 1e-13 * scale, "{a} {b}");
        for n in 0..points {
            let one = (time(n), derivative);
            let (middle, band) = (
                moments.mean(one.0, derivative),
                moments.standard_deviation(one.0, derivative),
            );
            for d in 0..joints {
                close(mean[(n, d)], middle[d], mean.amax());
                close(deviation[(n, d)], band[d], deviation.amax());
            }
            for m in 0..points {
                let block = moments.covariance(one, (time(m), derivative));
                for d in 0..joints {
                    for e in 0..joints {
                        let found = covariance[(d * points + n, e * points + m)];
                        close(found, block[(d, e)], covariance.amax());
                    }
                }
            }
        }
    }
}

const SEED: u64 = 31;
const DRAWS: u64 = 40_000;
/// Beyond this a standard normal number is with probability 5e-9. By the central limit theorem, and shared by the 18 means and 171 covariances, that is
/// a false alarm with probability below 1e-6.
const Z: f64 = 5.85;

/// The same with Sigma / 10: log-normal tails are then light enough for means of products to settle.
fn calmer(primitive: &FourierMovementPrimitive) -> FourierMovementPrimitive {
    let (shrink, gaussian) = (0.1f64.sqrt(), primitive.gaussian());
    let prior = gaussian.prior_covariance();
    let block = |b: &Kronecker| {
        let deviations = b.deviations().iter().map(|s| shrink * s).collect();
        Kronecker::new(b.start(), b.correlation().clone(), b.decay(), deviations).unwrap()
    };
    let covariance = Covariance::new(
        prior.factor() * shrink,
        prior.blocks().iter().map(block).collect(),
        prior.independent() * shrink,
    );
    let gaussian = Gaussian::structured(gaussian.prior_mean().clone(), covariance.unwrap());
    FourierMovementPrimitive::new(primitive.chart().clone(), gaussian.unwrap()).unwrap()
}

/// E y(t) with exp(a^T mu + share a^T Sigma a): one half, or one where the half is forgotten.
fn mean_position(primitive: &FourierMovementPrimitive, t: f64, share: f64) -> DVector<f64> {
    let (chart, gaussian) = (primitive.chart(), primitive.gaussian());
    let sigma = gaussian.covariance();
    let row = |coordinate: Coordinate, unit: Complex<f64>| {
        let entries = chart.row(&coordinate).unwrap().into_iter();
        entries.map(move |(i, c)| (i, unit * c))
    };
    let expected = |a: &[(usize, Complex<f64>)]| {
        let mean: Complex<f64> = a.iter().map(|(i, c)| c * gaussian.mean()[*i]).sum();
        let pairs = a.iter().flat_map(|x| a.iter().map(move |y| (x, y)));
        let variance: Complex<f64> = pairs.map(|((i, c), (j, d))| c * d * sigma[(*i, *j)]).sum();
        (mean + variance * share).exp()
    };
    let joints = chart.joints();
    DVector::from_fn(joints.len(), |d, _| {
        let joint = joints.name(d);
        let offset: Vec<_> = row(
            Coordinate::Offset {
                joint: joint.into(),
            },
            Complex::ONE,
        )
        .collect();
        let middle = match chart.offset_forms()[d] {
            OffsetForm::Signed => gaussian.mean()[offset[0].0],
            OffsetForm::Positive => expected(&offset).re,
            OffsetForm::Negative => -expected(&offset).re,
        };
        let harmonic = |k: usize| {
            let a: Vec<_> = row(Coordinate::modulus(joint, k), Complex::ONE)
                .chain(row(Coordinate::phase(joint, k), Complex::I))
                .collect();
            let turn = std::f64::consts::TAU * k as f64 * t / chart.period().unwrap();
            2.0 * (expected(&a) * Complex::cis(turn)).re
        };
        middle + (1..=chart.harmonics()).map(harmonic).sum::<f64>()
    })
}

#[test]
fn draws_have_the_mean_and_covariance_stated() {
    let primitive = calmer(&fixture());
    let instants = [
        (0.2, Position),
        (0.2, Velocity),
        (0.9, Position),
        (0.9, Velocity),
        (2.0, Position),
        (2.0, Velocity),
    ];
    let moments = primitive.moments(StartSpread::None).unwrap();
    let (mean, covariance) = stated(&moments, &instants);
    let size = mean.len();
    let draws: Vec<DVector<f64>> = (0..DRAWS)
        .map(|k| trajectory(&primitive.sample(&mut stream(SEED, k)), &instants, 0.0) - &mean)
        .collect();
    // z of a statistic of one draw whose mean is to be `expected`.
    let z = |statistic: &dyn Fn(&DVector<f64>) -> f64, expected: f64| {
        let (mut sum, mut squares) = (0.0, 0.0);
        for y in &draws {
            let off = statistic(y) - expected;
            sum += off;
            squares += off * off;
        }
        sum / (squares - sum * sum / DRAWS as f64).sqrt()
    };
    let mut worst = 0f64;
    for i in 0..size {
        worst = worst.max(z(&|y| y[i], 0.0).abs());
        for j in 0..=i {
            worst = worst.max(z(&|y| y[i] * y[j], covariance[(i, j)]).abs());
        }
    }
    println!("largest z {worst:.2}");
    assert!(worst < Z, "z = {worst}, seed {SEED}, {DRAWS} draws");

    // The twin is broken by the forgotten half alone, and caught.
    let joints = moments.joints().len();
    let mut caught = 0f64;
    for (at, (t, _)) in instants.iter().enumerate().filter(|(_, i)| i.1 == Position) {
        let right = mean_position(&primitive, *t, 0.5);
        let off = right - mean.rows(at * joints, joints);
        assert!(off.amax() < 1e-13, "{off}");
        let wrong = mean_position(&primitive, *t, 1.0) - mean.rows(at * joints, joints);
        for d in 0..joints {
            caught = caught.max(z(&|y| y[at * joints + d], wrong[d]).abs());
        }
    }
    println!("without the half: {caught:.1}");
    assert!(caught > Z, "z = {caught}");
}

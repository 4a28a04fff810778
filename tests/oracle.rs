//! Weights, mean, covariance and conditioning against an independent implementation, `tests/oracle/algorithm1.py`.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use serde_json::Value;
use undulate::{
    Demonstrations, Duration, FourierMovementPrimitive, Joints, LearnOptions, Observation,
    Recording,
};

/// Relative, in the Frobenius norm.
const TOLERANCE: f64 = 1e-10;

fn vector(value: &Value) -> DVector<f64> {
    DVector::from_vec(
        value
            .as_array()
            .unwrap()
            .iter()
            .map(|x| x.as_f64().unwrap())
            .collect(),
    )
}

fn matrix(value: &Value) -> DMatrix<f64> {
    let rows: Vec<_> = value
        .as_array()
        .unwrap()
        .iter()
        .map(|r| vector(r).transpose())
        .collect();
    DMatrix::from_rows(&rows)
}

fn close(found: &DMatrix<f64>, expected: &DMatrix<f64>, what: &str) {
    let error = (found - expected).norm() / expected.norm();
    assert!(error < TOLERANCE, "{what}: {error:e}");
}

fn recordings(problem: &Value) -> Vec<Recording> {
    let names = problem["joints"]
        .as_array()
        .unwrap()
        .iter()
        .map(|n| n.as_str().unwrap());
    let joints = Joints::new(names).unwrap();
    problem["demonstrations"]
        .as_array()
        .unwrap()
        .iter()
        .enumerate()
        .map(|(m, d)| {
            let times = vector(&d["times"]).as_slice().to_vec();
            Recording::new(format!("{m}"), joints.clone(), times, matrix(&d["samples"])).unwrap()
        })
        .collect()
}

#[test]
fn three_kinds_of_time_stamps_agree_with_numpy() {
    let text = include_str!("oracle/algorithm1.json");
    let problems: Value = serde_json::from_str(text).unwrap();
    for problem in problems.as_array().unwrap() {
        let name = problem["name"].as_str().unwrap();
        let period = Duration::Seconds(problem["period"].as_f64().unwrap());
        let harmonics = problem["harmonics"].as_u64().unwrap() as usize;
        let demonstrations = Demonstrations::new(recordings(problem), period).unwrap();
        let waves = demonstrations.fit(harmonics).unwrap();
        for (wave, expected) in waves.iter().zip(problem["weights"].as_array().unwrap()) {
            let weights = DMatrix::from_fn(wave.joints().len(), harmonics + 1, |d, k| {
                Complex::new(
                    expected[d][k][0].as_f64().unwrap(),
                    expected[d][k][1].as_f64().unwrap(),
                )
            });
            let found = wave.weights().clone().insert_column(0, Complex::ZERO);
            let found = DMatrix::from_fn(found.nrows(), found.ncols(), |d, k| {
                if k == 0 {
                    wave.offsets()[d].into()
                } else {
                    found[(d, k)]
                }
            });
            assert!(
                (found - &weights).norm() < TOLERANCE * weights.norm(),
                "{name}"
            );
        }
        let primitive = FourierMovementPrimitive::learn_with(
            &demonstrations,
            harmonics,
            &LearnOptions::paper(),
        )
        .unwrap();
        let mean = |g: &undulate::Gaussian| {
            DMatrix::from_column_slice(g.dimension(), 1, g.mean().as_slice())
        };
        let expected = |value: &Value| DMatrix::from_columns(&[vector(value)]);
        close(
            &mean(primitive.gaussian()),
            &expected(&problem["mean"]),
            name,
        );
        close(
            &primitive.gaussian().covariance(),
            &matrix(&problem["covariance"]),
            name,
        );
        for case in problem["conditioned"].as_array().unwrap() {
            let given: Vec<Observation> = case["observations"]
                .as_array()
                .unwrap()
                .iter()
                .map(|o| {
                    let coordinate = o["coordinate"].as_str().unwrap();
                    format!("{coordinate}={}rad", o["value"].as_f64().unwrap())
                        .parse()
                        .unwrap()
                })
                .collect();
            let conditioned = primitive.condition(&given).unwrap();
            close(
                &mean(conditioned.gaussian()),
                &expected(&case["mean"]),
                name,
            );
            close(
                &conditioned.gaussian().covariance(),
                &matrix(&case["covariance"]),
                name,
            );
        }
    }
}

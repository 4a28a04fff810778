//! Each stage beside a plain reference in the same run: on a shared machine, trust the ratios.
//!
//! `cargo bench` prints medians; figures to be met are in the names' comments.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::{DMatrix, DVector, Isometry3, UnitQuaternion};
use rand::distr::Distribution;
use undulate::{
    Demonstrations, Derivative, Estimator, FourierMovementPrimitive, Gaussian, JointKind,
    LearnOptions, Observation, PeriodGrid, Robot, StartSpread, Wave, shipped, stream, synthetic,
};

const HARMONICS: usize = 25;
const POINTS: usize = 500;

/// Least squares by the normal equations of the literal design matrix, the covariance as a full matrix.
fn plain_learn(demonstrations: &Demonstrations) -> (DVector<f64>, DMatrix<f64>) {
    let w = std::f64::consts::TAU / demonstrations.period();
    let vectors: Vec<DVector<f64>> = demonstrations
        .recordings()
        .iter()
        .map(|recording| {
            let design = DMatrix::from_fn(recording.times().len(), 2 * HARMONICS + 1, |n, j| {
                let k = j.div_ceil(2) as f64;
                let angle = k * w * recording.times()[n];
                match j {
                    0 => 1.0,
                    _ if j % 2 == 1 => 2.0 * angle.cos(),
                    _ => -2.0 * angle.sin(),
                }
            });
            let gram = design.tr_mul(&design);
            let right = design.tr_mul(recording.positions());
            let weights = gram.cholesky().unwrap().solve(&right);
            let joints = weights.ncols();
            let mut x = Vec::new();
            for d in 0..joints {
                x.extend(
                    (0..HARMONICS)
                        .map(|k| weights[(2 * k + 1, d)].hypot(weights[(2 * k + 2, d)]).ln()),
                );
            }
            for d in 0..joints {
                x.extend(
                    (0..HARMONICS).map(|k| weights[(2 * k + 2, d)].atan2(weights[(2 * k + 1, d)])),
                );
            }
            x.extend(weights.row(0).iter());
            DVector::from_vec(x)
        })
        .collect();
    let count = vectors.len() as f64;
    let mean = vectors.iter().sum::<DVector<f64>>() / count;
    let mut covariance = DMatrix::zeros(mean.len(), mean.len());
    for x in &vectors {
        let deviation = x - &mean;
        covariance.ger(1.0 / count, &deviation, &deviation, 1.0);
    }
    (mean, covariance)
}

/// The series, term by term.
fn plain_evaluate(wave: &Wave) -> DMatrix<f64> {
    let w = wave.angular_frequency();
    DMatrix::from_fn(POINTS, wave.joints().len(), |n, d| {
        let t = wave.period() * n as f64 / POINTS as f64;
        wave.offsets()[d]
            + (1..=wave.harmonics())
                .map(|k| {
                    let (sin, cos) = (k as f64 * w * t).sin_cos();
                    let weight = wave.weights()[(d, k - 1)];
                    2.0 * (weight.re * cos - weight.im * sin)
                })
                .sum::<f64>()
    })
}

/// Each body by walking down from the base.
fn plain_kinematics(robot: &Robot, q: &[f64]) -> Vec<Isometry3<f64>> {
    (0..robot.bodies().len())
        .map(|mut body| {
            let mut pose = Isometry3::identity();
            while let Some(joint) = &robot.bodies()[body].joint {
                let position = joint.multiplier * q[joint.index] + joint.offset;
                let step = match joint.kind {
                    JointKind::Revolute => Isometry3::from_parts(
                        Default::default(),
                        UnitQuaternion::from_axis_angle(&joint.axis, position),
                    ),
                    JointKind::Prismatic => Isometry3::from_parts(
                        (joint.axis.into_inner() * position).into(),
                        Default::default(),
                    ),
                };
                pose = joint.origin * step * pose;
                body = robot.bodies()[body].parent;
            }
            pose
        })
        .collect()
}

/// Phases relative to the strongest joint, structured covariance of a fixed weight: the default without the choice of the weight.
fn structured() -> LearnOptions {
    LearnOptions {
        estimator: Estimator::Kronecker { weight: Some(0.9) },
        ..LearnOptions::default()
    }
}

/// Learning 15 x 5 x 500 with K = 25: the paper's below 0.4 ms, the structured one below 0.8 ms.
fn learning(c: &mut Criterion) {
    let demonstrations = synthetic(0).unwrap();
    let mut group = c.benchmark_group("learn");
    group.bench_function("ours", |b| {
        b.iter(|| {
            FourierMovementPrimitive::learn_with(
                black_box(&demonstrations),
                HARMONICS,
                &LearnOptions::paper(),
            )
            .unwrap()
        });
    });
    group.bench_function("structured", |b| {
        b.iter(|| {
            FourierMovementPrimitive::learn_with(
                black_box(&demonstrations),
                HARMONICS,
                &structured(),
            )
            .unwrap()
        });
    });
    group.bench_function("weight chosen", |b| {
        b.iter(|| FourierMovementPrimitive::learn(black_box(&demonstrations), HARMONICS).unwrap());
    });
    group.bench_function("plain", |b| {
        b.iter(|| plain_learn(black_box(&demonstrations)))
    });
    group.finish();
}

/// mu + Sigma a (b - a^T mu) / (a^T Sigma a), and the new covariance, on dense matrices.
fn plain_condition(gaussian: &Gaussian, sigma: &DMatrix<f64>, i: usize, value: f64) -> Gaussian {
    let gain = sigma.column(i) / sigma[(i, i)];
    let mean = gaussian.mean() + &gain * (value - gaussian.mean()[i]);
    let posterior = sigma - &gain * sigma.row(i);
    Gaussian::new(mean, posterior).unwrap()
}

/// One observation: below 20 us.
fn conditioning(c: &mut Criterion) {
    let demonstrations = synthetic(0).unwrap();
    let primitive =
        FourierMovementPrimitive::learn_with(&demonstrations, HARMONICS, &structured()).unwrap();
    let given = [Observation::modulus("elbow_flexion", 10, 0.1)];
    let sigma = primitive.gaussian().covariance();
    let mut group = c.benchmark_group("condition");
    group.bench_function("ours", |b| {
        b.iter(|| primitive.condition(black_box(&given)).unwrap())
    });
    group.bench_function("plain", |b| {
        b.iter(|| plain_condition(primitive.gaussian(), &sigma, black_box(84), 0.1f64.ln()))
    });
    group.finish();
}

/// One sampled wave on 500 points: below 8 us, a thousand below 8 ms.
fn sampling(c: &mut Criterion) {
    let primitive =
        FourierMovementPrimitive::learn_with(&synthetic(0).unwrap(), HARMONICS, &structured())
            .unwrap();
    let grid = PeriodGrid::new(POINTS, HARMONICS);
    let mut rng = stream(0, 0);
    let mut group = c.benchmark_group("sample");
    group.bench_function("ours", |b| {
        b.iter(|| {
            primitive
                .sample(&mut rng)
                .on_grid(&grid, Derivative::Position)
        });
    });
    group.bench_function("draw only", |b| b.iter(|| primitive.sample(&mut rng)));
    group.bench_function("plain", |b| {
        b.iter(|| plain_evaluate(&primitive.sample(&mut rng)))
    });
    group.finish();
}

/// The covariance of a whole trajectory from 400 draws: what can be had without a closed form, and is 5 % off.
fn plain_moments(primitive: &FourierMovementPrimitive, grid: &PeriodGrid) -> DMatrix<f64> {
    let draws: Vec<DVector<f64>> = (0..400)
        .map(|k| {
            let wave = primitive.sample(&mut stream(0, k));
            let positions = wave.on_grid(grid, Derivative::Position);
            DVector::from_column_slice(positions.as_slice())
        })
        .collect();
    let centred = DMatrix::from_columns(&draws);
    &centred * centred.transpose() / 400.0
}

/// The full covariance of 500 points of 5 joints: below 60 ms.
fn moments(c: &mut Criterion) {
    let primitive =
        FourierMovementPrimitive::learn_with(&synthetic(0).unwrap(), HARMONICS, &structured())
            .unwrap();
    let grid = PeriodGrid::new(POINTS, HARMONICS);
    let mut group = c.benchmark_group("trajectory covariance");
    group.sample_size(20);
    group.bench_function("ours", |b| {
        b.iter(|| {
            let moments = primitive.moments(StartSpread::None).unwrap();
            moments.covariance_on_grid(POINTS, Derivative::Position)
        });
    });
    group.bench_function("plain", |b| b.iter(|| plain_moments(&primitive, &grid)));
    group.finish();
}

/// All body poses of the shipped arm: below 1 us.
fn kinematics(c: &mut Criterion) {
    let robot = shipped::robot("wave_arm").unwrap();
    let q = [0.2, 1.2, -1.3, 1.9, 0.1, 0.05];
    let mut poses = robot.body_poses(&q);
    let mut group = c.benchmark_group("kinematics");
    group.bench_function("ours", |b| {
        b.iter(|| robot.body_poses_into(black_box(&q), &mut poses))
    });
    group.bench_function("plain", |b| {
        b.iter(|| plain_kinematics(&robot, black_box(&q)))
    });
    group.finish();
}

criterion_group!(
    stages,
    learning,
    conditioning,
    sampling,
    moments,
    kinematics
);
criterion_main!(stages);

//! A second of tracking at 1 kHz by both plants, beside what of it is plain: on a shared machine, trust the ratios. With `UNDULATE_SHARED` set,
//! on the UR5 there besides the shipped arm; else on the table-top one. `tests/oracle/mujoco_euler.py` prints MuJoCo's real-time factors for the same.
//!
//! `cargo bench --bench simulation` prints medians; figures to be met are in the comments. A second divided by a median is the real-time factor.

use std::path::PathBuf;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use undulate::{
    Control, Dynamics, GRAVITY, MultibodyWorld, Plant, Robot, Simulation, SimulationOptions, Wave,
    shipped,
};

/// The shipped arm, and an industrial one.
fn arms() -> [Robot; 2] {
    let industrial = match std::env::var_os("UNDULATE_SHARED") {
        Some(folder) => Robot::open(&PathBuf::from(folder).join("robots/ur5/ur5_robot.urdf")),
        None => shipped::robot("table_arm"),
    };
    [shipped::robot("wave_arm"), industrial].map(Result::unwrap)
}

/// A wave of 25 harmonics about the middle of the joints' ranges, most of it in the third: 1.5 Hz.
fn wave(robot: &Robot) -> Wave {
    let joints = robot.joints().clone();
    let offsets = DVector::from_fn(joints.len(), |j, _| {
        let range = robot.properties(j).position;
        range.map_or(0.0, |r| r.lower.midpoint(r.upper))
    });
    let weights = DMatrix::from_fn(joints.len(), 25, |j, k| {
        let modulus = if k == 2 { 0.04 } else { 1e-3 / (k + 1) as f64 };
        Complex::from_polar(modulus, (j + k) as f64)
    });
    Wave::new(joints, 2.0, offsets, weights).unwrap()
}

/// Rapier 12.5 ms, which is 80 times real time; Runge-Kutta 4 ms, 250 times. The references: Rapier's steps alone, without motors, and forward
/// dynamics alone, four times a step.
fn simulation(c: &mut Criterion) {
    let mut group = c.benchmark_group("one second at 1 kHz");
    group.sample_size(20);
    for robot in arms() {
        let wave = wave(&robot);
        for plant in [Plant::Rapier, Plant::Rk4] {
            for (what, control) in [
                ("tracking", Control::FeedForward),
                ("falling", Control::Free),
            ] {
                let options = SimulationOptions {
                    plant,
                    control,
                    duration: Some(1.0),
                    ..SimulationOptions::default()
                };
                let simulation = Simulation::new(&robot, options).unwrap();
                let name = BenchmarkId::new(format!("{plant:?} {what}"), robot.name());
                group.bench_function(name, |b| b.iter(|| simulation.run(&wave).unwrap()));
            }
        }
        let (q, v) = (wave.position(0.0), vec![0.0; robot.joints().len()]);
        group.bench_function(BenchmarkId::new("plain Rapier", robot.name()), |b| {
            b.iter(|| {
                let mut world = MultibodyWorld::new(&robot, q.as_slice(), &v, 1e-3).unwrap();
                (0..1000).for_each(|_| world.step());
            });
        });
        let mut dynamics = Dynamics::new(&robot);
        group.bench_function(
            BenchmarkId::new("plain forward dynamics", robot.name()),
            |b| {
                b.iter(|| {
                    (0..4000)
                        .map(|_| {
                            dynamics
                                .forward(&robot, q.as_slice(), &v, &v, &GRAVITY)
                                .unwrap()[0]
                        })
                        .sum::<f64>()
                });
            },
        );
    }
    group.finish();
}

/// Sixteen rollouts by Runge-Kutta on one thread and on two.
fn batch(c: &mut Criterion) {
    let robot = shipped::robot("wave_arm").unwrap();
    let waves = vec![wave(&robot); 16];
    let options = SimulationOptions {
        plant: Plant::Rk4,
        ..SimulationOptions::default()
    };
    let simulation = Simulation::new(&robot, options).unwrap();
    let mut group = c.benchmark_group("sixteen rollouts of two seconds");
    group.sample_size(10);
    for threads in [1, 2] {
        group.bench_function(BenchmarkId::new("threads", threads), |b| {
            b.iter(|| simulation.run_all(&waves, threads, |_, r| r.unwrap().rms_error().max()));
        });
    }
    group.finish();
}

criterion_group!(benches, simulation, batch);
criterion_main!(benches);

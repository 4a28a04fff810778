//! Kinematics and dynamics of two arms of six joints beside plain references: on a shared machine, trust the ratios.
//!
//! `cargo bench --bench dynamics` prints medians; figures to be met are in the comments.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use nalgebra::DVector;
use undulate::{Dynamics, Frame, GRAVITY, Kinematics, MultibodyWorld, Robot, shipped};

/// An arm of the usual industrial order (turn, two lifts, three wrist joints), of masses like a robot's for 5 kg.
fn industrial() -> Robot {
    let mut text = String::from("<robot name=\"industrial\"><link name=\"link_0\"/>");
    let axes = ["0 0 1", "0 1 0", "0 1 0", "0 1 0", "0 0 -1", "0 1 0"];
    let origins = [
        "0 0 0.09",
        "0 0.13 0",
        "0 -0.12 0.43",
        "0 0 0.39",
        "0 0.09 0",
        "0 0 0.09",
    ];
    let masses = [3.7, 8.4, 2.3, 1.2, 1.2, 0.2];
    for (k, ((axis, origin), mass)) in axes.iter().zip(origins).zip(masses).enumerate() {
        text += &format!(
            r#"<link name="link_{child}"><inertial><origin xyz="0 0.02 0.1"/><mass value="{mass}"/>
            <inertia ixx="{i}" ixy="0" ixz="0" iyy="{i}" iyz="0" izz="{i}"/></inertial></link>
            <joint name="joint_{child}" type="revolute"><parent link="link_{k}"/><child link="link_{child}"/>
            <origin xyz="{origin}" rpy="0 {pitch} 0"/><axis xyz="{axis}"/>
            <limit lower="-6" upper="6" velocity="3" effort="150"/></joint>"#,
            child = k + 1,
            i = mass * 0.01,
            pitch = if k == 1 || k == 3 {
                "1.5707963267948966"
            } else {
                "0"
            },
        );
    }
    Robot::from_urdf(&(text + "</robot>")).unwrap()
}

fn arms() -> [Robot; 2] {
    [shipped::robot("wave_arm").unwrap(), industrial()]
}

const Q: [f64; 6] = [0.2, 1.2, -1.3, 1.9, 0.1, 0.05];
const V: [f64; 6] = [1.0, -0.5, 0.3, 2.0, -1.0, 0.7];

/// All body frames: 0.3 us. The reference composes quaternions.
fn kinematics(c: &mut Criterion) {
    let mut group = c.benchmark_group("forward kinematics");
    for robot in arms() {
        let mut frames = vec![Frame::identity(); robot.bodies().len()];
        group.bench_function(BenchmarkId::new("matrices", robot.name()), |b| {
            b.iter(|| robot.body_frames_into(black_box(&Q), &mut frames));
        });
        let mut poses = robot.body_poses(&Q);
        group.bench_function(BenchmarkId::new("quaternions", robot.name()), |b| {
            b.iter(|| robot.body_poses_into(black_box(&Q), &mut poses));
        });
        let mut kinematics = Kinematics::new(&robot);
        let tip = robot.tip();
        group.bench_function(BenchmarkId::new("and Jacobian", robot.name()), |b| {
            b.iter(|| kinematics.link_jacobian(&robot, black_box(&Q), tip)[(0, 0)]);
        });
    }
    group.finish();
}

/// Forces, mass matrix, accelerations. The reference for M is a column of inverse dynamics for each joint.
fn dynamics(c: &mut Criterion) {
    let mut group = c.benchmark_group("dynamics");
    for robot in arms() {
        let mut dynamics = Dynamics::new(&robot);
        group.bench_function(BenchmarkId::new("inverse", robot.name()), |b| {
            b.iter(|| dynamics.inverse(&robot, black_box(&Q), &V, &V, &GRAVITY)[0]);
        });
        group.bench_function(BenchmarkId::new("mass matrix", robot.name()), |b| {
            b.iter(|| dynamics.mass_matrix(&robot, black_box(&Q))[(0, 0)]);
        });
        group.bench_function(
            BenchmarkId::new("mass matrix by columns", robot.name()),
            |b| {
                b.iter(|| {
                    let mut sum = 0.0;
                    for j in 0..6 {
                        let mut unit = [0.0; 6];
                        unit[j] = 1.0;
                        let zero = nalgebra::Vector3::zeros();
                        sum += dynamics.inverse(&robot, black_box(&Q), &[0.0; 6], &unit, &zero)[j];
                    }
                    sum
                });
            },
        );
        group.bench_function(BenchmarkId::new("forward", robot.name()), |b| {
            b.iter(|| {
                dynamics
                    .forward(&robot, black_box(&Q), &V, &V, &GRAVITY)
                    .unwrap()[0]
            });
        });
    }
    group.finish();
}

/// One step of 1 ms: the classical Runge-Kutta method beside a step of Rapier's multibody (first order).
fn step(c: &mut Criterion) {
    let mut group = c.benchmark_group("one step");
    for robot in arms() {
        let mut dynamics = Dynamics::new(&robot);
        let mut slopes: [[DVector<f64>; 2]; 4] =
            std::array::from_fn(|_| std::array::from_fn(|_| DVector::zeros(6)));
        group.bench_function(BenchmarkId::new("Runge-Kutta 4", robot.name()), |b| {
            let (mut q, mut v) = (DVector::from_row_slice(&Q), DVector::from_row_slice(&V));
            let (mut at, mut rate) = (q.clone(), v.clone());
            b.iter(|| {
                let dt = 1e-3;
                for (k, share) in [0.0, 0.5, 0.5, 1.0].into_iter().enumerate() {
                    at.copy_from(&q);
                    rate.copy_from(&v);
                    if k > 0 {
                        at.axpy(share * dt, &slopes[k - 1][0], 1.0);
                        rate.axpy(share * dt, &slopes[k - 1][1], 1.0);
                    }
                    let a = dynamics.forward(
                        &robot,
                        at.as_slice(),
                        rate.as_slice(),
                        &[0.0; 6],
                        &GRAVITY,
                    );
                    slopes[k][1].as_mut_slice().copy_from_slice(a.unwrap());
                    slopes[k][0].copy_from(&rate);
                }
                for (slope, weight) in slopes.iter().zip([1.0, 2.0, 2.0, 1.0]) {
                    q.axpy(weight * dt / 6.0, &slope[0], 1.0);
                    v.axpy(weight * dt / 6.0, &slope[1], 1.0);
                }
            });
        });
        group.bench_function(BenchmarkId::new("Rapier", robot.name()), |b| {
            let mut world = MultibodyWorld::new(&robot, &Q, &V, 1e-3).unwrap();
            b.iter(|| world.step());
        });
    }
    group.finish();
}

criterion_group!(benches, kinematics, dynamics, step);
criterion_main!(benches);

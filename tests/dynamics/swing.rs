//! Free swings: energy is kept, and Pinocchio's swing is met.

use nalgebra::DVector;
use undulate::{Dynamics, GRAVITY, Robot, shipped};

use crate::common::shared;

/// One step of the classical Runge-Kutta method without forces at the joints.
fn step(
    robot: &Robot,
    dynamics: &mut Dynamics,
    q: &mut DVector<f64>,
    v: &mut DVector<f64>,
    dt: f64,
) {
    let tau = vec![0.0; q.len()];
    let mut slope = |q: &DVector<f64>, v: &DVector<f64>| {
        let a = dynamics
            .forward(robot, q.as_slice(), v.as_slice(), &tau, &GRAVITY)
            .unwrap();
        (v.clone(), DVector::from_column_slice(a))
    };
    let (q1, v1) = slope(q, v);
    let (q2, v2) = slope(&(&*q + &q1 * (dt / 2.0)), &(&*v + &v1 * (dt / 2.0)));
    let (q3, v3) = slope(&(&*q + &q2 * (dt / 2.0)), &(&*v + &v2 * (dt / 2.0)));
    let (q4, v4) = slope(&(&*q + &q3 * dt), &(&*v + &v3 * dt));
    *q += (q1 + 2.0 * q2 + 2.0 * q3 + q4) * (dt / 6.0);
    *v += (v1 + 2.0 * v2 + 2.0 * v3 + v4) * (dt / 6.0);
}

/// The largest share of the kinetic energy by which the sum of both energies leaves its start within half a second.
fn drift(robot: &Robot, steps: usize) -> f64 {
    let mut dynamics = Dynamics::new(robot);
    let mut q = DVector::from_element(robot.joints().len(), 0.4);
    let mut v = DVector::zeros(q.len());
    let start = dynamics.potential_energy(robot, q.as_slice(), &GRAVITY);
    let (mut worst, mut most) = (0.0_f64, 0.0_f64);
    for _ in 0..steps {
        step(robot, &mut dynamics, &mut q, &mut v, 0.5 / steps as f64);
        let kinetic = dynamics.kinetic_energy(robot, q.as_slice(), v.as_slice());
        let total = kinetic + dynamics.potential_energy(robot, q.as_slice(), &GRAVITY);
        worst = worst.max((total - start).abs());
        most = most.max(kinetic);
    }
    worst / most
}

#[test]
fn a_free_swing_keeps_its_energy_to_the_order_of_the_method() {
    let robot = shipped::robot("wave_arm").unwrap();
    let (coarse, fine) = (drift(&robot, 1000), drift(&robot, 2000));
    println!("{coarse:e} {fine:e}");
    assert!(fine < 1e-9, "{fine:e}");
    // Fourth order: a sixteenth of the error; a first-order fault in M, C or g would leave the drift as it was.
    assert!(fine < coarse / 12.0, "{coarse:e} {fine:e}");
}

#[test]
fn pinocchio_swings_the_same_way() {
    let Some(folder) = shared("Pinocchio's free swing of a UR5") else {
        return;
    };
    let robot = Robot::open(&folder.join("robots/ur5/ur5_robot.urdf")).unwrap();
    let text = std::fs::read_to_string(folder.join("oracle/ur5_free_swing.csv")).unwrap();
    // Runge-Kutta with the step that the file's first line names, so that both are wrong by the same amount.
    let dt = 1e-4;
    assert!(text.lines().next().unwrap().contains("RK4 at 1e-4 s"));
    let rows = text.lines().skip(1).map(|line| {
        let numbers = line.split(',').map(|x| x.parse().unwrap());
        numbers.collect::<Vec<f64>>()
    });
    let mut dynamics = Dynamics::new(&robot);
    let (mut q, mut v) = (DVector::zeros(6), DVector::zeros(6));
    let (mut done, mut worst, mut rows_seen) = (0, 0.0_f64, 0);
    for row in rows {
        let expected = DVector::from_column_slice(&row[1..7]);
        if rows_seen == 0 {
            q.copy_from(&expected);
        }
        let until = (row[0] / dt).round() as usize;
        for _ in done..until {
            step(&robot, &mut dynamics, &mut q, &mut v, dt);
        }
        done = until;
        worst = worst.max((&q - expected).amax());
        rows_seen += 1;
    }
    println!("{worst:e} rad after {rows_seen} rows");
    assert!(
        rows_seen > 40 && worst < 1e-8,
        "{worst:e} rad, {rows_seen} rows"
    );
}

//! Free swings of a UR5 against Pinocchio's Runge-Kutta, and of both plants against each other.

use undulate::nalgebra::DVector;
use undulate::{Control, Dynamics, GRAVITY, Plant, Robot, Simulation, SimulationOptions, shipped};

use crate::common::shared;
use crate::{still, told, with};

/// Where the joints are after a second of falling from `posture`, and every 50 ms before.
fn fall(robot: &Robot, posture: &[f64], plant: Plant, time_step: f64) -> Vec<DVector<f64>> {
    let options = SimulationOptions {
        control: Control::Free,
        time_step,
        duration: Some(1.0),
        ..with(plant)
    };
    let simulation = Simulation::new(robot, options).unwrap();
    let rollout = simulation.run(&still(robot, posture)).unwrap();
    let every = (0.05 / time_step).round() as usize;
    (0..=20)
        .map(|n| rollout.position.row(n * every).transpose())
        .collect()
}

/// How far semi-implicit Euler, which is MuJoCo's without damping, is off after a second at 1 ms.
fn euler(robot: &Robot, start: &[f64], end: &[f64]) -> f64 {
    let mut dynamics = Dynamics::new(robot);
    let (mut q, mut v) = (DVector::from_row_slice(start), DVector::zeros(6));
    for _ in 0..1000 {
        let a = dynamics.forward(robot, q.as_slice(), v.as_slice(), &[0.0; 6], &GRAVITY);
        v += DVector::from_row_slice(a.unwrap()) * 1e-3;
        q += &v * 1e-3;
    }
    (q - DVector::from_row_slice(end)).amax()
}

#[test]
fn the_ur5_swings_as_pinocchio_has_it() {
    let Some(folder) = shared("Pinocchio's free swing of a UR5") else {
        return;
    };
    // Pinocchio's has no stops, and passes one of the UR5's before the second is over.
    let urdf = std::fs::read_to_string(folder.join("robots/ur5/ur5_robot.urdf")).unwrap();
    let urdf = urdf
        .replace("6.28318530718", "60")
        .replace("3.14159265359", "60");
    let robot = Robot::from_urdf(&urdf).unwrap();
    let text = std::fs::read_to_string(folder.join("oracle/ur5_free_swing.csv")).unwrap();
    let rows: Vec<Vec<f64>> = text
        .lines()
        .skip(1)
        .take(21)
        .map(|line| line.split(',').map(|x| x.parse().unwrap()).collect())
        .collect();
    assert!((rows[20][0] - 1.0).abs() < 1e-12);
    let error = |plant, time_step| {
        let fallen = fall(&robot, &rows[0][1..7], plant, time_step);
        let last = DVector::from_row_slice(&rows[20][1..7]);
        let off = fallen.iter().zip(&rows);
        let worst = off
            .map(|(q, row)| (q - DVector::from_row_slice(&row[1..7])).amax())
            .fold(0.0, f64::max);
        ((&fallen[20] - last).amax(), worst)
    };
    let (rk4, worst) = error(Plant::Rk4, 1e-3);
    println!("RK4: {rk4:.1e} rad after 1 s at 1 ms, at most {worst:.1e}");
    assert!(worst < 1e-8, "{worst:e}");
    let rapier = [2e-3, 1e-3, 5e-4].map(|dt| error(Plant::Rapier, dt).0);
    println!("Rapier: {} rad after 1 s at 2, 1, 0.5 ms", told(&rapier));
    let euler = euler(&robot, &rows[0][1..7], &rows[20][1..7]);
    println!("semi-implicit Euler: {euler:.2e} rad after 1 s at 1 ms");
    assert!(rapier[1] < euler, "{rapier:?}");
    // First order: half the step, half the error.
    for pair in rapier.windows(2) {
        assert!((1.8..2.3).contains(&(pair[0] / pair[1])), "{rapier:?}");
    }
}

#[test]
fn two_plants_fall_the_same_way() {
    for name in ["wave_arm", "table_arm", "column_arm"] {
        let robot = shipped::robot(name).unwrap();
        let mut posture = robot.rest();
        for (j, q) in posture.iter_mut().enumerate() {
            let range = robot.properties(j).position;
            *q = range.map_or(*q, |r| r.lower.midpoint(r.upper)) + 0.1;
        }
        // For a fifth of a second, before anything meets its stop.
        let apart = [1e-3, 5e-4].map(|dt| {
            let rapier = fall(&robot, &posture, Plant::Rapier, dt);
            let rk4 = fall(&robot, &posture, Plant::Rk4, dt);
            (&rapier[4] - &rk4[4]).amax()
        });
        println!(
            "{name}: {} rad apart after 0.2 s at 1 and 0.5 ms",
            told(&apart)
        );
        assert!((1.8..2.2).contains(&(apart[0] / apart[1])), "{apart:?}");
    }
}

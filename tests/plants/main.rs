//! Two plants: tracking, free swings, energy, disturbances, what is refused, and the same bits on any number of threads.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/waves.rs"]
mod waves;

mod batch;
mod energy;
mod loads;
mod observer;
mod refused;
mod swing;
mod tracking;

use undulate::nalgebra::{DMatrix, DVector};
use undulate::{Plant, Robot, SimulationOptions, Wave, shipped};

use common::shared;

const PLANTS: [Plant; 2] = [Plant::Rapier, Plant::Rk4];

/// The shipped arm, and the UR5 where it is at hand.
fn arms() -> Vec<Robot> {
    let mut arms = vec![shipped::robot("wave_arm").unwrap()];
    if let Some(folder) = shared("the UR5") {
        arms.push(Robot::open(&folder.join("robots/ur5/ur5_robot.urdf")).unwrap());
    }
    arms
}

/// All joints held still.
fn still(robot: &Robot, posture: &[f64]) -> Wave {
    let joints = robot.joints().clone();
    let weights = DMatrix::zeros(joints.len(), 1);
    Wave::new(joints, 1.0, DVector::from_row_slice(posture), weights).unwrap()
}

fn with(plant: Plant) -> SimulationOptions {
    SimulationOptions {
        plant,
        ..SimulationOptions::default()
    }
}

/// Numbers of many sizes in a line.
fn told(numbers: &[f64]) -> String {
    let told: Vec<String> = numbers.iter().map(|x| format!("{x:.1e}")).collect();
    told.join(", ")
}

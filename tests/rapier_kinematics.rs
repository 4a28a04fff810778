//! Forward kinematics against Rapier's multibody, over random configurations.

mod common;

use common::shared;
use rand::RngExt;
use undulate::{MultibodyWorld, Robot, shipped, stream};

const CONFIGURATIONS: u64 = 200;

fn compare(robot: &Robot) {
    let still = vec![0.0; robot.joints().len()];
    for seed in 0..CONFIGURATIONS {
        let mut rng = stream(seed, 0);
        let q: Vec<f64> = (0..robot.joints().len())
            .map(|j| {
                let (low, high) = robot
                    .properties(j)
                    .position
                    .map_or((-3.0, 3.0), |p| (p.lower.max(-6.0), p.upper.min(6.0)));
                low + (high - low) * rng.random::<f64>()
            })
            .collect();
        let world = MultibodyWorld::new(robot, &q, &still, 1e-3).unwrap();
        for ((body, ours), theirs) in robot
            .bodies()
            .iter()
            .zip(robot.body_poses(&q))
            .zip(world.body_poses())
        {
            let offset = (ours.translation.vector - theirs.translation.vector).norm();
            // Twice the sine of half the angle: the arccos of `angle_to` would cost half of the digits.
            let angle = 2.0 * ours.rotation.rotation_to(&theirs.rotation).imag().norm();
            assert!(
                offset < 1e-12 && angle < 1e-12,
                "{} {}: {offset:e} m, {angle:e} rad",
                robot.name(),
                body.name
            );
        }
    }
}

#[test]
fn every_shipped_robot_agrees() {
    for name in shipped::robots() {
        compare(&shipped::robot(name).unwrap());
    }
}

#[test]
fn three_real_robots_agree() {
    let Some(folder) = shared("Rapier's kinematics of real robots") else {
        return;
    };
    for file in [
        "ur5/ur5_robot.urdf",
        "kuka_kr16_2/kr16_2.urdf",
        "wx250s_6dof/wx250s.urdf",
    ] {
        compare(&Robot::open(&folder.join("robots").join(file)).unwrap());
    }
}

//! Sampled waves on the shipped arm: limits, self-collision, tracking.

use rand::distr::Distribution;
use undulate::{
    CollisionModel, CollisionOptions, FourierMovementPrimitive, LearnOptions, Observation,
    Simulation, SimulationOptions, Verdict, Wave, shipped, stream, synthetic,
};

/// The first draw of a seed that passes, and how many were drawn.
fn redrawn(primitive: &FourierMovementPrimitive, seed: u64) -> (Wave, u64) {
    let robot = shipped::robot("wave_arm").unwrap();
    let collision = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
    let map = shipped::map("wave_arm_demonstrator").unwrap();
    for draw in 0..1000 {
        let wave = map
            .apply(&primitive.sample(&mut stream(seed, draw)), &robot)
            .unwrap();
        let verdict = Verdict::of(&robot, &collision, &wave, 0.0).unwrap();
        if verdict.passes() {
            return (wave, draw + 1);
        }
    }
    panic!("no draw of seed {seed} passes");
}

#[test]
fn twenty_seeds_a_condition_are_tracked_without_touching() {
    let robot = shipped::robot("wave_arm").unwrap();
    let collision = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
    let primitive =
        FourierMovementPrimitive::learn_with(&synthetic(0).unwrap(), 25, &LearnOptions::paper())
            .unwrap();
    let simulation = Simulation::new(&robot, SimulationOptions::default()).unwrap();
    let mut drawn = 0;
    for condition in [
        Observation::modulus("elbow_flexion", 10, 5f64.to_radians()),
        Observation::modulus("wrist_deviation", 20, 4f64.to_radians()),
    ] {
        let conditioned = primitive.condition(&[condition]).unwrap();
        for seed in 0..20 {
            let (wave, draws) = redrawn(&conditioned, seed);
            drawn += draws;
            let rollout = simulation.run(&wave).unwrap();
            println!(
                "seed {seed} rms {:.1e} peak {:.1e} draws {draws} torque {:.1}",
                rollout.rms_error().max(),
                rollout.peak_error().max(),
                rollout.peak_torque().max()
            );
            assert!(
                rollout.rms_error().max() < 5e-5,
                "seed {seed}: {}",
                rollout.rms_error()
            );
            assert_eq!(rollout.saturated, [0; 6], "seed {seed}");
            for (j, torques) in rollout.torque.column_iter().enumerate() {
                let peak = torques.iter().fold(0.0, |a: f64, t| a.max(t.abs()));
                assert_eq!(rollout.peak_torque()[j], peak, "seed {seed}, joint {j}");
            }
            // What was achieved keeps limits and distance too.
            for q in rollout.position.row_iter() {
                let q: Vec<f64> = q.iter().copied().collect();
                assert!(collision.collision(&q).is_none(), "seed {seed}");
                for (j, position) in q.iter().enumerate() {
                    let limit = robot.properties(j).position.unwrap();
                    assert!(limit.contains(*position), "seed {seed}, joint {j}");
                }
            }
            for (j, limit) in (0..6).map(|j| (j, robot.properties(j).velocity.unwrap())) {
                assert!(
                    rollout.velocity.column(j).amax() <= limit,
                    "seed {seed}, joint {j}"
                );
            }
        }
    }
    println!("{drawn} draws for 40 waves");
}

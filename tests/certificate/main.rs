//! No wave is proven clear that touches, and none is said to touch that does not: against parry on a grid of a kilohertz.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/dense.rs"]
mod dense;
#[path = "../common/waves.rs"]
mod waves;

use dense::Dense;
use undulate::{Certification, CollisionModel, CollisionOptions, Robot, shipped, stream};
use waves::random_wave;

/// Of waves on one robot.
#[derive(Default, Debug)]
struct Tally {
    clear: usize,
    collides: usize,
    undecided: usize,
}

fn fuzz(robot: &Robot, model: &CollisionModel, seed: u64, waves: u64) -> Tally {
    let dense = Dense::new(robot, model);
    let mut prover = model.prover();
    let mut tally = Tally::default();
    for number in 0..waves {
        let mut rng = stream(seed, number);
        let wave = random_wave(robot, 26, 6.7, 0.6, &mut rng);
        match prover.certify(&wave, 0.0, &[]).unwrap() {
            Certification::Clear { bound, .. } => {
                tally.clear += 1;
                let sampled = dense.clearance(robot, &wave, 1000.0, bound.distance - 1e-9);
                assert!(
                    sampled > 0.0 && sampled >= bound.distance - 1e-9,
                    "wave {number}: {bound:?}, sampled {sampled}"
                );
            }
            Certification::Collides { witness, .. } => {
                tally.collides += 1;
                let q = wave.position(witness.time);
                let sampled = dense.at(robot, q.as_slice(), f64::INFINITY);
                assert!(
                    sampled <= 1e-9,
                    "wave {number}: {witness:?}, sampled {sampled}"
                );
            }
            Certification::Undecided { .. } => tally.undecided += 1,
        }
    }
    tally
}

#[test]
fn no_false_certificate_and_no_false_rejection() {
    let robot = shipped::robot("wave_arm").unwrap();
    let model = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
    let tally = fuzz(&robot, &model, 1, 300);
    println!("wave_arm: {tally:?}");
    assert!(tally.clear > 30 && tally.collides > 30, "{tally:?}");
    assert!(tally.undecided == 0, "{tally:?}");
}

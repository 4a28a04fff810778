//! A bound that is halved on purpose is caught: the same fuzz, on motions that understate how far they go.

#[path = "../common/halved.rs"]
mod motion;

use undulate::{Certification, CollisionModel, CollisionOptions, stream};

use crate::dense::Dense;
use crate::robots::{THIN, carousel};
use crate::waves::random_wave;
use motion::Halved;

#[test]
fn a_bound_that_is_halved_is_caught() {
    let robot = carousel(THIN);
    let model = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
    let dense = Dense::new(&robot, &model);
    let mut prover = model.prover();
    let caught = (0..1000).find(|number| {
        let wave = random_wave(&robot, 26, 6.7, 2.0, &mut stream(5, *number));
        let Certification::Collides { witness, .. } = prover.certify(&wave, 0.0, &[]).unwrap()
        else {
            return false;
        };
        assert!(
            dense.at(
                &robot,
                wave.position(witness.time).as_slice(),
                f64::INFINITY
            ) < 1e-9
        );
        prover.certify(&Halved(wave), 0.0, &[]).unwrap().is_clear()
    });
    println!("caught by wave {caught:?}");
    assert!(caught.is_some());
}

//! Files of every released version load, and a model file and a seed give the same wave to the last bit.
//!
//! A change of these numbers is a change for every user who keeps model files and seeds: it needs a reason in the changelog.

use rand::distr::Distribution;
use undulate::{FourierMovementPrimitive, Wave, stream};

#[test]
fn version_1_draws_the_wave_it_always_drew() {
    let primitive =
        FourierMovementPrimitive::from_json(include_str!("fixtures/model_v1.json")).unwrap();
    let golden = include_str!("fixtures/wave_v1.json");
    let wave = primitive.sample(&mut stream(5, 2));
    assert_eq!(wave.to_json(), golden);
    assert_eq!(Wave::from_json(golden).unwrap(), wave);
}

//! Files of every released version load, and a model file and a seed give the same wave to the last bit.
//!
//! A change of these numbers is a change for every user who keeps model files and seeds: it needs a reason in the changelog.
//! Where there is one, `UNDULATE_REGENERATE=1 cargo test --test golden` writes the waves anew.

use std::path::Path;

use rand::distr::Distribution;
use undulate::{FourierMovementPrimitive, Wave, stream};

/// `model_{name}.json` and the wave that sample 2 of seed 5 is, `wave_{name}.json`.
fn draws_the_wave_it_always_drew(name: &str) {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures");
    let model = std::fs::read_to_string(fixtures.join(format!("model_{name}.json"))).unwrap();
    let primitive = FourierMovementPrimitive::from_json(&model).unwrap();
    let wave = primitive.sample(&mut stream(5, 2));
    let golden = fixtures.join(format!("wave_{name}.json"));
    if std::env::var_os("UNDULATE_REGENERATE").is_some() {
        std::fs::write(&golden, wave.to_json()).unwrap();
    }
    let golden = std::fs::read_to_string(golden).unwrap();
    assert_eq!(wave.to_json(), golden);
    assert_eq!(Wave::from_json(&golden).unwrap(), wave);
}

#[test]
fn version_1_draws_the_wave_it_always_drew() {
    draws_the_wave_it_always_drew("v1");
}

/// Relative phases, Kronecker blocks, a uniform phase, logarithmic offsets, observations.
#[test]
fn version_2_draws_the_wave_it_always_drew() {
    draws_the_wave_it_always_drew("v2");
}

/// Cycles on a ring.
#[test]
fn cycles_of_version_2_draw_the_wave_they_always_drew() {
    draws_the_wave_it_always_drew("v2_cycles");
}

//! Files of every released version load, and a model file and a seed give the same wave to the last bit. A certificate that was written once still
//! verifies, and is written so again.
//!
//! A change of a wave's numbers is a change for every user who keeps model files and seeds: it needs a reason in the changelog. What a certificate
//! holds may change more freely: a tighter bound, another order of the search or another first cover of the motion gives other intervals, and
//! `clearance_above_m` with them. What may not change is that files of earlier versions verify, and so neither may `geometry_sha256`.
//!
//! Where there is a reason, `UNDULATE_REGENERATE=1 cargo test --test golden` writes waves and certificate anew. Run it without first: that the
//! certificate from before verifies is looked at before its numbers are.

use std::path::Path;

use rand::distr::Distribution;
use undulate::{FourierMovementPrimitive, Mixture, Wave, stream};

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

/// A kind by its weight, then its wave; conditioned, so that weights were evidence once.
#[test]
fn a_mixture_of_version_1_draws_the_waves_it_always_drew() {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures");
    let model = std::fs::read_to_string(fixtures.join("mixture_v1.json")).unwrap();
    let mixture = Mixture::from_json(&model).unwrap();
    // One of each kind.
    for (name, index) in [("a", 0), ("b", 2)] {
        let wave = mixture.sample(&mut stream(5, index));
        let golden = fixtures.join(format!("wave_mixture_v1_{name}.json"));
        if std::env::var_os("UNDULATE_REGENERATE").is_some() {
            std::fs::write(&golden, wave.to_json()).unwrap();
        }
        assert_eq!(wave.to_json(), std::fs::read_to_string(golden).unwrap());
    }
    assert_eq!(mixture.to_json(), model);
}

#[cfg(feature = "robot")]
mod certificate {
    use std::path::Path;

    use nalgebra::{DMatrix, DVector};
    use num_complex::Complex;
    use undulate::{Certificate, CollisionModel, CollisionOptions, Evidence, Robot, Wave};

    /// Two balls on arms that turn about one post, one of them geared to a bar between.
    const URDF: &str = r#"<robot name="carousel"><link name="post"/>
        <link name="one"><collision><origin xyz="1 0 0"/><geometry><sphere radius="0.1"/></geometry></collision></link>
        <link name="two"><collision><origin xyz="1 0 0.05"/><geometry><box size="0.1 0.2 0.1"/></geometry></collision></link>
        <link name="bar"><collision><origin xyz="0 0 0.3"/><geometry><cylinder radius="0.05" length="1"/></geometry></collision></link>
        <joint name="first" type="continuous"><parent link="post"/><child link="one"/><axis xyz="0 0 1"/></joint>
        <joint name="second" type="continuous"><parent link="post"/><child link="two"/><axis xyz="0 0.1 1"/></joint>
        <joint name="third" type="continuous"><parent link="post"/><child link="bar"/><axis xyz="0 1 0"/>
        <mimic joint="second" multiplier="0.2"/></joint></robot>"#;

    /// The arms swing towards each other.
    fn wave(robot: &Robot) -> Wave {
        let number = Complex::new;
        let weights = [
            [number(0.1, 0.05), number(0.0, -0.03)],
            [number(-0.1, 0.1), number(0.05, 0.0)],
        ];
        let weights = DMatrix::from_fn(2, 2, |joint, k| weights[joint][k]);
        let offsets = DVector::from_vec(vec![0.0, 0.75]);
        Wave::new(robot.joints().clone(), 2.5, offsets, weights).unwrap()
    }

    #[test]
    fn a_certificate_holds_and_is_the_one_it_always_was() {
        let robot = Robot::from_urdf(URDF).unwrap();
        let (wave, options) = (wave(&robot), CollisionOptions::default());
        let model = CollisionModel::new(&robot, &options).unwrap();
        let rests_on = vec![Evidence::new("urdf", "carousel.urdf", URDF.as_bytes())];
        let (_, made) = model
            .prover()
            .certificate(&robot, &wave, 0.02, &[1e-3; 2], rests_on, Vec::new())
            .unwrap();
        let made = made.expect("a proof").to_json();
        let golden =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/certificate_v1.json");
        if std::env::var_os("UNDULATE_REGENERATE").is_some() {
            std::fs::write(&golden, &made).unwrap();
        }
        let golden = std::fs::read_to_string(golden).unwrap();
        let verified = |text: &str| Certificate::from_json(text)?.verify(&robot, &wave, &options);
        assert!(verified(&golden).unwrap().spare > 0.0);
        assert_eq!(made, golden);
        // It is looked at: with half a metre it proves too much.
        let bolder = golden.replacen("\"margin_m\":0.02", "\"margin_m\":0.52", 1);
        assert_ne!(bolder, golden);
        assert!(verified(&bolder).is_err());
    }
}

//! Certificates that are written hold when verified, and what they cannot say is refused.

use undulate::{
    Certificate, Certification, CollisionModel, CollisionOptions, Robot, Spline, StartPosture,
    Waypoint, Waypoints, stream,
};

use crate::robots::{carousel, robots};
use crate::waves::random_wave;

#[test]
fn what_is_written_is_verified() {
    let mut verified = 0;
    for (name, robot, options, _) in robots() {
        let model = CollisionModel::new(&robot, &options).unwrap();
        let mut prover = model.prover();
        let touching = (100..)
            .map(|number| random_wave(&robot, 26, 6.7, 0.6, &mut stream(11, number)))
            .find(|wave| {
                matches!(
                    prover.certify(wave, 0.0, &[]),
                    Ok(Certification::Collides { .. })
                )
            })
            .unwrap();
        for number in 0..12 {
            let wave = random_wave(&robot, 26, 6.7, 0.6, &mut stream(11, number));
            let (certification, certificate) = prover
                .certificate(&robot, &wave, 0.0, &[], Vec::new(), Vec::new())
                .unwrap();
            assert_eq!(certification.is_clear(), certificate.is_some());
            let Some(certificate) = certificate else {
                continue;
            };
            let read = Certificate::from_json(&certificate.to_json()).unwrap();
            assert_eq!(read, certificate);
            let found = read.verify(&robot, &wave, &options);
            assert!(found.is_ok(), "{name}, wave {number}: {found:?}");
            // Of a motion that touches it says nothing.
            assert!(
                read.verify(&robot, &touching, &options).is_err(),
                "{name}, wave {number}"
            );
            verified += 1;
        }
    }
    println!("{verified} certificates verified");
    assert!(verified > 10);
}

#[test]
fn a_margin_or_tolerance_that_is_none_is_refused() {
    let robot = carousel(0.1);
    let options = CollisionOptions::default();
    let model = CollisionModel::new(&robot, &options).unwrap();
    let still = move_of(&robot, &[0.0, 1.0], &[0.1, 1.0]);
    let (_, made) = model
        .prover()
        .certificate(&robot, &still, 0.02, &[1e-3; 2], Vec::new(), Vec::new())
        .unwrap();
    let text = made.expect("a proof").to_json();
    let verified = |text: &str| Certificate::from_json(text)?.verify(&robot, &still, &options);
    assert!(verified(&text).is_ok());
    for (now, then) in [
        ("\"margin_m\":0.02", "\"margin_m\":-0.02"),
        ("0.001", "-0.001"),
    ] {
        let broken = text.replacen(now, then, 1);
        assert_ne!(broken, text);
        let error = verified(&broken).unwrap_err().to_string();
        assert!(error.contains("that is none"), "{error}");
    }
}

/// A sphere on a slider, one above it on a mast, and a sphere that a third joint turns: the last two overlap by 10 mm whatever the joints do.
fn sledge() -> Robot {
    let link = |name: &str, radius: f64| {
        format!(
            r#"<link name="{name}"><collision><geometry><sphere radius="{radius}"/></geometry></collision></link>"#
        )
    };
    let joint = |name: &str, kind: &str, parent: &str, child: &str, z: f64, rest: &str| {
        format!(
            r#"<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/><origin xyz="0 0 {z}"/><axis xyz="0 1 0"/>
            <limit lower="-1" upper="1" velocity="1e9"/>{rest}</joint>"#
        )
    };
    let mimic = r#"<mimic joint="j0" multiplier="1e9"/>"#;
    Robot::from_urdf(&format!(
        r#"<robot name="sledge"><link name="base"/><link name="dummy"/>{}<link name="mid"/>{}{}{}{}{}</robot>"#,
        link("car", 0.55),
        link("arm", 0.56),
        joint("j0", "prismatic", "base", "dummy", 0.0, ""),
        joint("lift", "prismatic", "base", "car", 0.0, mimic),
        joint("j1", "revolute", "car", "mid", 1.1, ""),
        joint("j2", "revolute", "mid", "arm", 0.0, ""),
    ))
    .unwrap()
}

/// Two postures, a second apart.
fn move_of(robot: &Robot, from: &[f64], to: &[f64]) -> Spline {
    let waypoints = [(0.0, from), (1.0, to)].map(|(time, positions)| Waypoint {
        time,
        positions,
        velocities: None,
        accelerations: None,
    });
    let waypoints = Waypoints::new(robot.joints().clone(), waypoints);
    Spline::new(&waypoints.unwrap(), StartPosture::Given).unwrap()
}

#[test]
fn digits_that_a_far_slider_costs_are_paid_for() {
    let robot = sledge();
    let options = CollisionOptions {
        kept: vec![("car".to_owned(), "arm".to_owned())],
        ..CollisionOptions::default()
    };
    let model = CollisionModel::new(&robot, &options).unwrap();
    for far in [0.0, 1.0, 1e3, 1e7] {
        let motion = move_of(&robot, &[far, 0.0, 0.0], &[far, 0.1, 0.0]);
        let found = model.certify(&motion, 0.0, &[]).unwrap();
        assert!(!found.is_clear(), "at {far}: {found:?}");
    }
}

#[test]
fn a_refutation_leaves_nothing_behind() {
    let robot = carousel(0.1);
    let model = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
    let through = move_of(&robot, &[0.0, 1.0], &[2.0, 1.0]);
    let still = move_of(&robot, &[0.0, 1.0], &[0.1, 1.0]);
    let mut prover = model.prover();
    let fresh = model.certify(&still, 0.0, &[]).unwrap();
    for _ in 0..3 {
        assert!(matches!(
            prover.certify(&through, 0.0, &[]).unwrap(),
            Certification::Collides { .. }
        ));
        assert_eq!(prover.certify(&still, 0.0, &[]).unwrap(), fresh);
        prover.certify(&through, 0.0, &[]).unwrap();
        let kept = prover
            .certificate(&robot, &still, 0.0, &[], Vec::new(), Vec::new())
            .unwrap();
        assert!(kept.1.is_some());
    }
}

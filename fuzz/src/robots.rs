//! Inputs of the robot half: robots, scenes, maps, moves, meshes, certificates.

use std::sync::LazyLock;

use undulate::nalgebra::{DMatrix, DVector};
use undulate::num_complex::Complex;
use undulate::{
    Certificate, CollisionModel, CollisionOptions, Derivative, Dynamics, GRAVITY, JointLimits,
    JointMap, Joints, Mesh, Motion, PlayMotion, Robot, Scene, Spline, Srdf, StartPosture, Wave,
    Waypoints, shipped,
};

use super::text;

/// Moves of more numbers are read and not used.
const USED: usize = 2_000;

/// Robots of more links are read and not put through everything.
const LINKS: usize = 60;

static ARM: LazyLock<Robot> =
    LazyLock::new(|| shipped::robot("wave_arm").expect("a robot that is shipped"));

pub fn urdf(data: &[u8]) {
    let Some(Ok(robot)) = text(data).map(Robot::from_urdf) else {
        return;
    };
    if robot.links().len() > LINKS {
        return;
    }
    let _ = (robot.doubts().len(), robot.tips().len());
    let rest = robot.rest();
    assert_eq!(robot.body_poses(&rest).len(), robot.bodies().len());
    if robot.require_dynamics().is_ok() {
        let still = vec![0.0; rest.len()];
        let mut dynamics = Dynamics::new(&robot);
        let _ = dynamics.inverse(&robot, &rest, &still, &still, &GRAVITY);
    }
    if let Ok(model) = CollisionModel::new(&robot, &CollisionOptions::default()) {
        let is_checked = model.pairs().iter().any(|pair| pair.is_checked());
        assert_eq!(model.clearance(&rest).is_some(), is_checked);
    }
}

pub fn srdf(data: &[u8]) {
    let Some(Ok(srdf)) = text(data).map(Srdf::from_xml) else {
        return;
    };
    let _ = srdf.told(&ARM);
    let options = CollisionOptions {
        disabled: srdf.disabled().to_vec(),
        ..CollisionOptions::default()
    };
    CollisionModel::new(&ARM, &options).expect("an SRDF only leaves out pairs");
}

pub fn scene(data: &[u8]) {
    let Some(Ok(scene)) = text(data).map(Scene::from_toml) else {
        return;
    };
    if scene.objects().len() > LINKS {
        return;
    }
    let options = CollisionOptions {
        scene,
        ..CollisionOptions::default()
    };
    if let Ok(model) = CollisionModel::new(&ARM, &options) {
        let clearance = model
            .clearance(&ARM.rest())
            .expect("pairs of the arm are checked");
        assert!(!clearance.distance.is_nan(), "{clearance:?}");
    }
}

pub fn joint_map(data: &[u8]) {
    let Some(Ok(map)) = text(data).map(JointMap::from_toml) else {
        return;
    };
    let joints = Joints::new(["elbow_flexion", "wrist_deviation"]).expect("two names");
    let weights = DMatrix::from_element(2, 2, Complex::new(0.1, 0.05));
    let wave = Wave::new(joints, 2.0, DVector::from_element(2, 0.2), weights).expect("a wave");
    if let Ok(mapped) = map.apply(&wave, &ARM) {
        assert_eq!(mapped.joints(), ARM.joints());
    }
}

pub fn limits(data: &[u8]) {
    let _ = text(data).map(JointLimits::from_toml);
}

pub fn moves(data: &[u8]) {
    let mut read = vec![
        Waypoints::from_csv("fuzzed.csv", data, false),
        Waypoints::from_csv("fuzzed.csv", data, true),
        Waypoints::from_json("fuzzed.json", data),
    ];
    if let Ok(file) = PlayMotion::read("fuzzed.yaml", data) {
        read.extend(file.iter().map(|(_, waypoints)| Ok(waypoints.clone())));
    }
    for waypoints in read.into_iter().flatten() {
        if waypoints.len() * waypoints.joints().len() > USED {
            continue;
        }
        if let Ok(text) = waypoints.to_csv() {
            let again = Waypoints::from_csv("printed.csv", &text, false);
            assert_eq!(again.expect("a move that was printed"), waypoints);
        }
        if let Ok(text) = waypoints.to_json() {
            Waypoints::from_json("printed.json", &text).expect("a move that was printed");
        }
        for start in [StartPosture::Given, StartPosture::AtFirstWaypoint] {
            let Ok(spline) = Spline::new(&waypoints, start) else {
                continue;
            };
            for joint in 0..waypoints.joints().len() {
                let range = spline.range(joint, Derivative::Position);
                let start = waypoints.get(0).positions[joint];
                assert!(range.lower.is_nan() || range.contains(start), "{range:?}");
            }
        }
    }
}

pub fn certificate(data: &[u8]) {
    if let Some(Ok(certificate)) = text(data).map(Certificate::from_json) {
        let again = Certificate::from_json(&certificate.to_json());
        assert_eq!(again.expect("a certificate that was printed"), certificate);
    }
}

pub fn stl(data: &[u8]) {
    mesh(Mesh::from_stl(data));
}

pub fn obj(data: &[u8]) {
    mesh(Mesh::from_obj(data));
}

/// All vertices are in the hull.
fn mesh(read: undulate::Result<Mesh>) {
    let Ok(mesh) = read else {
        return;
    };
    if mesh.vertices().len() > USED {
        return;
    }
    if let Ok(hull) = mesh.hull() {
        let size = mesh
            .vertices()
            .iter()
            .map(|v| v.coords.amax())
            .fold(0.0, f64::max);
        for (normal, offset) in hull.planes() {
            for vertex in mesh.vertices() {
                let outside = normal.dot(&vertex.coords) - offset;
                assert!(outside <= hull.tolerance() + 1e-12 * size, "{outside:e}");
            }
        }
    }
}

//! Real and hostile robots, and the values that another implementation computed for them.

mod common;

use std::path::Path;

use common::shared;
use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion};
use serde_json::Value;
use undulate::{Dynamics, GRAVITY, Robot};

/// Files whose fault lies in a mesh: meshes are not read yet.
const MESH_FILES: [&str; 3] = [
    "46_mesh_traversal.urdf",
    "49_mesh_missing.urdf",
    "51_mesh_lying_stl.urdf",
];

#[test]
fn every_real_robot_loads() {
    let Some(folder) = shared("real robots") else {
        return;
    };
    let mut loaded = 0;
    for robot in std::fs::read_dir(folder.join("robots")).unwrap() {
        let robot = robot.unwrap().path();
        if !robot.is_dir() {
            continue;
        }
        for file in std::fs::read_dir(&robot).unwrap() {
            let file = file.unwrap().path();
            if file.extension().is_some_and(|e| e == "urdf") {
                let robot = Robot::open(&file).unwrap();
                println!(
                    "{}: {} joints, {:?}",
                    robot.name(),
                    robot.joints().len(),
                    robot.require_dynamics().err()
                );
                loaded += 1;
            }
        }
    }
    assert!(loaded >= 10, "{loaded} robots");
}

#[test]
fn hostile_files_get_what_the_manifest_says() {
    let Some(folder) = shared("hostile URDFs") else {
        return;
    };
    let folder = folder.join("hostile");
    let manifest = std::fs::read_to_string(folder.join("manifest.csv")).unwrap();
    let mut seen = 0;
    let mut reader = csv::Reader::from_reader(manifest.as_bytes());
    for row in reader.records() {
        let row = row.unwrap();
        let (file, expected) = (&row[0], &row[2]);
        if MESH_FILES.contains(&file) {
            continue;
        }
        seen += 1;
        let result = Robot::open(&folder.join(file));
        let said = result
            .as_ref()
            .err()
            .map(ToString::to_string)
            .unwrap_or_default();
        println!("{file}: {said}");
        if expected.starts_with("load") {
            assert!(result.is_ok(), "{file}: {said}");
        } else if expected.starts_with("kinematics ok") || expected.contains("singular") {
            let missing = result.unwrap().require_dynamics().unwrap_err();
            assert!(missing.to_string().contains("link `"), "{file}: {missing}");
        } else {
            assert!(result.is_err(), "{file} must be refused: {expected}");
            assert!(said.contains(file), "{said}");
        }
        if expected.contains("ghost") {
            assert!(said.contains("ghost"), "{said}");
        }
    }
    assert!(seen >= 20, "{seen} files");
}

fn numbers(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .unwrap()
        .iter()
        .map(|x| x.as_f64().unwrap())
        .collect()
}

fn pose(row_major: &[f64]) -> Isometry3<f64> {
    let m = row_major;
    let rotation = Matrix3::new(m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]);
    Isometry3::from_parts(
        Translation3::new(m[3], m[7], m[11]),
        UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation)),
    )
}

/// The oracle's joints are free where ours mimic; such cases cannot be compared joint by joint.
fn order(robot: &Robot, names: &Value) -> Option<Vec<usize>> {
    let names: Vec<&str> = names
        .as_array()
        .unwrap()
        .iter()
        .map(|n| n.as_str().unwrap())
        .collect();
    robot
        .joints()
        .iter()
        .map(|j| names.iter().position(|n| n == j))
        .collect::<Option<_>>()
        .filter(|o: &Vec<usize>| o.len() == names.len())
}

fn compare(folder: &Path, file: &str, urdf: &Path) -> usize {
    let oracle: Value =
        serde_json::from_str(&std::fs::read_to_string(folder.join("oracle").join(file)).unwrap())
            .unwrap();
    let robot = Robot::open(urdf).unwrap();
    let Some(order) = order(&robot, &oracle["joints_in_order_of_q"]) else {
        return 0;
    };
    let mut dynamics = Dynamics::new(&robot);
    let mut compared = 0;
    for case in oracle["cases"].as_array().unwrap() {
        let arranged = |key: &str| {
            let values = numbers(&case[key]);
            order.iter().map(|i| values[*i]).collect::<Vec<f64>>()
        };
        let q = arranged("q");
        for (link, found) in robot.links().iter().zip(robot.link_poses(&q)) {
            let expected = &case["link_pose_3x4_row_major"][&link.name];
            if expected.is_null() {
                continue;
            }
            let expected = numbers(expected);
            let translation =
                (found.translation.vector - pose(&expected).translation.vector).norm();
            let rotation: f64 = found
                .rotation
                .to_rotation_matrix()
                .into_inner()
                .iter()
                .zip(
                    pose(&expected)
                        .rotation
                        .to_rotation_matrix()
                        .into_inner()
                        .iter(),
                )
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f64::max);
            assert!(
                translation < 1e-10 && rotation < 1e-10,
                "{file} {}: {translation:e} m, {rotation:e}",
                link.name
            );
            compared += 1;
        }
        if let Some(expected) = case["rnea_tau"].as_array() {
            let expected: Vec<f64> = expected.iter().map(|x| x.as_f64().unwrap()).collect();
            let found = dynamics.inverse(&robot, &q, &arranged("v"), &arranged("a"), &GRAVITY);
            for (j, i) in order.iter().enumerate() {
                let scale = expected.iter().fold(1.0, |s: f64, e| s.max(e.abs()));
                assert!(
                    (found[j] - expected[*i]).abs() < 1e-10 * scale,
                    "{file} joint {j}: {} {}",
                    found[j],
                    expected[*i]
                );
            }
            compared += 1;
        }
    }
    compared
}

#[test]
fn poses_and_torques_agree_with_pinocchio() {
    let Some(folder) = shared("Pinocchio's values") else {
        return;
    };
    let (mut compared, mut agreeing) = (0, 0);
    for entry in std::fs::read_dir(folder.join("oracle")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let oracle: Value = match name.strip_suffix(".json") {
            Some(_) => serde_json::from_str(
                &std::fs::read_to_string(folder.join("oracle").join(&name)).unwrap(),
            )
            .unwrap(),
            None => continue,
        };
        if oracle["joints_in_order_of_q"].is_null() {
            continue;
        }
        let urdf = folder
            .join("robots")
            .join(oracle["robot"].as_str().unwrap());
        let n = compare(&folder, &name, &urdf);
        println!("{name}: {n} values");
        compared += n;
        agreeing += usize::from(n > 0);
    }
    // All but the two whose mimicking joints are free in the oracle.
    assert_eq!(agreeing, 5, "robots compared");
    assert!(compared > 100, "{compared}");
}

#[test]
fn a_hanging_pendulum_needs_the_torque_of_the_textbook() {
    // A rod of 2 kg with its centre 0.3 m below a horizontal axis: tau = m g l sin q + (I + m l^2) a.
    let robot = Robot::from_urdf(
        r#"<robot name="pendulum"><link name="base"/><link name="rod"><inertial><origin xyz="0 0 -0.3"/>
        <mass value="2"/><inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.04"/></inertial></link>
        <joint name="pivot" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/></joint></robot>"#,
    )
    .unwrap();
    let mut dynamics = Dynamics::new(&robot);
    for (q, v, a) in [(0.0, 0.0, 0.0), (0.7, 3.0, -2.0), (-2.5, 1.0, 4.0_f64)] {
        let expected = 2.0 * 9.81 * 0.3 * f64::sin(q) + (0.03 + 2.0 * 0.09) * a;
        let found = dynamics.inverse(&robot, &[q], &[v], &[a], &GRAVITY)[0];
        assert!((found - expected).abs() < 1e-13, "{found} {expected}");
    }
    assert!((dynamics.mass_diagonal(&robot, &[0.4])[0] - 0.21).abs() < 1e-15);
}

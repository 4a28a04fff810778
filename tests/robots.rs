//! Real and hostile robots.

mod common;

use common::shared;
use undulate::Robot;

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

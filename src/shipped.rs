//! Robots and joint maps that come with the crate, embedded in it.

use crate::demonstration::DEMONSTRATOR_JOINTS;
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::Joints;
use crate::retarget::{JointMap, RobotArm, Source};
use crate::robot::{LoadOptions, MeshFiles, Robot};

/// Name and URDF of each shipped robot.
const ROBOTS: [(&str, &str); 4] = [
    ("wave_arm", include_str!("../robots/wave_arm.urdf")),
    (
        "wave_arm_left",
        include_str!("../robots/wave_arm_left.urdf"),
    ),
    ("table_arm", include_str!("../robots/table_arm.urdf")),
    ("column_arm", include_str!("../robots/column_arm.urdf")),
];

/// Path, as their URDF has it, and content of the meshes of shipped robots.
const MESHES: [(&str, &[u8]); 13] = [
    (
        "table_arm/base.obj",
        include_bytes!("../robots/table_arm/base.obj"),
    ),
    (
        "table_arm/turret.obj",
        include_bytes!("../robots/table_arm/turret.obj"),
    ),
    (
        "table_arm/shoulder.obj",
        include_bytes!("../robots/table_arm/shoulder.obj"),
    ),
    (
        "table_arm/upper_arm.obj",
        include_bytes!("../robots/table_arm/upper_arm.obj"),
    ),
    (
        "table_arm/elbow.obj",
        include_bytes!("../robots/table_arm/elbow.obj"),
    ),
    (
        "table_arm/forearm.obj",
        include_bytes!("../robots/table_arm/forearm.obj"),
    ),
    (
        "table_arm/wrist.obj",
        include_bytes!("../robots/table_arm/wrist.obj"),
    ),
    (
        "table_arm/cheek.obj",
        include_bytes!("../robots/table_arm/cheek.obj"),
    ),
    (
        "table_arm/knuckle.obj",
        include_bytes!("../robots/table_arm/knuckle.obj"),
    ),
    (
        "table_arm/neck.obj",
        include_bytes!("../robots/table_arm/neck.obj"),
    ),
    (
        "table_arm/flange.obj",
        include_bytes!("../robots/table_arm/flange.obj"),
    ),
    (
        "table_arm/hand.obj",
        include_bytes!("../robots/table_arm/hand.obj"),
    ),
    (
        "table_arm/thumb.obj",
        include_bytes!("../robots/table_arm/thumb.obj"),
    ),
];

/// Name, robot and TOML of each shipped map.
const MAPS: [(&str, &str, &str); 8] = [
    (
        "wave_arm_demonstrator",
        "wave_arm",
        include_str!("../robots/wave_arm_demonstrator.toml"),
    ),
    (
        "wave_arm_human",
        "wave_arm",
        include_str!("../robots/wave_arm_human.toml"),
    ),
    (
        "wave_arm_left_demonstrator",
        "wave_arm_left",
        include_str!("../robots/wave_arm_left_demonstrator.toml"),
    ),
    (
        "wave_arm_left_human",
        "wave_arm_left",
        include_str!("../robots/wave_arm_left_human.toml"),
    ),
    (
        "table_arm_demonstrator",
        "table_arm",
        include_str!("../robots/table_arm_demonstrator.toml"),
    ),
    (
        "table_arm_human",
        "table_arm",
        include_str!("../robots/table_arm_human.toml"),
    ),
    (
        "column_arm_demonstrator",
        "column_arm",
        include_str!("../robots/column_arm_demonstrator.toml"),
    ),
    (
        "column_arm_human",
        "column_arm",
        include_str!("../robots/column_arm_human.toml"),
    ),
];

/// Of each shipped robot, where its arm points.
const ARMS: [(&str, &str); ROBOTS.len()] = [
    (
        "wave_arm",
        include_str!("../robots/wave_arm_directions.toml"),
    ),
    (
        "wave_arm_left",
        include_str!("../robots/wave_arm_left_directions.toml"),
    ),
    (
        "table_arm",
        include_str!("../robots/table_arm_directions.toml"),
    ),
    (
        "column_arm",
        include_str!("../robots/column_arm_directions.toml"),
    ),
];

/// The names of the shipped robots.
pub fn robots() -> impl Iterator<Item = &'static str> {
    ROBOTS.iter().map(|(name, _)| *name)
}

/// The names of the shipped joint maps.
pub fn maps() -> impl Iterator<Item = &'static str> {
    MAPS.iter().map(|(name, ..)| *name)
}

/// A shipped robot by name. All were made up for this crate.
///
/// | name | what |
/// |---|---|
/// | `wave_arm` | a social robot of human size with torso, head and a right arm of six joints |
/// | `wave_arm_left` | its mirror image |
/// | `table_arm` | an industrial arm of six joints and 0.6 m reach on a table, with meshes for shapes |
/// | `column_arm` | an arm of seven joints with a ball for a shoulder, mounted sideways on a column |
///
/// # Errors
/// When there is none of this name.
pub fn robot(name: &str) -> Result<Robot> {
    let (_, urdf) = ROBOTS.iter().find(|(n, _)| *n == name).ok_or_else(|| {
        Error::new(ErrorKind::Name, format!("no shipped robot `{name}`")).expected(format!(
            "one of {}",
            robots().collect::<Vec<_>>().join(", ")
        ))
    })?;
    Robot::load(
        urdf,
        &LoadOptions {
            meshes: MeshFiles::Embedded(&MESHES),
            ..LoadOptions::default()
        },
    )
}

/// A shipped joint map by name.
///
/// # Errors
/// When there is none of this name.
pub fn map(name: &str) -> Result<JointMap> {
    let (.., toml) = MAPS.iter().find(|(n, ..)| *n == name).ok_or_else(|| {
        Error::new(ErrorKind::Name, format!("no shipped joint map `{name}`"))
            .expected(format!("one of {}", maps().collect::<Vec<_>>().join(", ")))
    })?;
    JointMap::from_toml(toml)
}

/// What of a shipped robot, by its name, points as a person's arm does.
///
/// # Errors
/// When there is none of this name.
pub fn arm(name: &str) -> Result<RobotArm> {
    let (_, toml) = ARMS.iter().find(|(n, _)| *n == name).ok_or_else(|| {
        Error::new(
            ErrorKind::Name,
            format!("no shipped directions of `{name}`"),
        )
        .expected(format!(
            "one of {}",
            robots().collect::<Vec<_>>().join(", ")
        ))
    })?;
    RobotArm::from_toml(toml)
}

/// The URDF text of a shipped robot; what a certificate takes the fingerprint of.
pub fn robot_text(name: &str) -> Option<&'static str> {
    let found = ROBOTS.iter().find(|(n, ..)| *n == name);
    found.map(|(_, urdf, ..)| *urdf)
}

/// The TOML text of a shipped joint map.
pub fn map_text(name: &str) -> Option<&'static str> {
    let found = MAPS.iter().find(|(n, ..)| *n == name);
    found.map(|(.., toml)| *toml)
}

/// The shipped map that takes most of these learned joints to a robot, and its name; `None` when none fits. Maps for the synthetic demonstrator
/// are for its joints alone.
///
/// # Errors
/// None that the shipped files could cause.
pub fn map_for(robot: &str, learned: &Joints) -> Result<Option<(&'static str, JointMap)>> {
    // Of the demonstrator's joints some have names that a person's have, and another sense.
    let is_demonstrator = learned.iter().eq(DEMONSTRATOR_JOINTS.iter().copied());
    let mut best: Option<((bool, usize), &str, JointMap)> = None;
    for (name, its_robot, toml) in MAPS {
        if its_robot != robot {
            continue;
        }
        let map = JointMap::from_toml(toml)?;
        let used: Vec<&String> = map
            .sources()
            .filter_map(|(_, source)| match source {
                Source::Learned { joint, .. } => Some(joint),
                Source::Constant(_) => None,
            })
            .collect();
        let fits = used.iter().all(|joint| learned.iter().any(|l| l == *joint));
        let rank = (
            name.ends_with("_demonstrator") == is_demonstrator,
            used.len(),
        );
        if fits && best.as_ref().is_none_or(|(of, ..)| rank > *of) {
            best = Some((rank, name, map));
        }
    }
    Ok(best.map(|(_, name, map)| (name, map)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_shipped_loads_and_the_map_is_found_by_the_joints() {
        for name in robots() {
            let robot = robot(name).unwrap();
            robot.require_dynamics().unwrap();
            assert_eq!(robot.name(), name);
            assert!(robot.notes().is_empty(), "{:?}", robot.notes());
            let arm = arm(name).unwrap();
            let directions = arm.directions(&robot, &robot.rest()).unwrap();
            assert_eq!(directions.len(), 4, "{name}");
        }
        let found = |joints: &[&str]| {
            let joints = Joints::new(joints.iter().copied()).unwrap();
            map_for("wave_arm", &joints).unwrap().map(|(name, _)| name)
        };
        assert_eq!(found(&DEMONSTRATOR_JOINTS), Some("wave_arm_demonstrator"));
        for robot in robots() {
            let joints = Joints::new(crate::anatomy::ARM_ANGLES).unwrap();
            let (name, _) = map_for(robot, &joints).unwrap().unwrap();
            assert_eq!(name, format!("{robot}_human"));
        }
        assert_eq!(found(&["a", "b"]), None);
    }
}

//! Robots and joint maps that come with the crate, embedded in it.

use crate::error::{Error, ErrorKind, Result};
use crate::fourier::Joints;
use crate::retarget::{JointMap, Source};
use crate::robot::Robot;

/// Name and URDF of each shipped robot.
const ROBOTS: [(&str, &str); 1] = [("wave_arm", include_str!("../robots/wave_arm.urdf"))];

/// Name, robot and TOML of each shipped map.
const MAPS: [(&str, &str, &str); 2] = [
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
];

/// The names of the shipped robots.
pub fn robots() -> impl Iterator<Item = &'static str> {
    ROBOTS.iter().map(|(name, _)| *name)
}

/// The names of the shipped joint maps.
pub fn maps() -> impl Iterator<Item = &'static str> {
    MAPS.iter().map(|(name, ..)| *name)
}

/// A shipped robot by name: `wave_arm`, a social robot of human size with a right arm of six joints.
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
    Robot::from_urdf(urdf)
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

/// The shipped map that takes most of these learned joints to a robot, and its name; `None` when none fits.
///
/// # Errors
/// None that the shipped files could cause.
pub fn map_for(robot: &str, learned: &Joints) -> Result<Option<(&'static str, JointMap)>> {
    let mut best: Option<(usize, &str, JointMap)> = None;
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
        if fits && best.as_ref().is_none_or(|(n, ..)| used.len() > *n) {
            best = Some((used.len(), name, map));
        }
    }
    Ok(best.map(|(_, name, map)| (name, map)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::demonstration::DEMONSTRATOR_JOINTS;

    #[test]
    fn everything_shipped_loads_and_the_map_is_found_by_the_joints() {
        for name in robots() {
            let robot = robot(name).unwrap();
            robot.require_dynamics().unwrap();
            assert_eq!(robot.name(), name);
            assert!(robot.notes().is_empty(), "{:?}", robot.notes());
        }
        let found = |joints: &[&str]| {
            let joints = Joints::new(joints.iter().copied()).unwrap();
            map_for("wave_arm", &joints).unwrap().map(|(name, _)| name)
        };
        assert_eq!(found(&DEMONSTRATOR_JOINTS), Some("wave_arm_demonstrator"));
        let human = [
            "shoulder_flexion",
            "shoulder_abduction",
            "shoulder_rotation",
            "elbow_flexion",
            "forearm_pronation",
            "wrist_flexion",
            "wrist_deviation",
        ];
        assert_eq!(found(&human), Some("wave_arm_human"));
        assert_eq!(found(&["a", "b"]), None);
    }
}

//! The robot and the joint map that a verb works with.

use std::path::{Path, PathBuf};

use clap::Args;

use super::{output, read_text};
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::Joints;
use crate::retarget::JointMap;
use crate::robot::Robot;
use crate::shipped;

#[derive(Args)]
pub(super) struct RobotArguments {
    /// A URDF file, or the name of a shipped robot (`wave_arm`).
    #[arg(long, value_name = "URDF|NAME")]
    pub robot: String,
    /// A joint map (TOML), or the name of a shipped one. Default: for a shipped robot, the shipped map that fits the joints; else equal names.
    #[arg(long, value_name = "TOML|NAME")]
    pub map: Option<String>,
}

/// A robot by path or by shipped name; a file goes first.
pub(super) fn robot(name: &str) -> Result<Robot> {
    let path = Path::new(name);
    if path.is_file() {
        return Robot::open(path);
    }
    shipped::robot(name).map_err(|e| match e.kind() {
        ErrorKind::Name => {
            Error::new(ErrorKind::Name, format!("no robot `{name}`")).expected(format!(
                "a URDF file, or a shipped robot: {}",
                shipped::robots().collect::<Vec<_>>().join(", ")
            ))
        }
        _ => e,
    })
}

/// The map for waves of `learned` joints on a robot.
pub(super) fn joint_map(name: Option<&str>, robot: &str, learned: &Joints) -> Result<JointMap> {
    let Some(name) = name else {
        let found = if Path::new(robot).is_file() {
            None
        } else {
            shipped::map_for(robot, learned)?
        };
        return Ok(found.map_or_else(JointMap::default, |(_, map)| map));
    };
    let path = PathBuf::from(name);
    if path.is_file() {
        return JointMap::from_toml(&read_text(&path)?).map_err(|e| e.at(name));
    }
    shipped::map(name).map_err(|e| match e.kind() {
        ErrorKind::Name => Error::new(ErrorKind::Name, format!("no joint map `{name}`"))
            .expected(format!(
                "a TOML file, or a shipped map: {}",
                shipped::maps().collect::<Vec<_>>().join(", ")
            ))
            .help("`undulate map --init MODEL ROBOT` writes a map to start from"),
        _ => e,
    })
}

impl RobotArguments {
    /// The robot, and the map for waves of `learned` joints on it.
    pub fn load(&self, learned: &Joints) -> Result<(Robot, JointMap)> {
        Ok((
            robot(&self.robot)?,
            joint_map(self.map.as_deref(), &self.robot, learned)?,
        ))
    }
}

/// Says what the file lacks and what was read otherwise than it stands, and returns it for the report.
pub(super) fn tell_notes(robot: &Robot) -> Vec<String> {
    for note in robot.notes() {
        output::warn(format!("robot `{}`: {note}", robot.name()));
    }
    robot.notes().to_vec()
}

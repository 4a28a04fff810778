//! The robot and the joint map that a verb works with.

use std::path::{Path, PathBuf};

use clap::Args;

use super::{output, read_text};
use crate::collision::{CollisionOptions, Evidence, Scene};
use crate::error::{Error, ErrorKind, Result, listed};
use crate::fourier::Joints;
use crate::geometry::Decomposition;
use crate::retarget::JointMap;
use crate::robot::{Inconsistent, LoadOptions, MeshConvex, MeshFiles, Robot, Srdf};
use crate::shipped;

/// How a URDF file is read, whatever is done with it.
#[derive(Args, Clone, Default)]
pub(super) struct Reading {
    /// A folder in which the URDF's meshes are looked for, after its own; may be given several times.
    #[arg(long, value_name = "FOLDER")]
    meshes: Vec<PathBuf>,
    /// An SRDF file: pairs of links that need not be kept apart, groups.
    #[arg(long, value_name = "FILE")]
    srdf: Option<PathBuf>,
    /// A scene (TOML): what stands around the robot.
    #[arg(long, value_name = "TOML")]
    scene: Option<PathBuf>,
    /// Put the nearest consistent inertia in the place of those that no body has.
    #[arg(long)]
    mend_inertia: bool,
    /// Take meshes apart into at most so many convex hulls, instead of one around all.
    #[arg(long, value_name = "PARTS", num_args = 0..=1, default_missing_value = "8")]
    decompose: Option<usize>,
}

impl Reading {
    /// A robot by path or by shipped name; a file goes first.
    pub fn robot(&self, name: &str) -> Result<Robot> {
        self.robot_with(name, false)
    }

    /// The same, and how closely hulls enclose meshes is measured where asked for.
    pub fn robot_with(&self, name: &str, measure: bool) -> Result<Robot> {
        let path = Path::new(name);
        if is_file(path) {
            let mut options = self.options()?;
            options.measure = measure;
            return Robot::open_with(path, options);
        }
        shipped::robot(name).map_err(|e| match e.kind() {
            ErrorKind::Name => {
                Error::new(ErrorKind::Name, format!("no robot `{}`", listed(&[name]))).expected(
                    format!(
                        "a URDF file, or a shipped robot: {}",
                        shipped::robots().collect::<Vec<_>>().join(", ")
                    ),
                )
            }
            _ => e,
        })
    }

    fn options(&self) -> Result<LoadOptions> {
        let convex = match self.decompose {
            None => MeshConvex::Hull,
            Some(parts @ 1..=64) => MeshConvex::Parts(Decomposition {
                parts,
                ..Decomposition::default()
            }),
            Some(parts) => {
                return Err(
                    Error::new(ErrorKind::Setting, format!("--decompose {parts}"))
                        .expected("1 to 64 parts"),
                );
            }
        };
        Ok(LoadOptions {
            convex,
            meshes: MeshFiles::Folders(self.meshes.clone()),
            inertia: match self.mend_inertia {
                true => Inconsistent::Mend,
                false => Inconsistent::Refuse,
            },
            ..LoadOptions::default()
        })
    }

    /// The SRDF, where one is given; what of it does not fit the robot is told.
    pub fn srdf(&self, robot: &Robot) -> Result<Option<Srdf>> {
        let Some(path) = &self.srdf else {
            return Ok(None);
        };
        let srdf = Srdf::open(path)?;
        for note in srdf.told(robot) {
            output::warn(note);
        }
        Ok(Some(srdf))
    }

    /// What a certificate rests on of all this: the URDF `robot`, or that of the shipped robot of this name, SRDF and scene.
    pub fn evidence(&self, robot: &str) -> Result<Vec<Evidence>> {
        let path = Path::new(robot);
        let urdf = match shipped::robot_text(robot) {
            Some(text) if !is_file(path) => Evidence::new("urdf", robot, text.as_bytes()),
            _ => evidence("urdf", path)?,
        };
        let mut all = vec![urdf];
        for (what, path) in [("srdf", &self.srdf), ("scene", &self.scene)] {
            if let Some(path) = path {
                all.push(evidence(what, path)?);
            }
        }
        Ok(all)
    }

    /// What is kept apart: the SRDF's word on it, and the scene.
    pub fn collision(&self, robot: &Robot) -> Result<CollisionOptions> {
        let srdf = self.srdf(robot)?;
        let scene = self.scene.as_deref().map(Scene::open).transpose()?;
        Ok(CollisionOptions {
            disabled: srdf.map(|s| s.disabled().to_vec()).unwrap_or_default(),
            scene: scene.unwrap_or_default(),
            ..CollisionOptions::default()
        })
    }
}

/// What a certificate rests on of a file. It is read once more for that, so it must be one that stays.
fn evidence(what: &str, path: &Path) -> Result<Evidence> {
    let name = path.display().to_string();
    if !path.is_file() {
        return Err(Error::new(ErrorKind::Unsupported, "no regular file")
            .expected("a file that can be read again when the certificate is verified")
            .at(name));
    }
    let bytes = std::fs::read(path).map_err(|e| Error::io(path, &e))?;
    Ok(Evidence::new(what, &name, &bytes))
}

/// Whether a URDF may be read there: a pipe will do too.
pub(super) fn is_file(path: &Path) -> bool {
    path.metadata().is_ok_and(|m| !m.is_dir())
}

#[derive(Args)]
pub(super) struct RobotArguments {
    /// A URDF file, or the name of a shipped robot (`wave_arm`).
    #[arg(long, value_name = "URDF|NAME")]
    pub robot: String,
    /// A joint map (TOML), or the name of a shipped one. Default: for a shipped robot, the shipped map that fits the joints; else equal names.
    #[arg(long, value_name = "TOML|NAME")]
    pub map: Option<String>,
    #[command(flatten)]
    pub reading: Reading,
}

/// The map for waves of `learned` joints on a robot.
pub(super) fn joint_map(name: Option<&str>, robot: &str, learned: &Joints) -> Result<JointMap> {
    Ok(joint_map_of(name, robot, learned)?.0)
}

/// The map, and what it came from; from nothing where names are equal.
fn joint_map_of(
    name: Option<&str>,
    robot: &str,
    learned: &Joints,
) -> Result<(JointMap, Option<Evidence>)> {
    let of_shipped = |name: &str| {
        let text = shipped::map_text(name);
        text.map(|text| Evidence::new("joint map", name, text.as_bytes()))
    };
    let Some(name) = name else {
        let found = if is_file(Path::new(robot)) {
            None
        } else {
            shipped::map_for(robot, learned)?
        };
        return Ok(found.map_or_else(
            || (JointMap::default(), None),
            |(name, map)| (map, of_shipped(name)),
        ));
    };
    let path = PathBuf::from(name);
    if path.is_file() {
        let text = read_text(&path)?;
        let map = JointMap::from_toml(&text).map_err(|e| e.at(name))?;
        return Ok((map, Some(Evidence::new("joint map", name, text.as_bytes()))));
    }
    let found = shipped::map(name).map(|map| (map, of_shipped(name)));
    found.map_err(|e| match e.kind() {
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
    /// The map for waves of `learned` joints, and what it came from.
    pub fn map(&self, learned: &Joints) -> Result<(JointMap, Option<Evidence>)> {
        joint_map_of(self.map.as_deref(), &self.robot, learned)
    }

    /// The robot, and the map for waves of `learned` joints on it.
    pub fn load(&self, learned: &Joints) -> Result<(Robot, JointMap)> {
        Ok((
            self.reading.robot(&self.robot)?,
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

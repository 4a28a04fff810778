//! What is asked of a motion, as arguments: pairs and distances, tolerance, limits.

use std::path::PathBuf;

use clap::Args;

use super::moves::parse_position;
use super::robot::Reading;
use super::{output, read_text};
use crate::collision::{CollisionOptions, Evidence};
use crate::error::{Error, ErrorKind, Result};
use crate::feasibility::{CheckOptions, JointLimit, JointLimits};
use crate::robot::{JointKind, Robot};

/// Which pairs are kept apart, and how far.
#[derive(Args, Clone, Default)]
pub(super) struct Apart {
    /// What every pair must stay apart besides the margin [m]; distances are told less this.
    #[arg(
        long,
        value_name = "METRES",
        allow_negative_numbers = true,
        default_value_t = 0.0
    )]
    padding: f64,
    /// The padding of one pair, instead; may be given several times.
    #[arg(long, value_name = "LINK:LINK=METRES")]
    pair_padding: Vec<String>,
    /// Two links that are not to be kept apart; may be given several times.
    #[arg(long, value_name = "LINK:LINK")]
    leave_out: Vec<String>,
    /// Two links that are, though neighbours or disabled by the SRDF; may be given several times.
    #[arg(long, value_name = "LINK:LINK")]
    keep: Vec<String>,
}

impl Apart {
    pub fn options(&self, reading: &Reading, robot: &Robot) -> Result<CollisionOptions> {
        let pairs = |option: &str, texts: &[String]| -> Result<Vec<(String, String)>> {
            texts.iter().map(|text| pair(option, text)).collect()
        };
        let pair_padding: Vec<((String, String), f64)> = self
            .pair_padding
            .iter()
            .map(|text| {
                let wrong = || {
                    Error::new(ErrorKind::Setting, format!("--pair-padding {text}"))
                        .expected("LINK:LINK=METRES")
                };
                let (names, metres) = text.rsplit_once('=').ok_or_else(wrong)?;
                let metres: f64 = metres.trim().parse().map_err(|_| wrong())?;
                Ok((pair("--pair-padding", names)?, metres))
            })
            .collect::<Result<_>>()?;
        for (n, ((a, b), _)) in pair_padding.iter().enumerate() {
            let again =
                |((c, d), _): &&((String, String), f64)| (a == c && b == d) || (a == d && b == c);
            if pair_padding[..n].iter().any(|other| again(&other)) {
                return Err(twice(&format!("--pair-padding {a}:{b}")));
            }
        }
        Ok(CollisionOptions {
            left_out: pairs("--leave-out", &self.leave_out)?,
            kept: pairs("--keep", &self.keep)?,
            padding: self.padding,
            pair_padding,
            ..reading.collision(robot)?
        })
    }
}

/// Of two values the last would win, and nobody would know.
pub(super) fn twice(what: &str) -> Error {
    Error::new(ErrorKind::Setting, format!("{what} twice")).expected("once")
}

fn pair(option: &str, text: &str) -> Result<(String, String)> {
    text.split_once(':')
        .map(|(a, b)| (a.trim().to_owned(), b.trim().to_owned()))
        .ok_or_else(|| {
            Error::new(ErrorKind::Setting, format!("{option} {text}")).expected("LINK:LINK")
        })
}

/// What a motion is held to.
#[derive(Args, Clone, Default)]
pub(super) struct Demands {
    /// Links must stay farther apart than this [m].
    #[arg(
        long,
        value_name = "METRES",
        allow_negative_numbers = true,
        default_value_t = 0.0
    )]
    margin: f64,
    /// How far joints may be from the motion, for all (`5e-4rad`, `0.1deg`; a bare number is rad, or m for joints that slide) or for one
    /// (`elbow=0.1deg`, `lift=1e-3m`): the proof holds for every such position. May be given several times.
    #[arg(long, value_name = "[JOINT=]ANGLE", allow_hyphen_values = true)]
    tolerance: Vec<String>,
    /// No joint may be faster [rad/s, m/s].
    #[arg(long, value_name = "SPEED", allow_negative_numbers = true)]
    max_velocity: Option<f64>,
    /// No joint may accelerate more [rad/s^2, m/s^2].
    #[arg(long, value_name = "ACCELERATION", allow_negative_numbers = true)]
    max_acceleration: Option<f64>,
    /// Limits of joints in the place of the URDF's: tables [limits.JOINT] with position = [lower, upper], velocity, acceleration; rad, m and those
    /// a second, or text with a unit ("80deg", "90deg/s").
    #[arg(long, value_name = "TOML")]
    limits: Option<PathBuf>,
    /// How exactly the smallest clearance is told [m].
    #[arg(
        long,
        value_name = "METRES",
        allow_negative_numbers = true,
        default_value_t = 1e-4
    )]
    accuracy: f64,
}

impl Demands {
    /// What is asked, and where limits come from that are not the robot's, in words.
    pub fn options(&self, robot: &Robot) -> Result<(CheckOptions, String)> {
        let mut sources = Vec::new();
        let mut limits = JointLimits::default();
        if let Some(path) = &self.limits {
            let name = path.display().to_string();
            let text = read_text(path)?;
            limits = JointLimits::from_toml(&text).map_err(|e| e.at(name.clone()))?;
            let print = Evidence::new("limits", &name, text.as_bytes());
            sources.push(format!("--limits {name} (sha256 {})", print.sha256));
            for (index, joint) in robot.joints().iter().enumerate() {
                let (given, own) = (limits.of(joint).position, robot.properties(index).position);
                if let (Some(given), Some(own)) = (given, own)
                    && given.hull(own) != own
                {
                    output::warn(format!(
                        "{name} lets {joint} go from {} to {}, and the URDF from {} to {}: numbers are rad and m, text has a unit (\"80deg\")",
                        given.lower, given.upper, own.lower, own.upper
                    ));
                }
            }
        }
        if let Some(velocity) = self.max_velocity {
            sources.push(format!("--max-velocity {velocity}"));
        }
        if let Some(acceleration) = self.max_acceleration {
            sources.push(format!("--max-acceleration {acceleration}"));
        }
        limits = limits.with(
            None,
            JointLimit {
                velocity: self.max_velocity,
                acceleration: self.max_acceleration,
                ..JointLimit::default()
            },
        )?;
        let options = CheckOptions {
            limits,
            margin: self.margin,
            tolerance: self.tolerance(robot)?,
            accuracy: Some(self.accuracy),
        };
        Ok((options, sources.join(", ")))
    }

    /// One a joint \[rad, m\], or none.
    fn tolerance(&self, robot: &Robot) -> Result<Vec<f64>> {
        let joints = robot.joints();
        let mut all: Option<&str> = None;
        let mut own: Vec<Option<f64>> = vec![None; joints.len()];
        for text in &self.tolerance {
            match text.split_once('=') {
                Some((joint, value)) => {
                    let joint = joints
                        .index(joint.trim())
                        .map_err(|e| e.at(format!("--tolerance {text}")))?;
                    if own[joint].is_some() {
                        return Err(twice(&format!("--tolerance {}", joints.name(joint))));
                    }
                    own[joint] = Some(parse_position(
                        value,
                        robot.joint(joint).kind,
                        "--tolerance",
                    )?);
                }
                None if all.is_some() => {
                    return Err(Error::new(
                        ErrorKind::Setting,
                        format!("--tolerance {text}, and another one for all joints"),
                    )
                    .expected("one"));
                }
                None => all = Some(text),
            }
        }
        if self.tolerance.is_empty() {
            return Ok(Vec::new());
        }
        let tolerance = (0..joints.len())
            .map(|j| match (own[j], all) {
                (Some(value), _) => Ok(value),
                (None, None) => Ok(0.0),
                // An angle says nothing of a joint that slides, which is told rather than guessed.
                (None, Some(text)) => parse_position(text, robot.joint(j).kind, "--tolerance")
                    .map_err(|e| match robot.joint(j).kind {
                        JointKind::Revolute => e,
                        JointKind::Prismatic => e.help(format!(
                            "joint `{0}` slides: --tolerance {0}=1e-3m",
                            joints.name(j)
                        )),
                    }),
            })
            .collect::<Result<Vec<f64>>>()?;
        if let Some(wrong) = tolerance.iter().find(|t| **t < 0.0) {
            return Err(
                Error::new(ErrorKind::Setting, format!("a tolerance of {wrong}"))
                    .expected("zero or more"),
            );
        }
        Ok(tolerance)
    }
}

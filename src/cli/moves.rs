//! The motions that a verb looks at, told apart by content: waves, and recorded moves of a robot's own joints.

use std::path::Path;

use clap::Args;
use serde::Deserialize;

use super::read_wave_text;
use super::robot::RobotArguments;
use crate::collision::Evidence;
use crate::error::{Error, ErrorKind, Reason, Result};
use crate::fourier::{Joints, Wave};
use crate::motion::{MoveOptions, PlayMotion, Spline, StartPosture, Waypoints};
use crate::robot::{JointKind, Robot};
use crate::units::parse_angle;

/// How recorded moves are read.
#[derive(Args, Clone, Default)]
pub(super) struct MoveArguments {
    /// Which motion of a file of several (play_motion2).
    #[arg(long, value_name = "NAME", conflicts_with = "all_motions")]
    motion: Option<String>,
    /// Every motion of a file of several, one after the other.
    #[arg(long)]
    all_motions: bool,
    /// Where a joint stands that a move does not name [default: at rest, 0 or as near as its limits allow]; given for all joints that it
    /// names, where the robot starts. `elbow=90deg`, `lift=0.1` [rad, m]; may be given several times.
    #[arg(long, value_name = "JOINT=ANGLE")]
    at: Vec<String>,
    /// The robot stands at the first waypoint when the move begins, whatever time that has.
    #[arg(long)]
    from_first_waypoint: bool,
    /// Angles of a CSV move are degrees.
    #[arg(long)]
    degrees: bool,
}

/// A motion of the robot's joints.
pub(super) enum Course {
    Wave(Box<Wave>),
    Move(Box<Spline>),
}

/// A motion as it was read, on the robot.
pub(super) struct Loaded {
    pub course: Course,
    /// What a controller may not like of it.
    pub warnings: Vec<String>,
    /// Joints that a move does not name, and where they stand \[rad, m\].
    pub held: Vec<(String, f64)>,
    /// What it came from.
    pub evidence: Vec<Evidence>,
}

/// A file as it stands.
enum Held {
    Wave(Wave),
    Moves(Vec<(String, Waypoints)>),
}

/// What tells one JSON from another.
#[derive(Deserialize)]
struct Header {
    format: Option<String>,
    joint_names: Option<serde::de::IgnoredAny>,
}

impl MoveArguments {
    /// The motions of a file on a robot, each with its name; what cannot be read keeps its place, so that no motion is missed.
    pub fn open(
        &self,
        path: &Path,
        robot: &Robot,
        target: &RobotArguments,
    ) -> Vec<(String, Result<Loaded>)> {
        let name = path.display().to_string();
        let read = std::fs::read(path)
            .map_err(|e| Error::io(path, &e))
            .and_then(|bytes| Ok((self.read(path, &bytes)?, bytes)));
        let (held, bytes) = match read {
            Ok(read) => read,
            Err(error) => return vec![(name, Err(error))],
        };
        let evidence = Evidence::new("motion", &name, &bytes);
        match held {
            Held::Wave(wave) => {
                let loaded = self.wave(&wave, robot, target, evidence);
                vec![(name, loaded)]
            }
            Held::Moves(moves) => moves
                .into_iter()
                .map(|(motion, waypoints)| {
                    let name = match motion.as_str() {
                        "" => name.clone(),
                        motion => format!("{name}: {motion}"),
                    };
                    let loaded = self
                        .spline(&waypoints, robot, target)
                        .map(|loaded| Loaded {
                            evidence: vec![evidence.clone()],
                            ..loaded
                        })
                        .map_err(|e| e.at(name.clone()));
                    (name, loaded)
                })
                .collect(),
        }
    }

    fn read(&self, path: &Path, bytes: &[u8]) -> Result<Held> {
        let name = path.display().to_string();
        let options = MoveOptions {
            degrees: self.degrees,
            motion: self.motion.clone(),
        };
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
        let extension = extension.to_ascii_lowercase();
        let one = |waypoints| Held::Moves(vec![(String::new(), waypoints)]);
        if matches!(extension.as_str(), "yaml" | "yml") && self.all_motions {
            if self.degrees {
                // Let the reader say why not.
                Waypoints::read(&name, bytes, &options)?;
            }
            let moves = PlayMotion::read(&name, bytes)?;
            return Ok(Held::Moves(
                moves
                    .iter()
                    .map(|(motion, waypoints)| (motion.to_owned(), waypoints.clone()))
                    .collect(),
            ));
        }
        if matches!(extension.as_str(), "yaml" | "yml" | "csv") {
            return Waypoints::read(&name, bytes, &options).map(one);
        }
        let is_json = bytes
            .iter()
            .find(|b| !b.is_ascii_whitespace() && !b"\xef\xbb\xbf".contains(*b))
            .is_some_and(|b| *b == b'{');
        if !is_json && extension != "json" {
            // Refused, with what is known.
            return Waypoints::read(&name, bytes, &options).map(one);
        }
        let header = serde_json::from_slice::<Header>(bytes);
        let is_move = header.map_or_else(
            // Cut short or worse: whose error is told?
            |_| String::from_utf8_lossy(bytes).contains("\"joint_names\""),
            |header| header.format.is_none() && header.joint_names.is_some(),
        );
        if is_move {
            // By content, whatever it is called.
            self.require_none_of(
                "a move in JSON",
                &[
                    ("--degrees", self.degrees),
                    ("--motion", self.motion.is_some()),
                ],
            )?;
            return Waypoints::from_json(&name, bytes).map(one);
        }
        let text = String::from_utf8(bytes.to_vec()).map_err(|_| {
            Error::new(ErrorKind::Syntax, "text that is not UTF-8").at(name.clone())
        })?;
        Ok(Held::Wave(read_wave_text(path, &text)?))
    }

    fn require_none_of(&self, what: &str, options: &[(&str, bool)]) -> Result<()> {
        match options.iter().find(|(_, given)| *given) {
            None => Ok(()),
            Some((option, _)) => Err(Error::new(
                ErrorKind::Setting,
                format!("{option} for {what}"),
            )
            .expected("motions that it means something for")),
        }
    }

    fn wave(
        &self,
        wave: &Wave,
        robot: &Robot,
        target: &RobotArguments,
        evidence: Evidence,
    ) -> Result<Loaded> {
        self.require_none_of(
            "a wave",
            &[
                ("--degrees", self.degrees),
                ("--motion", self.motion.is_some()),
                ("--at", !self.at.is_empty()),
                ("--from-first-waypoint", self.from_first_waypoint),
            ],
        )?;
        let (map, map_evidence) = target.map(wave.joints())?;
        let wave = map.apply(wave, robot)?;
        Ok(Loaded {
            course: Course::Wave(Box::new(wave)),
            warnings: Vec::new(),
            held: Vec::new(),
            evidence: std::iter::once(evidence).chain(map_evidence).collect(),
        })
    }

    fn spline(
        &self,
        waypoints: &Waypoints,
        robot: &Robot,
        target: &RobotArguments,
    ) -> Result<Loaded> {
        self.require_none_of(
            "a move, which is of the robot's own joints",
            &[("--map", target.map.is_some())],
        )?;
        let joints = robot.joints();
        let named: Vec<bool> = joints
            .iter()
            .map(|joint| waypoints.joints().index(joint).is_ok())
            .collect();
        if self.degrees {
            let slides = |j: &usize| named[*j] && robot.joint(*j).kind == JointKind::Prismatic;
            if let Some(joint) = (0..joints.len()).find(slides) {
                return Err(Error::new(
                    ErrorKind::Setting,
                    format!("--degrees, and joint `{}` slides", joints.name(joint)),
                )
                .expected("a move in radians and metres"));
            }
        }
        let mut hold = robot.rest();
        let mut stated = vec![false; joints.len()];
        for text in &self.at {
            let (joint, position) = posture(text, robot)?;
            hold[joint] = position;
            stated[joint] = true;
        }
        let moves = waypoints.for_joints(joints, &hold)?;
        let start = self.start(joints, &named, &stated, &hold)?;
        let spline = Spline::new(&moves, start)?;
        let unnamed = (0..joints.len()).filter(|j| !named[*j]);
        Ok(Loaded {
            warnings: spline.notes(),
            held: unnamed
                .map(|j| (joints.name(j).to_owned(), hold[j]))
                .collect(),
            course: Course::Move(Box::new(spline)),
            evidence: Vec::new(),
        })
    }

    /// Where the robot starts: as the move says, where `--at` says of all its joints, or at its first waypoint.
    fn start<'a>(
        &self,
        joints: &Joints,
        named: &[bool],
        stated: &[bool],
        hold: &'a [f64],
    ) -> Result<StartPosture<'a>> {
        let of_move: Vec<usize> = (0..named.len()).filter(|j| named[*j]).collect();
        let any = of_move.iter().any(|j| stated[*j]);
        if self.from_first_waypoint {
            if any {
                return Err(Error::new(
                    ErrorKind::Setting,
                    "--from-first-waypoint, and --at for a joint of the move",
                )
                .expected("one of the two"));
            }
            return Ok(StartPosture::AtFirstWaypoint);
        }
        match of_move.iter().find(|j| !stated[**j]) {
            _ if !any => Ok(StartPosture::Given),
            None => Ok(StartPosture::At(hold)),
            Some(missing) => Err(Error::new(
                ErrorKind::Setting,
                format!(
                    "--at does not say where joint `{}` starts",
                    joints.name(*missing)
                ),
            )
            .because(Reason::StartUnknown)
            .expected("all joints of the move, or none of them")),
        }
    }
}

/// `JOINT=ANGLE`, or a length for a joint that slides.
pub(super) fn posture(text: &str, robot: &Robot) -> Result<(usize, f64)> {
    let (joint, position) = text.split_once('=').ok_or_else(|| {
        Error::new(ErrorKind::Setting, format!("--at {text}")).expected("JOINT=ANGLE")
    })?;
    let joint = robot
        .joints()
        .index(joint.trim())
        .map_err(|e| e.because(Reason::UnknownJoint).at(format!("--at {text}")))?;
    Ok((
        joint,
        parse_position(position, robot.joint(joint).kind, "--at")?,
    ))
}

/// A position as people write it: an angle, or metres for a joint that slides.
pub(super) fn parse_position(text: &str, kind: JointKind, option: &str) -> Result<f64> {
    let wrong = |e: Error| {
        Error::new(ErrorKind::Setting, e.what().to_owned())
            .expected(match kind {
                JointKind::Revolute => "a finite number with unit deg or rad, such as 5deg",
                JointKind::Prismatic => "a finite number of metres, such as 0.1m",
            })
            .at(format!("{option} {text}"))
    };
    match kind {
        JointKind::Revolute => parse_angle(text).map_err(wrong),
        JointKind::Prismatic => {
            let number = text.trim();
            match number.strip_suffix('m').unwrap_or(number).trim().parse() {
                Ok(value) if f64::is_finite(value) => Ok(value),
                _ => Err(wrong(Error::new(
                    ErrorKind::Setting,
                    format!("length `{number}`"),
                ))),
            }
        }
    }
}

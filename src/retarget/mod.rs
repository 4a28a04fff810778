//! A person's wave becomes a robot's: by name, joint by joint ([`JointMap`]), or where the axes are others than a person's, by where
//! arm and hand point ([`DirectionFit`]).

mod arm;
mod fit;
mod least_squares;
mod person;
mod template;

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use serde::Deserialize;

use crate::error::{Error, ErrorKind, Reason, Result};
use crate::fourier::{Joints, Wave};
use crate::robot::Robot;
use crate::units::parse_angle;

pub use arm::RobotArm;
pub use fit::{DirectionFit, Residual};
pub use person::{Person, Segment};

/// What moves one robot joint.
#[derive(Debug, Clone, PartialEq)]
pub enum Source {
    /// `gain * learned + offset` \[rad\].
    #[allow(missing_docs)]
    Learned {
        joint: String,
        gain: f64,
        offset: f64,
    },
    /// It holds a position \[rad\].
    Constant(f64),
}

/// For robot joints, by name, what moves them. Joints of a robot that are not in the map follow the learned joint of
/// the same name. Learned joints that nothing follows are left out.
///
/// As TOML, a table a robot joint:
///
/// ```
/// use undulate::JointMap;
///
/// let map = JointMap::from_toml(r#"
///     [joints.shoulder_pitch]
///     from = "shoulder_flexion"   # a learned joint
///     sign = -1                   # optional: 1 or -1
///     scale = 0.8                 # optional
///     offset = "15deg"            # optional; a bare number is radians
///
///     [joints.forearm]
///     constant = "20deg"
/// "#)?;
/// assert_eq!(map.sources().count(), 2);
/// # Ok::<(), undulate::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct JointMap(BTreeMap<String, Source>);

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MapFile {
    #[serde(default)]
    joints: BTreeMap<String, Entry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    from: Option<String>,
    sign: Option<f64>,
    scale: Option<f64>,
    offset: Option<Angle>,
    constant: Option<Angle>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Angle {
    Radians(f64),
    Text(String),
}

impl Angle {
    fn radians(&self) -> Result<f64> {
        match self {
            Self::Radians(value) if value.is_finite() => Ok(*value),
            Self::Radians(value) => parse_angle(&value.to_string()),
            Self::Text(text) => parse_angle(text),
        }
    }
}

/// A robot joint as an affine function of a learned one, or a constant.
struct Row {
    source: Option<usize>,
    gain: f64,
    offset: f64,
}

impl JointMap {
    /// Reads a map.
    ///
    /// # Errors
    /// When the text is no TOML of the form above, an entry has both or neither of `from` and `constant`, a sign is not
    /// 1 or -1, a scale is not positive, or an angle is not finite; the message names the joint.
    pub fn from_toml(text: &str) -> Result<Self> {
        let file: MapFile = toml::from_str(text).map_err(|e| {
            toml_error(
                &e,
                text,
                "tables [joints.NAME] with `from`, `sign`, `scale`, `offset` or with `constant`",
            )
        })?;
        let entries = file.joints.into_iter().map(|(joint, entry)| {
            let source = entry
                .source()
                .map_err(|e| e.at(format!("robot joint `{joint}`")))?;
            Ok((joint, source))
        });
        Ok(Self(entries.collect::<Result<_>>()?))
    }

    /// The entries, by robot joint.
    pub fn sources(&self) -> impl Iterator<Item = (&str, &Source)> {
        self.0
            .iter()
            .map(|(joint, source)| (joint.as_str(), source))
    }

    /// The wave on the robot's joints, in the robot's order.
    ///
    /// # Errors
    /// When the map names a joint that the robot or the wave lacks, or a robot joint has no source.
    pub fn apply(&self, wave: &Wave, robot: &Robot) -> Result<Wave> {
        let rows = self.rows(wave.joints(), robot)?;
        let offsets = DVector::from_iterator(
            rows.len(),
            rows.iter().map(|row| match row.source {
                Some(s) => row.gain * wave.offsets()[s] + row.offset,
                None => row.offset,
            }),
        );
        let weights = DMatrix::from_fn(rows.len(), wave.harmonics(), |j, k| match rows[j].source {
            Some(s) => wave.weights()[(s, k)] * rows[j].gain,
            None => Complex::ZERO,
        });
        Wave::new(robot.joints().clone(), wave.period(), offsets, weights)
    }

    fn rows(&self, learned: &Joints, robot: &Robot) -> Result<Vec<Row>> {
        // What the map says is looked at before what it lacks.
        for (joint, source) in &self.0 {
            let here = |e: Error| e.at(format!("joint map, robot joint `{joint}`"));
            robot.joints().index(joint).map_err(|e| {
                here(e.because(Reason::UnknownJoint)).at(format!("robot `{}`", robot.name()))
            })?;
            if let Source::Learned { joint: from, .. } = source {
                learned.index(from).map_err(|e| {
                    here(
                        e.because(Reason::UnknownJoint).help(
                            "correct `from` in the joint map, or hold the joint with `constant`",
                        ),
                    )
                })?;
            }
        }
        // With a map it is the map's word what becomes of a learned joint.
        let follows = |name: &&String| {
            robot.joints().index(name).is_err() && robot.moving().any(|(_, j)| j.name == **name)
        };
        if let Some(joint) = learned.iter().find(follows)
            && self.0.is_empty()
        {
            return Err(Error::new(
                ErrorKind::Name,
                "the wave moves it, and the robot makes it follow another joint (mimic)",
            )
            .because(Reason::UnknownJoint)
            .expected("a wave of joints that can be moved")
            .help("leave it out by a joint map")
            .at(format!("joint `{joint}`"))
            .at(format!("robot `{}`", robot.name())));
        }
        robot
            .joints()
            .iter()
            .map(|joint| match self.0.get(joint) {
                Some(Source::Constant(position)) => Ok(Row { source: None, gain: 0.0, offset: *position }),
                Some(Source::Learned { joint: from, gain, offset }) => {
                    Ok(Row { source: Some(learned.index(from)?), gain: *gain, offset: *offset })
                }
                None => learned.index(joint).map(|source| Row { source: Some(source), gain: 1.0, offset: 0.0 }).map_err(|_| {
                    Error::new(ErrorKind::Name, "nothing moves it")
                        .because(Reason::MissingJoint)
                        .expected(format!("an entry in the joint map, or a learned joint of this name among {}", learned.listed()))
                        .help("`undulate map --init` writes a map to start from")
                        .at(format!("joint `{joint}`"))
                        .at(format!("robot `{}`", robot.name()))
                }),
            })
            .collect()
    }
}

/// What is wrong with a TOML text, and in which line.
fn toml_error(e: &toml::de::Error, text: &str, expected: &str) -> Error {
    let error = Error::new(ErrorKind::Syntax, e.message().replace('\n', " ")).expected(expected);
    match e.span() {
        Some(span) => {
            let line = text[..span.start.min(text.len())].matches('\n').count() + 1;
            error.at(format!("line {line}"))
        }
        None => error,
    }
}

impl Entry {
    fn source(&self) -> Result<Source> {
        let refuse = |what: String, expected: &str| {
            Err(Error::new(ErrorKind::Value, what).expected(expected.to_owned()))
        };
        match (&self.from, &self.constant) {
            (Some(from), None) => {
                let sign = self.sign.unwrap_or(1.0);
                let scale = self.scale.unwrap_or(1.0);
                if sign.abs() != 1.0 {
                    return refuse(format!("sign = {sign}"), "1 or -1");
                }
                if !(scale.is_finite() && scale > 0.0) {
                    return refuse(
                        format!("scale = {scale}"),
                        "a positive number; the sign has a key of its own",
                    );
                }
                Ok(Source::Learned {
                    joint: from.clone(),
                    gain: sign * scale,
                    offset: self.offset.as_ref().map_or(Ok(0.0), Angle::radians)?,
                })
            }
            (None, Some(constant))
                if self.sign.is_none() && self.scale.is_none() && self.offset.is_none() =>
            {
                Ok(Source::Constant(constant.radians()?))
            }
            (None, Some(_)) => refuse(
                "`constant` beside `sign`, `scale` or `offset`".into(),
                "`constant` alone",
            ),
            (Some(_), Some(_)) => refuse("both `from` and `constant`".into(), "one of them"),
            (None, None) => refuse("neither `from` nor `constant`".into(), "one of them"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{dmatrix, dvector};
    use num_complex::Complex;

    pub(super) fn robot() -> Robot {
        Robot::from_urdf(
            r#"<robot name="r"><link name="a"/><link name="b"/><link name="c"/>
            <joint name="arm/elbow" type="revolute"><parent link="a"/><child link="b"/><limit lower="0.2" upper="1" velocity="1"/></joint>
            <joint name="wrist" type="continuous"><parent link="b"/><child link="c"/></joint></robot>"#,
        )
        .unwrap()
    }

    pub(super) fn wave() -> Wave {
        Wave::new(
            Joints::new(["wrist", "elbow_flexion"]).unwrap(),
            1.0,
            dvector![0.1, 0.5],
            dmatrix![Complex::new(0.01, 0.02); Complex::new(0.03, 0.04)],
        )
        .unwrap()
    }

    #[test]
    fn positions_follow_sign_scale_and_offset() {
        let map = JointMap::from_toml(
            "[joints.'arm/elbow']\nfrom = 'elbow_flexion'\nsign = -1\nscale = 2\noffset = '90deg'",
        )
        .unwrap();
        let mapped = map.apply(&wave(), &robot()).unwrap();
        for t in [0.0, 0.3, 0.77] {
            let (before, after) = (wave().position(t), mapped.position(t));
            let expected = -2.0 * before[1] + std::f64::consts::FRAC_PI_2;
            assert!((after[0] - expected).abs() < 1e-15);
            assert_eq!(after[1], before[0]);
        }
    }

    #[test]
    fn every_fault_names_its_joint() {
        let robot = robot();
        let apply = |text: &str| JointMap::from_toml(text).and_then(|m| m.apply(&wave(), &robot));
        for (text, message) in [
            ("", "robot `r`, joint `arm/elbow`: nothing moves it"),
            ("[joints.hip]\nconstant = 0", "no joint `hip`"),
            (
                "[joints.wrist]\nfrom = 'elbo'",
                "joint map, robot joint `wrist`: no joint `elbo`",
            ),
            (
                "[joints.wrist]\nfrom = 'a'\nconstant = 1",
                "robot joint `wrist`: both",
            ),
            ("[joints.wrist]", "neither `from` nor `constant`"),
            ("[joints.wrist]\nfrom = 'a'\nsign = 2", "sign = 2"),
            ("[joints.wrist]\nfrom = 'a'\nscale = -2", "scale = -2"),
            ("[joints.wrist]\nconstant = '2grad'", "angle `2grad`"),
            ("[joints.wrist]\nconstant = nan", "angle `NaN`"),
            ("[joints.wrist]\nform = 'a'", "line 2: unknown field `form`"),
            ("[joints.wrist", "line 1"),
        ] {
            let error = apply(text).unwrap_err().to_string();
            assert!(error.contains(message), "{text:?}: {error}");
        }
    }
}

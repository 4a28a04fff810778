//! [`RobotArm`]: what of a robot is its upper arm, forearm, hand and palm.

use nalgebra::{Matrix3, Matrix3xX, Vector3};
use serde::Deserialize;

use super::person::Segment;
use super::toml_error;
use crate::error::{Error, ErrorKind, Result};
use crate::robot::{Frame, Kinematics, Link, Robot};

/// Two points nearer than this \[m\] have no direction.
const NEAREST: f64 = 1e-6;

/// Two unit vectors whose cross product is shorter than this span no plane.
const PARALLEL: f64 = 1e-3;

/// What of a robot is to point where a person's upper arm, forearm, hand and palm do.
///
/// As TOML, a table for each of them that counts:
///
/// ```
/// use undulate::RobotArm;
///
/// let arm = RobotArm::from_toml(r#"
///     forward = [1, 0, 0]        # where the person looks, in the robot's base frame; this is the default
///     up = [0, 0, 1]             # and where their head is
///     side = "right"             # or "left": the person is mirrored
///
///     [upper_arm]
///     from = "shoulder"          # from the frame of one link to that of another
///     to = "elbow"
///
///     [hand]
///     link = "flange"            # or an axis of a link
///     axis = [0, 0, 1]
///     weight = 0.5               # of its squared errors; 1 where none is given
/// "#)?;
/// assert_eq!(arm.segments().count(), 2);
/// # Ok::<(), undulate::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct RobotArm {
    /// From the person's frame, X left, Y up, Z forward, to the robot's base; a left arm's is a reflection.
    to_base: Matrix3<f64>,
    pointers: Vec<Pointer>,
}

#[derive(Debug, Clone, PartialEq)]
struct Pointer {
    segment: Segment,
    weight: f64,
    what: Between,
}

#[derive(Debug, Clone, PartialEq)]
enum Between {
    Links(String, String),
    Axis(String, Vector3<f64>),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ArmFile {
    forward: Option<[f64; 3]>,
    up: Option<[f64; 3]>,
    #[serde(default)]
    side: Side,
    upper_arm: Option<Entry>,
    forearm: Option<Entry>,
    hand: Option<Entry>,
    palm: Option<Entry>,
}

#[derive(Deserialize, Default, PartialEq)]
#[serde(rename_all = "lowercase")]
enum Side {
    #[default]
    Right,
    Left,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    from: Option<String>,
    to: Option<String>,
    link: Option<String>,
    axis: Option<[f64; 3]>,
    weight: Option<f64>,
}

impl RobotArm {
    /// Reads what a file says.
    ///
    /// # Errors
    /// When the text is no TOML of the form above, names none of the four, gives one both or neither of two links and an axis, a
    /// direction without length, a forward that is upward, or a weight that is not positive.
    pub fn from_toml(text: &str) -> Result<Self> {
        let file: ArmFile = toml::from_str(text).map_err(|e| {
            toml_error(
                &e,
                text,
                "tables [upper_arm], [forearm], [hand], [palm] with `from` and `to` or with `link` and `axis`",
            )
        })?;
        let forward = unit(file.forward.unwrap_or([1.0, 0.0, 0.0])).map_err(|e| e.at("forward"))?;
        let up = unit(file.up.unwrap_or([0.0, 0.0, 1.0])).map_err(|e| e.at("up"))?;
        let left = up.cross(&forward);
        if left.norm() < PARALLEL {
            return Err(
                Error::new(ErrorKind::Value, "forward and up along one line")
                    .expected("two directions at an angle"),
            );
        }
        let left = left.normalize();
        let mirrored = match file.side {
            Side::Right => left,
            Side::Left => -left,
        };
        let to_base = Matrix3::from_columns(&[mirrored, forward.cross(&left), forward]);
        let entries = [file.upper_arm, file.forearm, file.hand, file.palm];
        let mut pointers = Vec::new();
        for (segment, entry) in Segment::ALL.into_iter().zip(entries) {
            if let Some(entry) = entry {
                pointers.push(
                    entry
                        .pointer(segment)
                        .map_err(|e| e.at(format!("[{}]", segment.name())))?,
                );
            }
        }
        if pointers.is_empty() {
            return Err(Error::new(ErrorKind::Shape, "nothing that points")
                .expected("at least one of [upper_arm], [forearm], [hand], [palm]"));
        }
        Ok(Self { to_base, pointers })
    }

    /// What it names, from the shoulder on.
    pub fn segments(&self) -> impl Iterator<Item = Segment> {
        self.pointers.iter().map(|p| p.segment)
    }

    /// Where these point at configuration `q`: unit vectors in the robot's base frame, in the order of
    /// [`segments`](Self::segments). Panics when `q` has not one entry a joint.
    ///
    /// # Errors
    /// When the robot lacks a link, or the frames of two are at one place.
    pub fn directions(&self, robot: &Robot, q: &[f64]) -> Result<Vec<Vector3<f64>>> {
        let mut kinematics = Kinematics::new(robot);
        let pointers = self.on(robot)?;
        Ok(pointers
            .iter()
            .map(|p| p.direction(robot, &mut kinematics, q))
            .collect())
    }

    /// Directions in the person's frame, in the robot's base.
    pub(super) fn to_base(&self) -> &Matrix3<f64> {
        &self.to_base
    }

    /// # Errors
    /// When the robot lacks a link, or the frames of two are at one place.
    pub(super) fn on<'a>(&self, robot: &'a Robot) -> Result<Vec<Pointing<'a>>> {
        self.pointers
            .iter()
            .map(|pointer| {
                let here = |e: Error| e.at(format!("[{}]", pointer.segment.name()));
                let ends = match &pointer.what {
                    Between::Axis(link, axis) => Ends::Axis(robot.link(link).map_err(here)?, *axis),
                    Between::Links(from, to) => {
                        let [from, to] = [
                            robot.link(from).map_err(here)?,
                            robot.link(to).map_err(here)?,
                        ];
                        let mut kinematics = Kinematics::new(robot);
                        let frames = kinematics.frames(robot, &robot.rest());
                        if between(frames, from, to).norm() < NEAREST {
                            return Err(here(
                                Error::new(
                                    ErrorKind::Value,
                                    format!("links `{}` and `{}` at one place", from.name, to.name),
                                )
                                .expected("two places, or `link` and `axis`")
                                .at(format!("robot `{}`", robot.name())),
                            ));
                        }
                        Ends::Links(from, to)
                    }
                };
                Ok(Pointing {
                    segment: pointer.segment,
                    weight: pointer.weight,
                    ends,
                })
            })
            .collect()
    }
}

impl Entry {
    fn pointer(self, segment: Segment) -> Result<Pointer> {
        let refuse = |what: &str| {
            Err(Error::new(ErrorKind::Value, what)
                .expected("`from` and `to`, or `link` and `axis`"))
        };
        let what = match (self.from, self.to, self.link, self.axis) {
            (Some(from), Some(to), None, None) => Between::Links(from, to),
            (None, None, Some(link), Some(axis)) => {
                Between::Axis(link, unit(axis).map_err(|e| e.at("axis"))?)
            }
            (None, None, None, None) => return refuse("no direction"),
            _ => return refuse("half a direction, or two"),
        };
        let weight = self.weight.unwrap_or(1.0);
        if !(weight > 0.0 && weight.is_finite()) {
            return Err(Error::new(ErrorKind::Value, format!("weight = {weight}"))
                .expected("a positive number, or no table where it should not count"));
        }
        Ok(Pointer {
            segment,
            weight,
            what,
        })
    }
}

fn unit(vector: [f64; 3]) -> Result<Vector3<f64>> {
    // Scaled first, so that no square overflows or vanishes.
    let vector = Vector3::from(vector);
    let scaled = vector / vector.amax();
    if vector.iter().all(|x| x.is_finite()) && scaled.norm().is_finite() {
        return Ok(scaled.normalize());
    }
    Err(
        Error::new(ErrorKind::Value, format!("{:?}", vector.as_slice()))
            .expected("a direction: three finite numbers, not all 0"),
    )
}

/// A pointer on a robot.
pub(super) struct Pointing<'a> {
    pub segment: Segment,
    pub weight: f64,
    ends: Ends<'a>,
}

enum Ends<'a> {
    Links(&'a Link, &'a Link),
    Axis(&'a Link, Vector3<f64>),
}

impl Pointing<'_> {
    /// A unit vector in the base frame; zero where two frames meet.
    pub fn direction(&self, robot: &Robot, kinematics: &mut Kinematics, q: &[f64]) -> Vector3<f64> {
        let frames = kinematics.frames(robot, q);
        match self.ends {
            Ends::Axis(link, axis) => frames[link.body].rotation * (link.pose.rotation * axis),
            Ends::Links(from, to) => between(frames, from, to)
                .try_normalize(NEAREST)
                .unwrap_or_default(),
        }
    }

    /// The direction, and into `rates` its derivative by each joint.
    pub fn linearised(
        &self,
        robot: &Robot,
        kinematics: &mut Kinematics,
        q: &[f64],
        rates: &mut Matrix3xX<f64>,
    ) -> Vector3<f64> {
        let direction = self.direction(robot, kinematics, q);
        match self.ends {
            Ends::Axis(link, _) => {
                // A fixed direction of a body turns with it.
                rates.copy_from(&kinematics.link_jacobian(robot, q, link).fixed_rows::<3>(3));
                for mut rate in rates.column_iter_mut() {
                    let turned = rate.cross(&direction);
                    rate.copy_from(&turned);
                }
            }
            Ends::Links(from, to) => {
                let length = between(kinematics.frames(robot, q), from, to).norm();
                if length < NEAREST {
                    rates.fill(0.0);
                    return direction;
                }
                rates.copy_from(&kinematics.link_jacobian(robot, q, to).fixed_rows::<3>(0));
                *rates -= kinematics.link_jacobian(robot, q, from).fixed_rows::<3>(0);
                // Of v / |v|: what is along it changes the length alone.
                for mut rate in rates.column_iter_mut() {
                    let across = (&rate - direction * direction.dot(&rate)) / length;
                    rate.copy_from(&across);
                }
            }
        }
        direction
    }
}

/// From the origin of one link's frame to that of another \[m\].
fn between(frames: &[Frame], from: &Link, to: &Link) -> Vector3<f64> {
    let [from, to] = [from, to].map(|link| {
        let frame = &frames[link.body];
        frame.origin + frame.rotation * link.pose.translation.vector
    });
    to - from
}

#[cfg(test)]
pub(super) mod tests;

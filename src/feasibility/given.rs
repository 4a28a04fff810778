//! [`JointLimits`]: limits that the caller sets beside those of the robot's file.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::error::{Error, ErrorKind, Reason, Result};
use crate::fourier::{Interval, Joints};
use crate::units::parse_angle_with_unit;

/// Limits of one joint; what is `None` is not set.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct JointLimit {
    /// \[rad, m\]
    pub position: Option<Interval>,
    /// Largest speed \[rad/s, m/s\].
    pub velocity: Option<f64>,
    /// Largest acceleration either way \[rad/s^2, m/s^2\].
    pub acceleration: Option<f64>,
}

/// Limits that a caller sets: those of a joint take the place of the robot's, for URDF has none of acceleration, and an
/// application may be stricter or know better; those for every joint only ever make limits narrower.
///
/// ```
/// use undulate::JointLimits;
///
/// let limits = JointLimits::from_toml(
///     "[limits.elbow]\nvelocity = 1.5 # rad/s\nacceleration = 8.0\nposition = [-0.2, 2.0]\n",
/// )?;
/// assert_eq!(limits.of("elbow").acceleration, Some(8.0));
/// # Ok::<(), undulate::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct JointLimits {
    every: JointLimit,
    joints: BTreeMap<String, JointLimit>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LimitFile {
    limits: BTreeMap<String, Entry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    position: Option<[Quantity; 2]>,
    velocity: Option<Quantity>,
    acceleration: Option<Quantity>,
}

/// In SI units, or an angle with its unit as text: of degrees a second and a second squared too.
#[derive(Deserialize)]
#[serde(untagged)]
enum Quantity {
    Number(f64),
    Text(String),
}

impl Quantity {
    /// `per` is what follows the unit of an angle: nothing for positions. Another quantity than is asked for is none.
    fn value(&self, per: &str) -> Result<f64> {
        match self {
            Self::Number(number) => Ok(*number),
            Self::Text(text) => match text.strip_suffix(per) {
                Some(angle) => parse_angle_with_unit(angle),
                None => Err(Error::new(ErrorKind::Setting, format!("`{text}`"))
                    .because(Reason::Invalid)
                    .expected(format!(
                        "a number, or text that ends in deg{per} or rad{per}"
                    ))),
            },
        }
    }
}

impl JointLimits {
    /// Reads tables `[limits.JOINT]` with `position = [lower, upper]`, `velocity` and `acceleration`: numbers in rad or m, and those a second or
    /// a second squared, or text such as `"80deg"`, `"90deg/s"`, `"5rad/s^2"`.
    ///
    /// # Errors
    /// When the text is no TOML of this form, or a limit is no limit (see [`with`](Self::with)).
    pub fn from_toml(text: &str) -> Result<Self> {
        let file: LimitFile = toml::from_str(text).map_err(|e| {
            let error = Error::new(ErrorKind::Syntax, e.message().replace('\n', " ")).expected(
                "tables [limits.JOINT] with `position = [lower, upper]`, `velocity`, `acceleration`",
            );
            match e.span() {
                Some(span) => {
                    let before = &text.as_bytes()[..span.start.min(text.len())];
                    let line = 1 + before.iter().filter(|b| **b == b'\n').count();
                    error.at(format!("line {line}"))
                }
                None => error,
            }
        })?;
        file.limits
            .into_iter()
            .try_fold(Self::default(), |limits, (joint, entry)| {
                let here = |e: Error| e.at(format!("joint `{joint}`"));
                let value = |of: &Option<Quantity>, per: &str| {
                    of.as_ref().map(|of| of.value(per)).transpose()
                };
                let position = entry.position.map(|[lower, upper]| {
                    Ok(Interval {
                        lower: lower.value("")?,
                        upper: upper.value("")?,
                    })
                });
                let limit = JointLimit {
                    position: position.transpose().map_err(here)?,
                    velocity: value(&entry.velocity, "/s").map_err(here)?,
                    acceleration: value(&entry.acceleration, "/s^2").map_err(here)?,
                };
                limits.with(Some(&joint), limit)
            })
    }

    /// These limits and what `limit` sets besides, for one joint or for every joint.
    ///
    /// # Errors
    /// When a range is empty, a speed or an acceleration is not positive, or a number is not finite.
    pub fn with(mut self, joint: Option<&str>, limit: JointLimit) -> Result<Self> {
        let refuse = |what: String, expected: &str| {
            let place = joint.map_or("every joint".to_owned(), |j| format!("joint `{j}`"));
            Err(Error::new(ErrorKind::Setting, what)
                .because(Reason::Invalid)
                .expected(expected)
                .at(place))
        };
        if let Some(i) = limit.position
            && !(i.lower <= i.upper && i.width().is_finite())
        {
            return refuse(
                format!("positions from {} to {}", i.lower, i.upper),
                "a lower limit that is not above the upper one",
            );
        }
        for (what, value) in [
            ("velocity", limit.velocity),
            ("acceleration", limit.acceleration),
        ] {
            if let Some(value) = value
                && !(value > 0.0 && value.is_finite())
            {
                return refuse(format!("{what} limit of {value}"), "a positive number");
            }
        }
        let of = match joint {
            Some(joint) => self.joints.entry(joint.to_owned()).or_default(),
            None => &mut self.every,
        };
        of.position = limit.position.or(of.position);
        of.velocity = limit.velocity.or(of.velocity);
        of.acceleration = limit.acceleration.or(of.acceleration);
        Ok(self)
    }

    /// What is set for a joint itself.
    pub fn of(&self, joint: &str) -> JointLimit {
        self.joints.get(joint).copied().unwrap_or_default()
    }

    /// # Errors
    /// When a limit is set for a joint that is not among `names`: it would be checked by nobody.
    pub(super) fn require_known(&self, names: &[String]) -> Result<()> {
        let all = Joints::new(names.iter().cloned());
        match (self.joints.keys().find(|j| !names.contains(j)), all) {
            (None, _) => Ok(()),
            (Some(joint), all) => Err(Error::new(
                ErrorKind::Name,
                format!("a limit for joint `{joint}`, which the robot does not have"),
            )
            .because(Reason::UnknownJoint)
            .expected(all.map_or("none".to_owned(), |all| format!("one of {}", all.listed())))),
        }
    }

    /// The limits of a joint whose file gives it `robot`.
    pub(super) fn over(&self, joint: &str, robot: JointLimit) -> JointLimit {
        let own = self.of(joint);
        let least = |a: Option<f64>, b: Option<f64>| match (a, b) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
        let every = &self.every;
        let position = match (own.position.or(robot.position), every.position) {
            // Empty when they exclude each other: nothing passes then.
            (Some(a), Some(b)) => Some(a.intersect(b)),
            (a, b) => a.or(b),
        };
        JointLimit {
            position,
            velocity: least(own.velocity.or(robot.velocity), every.velocity),
            acceleration: least(own.acceleration.or(robot.acceleration), every.acceleration),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn speed(velocity: f64) -> JointLimit {
        JointLimit {
            velocity: Some(velocity),
            ..JointLimit::default()
        }
    }

    #[test]
    fn a_joint_s_own_limit_replaces_and_one_for_all_only_narrows() {
        let limits = JointLimits::default()
            .with(Some("a"), speed(9.0))
            .unwrap()
            .with(None, speed(2.0))
            .unwrap();
        let of = |joint, robot| limits.over(joint, robot).velocity;
        assert_eq!(of("a", speed(1.0)), Some(2.0));
        let own = JointLimits::default().with(Some("a"), speed(9.0)).unwrap();
        assert_eq!(own.over("a", speed(1.0)).velocity, Some(9.0));
        assert_eq!(of("b", speed(1.0)), Some(1.0));
        assert_eq!(of("b", speed(3.0)), Some(2.0));
        assert_eq!(of("b", JointLimit::default()), Some(2.0));
        assert_eq!(limits.over("b", speed(1.0)).acceleration, None);
    }

    #[test]
    fn text_has_the_unit_of_its_quantity() {
        let read = |text: &str| JointLimits::from_toml(&format!("[limits.a]\n{text}\n"));
        let own =
            read("position = [0, \"180deg\"]\nvelocity = \"90deg/s\"\nacceleration = \"2rad/s^2\"");
        let own = own.unwrap().of("a");
        let turn = std::f64::consts::PI;
        assert_eq!(own.position.unwrap().upper, turn);
        assert_eq!(
            (own.velocity, own.acceleration),
            (Some(turn / 2.0), Some(2.0))
        );
        for wrong in [
            "position = [0, \"80deg/s\"]",
            "velocity = \"90deg\"",
            "velocity = \"90deg/s^2\"",
            "acceleration = \"90deg/s\"",
            "velocity = \"/s\"",
        ] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn what_is_no_limit_is_refused() {
        for (text, expected) in [
            (
                "[limits.a]\nvelocity = 0.0",
                "joint `a`: velocity limit of 0",
            ),
            (
                "[limits.a]\nacceleration = nan",
                "acceleration limit of NaN",
            ),
            (
                "[limits.a]\nposition = [1.0, -1.0]",
                "positions from 1 to -1",
            ),
            (
                "[limits.a]\nposition = [-inf, 1.0]",
                "positions from -inf to 1",
            ),
            ("[limits.a]\nposition = [1.0]", "line 2"),
            ("[limits.a]\n\njerk = 1.0", "line 3: unknown field `jerk`"),
            ("[limit.a]\nvelocity = 1.0", "line 1: unknown field `limit`"),
            ("[limits.a]\nvelocity = \"é", "line 2"),
        ] {
            let error = JointLimits::from_toml(text).unwrap_err().to_string();
            assert!(error.contains(expected), "{text}: {error}");
        }
    }
}

//! Moves from JSON in the field names of trajectory_msgs/JointTrajectory.

use serde::Deserialize;

use super::{Error, ErrorKind, Reason, Result, Waypoints, utf8};
use crate::fourier::Joints;
use crate::motion::waypoints::{Rows, Waypoint};

/// Nanoseconds in a second.
const NANO: u64 = 1_000_000_000;

/// Another field than these is refused: a misspelt `velocities` would make another motion.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Trajectory {
    #[serde(default, rename = "header")]
    _header: serde::de::IgnoredAny,
    joint_names: Vec<String>,
    points: Vec<Point>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Point {
    positions: Vec<f64>,
    #[serde(default)]
    velocities: Vec<f64>,
    #[serde(default)]
    accelerations: Vec<f64>,
    /// Feed-forward; where the joints go does not depend on it.
    #[serde(default, rename = "effort")]
    _effort: Vec<f64>,
    time_from_start: Time,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Time {
    Seconds(f64),
    Ros2(Ros2),
    Ros1(Ros1),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Ros2 {
    sec: u32,
    nanosec: u32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Ros1 {
    secs: u32,
    nsecs: u32,
}

impl Time {
    fn seconds(&self) -> Result<f64> {
        let (whole, nano) = match self {
            Self::Seconds(t) => return Ok(*t),
            Self::Ros2(t) => (t.sec, t.nanosec),
            Self::Ros1(t) => (t.secs, t.nsecs),
        };
        if u64::from(nano) >= NANO {
            return Err(Error::new(ErrorKind::Value, format!("{nano} ns"))
                .because(Reason::OutOfRange)
                .expected("less than a second of nanoseconds")
                .at("time_from_start"));
        }
        // Below 2^53 for every time that waypoints take, so the quotient is the number nearest to the decimal.
        Ok((u64::from(whole) * NANO + u64::from(nano)) as f64 / NANO as f64)
    }
}

impl Waypoints {
    /// Reads JSON in the field names of trajectory_msgs/JointTrajectory: `joint_names`, and `points` with `positions`,
    /// `velocities`, `accelerations` (empty or left out where there are none) and `time_from_start` as `{sec, nanosec}`,
    /// `{secs, nsecs}` or a number of seconds. The header and efforts are not looked at. Positions must be given: the
    /// controller can integrate velocities, but what it then does depends on where it starts.
    ///
    /// ```
    /// use undulate::Waypoints;
    ///
    /// let text = r#"{"joint_names": ["elbow"], "points": [
    ///     {"positions": [0.0], "time_from_start": {"sec": 0, "nanosec": 0}},
    ///     {"positions": [0.5], "time_from_start": {"sec": 1, "nanosec": 500000000}}]}"#;
    /// assert_eq!(Waypoints::from_json("nod.json", text.as_bytes())?.get(1).time, 1.5);
    /// # Ok::<(), undulate::Error>(())
    /// ```
    ///
    /// # Errors
    /// When the text is not that, and those of [`Waypoints::new`].
    pub fn from_json(name: &str, text: &[u8]) -> Result<Self> {
        parse(text).map_err(|e| e.at(name))
    }
}

fn parse(text: &[u8]) -> Result<Waypoints> {
    let trajectory: Trajectory = serde_json::from_str(utf8(text)?).map_err(|e| {
        let what = if e.is_eof() {
            "the file is cut short".to_owned()
        } else {
            e.to_string()
        };
        Error::new(ErrorKind::Syntax, what)
            .expected("a JointTrajectory: joint_names, points with positions and time_from_start")
            .at(format!("line {}, column {}", e.line(), e.column()))
    })?;
    let joints = Joints::new(trajectory.joint_names)
        .map_err(|e| e.because(Reason::MissingJoint).at("joint_names"))?;
    let mut rows = Rows::new(joints);
    for (i, point) in trajectory.points.iter().enumerate() {
        point
            .time_from_start
            .seconds()
            .and_then(|time| {
                rows.push(Waypoint {
                    time,
                    positions: &point.positions,
                    velocities: given(&point.velocities),
                    accelerations: given(&point.accelerations),
                })
            })
            .map_err(|e| e.at(format!("points[{i}]")))?;
    }
    rows.finish()
}

/// An empty list stands for none, as in the message.
fn given(values: &[f64]) -> Option<&[f64]> {
    (!values.is_empty()).then_some(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_bad_trajectory_gets_its_place_and_reason() {
        let point =
            |fields: &str| format!(r#"{{"joint_names": ["a", "b"], "points": [{fields}]}}"#);
        let good = r#"{"positions": [0, 1], "time_from_start": 0}"#;
        for (text, expected, reason) in [
            (
                String::new(),
                "m.json, line 1, column 0: the file is cut short",
                Reason::Unreadable,
            ),
            (
                "[1]".into(),
                "expected a JointTrajectory",
                Reason::Unreadable,
            ),
            (point(""), "no waypoint", Reason::NoDuration),
            (
                r#"{"joint_names": [], "points": []}"#.into(),
                "joint_names: no joints",
                Reason::MissingJoint,
            ),
            (
                r#"{"joint_names": ["a", "a"], "points": []}"#.into(),
                "joint `a` is named twice",
                Reason::MissingJoint,
            ),
            (
                point(r#"{"positions": [0, 1], "velocites": [0, 1], "time_from_start": 0}"#),
                "unknown field `velocites`",
                Reason::Unreadable,
            ),
            (
                point(r#"{"velocities": [0, 1], "time_from_start": 0}"#),
                "missing field `positions`",
                Reason::Unreadable,
            ),
            (
                point(r#"{"positions": [0, 1]}"#),
                "missing field `time_from_start`",
                Reason::Unreadable,
            ),
            (
                point(r#"{"positions": [0, null], "time_from_start": 0}"#),
                "invalid type: null",
                Reason::Unreadable,
            ),
            (
                point(r#"{"positions": [0, NaN], "time_from_start": 0}"#),
                "line 1",
                Reason::Unreadable,
            ),
            (
                point(r#"{"positions": [0, 1e999], "time_from_start": 0}"#),
                "number out of range",
                Reason::Unreadable,
            ),
            (
                point(r#"{"positions": [0], "time_from_start": 0}"#),
                "points[0]: 1 positions",
                Reason::WrongSize,
            ),
            (
                point(r#"{"positions": [0, 1], "velocities": [0, 1, 2], "time_from_start": 0}"#),
                "3 velocities",
                Reason::WrongSize,
            ),
            (
                point(&format!("{good}, {good}")),
                "points[1]: time 0 s does not come after 0 s",
                Reason::TimesNotIncreasing,
            ),
            (
                point(
                    r#"{"positions": [0, 1], "time_from_start": {"sec": 1, "nanosec": 1000000000}}"#,
                ),
                "points[0], time_from_start: 1000000000 ns",
                Reason::OutOfRange,
            ),
            (
                point(r#"{"positions": [0, 1], "time_from_start": {"sec": -1, "nanosec": 0}}"#),
                "untagged enum",
                Reason::Unreadable,
            ),
            ("[".repeat(1_000_000), "line 1", Reason::Unreadable),
            (
                format!(r#"{{"header": {}"#, "[".repeat(1_000_000)),
                "cut short",
                Reason::Unreadable,
            ),
        ] {
            let error = Waypoints::from_json("m.json", text.as_bytes()).unwrap_err();
            assert!(error.to_string().contains(expected), "{error}");
            assert_eq!(Reason::of(&error), reason, "{error}");
        }
        let error = Waypoints::from_json("m.json", b"{\n\"a\": \xff}").unwrap_err();
        assert!(
            error
                .to_string()
                .contains("m.json, line 2: text that is not UTF-8")
        );
    }
}

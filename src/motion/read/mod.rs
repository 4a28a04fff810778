//! Readers of recorded moves: what a file says, as [`Waypoints`].

mod csv;
mod json;
mod yaml;

use std::path::Path;

use super::Waypoints;
use crate::error::{Error, ErrorKind, Reason, Result, listed};

pub use yaml::PlayMotion;

/// How to read a move.
#[derive(Debug, Clone, Default)]
pub struct MoveOptions {
    /// Angles of a CSV are degrees, not radians; the other formats are in radians by definition.
    pub degrees: bool,
    /// Which motion of a file of several.
    pub motion: Option<String>,
}

impl Waypoints {
    /// Reads a move by the extension of its file's name: `.csv`, `.json` (trajectory_msgs/JointTrajectory), `.yaml` or
    /// `.yml` (play_motion2).
    ///
    /// # Errors
    /// Those of [`from_csv`](Self::from_csv), [`from_json`](Self::from_json) and [`PlayMotion`], and when the extension is
    /// another or an option is not one of the format.
    pub fn read(name: &str, text: &[u8], options: &MoveOptions) -> Result<Self> {
        let extension = Path::new(name)
            .extension()
            .and_then(|e| e.to_str())
            .unwrap_or("")
            .to_ascii_lowercase();
        let refuse = |option: &str, expected: &str| {
            Err(Error::new(
                ErrorKind::Setting,
                format!("{option} for a move in {extension}"),
            )
            .expected(expected)
            .at(name))
        };
        match extension.as_str() {
            "csv" | "json" if options.motion.is_some() => {
                refuse("a motion to choose", "none: the file holds one move")
            }
            "json" | "yaml" | "yml" if options.degrees => {
                refuse("degrees", "radians, which the format is in")
            }
            "csv" => Self::from_csv(name, text, options.degrees),
            "json" => Self::from_json(name, text),
            "yaml" | "yml" => PlayMotion::read(name, text)?.choose(options.motion.as_deref()),
            _ => Err(
                Error::new(ErrorKind::Unsupported, "not a file of moves that is known")
                    .because(Reason::Unsupported)
                    .expected(".csv, .json (JointTrajectory), .yaml or .yml (play_motion2)")
                    .at(name),
            ),
        }
    }

    /// [`read`](Self::read) of a file.
    ///
    /// # Errors
    /// Those of `read`, and when the file cannot be read.
    pub fn open(path: &Path, options: &MoveOptions) -> Result<Self> {
        let text = crate::document::bytes(path)?;
        Self::read(&path.display().to_string(), &text, options)
    }
}

/// Text that may start with a byte order mark.
fn utf8(text: &[u8]) -> Result<&str> {
    let text = std::str::from_utf8(text).map_err(|e| {
        let line = 1 + text[..e.valid_up_to()]
            .iter()
            .filter(|b| **b == b'\n')
            .count();
        Error::new(ErrorKind::Syntax, "text that is not UTF-8").at(format!("line {line}"))
    })?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{Spline, StartPosture};

    const CSV: &str = "time_s,shoulder,elbow\n0.25,0.1,-1e-1\n1.75,0.3,7.25\n2.000000001,-0.7,0\n";
    const JSON: &str = r#"{"header": {"stamp": {"sec": 3}, "frame_id": ""}, "joint_names": ["shoulder", "elbow"], "points": [
        {"positions": [0.1, -0.1], "velocities": [], "time_from_start": {"sec": 0, "nanosec": 250000000}},
        {"positions": [0.3, 7.25], "effort": [1, 2], "time_from_start": 1.75},
        {"positions": [-0.7, 0], "time_from_start": {"secs": 2, "nsecs": 1}}]}"#;
    const YAML: &str = "/**:\n  ros__parameters:\n    motions:\n      wave:\n        joints: [shoulder, elbow]\n        positions: [0.1, -1e-1,\n                    0.3, 7.25,\n                    -0.7, 0]\n        times_from_start: [0.25, 1.75, 2.000000001]\n        meta: {name: Wave, usage: demo, description: 'one wave'}\n";

    #[test]
    fn one_move_in_three_formats_is_one_spline_bit_for_bit() {
        let read = |name: &str, text: &str| {
            let options = MoveOptions::default();
            let waypoints = Waypoints::read(name, text.as_bytes(), &options).unwrap();
            Spline::new(&waypoints, StartPosture::AtFirstWaypoint).unwrap()
        };
        let spline = read("move.csv", CSV);
        assert_eq!(spline.knots(), [0.0, 0.25, 1.75, 2.000000001]);
        assert_eq!(spline, read("move.json", JSON));
        assert_eq!(spline, read("move.YAML", YAML));
        assert_eq!(spline, read("bom.csv", &format!("\u{feff}{CSV}")));
    }

    #[test]
    fn options_that_a_format_does_not_have_are_refused() {
        let degrees = MoveOptions {
            degrees: true,
            ..MoveOptions::default()
        };
        let motion = MoveOptions {
            motion: Some("wave".into()),
            ..MoveOptions::default()
        };
        for (name, text, options, expected) in [
            ("m.json", JSON, &degrees, "degrees for a move in json"),
            ("m.yaml", YAML, &degrees, "degrees for a move in yaml"),
            ("m.csv", CSV, &motion, "a motion to choose"),
            ("m.bag", CSV, &motion, "m.bag: not a file of moves"),
            ("csv", CSV, &degrees, "csv: not a file of moves"),
        ] {
            let error = Waypoints::read(name, text.as_bytes(), options).unwrap_err();
            assert!(error.to_string().contains(expected), "{error}");
        }
    }
}

//! Moves as a motion file of play_motion2.

use std::fmt::Write as _;

use super::super::PlayMotion;
use super::Waypoints;
use crate::error::{Error, ErrorKind, Result};

impl Waypoints {
    /// A play_motion2 file of one motion of this `name`, which [`PlayMotion`] reads back, every number bit for bit. It holds
    /// positions alone: velocities and accelerations are left out, and the controller will interpolate linearly.
    ///
    /// # Errors
    /// When the name is not one of letters, digits and underscores, which names of ROS parameters are made of, or the file
    /// would be larger than such files may be.
    pub fn to_play_motion(&self, name: &str) -> Result<Vec<u8>> {
        let fits = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if name.is_empty() || !name.chars().all(fits) {
            return Err(
                Error::new(ErrorKind::Setting, format!("a motion called `{name}`"))
                    .expected("letters, digits and underscores"),
            );
        }
        // A number without a point is another type to ROS, and lists are of one type: `{:?}` always writes one, or an exponent.
        let joined = |numbers: &[f64]| {
            let numbers: Vec<String> = numbers.iter().map(|x| format!("{x:?}")).collect();
            numbers.join(", ")
        };
        // What JSON writes between quotes, YAML reads.
        let quoted = |text: &str| serde_json::Value::from(text).to_string();
        let joints: Vec<String> = self.joints().iter().map(|j| quoted(j)).collect();
        let rows: Vec<String> = self.iter().map(|w| joined(w.positions)).collect();
        let times: Vec<f64> = self.iter().map(|w| w.time).collect();
        let mut text = String::from("/play_motion2:\n  ros__parameters:\n    motions:\n");
        // The name may look like a number, so it is quoted too.
        let _ = write!(
            text,
            "      \"{name}\":\n        joints: [{}]\n        positions: [{}]\n        times_from_start: [{}]\n        \
             meta:\n          name: \"{name}\"\n          usage: demo\n          description: \"written by undulate\"\n",
            joints.join(", "),
            rows.join(",\n                    "),
            joined(&times)
        );
        let text = text.into_bytes();
        let read = PlayMotion::read("written", &text).and_then(|file| file.choose(Some(name)));
        self.held(text, read, "YAML of play_motion2")
    }
}

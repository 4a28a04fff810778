//! Moves as JSON in the field names of trajectory_msgs/JointTrajectory.

use serde::Serialize;

use super::{Waypoints, seconds_and_nanoseconds};
use crate::error::Result;

#[derive(Serialize)]
struct Trajectory<'a> {
    header: Header,
    joint_names: Vec<&'a str>,
    points: Vec<Point<'a>>,
}

/// Of a move that begins when it arrives.
#[derive(Serialize)]
struct Header {
    stamp: Time,
    frame_id: &'static str,
}

#[derive(Serialize)]
struct Point<'a> {
    positions: &'a [f64],
    velocities: &'a [f64],
    accelerations: &'a [f64],
    effort: [f64; 0],
    time_from_start: Time,
}

#[derive(Serialize)]
struct Time {
    sec: u64,
    nanosec: u64,
}

impl Time {
    fn of(t: f64) -> Self {
        let (sec, nanosec) = seconds_and_nanoseconds(t);
        Self { sec, nanosec }
    }
}

impl Waypoints {
    /// All fields of a trajectory_msgs/JointTrajectory of ROS 2, which [`from_json`](Self::from_json) reads back: numbers bit for
    /// bit, times to the nanosecond.
    ///
    /// # Errors
    /// None that waypoints within their bounds are known to cause.
    pub fn to_json(&self) -> Result<Vec<u8>> {
        let trajectory = Trajectory {
            header: Header {
                stamp: Time::of(0.0),
                frame_id: "",
            },
            joint_names: self.joints().iter().map(String::as_str).collect(),
            points: self
                .iter()
                .map(|w| Point {
                    positions: w.positions,
                    velocities: w.velocities.unwrap_or(&[]),
                    accelerations: w.accelerations.unwrap_or(&[]),
                    effort: [],
                    time_from_start: Time::of(w.time),
                })
                .collect(),
        };
        let mut text =
            serde_json::to_vec(&trajectory).expect("strings and finite numbers have a JSON form");
        text.push(b'\n');
        let read = Self::from_json("written", &text);
        self.held(text, read, "JSON")
    }
}

//! Recorded moves.

use std::ops::RangeInclusive;

use proptest::collection::vec;
use proptest::prelude::*;

use super::super::argument::require_counts;
use crate::fourier::Joints;
use crate::motion::{Waypoint, Waypoints};

/// Waypoints of up to so many joints: positions within 2 rad, 0.05 to 1 s apart from time 0 on (whole milliseconds, which every format keeps); a
/// third of them with velocities within 1 rad/s, a third with these and accelerations within 5 rad/s^2. They shrink to fewer joints and waypoints, to
/// positions alone, and to 0.
///
/// ```
/// use proptest::prelude::*;
/// use undulate::testing::waypoints;
/// use undulate::{Spline, StartPosture};
///
/// proptest!(|(waypoints in waypoints(1..=3, 2..=6))| {
///     prop_assert!(Spline::new(&waypoints, StartPosture::AtFirstWaypoint).is_ok());
/// });
/// ```
///
/// # Panics
/// When `joints` is an empty range or starts at 0, or `count` is empty or starts below 2.
#[track_caller]
pub fn waypoints(
    joints: RangeInclusive<usize>,
    count: RangeInclusive<usize>,
) -> impl Strategy<Value = Waypoints> {
    require_counts("joints", &joints, 1);
    require_counts("count", &count, 2);
    (joints, 0..3usize).prop_flat_map(move |(joints, derivatives)| {
        let row = (
            50..1000u32,
            vec(-2.0..2.0f64, joints),
            vec(-1.0..1.0f64, joints),
            vec(-5.0..5.0f64, joints),
        );
        vec(row, count.clone()).prop_map(move |rows| {
            let names = (0..joints).map(|d| format!("joint_{d}"));
            let mut milliseconds = 0;
            let waypoints = rows.iter().enumerate().map(|(i, (step, p, v, a))| {
                milliseconds += if i == 0 { 0 } else { *step };
                Waypoint {
                    time: f64::from(milliseconds) / 1000.0,
                    positions: p,
                    velocities: (derivatives > 0).then_some(v.as_slice()),
                    accelerations: (derivatives > 1).then_some(a.as_slice()),
                }
            });
            Waypoints::new(Joints::new(names).expect("at least one joint"), waypoints)
                .expect("finite numbers at increasing times")
        })
    })
}

/// A format of recorded moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// [`Waypoints::from_csv`].
    Csv,
    /// [`Waypoints::from_json`]: trajectory_msgs/JointTrajectory.
    Json,
    /// [`PlayMotion`](crate::PlayMotion): positions alone.
    Yaml,
}

impl Format {
    /// A file's name by which [`Waypoints::read`] knows the format.
    pub fn file(self) -> &'static str {
        match self {
            Self::Csv => "move.csv",
            Self::Json => "move.json",
            Self::Yaml => "move.yaml",
        }
    }
}

/// The texts of [`waypoints`] in a format, as they are written to be read again.
///
/// ```
/// use proptest::prelude::*;
/// use undulate::testing::{Format, hostile, moves};
/// use undulate::{MoveOptions, Waypoints};
///
/// for format in [Format::Csv, Format::Json, Format::Yaml] {
///     let read = |text: &str| Waypoints::read(format.file(), text.as_bytes(), &MoveOptions::default());
///     proptest!(|(text in moves(format, 1..=3, 2..=6))| {
///         prop_assert!(read(&text).is_ok());
///     });
///     // What is broken may be refused, but by an error.
///     proptest!(|(text in hostile(moves(format, 1..=3, 2..=6)))| { let _ = read(&text); });
/// }
/// ```
///
/// # Panics
/// As [`waypoints`] does.
#[track_caller]
pub fn moves(
    format: Format,
    joints: RangeInclusive<usize>,
    count: RangeInclusive<usize>,
) -> impl Strategy<Value = String> {
    waypoints(joints, count).prop_map(move |waypoints| {
        let bytes = match format {
            Format::Csv => waypoints.to_csv(),
            Format::Json => waypoints.to_json(),
            Format::Yaml => waypoints.to_play_motion("move"),
        };
        String::from_utf8(bytes.expect("waypoints that every format takes"))
            .expect("formats of text")
    })
}

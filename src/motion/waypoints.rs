//! [`Waypoints`]: where a recorded move has its joints at which times, checked, before anything lies between them.

use crate::error::{Error, ErrorKind, Reason, Result};
use crate::fourier::Joints;

/// The latest time of a waypoint \[s\].
const LATEST: f64 = 1e6;

/// Waypoints must be a nanosecond apart, the unit of time of the messages that carry them.
const NEAREST: f64 = 1e-9;

/// The largest modulus of a position, velocity or acceleration: whatever is larger is no motion of a robot.
const LARGEST: f64 = 1e9;

/// The most waypoints times joints: five minutes of seven joints at 1 kHz, below 200 MB as a spline.
const MOST_VALUES: usize = 2_000_000;

/// One waypoint: a row of [`Waypoints`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Waypoint<'a> {
    /// Since the start of the move \[s\].
    pub time: f64,
    /// One a joint \[rad, m\].
    pub positions: &'a [f64],
    /// One a joint \[rad/s, m/s\].
    pub velocities: Option<&'a [f64]>,
    /// One a joint \[rad/s^2, m/s^2\]; only with velocities.
    pub accelerations: Option<&'a [f64]>,
}

/// Waypoints of a move, at least one: times from 0 to 1e6 s that increase by a nanosecond at least, finite numbers no
/// larger than 1e9.
#[derive(Debug, Clone, PartialEq)]
pub struct Waypoints {
    joints: Joints,
    times: Vec<f64>,
    /// Row by row.
    positions: Vec<f64>,
    /// For each waypoint, where its row starts in `velocities`.
    with_velocities: Vec<Option<usize>>,
    velocities: Vec<f64>,
    with_accelerations: Vec<Option<usize>>,
    accelerations: Vec<f64>,
}

impl Waypoints {
    /// # Errors
    /// When there is no waypoint, or one breaks what this type promises; the message says which.
    pub fn new<'a>(
        joints: Joints,
        waypoints: impl IntoIterator<Item = Waypoint<'a>>,
    ) -> Result<Self> {
        let mut rows = Rows::new(joints);
        for (i, waypoint) in waypoints.into_iter().enumerate() {
            rows.push(waypoint)
                .map_err(|e| e.at(format!("waypoint {}", i + 1)))?;
        }
        rows.finish()
    }

    /// The joints that the waypoints name, in the order of their numbers.
    pub fn joints(&self) -> &Joints {
        &self.joints
    }

    /// Number of waypoints.
    #[allow(clippy::len_without_is_empty)] // never empty
    pub fn len(&self) -> usize {
        self.times.len()
    }

    /// Waypoint `index`; panics when there is none, as slices do.
    pub fn get(&self, index: usize) -> Waypoint<'_> {
        let d = self.joints.len();
        Waypoint {
            time: self.times[index],
            positions: &self.positions[index * d..(index + 1) * d],
            velocities: self.with_velocities[index].map(|at| &self.velocities[at..at + d]),
            accelerations: self.with_accelerations[index].map(|at| &self.accelerations[at..at + d]),
        }
    }

    /// The waypoints in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Waypoint<'_>> {
        (0..self.len()).map(|i| self.get(i))
    }

    /// The same move as one of `joints`, in their order; joints that it does not name stand still at their entry of
    /// `hold` \[rad, m\], as a controller holds what a trajectory leaves out.
    ///
    /// # Errors
    /// When the move names a joint that is not among `joints`, or `hold` is not one finite number a joint.
    pub fn for_joints(&self, joints: &Joints, hold: &[f64]) -> Result<Self> {
        if hold.len() != joints.len() {
            return Err(wrong_size(
                format!("a posture of {} numbers", hold.len()),
                format!("one for each of {} joints", joints.len()),
            ));
        }
        // For each joint of the result, its column here.
        let mut columns = vec![None; joints.len()];
        for (column, name) in self.joints.iter().enumerate() {
            let index = joints.index(name).map_err(|e| {
                e.because(Reason::UnknownJoint).help(
                    "name the robot's own joints; joints that mimic others follow by themselves",
                )
            })?;
            columns[index] = Some(column);
        }
        let zeros = vec![0.0; joints.len()];
        let take = |values: &[f64], still: &[f64], into: &mut Vec<f64>| {
            into.clear();
            into.extend(
                columns
                    .iter()
                    .zip(still)
                    .map(|(c, s)| c.map_or(*s, |c| values[c])),
            );
        };
        let mut rows = Rows::new(joints.clone());
        let [mut positions, mut velocities, mut accelerations] = [const { Vec::new() }; 3];
        for waypoint in self.iter() {
            take(waypoint.positions, hold, &mut positions);
            if let Some(values) = waypoint.velocities {
                take(values, &zeros, &mut velocities);
            }
            if let Some(values) = waypoint.accelerations {
                take(values, &zeros, &mut accelerations);
            }
            rows.push(Waypoint {
                time: waypoint.time,
                positions: &positions,
                velocities: waypoint.velocities.map(|_| velocities.as_slice()),
                accelerations: waypoint.accelerations.map(|_| accelerations.as_slice()),
            })?;
        }
        rows.finish()
    }
}

/// Waypoints as they are read, each checked as it comes.
#[derive(Debug)]
pub(super) struct Rows(Waypoints);

impl Rows {
    pub(super) fn new(joints: Joints) -> Self {
        Self(Waypoints {
            joints,
            times: Vec::new(),
            positions: Vec::new(),
            with_velocities: Vec::new(),
            velocities: Vec::new(),
            with_accelerations: Vec::new(),
            accelerations: Vec::new(),
        })
    }

    /// # Errors
    /// When the waypoint has other sizes than the joints, numbers out of range, accelerations without velocities, or a
    /// time that does not come after the one before; or there are too many.
    pub(super) fn push(&mut self, waypoint: Waypoint<'_>) -> Result<()> {
        let all = &mut self.0;
        let t = waypoint.time;
        if !t.is_finite() {
            return Err(Error::new(ErrorKind::Value, format!("time {t} s"))
                .because(Reason::NotFinite)
                .expected("a finite number of seconds"));
        }
        if !(0.0..=LATEST).contains(&t) {
            return Err(Error::new(ErrorKind::Value, format!("time {t} s"))
                .because(Reason::OutOfRange)
                .expected(format!(
                    "from 0 to {LATEST:e} s since the start of the move"
                )));
        }
        if let Some(before) = all.times.last()
            && t - before < NEAREST
        {
            return Err(Error::new(
                ErrorKind::Value,
                format!("time {t} s does not come after {before} s"),
            )
            .because(Reason::TimesNotIncreasing)
            .expected("times that increase, by a nanosecond at least")
            .help("sort the waypoints by time and remove repeated ones"));
        }
        if (all.times.len() + 1).saturating_mul(all.joints.len()) > MOST_VALUES {
            return Err(Error::new(
                ErrorKind::Unsupported,
                format!("more than {} waypoints", all.times.len()),
            )
            .because(Reason::TooLarge)
            .expected(format!("at most {MOST_VALUES:e} waypoints times joints"))
            .help("split the move, or leave out waypoints"));
        }
        check(&all.joints, "positions", waypoint.positions)?;
        if let Some(values) = waypoint.velocities {
            check(&all.joints, "velocities", values)?;
        }
        if let Some(values) = waypoint.accelerations {
            check(&all.joints, "accelerations", values)?;
            if waypoint.velocities.is_none() {
                return Err(wrong_size(
                    "accelerations without velocities",
                    "both, or positions alone",
                )
                .help("the controller has no interpolation for them"));
            }
        }
        all.times.push(t);
        all.positions.extend_from_slice(waypoint.positions);
        append(
            waypoint.velocities,
            &mut all.with_velocities,
            &mut all.velocities,
        );
        append(
            waypoint.accelerations,
            &mut all.with_accelerations,
            &mut all.accelerations,
        );
        Ok(())
    }

    /// # Errors
    /// When there was no waypoint.
    pub(super) fn finish(self) -> Result<Waypoints> {
        if self.0.times.is_empty() {
            return Err(Error::new(ErrorKind::Shape, "no waypoint")
                .because(Reason::NoDuration)
                .expected("at least one"));
        }
        Ok(self.0)
    }
}

fn append(values: Option<&[f64]>, starts: &mut Vec<Option<usize>>, all: &mut Vec<f64>) {
    starts.push(values.map(|_| all.len()));
    all.extend_from_slice(values.unwrap_or(&[]));
}

fn check(joints: &Joints, what: &str, values: &[f64]) -> Result<()> {
    if values.len() != joints.len() {
        return Err(wrong_size(
            format!("{} {what}", values.len()),
            format!("one for each of {} joints", joints.len()),
        ));
    }
    match values
        .iter()
        .position(|x| !x.is_finite() || x.abs() > LARGEST)
    {
        None => Ok(()),
        Some(i) => Err(
            Error::new(ErrorKind::Value, format!("{} among the {what}", values[i]))
                .because(if values[i].is_finite() {
                    Reason::OutOfRange
                } else {
                    Reason::NotFinite
                })
                .expected(format!("a finite number, at most {LARGEST:e} in SI units"))
                .at(format!("joint `{}`", joints.name(i))),
        ),
    }
}

pub(super) fn wrong_size(what: impl Into<String>, expected: impl Into<String>) -> Error {
    Error::new(ErrorKind::Shape, what)
        .because(Reason::WrongSize)
        .expected(expected)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(time: f64, positions: &[f64]) -> Waypoint<'_> {
        Waypoint {
            time,
            positions,
            velocities: None,
            accelerations: None,
        }
    }

    #[test]
    fn each_promise_is_kept_by_a_refusal_with_its_reason() {
        let joints = Joints::new(["a", "b"]).unwrap();
        let q = [0.0, 1.0];
        let good = at(0.0, &q);
        let cases: [(Vec<Waypoint<'_>>, Reason, &str); 12] = [
            (vec![], Reason::NoDuration, "no waypoint"),
            (
                vec![at(f64::NAN, &q)],
                Reason::NotFinite,
                "waypoint 1: time NaN s",
            ),
            (vec![at(-1e-3, &q)], Reason::OutOfRange, "time -0.001 s"),
            (vec![at(1.1e6, &q)], Reason::OutOfRange, "time 1100000 s"),
            (
                vec![good, good],
                Reason::TimesNotIncreasing,
                "waypoint 2: time 0 s",
            ),
            (
                vec![good, at(5e-10, &q)],
                Reason::TimesNotIncreasing,
                "after 0 s",
            ),
            (
                vec![at(1.0, &q), at(0.5, &q)],
                Reason::TimesNotIncreasing,
                "after 1 s",
            ),
            (vec![at(0.0, &q[..1])], Reason::WrongSize, "1 positions"),
            (
                vec![at(0.0, &[0.0, f64::INFINITY])],
                Reason::NotFinite,
                "joint `b`",
            ),
            (vec![at(0.0, &[-2e9, 0.0])], Reason::OutOfRange, "joint `a`"),
            (
                vec![Waypoint {
                    accelerations: Some(&q),
                    ..good
                }],
                Reason::WrongSize,
                "accelerations without velocities",
            ),
            (
                vec![Waypoint {
                    velocities: Some(&q[1..]),
                    ..good
                }],
                Reason::WrongSize,
                "1 velocities",
            ),
        ];
        for (rows, reason, text) in cases {
            let error = Waypoints::new(joints.clone(), rows).unwrap_err();
            assert_eq!(error.reason(), Some(reason), "{error}");
            assert!(error.to_string().contains(text), "{error}");
        }
    }

    #[test]
    fn there_are_only_so_many() {
        let joints = Joints::new((0..1000).map(|i| i.to_string())).unwrap();
        let q = vec![0.0; 1000];
        let error = Waypoints::new(joints, (0..).map(|i| at(f64::from(i), &q))).unwrap_err();
        assert_eq!(error.reason(), Some(Reason::TooLarge));
        assert!(error.to_string().contains("more than 2000 waypoints"));
    }

    #[test]
    fn other_joints_stand_still_and_columns_find_their_joints() {
        let own = Joints::new(["b", "a"]).unwrap();
        let row = Waypoint {
            velocities: Some(&[5.0, 6.0]),
            ..at(0.5, &[1.0, 2.0])
        };
        let waypoints = Waypoints::new(own, [at(0.0, &[3.0, 4.0]), row]).unwrap();
        let robot = Joints::new(["a", "x", "b"]).unwrap();
        let all = waypoints.for_joints(&robot, &[7.0, 8.0, 9.0]).unwrap();
        assert_eq!(all.get(0).positions, [4.0, 8.0, 3.0]);
        assert_eq!(all.get(0).velocities, None);
        assert_eq!(all.get(1).velocities, Some(&[6.0, 0.0, 5.0][..]));
        assert_eq!(all.get(1).time, 0.5);

        let error = waypoints.for_joints(&robot, &[0.0]).unwrap_err();
        assert_eq!(error.reason(), Some(Reason::WrongSize));
        let other = Joints::new(["a", "c"]).unwrap();
        let error = waypoints.for_joints(&other, &[0.0; 2]).unwrap_err();
        assert_eq!(error.reason(), Some(Reason::UnknownJoint));
        assert!(
            error
                .to_string()
                .contains("no joint `b`, expected one of a, c")
        );
    }
}

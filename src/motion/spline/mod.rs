//! [`Spline`]: a recorded move as the controller runs it.

mod ends;
mod resampled;
mod tube;

#[cfg(test)]
mod tests;

pub use ends::Jump;
pub use tube::SplineTube;

use super::Motion;
use super::polynomial::{Quintic, RangeSearch};
use super::waypoints::{Waypoint, Waypoints, wrong_size};
use crate::error::{Error, ErrorKind, Reason, Result};
use crate::fourier::{Derivative, Extremes, Interval, Joints, State};

/// A robot that is told to start within this of the first waypoint is there \[rad, m\]: what six digits of text leave.
const NEAR: f64 = 1e-6;

/// Where the robot is at time 0, before the first waypoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StartPosture<'a> {
    /// As the waypoints say: the first is at time 0, else the move is refused.
    Given,
    /// It stands at the first waypoint already. What brings it there is not part of the move.
    AtFirstWaypoint,
    /// It stands at these positions \[rad, m\], one a joint; a first waypoint at time 0 must be there too.
    At(&'a [f64]),
}

/// By which polynomial a segment interpolates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Degree {
    /// Positions alone: velocities jump at the waypoints.
    Linear,
    /// Positions and velocities at both ends: accelerations jump.
    Cubic,
    /// Accelerations too.
    Quintic,
}

/// A move through waypoints, as the spline that `joint_trajectory_controller` of ROS 2 runs: each segment is quintic when
/// both its ends have velocities and accelerations, cubic when both have velocities, else linear (its `Trajectory::sample`).
///
/// Before and after, the robot stands at the first and last position. When the first waypoint comes after time 0, the
/// segment towards it starts at rest where [`StartPosture`] says, with a velocity of 0 and no acceleration: so it is cubic at
/// most, as in a controller that measures position and velocity. A lone waypoint at time 0 is no move and is refused: to
/// check a posture, hold it for a while.
///
/// ```
/// use undulate::{Joints, Motion, Spline, StartPosture, Waypoint, Waypoints};
///
/// let point = |time, positions| Waypoint { time, positions, velocities: Some(&[0.0]), accelerations: None };
/// let waypoints = Waypoints::new(Joints::new(["elbow"])?, [point(0.0, &[0.0]), point(2.0, &[1.0])])?;
/// let spline = Spline::new(&waypoints, StartPosture::Given)?;
/// let range = spline.range(0, undulate::Derivative::Velocity);
/// assert!((range.upper - 0.75).abs() < 1e-13); // 3/2 of the mean
/// # Ok::<(), undulate::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Spline {
    joints: Joints,
    /// S + 1 of them, the first 0.
    knots: Vec<f64>,
    /// For each segment one polynomial a joint, in (t - knot) / length.
    pieces: Vec<Quintic>,
    degrees: Vec<Degree>,
    repeats: bool,
    /// A complete binary tree of enclosures of the positions, D a node: segment s is node S + s, node n holds 2n and 2n + 1.
    hulls: Vec<Interval>,
}

impl Spline {
    /// # Errors
    /// When the move has no duration, or it is not known or not true that the robot is where it starts.
    pub fn new(waypoints: &Waypoints, start: StartPosture<'_>) -> Result<Self> {
        let joints = waypoints.joints().clone();
        let first = waypoints.get(0);
        let posture = match start {
            StartPosture::At(posture) if posture.len() != joints.len() => {
                return Err(wrong_size(
                    format!("a start of {} positions", posture.len()),
                    format!("one for each of {} joints", joints.len()),
                ));
            }
            StartPosture::At(posture) => Some(posture),
            StartPosture::AtFirstWaypoint => Some(first.positions),
            StartPosture::Given => None,
        };
        let zeros = vec![0.0; joints.len()];
        let before = if first.time > 0.0 {
            let positions = posture.ok_or_else(|| start_unknown(first.time))?;
            Some(Waypoint {
                time: 0.0,
                positions,
                velocities: Some(&zeros),
                accelerations: None,
            })
        } else {
            if let Some(posture) = posture {
                require_near(&joints, posture, first.positions)?;
            }
            None
        };
        // Through `Waypoints` once more, so that the start is checked as the rest is.
        let points = Waypoints::new(joints.clone(), before.into_iter().chain(waypoints.iter()))?;
        if points.len() < 2 {
            return Err(Error::new(ErrorKind::Shape, "one waypoint, at time 0")
                .because(Reason::NoDuration)
                .expected("a move that lasts")
                .help("to check a posture, give it twice, a second apart"));
        }
        let segments = points.len() - 1;
        let mut pieces = Vec::with_capacity(segments * joints.len());
        let mut degrees = Vec::with_capacity(segments);
        for s in 0..segments {
            degrees.push(interpolate(&points.get(s), &points.get(s + 1), &mut pieces));
        }
        let hulls = hull_tree(&pieces, joints.len());
        Ok(Self {
            joints,
            knots: points.iter().map(|p| p.time).collect(),
            pieces,
            degrees,
            repeats: false,
            hulls,
        })
    }

    /// The same move, begun anew whenever it ends.
    ///
    /// # Errors
    /// When it does not end where it begins, to 1e-9 rad or m.
    pub fn repeated(&self) -> Result<Self> {
        for (joint, name) in self.joints.iter().enumerate() {
            let (first, last) = (self.piece(0, joint), self.piece(self.segments() - 1, joint));
            let gap = (first.value(0.0) - last.value(1.0)).abs();
            if gap > CLOSED {
                return Err(Error::new(
                    ErrorKind::Infeasible,
                    format!("the move ends {gap:e} from where it begins"),
                )
                .because(Reason::NotClosed)
                .expected("a last waypoint that equals the first")
                .at(format!("joint `{name}`")));
            }
        }
        Ok(Self {
            repeats: true,
            ..self.clone()
        })
    }

    /// Times of the waypoints \[s\], the first 0.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// Of each segment between two knots.
    pub fn degrees(&self) -> &[Degree] {
        &self.degrees
    }

    fn segments(&self) -> usize {
        self.degrees.len()
    }

    fn piece(&self, segment: usize, joint: usize) -> &Quintic {
        &self.pieces[segment * self.joints.len() + joint]
    }

    fn length(&self, segment: usize) -> f64 {
        self.knots[segment + 1] - self.knots[segment]
    }

    /// The segment of a time within 0..=duration; the later one at a knot between two.
    fn segment_at(&self, t: f64) -> usize {
        let later = self.knots.partition_point(|knot| *knot <= t);
        later.saturating_sub(1).min(self.segments() - 1)
    }

    /// `t` within the segment, from 0 to 1.
    fn local(&self, segment: usize, t: f64) -> f64 {
        ((t - self.knots[segment]) / self.length(segment)).clamp(0.0, 1.0)
    }

    /// `t` reduced to one period when the move repeats.
    fn reduced(&self, t: f64) -> f64 {
        if self.repeats {
            let duration = self.duration();
            (t - libm::floor(t / duration) * duration).clamp(0.0, duration)
        } else {
            t
        }
    }
}

/// How far the ends of a move that repeats may be apart \[rad, m\].
const CLOSED: f64 = 1e-9;

fn start_unknown(first: f64) -> Error {
    Error::new(
        ErrorKind::Infeasible,
        format!("the first waypoint is at {first} s, and nothing says where the robot starts"),
    )
    .because(Reason::StartUnknown)
    .expected("a waypoint at time 0")
    .help("say where the robot starts (--at), or that it stands at the first waypoint (--from-first-waypoint)")
}

fn require_near(joints: &Joints, posture: &[f64], first: &[f64]) -> Result<()> {
    for (joint, (a, b)) in joints.iter().zip(posture.iter().zip(first)) {
        if (a - b).is_nan() || (a - b).abs() > NEAR {
            return Err(Error::new(
                ErrorKind::Infeasible,
                format!("the robot starts at {a}, the move at {b} at once"),
            )
            .because(Reason::StartElsewhere)
            .expected("one place")
            .help("start at the first waypoint, or give it a later time")
            .at(format!("joint `{joint}`")));
        }
    }
    Ok(())
}

/// The polynomials of one segment, one a joint, after the rule of the controller.
fn interpolate(a: &Waypoint<'_>, b: &Waypoint<'_>, pieces: &mut Vec<Quintic>) -> Degree {
    let t = b.time - a.time;
    let joints = 0..a.positions.len();
    let ends = a.velocities.zip(b.velocities);
    let Some((va, vb)) = ends else {
        pieces.extend(joints.map(|j| Quintic::linear(a.positions[j], b.positions[j])));
        return Degree::Linear;
    };
    let Some((aa, ab)) = a.accelerations.zip(b.accelerations) else {
        pieces.extend(
            joints
                .map(|j| Quintic::cubic([a.positions[j], t * va[j]], [b.positions[j], t * vb[j]])),
        );
        return Degree::Cubic;
    };
    pieces.extend(joints.map(|j| {
        Quintic::hermite(
            [a.positions[j], t * va[j], t * t * aa[j]],
            [b.positions[j], t * vb[j], t * t * ab[j]],
        )
    }));
    Degree::Quintic
}

fn hull_tree(pieces: &[Quintic], joints: usize) -> Vec<Interval> {
    let mut hulls = vec![Interval::point(0.0); pieces.len()];
    hulls.extend(pieces.iter().map(Quintic::hull));
    for at in (joints..pieces.len()).rev() {
        let (node, joint) = (at / joints, at % joints);
        let child = 2 * node * joints + joint;
        hulls[at] = hulls[child].hull(hulls[child + joints]);
    }
    hulls
}

impl Motion for Spline {
    type Tube<'a> = SplineTube<'a>;

    fn joints(&self) -> &Joints {
        &self.joints
    }

    fn duration(&self) -> f64 {
        self.knots[self.segments()]
    }

    fn is_periodic(&self) -> bool {
        self.repeats
    }

    /// At a knot between two segments, what comes after it.
    fn state_into(&self, t: f64, state: &mut State) {
        let t = self.reduced(t);
        let segment = self.segment_at(t);
        let (u, length) = (self.local(segment, t), self.length(segment));
        let moves = (0.0..=self.duration()).contains(&t);
        for joint in 0..self.joints.len() {
            let b = self.piece(segment, joint).about(u);
            let still = if moves { 1.0 / length } else { 0.0 };
            state.position[joint] = b[0];
            state.velocity[joint] = still * b[1];
            state.acceleration[joint] = 2.0 * still * still * b[2];
            state.jerk[joint] = 6.0 * still * still * still * b[3];
        }
    }

    /// Infinite for a derivative of something that jumps, at the time of the largest jump (see [`Spline::jump`]).
    fn extremes(&self, joint: usize, derivative: Derivative) -> Extremes {
        let jumps = [Derivative::Velocity, Derivative::Acceleration]
            .into_iter()
            .filter(|d| d.order() < derivative.order())
            .find_map(|d| self.jump(joint, d));
        if let Some(jump) = jumps {
            return Extremes {
                range: Interval::within(f64::INFINITY),
                lower_time: jump.time,
                upper_time: jump.time,
            };
        }
        self.inner_extremes(joint, derivative)
    }

    fn tube(&self) -> SplineTube<'_> {
        SplineTube::new(self)
    }
}

impl Spline {
    /// The extremes of the segments, whatever jumps between them.
    pub(super) fn inner_extremes(&self, joint: usize, derivative: Derivative) -> Extremes {
        let order = derivative.order();
        let piece = |s: usize| self.piece(s, joint).derivative(order, self.length(s));
        let mut search = RangeSearch::new();
        for s in 0..self.segments() {
            let p = piece(s);
            search.reach(s, &p, 0.0);
            search.reach(s, &p, 1.0);
        }
        for s in 0..self.segments() {
            search.enclose(s, &piece(s));
        }
        let (range, low, high) = search.found();
        let time = |(s, u): (usize, f64)| self.knots[s] + u * self.length(s);
        Extremes {
            range,
            lower_time: time(low),
            upper_time: time(high),
        }
    }
}

//! What torque or force a motion takes of each joint.

use super::limits::excess_of;
use crate::error::{Reason, Result};
use crate::fourier::{Interval, State};
use crate::motion::{Motion, Tube};
use crate::robot::{BodyJoint, Dynamics, GRAVITY, JointKind, Robot};

/// Samples on each piece of a motion: a piece is about half a cycle of its highest harmonic, and torques have twice its frequency; or a segment of
/// a spline, a polynomial.
const SAMPLES: usize = 12;
/// So near to an end of a piece, as a share of its half: accelerations may jump there.
const BESIDE: f64 = 1.0 - 1e-9;
/// To find where a joint turns back, where friction jumps.
const HALVINGS: usize = 30;
/// Parabolas that are laid through a peak, one after the other.
const PARABOLAS: usize = 4;
/// A peak whose sample is below the highest by no more than this share of the range may be the highest: with six samples a cycle, one may lie
/// below its peak by 1 - cos(pi / 6) of the amplitude.
const RIVAL: f64 = 0.07;

/// The torque or force that a motion takes of a joint, beside the limit: inverse dynamics with damping and friction, under gravity.
///
/// An estimate: the largest and smallest of samples, some sixteen a cycle of the highest harmonic, each refined by parabolas, and of both sides of where
/// accelerations or friction jump. Between samples nothing is proven, other than for [`LimitUse`](super::LimitUse).
#[derive(Debug, Clone, PartialEq)]
pub struct EffortUse {
    /// The joint, commanded or mimicking.
    pub joint: String,
    /// Whether the numbers are N m or N.
    pub kind: JointKind,
    /// What the motion takes, as estimated.
    pub range: Interval,
    /// When the lower end is reached \[s\].
    pub lower_time: f64,
    /// When the upper end is.
    pub upper_time: f64,
    /// What the robot's file allows; `None` when it does not say.
    pub limit: Option<f64>,
}

impl EffortUse {
    /// How far the range leaves the limit; 0 when it does not, or when there is none.
    pub fn excess(&self) -> f64 {
        self.limit
            .map_or(0.0, |limit| excess_of(self.range, Interval::within(limit)))
    }

    /// When the effort is largest \[s\].
    pub fn worst_time(&self) -> f64 {
        if self.range.lower.abs() > self.range.upper.abs() {
            self.lower_time
        } else {
            self.upper_time
        }
    }

    /// Why the motion does not pass, if the limit is broken.
    pub fn reason(&self) -> Option<Reason> {
        (self.excess() > 0.0).then_some(Reason::EffortLimit)
    }
}

/// What torque or force `motion` takes of every joint of `robot`.
///
/// # Errors
/// When the motion is not of the robot's joints, or the robot lacks masses.
pub fn efforts<M: Motion>(robot: &Robot, motion: &M) -> Result<Vec<EffortUse>> {
    robot.require_joints(motion.joints())?;
    robot.require_dynamics()?;
    let mut pieces = Vec::new();
    motion.tube().smooth_pieces(&mut pieces);
    let times: Vec<(f64, f64)> = pieces
        .iter()
        .flat_map(|(middle, half)| {
            let step = 2.0 * half / SAMPLES as f64;
            (0..SAMPLES).map(move |n| (middle - half + (n as f64 + 0.5) * step, step))
        })
        .collect();
    let mut plant = Plant::new(robot);
    // A row a sample: of each joint.
    let joints = plant.joints.len();
    let mut rows = Vec::with_capacity(times.len() * joints);
    for (time, _) in &times {
        rows.extend_from_slice(plant.efforts(motion, *time));
    }
    // Where efforts jump they are taken on either side.
    let mut jumps: Vec<f64> = pieces
        .iter()
        .flat_map(|(middle, half)| [-1.0, 1.0].map(|end| middle + end * half * BESIDE))
        .collect();
    plant.reversals(motion, &times, &mut jumps);
    let mut beside = Vec::with_capacity(jumps.len() * joints);
    for time in &jumps {
        beside.extend_from_slice(plant.efforts(motion, *time));
    }
    let uses = (0..joints).map(|j| {
        let column: Vec<f64> = rows.iter().skip(j).step_by(joints).copied().collect();
        let (mut lower_time, mut lower) = plant.highest(motion, j, &times, &column, -1.0);
        let (mut upper_time, mut upper) = plant.highest(motion, j, &times, &column, 1.0);
        for (time, effort) in jumps.iter().zip(beside.iter().skip(j).step_by(joints)) {
            if *effort < lower {
                (lower_time, lower) = (*time, *effort);
            }
            if *effort > upper {
                (upper_time, upper) = (*time, *effort);
            }
        }
        let joint = plant.joints[j].1;
        EffortUse {
            joint: joint.name.clone(),
            kind: joint.kind,
            range: Interval { lower, upper },
            lower_time,
            upper_time,
            limit: joint.properties.effort,
        }
    });
    Ok(uses.collect())
}

/// A robot that is made to follow a motion.
struct Plant<'a> {
    robot: &'a Robot,
    joints: Vec<(usize, &'a BodyJoint)>,
    dynamics: Dynamics,
    state: State,
    efforts: Vec<f64>,
}

impl<'a> Plant<'a> {
    fn new(robot: &'a Robot) -> Self {
        let joints: Vec<(usize, &BodyJoint)> = robot.moving().collect();
        Self {
            robot,
            dynamics: Dynamics::new(robot),
            state: State::zeros(robot.joints().len()),
            efforts: vec![0.0; joints.len()],
            joints,
        }
    }

    /// Appends times just before and after those at which a joint with friction turns back, between two samples.
    fn reversals<M: Motion>(&mut self, motion: &M, times: &[(f64, f64)], reversals: &mut Vec<f64>) {
        let rubbing: Vec<usize> = (0..self.joints.len())
            .filter(|j| self.joints[*j].1.properties.friction > 0.0)
            .collect();
        if rubbing.is_empty() {
            return;
        }
        let mut rate = |time: f64, j: usize| {
            motion.state_into(time, &mut self.state);
            let joint = self.joints[j].1;
            joint.multiplier * self.state.velocity[joint.index]
        };
        for pair in times.windows(2) {
            for j in &rubbing {
                let (mut before, mut after) = (pair[0].0, pair[1].0);
                let forth = rate(before, *j) > 0.0;
                if forth == (rate(after, *j) > 0.0) {
                    continue;
                }
                for _ in 0..HALVINGS {
                    let middle = before + (after - before) / 2.0;
                    if (rate(middle, *j) > 0.0) == forth {
                        before = middle;
                    } else {
                        after = middle;
                    }
                }
                reversals.extend([before, after]);
            }
        }
    }

    /// Of every joint at a time.
    fn efforts<M: Motion>(&mut self, motion: &M, time: f64) -> &[f64] {
        motion.state_into(time, &mut self.state);
        let State {
            position,
            velocity,
            acceleration,
            ..
        } = &self.state;
        self.dynamics.inverse(
            self.robot,
            position.as_slice(),
            velocity.as_slice(),
            acceleration.as_slice(),
            &GRAVITY,
        );
        let own = self.dynamics.body_efforts();
        for (effort, (body, joint)) in self.efforts.iter_mut().zip(&self.joints) {
            *effort = own[*body] + joint.resistance(joint.multiplier * velocity[joint.index]);
        }
        &self.efforts
    }

    /// Time and value of the highest peak, upwards or (`sign` -1) downwards, given the samples.
    fn highest<M: Motion>(
        &mut self,
        motion: &M,
        joint: usize,
        times: &[(f64, f64)],
        samples: &[f64],
        sign: f64,
    ) -> (f64, f64) {
        let count = samples.len();
        let at = |n: usize| sign * samples[n % count];
        let range = |f: fn(f64, f64) -> f64, start| samples.iter().fold(start, |a, b| f(a, *b));
        let width = range(f64::max, f64::NEG_INFINITY) - range(f64::min, f64::INFINITY);
        let Some(top) = (0..count).max_by(|a, b| at(*a).total_cmp(&at(*b))) else {
            return (0.0, 0.0);
        };
        let mut highest = (times[top].0, samples[top]);
        for (n, time) in times.iter().enumerate() {
            // What stays as it is has no peak.
            let is_peak = at(n) > at(n + count - 1) && at(n) >= at(n + 1);
            if n == top || is_peak && at(n) >= at(top) - RIVAL * width {
                let found = self.peak(motion, joint, *time, sign);
                if sign * found.1 > sign * highest.1 {
                    highest = found;
                }
            }
        }
        highest
    }

    /// Time and value of the peak next to a sample, upwards or (`sign` -1) downwards, about a step from it.
    fn peak<M: Motion>(
        &mut self,
        motion: &M,
        joint: usize,
        (mut best, mut step): (f64, f64),
        sign: f64,
    ) -> (f64, f64) {
        let end = motion.duration();
        let within = |t: f64| {
            if motion.is_periodic() {
                t
            } else {
                t.clamp(0.0, end)
            }
        };
        let mut at = |t: f64| sign * self.efforts(motion, t)[joint];
        let mut height = at(best);
        for _ in 0..PARABOLAS {
            let (before, after) = (at(within(best - step)), at(within(best + step)));
            let bend = 2.0 * height - before - after;
            let shift = if bend > 0.0 {
                0.5 * step * (after - before) / bend
            } else {
                0.0
            };
            let moved = within(best + shift.clamp(-step, step));
            for (time, value) in [
                (moved, at(moved)),
                (within(best - step), before),
                (within(best + step), after),
            ] {
                if value > height {
                    (best, height) = (time, value);
                }
            }
            step /= 4.0;
        }
        (best.rem_euclid(end.max(f64::MIN_POSITIVE)), sign * height)
    }
}

//! What a motion takes of each joint's limits.

use super::given::{JointLimit, JointLimits};
use crate::error::{Reason, Result};
use crate::fourier::{Derivative, Extremes, Interval};
use crate::motion::Motion;
use crate::robot::{BodyJoint, JointKind, Robot};

/// An excess below this share of the limit is the rounding of the decimals in which motion and limit were written, and
/// none: a waypoint on the limit keeps it.
const ROUNDING: f64 = 1e-12;

/// Who set a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LimitSource {
    /// The robot's file.
    Robot,
    /// The caller, by [`JointLimits`].
    Given,
}

/// The range that a motion takes of a joint's position, velocity or acceleration, beside the limit.
#[derive(Debug, Clone, PartialEq)]
pub struct LimitUse {
    /// The joint, commanded or mimicking.
    pub joint: String,
    /// Whether the numbers are rad, rad/s and rad/s^2, or m, m/s and m/s^2.
    pub kind: JointKind,
    /// [`Derivative::Position`], [`Derivative::Velocity`] or [`Derivative::Acceleration`].
    pub quantity: Derivative,
    /// An enclosure of what the motion does, from exact bounds and not from samples (see [`Motion::extremes`]);
    /// infinite for the acceleration of a motion whose velocity jumps.
    pub range: Interval,
    /// When the lower end of the range is reached \[s\].
    pub lower_time: f64,
    /// When the upper end is.
    pub upper_time: f64,
    /// What is allowed.
    pub limit: Interval,
    /// Who said so.
    pub source: LimitSource,
}

impl LimitUse {
    /// How far the range leaves the limit; 0 when it does not, up to rounding (1e-12 of the limit).
    pub fn excess(&self) -> f64 {
        excess_of(self.range, self.limit)
    }

    fn below(&self) -> f64 {
        self.limit.lower - self.range.lower
    }

    fn above(&self) -> f64 {
        self.range.upper - self.limit.upper
    }

    /// When the motion is nearest to leaving the limit, or farthest outside \[s\].
    pub fn worst_time(&self) -> f64 {
        if self.below() > self.above() {
            self.lower_time
        } else {
            self.upper_time
        }
    }

    /// Why the motion does not pass, if the limit is broken.
    pub fn reason(&self) -> Option<Reason> {
        if self.excess() == 0.0 {
            return None;
        }
        Some(match self.quantity {
            Derivative::Position => Reason::PositionLimit,
            Derivative::Velocity => Reason::VelocityLimit,
            _ if self.range.magnitude() == f64::INFINITY => Reason::VelocityJump,
            _ => Reason::AccelerationLimit,
        })
    }
}

/// How far `range` leaves `limit`, up to rounding.
pub(super) fn excess_of(range: Interval, limit: Interval) -> f64 {
    let (below, above) = (limit.lower - range.lower, range.upper - limit.upper);
    let most = below.max(above);
    if below.is_nan() || above.is_nan() {
        // Not comparable: what cannot be checked does not pass.
        f64::INFINITY
    } else if most <= ROUNDING * limit.magnitude() {
        0.0
    } else {
        most
    }
}

/// Every position and velocity limit that `robot` gives, beside what `motion` does.
///
/// # Errors
/// When the motion is not of the robot's joints.
pub fn limits<M: Motion>(robot: &Robot, motion: &M) -> Result<Vec<LimitUse>> {
    limits_with(robot, motion, &JointLimits::default())
}

/// [`limits`], with those that the caller sets.
///
/// # Errors
/// When the motion is not of the robot's joints, or a limit is set for a joint that the robot does not have.
pub fn limits_with<M: Motion>(
    robot: &Robot,
    motion: &M,
    given: &JointLimits,
) -> Result<Vec<LimitUse>> {
    robot.require_joints(motion.joints())?;
    let names: Vec<String> = robot.moving().map(|(_, j)| j.name.clone()).collect();
    given.require_known(&names)?;
    let mut uses = Vec::new();
    for (_, joint) in robot.moving() {
        let own = own_limits(joint);
        let all = given.over(&joint.name, own);
        let speed = |v: f64| Interval::within(v);
        for (quantity, limit, robots) in [
            (Derivative::Position, all.position, own.position),
            (
                Derivative::Velocity,
                all.velocity.map(speed),
                own.velocity.map(speed),
            ),
            (Derivative::Acceleration, all.acceleration.map(speed), None),
        ] {
            let Some(limit) = limit else { continue };
            let extremes = of_joint(joint, quantity, motion.extremes(joint.index, quantity));
            uses.push(LimitUse {
                joint: joint.name.clone(),
                kind: joint.kind,
                quantity,
                range: extremes.range,
                lower_time: extremes.lower_time,
                upper_time: extremes.upper_time,
                limit,
                source: if robots == Some(limit) {
                    LimitSource::Robot
                } else {
                    LimitSource::Given
                },
            });
        }
    }
    Ok(uses)
}

/// The joints whose velocity nobody limits, robot or caller: for a gate that must know (`Reason::LimitMissing`).
/// Positions without limits are those of continuous joints.
pub fn without_velocity_limit(robot: &Robot, given: &JointLimits) -> Vec<String> {
    robot
        .moving()
        .filter(|(_, j)| given.over(&j.name, own_limits(j)).velocity.is_none())
        .map(|(_, j)| j.name.clone())
        .collect()
}

fn own_limits(joint: &BodyJoint) -> JointLimit {
    JointLimit {
        position: joint.properties.position,
        velocity: joint.properties.velocity,
        acceleration: None,
    }
}

/// What a joint does when the entry of q that moves it does `of`: a joint that mimics has a multiplier and an offset.
fn of_joint(joint: &BodyJoint, quantity: Derivative, of: Extremes) -> Extremes {
    let shift = match quantity {
        Derivative::Position => joint.offset,
        _ => 0.0,
    };
    // A multiplier of 0 stands still, whatever it mimics.
    let image = |x: f64| {
        if joint.multiplier == 0.0 {
            shift
        } else {
            joint.multiplier * x + shift
        }
    };
    let (lower, upper) = (image(of.range.lower), image(of.range.upper));
    if joint.multiplier < 0.0 {
        Extremes {
            range: Interval {
                lower: upper,
                upper: lower,
            },
            lower_time: of.upper_time,
            upper_time: of.lower_time,
        }
    } else {
        Extremes {
            range: Interval { lower, upper },
            ..of
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fourier::{Joints, Wave};
    use crate::motion::{Spline, StartPosture, Waypoint, Waypoints};
    use nalgebra::{dmatrix, dvector};
    use num_complex::Complex;

    #[test]
    fn a_mimicking_joint_has_limits_of_its_own() {
        let robot = gripper();
        // left moves within 0.1 +- 0.1, right within -2 (0.1 +- 0.1) + 0.1 = -0.3 .. 0.1.
        let wave = |size: f64| {
            Wave::new(
                robot.joints().clone(),
                1.0,
                dvector![0.1],
                dmatrix![Complex::new(size / 2.0, 0.0)],
            )
            .unwrap()
        };
        let right = |size: f64| {
            let uses = limits(&robot, &wave(size)).unwrap();
            uses.into_iter()
                .find(|u| u.joint == "right" && u.quantity == Derivative::Position)
                .unwrap()
        };
        assert_eq!(right(0.2).kind, JointKind::Prismatic);
        assert_eq!(right(0.099).excess(), 0.0);
        assert!((right(0.2).excess() - 0.2).abs() < 1e-5);
        // The cosine is largest at the start of the period, and `right` is lowest then.
        let time = right(0.2).worst_time();
        assert!(time.min(1.0 - time) < 1e-2, "{time}");
    }

    fn gripper() -> Robot {
        Robot::from_urdf(
            r#"<robot name="gripper"><link name="a"/><link name="b"/><link name="c"/>
            <joint name="left" type="prismatic"><parent link="a"/><child link="b"/><limit lower="-1" upper="1" velocity="9"/></joint>
            <joint name="right" type="prismatic"><parent link="a"/><child link="c"/><limit lower="-0.3" upper="0.3" velocity="9"/>
            <mimic joint="left" multiplier="-2" offset="0.1"/></joint></robot>"#,
        )
        .unwrap()
    }

    /// `left` through these (time, position, velocity).
    fn spline(points: &[(f64, f64, Option<f64>)]) -> Spline {
        let rows = points.iter().map(|(time, position, velocity)| Waypoint {
            time: *time,
            positions: std::slice::from_ref(position),
            velocities: velocity.as_ref().map(std::slice::from_ref),
            accelerations: None,
        });
        let waypoints = Waypoints::new(Joints::new(["left"]).unwrap(), rows).unwrap();
        Spline::new(&waypoints, StartPosture::Given).unwrap()
    }

    fn reasons(motion: &Spline, given: &JointLimits) -> Vec<(Reason, String)> {
        let uses = limits_with(&gripper(), motion, given).unwrap();
        uses.iter()
            .filter_map(|u| Some((u.reason()?, u.joint.clone())))
            .collect()
    }

    #[test]
    fn an_overshoot_between_waypoints_is_found_where_it_is() {
        // Cubic, symmetric: 0.05 + 4 u (1 - u) 0.19 peaks at 0.24 in the middle, so right reaches -0.38.
        let slope = 4.0 * 0.19 / 2.0;
        let overshoot = spline(&[(0.0, 0.05, Some(slope)), (2.0, 0.05, Some(-slope))]);
        let uses = limits(&gripper(), &overshoot).unwrap();
        let broken: Vec<&LimitUse> = uses.iter().filter(|u| u.excess() > 0.0).collect();
        assert_eq!(broken.len(), 1);
        assert_eq!(broken[0].reason(), Some(Reason::PositionLimit));
        assert_eq!(broken[0].joint, "right");
        assert!((broken[0].excess() - 0.08).abs() < 1e-12);
        assert!((broken[0].worst_time() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_waypoint_on_the_limit_keeps_it_and_one_beyond_does_not() {
        // right: -2 q + 0.1 is 0.3 at q = -0.1.
        let to = |q: f64| spline(&[(0.0, 0.0, None), (1.0, q, None)]);
        assert_eq!(reasons(&to(-0.1), &JointLimits::default()), []);
        assert_eq!(
            reasons(&to(-0.1 - 1e-9), &JointLimits::default()),
            [(Reason::PositionLimit, "right".to_owned())]
        );
    }

    #[test]
    fn accelerations_are_looked_at_where_they_are_limited_and_jumps_have_a_code_of_their_own() {
        let line = spline(&[(0.0, 0.0, None), (1.0, 0.1, None)]);
        let ease = spline(&[(0.0, 0.0, Some(0.0)), (1.0, 0.1, Some(0.0))]);
        let most = |acceleration: f64| {
            let limit = JointLimit {
                acceleration: Some(acceleration),
                ..JointLimit::default()
            };
            JointLimits::default().with(Some("left"), limit).unwrap()
        };
        let left = "left".to_owned();
        assert_eq!(reasons(&line, &JointLimits::default()), []);
        assert_eq!(
            reasons(&line, &most(1e6)),
            [(Reason::VelocityJump, left.clone())]
        );
        // 6 times 0.1 at either end.
        assert_eq!(reasons(&ease, &most(0.6)), []);
        assert_eq!(
            reasons(&ease, &most(0.599)),
            [(Reason::AccelerationLimit, left)]
        );
    }

    #[test]
    fn a_speed_is_that_of_the_joint_and_the_caller_s_limit_is_said_to_be_his() {
        let given = JointLimits::from_toml("[limits.right]\nvelocity = 0.15").unwrap();
        let line = spline(&[(0.0, 0.0, None), (1.0, 0.1, None)]);
        let uses = limits_with(&gripper(), &line, &given).unwrap();
        let broken: Vec<&LimitUse> = uses.iter().filter(|u| u.reason().is_some()).collect();
        assert_eq!(broken.len(), 1);
        assert_eq!(broken[0].reason(), Some(Reason::VelocityLimit));
        assert_eq!(
            (broken[0].source, uses[0].source),
            (LimitSource::Given, LimitSource::Robot)
        );
        assert!((broken[0].excess() - 0.05).abs() < 1e-12);

        let unknown = JointLimits::from_toml("[limits.middle]\nvelocity = 1.0").unwrap();
        let error = limits_with(&gripper(), &line, &unknown).unwrap_err();
        assert_eq!(error.reason(), Some(Reason::UnknownJoint));
        assert!(without_velocity_limit(&gripper(), &unknown).is_empty());
    }

    #[test]
    fn what_is_no_number_does_not_pass() {
        let uses = limits(&gripper(), &spline(&[(0.0, 0.0, None), (1.0, 0.1, None)])).unwrap();
        for (lower, upper) in [(f64::NAN, f64::NAN), (f64::NAN, 0.0), (0.0, f64::NAN)] {
            let broken = LimitUse {
                range: Interval { lower, upper },
                ..uses[0].clone()
            };
            assert_eq!(broken.excess(), f64::INFINITY);
            assert_eq!(broken.reason(), Some(Reason::PositionLimit));
        }
    }
}

//! What stands between a wave and its execution: limits of the joints, and self-collision.

use crate::collision::{Certification, CollisionModel};
use crate::error::Result;
use crate::fourier::{Derivative, Interval};
use crate::motion::Motion;
use crate::robot::{JointKind, Robot};

/// The range that a wave takes of a joint's position or velocity, beside the limit.
#[derive(Debug, Clone, PartialEq)]
pub struct LimitUse {
    /// The joint, commanded or mimicking.
    pub joint: String,
    /// Whether the numbers are rad and rad/s, or m and m/s.
    pub kind: JointKind,
    /// [`Derivative::Position`] or [`Derivative::Velocity`].
    pub quantity: Derivative,
    /// An enclosure of what the wave does over its period, from exact bounds of its series (see [`Wave::range`]) \[rad, rad/s; m, m/s\].
    pub range: Interval,
    /// What the robot allows.
    pub limit: Interval,
}

impl LimitUse {
    /// How far the range leaves the limit \[rad, rad/s; m, m/s\]; 0 when it does not.
    pub fn excess(&self) -> f64 {
        (self.limit.lower - self.range.lower)
            .max(self.range.upper - self.limit.upper)
            .max(0.0)
    }
}

/// Every position and velocity limit that `robot` gives, beside what `wave` does.
///
/// # Errors
/// When the wave is not of the robot's joints.
pub fn limits<M: Motion>(robot: &Robot, wave: &M) -> Result<Vec<LimitUse>> {
    robot.require_joints(wave.joints())?;
    let mut uses = Vec::new();
    for (_, joint) in robot.moving() {
        let speed = joint.properties.velocity.map(|v| Interval {
            lower: -v,
            upper: v,
        });
        for (quantity, limit) in [
            (Derivative::Position, joint.properties.position),
            (Derivative::Velocity, speed),
        ] {
            if let Some(limit) = limit {
                let shift = if quantity == Derivative::Position {
                    joint.offset
                } else {
                    0.0
                };
                let range = wave.range(joint.index, quantity);
                let ends = [range.lower, range.upper].map(|x| joint.multiplier * x + shift);
                uses.push(LimitUse {
                    joint: joint.name.clone(),
                    kind: joint.kind,
                    quantity,
                    range: Interval {
                        lower: ends[0].min(ends[1]),
                        upper: ends[0].max(ends[1]),
                    },
                    limit,
                });
            }
        }
    }
    Ok(uses)
}

/// What is known of a wave on a robot before it is executed.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// Every limit and its use.
    pub limits: Vec<LimitUse>,
    /// Whether it keeps clear of itself; not looked at when a limit is broken.
    pub collision: Option<Certification>,
}

impl Verdict {
    /// Puts a motion through limits and, if they hold, the proof that every pair stays farther apart than `margin` \[m\].
    ///
    /// # Errors
    /// Those of [`limits`] and [`CollisionModel::certify`].
    pub fn of<M: Motion>(
        robot: &Robot,
        collision: &CollisionModel,
        wave: &M,
        margin: f64,
    ) -> Result<Self> {
        let limits = limits(robot, wave)?;
        let within = limits.iter().all(|l| l.excess() == 0.0);
        let collision = if within {
            Some(collision.certify(wave, margin, &[])?)
        } else {
            None
        };
        Ok(Self { limits, collision })
    }

    /// The limits that are broken.
    pub fn broken(&self) -> impl Iterator<Item = &LimitUse> {
        self.limits.iter().filter(|l| l.excess() > 0.0)
    }

    /// Whether no limit is broken and nothing touches, for certain.
    pub fn passes(&self) -> bool {
        self.broken().next().is_none()
            && self.collision.as_ref().is_some_and(Certification::is_clear)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fourier::Wave;
    use nalgebra::{dmatrix, dvector};
    use num_complex::Complex;

    #[test]
    fn a_mimicking_joint_has_limits_of_its_own() {
        let robot = Robot::from_urdf(
            r#"<robot name="gripper"><link name="a"/><link name="b"/><link name="c"/>
            <joint name="left" type="prismatic"><parent link="a"/><child link="b"/><limit lower="-1" upper="1" velocity="9"/></joint>
            <joint name="right" type="prismatic"><parent link="a"/><child link="c"/><limit lower="-0.3" upper="0.3" velocity="9"/>
            <mimic joint="left" multiplier="-2" offset="0.1"/></joint></robot>"#,
        )
        .unwrap();
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
        let excess = |size: f64| {
            let uses = limits(&robot, &wave(size)).unwrap();
            let right = uses
                .iter()
                .find(|u| u.joint == "right" && u.quantity == Derivative::Position)
                .unwrap();
            assert_eq!(right.kind, JointKind::Prismatic);
            right.excess()
        };
        assert_eq!(excess(0.099), 0.0);
        assert!((excess(0.2) - 0.2).abs() < 1e-5);
    }
}

//! Frames, velocities and the geometric Jacobian, in a workspace that the caller holds.

use nalgebra::{Matrix6xX, Point3, Vector3};

use super::Frame;
use crate::robot::{JointKind, Link, Robot};

/// How a frame moves: in the base frame's directions, at the frame's origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Twist {
    /// Velocity of the frame's origin \[m/s\].
    pub linear: Vector3<f64>,
    /// Angular velocity \[rad/s\].
    pub angular: Vector3<f64>,
}

impl Twist {
    /// No motion.
    pub fn zero() -> Self {
        Self {
            linear: Vector3::zeros(),
            angular: Vector3::zeros(),
        }
    }

    /// The twist of the same rigid body at a point `arm` \[m\] away, in the base frame's directions.
    pub fn at(&self, arm: &Vector3<f64>) -> Self {
        Self {
            linear: self.linear + self.angular.cross(arm),
            angular: self.angular,
        }
    }
}

/// Workspace of the kinematics of one robot; nothing is allocated once it exists.
///
/// Every method takes the robot that the workspace was made for, and panics for one of another size and for slices
/// that have not one entry a joint.
///
/// ```
/// use nalgebra::DVector;
/// use undulate::{Kinematics, nalgebra, shipped};
///
/// let robot = shipped::robot("wave_arm")?;
/// let mut kinematics = Kinematics::new(&robot);
/// let palm = robot.link("palm")?;
/// let (q, v) = (robot.rest(), DVector::from_element(6, 0.1));
/// let twist = kinematics.link_twist(&robot, &q, v.as_slice(), palm);
/// let product = kinematics.link_jacobian(&robot, &q, palm) * v;
/// assert!((product.fixed_rows::<3>(0) - twist.linear).norm() < 1e-15);
/// # Ok::<(), undulate::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Kinematics {
    frames: Vec<Frame>,
    twists: Vec<Twist>,
    jacobian: Matrix6xX<f64>,
}

impl Kinematics {
    /// A workspace for `robot`.
    pub fn new(robot: &Robot) -> Self {
        Self {
            frames: vec![Frame::identity(); robot.bodies().len()],
            twists: vec![Twist::zero(); robot.bodies().len()],
            jacobian: Matrix6xX::zeros(robot.joints().len()),
        }
    }

    /// The frame of every body in the base frame at configuration `q`.
    pub fn frames(&mut self, robot: &Robot, q: &[f64]) -> &[Frame] {
        robot.body_frames_into(q, &mut self.frames);
        &self.frames
    }

    /// The frames that were asked for last, or that something else was worked out from.
    pub(in crate::robot) fn last_frames(&self) -> &[Frame] {
        &self.frames
    }

    /// The twist of every body's frame at configuration `q` and velocity `v` \[rad/s, m/s\] of each joint.
    pub fn twists(&mut self, robot: &Robot, q: &[f64], v: &[f64]) -> &[Twist] {
        self.move_bodies(robot, q, v);
        &self.twists
    }

    /// The twist of a link's frame.
    pub fn link_twist(&mut self, robot: &Robot, q: &[f64], v: &[f64], link: &Link) -> Twist {
        self.move_bodies(robot, q, v);
        let arm = self.frames[link.body].rotation * link.pose.translation.vector;
        self.twists[link.body].at(&arm)
    }

    /// Frames and twists of all bodies; both stand afterwards.
    pub(in crate::robot) fn move_bodies(
        &mut self,
        robot: &Robot,
        q: &[f64],
        v: &[f64],
    ) -> (&[Frame], &[Twist]) {
        assert_eq!(v.len(), robot.joints().len(), "one velocity a joint");
        robot.body_frames_into(q, &mut self.frames);
        for (i, step) in robot.steps.iter().enumerate().skip(1) {
            let rate = step.multiplier * v[step.index];
            let axis = self.frames[i].rotation * step.axis * rate;
            let arm = self.frames[i].origin - self.frames[step.parent].origin;
            let mut twist = self.twists[step.parent].at(&arm);
            match step.kind {
                JointKind::Revolute => twist.angular += axis,
                JointKind::Prismatic => twist.linear += axis,
            }
            self.twists[i] = twist;
        }
        (&self.frames, &self.twists)
    }

    /// The geometric Jacobian of a point fixed to body `body`, `point` \[m\] in the body's frame: 6 x joints, so that
    /// J v is the velocity of the point (rows 0 to 2, m/s) and the angular velocity of the body (rows 3 to 5, rad/s), both
    /// in the base frame's directions. Where joints mimic others, v is that of the commanded joints (Featherstone,
    /// "Rigid Body Dynamics Algorithms", 2008, section 4.3, with the linear half at the point).
    ///
    /// Panics when there is no such body.
    pub fn jacobian(
        &mut self,
        robot: &Robot,
        q: &[f64],
        body: usize,
        point: &Point3<f64>,
    ) -> &Matrix6xX<f64> {
        robot.body_frames_into(q, &mut self.frames);
        let end = self.frames[body];
        let point = end.origin + end.rotation * point.coords;
        self.jacobian.fill(0.0);
        let mut body = body;
        while body != 0 {
            let (step, frame) = (&robot.steps[body], &self.frames[body]);
            let axis = frame.rotation * step.axis * step.multiplier;
            let mut column = self.jacobian.column_mut(step.index);
            match step.kind {
                JointKind::Revolute => {
                    let mut linear = column.fixed_rows_mut::<3>(0);
                    linear += axis.cross(&(point - frame.origin));
                    let mut angular = column.fixed_rows_mut::<3>(3);
                    angular += axis;
                }
                JointKind::Prismatic => {
                    let mut linear = column.fixed_rows_mut::<3>(0);
                    linear += axis;
                }
            }
            body = step.parent;
        }
        &self.jacobian
    }

    /// [`jacobian`](Self::jacobian) of the origin of a link's frame.
    pub fn link_jacobian(&mut self, robot: &Robot, q: &[f64], link: &Link) -> &Matrix6xX<f64> {
        let origin = Point3::from(link.pose.translation.vector);
        self.jacobian(robot, q, link.body, &origin)
    }
}

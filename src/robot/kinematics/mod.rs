//! Where bodies are and how they move: forward kinematics, velocities, the Jacobian.

mod step;
mod workspace;

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};

pub use step::Frame;
pub(super) use step::Step;
pub use workspace::{Kinematics, Twist};

use super::{BodyJoint, JointKind, Robot};

impl BodyJoint {
    /// The joint's own position for a configuration: that of the joint it mimics, scaled and shifted.
    pub fn position(&self, q: &[f64]) -> f64 {
        self.multiplier * q[self.index] + self.offset
    }

    /// The body's frame in its parent's.
    pub fn pose(&self, q: &[f64]) -> Isometry3<f64> {
        let position = self.position(q);
        match self.kind {
            JointKind::Revolute => {
                let (sin, cos) = libm::sincos(position / 2.0);
                let turn = UnitQuaternion::new_unchecked(Quaternion::from_parts(
                    cos,
                    self.axis.into_inner() * sin,
                ));
                Isometry3::from_parts(self.origin.translation, self.origin.rotation * turn)
            }
            JointKind::Prismatic => {
                let shift = self.origin.rotation * (self.axis.into_inner() * position);
                Isometry3::from_parts(
                    Translation3::from(self.origin.translation.vector + shift),
                    self.origin.rotation,
                )
            }
        }
    }
}

impl Robot {
    /// The pose of every body in the base frame at configuration `q` (Featherstone, "Rigid Body Dynamics Algorithms",
    /// 2008, section 4.1: poses compose along the tree).
    ///
    /// Panics when `q` has not one entry a joint.
    pub fn body_poses(&self, q: &[f64]) -> Vec<Isometry3<f64>> {
        let mut poses = vec![Isometry3::identity(); self.bodies.len()];
        self.body_poses_into(q, &mut poses);
        poses
    }

    /// [`body_poses`](Self::body_poses) without allocation; `poses` has one entry a body.
    pub fn body_poses_into(&self, q: &[f64], poses: &mut [Isometry3<f64>]) {
        assert_eq!(q.len(), self.joints.len(), "one position a joint");
        for (i, body) in self.bodies.iter().enumerate() {
            poses[i] = match &body.joint {
                None => Isometry3::identity(),
                Some(joint) => poses[body.parent] * joint.pose(q),
            };
        }
    }

    /// The same poses as rotation matrices, which is what distances and Jacobians want; `frames` has one entry a body.
    /// Panics for another number of entries, and when `q` has not one entry a joint.
    pub fn body_frames_into(&self, q: &[f64], frames: &mut [Frame]) {
        assert_eq!(q.len(), self.joints.len(), "one position a joint");
        assert_eq!(frames.len(), self.steps.len(), "one frame a body");
        frames[0] = Frame::identity();
        for (i, step) in self.steps.iter().enumerate().skip(1) {
            frames[i] = frames[step.parent].carry(&step.frame(q));
        }
    }

    /// The pose of every link in the base frame, in the order of [`links`](Self::links).
    pub fn link_poses(&self, q: &[f64]) -> Vec<Isometry3<f64>> {
        let poses = self.body_poses(q);
        self.links
            .iter()
            .map(|link| poses[link.body] * link.pose)
            .collect()
    }
}

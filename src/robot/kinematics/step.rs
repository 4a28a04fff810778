//! A body's frame in its parent's, with all that does not depend on the configuration worked out.

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};

use crate::robot::dynamics::SpatialInertia;
use crate::robot::{Body, JointKind};

/// A frame in another: rotation matrix and origin. It takes coordinates in the one to coordinates in the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Orthonormal, to rounding.
    pub rotation: Matrix3<f64>,
    /// \[m\]
    pub origin: Vector3<f64>,
}

impl Frame {
    /// The frame itself.
    pub fn identity() -> Self {
        Self {
            rotation: Matrix3::identity(),
            origin: Vector3::zeros(),
        }
    }

    /// A frame given in this one, in the frame that this one is given in.
    #[inline]
    pub fn carry(&self, inner: &Self) -> Self {
        Self {
            rotation: self.rotation * inner.rotation,
            origin: self.origin + self.rotation * inner.origin,
        }
    }

    /// The same pose with a unit quaternion.
    pub fn to_isometry(&self) -> Isometry3<f64> {
        Isometry3::from_parts(
            Translation3::from(self.origin),
            UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(self.rotation)),
        )
    }
}

/// The joint between a body and its parent as the recursions need it: compact, and side by side in memory.
#[derive(Debug, Clone)]
pub(in crate::robot) struct Step {
    pub parent: usize,
    /// Entry of q.
    pub index: usize,
    pub kind: JointKind,
    pub multiplier: f64,
    offset: f64,
    /// In the body's frame.
    pub axis: Vector3<f64>,
    /// Rodrigues' formula with the origin's rotation multiplied in: at angle p the rotation is
    /// `fixed + sine sin p + cosine cos p`.
    fixed: Matrix3<f64>,
    sine: Matrix3<f64>,
    cosine: Matrix3<f64>,
    /// The frame's origin at position 0, and how a prismatic joint shifts it.
    origin: Vector3<f64>,
    shift: Vector3<f64>,
    /// Zero for a body without mass.
    pub inertia: SpatialInertia,
}

impl Step {
    pub fn new(body: &Body) -> Self {
        let inertia = body
            .inertial
            .as_ref()
            .map_or_else(SpatialInertia::zero, SpatialInertia::of);
        let still = Self {
            parent: body.parent,
            index: 0,
            kind: JointKind::Prismatic,
            multiplier: 0.0,
            offset: 0.0,
            axis: Vector3::zeros(),
            fixed: Matrix3::identity(),
            sine: Matrix3::zeros(),
            cosine: Matrix3::zeros(),
            origin: Vector3::zeros(),
            shift: Vector3::zeros(),
            inertia,
        };
        let Some(joint) = &body.joint else {
            return still;
        };
        let rotation = joint.origin.rotation.to_rotation_matrix().into_inner();
        let axis = joint.axis.into_inner();
        let (fixed, sine, cosine, shift) = match joint.kind {
            JointKind::Revolute => {
                let along = axis * axis.transpose();
                (
                    rotation * along,
                    rotation * axis.cross_matrix(),
                    rotation * (Matrix3::identity() - along),
                    Vector3::zeros(),
                )
            }
            JointKind::Prismatic => (rotation, still.sine, still.cosine, rotation * axis),
        };
        Self {
            index: joint.index,
            kind: joint.kind,
            multiplier: joint.multiplier,
            offset: joint.offset,
            axis,
            fixed,
            sine,
            cosine,
            origin: joint.origin.translation.vector,
            shift,
            ..still
        }
    }

    /// The body's frame in its parent's at configuration `q`. Always inlined: handed over in memory, it is waited for.
    #[inline(always)]
    pub fn frame(&self, q: &[f64]) -> Frame {
        let position = self.multiplier * q[self.index] + self.offset;
        match self.kind {
            JointKind::Revolute => {
                let (sin, cos) = libm::sincos(position);
                Frame {
                    rotation: self.fixed + self.sine * sin + self.cosine * cos,
                    origin: self.origin,
                }
            }
            JointKind::Prismatic => Frame {
                rotation: self.fixed,
                origin: self.origin + self.shift * position,
            },
        }
    }
}

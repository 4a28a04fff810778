//! Inertia of a rigid body about the origin of its frame.

use nalgebra::{Matrix3, Vector3};

use crate::robot::kinematics::{Frame, Step};
use crate::robot::{Inertial, JointKind};

/// The rigid-body inertia of Featherstone 2008, equation 2.62: mass, first and second moments about a frame's origin.
#[derive(Debug, Clone)]
pub(in crate::robot) struct SpatialInertia {
    /// \[kg\]
    pub mass: f64,
    /// Mass times centre of mass \[kg m\].
    pub moment: Vector3<f64>,
    /// About the frame's origin \[kg m^2\].
    pub inertia: Matrix3<f64>,
}

/// A force \[N\] and its moment about the origin of a frame \[N m\].
#[derive(Debug, Clone, Copy)]
pub(super) struct Wrench {
    pub force: Vector3<f64>,
    pub moment: Vector3<f64>,
}

impl Wrench {
    pub fn zero() -> Self {
        Self {
            force: Vector3::zeros(),
            moment: Vector3::zeros(),
        }
    }

    /// What of it acts along the joint of a body whose frame it is given in.
    #[inline]
    pub fn along(&self, step: &Step) -> f64 {
        match step.kind {
            JointKind::Revolute => step.axis.dot(&self.moment),
            JointKind::Prismatic => step.axis.dot(&self.force),
        }
    }

    #[inline]
    pub fn add(&mut self, other: &Self) {
        self.force += other.force;
        self.moment += other.moment;
    }

    /// The same wrench about the origin of the frame that `frame` is given in, and in its directions.
    #[inline]
    pub fn carried(&self, frame: &Frame) -> Self {
        let force = frame.rotation * self.force;
        Self {
            force,
            moment: frame.rotation * self.moment + frame.origin.cross(&force),
        }
    }
}

impl SpatialInertia {
    pub fn zero() -> Self {
        Self {
            mass: 0.0,
            moment: Vector3::zeros(),
            inertia: Matrix3::zeros(),
        }
    }

    /// By the parallel axes.
    pub fn of(inertial: &Inertial) -> Self {
        let (m, c) = (inertial.mass, inertial.center);
        Self {
            mass: m,
            moment: c * m,
            inertia: inertial.inertia + parallel(&(c * m), &c),
        }
    }

    /// What gives the body this motion: w and dw/dt of the body, acceleration of the frame's origin (Newton, Euler).
    #[inline]
    pub(super) fn wrench(
        &self,
        angular_velocity: &Vector3<f64>,
        angular_acceleration: &Vector3<f64>,
        acceleration: &Vector3<f64>,
    ) -> Wrench {
        let (w, h) = (angular_velocity, &self.moment);
        Wrench {
            force: acceleration * self.mass + angular_acceleration.cross(h) + w.cross(&w.cross(h)),
            moment: self.inertia * angular_acceleration
                + w.cross(&(self.inertia * w))
                + h.cross(acceleration),
        }
    }

    /// What gives a body at rest unit acceleration along its own joint.
    #[inline]
    pub(super) fn starting(&self, step: &Step) -> Wrench {
        match step.kind {
            JointKind::Revolute => Wrench {
                force: step.axis.cross(&self.moment),
                moment: self.inertia * step.axis,
            },
            JointKind::Prismatic => Wrench {
                force: step.axis * self.mass,
                moment: self.moment.cross(&step.axis),
            },
        }
    }

    /// The same body about the origin of the frame that `frame` is given in, and in its directions.
    #[inline]
    pub fn carried(&self, frame: &Frame) -> Self {
        let (r, rotation) = (&frame.origin, &frame.rotation);
        let turned = rotation * self.moment;
        let moment = turned + r * self.mass;
        // Points are r + x: the cross terms with r once in each of the two products.
        Self {
            mass: self.mass,
            moment,
            inertia: rotation * self.inertia * rotation.transpose()
                + parallel(&moment, r)
                + parallel(r, &turned),
        }
    }

    #[inline]
    pub fn add(&mut self, other: &Self) {
        self.mass += other.mass;
        self.moment += other.moment;
        self.inertia += other.inertia;
    }
}

/// (a . b) 1 - b a^T
#[inline]
fn parallel(a: &Vector3<f64>, b: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::from_diagonal_element(a.dot(b)) - b * a.transpose()
}

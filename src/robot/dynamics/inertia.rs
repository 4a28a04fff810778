//! Inertia of a rigid body about the origin of its frame.

use nalgebra::{Matrix3, Vector3};

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

/// A force \[N\] and its moment about a point of reference \[N m\].
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

    /// What of it acts along a joint whose axis passes through the point of reference.
    #[inline]
    pub fn along(&self, kind: JointKind, axis: &Vector3<f64>) -> f64 {
        match kind {
            JointKind::Revolute => axis.dot(&self.moment),
            JointKind::Prismatic => axis.dot(&self.force),
        }
    }

    #[inline]
    pub fn add(&mut self, other: &Self) {
        self.force += other.force;
        self.moment += other.moment;
    }

    /// The same wrench about a point from which `arm` leads to the old one.
    #[inline]
    pub fn carried(&self, arm: &Vector3<f64>) -> Self {
        Self {
            force: self.force,
            moment: self.moment + arm.cross(&self.force),
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
    pub(super) fn starting(&self, kind: JointKind, axis: &Vector3<f64>) -> Wrench {
        match kind {
            JointKind::Revolute => Wrench {
                force: axis.cross(&self.moment),
                moment: self.inertia * axis,
            },
            JointKind::Prismatic => Wrench {
                force: axis * self.mass,
                moment: self.moment.cross(axis),
            },
        }
    }

    /// The same body in the directions that `rotation` takes its own to.
    #[inline]
    pub(super) fn turned(&self, rotation: &Matrix3<f64>) -> Self {
        let half = rotation * self.inertia;
        Self {
            mass: self.mass,
            moment: rotation * self.moment,
            inertia: symmetric(|i, j| half.row(i).dot(&rotation.row(j))),
        }
    }

    /// The same body about a point from which `arm` leads to the old one.
    #[inline]
    pub(super) fn carried(&self, arm: &Vector3<f64>) -> Self {
        let (r, h) = (arm, &self.moment);
        let moment = h + r * self.mass;
        // Points are r + x: the cross terms with r once in each of the two products.
        let trace = moment.dot(r) + r.dot(h);
        let inertia = symmetric(|i, j| {
            let own = self.inertia[(i, j)] - r[i] * moment[j] - h[i] * r[j];
            if i == j { own + trace } else { own }
        });
        Self {
            mass: self.mass,
            moment,
            inertia,
        }
    }

    #[inline]
    pub fn add(&mut self, other: &Self) {
        self.mass += other.mass;
        self.moment += other.moment;
        self.inertia += other.inertia;
    }
}

/// From the entries on and above the diagonal.
#[inline]
fn symmetric(entry: impl Fn(usize, usize) -> f64) -> Matrix3<f64> {
    let [xy, xz, yz] = [entry(0, 1), entry(0, 2), entry(1, 2)];
    Matrix3::new(
        entry(0, 0),
        xy,
        xz,
        xy,
        entry(1, 1),
        yz,
        xz,
        yz,
        entry(2, 2),
    )
}

/// (a . b) 1 - b a^T
#[inline]
fn parallel(a: &Vector3<f64>, b: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::from_diagonal_element(a.dot(b)) - b * a.transpose()
}

//! Inertias that a body can have, and the nearest one to those that none can.

use nalgebra::{Matrix3, Matrix3x2, SymmetricEigen, Vector3};

use super::Inertial;

/// An inertia may be inconsistent by this share of its trace: rounding of printed digits.
const TOLERANCE: f64 = 1e-6;

/// What is wrong with an inertia.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Fault {
    /// A principal moment is negative: kinetic energy could be.
    Indefinite([f64; 3]),
    /// One principal moment is larger than the two others together: no distribution of mass has it.
    Triangle([f64; 3]),
}

impl Fault {
    /// The sentence for an error or a note.
    pub(super) fn told(&self) -> String {
        let (Self::Indefinite([a, b, c]) | Self::Triangle([a, b, c])) = self;
        let moments = format!("principal moments {a:.3e}, {b:.3e}, {c:.3e} kg m^2");
        match self {
            Self::Indefinite(_) => format!("inertia is not positive semidefinite: {moments}"),
            Self::Triangle(_) => {
                format!("{moments} violate the triangle inequality: no body has them")
            }
        }
    }
}

/// The symmetric matrix of URDF's six numbers.
pub(super) fn tensor([ixx, ixy, ixz, iyy, iyz, izz]: [f64; 6]) -> Matrix3<f64> {
    Matrix3::new(ixx, ixy, ixz, ixy, iyy, iyz, ixz, iyz, izz)
}

/// What is wrong with an inertia about the centre of mass, beyond the rounding of printed digits.
pub(super) fn fault(tensor: &Matrix3<f64>) -> Option<Fault> {
    let mut moments = SymmetricEigen::new(*tensor).eigenvalues;
    moments.as_mut_slice().sort_by(f64::total_cmp);
    let moments: [f64; 3] = moments.into();
    let tolerance = TOLERANCE * tensor.trace().abs();
    if moments[0] < -tolerance {
        Some(Fault::Indefinite(moments))
    } else if moments[2] > moments[0] + moments[1] + tolerance {
        Some(Fault::Triangle(moments))
    } else {
        None
    }
}

/// The consistent inertia nearest to `tensor` in the Frobenius norm.
///
/// Consistent are the inertias I = tr(S) 1 - S of second moments S that are positive semidefinite (Wensing, Kim and
/// Slotine, "Linear matrix inequalities for physically consistent inertial parameter identification", 2018): a set that
/// turns keep, so the nearest has the same principal axes, and its moments are the nearest of the cone A s, s >= 0 with
/// A = [0 1 1; 1 0 1; 1 1 0].
pub(super) fn mended(tensor: &Matrix3<f64>) -> Matrix3<f64> {
    let eigen = SymmetricEigen::new(*tensor);
    let moments = nearest(&eigen.eigenvalues);
    let axes = eigen.eigenvectors;
    let mended = axes * Matrix3::from_diagonal(&moments) * axes.transpose();
    (mended + mended.transpose()) / 2.0
}

/// The nearest point of the cone of moments: the nearest of those on its inside, faces, edges and tip that lie in it.
fn nearest(moments: &Vector3<f64>) -> Vector3<f64> {
    // Columns of A: the moments of mass spread along one principal axis.
    let edges = [
        Vector3::new(0.0, 1.0, 1.0),
        Vector3::new(1.0, 0.0, 1.0),
        Vector3::new(1.0, 1.0, 0.0),
    ];
    let inside = |m: &Vector3<f64>| (0..3).all(|i| m.sum() - 2.0 * m[i] >= 0.0);
    if inside(moments) {
        return *moments;
    }
    let mut best = Vector3::zeros();
    let mut consider = |point: Vector3<f64>| {
        if (point - moments).norm_squared() < (best - moments).norm_squared() {
            best = point;
        }
    };
    for (i, edge) in edges.iter().enumerate() {
        consider(edge * (edge.dot(moments) / 2.0).max(0.0));
        let face = Matrix3x2::from_columns(&[edges[(i + 1) % 3], edges[(i + 2) % 3]]);
        // Two columns of A have the Gram matrix [2 1; 1 2].
        let b = face.tr_mul(moments);
        let s = nalgebra::Vector2::new(2.0 * b.x - b.y, 2.0 * b.y - b.x) / 3.0;
        if s.min() >= 0.0 {
            consider(face * s);
        }
    }
    best
}

impl Inertial {
    /// Two bodies as one (parallel axes).
    pub(super) fn joined(&self, other: &Self) -> Self {
        let mass = self.mass + other.mass;
        let center = (self.center * self.mass + other.center * other.mass) / mass;
        let about = |part: &Self| {
            let d = part.center - center;
            part.inertia + (Matrix3::identity() * d.norm_squared() - d * d.transpose()) * part.mass
        };
        Self {
            mass,
            center,
            inertia: about(self) + about(other),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;
    use proptest::prelude::*;

    #[test]
    fn moments_are_judged_beyond_rounding() {
        let judged = |a, b, c| fault(&Matrix3::from_diagonal(&Vector3::new(a, b, c)));
        assert_eq!(judged(1.0, 2.0, 3.0), None);
        assert_eq!(judged(1.0, 1.0, -1e-7), None);
        assert!(matches!(
            judged(1.0, 1.0, -1e-5),
            Some(Fault::Indefinite(_))
        ));
        assert!(matches!(judged(1.0, 3.0, 1.0), Some(Fault::Triangle(_))));
        assert_eq!(judged(0.0, 0.0, 0.0), None);
    }

    proptest! {
        /// Of the mended inertia and random consistent ones, none is nearer; a consistent one stays as it is.
        #[test]
        fn the_mended_inertia_is_consistent_and_the_nearest(
            moments in prop::array::uniform3(-2.0..3.0f64),
            angles in prop::array::uniform3(-3.0..3.0f64),
            spreads in prop::array::uniform3(0.0..2.0f64),
            step in 0.0..1.0f64,
        ) {
            let turn = Rotation3::from_euler_angles(angles[0], angles[1], angles[2]).into_inner();
            let given = turn * Matrix3::from_diagonal(&Vector3::from(moments)) * turn.transpose();
            let mended = mended(&given);
            prop_assert_eq!(fault(&mended), None);
            if fault(&given).is_none() {
                prop_assert!((mended - given).norm() < 1e-5);
            }
            // Between the mended one and any other that is consistent, all are (the set is convex).
            let other = {
                let s = Matrix3::from_diagonal(&Vector3::from(spreads));
                Matrix3::identity() * s.trace() - s
            };
            let between = mended + (other - mended) * step;
            prop_assert!((mended - given).norm() <= (between - given).norm() + 1e-12);
        }
    }
}

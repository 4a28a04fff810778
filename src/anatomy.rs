//! The angles of a person's arm: their names, the orders of the shoulder, and the way from rotations to angles.

use nalgebra::{Matrix3, Vector3};

/// The four that place upper arm and forearm, then the three that place the hand.
///
/// Zero is the arm hanging, palm to the thigh, elbow straight. In the frame of the thorax, X left, Y up, Z forward, with R
/// about the axes of the segment before, a right arm is
///
/// ```text
/// thorax to humerus   Rx(-flexion) Rz(-abduction) Ry(rotation), or Rz(-abduction) Rx(-flexion) Ry(rotation)
/// humerus to forearm  Rx(-elbow_flexion) Rz(-carrying)
/// forearm to hand     Ry(pronation) Rz(wrist_flexion) Rx(-wrist_deviation)
/// ```
///
/// and a left arm its mirror image, so that both have the same signs. The carrying angle belongs to the arm and not to a motion.
pub const ARM_ANGLES: [&str; 7] = [
    "shoulder_flexion",
    "shoulder_abduction",
    "shoulder_rotation",
    "elbow_flexion",
    "forearm_pronation",
    "wrist_flexion",
    "wrist_deviation",
];

/// In which order the angles of the shoulder turn the humerus, each about the axes that those before it have turned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ShoulderOrder {
    /// Flexion, abduction, rotation: singular where the upper arm points sideways.
    #[default]
    Xzy,
    /// Abduction, flexion, rotation: singular where the upper arm points straight forward or back.
    Zxy,
}

impl ShoulderOrder {
    /// The other one.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Xzy => Self::Zxy,
            Self::Zxy => Self::Xzy,
        }
    }

    /// Which of the angles turns in the middle.
    pub(crate) fn middle(self) -> usize {
        match self {
            Self::Xzy => 1,
            Self::Zxy => 0,
        }
    }

    /// Flexion, abduction and rotation \[rad\] of a humerus in the thorax; the middle one in turn is within a quarter turn.
    pub(crate) fn angles(self, humerus: &Matrix3<f64>) -> [f64; 3] {
        let r = |i, j| humerus[(i, j)];
        match self {
            Self::Xzy => [
                libm::atan2(-r(2, 1), r(1, 1)),
                libm::atan2(r(0, 1), libm::hypot(r(1, 1), r(2, 1))),
                libm::atan2(r(0, 2), r(0, 0)),
            ],
            Self::Zxy => [
                libm::atan2(-r(2, 1), libm::hypot(r(0, 1), r(1, 1))),
                libm::atan2(r(0, 1), r(1, 1)),
                libm::atan2(-r(2, 0), r(2, 2)),
            ],
        }
    }

    /// The cosine of the angle in the middle: 0 where the order is singular, and the other two cannot be told apart.
    pub(crate) fn margin(self, humerus: &Matrix3<f64>) -> f64 {
        match self {
            Self::Xzy => libm::hypot(humerus[(1, 1)], humerus[(2, 1)]),
            Self::Zxy => libm::hypot(humerus[(0, 1)], humerus[(1, 1)]),
        }
    }
}

impl std::fmt::Display for ShoulderOrder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Xzy => "xzy",
            Self::Zxy => "zxy",
        })
    }
}

/// Flexion and carrying angle \[rad\] of an elbow whose forearm points so in the humerus, a unit vector.
pub(crate) fn elbow(forearm: &Vector3<f64>) -> [f64; 2] {
    [
        libm::atan2(forearm.z, -forearm.y),
        libm::atan2(-forearm.x, libm::hypot(forearm.y, forearm.z)),
    ]
}

/// Pronation, flexion and deviation \[rad\] of a hand in its forearm.
pub(crate) fn wrist(hand: &Matrix3<f64>) -> [f64; 3] {
    let r = |i, j| hand[(i, j)];
    [
        libm::atan2(-r(2, 0), r(0, 0)),
        libm::atan2(r(1, 0), libm::hypot(r(0, 0), r(2, 0))),
        libm::atan2(r(1, 2), r(1, 1)),
    ]
}

/// The rotation about X by `angle` \[rad\].
pub(crate) fn about_x(angle: f64) -> Matrix3<f64> {
    let (s, c) = libm::sincos(angle);
    Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c)
}

/// The rotation about Y by `angle` \[rad\].
pub(crate) fn about_y(angle: f64) -> Matrix3<f64> {
    let (s, c) = libm::sincos(angle);
    Matrix3::new(c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c)
}

/// The rotation about Z by `angle` \[rad\].
pub(crate) fn about_z(angle: f64) -> Matrix3<f64> {
    let (s, c) = libm::sincos(angle);
    Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0)
}

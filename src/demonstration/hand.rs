//! Where the hand is: the path along which a person waves, whatever the angles of the shoulder do near their singularity.

use nalgebra::{DMatrix, Rotation3, Vector3};

use super::Recording;
use crate::fourier::Joints;

/// Shoulder flexion, abduction, rotation; elbow flexion; these must be there. Forearm pronation, wrist flexion and
/// deviation are zero where they were not recorded.
const JOINTS: [&str; 7] = [
    "shoulder_flexion",
    "shoulder_abduction",
    "shoulder_rotation",
    "elbow_flexion",
    "forearm_pronation",
    "wrist_flexion",
    "wrist_deviation",
];
const NEEDED: usize = 4;

/// Upper arm, forearm and hand as shares of the arm, which is 1 long.
const LENGTHS: [f64; 3] = [0.41, 0.35, 0.24];

/// The columns of a person's arm, where a recording has them.
pub(super) fn columns(joints: &Joints) -> Option<[Option<usize>; 7]> {
    let columns = JOINTS.map(|name| joints.iter().position(|joint| joint == name));
    columns[..NEEDED]
        .iter()
        .all(Option::is_some)
        .then_some(columns)
}

/// The path of the fingertips in arm lengths \[N x 3\] about the shoulder, for a person's arm. Of the two orders of shoulder angles
/// in use it is the one by which the fingertips travel less: jumps near the singularity of the other make a path longer.
pub(super) fn path(recording: &Recording) -> Option<Recording> {
    let columns = columns(&recording.joints)?;
    let travelled = |path: &DMatrix<f64>| -> f64 {
        let steps = path.row_iter().zip(path.row_iter().skip(1));
        steps.map(|(a, b)| (b - a).norm()).sum()
    };
    let [first, second] = [false, true].map(|abducts_first| {
        let mut path = DMatrix::zeros(recording.times.len(), 3);
        for n in 0..recording.times.len() {
            let angles = columns.map(|d| d.map_or(0.0, |d| recording.positions[(n, d)]));
            path.row_mut(n)
                .copy_from(&fingertips(angles, abducts_first).transpose());
        }
        path
    });
    let positions = if travelled(&second) < travelled(&first) {
        second
    } else {
        first
    };
    Some(Recording {
        joints: Joints::new(["x", "y", "z"]).ok()?,
        positions,
        ..recording.clone()
    })
}

/// x to the left, y up, z forward; a right arm, hanging along -y at zero.
fn fingertips(angles: [f64; 7], abducts_first: bool) -> Vector3<f64> {
    let [
        flexion,
        abduction,
        rotation,
        elbow,
        pronation,
        wrist,
        deviation,
    ] = angles;
    let about = |axis: Vector3<f64>, angle: f64, v: Vector3<f64>| {
        Rotation3::from_scaled_axis(axis * angle) * v
    };
    let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
    let mut p = -LENGTHS[2] * y;
    p = about(x, -deviation, p);
    p = about(z, wrist, p);
    p = about(y, pronation, p);
    p -= LENGTHS[1] * y;
    p = about(x, -elbow, p);
    p -= LENGTHS[0] * y;
    p = about(y, rotation, p);
    if abducts_first {
        about(z, -abduction, about(x, -flexion, p))
    } else {
        about(x, -flexion, about(z, -abduction, p))
    }
}

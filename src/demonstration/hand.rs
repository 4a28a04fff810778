//! Where the hand is: the path along which a person waves, whatever the angles of the shoulder do near their singularity.

use std::borrow::Cow;
use std::f64::consts::FRAC_PI_2;

use nalgebra::DMatrix;

use super::Recording;
use crate::anatomy::ARM_ANGLES;
use crate::fourier::Joints;

/// The first of [`ARM_ANGLES`], of shoulder and elbow, must be there; those of the hand are zero where they were not recorded.
const NEEDED: usize = 4;

/// Upper arm, forearm and hand as shares of the arm, which is 1 long.
const LENGTHS: [f64; 3] = [0.41, 0.35, 0.24];

/// Angles in files are rounded, to tenths of a degree at worst \[rad\].
const ROUNDED: f64 = 2e-3;

/// By this factor; far from both singularities the two paths are about as long.
const CLEARLY: f64 = 0.8;

/// The columns of a person's arm, where a recording has them.
fn columns(joints: &Joints) -> Option<[Option<usize>; 7]> {
    let columns = ARM_ANGLES.map(|name| joints.iter().position(|joint| joint == name));
    let complete = columns[..NEEDED].iter().all(Option::is_some);
    complete.then_some(columns)
}

/// A person's arm in a recording.
pub(super) struct Arm {
    /// Path of the fingertips about the shoulder \[arm lengths\], N x 3.
    pub path: DMatrix<f64>,
    /// The joint whose angle turns the shoulder second: where its cosine is 0 the other two turn about one axis.
    pub second: usize,
}

/// The arm, if the joints are a person's. Its shoulder turns by flexion, abduction, rotation, or by the other order in use, abduction first.
/// The second angle in turn is within a quarter turn, the first may be beyond it, and so tells. Where neither is, or both are, it is the other
/// order if by that the fingertips travel clearly less: jumps near the singularity make the path longer by the wrong one.
pub(super) fn arm(recording: &Recording) -> Option<Arm> {
    let columns = columns(&recording.joints)?;
    let travelled = |path: &DMatrix<f64>| -> f64 {
        (1..path.nrows())
            .map(|n| (path.row(n) - path.row(n - 1)).norm())
            .sum()
    };
    let along = |abducts_first: bool| {
        let mut path = DMatrix::zeros(recording.times.len(), 3);
        for n in 0..recording.times.len() {
            let angles = columns.map(|d| d.map_or(0.0, |d| recording.positions[(n, d)]));
            for (d, p) in fingertips(angles, abducts_first).into_iter().enumerate() {
                path[(n, d)] = p;
            }
        }
        path
    };
    let [flexion, abduction] = [columns[0]?, columns[1]?];
    let is_far = |joint: usize| {
        let mut angles = recording.positions.column(joint).into_iter();
        angles.any(|angle| angle.abs() > FRAC_PI_2 + ROUNDED)
    };
    let abducts_first = match (is_far(flexion), is_far(abduction)) {
        (true, false) => false,
        (false, true) => true,
        _ => travelled(&along(true)) < CLEARLY * travelled(&along(false)),
    };
    Some(Arm {
        path: along(abducts_first),
        second: if abducts_first { flexion } else { abduction },
    })
}

/// What shows the rhythm of a recording: the path of the hand of a person's arm, else the joints.
pub(super) fn seen(recording: &Recording) -> Cow<'_, Recording> {
    seen_of(recording, arm(recording))
}

/// The same where the arm is known already.
pub(super) fn seen_of(recording: &Recording, arm: Option<Arm>) -> Cow<'_, Recording> {
    match (arm, Joints::new(["x", "y", "z"])) {
        (Some(arm), Ok(joints)) => Cow::Owned(Recording {
            name: recording.name.clone(),
            joints,
            times: recording.times.clone(),
            positions: arm.path,
        }),
        _ => Cow::Borrowed(recording),
    }
}

/// x to the left, y up, z forward; a right arm, hanging along -y at zero.
fn fingertips(angles: [f64; 7], abducts_first: bool) -> [f64; 3] {
    let [
        flexion,
        abduction,
        rotation,
        elbow,
        pronation,
        wrist,
        deviation,
    ] = angles;
    // Right-handed turns of a vector.
    let about_x = |[x, y, z]: [f64; 3], angle: f64| {
        let (s, c) = angle.sin_cos();
        [x, c * y - s * z, s * y + c * z]
    };
    let about_y = |[x, y, z]: [f64; 3], angle: f64| {
        let (s, c) = angle.sin_cos();
        [c * x + s * z, y, c * z - s * x]
    };
    let about_z = |[x, y, z]: [f64; 3], angle: f64| {
        let (s, c) = angle.sin_cos();
        [c * x - s * y, s * x + c * y, z]
    };
    let down = |[x, y, z]: [f64; 3], length: f64| [x, y - length, z];
    let hand = about_y(
        about_z(about_x(down([0.0; 3], LENGTHS[2]), -deviation), wrist),
        pronation,
    );
    let forearm = about_x(down(hand, LENGTHS[1]), -elbow);
    let arm = about_y(down(forearm, LENGTHS[0]), rotation);
    if abducts_first {
        about_z(about_x(arm, -flexion), -abduction)
    } else {
        about_x(about_z(arm, -abduction), -flexion)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Abduction may be beyond a quarter turn where it comes first, flexion where that does.
    #[test]
    fn the_angle_beyond_a_quarter_turn_comes_first() {
        for (flexion, abduction, second) in [(0.3, 1.8, 0), (2.5, 0.4, 1)] {
            let times: Vec<f64> = (0..50).map(|n| 0.02 * f64::from(n)).collect();
            let positions = DMatrix::from_fn(50, 4, |n, d| {
                let swing = 0.2 * (9.0 * times[n]).sin();
                [flexion, abduction, 0.1, 1.0][d] + if d == second { swing } else { 0.0 }
            });
            let joints = Joints::new(ARM_ANGLES[..4].iter().copied()).unwrap();
            let recording = Recording::new("arm", joints, times, positions).unwrap();
            assert_eq!(arm(&recording).unwrap().second, second);
        }
    }

    /// Forward, sideways, the forearm up; and raised by either order.
    #[test]
    fn fingertips_are_where_an_arm_holds_them() {
        let near = |angles: [f64; 7], order: bool, expected: [f64; 3]| {
            let found = fingertips(angles, order);
            let distance: f64 = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).sum();
            assert!(distance < 1e-12, "{angles:?}: {found:?}");
        };
        for order in [false, true] {
            near(
                [FRAC_PI_2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
                order,
                [0.0, 0.0, 1.0],
            );
            near(
                [0.0, FRAC_PI_2, 0.0, 0.0, 0.3, 0.0, 0.0],
                order,
                [-1.0, 0.0, 0.0],
            );
            near(
                [0.0, 0.0, 0.0, PI, 0.0, 0.0, 0.0],
                order,
                [0.0, LENGTHS[1] + LENGTHS[2] - LENGTHS[0], 0.0],
            );
        }
        near(
            [FRAC_PI_2, 0.0, 0.0, FRAC_PI_2, 0.0, 0.0, 0.0],
            true,
            [0.0, 1.0 - LENGTHS[0], LENGTHS[0]],
        );
    }
}

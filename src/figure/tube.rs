//! The path of the hand as a coloured tube.

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};

use crate::geometry::Shape;

/// Pieces of the tube between two points of the path.
const PATH_PIECES: usize = 4;

/// Colours of the path from its start to its end, evenly spaced; dark to light and free of red
/// against green, and not as pale at the end as to be lost on white.
const GRADIENT: [[f64; 3]; 6] = [
    [68.0, 1.0, 84.0],
    [65.0, 68.0, 135.0],
    [42.0, 120.0, 142.0],
    [34.0, 168.0, 132.0],
    [122.0, 209.0, 81.0],
    [240.0, 215.0, 30.0],
];

/// Capsules, with colours of 0..=255, along a smooth curve through `path`.
pub(crate) fn tube(path: &[Point3<f64>], radius: f64) -> Vec<(Shape, Isometry3<f64>, [f64; 3])> {
    let pairs = path.len().saturating_sub(1);
    let at = |index: usize| {
        path.get(index.min(pairs))
            .map_or(Vector3::zeros(), |p| p.coords)
    };
    // Catmull and Rom's spline.
    let place = |time: f64| {
        let index = (time.floor() as usize).min(pairs.saturating_sub(1));
        let t = time - index as f64;
        let (a, b, c, d) = (
            at(index.saturating_sub(1)),
            at(index),
            at(index + 1),
            at(index + 2),
        );
        b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)))
    };
    let pieces = PATH_PIECES * pairs;
    (0..pieces)
        .map(|piece| {
            let time = |piece: usize| piece as f64 / PATH_PIECES as f64;
            let (from, to) = (place(time(piece)), place(time(piece + 1)));
            let along = to - from;
            let rotation =
                UnitQuaternion::rotation_between(&Vector3::z(), &along).unwrap_or_else(|| {
                    UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
                });
            let pose = Isometry3::from_parts((0.5 * (from + to)).into(), rotation);
            let shape = Shape::Capsule {
                radius,
                length: along.norm(),
            };
            (shape, pose, gradient((piece as f64 + 0.5) / pieces as f64))
        })
        .collect()
}

fn gradient(part: f64) -> [f64; 3] {
    let place = part.clamp(0.0, 1.0) * (GRADIENT.len() - 1) as f64;
    let index = (place as usize).min(GRADIENT.len() - 2);
    let (from, to) = (GRADIENT[index], GRADIENT[index + 1]);
    std::array::from_fn(|i| from[i] + (place - index as f64) * (to[i] - from[i]))
}

//! Balls and capsules around points, found once when a shape is made.

use nalgebra::Vector3;

use super::convex::{Cylinder, perpendiculars};

/// Steps of Badoiu and Clarkson's iteration: a ball within about 1 / steps of the smallest one.
const STEPS: usize = 100;

/// How often a capsule is turned or the angle of turning halved.
const TURNS: usize = 12;

/// A ball.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ball {
    /// \[m\]
    pub center: Vector3<f64>,
    /// \[m\], rounded up.
    pub radius: f64,
}

/// All that is within `radius` of a segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundingCapsule {
    /// Ends of the segment \[m\].
    pub ends: [Vector3<f64>; 2],
    /// \[m\], rounded up.
    pub radius: f64,
}

impl Ball {
    /// `size` is that of the numbers `radius` was computed from: rounding is proportional to it.
    pub(crate) fn rounded_up(center: Vector3<f64>, radius: f64, size: f64) -> Self {
        let size = size + center.norm();
        Self {
            center,
            radius: radius + 32.0 * f64::EPSILON * size,
        }
    }

    pub(crate) fn of_points(points: &[Vector3<f64>]) -> Self {
        let center = center_of(points);
        let radius = farthest(points, &center).1;
        Self::rounded_up(center, radius, radius)
    }

    pub(crate) fn grown(self, margin: f64) -> Self {
        Self::rounded_up(self.center, self.radius + margin, margin)
    }
}

impl BoundingCapsule {
    /// Of small volume: the best of the coordinates' axes and of the longest way through the points, turned while that helps.
    pub(crate) fn of_points(points: &[Vector3<f64>]) -> Self {
        // For boxes the longest way is a diagonal, for long hulls their length.
        let first = points[farthest(points, &points[0]).0];
        let second = points[farthest(points, &first).0];
        let mut best = (Vector3::z(), Self::about(points, &Vector3::z()));
        let better = |axis: Vector3<f64>, best: &mut (Vector3<f64>, Self)| {
            let Some(axis) = axis.try_normalize(0.0) else {
                return false;
            };
            let capsule = Self::about(points, &axis);
            let is_better = capsule.volume() < best.1.volume();
            if is_better {
                *best = (axis, capsule);
            }
            is_better
        };
        for axis in [Vector3::x(), Vector3::y(), second - first] {
            better(axis, &mut best);
        }
        let mut step = 0.5;
        for _ in 0..TURNS {
            let [u, v] = perpendiculars(&best.0);
            let turned = [u, -u, v, -v].map(|side| best.0 + side * step);
            if !turned.into_iter().any(|axis| better(axis, &mut best)) {
                step /= 2.0;
            }
        }
        best.1
    }

    /// Its segment along the unit vector `axis`.
    fn about(points: &[Vector3<f64>], axis: &Vector3<f64>) -> Self {
        let across = |p: &Vector3<f64>| p - axis * axis.dot(p);
        let flat: Vec<Vector3<f64>> = points.iter().map(across).collect();
        let center = across(&center_of(&flat));
        let radius = farthest(&flat, &center).1;
        // A cap reaches over a point as far as the point is from the rim.
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for (point, flat) in points.iter().zip(&flat) {
            let along = axis.dot(point);
            let over = (radius * radius - (flat - center).norm_squared())
                .max(0.0)
                .sqrt();
            low = low.min(along + over);
            high = high.max(along - over);
        }
        if low > high {
            low = f64::midpoint(low, high);
            high = low;
        }
        let ends = [center + axis * low, center + axis * high];
        Self::around(ends, points.iter().copied())
    }

    /// The least radius about this segment, by the distances themselves.
    fn around(ends: [Vector3<f64>; 2], points: impl Iterator<Item = Vector3<f64>>) -> Self {
        let along = ends[1] - ends[0];
        let square = along.norm_squared();
        let mut size = ends[0].norm().max(ends[1].norm());
        let mut radius: f64 = 0.0;
        for point in points {
            let share = (point - ends[0]).dot(&along) / square;
            let share = if share > 0.0 { share.min(1.0) } else { 0.0 };
            radius = radius.max((point - (ends[0] + along * share)).norm());
            size = size.max(point.norm());
        }
        Self {
            ends,
            radius: radius + 32.0 * f64::EPSILON * (radius + size),
        }
    }

    pub(crate) fn of_cylinder(cylinder: &Cylinder) -> Self {
        let axis = cylinder.axes.column(2) * cylinder.half_length;
        let size = cylinder.center.norm() + cylinder.half_length;
        Self {
            ends: [cylinder.center - axis, cylinder.center + axis],
            radius: cylinder.radius + 32.0 * f64::EPSILON * (cylinder.radius + size),
        }
    }

    pub(crate) fn grown(self, margin: f64) -> Self {
        Self {
            ends: self.ends,
            radius: (self.radius + margin) * (1.0 + 2.0 * f64::EPSILON),
        }
    }

    fn volume(&self) -> f64 {
        let length = (self.ends[1] - self.ends[0]).norm();
        std::f64::consts::PI * self.radius * self.radius * (length + 4.0 / 3.0 * self.radius)
    }
}

/// Nearly the centre of the smallest ball (Badoiu and Clarkson, "Smaller core-sets for balls", 2003).
fn center_of(points: &[Vector3<f64>]) -> Vector3<f64> {
    let mut center = points.iter().sum::<Vector3<f64>>() / points.len() as f64;
    for step in 1..=STEPS {
        let (index, _) = farthest(points, &center);
        center += (points[index] - center) / (step + 1) as f64;
    }
    center
}

/// The point farthest from `from`, and how far that is.
fn farthest(points: &[Vector3<f64>], from: &Vector3<f64>) -> (usize, f64) {
    let (mut at, mut most) = (0, 0.0);
    for (i, point) in points.iter().enumerate() {
        let square = (point - from).norm_squared();
        if square > most {
            (at, most) = (i, square);
        }
    }
    (at, most.sqrt())
}

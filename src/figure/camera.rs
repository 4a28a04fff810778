//! Where things of the world are in the picture.

use nalgebra::{Isometry3, Point3, Vector3};

use crate::figure::robot_view::View;
use crate::geometry::Shape;

/// Nearer than this nothing is seen, m.
pub(crate) const NEAR: f64 = 1e-3;

/// Half the thickness of what has none, m.
pub(crate) const SHEET: f64 = 5e-4;

/// A camera: the ray of a place in the picture is `eye + t * direction`, with the depth `t` in
/// metres along the optical axis.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Camera {
    pub(crate) eye: Point3<f64>,
    /// Unit vectors of the camera: to the right, up and forward.
    pub(crate) right: Vector3<f64>,
    pub(crate) up: Vector3<f64>,
    pub(crate) forward: Vector3<f64>,
    /// Half of the picture in samples.
    pub(crate) centre: (f64, f64),
    /// Samples per unit of the tangent of the view angle.
    pub(crate) focal: f64,
}

impl Camera {
    /// The camera of a view, for a picture of (width, height) samples.
    pub(crate) fn new(view: &View, (width, height): (usize, usize)) -> Self {
        let forward = (view.target - view.eye).normalize();
        // Seen from straight above or below, the vertical gives no upward direction.
        let vertical = if forward.xy().norm() > 1e-6 {
            Vector3::z()
        } else {
            Vector3::y()
        };
        let right = forward.cross(&vertical).normalize();
        let centre = (0.5 * width as f64, 0.5 * height as f64);
        let focal = centre.1 / (0.5 * view.field_of_view).tan();
        Self {
            eye: view.eye,
            right,
            up: right.cross(&forward),
            forward,
            centre,
            focal,
        }
    }

    /// Direction of the ray through the middle of the sample (column, row).
    pub(crate) fn direction(&self, column: usize, row: usize) -> Vector3<f64> {
        let x = (column as f64 + 0.5 - self.centre.0) / self.focal;
        let y = (self.centre.1 - row as f64 - 0.5) / self.focal;
        self.forward + x * self.right + y * self.up
    }

    /// Sample (column, row) at which a point is seen, if it is in front of the eye.
    fn projected(&self, point: &Point3<f64>) -> Option<(f64, f64)> {
        let offset = point - self.eye;
        let depth = offset.dot(&self.forward);
        (depth > NEAR).then(|| {
            let scale = self.focal / depth;
            (
                self.centre.0 + scale * offset.dot(&self.right),
                self.centre.1 - scale * offset.dot(&self.up),
            )
        })
    }

    /// Samples that may see `shape` at `pose`, in a picture of `size` samples: (first, one past
    /// the last) column, then row.
    pub(crate) fn span(
        &self,
        shape: &Shape,
        pose: &Isometry3<f64>,
        size: (usize, usize),
    ) -> ((usize, usize), (usize, usize)) {
        let mut low = (f64::INFINITY, f64::INFINITY);
        let mut high = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        let mut whole = false;
        for corner in corners(shape, pose) {
            match self.projected(&corner) {
                Some((x, y)) => {
                    low = (low.0.min(x), low.1.min(y));
                    high = (high.0.max(x), high.1.max(y));
                }
                // A box that reaches behind the eye has no rectangle.
                None => whole = true,
            }
        }
        let span = |low: f64, high: f64, size: usize| {
            if whole {
                return (0, size);
            }
            // Conversion of a float to an integer saturates, which is the clipping wanted.
            (
                (low.floor() as usize).min(size),
                (high.ceil() as usize).min(size),
            )
        };
        (span(low.0, high.0, size.0), span(low.1, high.1, size.1))
    }
}

/// Middle and half of the edges of the box around a shape in its own frame, m.
pub(crate) fn box_around(shape: &Shape) -> (Vector3<f64>, Vector3<f64>) {
    let half = match shape {
        Shape::Box { half_extents } => *half_extents,
        Shape::Sphere { radius } => Vector3::repeat(*radius),
        Shape::Cylinder { radius, length } => Vector3::new(*radius, *radius, 0.5 * length),
        Shape::Capsule { radius, length } => Vector3::new(*radius, *radius, 0.5 * length + radius),
        Shape::Hull(hull) => {
            let corners = || hull.vertices().iter().map(|v| v.coords);
            let low = corners().fold(Vector3::repeat(f64::INFINITY), |a, b| a.inf(&b));
            let high = corners().fold(Vector3::repeat(f64::NEG_INFINITY), |a, b| a.sup(&b));
            // Flat ones are drawn as sheets.
            let half = (0.5 * (high - low)).sup(&Vector3::repeat(SHEET));
            return (0.5 * (low + high), half);
        }
    };
    (Vector3::zeros(), half)
}

/// The corners of the box around a placed shape, in the frame of `pose`'s parent.
pub(crate) fn corners(shape: &Shape, pose: &Isometry3<f64>) -> [Point3<f64>; 8] {
    let (middle, half) = box_around(shape);
    std::array::from_fn(|index| {
        let sign = |bit: usize| if index >> bit & 1 == 0 { -1.0 } else { 1.0 };
        let corner = Vector3::new(sign(0), sign(1), sign(2)).component_mul(&half);
        pose * Point3::from(middle + corner)
    })
}

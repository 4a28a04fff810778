//! Where rays meet shapes.

use nalgebra::{Isometry3, Vector3};

use crate::figure::camera::{Camera, NEAR, SHEET};
use crate::geometry::Shape;

/// What a ray may meet.
#[derive(Debug, Clone)]
enum Form {
    /// Any but a hull.
    Primitive(Shape),
    /// {x : n . x <= d} for all (n, d).
    HalfSpaces(Vec<(Vector3<f64>, f64)>),
}

impl Form {
    fn new(shape: &Shape) -> Self {
        match shape {
            Shape::Hull(hull) => {
                let mut planes = hull.planes();
                if hull.is_flat() {
                    planes.iter_mut().for_each(|(_, d)| *d += SHEET);
                }
                Self::HalfSpaces(planes)
            }
            primitive => Self::Primitive(primitive.clone()),
        }
    }
}

/// A shape as the camera sees it.
#[derive(Debug, Clone)]
pub(crate) struct Target {
    form: Form,
    /// Axes of the shape's frame in the world. Not a matrix, whose general product takes most
    /// of the time of a picture.
    axes: [Vector3<f64>; 3],
    /// The eye in the shape's frame, m.
    eye: Vector3<f64>,
    /// Samples that may see the shape: (first, one past the last) column, then row.
    pub(crate) columns: (usize, usize),
    pub(crate) rows: (usize, usize),
}

impl Target {
    /// `shape` at `pose` in the world, for a picture of `size` samples.
    pub(crate) fn new(
        shape: &Shape,
        pose: &Isometry3<f64>,
        camera: &Camera,
        size: (usize, usize),
    ) -> Self {
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| pose.rotation * axis);
        let eye = pose.inverse_transform_point(&camera.eye).coords;
        let (columns, rows) = camera.span(shape, pose, size);
        Self {
            form: Form::new(shape),
            axes,
            eye,
            columns,
            rows,
        }
    }

    /// A ray's direction in the frame of the shape.
    pub(crate) fn local(&self, direction: &Vector3<f64>) -> Vector3<f64> {
        let [x, y, z] = &self.axes;
        Vector3::new(x.dot(direction), y.dot(direction), z.dot(direction))
    }

    /// Depth at which a ray with the local `direction` enters the shape; infinite if never.
    pub(crate) fn depth(&self, direction: &Vector3<f64>) -> f64 {
        let (eye, d) = (&self.eye, direction);
        let depth = match &self.form {
            Form::Primitive(shape) => match shape {
                Shape::Box { half_extents } => enter_box(eye, d, half_extents),
                Shape::Sphere { radius } => enter_ball(eye, d, *radius),
                Shape::Cylinder { radius, length } => enter_cylinder(eye, d, *radius, 0.5 * length),
                Shape::Capsule { radius, length } => enter_capsule(eye, d, *radius, 0.5 * length),
                Shape::Hull(_) => f64::INFINITY,
            },
            Form::HalfSpaces(planes) => enter_all(eye, d, planes),
        };
        // Comparisons with NaN are false.
        if depth > NEAR { depth } else { f64::INFINITY }
    }

    /// Outward normal in the world where a ray with the local `direction` is at `depth`, on
    /// the surface.
    pub(crate) fn normal(&self, direction: &Vector3<f64>, depth: f64) -> Vector3<f64> {
        let point = self.eye + depth * direction;
        let normal = match &self.form {
            Form::Primitive(shape) => primitive_normal(shape, &point),
            Form::HalfSpaces(planes) => {
                let over = |(n, d): &(Vector3<f64>, f64)| n.dot(&point) - d;
                let face = planes.iter().max_by(|p, q| over(p).total_cmp(&over(q)));
                face.map_or(Vector3::zeros(), |(n, _)| *n)
            }
        };
        let [x, y, z] = &self.axes;
        normal.x * x + normal.y * y + normal.z * z
    }
}

fn primitive_normal(shape: &Shape, point: &Vector3<f64>) -> Vector3<f64> {
    match *shape {
        Shape::Box { half_extents } => box_normal(point, &half_extents),
        Shape::Sphere { radius } => point / radius,
        Shape::Cylinder { radius, length } => {
            if point.xy().norm() / radius > point.z.abs() / (0.5 * length) {
                Vector3::new(point.x, point.y, 0.0) / radius
            } else {
                Vector3::new(0.0, 0.0, point.z.signum())
            }
        }
        Shape::Capsule { radius, length } => {
            let half = 0.5 * length;
            let along = point.z.clamp(-half, half);
            Vector3::new(point.x, point.y, point.z - along) / radius
        }
        Shape::Hull(_) => Vector3::zeros(),
    }
}

fn enter_ball(eye: &Vector3<f64>, d: &Vector3<f64>, radius: f64) -> f64 {
    let (a, b, c) = (
        d.norm_squared(),
        eye.dot(d),
        eye.norm_squared() - radius * radius,
    );
    let discriminant = b * b - a * c;
    if discriminant < 0.0 {
        f64::INFINITY
    } else {
        (-b - discriminant.sqrt()) / a
    }
}

/// Where a ray enters the endless cylinder along z: minus infinity if it is within it all
/// along.
fn enter_pipe(eye: &Vector3<f64>, d: &Vector3<f64>, radius: f64) -> f64 {
    let a = d.x * d.x + d.y * d.y;
    let b = eye.x * d.x + eye.y * d.y;
    let c = eye.x * eye.x + eye.y * eye.y - radius * radius;
    let discriminant = b * b - a * c;
    if discriminant < 0.0 || (a == 0.0 && c > 0.0) {
        f64::INFINITY
    } else if a == 0.0 {
        f64::NEG_INFINITY
    } else {
        (-b - discriminant.sqrt()) / a
    }
}

/// Height along z of a ray at `depth`, which may be minus infinity.
fn height(eye: &Vector3<f64>, d: &Vector3<f64>, depth: f64) -> f64 {
    if depth.is_finite() {
        eye.z + depth * d.z
    } else {
        -d.z.signum() * f64::INFINITY
    }
}

fn enter_cylinder(eye: &Vector3<f64>, d: &Vector3<f64>, radius: f64, half: f64) -> f64 {
    let side = enter_pipe(eye, d, radius);
    let z = height(eye, d, side);
    if side == f64::INFINITY || z.abs() <= half {
        return side;
    }
    // The ray is above or below when it enters the pipe, so it can come only through that end.
    let end = (z.signum() * half - eye.z) / d.z;
    let (x, y) = (eye.x + end * d.x, eye.y + end * d.y);
    if end >= side && x * x + y * y <= radius * radius {
        end
    } else {
        f64::INFINITY
    }
}

fn enter_capsule(eye: &Vector3<f64>, d: &Vector3<f64>, radius: f64, half: f64) -> f64 {
    let side = enter_pipe(eye, d, radius);
    let z = height(eye, d, side);
    if side == f64::INFINITY || z.abs() <= half {
        return side;
    }
    // As with the cylinder, only one end is left, and it is a ball.
    enter_ball(
        &Vector3::new(eye.x, eye.y, eye.z - z.signum() * half),
        d,
        radius,
    )
}

fn enter_box(eye: &Vector3<f64>, d: &Vector3<f64>, half: &Vector3<f64>) -> f64 {
    let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        if d[axis] == 0.0 {
            if eye[axis].abs() > half[axis] {
                return f64::INFINITY;
            }
            continue;
        }
        let middle = -eye[axis] / d[axis];
        let spread = half[axis] / d[axis].abs();
        enter = enter.max(middle - spread);
        leave = leave.min(middle + spread);
    }
    if enter > leave { f64::INFINITY } else { enter }
}

/// Without half-spaces there is nothing to enter.
fn enter_all(eye: &Vector3<f64>, d: &Vector3<f64>, planes: &[(Vector3<f64>, f64)]) -> f64 {
    let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
    for (n, distance) in planes {
        let (speed, gap) = (n.dot(d), distance - n.dot(eye));
        if speed < 0.0 {
            enter = enter.max(gap / speed);
        } else if speed > 0.0 {
            leave = leave.min(gap / speed);
        } else if gap < 0.0 {
            return f64::INFINITY;
        }
        if enter > leave {
            return f64::INFINITY;
        }
    }
    enter
}

/// Part of a box's smallest half extent over which its edges look rounded.
const BEVEL: f64 = 0.3;

/// Normals that turn towards the neighbouring faces catch the light as real, slightly rounded
/// edges do; sharp ones look like paper.
fn box_normal(point: &Vector3<f64>, half: &Vector3<f64>) -> Vector3<f64> {
    let face = point.component_div(half).iamax();
    let bevel = BEVEL * half.min();
    let mut normal = Vector3::zeros();
    for axis in 0..3 {
        let beyond = ((point[axis].abs() - half[axis] + bevel) / bevel).max(0.0);
        let turned = if axis == face {
            1.0
        } else {
            0.6 * beyond * beyond
        };
        normal[axis] = turned * point[axis].signum();
    }
    normal.normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Hull;

    /// Whether a point in the shape's frame is inside it.
    fn inside(shape: &Shape, p: &Vector3<f64>) -> bool {
        match *shape {
            Shape::Box { half_extents } => (0..3).all(|axis| p[axis].abs() <= half_extents[axis]),
            Shape::Sphere { radius } => p.norm() <= radius,
            Shape::Cylinder { radius, length } => {
                p.xy().norm() <= radius && p.z.abs() <= 0.5 * length
            }
            Shape::Capsule { radius, length } => {
                let along = p.z.clamp(-0.5 * length, 0.5 * length);
                (p - Vector3::new(0.0, 0.0, along)).norm() <= radius
            }
            // The one below: an octahedron.
            Shape::Hull(_) => p.abs().sum() <= 0.6,
        }
    }

    fn octahedron() -> Shape {
        let corners =
            (0..6).map(|i| Vector3::ith(i / 2, if i % 2 == 0 { 0.6 } else { -0.6 }).into());
        Hull::new(&corners.collect::<Vec<_>>()).unwrap().into()
    }

    #[test]
    fn rays_enter_where_marching_along_them_does() {
        let shapes = [
            Shape::Box {
                half_extents: Vector3::new(0.2, 0.5, 0.3),
            },
            Shape::Sphere { radius: 0.4 },
            Shape::Cylinder {
                radius: 0.3,
                length: 0.7,
            },
            Shape::Capsule {
                radius: 0.25,
                length: 0.5,
            },
            octahedron(),
        ];
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let mut hits = 0;
        for shape in shapes {
            for turn in 0..40 {
                let (a, b) = (0.37 * f64::from(turn), 0.61 * f64::from(turn));
                let eye = 2.0 * Vector3::new(a.cos() * b.sin(), a.sin() * b.sin(), b.cos());
                for aim in 0..40 {
                    let (c, e) = (0.71 * f64::from(aim), 0.016 * f64::from(aim));
                    let direction = e * Vector3::new(c.cos(), c.sin(), (1.3 * c).sin()) - eye;
                    let target = Target {
                        form: Form::new(&shape),
                        axes,
                        eye,
                        columns: (0, 1),
                        rows: (0, 1),
                    };
                    let depth = target.depth(&direction);
                    let marched = (0..4000)
                        .map(|step| f64::from(step) * 5e-4)
                        .find(|t| inside(&shape, &(eye + *t * direction)));
                    match marched {
                        Some(t) => {
                            assert!((0.0..1e-3).contains(&(t - depth)), "{shape:?} {t} {depth}");
                            let normal = target.normal(&direction, depth);
                            assert!((normal.norm() - 1.0).abs() < 1e-6);
                            assert!(normal.dot(&direction) < 0.3 * direction.norm());
                            hits += 1;
                        }
                        None if depth.is_finite() => {
                            // A graze shorter than the march's step.
                            let after = eye + (depth + 1e-3) * direction;
                            assert!(!inside(&shape, &after), "{shape:?} {depth}");
                        }
                        None => {}
                    }
                }
            }
        }
        assert!(hits > 3000, "{hits}");
    }

    #[test]
    fn a_ray_along_the_axis_meets_the_end() {
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let eye = Vector3::new(0.0, 0.0, 3.0);
        let shapes = [
            (
                Shape::Cylinder {
                    radius: 0.3,
                    length: 1.0,
                },
                2.5,
            ),
            (
                Shape::Capsule {
                    radius: 0.3,
                    length: 1.0,
                },
                2.2,
            ),
        ];
        for (shape, depth) in shapes {
            let target = Target {
                form: Form::new(&shape),
                axes,
                eye,
                columns: (0, 1),
                rows: (0, 1),
            };
            assert!((target.depth(&-Vector3::z()) - depth).abs() < 1e-12);
            assert_eq!(target.depth(&Vector3::z()), f64::INFINITY);
            assert!((target.normal(&-Vector3::z(), depth) - Vector3::z()).norm() < 1e-12);
        }
    }
}

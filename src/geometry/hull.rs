//! Convex hulls.

mod flat;
mod orientation;
mod planes;
mod quickhull;
mod surface;

use nalgebra::Point3;

use self::flat::Span;
use self::orientation::LEAST;
use self::quickhull::Quickhull;
use self::surface::{compact, is_closed, is_convex, used};
pub(super) use self::surface::{is_paired, volume};
use super::bounds::{Ball, Capsule};
use crate::error::{Error, ErrorKind, Result};

/// Coordinates beyond this \[m\] belong to no robot: millimetres taken for metres, or damage.
pub const FARTHEST: f64 = 1e6;

/// The convex hull of points: a solid with flat faces.
///
/// Its corners are some of the points, as they were given, and it is computed with exact signs: every point lies in the
/// convex hull of [`vertices`](Self::vertices) without any tolerance, whatever the rounding, and no vertex can be spared.
/// Faces are triangles, counterclockwise from outside, closed and convex (both checked): each edge between two faces,
/// V - E + F = 2. Vertices and faces do not depend on the order of the points.
///
/// Points in one plane make a flat hull, that is a polygon with two sides; points on one line a segment, and equal points
/// a point, both without faces. Flat hulls collide like others, since a support function asks for vertices only; their
/// volume is 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Hull {
    vertices: Vec<Point3<f64>>,
    faces: Vec<[u32; 3]>,
    flat: bool,
    tolerance: f64,
    volume: f64,
    ball: Ball,
    capsule: Capsule,
}

impl Hull {
    /// The convex hull of `points` \[m\].
    ///
    /// # Errors
    /// No points, coordinates that are not finite or beyond 1e6 m, or points that would take too long
    /// (hundreds of thousands of corners, placed for it).
    pub fn new(points: &[Point3<f64>]) -> Result<Self> {
        Self::within(points, 0.0)
    }

    /// As [`new`](Self::new), of points that are `tolerance` \[m\] off what is to be enclosed.
    pub(super) fn within(points: &[Point3<f64>], tolerance: f64) -> Result<Self> {
        let mut tolerance = tolerance;
        let mut clean = Vec::with_capacity(points.len());
        for (i, point) in points.iter().enumerate() {
            if !point.iter().all(|x| x.abs() <= FARTHEST) {
                return Err(out_of_range(point).at(format!("point {}", i + 1)));
            }
            clean.push(point.map(seen));
        }
        if clean != points {
            tolerance += 2.0 * LEAST;
        }
        let (vertices, faces, flat) = enclose(clean)?;
        if !(is_closed(vertices.len(), &faces) && is_convex(&vertices, &faces)) {
            return Err(quickhull::torn());
        }
        Ok(Self {
            flat,
            tolerance,
            volume: if flat { 0.0 } else { volume(&vertices, &faces) },
            ball: Ball::around(&vertices),
            capsule: Capsule::around(&vertices),
            vertices,
            faces,
        })
    }

    /// The corners \[m\], none of them in the hull of the others.
    pub fn vertices(&self) -> &[Point3<f64>] {
        &self.vertices
    }

    /// Triangles of indices into the vertices, counterclockwise from outside; none for a segment and a point.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// Whether it has no volume: a polygon, a segment or a point.
    pub fn is_flat(&self) -> bool {
        self.flat
    }

    /// \[m^3\]; 0 when flat.
    pub fn volume(&self) -> f64 {
        self.volume
    }

    /// The largest distance \[m\] by which what the hull was made for may stick out of it: 0 for the hull of points and of
    /// meshes (but for coordinates below 1e-30 m, which are taken for 0), the rounding of cuts for the parts of a
    /// decomposition. Whoever proves a distance subtracts it.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Centre and radius \[m\] of a ball around all vertices: the smallest but for rounding, which is outward.
    pub fn bounding_sphere(&self) -> (Point3<f64>, f64) {
        (self.ball.centre, self.ball.radius)
    }

    /// Ends of the axis and radius \[m\] of a capsule around all vertices: small, not the smallest; rounded outward.
    pub fn bounding_capsule(&self) -> (Point3<f64>, Point3<f64>, f64) {
        let Capsule {
            ends: [a, b],
            radius,
        } = self.capsule;
        (a, b, radius)
    }

    /// The largest distance \[m\] of a vertex from the origin, rounded outward.
    pub fn radius(&self) -> f64 {
        Ball::about(Point3::origin(), &self.vertices).radius
    }
}

/// What exact signs can take; never -0, which would make another corner.
fn seen(x: f64) -> f64 {
    if x.abs() < LEAST { 0.0 } else { x }
}

/// Corners, faces, and whether they are flat.
type Surface = (Vec<Point3<f64>>, Vec<[u32; 3]>, bool);

/// Corners, faces and whether the hull is flat, of points with coordinates in range.
fn enclose(mut points: Vec<Point3<f64>>) -> Result<Surface> {
    points.sort_unstable_by(|p, q| {
        let [x, y, z] = [0, 1, 2].map(|axis| p[axis].total_cmp(&q[axis]));
        x.then(y).then(z)
    });
    points.dedup();
    if points.is_empty() {
        return Err(Error::new(ErrorKind::Shape, "a hull of no points").expected("at least one"));
    }
    if u32::try_from(points.len()).is_err() {
        return Err(Error::new(ErrorKind::Infeasible, "more than 2^32 points"));
    }
    loop {
        match flat::span(&points) {
            Span::Flat(corners) => {
                let faces = flat::two_sided(corners.len() as u32);
                let vertices = corners.iter().map(|i| points[*i as usize]).collect();
                return Ok((vertices, faces, true));
            }
            Span::Body(simplex) => {
                let hull = Quickhull::new(&points, simplex)?;
                let corners = hull.corners();
                let faces = hull.facets();
                let used = used(&faces, points.len());
                if used == corners {
                    let (vertices, faces) = compact(&points, &used, faces);
                    return Ok((vertices, faces, false));
                }
                // What lies between corners goes, and the few that are left are done again: all are corners then.
                let mut keep = corners.iter();
                points.retain(|_| keep.next() == Some(&true));
            }
        }
    }
}

/// The volume \[m^3\] of the hull of points with coordinates in range.
pub(super) fn hull_volume(mut points: Vec<Point3<f64>>) -> Result<f64> {
    points.iter_mut().for_each(|p| *p = p.map(seen));
    let (vertices, faces, flat) = enclose(points)?;
    Ok(if flat { 0.0 } else { volume(&vertices, &faces) })
}

/// A point with a coordinate that cannot be.
pub(super) fn out_of_range(point: &Point3<f64>) -> Error {
    Error::new(
        ErrorKind::Value,
        format!("a point at {}, {}, {} m", point.x, point.y, point.z),
    )
    .expected(format!("finite coordinates up to {FARTHEST} m"))
}

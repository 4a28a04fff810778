//! How much larger hulls are than the mesh they enclose.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use nalgebra::{Point3, Vector3};

use super::hull::Hull;
use super::mesh::Mesh;

/// Distances from points to triangles that are computed at most for one enclosure: below a second.
const MOST_DISTANCES: usize = 20_000_000;

/// The bounds of the largest gap are brought together to this part of it.
const ACCURACY: f64 = 0.05;

/// And to this part of the size of the hulls.
const NEGLIGIBLE: f64 = 1e-4;

/// The error of hulls as an enclosure of a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Enclosure {
    /// The volumes of the hulls, summed, over that of the mesh; at least 1 for one hull. `None` when the mesh is not closed or
    /// inside out, and so has no volume.
    pub volume_ratio: Option<f64>,
    /// A lower and an upper bound of the largest distance \[m\] from the surface of the hulls to the nearest triangle: both
    /// proven to rounding; the lower is the gap at a point that was found. Surface of one hull within another does not count.
    /// The bounds are within 5 %, or 1e-4 of the radius of the hulls, where a second's work brings them there; large meshes
    /// leave them farther apart.
    pub largest_gap: (f64, f64),
}

impl Mesh {
    /// How closely `hulls`, made of this mesh, enclose it.
    pub fn enclosure(&self, hulls: &[Hull]) -> Enclosure {
        let volume = self.signed_volume();
        let hull_volume: f64 = hulls.iter().map(Hull::volume).sum();
        Enclosure {
            volume_ratio: (self.is_closed() && volume > 0.0).then(|| hull_volume / volume),
            largest_gap: self.largest_gap(hulls),
        }
    }

    /// Branch and bound over the faces.
    fn largest_gap(&self, hulls: &[Hull]) -> (f64, f64) {
        let triangles: Vec<Triangle> = self
            .triangles()
            .iter()
            .map(|t| Triangle::new(t.map(|i| self.vertices()[i as usize])))
            .collect();
        let planes: Vec<_> = hulls.iter().map(Hull::planes).collect();
        // Inside another hull, or on a cut that it shares.
        let covered = |own: usize, corners: &[Point3<f64>; 3]| {
            planes.iter().enumerate().any(|(other, planes)| {
                let below =
                    |(n, d): &(Vector3<f64>, f64)| corners.iter().all(|p| n.dot(&p.coords) <= *d);
                other != own && !hulls[other].is_flat() && planes.iter().all(below)
            })
        };
        // Corners are points of the mesh, and no point of a triangle is farther from all of them than its longest side is long.
        let mut open: BinaryHeap<Patch> = BinaryHeap::new();
        for (own, hull) in hulls.iter().enumerate() {
            for face in hull.faces() {
                let corners = face.map(|i| hull.vertices()[i as usize]);
                let bound = farthest(&corners[0], &corners).max((corners[2] - corners[1]).norm());
                open.push(Patch {
                    bound,
                    own,
                    corners,
                });
            }
        }
        let near = NEGLIGIBLE
            * hulls
                .iter()
                .map(|h| h.bounding_sphere().1)
                .fold(0.0, f64::max);
        let mut budget = MOST_DISTANCES / triangles.len().max(1);
        let mut lower = 0.0_f64;
        while let Some(patch) = open.pop() {
            if patch.bound <= lower * (1.0 + ACCURACY) + near || budget == 0 {
                return (lower, patch.bound.max(lower));
            }
            budget -= 1;
            if covered(patch.own, &patch.corners) {
                continue;
            }
            let [a, b, c] = patch.corners.map(|p| p.coords);
            let middle = Point3::from((a + b + c) / 3.0);
            let (nearest, gap) = nearest(&triangles, &middle);
            if !covered(patch.own, &[middle; 3]) {
                lower = lower.max(gap);
            }
            // The distance to one triangle is convex, and the distance to all grows no faster than one goes.
            let to_one = patch.corners.map(|p| nearest.distance(&p));
            let to_one = to_one.into_iter().fold(0.0, f64::max);
            let to_all = gap + farthest(&middle, &patch.corners);
            let bound = patch.bound.min(to_one).min(to_all);
            open.extend(patch.halves().map(|corners| Patch {
                bound,
                corners,
                ..patch
            }));
        }
        (lower, lower)
    }
}

fn farthest(from: &Point3<f64>, points: &[Point3<f64>; 3]) -> f64 {
    points.iter().map(|p| (p - from).norm()).fold(0.0, f64::max)
}

/// A piece of a face; the one whose gap may be largest is looked at first.
struct Patch {
    bound: f64,
    own: usize,
    corners: [Point3<f64>; 3],
}

impl Patch {
    /// Cut across its longest side.
    fn halves(&self) -> [[Point3<f64>; 3]; 2] {
        let side = |i: usize| (self.corners[(i + 1) % 3] - self.corners[i]).norm_squared();
        let longest = (0..3)
            .max_by(|i, j| side(*i).total_cmp(&side(*j)))
            .unwrap_or(0);
        let [a, b, c] = [0, 1, 2].map(|i| self.corners[(longest + i) % 3]);
        let middle = nalgebra::center(&a, &b);
        [[a, middle, c], [middle, b, c]]
    }
}

impl Ord for Patch {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

impl PartialOrd for Patch {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Patch {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Patch {}

struct Triangle {
    corners: [Point3<f64>; 3],
    middle: Point3<f64>,
    /// Of a ball about the middle.
    radius: f64,
}

impl Triangle {
    fn new(corners: [Point3<f64>; 3]) -> Self {
        let [a, b, c] = corners;
        let middle = Point3::from((a.coords + b.coords + c.coords) / 3.0);
        let radius = farthest(&middle, &corners);
        Self {
            corners,
            middle,
            radius,
        }
    }

    /// To the nearest point, found as Ericson does ("Real-Time Collision Detection", 2005, 5.1.5), but for a triangle without
    /// area, whose sides are enough.
    fn distance(&self, p: &Point3<f64>) -> f64 {
        let [a, b, c] = &self.corners;
        let sides = side(a, b, p).min(side(b, c, p)).min(side(c, a, p));
        let (u, v, w) = (b - a, c - a, p - a);
        let normal = u.cross(&v);
        let area = normal.norm_squared();
        // Barycentric coordinates of the foot in the plane.
        let s = w.cross(&v).dot(&normal) / area;
        let t = u.cross(&w).dot(&normal) / area;
        if s >= 0.0 && t >= 0.0 && s + t <= 1.0 {
            (w - s * u - t * v).norm().min(sides)
        } else {
            sides
        }
    }
}

/// From p to a segment.
fn side(a: &Point3<f64>, b: &Point3<f64>, p: &Point3<f64>) -> f64 {
    let (along, to) = (b - a, p - a);
    let square = along.norm_squared();
    let t = if square > 0.0 {
        (to.dot(&along) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (to - t * along).norm()
}

/// The triangle nearest to `p`, and its distance.
fn nearest<'a>(triangles: &'a [Triangle], p: &Point3<f64>) -> (&'a Triangle, f64) {
    let mut best = (&triangles[0], triangles[0].distance(p));
    for triangle in &triangles[1..] {
        let reach = best.1 + triangle.radius;
        if (triangle.middle - p).norm_squared() > reach * reach {
            continue;
        }
        let distance = triangle.distance(p);
        if distance < best.1 {
            best = (triangle, distance);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::stream;

    /// Points along a side of a triangle that is looked at point by point.
    const STEPS: usize = 100;

    #[test]
    fn the_distance_to_a_triangle_is_that_to_its_nearest_point() {
        let mut rng = stream(5, 0);
        for _ in 0..300 {
            let mut point = |size: f64| {
                Point3::from(Vector3::from_fn(|_, _| size * (rng.random::<f64>() - 0.5)))
            };
            let corners = [point(1.0), point(1.0), point(1.0)];
            let p = point(3.0);
            let found = Triangle::new(corners).distance(&p);
            let [a, b, c] = &corners;
            let (u, v) = ((b - a) / STEPS as f64, (c - a) / STEPS as f64);
            let nearest = (0..=STEPS)
                .flat_map(|i| (0..=STEPS - i).map(move |j| (i as f64, j as f64)))
                .map(|(i, j)| (a + u * i + v * j - p).norm())
                .fold(f64::INFINITY, f64::min);
            assert!(found <= nearest + 1e-12, "{found}, {nearest}");
            assert!(nearest <= found + u.norm() + v.norm(), "{found}, {nearest}");
        }
    }
}

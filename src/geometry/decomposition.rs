//! Meshes as several convex hulls, which fit closer than one.

mod section;

use nalgebra::Point3;

use super::hull::{Hull, hull_volume};
use super::mesh::Mesh;
use crate::error::{Error, ErrorKind, Result};

/// What rounding moves the ends of a cut by, at most, relative to the largest coordinate: the quotient, the product and the sum
/// are rounded once each, in three coordinates.
const CUT_ROUNDING: f64 = 16.0 * f64::EPSILON;

/// The most points that hulls are made of in one decomposition, all trials together: less than a minute.
const MOST_POINTS: usize = 200_000_000;

/// How far a mesh is to be taken apart.
///
/// The mesh is cut by planes across its axes, again and again the piece and the plane that save most volume. Each
/// triangle goes, cut where it has to be, into the hulls of both sides, so the hulls together hold every point of
/// every triangle, to the rounding of the cuts ([`Hull::tolerance`]). What the mesh encloses at a cut goes into both sides
/// too, so that the hulls of a closed mesh hold its inside, to rounding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Decomposition {
    /// The most hulls, 1 to 64.
    pub parts: usize,
    /// No more cuts when the best one saves less than this part of the volume of the whole hull, 0 to 1.
    pub concavity: f64,
    /// Planes tried along each axis of a piece, 1 to 64; as many again at corners of the mesh near the best.
    pub resolution: usize,
}

impl Default for Decomposition {
    /// 8 parts, 1 %, 12 planes.
    fn default() -> Self {
        Self {
            parts: 8,
            concavity: 0.01,
            resolution: 12,
        }
    }
}

impl Mesh {
    /// Convex hulls that together hold all triangles, in the order of their cuts.
    ///
    /// # Errors
    /// Settings out of range or too fine for a mesh of this size, or as [`Hull::new`].
    pub fn decomposed(&self, options: &Decomposition) -> Result<Vec<Hull>> {
        let Decomposition {
            parts,
            concavity,
            resolution,
        } = *options;
        let fail = |what: String, expected: &str| {
            Err(Error::new(ErrorKind::Setting, what).expected(expected.to_owned()))
        };
        if !(1..=64).contains(&parts) {
            return fail(format!("{parts} parts"), "1 to 64");
        }
        if !(0.0..=1.0).contains(&concavity) {
            return fail(format!("a concavity of {concavity}"), "0 to 1");
        }
        if !(1..=64).contains(&resolution) {
            return fail(format!("a resolution of {resolution}"), "1 to 64");
        }
        let mut work = Work {
            resolution,
            points: 0,
        };
        let whole = Piece {
            triangles: self
                .triangles()
                .iter()
                .map(|t| t.map(|i| self.vertices()[i as usize]))
                .collect(),
            cuts: 0,
        };
        let volume = work.volume(&whole)?;
        let best = work.best(&whole, volume)?.filter(|_| parts > 1);
        let mut pieces = vec![(whole, best)];
        while pieces.len() < parts {
            let saved = |(_, cut): &(Piece, Option<Cut>)| cut.as_ref().map_or(0.0, |c| c.saved);
            // The first of equals.
            let most = (0..pieces.len())
                .rev()
                .max_by(|i, j| saved(&pieces[*i]).total_cmp(&saved(&pieces[*j])));
            let Some(most) = most.filter(|i| saved(&pieces[*i]) > concavity * volume) else {
                break;
            };
            let Some(cut) = pieces[most].1.take() else {
                break;
            };
            let sides = pieces[most].0.divided(cut.axis, cut.at);
            let [low, high] = sides.map(|side| {
                let own = work.volume(&side)?;
                let best = work.best(&side, own)?;
                Ok((side, best))
            });
            pieces[most] = low?;
            pieces.insert(most + 1, high?);
        }
        let size = self.vertices().iter().map(|v| v.coords.amax());
        let rounding = CUT_ROUNDING * size.fold(0.0, f64::max);
        let hull = |(piece, _): &(Piece, Option<Cut>)| {
            Hull::within(&piece.points(), f64::from(piece.cuts) * rounding)
        };
        pieces.iter().map(hull).collect()
    }
}

/// Part of a mesh.
struct Piece {
    triangles: Vec<[Point3<f64>; 3]>,
    /// How many cuts it has gone through.
    cuts: u32,
}

/// A plane across an axis.
struct Cut {
    axis: usize,
    at: f64,
    /// Volume of the hull less those of the hulls of both sides \[m^3\].
    saved: f64,
}

/// Tries cuts, within a bound.
struct Work {
    resolution: usize,
    points: usize,
}

impl Work {
    fn volume(&mut self, piece: &Piece) -> Result<f64> {
        let points = piece.points();
        self.points += points.len();
        if self.points > MOST_POINTS {
            return Err(
                Error::new(ErrorKind::Setting, "the decomposition takes too long")
                    .help("ask for fewer parts, a lower resolution, or simplify the mesh"),
            );
        }
        hull_volume(points)
    }

    /// The cut that saves most volume, if one saves any.
    fn best(&mut self, piece: &Piece, volume: f64) -> Result<Option<Cut>> {
        let mut best: Option<Cut> = None;
        if volume <= 0.0 {
            return Ok(best);
        }
        let points = piece.points();
        for axis in 0..3 {
            let mut places: Vec<f64> = points.iter().map(|p| p[axis]).collect();
            places.sort_by(f64::total_cmp);
            places.dedup();
            let [low, .., high] = places[..] else {
                continue;
            };
            let step = (high - low) / (self.resolution + 1) as f64;
            let evenly: Vec<f64> = (1..=self.resolution)
                .map(|i| low + i as f64 * step)
                .collect();
            let mut here = self.best_of(piece, volume, axis, &evenly)?;
            // Between two tried planes there may be a corner at which a body changes.
            if let Some(at) = here.as_ref().map(|cut| cut.at) {
                let near = |x: &&f64| (**x - at).abs() < step && **x > low && **x < high;
                let near: Vec<f64> = places.iter().filter(near).copied().collect();
                let stride = near.len().div_ceil(self.resolution).max(1);
                let some: Vec<f64> = near.into_iter().step_by(stride).collect();
                let finer = self.best_of(piece, volume, axis, &some)?;
                here = here.into_iter().chain(finer).reduce(larger);
            }
            best = best.into_iter().chain(here).reduce(larger);
        }
        Ok(best)
    }

    fn best_of(
        &mut self,
        piece: &Piece,
        volume: f64,
        axis: usize,
        places: &[f64],
    ) -> Result<Option<Cut>> {
        let mut best: Option<Cut> = None;
        for &at in places {
            let [low, high] = piece.cut(axis, at);
            if low.triangles.is_empty() || high.triangles.is_empty() {
                continue;
            }
            let saved = volume - self.volume(&low)? - self.volume(&high)?;
            if saved > 0.0 {
                best = best
                    .into_iter()
                    .chain([Cut { axis, at, saved }])
                    .reduce(larger);
            }
        }
        Ok(best)
    }
}

/// The one that saves more; the first of equals.
fn larger(a: Cut, b: Cut) -> Cut {
    if b.saved > a.saved { b } else { a }
}

impl Piece {
    fn points(&self) -> Vec<Point3<f64>> {
        self.triangles.iter().flatten().copied().collect()
    }

    /// As [`cut`](Self::cut), and both sides closed by the section: without it, a later cut could leave a hollow.
    fn divided(&self, axis: usize, at: f64) -> [Self; 2] {
        let [mut low, mut high] = self.cut(axis, at);
        let section = |side| section::filled(&self.triangles, axis, at, side);
        low.triangles.extend(section(-1.0));
        high.triangles.extend(section(1.0));
        [low, high]
    }

    /// What is below and above a plane across an axis. A triangle in the plane belongs to what is behind it.
    fn cut(&self, axis: usize, at: f64) -> [Self; 2] {
        [-1.0, 1.0].map(|side| {
            let mut triangles = Vec::new();
            let mut polygon = Vec::with_capacity(4);
            for triangle in &self.triangles {
                polygon.clear();
                if triangle.iter().all(|p| p[axis] == at) {
                    let [a, b, c] = triangle;
                    let normal = (b - a).cross(&(c - a));
                    if (normal[axis] < 0.0) == (side > 0.0) {
                        triangles.push(*triangle);
                    }
                    continue;
                }
                for (i, a) in triangle.iter().enumerate() {
                    let b = &triangle[(i + 1) % 3];
                    if side * (a[axis] - at) >= 0.0 {
                        polygon.push(*a);
                    }
                    if (a[axis] < at && b[axis] > at) || (a[axis] > at && b[axis] < at) {
                        polygon.push(crossing(a, b, axis, at));
                    }
                }
                // A triangle that only touches the plane belongs to its other side.
                for i in 2..polygon.len() {
                    triangles.push([polygon[0], polygon[i - 1], polygon[i]]);
                }
            }
            Self {
                triangles,
                cuts: self.cuts + 1,
            }
        })
    }
}

/// Where the edge from a to b, which has an end on each side, passes the plane: the same from either end.
fn crossing(a: &Point3<f64>, b: &Point3<f64>, axis: usize, at: f64) -> Point3<f64> {
    let (a, b) = if a[axis] < b[axis] { (a, b) } else { (b, a) };
    let t = (at - a[axis]) / (b[axis] - a[axis]);
    let mut point = a + t * (b - a);
    for i in 0..3 {
        point[i] = point[i].clamp(a[i].min(b[i]), a[i].max(b[i]));
    }
    point[axis] = at;
    point
}

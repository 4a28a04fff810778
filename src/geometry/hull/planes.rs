//! Hulls as intersections of half-spaces.

use nalgebra::Vector3;

use super::Hull;

/// The area of a triangle, twice, relative to the square of its longest side below which its normal is noise.
const SLIVER: f64 = 1e-9;

/// A face's unit normal, by how much rounding may have turned it \[rad\], and twice its area relative to its longest side squared.
struct Normal {
    vector: Vector3<f64>,
    turn: f64,
    proportion: f64,
}

impl Hull {
    /// Half-spaces {x : n . x <= d}, n of length 1, d in metres, whose intersection is the hull but for rounding, which is
    /// outward; one for each face. Slivers, whose normals are noise, have none: their neighbours bound the hull. A flat hull
    /// has its two sides and its rim, and none when it is all slivers; without faces there are none.
    pub fn planes(&self) -> Vec<(Vector3<f64>, f64)> {
        let plane = |corners: &[u32], normal: &Vector3<f64>, turn: f64| {
            let heights = corners
                .iter()
                .map(|i| normal.dot(&self.vertices[*i as usize].coords));
            (*normal, heights.fold(f64::MIN, f64::max) + self.slack(turn))
        };
        let telling = |face: &[u32; 3]| {
            let normal = self.normal(face);
            (normal.proportion > SLIVER).then_some(normal)
        };
        if !self.flat {
            let faces = self.faces.iter();
            return faces
                .filter_map(|face| telling(face).map(|n| plane(face, &n.vector, n.turn)))
                .collect();
        }
        // All are in one plane, and the widest tells it best. Corners go around the front, whose triangles come first.
        let widest = (0..self.faces.len())
            .filter_map(|i| telling(&self.faces[i]).map(|normal| (i, normal)))
            .max_by(|(_, a), (_, b)| a.proportion.total_cmp(&b.proportion));
        let Some((i, Normal { vector, turn, .. })) = widest else {
            return Vec::new();
        };
        let is_front = i < self.faces.len() / 2;
        let vector = if is_front { vector } else { -vector };
        let count = self.vertices.len() as u32;
        let corners: Vec<u32> = (0..count).collect();
        let rim = corners.iter().filter_map(|&from| {
            let ends = [from, (from + 1) % count];
            let [a, b] = ends.map(|i| &self.vertices[i as usize]);
            let outward = (b - a).cross(&vector).try_normalize(0.0)?;
            Some(plane(&ends, &outward, turn + 8.0 * f64::EPSILON))
        });
        [vector, -vector]
            .iter()
            .map(|side| plane(&corners, side, turn))
            .chain(rim)
            .collect()
    }

    /// By how much rounding may move a plane whose normal is turned so far \[m\]: at a lever of the diameter, and in products.
    fn slack(&self, turn: f64) -> f64 {
        let size = self.vertices.iter().map(|v| v.coords.amax());
        let size = size.fold(0.0, f64::max);
        (turn + 4.0 * f64::EPSILON) * 2.0 * (size + self.ball.radius)
    }

    fn normal(&self, face: &[u32; 3]) -> Normal {
        let [a, b, c] = face.map(|i| &self.vertices[i as usize]);
        let sides = [b - a, c - b, a - c];
        let longest = sides.iter().map(Vector3::norm).fold(0.0, f64::max);
        let across = sides[0].cross(&sides[1]);
        let proportion = across.norm() / (longest * longest);
        Normal {
            vector: across.normalize(),
            // Sides are differences of what is exact, known to half an EPSILON of themselves, and their product to nine EPSILON of
            // the square of the longest.
            turn: 16.0 * f64::EPSILON / proportion,
            proportion,
        }
    }
}

//! Hulls as intersections of half-spaces.

use nalgebra::Vector3;

use super::Hull;

/// The height of a triangle relative to its longest side below which its normal is noise.
const SLIVER: f64 = 1e-9;

impl Hull {
    /// Half-spaces {x : n . x <= d}, n of length 1, d in metres, whose intersection is the hull but for rounding, which is
    /// outward; one for each face. Slivers, whose normals are noise, have none: their neighbours bound the hull. A flat hull
    /// has its sides and its rim; without faces there are none.
    pub fn planes(&self) -> Vec<(Vector3<f64>, f64)> {
        let size = self
            .vertices
            .iter()
            .map(|v| v.coords.amax())
            .fold(0.0, f64::max);
        let mut planes = Vec::new();
        for face in &self.faces {
            let [a, b, c] = face.map(|i| &self.vertices[i as usize]);
            let sides = [b - a, c - b, a - c];
            let longest = sides.iter().map(Vector3::norm).fold(0.0, f64::max);
            let across = sides[0].cross(&sides[1]);
            let area = across.norm();
            if area <= SLIVER * longest * longest {
                continue;
            }
            let normal = across / area;
            // Sides are known to 2 EPSILON size, so the normal turns by 8 EPSILON size longest / area, at a lever of the
            // diameter; what else is rounded is less.
            let turn = 16.0 * f64::EPSILON * size * longest / area;
            let slack = (turn + 4.0 * f64::EPSILON) * 2.0 * (size + self.ball.radius);
            let corners = [a, b, c].map(|p| normal.dot(&p.coords));
            planes.push((
                normal,
                corners.into_iter().fold(corners[0], f64::max) + slack,
            ));
        }
        if let Some((front, _)) = planes.first().copied().filter(|_| self.flat) {
            let next = self.vertices.iter().cycle().skip(1);
            for (a, b) in self.vertices.iter().zip(next) {
                if let Some(n) = (b - a).cross(&front).try_normalize(0.0) {
                    planes.push((n, n.dot(&a.coords).max(n.dot(&b.coords))));
                }
            }
        }
        planes
    }
}

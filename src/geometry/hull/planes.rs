//! Hulls as intersections of half-spaces.

use nalgebra::Vector3;

use super::Hull;

/// Normals nearer to each other are one.
const SAME: f64 = 1e-9;

/// The height of a triangle relative to its longest side below which its normal is noise.
const SLIVER: f64 = 1e-9;

impl Hull {
    /// Half-spaces {x : n . x <= d}, n of length 1, d in metres, whose intersection is the hull but for rounding, which does
    /// not cut corners; one for faces in a common plane. Slivers, whose normals are noise, have none: their neighbours
    /// bound the hull. A flat hull has its two sides and its rim, without faces there are none.
    pub fn planes(&self) -> Vec<(Vector3<f64>, f64)> {
        let mut normals: Vec<Vector3<f64>> = Vec::new();
        for face in &self.faces {
            let [a, b, c] = face.map(|i| &self.vertices[i as usize]);
            let sides = [b - a, c - b, a - c];
            let longest = sides.iter().map(Vector3::norm).fold(0.0, f64::max);
            let normal = sides[0].cross(&sides[1]);
            if normal.norm() > SLIVER * longest * longest {
                add(&mut normals, normal);
            }
        }
        if let Some(front) = normals.first().copied().filter(|_| self.flat) {
            let next = self.vertices.iter().cycle().skip(1);
            for (a, b) in self.vertices.iter().zip(next) {
                add(&mut normals, (b - a).cross(&front));
            }
        }
        let support = |n: Vector3<f64>| {
            let along = self.vertices.iter().map(|v| n.dot(&v.coords));
            (n, along.fold(f64::NEG_INFINITY, f64::max))
        };
        normals.into_iter().map(support).collect()
    }
}

fn add(normals: &mut Vec<Vector3<f64>>, normal: Vector3<f64>) {
    if let Some(n) = normal.try_normalize(0.0)
        && normals.iter().all(|m| (m - n).norm() > SAME)
    {
        normals.push(n);
    }
}

//! A polytope that grows by a vertex at a time: triangles that know their neighbours.

use nalgebra::Vector3;

use super::simplex::Vertex;
use crate::geometry::convex::dot;

/// A triangle, counter-clockwise from outside.
#[derive(Clone, Copy)]
pub(super) struct Face {
    corners: [usize; 3],
    /// Across the edge from corner i to corner i + 1.
    neighbours: [usize; 3],
    pub(super) normal: Vector3<f64>,
    /// The largest coordinate of a corner along the normal; infinite for a face that is not to be looked at again.
    pub(super) distance: f64,
    /// The same, kept for telling what sees the face.
    height: f64,
    alive: bool,
}

pub(super) struct Polytope {
    vertices: Vec<Vertex>,
    pub(super) faces: Vec<Face>,
    /// A face is seen from points above this height under its plane \[m\].
    below: f64,
    /// Working space: faces seen, edges of what is not, the new face that starts at a vertex.
    seen: Vec<usize>,
    horizon: Vec<[usize; 3]>,
    starting: Vec<usize>,
}

/// No face.
const NONE: usize = usize::MAX;

impl Polytope {
    /// A tetrahedron that is not flat.
    pub(super) fn new(corners: [Vertex; 4], coplanar: f64) -> Self {
        let mut polytope = Self {
            vertices: Vec::with_capacity(64),
            faces: Vec::with_capacity(256),
            below: coplanar,
            seen: Vec::with_capacity(32),
            horizon: Vec::with_capacity(32),
            starting: Vec::with_capacity(64),
        };
        polytope.vertices.extend(corners);
        polytope.starting.resize(4, NONE);
        let [p, q, r, s] = corners.map(|c| c.w);
        let outward = dot(&(q - p).cross(&(r - p)), &(s - p)) < 0.0;
        let faces = if outward {
            [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]
        } else {
            [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
        };
        for corners in faces {
            // Across the edge from i to j is the face with the edge from j to i.
            let neighbours = std::array::from_fn(|i| {
                let (from, to) = (corners[i], corners[(i + 1) % 3]);
                faces
                    .iter()
                    .position(|other| (0..3).any(|k| other[k] == to && other[(k + 1) % 3] == from))
                    .unwrap_or(NONE)
            });
            if let Some(face) = polytope.face(corners, neighbours) {
                polytope.faces.push(face);
            }
        }
        polytope
    }

    /// The face nearest to the origin, by signed distance.
    pub(super) fn nearest(&self) -> Option<usize> {
        let mut best = (f64::INFINITY, None);
        for (i, face) in self.faces.iter().enumerate() {
            if face.alive && face.distance < best.0 {
                best = (face.distance, Some(i));
            }
        }
        best.1
    }

    fn face(&self, corners: [usize; 3], neighbours: [usize; 3]) -> Option<Face> {
        let [p, q, r] = corners.map(|c| self.vertices[c].w);
        let normal = (q - p).cross(&(r - p));
        let length = normal.norm();
        if length.is_nan() || length <= f64::MIN_POSITIVE {
            return None;
        }
        let normal = normal / length;
        let distance = dot(&normal, &p).max(dot(&normal, &q)).max(dot(&normal, &r));
        Some(Face {
            corners,
            neighbours,
            normal,
            distance,
            height: distance,
            alive: true,
        })
    }

    /// Takes `vertex`, which is above the face `first`, into the polytope. False, and nothing changed, when rounding
    /// leaves no simple ring of edges around what the vertex sees.
    pub(super) fn expand(&mut self, first: usize, vertex: Vertex) -> bool {
        self.look(first, &vertex.w);
        let tip = self.vertices.len();
        self.vertices.push(vertex);
        self.starting.push(NONE);
        let before = self.faces.len();
        if self.cover(tip) {
            for i in 0..self.seen.len() {
                self.faces[self.seen[i]].alive = false;
            }
            true
        } else {
            self.faces.truncate(before);
            self.vertices.pop();
            self.starting.pop();
            for i in 0..self.seen.len() {
                self.faces[self.seen[i]].alive = true;
            }
            false
        }
    }

    /// Collects what is seen from `point`, from the face `first` on, and the edges around it. Faces seen are dead.
    fn look(&mut self, first: usize, point: &Vector3<f64>) {
        self.seen.clear();
        self.horizon.clear();
        self.faces[first].alive = false;
        self.seen.push(first);
        let mut next = 0;
        while next < self.seen.len() {
            let face = self.faces[self.seen[next]];
            next += 1;
            for neighbour in face.neighbours {
                let Some(other) = self.faces.get_mut(neighbour) else {
                    continue;
                };
                if other.alive && dot(&other.normal, point) > other.height - self.below {
                    other.alive = false;
                    self.seen.push(neighbour);
                }
            }
        }
        for seen in &self.seen {
            let face = &self.faces[*seen];
            for i in 0..3 {
                let beyond = face.neighbours[i];
                if self.faces.get(beyond).is_some_and(|f| f.alive) {
                    self.horizon
                        .push([face.corners[i], face.corners[(i + 1) % 3], beyond]);
                }
            }
        }
    }

    /// Faces from every edge of the horizon to the vertex `tip`, linked to one another and to what is beyond. False when
    /// the horizon is no simple ring or a face has no normal; neighbours beyond are then as they were.
    fn cover(&mut self, tip: usize) -> bool {
        let (first, count) = (self.faces.len(), self.horizon.len());
        if count < 3 {
            return false;
        }
        for [from, _, _] in &self.horizon {
            self.starting[*from] = NONE;
        }
        for i in 0..count {
            let [from, to, beyond] = self.horizon[i];
            if self.starting[from] != NONE {
                return false;
            }
            self.starting[from] = first + i;
            match self.face([from, to, tip], [beyond, NONE, NONE]) {
                Some(face) => self.faces.push(face),
                None => return false,
            }
        }
        // One ring, all the way round.
        let (mut at, mut passed) = (0, 0);
        loop {
            let next = self.starting[self.horizon[at][1]];
            // A start left from an earlier vertex is not of this ring.
            if next < first
                || next >= first + count
                || self.horizon[next - first][0] != self.horizon[at][1]
            {
                return false;
            }
            self.faces[first + at].neighbours[1] = next;
            self.faces[next].neighbours[2] = first + at;
            at = next - first;
            passed += 1;
            if at == 0 {
                break;
            }
            if passed > count {
                return false;
            }
        }
        if passed != count {
            return false;
        }
        for i in 0..count {
            let [from, to, beyond] = self.horizon[i];
            let other = &mut self.faces[beyond];
            for k in 0..3 {
                if other.corners[k] == to && other.corners[(k + 1) % 3] == from {
                    other.neighbours[k] = first + i;
                }
            }
        }
        true
    }
}

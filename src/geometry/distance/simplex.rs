//! The point nearest to the origin of a point, segment, triangle or tetrahedron of the difference of two shapes.
//!
//! Everything is formed from cross products of edges, not from Gram determinants: those lose twice the digits on slivers.

use nalgebra::Vector3;

use crate::geometry::convex::dot;

/// A squared sine below which edges count as parallel.
const PARALLEL: f64 = 1e-28;

/// A point of B less a point of A, all in A's frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vertex {
    /// b - a
    pub(super) w: Vector3<f64>,
    pub(super) a: Vector3<f64>,
    pub(super) b: Vector3<f64>,
    /// Numbers of the vertices, or [`SMOOTH`](super::support::SMOOTH).
    pub(super) ids: [u32; 2],
}

/// Up to four vertices, and the weights of the point nearest to the origin.
#[derive(Clone, Copy)]
pub(super) struct Simplex {
    vertices: [Vertex; 4],
    weights: [f64; 4],
    len: usize,
}

/// What a simplex has to say about the origin.
#[derive(Clone, Copy)]
pub(super) enum Closest {
    /// It is inside the tetrahedron.
    Inside,
    At(Nearest),
}

/// The nearest point, by the vertices in `corners`.
#[derive(Clone, Copy)]
pub(super) struct Nearest {
    /// For faces along their normal, which is known better than the point.
    pub(super) v: Vector3<f64>,
    pub(super) square: f64,
    corners: [usize; 3],
    weights: [f64; 3],
    len: usize,
}

impl Simplex {
    #[inline(always)]
    pub(super) fn empty() -> Self {
        let zero = Vector3::zeros();
        let vertex = Vertex {
            w: zero,
            a: zero,
            b: zero,
            ids: [0; 2],
        };
        Self {
            vertices: [vertex; 4],
            weights: [1.0, 0.0, 0.0, 0.0],
            len: 0,
        }
    }

    #[inline(always)]
    pub(super) fn vertices(&self) -> &[Vertex] {
        &self.vertices[..self.len]
    }

    #[inline(always)]
    pub(super) fn push(&mut self, vertex: Vertex) {
        if self.len < 4 {
            self.vertices[self.len] = vertex;
            self.len += 1;
        }
    }

    /// Takes the last vertex off again.
    #[inline(always)]
    pub(super) fn pop(&mut self) {
        self.len -= 1;
    }

    /// Keeps the vertices of `nearest`, with its weights.
    #[inline(always)]
    pub(super) fn keep(&mut self, nearest: &Nearest) {
        // Corners ascend, so that none is overwritten before it is read.
        for i in 0..nearest.len {
            self.vertices[i] = self.vertices[nearest.corners[i]];
            self.weights[i] = nearest.weights[i];
        }
        self.len = nearest.len;
    }

    /// The nearest points of A and of B by the weights.
    #[inline(always)]
    pub(super) fn witnesses(&self) -> [Vector3<f64>; 2] {
        let (mut a, mut b) = (Vector3::zeros(), Vector3::zeros());
        for (vertex, weight) in self.vertices().iter().zip(&self.weights) {
            a += vertex.a * *weight;
            b += vertex.b * *weight;
        }
        [a, b]
    }

    /// `outside`: the origin is known to be outside, whatever rounding makes of a flat tetrahedron.
    #[inline(always)]
    pub(super) fn closest(&self, outside: bool) -> Closest {
        let w = |i: usize| &self.vertices[i].w;
        match self.len {
            0 | 1 => Closest::At(point(w(0), 0)),
            2 => Closest::At(segment(w, 0, 1)),
            3 => Closest::At(triangle(w, 0, 1, 2)),
            _ => tetrahedron(w, outside),
        }
    }
}

#[inline(always)]
fn point(p: &Vector3<f64>, corner: usize) -> Nearest {
    Nearest {
        v: *p,
        square: dot(p, p),
        corners: [corner; 3],
        weights: [1.0, 0.0, 0.0],
        len: 1,
    }
}

#[inline(always)]
fn segment<'a>(w: impl Fn(usize) -> &'a Vector3<f64>, i: usize, j: usize) -> Nearest {
    let (p, q) = (w(i), w(j));
    let edge = q - p;
    let (along, square) = (-dot(p, &edge), dot(&edge, &edge));
    if along <= 0.0 || square <= 0.0 {
        return point(p, i);
    }
    if along >= square {
        return point(q, j);
    }
    let share = along / square;
    let v = p + edge * share;
    Nearest {
        v,
        square: dot(&v, &v),
        corners: [i, j, j],
        weights: [1.0 - share, share, 0.0],
        len: 2,
    }
}

#[inline(always)]
fn nearer(a: Nearest, b: Nearest) -> Nearest {
    if b.square < a.square { b } else { a }
}

#[inline(always)]
fn triangle<'a>(
    w: impl Fn(usize) -> &'a Vector3<f64> + Copy,
    i: usize,
    j: usize,
    k: usize,
) -> Nearest {
    let (p, q, r) = (w(i), w(j), w(k));
    let (e, f) = (q - p, r - p);
    let normal = e.cross(&f);
    let square = dot(&normal, &normal);
    if square <= PARALLEL * dot(&e, &e) * dot(&f, &f) {
        return nearer(nearer(segment(w, i, j), segment(w, i, k)), segment(w, j, k));
    }
    // Weights of q and r times `square`.
    let beta = -dot(&p.cross(&f), &normal);
    let gamma = -dot(&e.cross(p), &normal);
    let alpha = square - beta - gamma;
    if alpha >= 0.0 && beta >= 0.0 && gamma >= 0.0 {
        let v = normal * (dot(&normal, p) / square);
        return Nearest {
            v,
            square: dot(&v, &v),
            corners: [i, j, k],
            weights: [alpha / square, beta / square, gamma / square],
            len: 3,
        };
    }
    // The nearest point is on an edge that the foot of the origin is beyond.
    let mut best: Option<Nearest> = None;
    let mut take = |edge: Nearest| {
        best = Some(match best {
            Some(best) => nearer(best, edge),
            None => edge,
        });
    };
    if alpha < 0.0 {
        take(segment(w, j, k));
    }
    if beta < 0.0 {
        take(segment(w, i, k));
    }
    if gamma < 0.0 {
        take(segment(w, i, j));
    }
    // None of these only when a number is NaN.
    best.unwrap_or_else(|| point(p, i))
}

#[inline(always)]
fn tetrahedron<'a>(w: impl Fn(usize) -> &'a Vector3<f64> + Copy, outside: bool) -> Closest {
    let mut best: Option<Nearest> = None;
    for [i, j, k, opposite] in [[0, 1, 3, 2], [0, 2, 3, 1], [1, 2, 3, 0], [0, 1, 2, 3]] {
        let (p, e, f) = (w(i), w(j) - w(i), w(k) - w(i));
        let normal = e.cross(&f);
        let up = w(opposite) - p;
        let (height, origin) = (dot(&normal, &up), -dot(&normal, p));
        // A flat tetrahedron has no inside.
        let flat = height * height <= PARALLEL * dot(&normal, &normal) * dot(&up, &up);
        if flat || (origin < 0.0) == (height > 0.0) {
            let face = triangle(w, i, j, k);
            best = Some(match best {
                Some(best) => nearer(best, face),
                None => face,
            });
        }
    }
    match best {
        Some(best) => Closest::At(best),
        None if outside => {
            let faces = [[0, 1, 3], [0, 2, 3], [1, 2, 3]].map(|[i, j, k]| triangle(w, i, j, k));
            Closest::At(faces.into_iter().fold(triangle(w, 0, 1, 2), nearer))
        }
        None => Closest::Inside,
    }
}

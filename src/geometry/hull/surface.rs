//! Surfaces of triangles: whether they are closed and convex, and what they hold.

use nalgebra::Point3;

use super::orientation::height;

/// Which of `count` vertices the faces use.
pub(super) fn used(faces: &[[u32; 3]], count: usize) -> Vec<bool> {
    let mut used = vec![false; count];
    for i in faces.iter().flatten() {
        used[*i as usize] = true;
    }
    used
}

/// The points that are used, and the faces in their new numbers.
pub(super) fn compact(
    points: &[Point3<f64>],
    used: &[bool],
    mut faces: Vec<[u32; 3]>,
) -> (Vec<Point3<f64>>, Vec<[u32; 3]>) {
    let mut numbers = vec![0; points.len()];
    let mut kept = Vec::new();
    for (i, point) in points.iter().enumerate().filter(|(i, _)| used[*i]) {
        numbers[i] = kept.len() as u32;
        kept.push(*point);
    }
    for i in faces.iter_mut().flatten() {
        *i = numbers[*i as usize];
    }
    (kept, faces)
}

/// Directed edges (from, to, index of the face), sorted.
fn edges(faces: &[[u32; 3]]) -> Vec<(u32, u32, usize)> {
    let sides = |(f, [a, b, c]): (usize, &[u32; 3])| [(*a, *b, f), (*b, *c, f), (*c, *a, f)];
    let mut edges: Vec<_> = faces.iter().enumerate().flat_map(sides).collect();
    edges.sort_unstable();
    edges
}

/// The face on the other side of an edge.
fn beyond(edges: &[(u32, u32, usize)], (a, b, _): (u32, u32, usize)) -> Option<usize> {
    let found = edges.binary_search_by(|e| (e.0, e.1).cmp(&(b, a)));
    found.ok().map(|at| edges[at].2)
}

/// Whether every edge is passed once in each direction.
pub(crate) fn is_paired(faces: &[[u32; 3]]) -> bool {
    let edges = edges(faces);
    edges
        .windows(2)
        .all(|e| (e[0].0, e[0].1) != (e[1].0, e[1].1))
        && edges.iter().all(|e| beyond(&edges, *e).is_some())
}

/// Whether faces with all of `vertices` corners are a closed surface without holes: V - E + F = 2. A segment and a point
/// have no faces.
pub(super) fn is_closed(vertices: usize, faces: &[[u32; 3]]) -> bool {
    if faces.is_empty() {
        return vertices <= 2;
    }
    2 * vertices + 2 * faces.len() == 3 * faces.len() + 4 && is_paired(faces)
}

/// Whether no face is below the corners of a face beside it: for a closed surface without holes that is enough.
pub(super) fn is_convex(vertices: &[Point3<f64>], faces: &[[u32; 3]]) -> bool {
    let edges = edges(faces);
    edges.iter().all(|edge| {
        let [p, q, r] = faces[edge.2].map(|i| &vertices[i as usize]);
        beyond(&edges, *edge).is_some_and(|there| {
            let corners = faces[there].iter().map(|i| &vertices[*i as usize]);
            corners.into_iter().all(|v| height(p, q, r, v) <= 0.0)
        })
    })
}

/// \[m^3\], negative when the faces are clockwise from outside.
pub(crate) fn volume(vertices: &[Point3<f64>], faces: &[[u32; 3]]) -> f64 {
    let Some(foot) = vertices.first() else {
        return 0.0;
    };
    let parts = faces.iter().map(|face| {
        let [a, b, c] = face.map(|i| vertices[i as usize] - foot);
        a.dot(&b.cross(&c))
    });
    parts.sum::<f64>() / 6.0
}

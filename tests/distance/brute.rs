//! Signed distance of polytopes of few corners, by everything there is to try.

use crate::drawn::V;

/// Of the hulls of `a` and `b`.
///
/// The nearest points of polytopes that are apart are on a corner and a triangle, or on two edges, and all triples and
/// pairs of corners are tried; the plane across the way between them tells whether they are apart at all. The depth is the
/// least support value over the normals of the facets of b - a: normals of triangles, and of pairs of edges.
pub fn signed_distance(a: &[V], b: &[V]) -> f64 {
    let way = nearest(a, b);
    let length = way.norm();
    let depth = |n: &V| {
        let high = a.iter().map(|p| n.dot(p)).fold(f64::MIN, f64::max);
        high - b.iter().map(|p| n.dot(p)).fold(f64::MAX, f64::min)
    };
    if length > 0.0 && depth(&(way / length)) < 0.0 {
        return length;
    }
    let edges = [edges(a), edges(b)];
    let mut least = f64::INFINITY;
    let mut try_normal = |n: V| {
        if let Some(n) = n.try_normalize(0.0) {
            least = least.min(depth(&n)).min(depth(&-n));
        }
    };
    for i in 0..3 {
        try_normal(V::ith(i, 1.0));
    }
    for (left, right) in [(0, 0), (1, 1), (0, 1)] {
        for e in &edges[left] {
            for f in &edges[right] {
                let normal = e.cross(f);
                if normal.norm() > 1e-9 * e.norm() * f.norm() {
                    try_normal(normal);
                }
            }
        }
    }
    // Where all is in one line, across it.
    for e in edges.iter().flatten() {
        let across = e.cross(&V::ith(e.iamin(), 1.0));
        try_normal(across);
        try_normal(e.cross(&across));
    }
    -least
}

fn edges(points: &[V]) -> Vec<V> {
    (0..points.len())
        .flat_map(|i| (0..i).map(move |j| points[i] - points[j]))
        .filter(|e| e.norm() > 0.0)
        .collect()
}

/// The shortest way from a corner, edge or triangle of `a` to one of `b`.
fn nearest(a: &[V], b: &[V]) -> V {
    let mut best = b[0] - a[0];
    let mut take = |way: Option<V>| {
        if let Some(way) = way
            && way.norm_squared() < best.norm_squared()
        {
            best = way;
        }
    };
    for i in 0..a.len() {
        for j in 0..=i {
            for k in 0..b.len() {
                for l in 0..=k {
                    take(between_lines([a[i], a[j]], [b[k], b[l]]));
                }
                take(to_segment(&b[k], [a[i], a[j]]).map(|way| -way));
            }
        }
    }
    for k in 0..b.len() {
        for l in 0..=k {
            for p in a {
                take(to_segment(p, [b[k], b[l]]));
            }
        }
    }
    for (points, corners, sign) in [(a, b, 1.0), (b, a, -1.0)] {
        for p in points {
            for i in 0..corners.len() {
                for j in 0..i {
                    for k in 0..j {
                        let triangle = [corners[i], corners[j], corners[k]];
                        take(to_triangle(p, triangle).map(|way| way * sign));
                    }
                }
            }
        }
    }
    best
}

/// From the inside of one segment to that of the other, if they are not parallel.
fn between_lines([p, p_end]: [V; 2], [q, q_end]: [V; 2]) -> Option<V> {
    let (d, e, r) = (p_end - p, q_end - q, q - p);
    let n = d.cross(&e);
    if n.norm() <= 1e-13 * d.norm() * e.norm() {
        return None;
    }
    let s = r.cross(&e).dot(&n) / n.norm_squared();
    let t = r.cross(&d).dot(&n) / n.norm_squared();
    let is_inside = (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t);
    is_inside.then(|| r + e * t - d * s)
}

fn to_segment(p: &V, [q, q_end]: [V; 2]) -> Option<V> {
    let e = q_end - q;
    let square = e.norm_squared();
    let share = if square > 0.0 {
        ((p - q).dot(&e) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    Some(q + e * share - p)
}

/// To the inside of a triangle.
fn to_triangle(p: &V, [q, r, s]: [V; 3]) -> Option<V> {
    let (e, f, way) = (r - q, s - q, p - q);
    let n = e.cross(&f);
    if n.norm() <= 1e-13 * e.norm() * f.norm() {
        return None;
    }
    let beta = way.cross(&f).dot(&n) / n.norm_squared();
    let gamma = e.cross(&way).dot(&n) / n.norm_squared();
    let is_inside = beta >= 0.0 && gamma >= 0.0 && beta + gamma <= 1.0;
    is_inside.then(|| e * beta + f * gamma - way)
}

//! Hulls of points in one plane, on one line, or at one place.

use nalgebra::Point3;

use super::orientation::{left, shadow};

/// Where points span a body, four of them do; else which of them are corners.
pub(super) enum Span {
    /// Four points that are not in one plane.
    Body([u32; 4]),
    /// The corners of a convex polygon, in order round it; two for a segment, one for a point.
    Flat(Vec<u32>),
}

/// What `points`, at least one, sorted along x, then y, then z, no two of them equal, span.
pub(super) fn span(points: &[Point3<f64>]) -> Span {
    let last = points.len() - 1;
    // The first and the last in this order are corners, and so are the ends of any line.
    let (a, b) = (&points[0], &points[last]);
    if last == 0 {
        return Span::Flat(vec![0]);
    }
    // The farthest serve best, rounded as distances are; the exact signs have the last word.
    let off_line = |p: &Point3<f64>| (b - a).cross(&(p - a)).norm_squared();
    let Some(c) = best(points, off_line, |p| shadow(a, b, p).is_some()) else {
        return Span::Flat(vec![0, last as u32]);
    };
    let third = &points[c as usize];
    let off_plane = |p: &Point3<f64>| (b - a).cross(&(third - a)).dot(&(p - a)).abs();
    match best(points, off_plane, |p| {
        super::orientation::height(a, b, third, p) != 0.0
    }) {
        Some(d) => Span::Body([0, last as u32, c, d]),
        None => Span::Flat(polygon(points, shadow(a, b, third).unwrap_or(0))),
    }
}

/// The point with the largest measure of those that are `fit`.
fn best(
    points: &[Point3<f64>],
    measure: impl Fn(&Point3<f64>) -> f64,
    fit: impl Fn(&Point3<f64>) -> bool,
) -> Option<u32> {
    let with = |(i, p)| (i, p, measure(p));
    let most = points
        .iter()
        .zip(0_u32..)
        .map(|(p, i)| with((i, p)))
        .max_by(|x, y| x.2.total_cmp(&y.2));
    most.filter(|(_, p, _)| fit(p))
        .map(|(i, ..)| i)
        // Only where rounding made the largest measure one of noise.
        .or_else(|| {
            points
                .iter()
                .zip(0_u32..)
                .find(|(p, _)| fit(p))
                .map(|(_, i)| i)
        })
}

/// The corners of the convex hull of points in a plane that is not along `axis`, counterclockwise as seen from it: Andrew's
/// chain, along the order of the points.
fn polygon(points: &[Point3<f64>], axis: usize) -> Vec<u32> {
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    let at = |i: u32| &points[i as usize];
    let (x, y) = ((axis + 1) % 3, (axis + 2) % 3);
    order.sort_by(|i, j| {
        let (p, q) = (at(*i), at(*j));
        p[x].total_cmp(&q[x]).then(p[y].total_cmp(&q[y]))
    });
    let chain = |order: &mut dyn Iterator<Item = u32>| {
        let mut chain: Vec<u32> = Vec::new();
        for p in order {
            while let [.., a, b] = chain[..]
                && left(at(a), at(b), at(p), axis) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        // It ends where the other chain begins.
        chain.pop();
        chain
    };
    let mut corners = chain(&mut order.iter().copied());
    corners.extend(chain(&mut order.iter().rev().copied()));
    corners
}

/// Both sides of a polygon of `n` corners as triangles, each edge between two of them: fans about different corners, so that
/// no edge belongs to four triangles.
pub(super) fn two_sided(n: u32) -> Vec<[u32; 3]> {
    let front = (1..n.saturating_sub(1)).map(|i| [0, i, i + 1]);
    let back = (2..n).map(|i| [1, (i + 1) % n, i]);
    front.chain(back).collect()
}

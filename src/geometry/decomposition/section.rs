//! What a plane across an axis meets of a surface, filled.

use nalgebra::Point3;

use super::crossing;

/// Parts of a section that are farther apart than this part of its size are filled apart; rounding brings them no nearer.
const APART: f64 = 1e-9;

/// Splits within splits.
const DEPTH: usize = 64;

/// Middles tried for filling a part.
const MIDDLES: usize = 16;

type Segment = [Point3<f64>; 2];

/// Triangles in the plane that cover all that the surface encloses just above it (`side` 1) or just below (-1): from a point of
/// each separate part of the section to the segments around it. A point that is enclosed has a segment behind it, as seen
/// from there, wherever that is; where it sees all of the part (as from within a convex one), nothing else is covered.
pub(super) fn filled(
    triangles: &[[Point3<f64>; 3]],
    axis: usize,
    at: f64,
    side: f64,
) -> Vec<[Point3<f64>; 3]> {
    let mut segments = Vec::new();
    for triangle in triangles {
        // What only touches the plane from the other side bounds nothing on this.
        if triangle.iter().all(|p| side * (p[axis] - at) <= 0.0) {
            continue;
        }
        let mut met = [Point3::origin(); 3];
        let mut count = 0;
        for (i, a) in triangle.iter().enumerate() {
            let b = &triangle[(i + 1) % 3];
            if a[axis] == at {
                met[count] = *a;
                count += 1;
            } else if (a[axis] < at && b[axis] > at) || (a[axis] > at && b[axis] < at) {
                met[count] = crossing(a, b, axis, at);
                count += 1;
            }
        }
        if count == 2 {
            segments.push([met[0], met[1]]);
        }
    }
    let mut parts = Vec::new();
    let across = [(axis + 1) % 3, (axis + 2) % 3];
    separate(segments, across, DEPTH, false, &mut parts);
    parts.iter().flat_map(|part| fan(part, axis)).collect()
}

/// Splits segments where a line across one of two axes goes between them, until none does; gives up, which only covers more,
/// after `depth` splits within each other. `stuck`: the other axis has just been tried.
fn separate(
    mut segments: Vec<Segment>,
    [u, v]: [usize; 2],
    depth: usize,
    stuck: bool,
    parts: &mut Vec<Vec<Segment>>,
) {
    let low = |s: &Segment| s[0][u].min(s[1][u]);
    let high = |s: &Segment| s[0][u].max(s[1][u]);
    segments.sort_by(|s, t| low(s).total_cmp(&low(t)));
    let size = segments
        .iter()
        .flatten()
        .map(|p| p[u].abs())
        .fold(0.0, f64::max);
    let mut groups: Vec<Vec<Segment>> = Vec::new();
    let mut reach = f64::NEG_INFINITY;
    for segment in segments {
        match groups.last_mut() {
            Some(group) if low(&segment) <= reach + APART * size => group.push(segment),
            _ => groups.push(vec![segment]),
        }
        reach = reach.max(high(&segment));
    }
    // What neither axis separates is one.
    let whole = groups.len() == 1;
    for group in groups {
        if depth == 0 || (whole && stuck) {
            parts.push(group);
        } else {
            separate(group, [v, u], depth - 1, whole, parts);
        }
    }
}

/// Triangles from one point, which makes them small, to all segments.
fn fan(segments: &[Segment], axis: usize) -> Vec<[Point3<f64>; 3]> {
    let ends: Vec<Point3<f64>> = segments.iter().flatten().copied().collect();
    let sum: nalgebra::Vector3<f64> = ends.iter().map(|p| p.coords).sum();
    let mut mean = Point3::from(sum / ends.len().max(1) as f64);
    if let Some(first) = ends.first() {
        mean[axis] = first[axis];
    }
    let some = ends
        .iter()
        .copied()
        .step_by(ends.len().div_ceil(MIDDLES).max(1));
    let area = |o: &Point3<f64>| -> f64 {
        segments
            .iter()
            .map(|[a, b]| (a - o).cross(&(b - o)).norm())
            .sum()
    };
    let middle = some.fold((area(&mean), mean), |(least, middle), o| {
        let own = area(&o);
        if own < least {
            (own, o)
        } else {
            (least, middle)
        }
    });
    segments.iter().map(|[a, b]| [middle.1, *a, *b]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_told_apart_along_either_axis() {
        let square = |y: f64, z: f64| {
            let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
                .map(|(dy, dz)| Point3::new(0.0, y + dy, z + dz));
            (0..4).map(move |i| [corners[i], corners[(i + 1) % 4]])
        };
        for (y, z, count) in [(0.0, 2.0, 2), (2.0, 0.0, 2), (2.0, 2.0, 2), (0.5, 0.5, 1)] {
            let segments: Vec<Segment> = square(0.0, 0.0).chain(square(y, z)).collect();
            let mut parts = Vec::new();
            separate(segments, [1, 2], DEPTH, false, &mut parts);
            assert_eq!(parts.len(), count, "{y} {z}");
        }
    }

    #[test]
    fn what_bounds_one_side_of_a_plane_fills_no_other() {
        // Walls from the plane x = 0 up, and none below it.
        let [a, b, c] = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(y, z)| [y, z]);
        let wall = |[p, q]: [[f64; 2]; 2]| {
            let at = |x: f64, p: [f64; 2]| Point3::new(x, p[0], p[1]);
            [
                [at(0.0, p), at(0.0, q), at(1.0, q)],
                [at(0.0, p), at(1.0, q), at(1.0, p)],
            ]
        };
        let walls: Vec<_> = [[a, b], [b, c], [c, a]]
            .into_iter()
            .flat_map(wall)
            .collect();
        assert!(filled(&walls, 0, 0.0, -1.0).is_empty());
        assert!(!filled(&walls, 0, 0.0, 1.0).is_empty());
    }
}

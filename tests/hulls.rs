//! Convex hulls of any points: they hold all, need every vertex, close, and do not depend on the order.

use std::sync::Arc;

use proptest::prelude::*;
use undulate::nalgebra::{Point3, Vector3};
use undulate::{Hull, Shape};

/// Points of every sort that trips hulls: random; on a grid (many in one plane, on one line, equal); on a sphere in 4-byte
/// numbers (almost in one plane); nearly flat.
fn points() -> impl Strategy<Value = Vec<Point3<f64>>> {
    let free = prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 1..120);
    let grid = prop::collection::vec(prop::array::uniform3(-2..3_i32), 1..120)
        .prop_map(|points| points.into_iter().map(|p| p.map(f64::from)).collect());
    let round =
        prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 1..120).prop_map(|points| {
            let on = |p: [f64; 3]| {
                let p = Vector3::from(p);
                <[f64; 3]>::from(p / p.norm().max(1e-3)).map(|x| f64::from(x as f32))
            };
            points.into_iter().map(on).collect()
        });
    let thin = (free.clone(), -60..0_i32).prop_map(|(points, power): (Vec<[f64; 3]>, i32)| {
        let squash = 2f64.powi(power);
        // Tilted, so that rounding roughens the plane.
        let tilt = |[x, y, z]: [f64; 3]| [x + 0.3 * y, y - 0.7 * x, 0.1 * x + 0.9 * y + squash * z];
        points.into_iter().map(tilt).collect()
    });
    prop_oneof![free, grid, round, thin]
        .prop_map(|points: Vec<[f64; 3]>| points.into_iter().map(Point3::from).collect())
}

fn support(points: &[Point3<f64>], direction: &Vector3<f64>) -> f64 {
    points
        .iter()
        .map(|p| p.coords.dot(direction))
        .fold(f64::NEG_INFINITY, f64::max)
}

fn directions() -> Vec<Vector3<f64>> {
    let golden = 2.399_963_229_728_653_f64;
    (0..200)
        .map(|i| {
            let z = (f64::from(i) + 0.5) / 100.0 - 1.0;
            let (r, turn) = ((1.0 - z * z).sqrt(), golden * f64::from(i));
            Vector3::new(r * turn.cos(), r * turn.sin(), z)
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(400) })]

    #[test]
    fn hulls_hold_all_points_and_need_every_vertex(points in points()) {
        let hull = Hull::new(&points).unwrap();
        prop_assert_eq!(hull.tolerance(), 0.0);
        prop_assert!(hull.vertices().iter().all(|v| points.contains(v)));
        for direction in directions() {
            // The same products are compared, so nothing is rounded differently.
            prop_assert_eq!(support(hull.vertices(), &direction), support(&points, &direction));
        }
        // Every face has all points below; what rounding may say otherwise is less than 1e-15.
        for face in hull.faces() {
            let [a, b, c] = face.map(|i| hull.vertices()[i as usize]);
            let normal = (b - a).cross(&(c - a));
            for p in &points {
                prop_assert!(normal.dot(&(p - a)) <= 2e-14, "{}", normal.dot(&(p - a)));
            }
        }
        // Nor is any beyond a plane, and there no rounding says otherwise.
        for (normal, offset) in hull.planes() {
            prop_assert!(points.iter().all(|p| normal.dot(&p.coords) <= offset));
        }
        // Without any one vertex the hull is another.
        for v in hull.vertices().iter().filter(|_| hull.vertices().len() > 1) {
            let others: Vec<_> = hull.vertices().iter().filter(|u| *u != v).copied().collect();
            let smaller = Hull::new(&others).unwrap();
            prop_assert_eq!(smaller.vertices().len(), others.len());
        }
    }

    #[test]
    fn surfaces_close(points in points()) {
        let hull = Hull::new(&points).unwrap();
        let mut edges: Vec<[u32; 2]> = hull.faces().iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
        edges.sort();
        let count = edges.len();
        edges.dedup();
        prop_assert_eq!(edges.len(), count, "an edge is passed twice in one direction");
        prop_assert!(edges.iter().all(|[a, b]| edges.binary_search(&[*b, *a]).is_ok()));
        if !hull.faces().is_empty() {
            prop_assert_eq!(hull.vertices().len() + hull.faces().len(), count / 2 + 2);
        }
        prop_assert!(hull.is_flat() == (hull.volume() == 0.0) || hull.volume().abs() < 1e-15);
    }

    #[test]
    fn order_does_not_matter(points in points(), turn in 0..120_usize) {
        let mut other = points.clone();
        let turn = turn % points.len();
        other.rotate_left(turn);
        other.reverse();
        other.extend_from_slice(&points[..turn]);
        prop_assert_eq!(Hull::new(&points).unwrap(), Hull::new(&other).unwrap());
    }

    #[test]
    fn balls_and_capsules_hold_all_and_are_small(points in points()) {
        let hull = Hull::new(&points).unwrap();
        let shape = Shape::Hull(Arc::new(hull));
        let (centre, radius) = shape.bounding_sphere();
        let far = points.iter().map(|p| (p - centre).norm()).fold(0.0, f64::max);
        prop_assert!(far <= radius && radius <= far * (1.0 + 1e-12));
        // No ball of less than half the diameter, and none larger than Jung's is needed.
        let diameter = points.iter().flat_map(|p| points.iter().map(move |q| (p - q).norm())).fold(0.0, f64::max);
        prop_assert!(radius >= 0.5 * diameter);
        prop_assert!(radius <= diameter * (3.0_f64 / 8.0).sqrt() * (1.0 + 1e-9));
        // Nothing nearer is a better centre.
        for direction in directions() {
            let moved = centre + 1e-3 * radius * direction;
            let there = points.iter().map(|p| (p - moved).norm()).fold(0.0, f64::max);
            prop_assert!(there >= radius * (1.0 - 1e-9));
        }
        let (a, b, radius) = shape.bounding_capsule();
        for p in &points {
            let along = b - a;
            let t = if a == b { 0.0 } else { ((p - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0) };
            prop_assert!((p - (a + t * along)).norm() <= radius);
        }
        prop_assert!(shape.radius() >= points.iter().map(|p| p.coords.norm()).fold(0.0, f64::max));
    }
}

/// Rims, corners and caps lie in the bounds, and reach them.
#[test]
fn bounds_of_primitives_hold_them_and_fit() {
    let (radius, length) = (0.3, 0.8);
    let half_extents = Vector3::new(0.2, 0.7, 0.4);
    let round = |z: f64, r: f64| {
        let turn = (0..64).map(|i| f64::from(i) * std::f64::consts::TAU / 64.0);
        turn.map(move |a| Point3::new(r * a.cos(), r * a.sin(), z))
            .collect::<Vec<_>>()
    };
    let corners = directions()
        .iter()
        .map(|d| d.map(f64::signum).component_mul(&half_extents).into())
        .collect();
    let caps = [
        round(0.4, radius),
        round(-0.4, radius),
        vec![Point3::new(0.0, 0.0, 0.7)],
    ]
    .concat();
    let shapes: [(Shape, Vec<Point3<f64>>); 4] = [
        (Shape::Box { half_extents }, corners),
        (Shape::Sphere { radius }, round(0.0, radius)),
        (
            Shape::Cylinder { radius, length },
            [round(0.4, radius), round(-0.4, radius)].concat(),
        ),
        (Shape::Capsule { radius, length }, caps),
    ];
    for (shape, points) in shapes {
        let (centre, sphere) = shape.bounding_sphere();
        let far = points
            .iter()
            .map(|p| (p - centre).norm())
            .fold(0.0, f64::max);
        assert!(
            far <= sphere * (1.0 + 1e-15) && sphere < far * (1.0 + 1e-12),
            "{shape:?}"
        );
        assert_eq!(shape.radius(), sphere);
        let (a, b, capsule) = shape.bounding_capsule();
        let off = |p: &Point3<f64>| {
            let along = b - a;
            let t = if a == b {
                0.0
            } else {
                ((p - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0)
            };
            (p - (a + t * along)).norm()
        };
        let far = points.iter().map(off).fold(0.0, f64::max);
        // The points are rounded too.
        assert!((far - capsule).abs() < 1e-15, "{shape:?} {far} {capsule}");
    }
}

/// Two corners close to each other, opposite to a third: the equations for the centre are nearly the same twice.
#[test]
fn balls_of_thin_triangles_are_small() {
    let far = Point3::new(-0.6389593100002349, 1.5647564309547095, 0.7395849575457081);
    let near = [
        Point3::new(0.5331622386397317, -1.5258812184813113, -0.7754613436956757),
        Point3::new(0.4594652070666392, -1.5298692015697974, -0.822790581989259),
    ];
    let hull = Hull::new(&[near[0], far, near[1]]).unwrap();
    // a b c / (4 area).
    let sides = [near[0] - far, near[1] - far, near[1] - near[0]];
    let product: f64 = sides.iter().map(Vector3::norm).product();
    let circumscribed = product / (2.0 * sides[0].cross(&sides[1]).norm());
    assert!((hull.bounding_sphere().1 - circumscribed).abs() < 1e-12);
}

/// A kite whose front is two slivers: only a small triangle at the back tells how it lies.
#[test]
fn the_rim_of_a_polygon_faces_outward() {
    let small = 2f64.powi(-44);
    let corners = [[-small; 3], [0.0, 0.0, -small], [1.0, 1.0, 0.0], [0.0; 3]];
    let hull = Hull::new(&corners.map(Point3::from)).unwrap();
    assert!(hull.is_flat());
    assert_eq!(hull.planes().len(), 2 + corners.len());
    for (normal, offset) in hull.planes() {
        let heights = corners.map(|p| normal.dot(&Vector3::from(p)) - offset);
        let highest = heights.into_iter().fold(f64::MIN, f64::max);
        assert!((-1e-12..=0.0).contains(&highest), "{normal}: {highest:e}");
    }
}

#[test]
fn a_cube_of_many_points_is_a_cube() {
    let axis = || (0..=6).map(f64::from);
    let points: Vec<_> = axis()
        .flat_map(|x| axis().flat_map(move |y| axis().map(move |z| Point3::new(x, y, z))))
        .collect();
    let hull = Hull::new(&points).unwrap();
    assert_eq!((hull.vertices().len(), hull.faces().len()), (8, 12));
    assert_eq!(hull.volume(), 216.0);
    assert_eq!(hull.planes().len(), 12);
    let (centre, radius) = hull.bounding_sphere();
    assert!((centre - Point3::new(3.0, 3.0, 3.0)).norm() < 1e-12);
    assert!((radius - 27f64.sqrt()).abs() < 1e-12);
}

#[test]
fn fewer_dimensions_are_flat_hulls() {
    let at = |x: f64, y: f64| Point3::new(x, y, 2.0 * x - 3.0 * y);
    let square: Vec<_> = (0..5)
        .flat_map(|x| (0..5).map(move |y| at(f64::from(x), f64::from(y))))
        .collect();
    let segment: Vec<_> = (0..5).map(|i| at(f64::from(i), f64::from(i))).collect();
    for (points, vertices, faces) in [
        (&square[..], 4, 4),
        (&square[..1], 1, 0),
        (&segment[..], 2, 0),
        (&[square[0], square[1], square[7]], 3, 2),
    ] {
        let hull = Hull::new(points).unwrap();
        assert_eq!(
            (hull.vertices().len(), hull.faces().len()),
            (vertices, faces)
        );
        assert!(hull.is_flat() && hull.volume() == 0.0);
    }
    assert!(Hull::new(&[]).is_err());
    for bad in [f64::NAN, f64::INFINITY, 2e6] {
        let error = Hull::new(&[Point3::origin(), Point3::new(0.0, bad, 0.0)])
            .err()
            .unwrap();
        assert!(error.to_string().starts_with("point 2: "), "{error}");
    }
}

#[test]
fn what_is_too_small_to_see_is_told() {
    let points = [
        [0.0; 3],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1e-40],
    ]
    .map(Point3::from);
    let hull = Hull::new(&points).unwrap();
    assert!(hull.is_flat());
    assert!((1e-40..1e-29).contains(&hull.tolerance()));
}

/// Long cylinders of many sides have thousands of points almost in one plane.
#[test]
fn capsules_fit_long_bodies() {
    let turned = |x: f64| {
        (0..500).map(move |i| {
            let a = f64::from(i) * std::f64::consts::TAU / 500.0;
            let p = Vector3::new(x, 0.1 * a.cos(), 0.1 * a.sin());
            let axis = Vector3::new(1.0, 2.0, 3.0).normalize();
            Point3::from(undulate::nalgebra::Rotation3::new(0.9 * axis) * p)
                .map(|x| f64::from(x as f32))
        })
    };
    let points: Vec<_> = turned(-0.5).chain(turned(0.7)).collect();
    let hull = Hull::new(&points).unwrap();
    assert!((hull.volume() / (1.2 * 0.01 * std::f64::consts::PI) - 1.0).abs() < 1e-3);
    let (a, b, radius) = hull.bounding_capsule();
    assert!(radius < 0.11, "{radius}");
    assert!(((b - a).norm() - 1.2).abs() < 0.1);
}

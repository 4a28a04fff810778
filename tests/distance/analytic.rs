//! Closed forms.

use rand::RngExt;
use undulate::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use undulate::{Convex, HalfSpace, Placement, Shape, Warm, separation, signed_distance, stream};

use crate::EXACT;
use crate::double_double::DoubleDouble;

fn at(x: f64, y: f64, z: f64) -> Isometry3<f64> {
    Isometry3::translation(x, y, z)
}

fn distance(a: &Shape, b: &Shape, pose: Isometry3<f64>) -> f64 {
    let home = Isometry3::identity();
    let [a, b] = [a, b].map(|shape| Convex::new(shape, &home).unwrap());
    let (at_a, at_b) = (Placement::identity(), Placement::from(&pose));
    signed_distance(a.at(&at_a), b.at(&at_b), &mut Warm::default()).distance
}

fn assert_near(found: f64, expected: f64) {
    assert!((found - expected).abs() < EXACT, "{found:e} {expected:e}");
}

#[test]
fn round_shapes_are_as_far_apart_as_their_axes_say() {
    let sphere = |radius| Shape::Sphere { radius };
    let capsule = |radius, length| Shape::Capsule { radius, length };
    let cylinder = |radius, length| Shape::Cylinder { radius, length };
    assert_near(distance(&sphere(0.1), &sphere(0.2), at(0.3, 0.4, 0.0)), 0.2);
    // Concentric.
    assert_near(
        distance(&sphere(0.1), &sphere(0.2), at(0.0, 0.0, 0.0)),
        -0.3,
    );
    assert_near(
        distance(&sphere(0.1), &capsule(0.05, 0.4), at(0.3, 0.0, 0.1)),
        0.15,
    );
    assert_near(
        distance(&sphere(0.1), &capsule(0.05, 0.4), at(0.3, 0.0, 0.6)),
        0.5 - 0.15,
    );
    // Crossing at right angles.
    let across =
        at(0.0, 0.25, 0.05) * Isometry3::rotation(Vector3::y() * std::f64::consts::FRAC_PI_2);
    assert_near(
        distance(&capsule(0.05, 0.4), &capsule(0.02, 0.3), across),
        0.18,
    );
    // A sphere beside a cylinder, above its rim, and at its centre: out through the cap or the wall, what is nearer.
    assert_near(
        distance(&cylinder(0.3, 0.4), &sphere(0.1), at(0.5, 0.0, 0.1)),
        0.1,
    );
    assert_near(
        distance(&cylinder(0.3, 0.4), &sphere(0.1), at(0.36, 0.48, 0.6)),
        0.5 - 0.1,
    );
    assert_near(
        distance(&cylinder(0.3, 0.4), &sphere(0.1), at(0.0, 0.0, 0.0)),
        -0.3,
    );
    assert_near(
        distance(&cylinder(0.1, 0.4), &sphere(0.1), at(0.0, 0.0, 0.0)),
        -0.2,
    );
    assert_near(
        distance(&cylinder(0.1, 0.4), &sphere(0.1), at(0.03, 0.04, 0.0)),
        -0.15,
    );
    // Cylinders side by side, and overlapping by 1 cm.
    assert_near(
        distance(
            &cylinder(0.1, 0.4),
            &cylinder(0.2, 0.3),
            at(0.36, 0.48, 0.1),
        ),
        0.3,
    );
    assert_near(
        distance(
            &cylinder(0.1, 0.4),
            &cylinder(0.2, 0.3),
            at(0.174, 0.232, 0.1),
        ),
        -0.01,
    );
    let cube = Shape::Box {
        half_extents: Vector3::repeat(0.1),
    };
    // Face, edge and corner of a cube.
    assert_near(distance(&cube, &sphere(0.05), at(0.3, 0.0, 0.02)), 0.15);
    assert_near(
        distance(&cube, &sphere(0.05), at(0.4, 0.5, 0.02)),
        0.5 - 0.05,
    );
    assert_near(
        distance(&cube, &sphere(0.05), at(0.3, 0.3, 0.2)),
        0.3 - 0.05,
    );
    assert_near(distance(&cube, &cube, at(0.15, 0.02, 0.03)), -0.05);
    assert_near(distance(&cube, &cube, at(0.0, 0.0, 0.0)), -0.2);
}

#[test]
fn half_spaces_are_as_far_as_the_lowest_point() {
    let table = HalfSpace::new(Vector3::new(0.0, 0.0, 3.0), 0.1).unwrap();
    let cube = Shape::Box {
        half_extents: Vector3::new(0.1, 0.2, 0.3),
    };
    let shapes = [
        (cube, 0.3),
        (Shape::Sphere { radius: 0.2 }, 0.2),
        (
            Shape::Cylinder {
                radius: 0.1,
                length: 0.5,
            },
            0.25,
        ),
    ];
    for (shape, down) in shapes {
        let convex = Convex::new(&shape, &Isometry3::identity()).unwrap();
        for height in [1.0, 0.4, 0.1, -0.3] {
            let placement = Placement::from(&at(0.4, 0.2, height));
            let found = table.signed_distance(convex.at(&placement));
            let expected = height - down - 0.1;
            assert_near(found.distance, expected);
            assert_near(
                (found.points[1] - found.points[0]).dot(&found.normal),
                expected,
            );
            let between = table.separation(convex.at(&placement));
            assert!(between.lower < expected && expected < between.upper);
            assert!(between.upper - between.lower < 1e-12);
        }
    }
    for normal in [
        Vector3::zeros(),
        Vector3::repeat(f64::NAN),
        Vector3::repeat(f64::INFINITY),
    ] {
        assert!(HalfSpace::new(normal, 0.0).is_err());
    }
    assert!(HalfSpace::new(Vector3::z(), f64::NAN).is_err());
    // Squares that vanish and squares that overflow.
    for length in [1e-200, 1e200] {
        assert_near(
            HalfSpace::new(Vector3::z() * length, 0.0)
                .unwrap()
                .normal()
                .z,
            1.0,
        );
    }
}

/// The distance of two points of bodies, with twice the digits.
fn exact(p: [&Vector3<f64>; 2], at: [&Placement; 2]) -> DoubleDouble {
    let number = DoubleDouble::from;
    let world = |i: usize, row: usize| {
        let turned = (0..3).map(|k| number(at[i].rotation[(row, k)]) * number(p[i][k]));
        turned.sum::<DoubleDouble>() + number(at[i].translation[row])
    };
    let ways = (0..3).map(|row| world(1, row) - world(0, row));
    ways.map(|way| way * way).sum::<DoubleDouble>().sqrt()
}

/// Lower bounds are below distances that are known to twice the digits; without the slack some would not be, so a slack
/// that is forgotten, or of the wrong sign, is found out.
#[test]
fn lower_bounds_are_below_distances_known_exactly() {
    let mut random = stream(11, 0);
    let mut above_without = 0;
    for _ in 0..2000 {
        let mut vector = |size: f64| Vector3::from_fn(|_, _| size * random.random_range(-1.0..1.0));
        let points = [vector(0.3), vector(0.3)];
        // Not by the closed form of segments: three points in one place.
        let [a, b] = points.map(|p| Convex::from_points(&[Point3::from(p); 3], 0.0).unwrap());
        let [at_a, at_b] = [0; 2].map(|_| {
            let turn = UnitQuaternion::from_scaled_axis(vector(3.0));
            Placement::from(&Isometry3::from_parts(vector(1.0).into(), turn))
        });
        let exact = exact([&points[0], &points[1]], [&at_a, &at_b]);
        let mut warm = Warm::default();
        for _ in 0..2 {
            // Cold, by a walk; and by the plane that this has left.
            let found = separation(a.at(&at_a), b.at(&at_b), &mut warm, exact.rounded() - 1e-9);
            let below = (exact - DoubleDouble::from(found.lower)).rounded();
            assert!((0.0..1e-12).contains(&below), "{below:e}");
            // The bounds of a warm plane have no upper one to tell the slack by.
            if found.upper.is_finite() {
                let middle = f64::midpoint(found.lower, found.upper);
                let without = (exact - DoubleDouble::from(middle)).rounded();
                above_without += usize::from(without < 0.0);
            }
        }
    }
    assert!(above_without > 200, "{above_without}");
}

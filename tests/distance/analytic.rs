//! Closed forms.

use undulate::nalgebra::{Isometry3, Point3, Vector3};
use undulate::{Convex, HalfSpace, Placement, Shape, Warm, separation, signed_distance};

use crate::EXACT;

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
    let across = at(0.0, 0.25, 0.05)
        * Isometry3::rotation(Vector3::x() * 0.0)
        * Isometry3::rotation(Vector3::y() * std::f64::consts::FRAC_PI_2);
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

/// A slack of the wrong sign is found out: cubes whose gap is a sum of powers of two, which no rounding touches.
#[test]
fn lower_bounds_are_below_distances_known_exactly() {
    let corners = |x: f64| {
        let corners: [Point3<f64>; 8] = std::array::from_fn(|i| {
            let at = |axis: usize| (i >> axis & 1) as f64;
            Point3::new(x + at(0), at(1), at(2))
        });
        Convex::from_points(&corners, 0.0).unwrap()
    };
    let (a, b) = (corners(0.0), corners(0.0));
    let (home, mut wrong) = (Placement::identity(), 0);
    for power in 1..40 {
        let gap = (-f64::from(power)).exp2();
        let away = Placement {
            translation: Vector3::new(1.0 + gap, 0.0, 0.0),
            ..home
        };
        let found = separation(a.at(&home), b.at(&away), &mut Warm::default(), gap * 0.5);
        assert!(
            found.lower < gap && found.lower > gap - 1e-12,
            "{gap:e} {found:?}"
        );
        // With the slack added instead.
        wrong += usize::from(found.lower + 2.0 * (gap - found.lower) <= gap);
    }
    assert_eq!(wrong, 0);
}

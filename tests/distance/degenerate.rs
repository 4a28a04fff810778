//! Shapes and poses that are hardly any.

use undulate::nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use undulate::{
    Convex, HalfSpace, Placement, Shape, Warm, intersects, rough_separation, separation,
    signed_distance,
};

fn hulls() -> Vec<Convex> {
    let points = |coordinates: &[[f64; 3]]| {
        let points: Vec<Point3<f64>> = coordinates.iter().map(|p| Point3::from(*p)).collect();
        Convex::from_points(&points, 0.0).unwrap()
    };
    let shape = |shape: Shape| Convex::new(&shape, &Isometry3::identity()).unwrap();
    vec![
        points(&[[0.0; 3]]),
        points(&[[0.0; 3]; 20]),
        points(&[[0.0, 0.0, -1e-3], [0.0, 0.0, 1e-3]]),
        points(&[[0.0; 3], [0.1, 0.0, 0.0], [0.2, 0.0, 0.0], [0.3, 0.0, 0.0]]),
        points(&[
            [-1.0, -1.0, 0.0],
            [1.0, -1.0, 0.0],
            [1.0, 1.0, 0.0],
            [-1.0, 1.0, 0.0],
        ]),
        points(&[
            [0.0, 0.0, 0.0],
            [1e-12, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1e-300],
        ]),
        points(&[
            [1e-160, 0.0, 0.0],
            [0.0, 1e-160, 0.0],
            [0.0, 0.0, 1e-160],
            [0.0; 3],
        ]),
        points(&[
            [1e12, 0.0, 0.0],
            [0.0, 1e12, 0.0],
            [0.0, 0.0, 1e12],
            [-1e12, 0.0, 0.0],
        ]),
        shape(Shape::Sphere { radius: 0.0 }),
        shape(Shape::Capsule {
            radius: 0.0,
            length: 0.0,
        }),
        shape(Shape::Cylinder {
            radius: 0.0,
            length: 0.0,
        }),
        shape(Shape::Cylinder {
            radius: 0.1,
            length: 0.0,
        }),
        shape(Shape::Cylinder {
            radius: 0.0,
            length: 0.1,
        }),
        shape(Shape::Box {
            half_extents: Vector3::zeros(),
        }),
        shape(Shape::Box {
            half_extents: Vector3::new(0.1, 0.0, 0.1),
        }),
    ]
}

#[test]
fn nothing_of_no_size_or_far_away_gives_other_than_numbers() {
    let home = Placement::identity();
    for a in &hulls() {
        for b in &hulls() {
            for away in [0.0, 1e-300, 1e-16, 1e-3, 1.0, 1e6, 1e12] {
                let at = Placement {
                    translation: Vector3::new(0.6, 0.0, 0.8) * away,
                    ..home
                };
                let (p, q) = (a.at(&home), b.at(&at));
                let mut warm = Warm::default();
                let found = signed_distance(p, q, &mut warm);
                let reach = a.reach() + b.reach();
                let rounding = 1e-9f64.max(1e-12 * (away + reach));
                assert!(found.distance.is_finite(), "{a:?} {b:?} {away}");
                assert!(found.distance <= away + reach + rounding);
                assert!(found.distance >= away - reach - rounding);
                assert!((found.normal.norm() - 1.0).abs() < 1e-12);
                assert!(
                    found
                        .points
                        .iter()
                        .flat_map(|p| p.iter())
                        .all(|x| x.is_finite())
                );
                for threshold in [f64::NEG_INFINITY, -1.0, 0.0, 1.0, f64::INFINITY, f64::NAN] {
                    let between = separation(p, q, &mut warm, threshold);
                    assert!(
                        between.lower <= found.distance + rounding,
                        "{between:?} {found:?}"
                    );
                    assert!(
                        between.upper >= found.distance - rounding,
                        "{between:?} {found:?}"
                    );
                }
                assert!(
                    rough_separation(p, q, &mut Warm::default(), 0.0) <= found.distance + rounding
                );
                if found.distance > rounding {
                    assert!(!intersects(p, q, &mut warm), "{a:?} {b:?} {away}");
                }
            }
        }
    }
}

#[test]
fn two_flat_shapes_in_one_plane_are_no_deep() {
    let square = Convex::from_points(
        &[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| Point3::new(x, y, 0.3)),
        0.0,
    )
    .unwrap();
    let home = Placement::identity();
    let moved = Placement {
        translation: Vector3::new(0.5, 0.2, 0.0),
        ..home
    };
    let found = signed_distance(square.at(&home), square.at(&moved), &mut Warm::default());
    assert!(
        found.distance.abs() < 1e-9 && found.normal.z.abs() > 0.999_999,
        "{found:?}"
    );
}

#[test]
fn placements_that_are_no_numbers_are_never_clear() {
    let home = Placement::identity();
    let table = HalfSpace::new(Vector3::z(), 0.0).unwrap();
    let mut broken = Vec::new();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for i in 0..3 {
            let mut translation = Vector3::zeros();
            translation[i] = bad;
            broken.push(Placement {
                translation,
                ..home
            });
            for j in 0..3 {
                let mut rotation = Matrix3::identity();
                rotation[(i, j)] = bad;
                broken.push(Placement { rotation, ..home });
            }
        }
    }
    for a in &hulls() {
        for b in &hulls() {
            let mut known = Warm::default();
            signed_distance(a.at(&home), b.at(&home), &mut known);
            for at in &broken {
                for (p, q) in [(a.at(&home), b.at(at)), (a.at(at), b.at(&home))] {
                    for mut warm in [Warm::default(), known.clone()] {
                        assert_eq!(separation(p, q, &mut warm, 0.0).lower, f64::NEG_INFINITY);
                        assert!(intersects(p, q, &mut warm));
                        let found = signed_distance(p, q, &mut warm);
                        assert_eq!(found.distance, f64::NEG_INFINITY);
                    }
                    assert!(rough_separation(p, q, &mut Warm::default(), 0.0) <= 0.0);
                }
                assert!(table.separation(a.at(at)).lower <= 0.0);
                assert!(table.signed_distance(a.at(at)).distance <= 0.0);
            }
        }
    }
}

#[test]
fn what_is_no_shape_is_refused() {
    let home = Isometry3::identity();
    assert!(Convex::from_points(&[], 0.0).is_err());
    for bad in [f64::NAN, f64::INFINITY, -1e13, 1e13] {
        assert!(Convex::from_points(&[Point3::new(0.0, bad, 0.0)], 0.0).is_err());
        assert!(Convex::from_points(&[Point3::origin()], bad).is_err());
        let shapes = [
            Shape::Sphere { radius: bad },
            Shape::Capsule {
                radius: 0.1,
                length: bad,
            },
            Shape::Cylinder {
                radius: bad,
                length: 0.1,
            },
            Shape::Cylinder {
                radius: 0.1,
                length: bad,
            },
            Shape::Box {
                half_extents: Vector3::new(0.1, bad, 0.1),
            },
        ];
        for shape in shapes {
            assert!(Convex::new(&shape, &home).is_err(), "{shape:?}");
        }
    }
}

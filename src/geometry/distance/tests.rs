//! The same bits from vectors of every width, and scans that see every vertex.

use fearless_simd::{Level, Simd, dispatch};
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};

use super::*;
use crate::geometry::{Convex, Placement, Shape};

/// The vectors of every processor that this one can stand in for.
fn levels() -> Vec<Level> {
    let best = Level::new();
    let mut levels = vec![Level::baseline(), best];
    #[cfg(target_arch = "x86_64")]
    levels.extend(
        [
            best.as_sse4_2().map(Simd::level),
            best.as_avx2().map(Simd::level),
        ]
        .into_iter()
        .flatten(),
    );
    levels
}

/// Numbers of no pattern, from -1 to 1.
fn number(i: usize) -> f64 {
    libm::sin(1.7 * (i * i) as f64 + 0.3)
}

fn vector(i: usize) -> Vector3<f64> {
    Vector3::new(number(3 * i), number(3 * i + 1), number(3 * i + 2))
}

fn hull(count: usize, seed: usize) -> Convex {
    let points: Vec<Point3<f64>> = (0..count)
        .map(|i| Point3::from(vector(seed + i) * 0.3))
        .collect();
    Convex::from_points(&points, 0.0).unwrap()
}

fn convexes() -> Vec<Convex> {
    let cylinder = Shape::Cylinder {
        radius: 0.2,
        length: 0.5,
    };
    let mut convexes: Vec<Convex> = [1, 2, 3, 7, 8, 9, 16, 17, 100, 220]
        .iter()
        .map(|count| hull(*count, 1000 * count))
        .collect();
    convexes.push(Convex::new(&cylinder, &Isometry3::identity()).unwrap());
    convexes
}

fn placement(i: usize, away: f64) -> Placement {
    let turn = UnitQuaternion::from_scaled_axis(vector(i) * 2.0);
    Placement::from(&Isometry3::from_parts((vector(i + 1) * away).into(), turn))
}

#[test]
fn scans_find_the_first_of_the_highest_vertices() {
    for count in (1..40).chain([220]) {
        let points: Vec<Vector3<f64>> = (0..count)
            // Every other one twice, so that some are equally high.
            .map(|i| vector(i / 2))
            .collect();
        let shape = hull_of(&points);
        for i in 0..50 {
            let u = vector(7000 + i).normalize();
            let highest = points
                .iter()
                .map(|p| dot(&u, p))
                .fold(f64::NEG_INFINITY, f64::max);
            let first = points.iter().position(|p| dot(&u, p) == highest).unwrap();
            for level in levels() {
                let found = dispatch!(level, simd => shape.core().farthest(simd, &u));
                assert_eq!(found.index as usize, first, "{count} {u:?}");
                assert_eq!(found.point, points[first]);
                let height = dispatch!(level, simd => shape.core().height(simd, &u));
                assert_eq!(
                    [found.height, height].map(f64::to_bits),
                    [highest.to_bits(); 2]
                );
            }
        }
    }
}

fn hull_of(points: &[Vector3<f64>]) -> Convex {
    let points: Vec<Point3<f64>> = points.iter().map(|p| Point3::from(*p)).collect();
    Convex::from_points(&points, 0.0).unwrap()
}

#[test]
fn vectors_of_every_width_give_the_same_bits() {
    let convexes = convexes();
    let mut overlapping = 0;
    for (i, a) in convexes.iter().enumerate() {
        for (j, b) in convexes.iter().enumerate() {
            for away in [0.1, 0.5, 2.0] {
                let (at_a, at_b) = (placement(i, away), placement(50 + j, away));
                let (a, b) = (a.at(&at_a), b.at(&at_b));
                let answers = |level: Level| {
                    let mut warm = Warm::default();
                    let found =
                        dispatch!(level, simd => signed_distance_with(simd, a, b, &mut warm));
                    let between =
                        dispatch!(level, simd => separation_with(simd, a, b, &mut warm, 0.0));
                    let mut bits = vec![found.distance, between.lower, between.upper];
                    bits.extend(found.normal.iter());
                    bits.extend(found.points.iter().flat_map(|p| p.iter()));
                    let bits: Vec<u64> = bits.into_iter().map(f64::to_bits).collect();
                    (found.distance, bits, warm)
                };
                let expected = answers(Level::baseline());
                overlapping += usize::from(expected.0 < 0.0);
                for level in levels() {
                    assert_eq!(answers(level), expected, "{i} {j} {away}");
                }
            }
        }
    }
    assert!(overlapping > 50, "{overlapping}");
}

/// Directions are unit vectors to rounding, whatever they come from, and what belongs to another pair does no harm.
#[test]
fn what_is_remembered_is_sound_with_any_other_pair() {
    let convexes = convexes();
    let mut warm = Warm::default();
    for i in 0..convexes.len() {
        for j in 0..convexes.len() {
            let (at_a, at_b) = (placement(j, 0.8), placement(90 + i, 0.8));
            let (a, b) = (convexes[i].at(&at_a), convexes[j].at(&at_b));
            let expected = signed_distance(a, b, &mut Warm::default()).distance;
            let lower = separation(a, b, &mut warm.clone(), expected - 1e-3).lower;
            assert!(lower <= expected + 1e-12, "{lower:e} {expected:e}");
            let found = signed_distance(a, b, &mut warm).distance;
            assert!((found - expected).abs() < 1e-9, "{found:e} {expected:e}");
            assert!((warm.direction.norm() - 1.0).abs() < 4.0 * f64::EPSILON);
        }
    }
}

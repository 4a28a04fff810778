//! What an answer about two shapes says of itself, held against the shapes' own formulas.

use proptest::prelude::*;
use proptest::test_runner::TestCaseError;
use rand::RngExt;
use undulate::{Warm, intersects, rough_separation, separation, signed_distance, stream};

use super::drawn::{Case, Drawn, V, from_triangles};

/// What distances are right to \[m\].
pub const EXACT: f64 = 1e-9;

/// What nearest points are right to \[m\]: of round shapes of a metre, distances that are 1e-12 m apart have points that
/// are 1e-6 m apart.
const POINTS: f64 = 1e-5;

pub fn near(what: &str, found: f64, expected: f64, tolerance: f64) -> Result<(), TestCaseError> {
    prop_assert!(
        (found - expected).abs() <= tolerance,
        "{}: {:e}, expected {:e}",
        what,
        found,
        expected
    );
    Ok(())
}

/// What the answer says of itself must hold by the shapes' own formulas. Returns the signed distance \[m\].
pub fn bracket(case: &Case) -> Result<f64, TestCaseError> {
    let [a, b] = [0, 1].map(|i| case.shapes[i].convex());
    let [at_a, at_b] = case.placements();
    let (a, b) = (a.at(&at_a), b.at(&at_b));
    let mut warm = Warm::default();
    let found = signed_distance(a, b, &mut warm);
    let distance = found.distance;
    // No plane's value is more than the signed distance, so it is no less than this.
    near("normal's length", found.normal.norm(), 1.0, 1e-12)?;
    near("plane", case.plane(&found.normal), distance, EXACT)?;
    // And no more, as these points are in the shapes.
    let way = found.points[1] - found.points[0];
    near("points", way.dot(&found.normal), distance, EXACT)?;
    near(
        "points across",
        (way - found.normal * distance).norm(),
        0.0,
        POINTS,
    )?;
    for i in 0..2 {
        let own = case.poses[i]
            .inverse_transform_point(&found.points[i])
            .coords;
        let outside = match (&case.shapes[i], case.shapes[i].parry()) {
            (Drawn::Points(points), Some(hull)) => {
                let point = parry3d::math::Vector::new(own.x, own.y, own.z);
                let beyond = hull.distance_to_local_point(point, true);
                // Of points that nearly coincide parry keeps one, and its hull is smaller by as much.
                if beyond > EXACT {
                    from_triangles(points, &own)
                } else {
                    beyond
                }
            }
            (shape, _) => shape.outside(&own),
        };
        prop_assert!(outside <= EXACT, "point {} is {:e} outside", i, outside);
    }
    if distance < 0.0 {
        // No other direction parts them sooner: all over the sphere, and close to the one found.
        let mut random = stream(7, 0);
        for i in 0..400 {
            let spread = if i % 4 == 0 {
                10.0
            } else {
                10f64.powf(-6.0 * random.random::<f64>())
            };
            let side = V::from_fn(|_, _| random.random_range(-1.0..1.0));
            let u = (found.normal + side * spread).normalize();
            prop_assert!(
                case.plane(&u) <= distance + EXACT,
                "less deep along {:?}",
                u
            );
        }
    }

    // Bounds, and what they decide.
    for threshold in [distance - 1e-6, distance + 1e-6, 0.0] {
        for mut warm in [Warm::default(), warm.clone()] {
            let between = separation(a, b, &mut warm, threshold);
            // Overlaps are known to what the polytope's bounds agree to.
            prop_assert!(
                between.lower <= distance + EXACT,
                "lower {:e} of {:e}",
                between.lower,
                distance
            );
            prop_assert!(
                between.upper >= distance - EXACT,
                "upper {:e} of {:e}",
                between.upper,
                distance
            );
            if distance > 1e-5 {
                prop_assert_eq!(between.lower > threshold, distance > threshold);
            }
            if distance.abs() > EXACT {
                prop_assert_eq!(intersects(a, b, &mut warm), distance < 0.0);
            }
        }
    }
    prop_assert!(rough_separation(a, b, &mut Warm::default(), f64::INFINITY) <= distance + EXACT);
    near(
        "other way round",
        signed_distance(b, a, &mut Warm::default()).distance,
        distance,
        EXACT,
    )?;
    near(
        "again",
        signed_distance(a, b, &mut warm).distance,
        distance,
        EXACT,
    )?;
    Ok(distance)
}

//! Signed distance against everything else that can tell it: brackets that each answer carries, all features of small
//! polytopes, parry, Coal, and closed forms.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/double_double.rs"]
mod double_double;

mod analytic;
mod brute;
mod coal;
mod degenerate;
mod drawn;

use std::cell::Cell;

use drawn::{Case, Drawn, V};
use parry3d::query;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed, TestCaseError, TestRunner};
use rand::RngExt;
use undulate::{Warm, intersects, rough_separation, separation, signed_distance, stream};

/// What distances are right to \[m\].
const EXACT: f64 = 1e-9;

/// What nearest points are right to \[m\]: of round shapes of a metre, distances that are 1e-12 m apart have points that
/// are 1e-6 m apart.
const POINTS: f64 = 1e-5;

/// Drawn by `UNDULATE_CASES` times as many, if that is set.
fn runner(cases: u32) -> TestRunner {
    let times = std::env::var("UNDULATE_CASES").map_or(1, |times| times.parse().unwrap());
    TestRunner::new(Config {
        cases: cases * times,
        rng_seed: RngSeed::Fixed(4),
        failure_persistence: None,
        ..Config::default()
    })
}

fn near(what: &str, found: f64, expected: f64, tolerance: f64) -> Result<(), TestCaseError> {
    prop_assert!(
        (found - expected).abs() <= tolerance,
        "{}: {:e}, expected {:e}",
        what,
        found,
        expected
    );
    Ok(())
}

/// What the answer says of itself must hold by the shapes' own formulas.
fn bracket(case: &Case) -> Result<f64, TestCaseError> {
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
            (Drawn::Points(_), Some(hull)) => {
                let point = parry3d::math::Vector::new(own.x, own.y, own.z);
                hull.distance_to_local_point(point, true)
            }
            (shape, _) => shape.outside(&own).unwrap_or(0.0),
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

#[test]
fn answers_hold_by_the_shapes_own_formulas_and_agree_with_parry() {
    let (compared, off) = (Cell::new(0), Cell::new(0));
    runner(2000)
        .run(&drawn::cases(drawn::every_kind), |case| {
            // What holds by its own bracket is right to 1e-9 m, whatever parry says.
            let distance = bracket(&case)?;
            let (Some(a), Some(b)) = (case.shapes[0].parry(), case.shapes[1].parry()) else {
                return Ok(());
            };
            let [at_a, at_b] = [0, 1].map(|i| drawn::pose(&case.poses[i]));
            let parry = if distance > 0.0 {
                query::distance(&at_a, &*a, &at_b, &*b)
                    .ok()
                    .map(|d| d.distance)
            } else {
                let contact = query::contact(&at_a, &*a, &at_b, &*b, 0.0);
                contact.ok().flatten().map(|c| c.dist)
            };
            compared.set(compared.get() + 1);
            if parry.is_none_or(|parry| (parry - distance).abs() > EXACT) {
                off.set(off.get() + 1);
            }
            Ok(())
        })
        .unwrap();
    let (compared, off) = (compared.get(), off.get());
    println!(
        "parry is more than {EXACT} m off in {off} of {compared} cases that hold by their brackets"
    );
    assert!(compared > 500 && off < compared / 5, "{off} of {compared}");
}

#[test]
fn small_polytopes_agree_with_all_their_features() {
    runner(2000)
        .run(&drawn::cases(drawn::small), |case| {
            let distance = bracket(&case)?;
            let [a, b] = case.corners().unwrap();
            near(
                "all features",
                distance,
                brute::signed_distance(&a, &b),
                EXACT,
            )
        })
        .unwrap();
}

/// The judges must be able to say no: hulls that miss a corner are found out.
#[test]
fn a_support_that_misses_a_corner_is_caught() {
    let caught = Cell::new(0);
    runner(200)
        .run(&drawn::cases(drawn::small), |case| {
            let [a, b] = case.corners().unwrap();
            let mut broken = case.clone();
            for shape in &mut broken.shapes {
                let mut corners = shape.corners().unwrap();
                if corners.len() > 1 {
                    corners.pop();
                }
                *shape = Drawn::Points(corners);
            }
            let [p, q] = [0, 1].map(|i| broken.shapes[i].convex());
            let [at_p, at_q] = broken.placements();
            let found = signed_distance(p.at(&at_p), q.at(&at_q), &mut Warm::default());
            let is_wrong = (found.distance - brute::signed_distance(&a, &b)).abs() > EXACT;
            caught.set(caught.get() + u32::from(is_wrong));
            Ok(())
        })
        .unwrap();
    assert!(caught.get() > 20, "{}", caught.get());
}

//! Signed distance against everything else that can tell it: brackets that each answer carries, all features of small
//! polytopes, parry, Coal, and closed forms.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/double_double.rs"]
mod double_double;

mod analytic;
mod bracket;
mod brute;
mod coal;
mod degenerate;
mod drawn;

use std::cell::Cell;

use bracket::{EXACT, bracket, near};
use drawn::Drawn;
use parry3d::query;
use proptest::test_runner::{Config, RngSeed, TestRunner};
use undulate::{Warm, signed_distance};

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

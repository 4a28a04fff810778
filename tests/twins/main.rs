//! Broken twins: small implementations of what the library does, each with one fault. An assertion that the sound one passes, and with it the library,
//! catches the broken one: what these assertions cannot see is not tested at all.

#[path = "../posterior/broken.rs"]
mod broken;
mod collision;
mod fourier;
#[path = "../common/halved.rs"]
mod halved;
mod motion;
mod robots;
mod statistics;

use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use undulate::testing::Family;

/// Passed, or what was noticed.
type Verdict = Result<(), String>;

/// What is wrong, and the assertion: of the twin if `true`, of the sound implementation if not.
type Twin = (&'static str, fn(bool) -> Verdict);

/// Of the samplers in `broken`.
type Target = fn(&[f64], &mut [f64]) -> f64;

/// One false alarm of all statistical assertions in a million runs.
const FAMILY: Family = Family::new(1e-6, 64);

const SEED: u64 = 40;

/// Whether a property holds for what a strategy draws; always the same cases.
fn for_all<S: Strategy>(
    strategy: S,
    property: impl Fn(S::Value) -> Result<(), TestCaseError>,
) -> Verdict {
    let config = Config {
        cases: 256,
        failure_persistence: None,
        ..Config::default()
    };
    let outcome = TestRunner::new_with_rng(config, TestRunner::deterministic().new_rng())
        .run(&strategy, property)
        .map_err(|e| e.to_string());
    outcome.map_err(|e| e.lines().next().unwrap_or_default().to_owned())
}

fn near(what: &str, found: f64, expected: f64) -> Result<(), TestCaseError> {
    let is_near = (found - expected).abs() <= 1e-9 * (1.0 + expected.abs());
    prop_assert!(is_near, "{what}: {found} for {expected}");
    Ok(())
}

#[test]
fn every_twin_is_caught_and_no_sound_one() {
    let fields: [&[Twin]; 5] = [
        &fourier::TWINS,
        &statistics::TWINS,
        &robots::TWINS,
        &collision::TWINS,
        &motion::TWINS,
    ];
    let twins: Vec<&Twin> = fields.into_iter().flatten().collect();
    assert!(twins.len() >= 40, "{}", twins.len());
    let mut wrong = Vec::new();
    for (name, check) in &twins {
        if let Err(alarm) = check(false) {
            wrong.push(format!("the sound one of `{name}` is not passed: {alarm}"));
        }
        match check(true) {
            Ok(()) => wrong.push(format!("`{name}` is not caught")),
            Err(caught) => println!("{name}: {caught}"),
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

//! What is refused, and with what words.

use nalgebra::DVector;
use undulate::posterior::{Draws, EllipticalSlice, Hamiltonian, HamiltonianOptions, Schedule, run};
use undulate::{ErrorKind, Result, stream};

use crate::{Target, elliptical, hamiltonian, linear};

#[test]
fn what_cannot_be_sampled_is_refused_with_a_reason() {
    let refused = |target: Target| {
        let of = |result: Result<Draws>| {
            let error = result.unwrap_err();
            (error.kind(), error.to_string())
        };
        let schedule = Schedule::default();
        let slices = of(run(&mut elliptical(2, target), &schedule, |c| stream(8, c)));
        let trajectories = of(run(&mut hamiltonian(2, target), &schedule, |c| {
            stream(8, c)
        }));
        (slices, trajectories)
    };
    let (slices, trajectories) = refused(|_, _| f64::NEG_INFINITY);
    assert_eq!(slices, trajectories);
    assert_eq!(slices.0, ErrorKind::Infeasible);
    assert_eq!(
        slices.1,
        "chain 0, start: impossible: none of 1000 draws of the prior has positive likelihood; widen the conditions, or give log-likelihoods that say how far off a draw is"
    );
    let (slices, trajectories) = refused(|_, _| f64::NAN);
    assert_eq!(slices, trajectories);
    assert_eq!(
        slices,
        (
            ErrorKind::Value,
            "chain 0, start: log-likelihood is NaN, expected a finite number, or -inf for what is impossible".to_owned()
        )
    );
    let (slices, trajectories) = refused(|_, _| f64::INFINITY);
    assert_eq!(slices, trajectories);
    assert!(slices.1.contains("log-likelihood is inf"), "{}", slices.1);
    let (_, trajectories) = refused(|z, gradient| {
        gradient.fill(0.0);
        gradient[1] = if z[0] > 1.0 { f64::NAN } else { 0.0 };
        if z[0] > 1.5 { f64::NAN } else { 0.0 }
    });
    assert!(
        trajectories
            .1
            .contains("gradient of the log-likelihood is NaN in dimension 1")
            || trajectories.1.contains("log-likelihood is NaN"),
        "{}",
        trajectories.1
    );

    // Another value at each call.
    let mut calls = 0.0;
    let mut falling = EllipticalSlice::new(1, |_: &DVector<f64>| {
        calls -= 100.0;
        calls
    });
    let error = run(&mut falling, &Schedule::default(), |c| stream(8, c)).unwrap_err();
    assert!(
        error.to_string().contains("expected the same value"),
        "{error}"
    );
}

#[test]
fn settings_out_of_range_are_refused() {
    let refused = |schedule: Schedule| {
        let error = run(&mut elliptical(6, linear), &schedule, |c| stream(8, c)).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Setting);
        error.to_string()
    };
    let default = Schedule::default;
    assert_eq!(
        refused(Schedule {
            chains: 3,
            ..default()
        }),
        "3 chains, expected at least 4"
    );
    assert_eq!(
        refused(Schedule {
            draws: 3,
            ..default()
        }),
        "3 draws a chain, expected at least 4"
    );
    assert_eq!(
        refused(Schedule {
            thinning: 0,
            ..default()
        }),
        "0 transitions a draw, expected at least 1"
    );
    assert!(
        refused(Schedule {
            draws: 1 << 40,
            ..default()
        })
        .contains("thin the chains")
    );
    for change in [
        |o: &mut HamiltonianOptions| o.angle = f64::NAN,
        |o: &mut HamiltonianOptions| o.jitter = 1.0,
        |o: &mut HamiltonianOptions| o.acceptance = 0.0,
        |o: &mut HamiltonianOptions| o.most_steps = 0,
    ] {
        let mut options = Default::default();
        change(&mut options);
        let error = Hamiltonian::new(6, linear)
            .with_options(options)
            .map(|_| ())
            .unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Setting);
    }
}

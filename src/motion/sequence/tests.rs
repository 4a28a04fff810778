//! Sequences against the states of their legs.

use super::*;
use crate::motion::{LANES, StartPosture, Tube, TubeRows, Waypoint, Waypoints};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

fn joints() -> Joints {
    Joints::new(["a", "b"]).unwrap()
}

fn wave() -> Wave {
    let weights = DMatrix::from_fn(2, 3, |d, k| {
        Complex::from_polar(0.2 / (k + 1) as f64, (d + 2 * k) as f64)
    });
    Wave::new(joints(), 1.3, DVector::from_vec(vec![0.3, -0.2]), weights).unwrap()
}

fn passage(from: &State, to: &State, duration: f64) -> Spline {
    let point = |time, state: &State| {
        let rows = [&state.position, &state.velocity, &state.acceleration];
        (time, rows.map(|r| r.as_slice().to_vec()))
    };
    let points = [point(0.0, from), point(duration, to)];
    let waypoints = Waypoints::new(
        joints(),
        points.iter().map(|(time, [q, v, a])| Waypoint {
            time: *time,
            positions: q,
            velocities: Some(v),
            accelerations: Some(a),
        }),
    );
    Spline::new(&waypoints.unwrap(), StartPosture::Given).unwrap()
}

#[test]
fn extremes_of_a_leg_are_those_of_the_part_that_is_waved() {
    let wave = wave();
    for (from, duration) in [(0.0, 0.3), (0.4, 0.2), (0.9, 0.5), (1.2, 1.1), (0.7, 3.0)] {
        let leg = Leg::Wave {
            wave: wave.clone(),
            from,
            duration,
        };
        for joint in 0..2 {
            for derivative in [Derivative::Position, Derivative::Velocity] {
                let values = (0..=4000).map(|n| {
                    let state = wave.state(from + duration * f64::from(n) / 4000.0);
                    match derivative {
                        Derivative::Position => state.position[joint],
                        _ => state.velocity[joint],
                    }
                });
                let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |s, x| {
                    (s.0.min(x), s.1.max(x))
                });
                let range = leg.extremes(joint, derivative).range;
                assert!(
                    range.lower <= low && range.lower > low - 1e-4,
                    "{range:?}, {low}"
                );
                assert!(
                    range.upper >= high && range.upper < high + 1e-4,
                    "{range:?}, {high}"
                );
            }
        }
    }
}

fn sequence() -> Sequence {
    let wave = wave();
    let rest = State::zeros(2);
    Sequence::new(vec![
        Leg::Move(passage(&rest, &wave.state(0.4), 0.8)),
        Leg::Wave {
            wave: wave.clone(),
            from: 0.4,
            duration: 2.5,
        },
        Leg::Move(passage(&wave.state(2.9), &rest, 0.9)),
    ])
    .unwrap()
}

#[test]
fn a_tube_contains_the_sequence_across_its_joins() {
    let sequence = sequence();
    let mut tube = sequence.tube();
    let mut rows = TubeRows::new(2);
    let mut state = State::zeros(2);
    for n in 0..400 {
        let middles: [f64; LANES] =
            std::array::from_fn(|lane| 0.0105 * f64::from(n) + 0.01 * lane as f64);
        let half = [0.3 / f64::from(1 << (n % 9)); LANES];
        tube.over_lanes(&middles, &half, &mut rows);
        for lane in 0..LANES {
            for i in 0..=10 {
                let t = middles[lane] + half[lane] * (f64::from(i) / 5.0 - 1.0);
                sequence.state_into(t, &mut state);
                for joint in 0..2 {
                    let off = state.position[joint] - rows.position[joint][lane];
                    assert!(off.abs() <= rows.radius[joint][lane], "{n} {lane} {t}");
                    let ahead = rows.velocity[joint][lane] * (t - middles[lane]);
                    let is_within = (0.0..=sequence.duration()).contains(&t);
                    assert!(!is_within || (off - ahead).abs() <= rows.bend[joint][lane]);
                }
            }
        }
    }
}

#[test]
fn extremes_are_those_of_a_fine_grid() {
    let sequence = sequence();
    let mut state = State::zeros(2);
    for derivative in [
        Derivative::Position,
        Derivative::Velocity,
        Derivative::Acceleration,
    ] {
        for joint in 0..2 {
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for n in 0..=42_000 {
                sequence.state_into(1e-4 * f64::from(n), &mut state);
                let value = match derivative {
                    Derivative::Position => state.position[joint],
                    Derivative::Velocity => state.velocity[joint],
                    _ => state.acceleration[joint],
                };
                (low, high) = (low.min(value), high.max(value));
            }
            let found = sequence.extremes(joint, derivative);
            let size = 1e-4 * (high - low);
            assert!(found.range.lower <= low && found.range.lower > low - size);
            assert!(found.range.upper >= high && found.range.upper < high + size);
            sequence.state_into(found.upper_time, &mut state);
            assert!((0.0..=sequence.duration()).contains(&found.upper_time));
        }
    }
}

#[test]
fn pieces_cover_the_sequence() {
    let sequence = sequence();
    let mut pieces = Vec::new();
    sequence.tube().pieces(&mut pieces);
    let mut end = 0.0;
    for (middle, half) in pieces {
        assert!((middle - half - end).abs() < 1e-14);
        end = middle + half;
    }
    assert!((end - sequence.duration()).abs() < 1e-13);
}

#[test]
fn legs_that_do_not_meet_are_refused() {
    let wave = wave();
    let rest = State::zeros(2);
    let leg = |from: f64, duration: f64| Leg::Wave {
        wave: wave.clone(),
        from,
        duration,
    };
    let raise = || Leg::Move(passage(&rest, &wave.state(0.4), 0.8));
    let refused = |legs: Vec<Leg>, expected: &str| {
        let error = Sequence::new(legs).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    };
    refused(vec![], "nothing");
    refused(vec![raise(), leg(0.41, 1.0)], "leg 2: the position");
    refused(vec![raise(), leg(0.4, f64::NAN)], "a duration of NaN");
    refused(vec![raise(), leg(0.4, 1e12)], "a wave for 1000000000000 s");
    assert!(Sequence::new(vec![raise(), leg(0.4, 1.0)]).is_ok());
}

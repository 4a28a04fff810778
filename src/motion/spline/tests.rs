//! Splines against a second implementation, dense sampling, and twins broken on purpose.

use proptest::prelude::*;

use super::*;
use crate::motion::Tube;

/// Waypoints of two joints with their times, positions, velocities, accelerations and how many of them are given.
#[derive(Debug, Clone)]
struct Table {
    times: Vec<f64>,
    rows: Vec<[[f64; 2]; 3]>,
    given: Vec<usize>,
}

impl Table {
    fn waypoints(&self) -> Waypoints {
        let rows = self.rows.iter().zip(&self.times).zip(&self.given);
        Waypoints::new(
            Joints::new(["a", "b"]).unwrap(),
            rows.map(|((row, time), given)| Waypoint {
                time: *time,
                positions: &row[0],
                velocities: (*given > 0).then_some(&row[1]),
                accelerations: (*given > 1).then_some(&row[2]),
            }),
        )
        .unwrap()
    }

    fn spline(&self) -> Spline {
        Spline::new(&self.waypoints(), StartPosture::Given).unwrap()
    }

    /// The position by Hermite's basis polynomials, in the form of textbooks: none of it is in the sources.
    fn position(&self, joint: usize, t: f64) -> f64 {
        let t = t.clamp(0.0, *self.times.last().unwrap());
        let s = self
            .times
            .partition_point(|x| *x <= t)
            .clamp(1, self.times.len() - 1)
            - 1;
        let length = self.times[s + 1] - self.times[s];
        let u = (t - self.times[s]) / length;
        let [a, b] = [s, s + 1].map(|i| self.rows[i].map(|row| row[joint]));
        match self.given[s].min(self.given[s + 1]) {
            0 => (1.0 - u) * a[0] + u * b[0],
            1 => {
                (1.0 + 2.0 * u) * (1.0 - u).powi(2) * a[0]
                    + u * (1.0 - u).powi(2) * length * a[1]
                    + u * u * (3.0 - 2.0 * u) * b[0]
                    + u * u * (u - 1.0) * length * b[1]
            }
            _ => {
                let v = 1.0 - u;
                let ends = |x: f64, y: f64, from: [f64; 3], sign: f64| {
                    y.powi(3)
                        * ((1.0 + 3.0 * x + 6.0 * x * x) * from[0]
                            + sign * x * (1.0 + 3.0 * x) * length * from[1]
                            + 0.5 * x * x * length * length * from[2])
                };
                ends(u, v, a, 1.0) + ends(v, u, b, -1.0)
            }
        }
    }
}

fn table() -> impl Strategy<Value = Table> {
    let number = || -1.5..1.5_f64;
    let row = proptest::array::uniform3(proptest::array::uniform2(number()));
    proptest::collection::vec((0.05..1.0_f64, row, 0..3_usize), 2..9).prop_map(|rows| {
        let mut times = vec![0.0];
        for (gap, _, _) in &rows[1..] {
            times.push(times[times.len() - 1] + gap);
        }
        Table {
            times,
            rows: rows.iter().map(|r| r.1).collect(),
            given: rows.iter().map(|r| r.2).collect(),
        }
    })
}

/// The same move there and back in the end, so that it can repeat.
fn closed(mut table: Table) -> Table {
    table.times.push(table.times.last().unwrap() + 0.3);
    table.rows.push(table.rows[0]);
    table.given.push(table.given[0]);
    table
}

/// By how much the truth leaves an enclosure, on 200 instants of the interval.
fn escape(
    truth: impl Fn(usize, f64) -> f64,
    (middle, half): (f64, f64),
    position: &[f64],
    radius: &[f64],
) -> f64 {
    (0..=200)
        .map(|i| middle + half * (f64::from(i) / 100.0 - 1.0))
        .flat_map(|t| [0, 1].map(|j| (truth(j, t) - position[j]).abs() - radius[j]))
        .fold(f64::NEG_INFINITY, f64::max)
}

proptest! {
    #[test]
    fn positions_are_those_of_hermite_s_basis(table in table()) {
        let spline = table.spline();
        let mut state = State::zeros(2);
        for i in -10..=110 {
            let t = spline.duration() * f64::from(i) / 100.0;
            spline.state_into(t, &mut state);
            for j in 0..2 {
                prop_assert!((state.position[j] - table.position(j, t)).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn velocities_to_jerks_are_differences_of_the_derivative_before(table in table(), s in 0..8_usize) {
        let spline = table.spline();
        let s = s % spline.degrees().len();
        let (start, length) = (spline.knots()[s], spline.length(s));
        let mut at = [State::zeros(2), State::zeros(2), State::zeros(2)];
        let h = 1e-4 * length;
        for i in 1..10 {
            let t = start + length * f64::from(i) / 10.0;
            for (state, shift) in at.iter_mut().zip([-h, 0.0, h]) {
                spline.state_into(t + shift, state);
            }
            let [before, now, after] = &at;
            for j in 0..2 {
                for (low, middle, high, scale) in [
                    (before.position[j], now.velocity[j], after.position[j], 1.0),
                    (before.velocity[j], now.acceleration[j], after.velocity[j], length),
                    (before.acceleration[j], now.jerk[j], after.acceleration[j], length * length),
                ] {
                    // Fifth powers over a ten-thousandth: h^2 / 6 of what 60 of 30 make.
                    let difference = (high - low) / (2.0 * h);
                    prop_assert!((difference - middle).abs() * scale * length < 1e-4);
                }
            }
        }
    }

    #[test]
    fn no_instant_leaves_the_tube(
        table in table(),
        repeats: bool,
        middle in -0.2..1.2_f64,
        width in 0.0..9.0_f64,
    ) {
        let table = if repeats { closed(table) } else { table };
        let spline = if repeats { table.spline().repeated().unwrap() } else { table.spline() };
        let duration = spline.duration();
        let interval = (middle * duration, duration * 10.0_f64.powf(-width));
        let mut tube = spline.tube();
        let (mut position, mut radius) = ([0.0; 2], [0.0; 2]);
        tube.over(interval.0, interval.1, &mut position, &mut radius);
        let truth = |j: usize, t: f64| {
            table.position(j, if repeats { t.rem_euclid(duration) } else { t })
        };
        let escape = escape(truth, interval, &position, &radius);
        // What the truth itself loses here.
        prop_assert!(escape < 1e-13, "{escape:e}");
        // Nor is the tube much wider than the motion is at its fastest.
        for (j, radius) in radius.iter().enumerate() {
            let speed = spline.range(j, Derivative::Velocity).magnitude();
            prop_assert!(*radius <= 40.0 * (speed * interval.1 + 1e-12));
            prop_assert!(*radius <= 2.5 * spline.range(j, Derivative::Position).width() + 1e-12);
        }
    }

    #[test]
    fn ranges_hold_and_are_reached_at_their_times(table in table()) {
        let spline = table.spline();
        let mut state = State::zeros(2);
        for derivative in
            [Derivative::Position, Derivative::Velocity, Derivative::Acceleration, Derivative::Jerk]
        {
            let all: Vec<Extremes> = (0..2).map(|j| spline.extremes(j, derivative)).collect();
            let value = |state: &State, j: usize| match derivative {
                Derivative::Position => state.position[j],
                Derivative::Velocity => state.velocity[j],
                Derivative::Acceleration => state.acceleration[j],
                Derivative::Jerk => state.jerk[j],
            };
            for (j, e) in all.iter().enumerate() {
                for i in 0..=3000 {
                    spline.state_into(spline.duration() * (f64::from(i) / 3000.0), &mut state);
                    prop_assert!(e.range.contains(value(&state, j)));
                }
                if e.range.magnitude().is_infinite() {
                    let velocity = spline.jump(j, Derivative::Velocity);
                    prop_assert!(derivative.order() >= 2);
                    prop_assert!(velocity.is_some() || derivative == Derivative::Jerk);
                    continue;
                }
                for (end, time) in [(e.range.lower, e.lower_time), (e.range.upper, e.upper_time)] {
                    // From either side: at a knot the later segment answers.
                    let near = [-1e-9, 0.0, 1e-9].map(|shift| {
                        spline.state_into((time + shift).clamp(0.0, spline.duration()), &mut state);
                        (value(&state, j) - end).abs()
                    });
                    let scale = e.range.magnitude() + 1.0;
                    let found = near.into_iter().fold(f64::INFINITY, f64::min);
                    prop_assert!(found < 1e-4 * scale, "{derivative:?}: {found:e} at {time}");
                }
            }
        }
    }
}

fn ease() -> Table {
    Table {
        times: vec![0.0, 1.0, 2.5],
        rows: vec![
            [[0.0, 1.0], [0.0, 0.5], [0.0; 2]],
            [[1.0, 0.5], [0.4, -0.7], [0.2, 0.0]],
            [[-0.3, 0.2], [0.0; 2], [0.0; 2]],
        ],
        given: vec![1, 1, 1],
    }
}

#[test]
fn the_extremes_of_an_ease_are_the_analytic_ones() {
    // 3 u^2 - 2 u^3 over 2 s: fastest in the middle, at 3/4; accelerations from 6/4 to -6/4, at the ends.
    let table = Table {
        times: vec![0.0, 2.0],
        rows: vec![[[0.0; 2]; 3], [[1.0, -1.0], [0.0; 2], [0.0; 2]]],
        given: vec![1, 1],
    };
    let spline = table.spline();
    let velocity = spline.extremes(0, Derivative::Velocity);
    assert!((velocity.range.upper - 0.75).abs() < 1e-13 && velocity.range.upper >= 0.75);
    assert!((velocity.upper_time - 1.0).abs() < 1e-6);
    assert!(velocity.range.lower <= 0.0 && velocity.range.lower > -1e-13);
    let acceleration = spline.extremes(1, Derivative::Acceleration);
    assert!((acceleration.range.lower + 1.5).abs() < 1e-12);
    assert_eq!(
        (acceleration.lower_time, acceleration.upper_time),
        (0.0, 2.0)
    );
    // It starts and ends with a jerk that nothing leads up to.
    assert!(spline.range(0, Derivative::Jerk).magnitude().is_infinite());
    assert_eq!(spline.jump(0, Derivative::Velocity), None);
    assert_eq!(spline.jump(0, Derivative::Acceleration).unwrap().size, 1.5);
}

#[test]
fn a_tube_without_its_second_order_and_a_spline_with_a_wrong_knot_are_caught() {
    let table = ease();
    let spline = table.spline();
    let mut shifted = table.clone();
    shifted.times[1] += 1e-3;
    let (wrong, mut tube) = (shifted.spline(), spline.tube());
    let mut state = State::zeros(2);
    let (mut position, mut radius) = ([0.0; 2], [0.0; 2]);
    let (mut sound, mut first_order, mut wrong_knot) = (0, 0, 0);
    for i in 0..500 {
        let interval = (2.5 * f64::from(i) / 500.0, 0.02);
        let caught = |position: &[f64], radius: &[f64]| {
            i32::from(escape(|j, t| table.position(j, t), interval, position, radius) > 1e-13)
        };
        tube.over(interval.0, interval.1, &mut position, &mut radius);
        sound += caught(&position, &radius);
        spline.state_into(interval.0, &mut state);
        let linear: Vec<f64> = state
            .velocity
            .iter()
            .map(|v| v.abs() * interval.1)
            .collect();
        first_order += caught(&position, &linear);
        wrong
            .tube()
            .over(interval.0, interval.1, &mut position, &mut radius);
        wrong_knot += caught(&position, &radius);
    }
    assert_eq!(sound, 0);
    assert!(
        first_order > 100 && wrong_knot > 100,
        "{first_order} {wrong_knot}"
    );
}

#[test]
fn a_tube_about_a_turning_point_shrinks_with_the_square_of_the_interval() {
    let spline = ease().spline();
    let mut tube = spline.tube();
    let (mut position, mut radius) = ([0.0; 2], [0.0; 2]);
    // At 2.5 s, the end, both joints rest: what is left of |q''| h^2 / 2.
    let mut over = |h: f64| {
        tube.over(2.5, h, &mut position, &mut radius);
        radius[0]
    };
    for h in [1e-2, 1e-3, 1e-4] {
        let ratio = over(h) / over(h / 2.0);
        assert!((ratio - 4.0).abs() < 10.0 * h + 1e-4, "{ratio} at {h}");
    }
    assert!(over(0.0) < 1e-12);
    // From the end all the way back, and from the start when no instant is meant.
    assert!(over(f64::INFINITY) >= 1.3 && over(f64::NAN) >= 1.0);
}

#[test]
fn the_controller_s_rule_takes_the_highest_order_that_both_ends_have() {
    let table = Table {
        times: vec![0.0, 1.0, 2.0, 3.0, 4.0],
        rows: vec![[[0.0, 0.1]; 3]; 5],
        given: vec![2, 2, 1, 1, 0],
    };
    use Degree::{Cubic, Linear, Quintic};
    assert_eq!(table.spline().degrees(), [Quintic, Cubic, Cubic, Linear]);
}

#[test]
fn a_line_jumps_where_it_bends_and_where_it_begins() {
    let line = |positions: &[f64]| Table {
        times: (0..positions.len()).map(|i| i as f64 * 0.1).collect(),
        rows: positions
            .iter()
            .map(|q| [[*q, 0.7], [0.0; 2], [0.0; 2]])
            .collect(),
        given: vec![0; positions.len()],
    };
    // Straight on to rounding between the ends, so the larger jumps are there, from and to rest.
    let spline = line(&[0.0, 0.1, 0.2, 0.3]).spline();
    let jump = spline.jump(0, Derivative::Velocity).unwrap();
    assert!((jump.size - 1.0).abs() < 1e-12 && jump.time == 0.0);
    assert_eq!(spline.jump(1, Derivative::Velocity), None);
    assert_eq!(spline.range(1, Derivative::Acceleration).magnitude(), 0.0);
    assert!(
        spline
            .range(0, Derivative::Acceleration)
            .magnitude()
            .is_infinite()
    );

    let bent = line(&[0.0, 0.1, -0.1, 0.0]).spline();
    let e = bent.extremes(0, Derivative::Acceleration);
    assert!(e.range.magnitude().is_infinite());
    assert!((e.upper_time - 0.1).abs() < 1e-15 && (e.lower_time - 0.1).abs() < 1e-15);
    // Begun anew, it goes on as it ended; only the bends are left.
    let size = bent
        .repeated()
        .unwrap()
        .jump(0, Derivative::Velocity)
        .unwrap()
        .size;
    assert!((size + 3.0).abs() < 1e-12, "{size}");
    // Straight on for ever but for the waypoints' rounding: no jump at all.
    assert!(
        line(&[0.3, 0.3, 0.3])
            .spline()
            .repeated()
            .unwrap()
            .jump(0, Derivative::Velocity)
            .is_none()
    );
}

#[test]
fn where_the_robot_starts_must_be_known_and_true() {
    let mut late = ease();
    for t in &mut late.times {
        *t += 0.5;
    }
    let reason =
        |table: &Table, start| Spline::new(&table.waypoints(), start).unwrap_err().reason();
    use StartPosture::{At, AtFirstWaypoint, Given};
    assert_eq!(reason(&late, Given), Some(Reason::StartUnknown));
    assert_eq!(reason(&late, At(&[0.0])), Some(Reason::WrongSize));
    assert_eq!(reason(&late, At(&[0.0, f64::NAN])), Some(Reason::NotFinite));
    assert_eq!(
        reason(&ease(), At(&[0.0, 1.1])),
        Some(Reason::StartElsewhere)
    );
    assert_eq!(
        reason(&ease(), At(&[f64::NAN, 1.0])),
        Some(Reason::StartElsewhere)
    );
    assert!(Spline::new(&ease().waypoints(), At(&[0.0, 1.0])).is_ok());

    let waypoints = late.waypoints();
    let held = Spline::new(&waypoints, AtFirstWaypoint).unwrap();
    // Joint `a` has no velocity there and stands; `b` has one and must swing back to get it.
    assert_eq!(held.degrees().len(), 3);
    let mut state = State::zeros(2);
    held.state_into(0.25, &mut state);
    assert_eq!(state.position[0], 0.0);
    assert!(state.position[1] < 0.99);
    let moved = Spline::new(&waypoints, At(&[0.3, 1.0])).unwrap();
    moved.state_into(0.0, &mut state);
    assert_eq!(state.position[0], 0.3);

    let mut lone = ease();
    lone.times.truncate(1);
    lone.rows.truncate(1);
    lone.given.truncate(1);
    assert_eq!(reason(&lone, Given), Some(Reason::NoDuration));
}

#[test]
fn a_move_that_does_not_close_does_not_repeat() {
    let error = ease().spline().repeated().unwrap_err();
    assert_eq!(error.reason(), Some(Reason::NotClosed));
    assert!(error.to_string().contains("joint `a`"), "{error}");
    let spline = closed(ease()).spline().repeated().unwrap();
    assert!(spline.is_periodic());
    let (mut now, mut later) = (State::zeros(2), State::zeros(2));
    spline.state_into(0.7, &mut now);
    spline.state_into(0.7 - 4.0 * spline.duration(), &mut later);
    assert!((now.position - later.position).norm() < 1e-14);
}

#[test]
fn a_start_or_end_in_motion_is_told() {
    let mut table = ease();
    table.rows[0][1][0] = 0.25;
    let notes = table.spline().notes();
    assert_eq!(notes.len(), 2, "{notes:?}"); // b starts at 0.5 as it is
    assert!(notes[0].contains("starts with joint `a` at 0.25"));
}

/// It starts at rest and ends in motion.
#[test]
fn an_end_in_motion_is_a_jump() {
    let joints = Joints::new(["a"]).unwrap();
    let at = |time, [q, v]: &[[f64; 1]; 2]| (time, *q, *v);
    let points = [at(0.0, &[[0.0], [0.0]]), at(2.0, &[[1.0], [0.5]])];
    let waypoints = points.iter().map(|(time, q, v)| Waypoint {
        time: *time,
        positions: q,
        velocities: Some(v),
        accelerations: Some(&[0.0]),
    });
    let waypoints = Waypoints::new(joints, waypoints).unwrap();
    let spline = Spline::new(&waypoints, StartPosture::Given).unwrap();
    let jump = spline.jump(0, Derivative::Velocity).unwrap();
    assert_eq!(jump.time, 2.0);
    assert!((jump.size + 0.5).abs() < 1e-12, "{jump:?}");
    assert!(spline.jump(0, Derivative::Acceleration).is_none());
}

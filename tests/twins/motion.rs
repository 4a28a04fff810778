//! Bounds of a motion, and splines.

use undulate::testing::waves;
use undulate::{
    Derivative, Interval, Joints, Motion, Spline, StartPosture, State, Wave, Waypoint, Waypoints,
};

use crate::{Twin, Verdict, for_all, near};

pub const TWINS: [Twin; 5] = [
    ("a range by samples alone", |broken| {
        encloses(|wave| match broken {
            true => {
                let at = |n: usize| wave.position(wave.period() * n as f64 / 24.0)[0];
                let samples = || (0..24).map(at);
                Interval {
                    lower: samples().fold(f64::MAX, f64::min),
                    upper: samples().fold(f64::MIN, f64::max),
                }
            }
            false => wave.range(0, Derivative::Position),
        })
    }),
    ("an amplitude for twice the modulus", |broken| {
        encloses(|wave| match broken {
            true => {
                let swing: f64 = wave.weights().iter().map(|w| w.norm()).sum();
                let middle = wave.offsets()[0];
                Interval {
                    lower: middle - swing,
                    upper: middle + swing,
                }
            }
            false => wave.range(0, Derivative::Position),
        })
    }),
    ("slopes in each other's place", |broken| {
        interpolates(|u, y, v, d| match broken {
            true => hermite(u, y, [v[1], v[0]], d),
            false => hermite(u, y, v, d),
        })
    }),
    ("slopes that are not scaled to their segment", |broken| {
        interpolates(|u, y, v, d| hermite(u, y, v, if broken { 1.0 } else { d }))
    }),
    ("a cubic for what has accelerations", |broken| {
        joins(|u, y, v, a, d| {
            // What is left of the accelerations of the cubic, by u^2 (1 - u)^3 and its mirror image.
            let [y0, y1, v0, v1] = [y[0], y[1], d * v[0], d * v[1]];
            let own = [
                6.0 * (y1 - y0) - 4.0 * v0 - 2.0 * v1,
                6.0 * (y0 - y1) + 2.0 * v0 + 4.0 * v1,
            ];
            let rest = [0, 1].map(|i| (d * d * a[i] - own[i]) / 2.0);
            let bump = |u: f64| u * u * (1.0 - u).powi(3);
            let quintic = rest[0] * bump(u) + rest[1] * bump(1.0 - u);
            hermite(u, y, v, d) + if broken { 0.0 } else { quintic }
        })
    }),
];

/// All positions of a wave are within its range.
fn encloses(range: impl Fn(&Wave) -> Interval) -> Verdict {
    for_all(waves(1..=1, 3..=6), |wave| {
        let range = range(&wave);
        for n in 0..1000 {
            let y = wave.position(wave.period() * f64::from(n) / 1000.0)[0];
            let outside = (range.lower - y).max(y - range.upper).max(0.0);
            near("outside by", outside, 0.0)?;
        }
        Ok(())
    })
}

/// Between positions and velocities at the ends of a segment of length d, at its share u.
fn hermite(u: f64, y: [f64; 2], v: [f64; 2], d: f64) -> f64 {
    let w = 1.0 - u;
    let held = w * w * (1.0 + 2.0 * u) * y[0] + u * u * (1.0 + 2.0 * w) * y[1];
    held + d * (u * w * w * v[0] - u * u * w * v[1])
}

/// A share of a segment, positions, velocities, its length.
fn interpolates(twin: impl Fn(f64, [f64; 2], [f64; 2], f64) -> f64) -> Verdict {
    segments(false, |u, y, v, _, d| twin(u, y, v, d))
}

/// The same, with accelerations before the length.
fn joins(twin: impl Fn(f64, [f64; 2], [f64; 2], [f64; 2], f64) -> f64) -> Verdict {
    segments(true, twin)
}

/// A segment of a move, as the library runs it.
fn segments(
    with_accelerations: bool,
    twin: impl Fn(f64, [f64; 2], [f64; 2], [f64; 2], f64) -> f64,
) -> Verdict {
    let pair = || [-2.0..2.0f64, -2.0..2.0f64];
    let drawn = (0.1..0.9f64, pair(), pair(), pair(), 1.5..3.0f64);
    for_all(drawn, |(u, y, v, a, d)| {
        let point = |i: usize| Waypoint {
            time: [0.0, d][i],
            positions: std::slice::from_ref(&y[i]),
            velocities: Some(std::slice::from_ref(&v[i])),
            accelerations: with_accelerations.then_some(std::slice::from_ref(&a[i])),
        };
        let waypoints = Waypoints::new(Joints::new(["joint"])?, [point(0), point(1)])?;
        let spline = Spline::new(&waypoints, StartPosture::Given)?;
        let mut state = State::zeros(1);
        spline.state_into(u * d, &mut state);
        near("a position", twin(u, y, v, a, d), state.position[0])
    })
}

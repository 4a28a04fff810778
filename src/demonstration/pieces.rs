//! A recording on even grids: its stretches without gaps and without frozen frames.

use std::f64::consts::TAU;

use nalgebra::DMatrix;

use super::Recording;

/// Grid points a second, where there are as many samples: eight a cycle of the fastest rhythm.
const RATE: f64 = 60.0;
/// Standard deviation of the smoothing \[s\]: noise of encoders and cameras goes, 3 Hz stay to five sixths.
const SMOOTHING: f64 = 0.03;
/// A step between samples is a gap when it is longer than so many usual ones, and than this \[s\].
const GAP_STEPS: f64 = 3.5;
const GAP: f64 = 0.1;
/// Frames are frozen when all joints repeat themselves exactly for so long \[s\], and so many times.
const FROZEN: f64 = 0.1;
const FROZEN_FRAMES: usize = 3;

/// A stretch of time \[s\] for which nothing is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Missing {
    pub start: f64,
    pub end: f64,
    /// Frames that repeat, and not a gap between stamps.
    pub frozen: bool,
}

/// Joints at even times, smoothed and without jumps of 2 pi.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    /// Time of the first point \[s\].
    pub start: f64,
    /// From point to point \[s\].
    pub step: f64,
    /// D x N \[rad\]: the joints of a point lie side by side.
    pub positions: DMatrix<f64>,
}

impl Piece {
    pub(super) fn time(&self, point: usize) -> f64 {
        self.start + self.step * point as f64
    }
}

/// The usual step from stamp to stamp \[s\].
pub(super) fn usual_step(recording: &Recording) -> f64 {
    let mut steps: Vec<f64> = recording.times.windows(2).map(|t| t[1] - t[0]).collect();
    let middle = steps.len() / 2;
    *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Gaps between stamps and frozen frames, by time.
pub(super) fn missing(recording: &Recording) -> Vec<Missing> {
    let times = &recording.times;
    let longest = (GAP_STEPS * usual_step(recording)).max(GAP);
    let mut found = Vec::new();
    let mut first = 0;
    for n in 1..=times.len() {
        let repeats = n < times.len()
            && (0..recording.joints.len())
                .all(|d| recording.positions[(n, d)] == recording.positions[(n - 1, d)]);
        if repeats {
            continue;
        }
        if n - 1 - first >= FROZEN_FRAMES && times[n - 1] - times[first] >= FROZEN {
            found.push(Missing {
                start: times[first],
                end: times[n - 1],
                frozen: true,
            });
        }
        if n < times.len() && times[n] - times[n - 1] > longest {
            found.push(Missing {
                start: times[n - 1],
                end: times[n],
                frozen: false,
            });
        }
        first = n;
    }
    found
}

/// The stretches between what is `missing`.
pub(super) fn pieces(recording: &Recording, missing: &[Missing]) -> Vec<Piece> {
    let times = &recording.times;
    let mut pieces = Vec::new();
    let mut first = 0;
    let mut add = |first: usize, last: usize| {
        if last > first {
            pieces.push(piece(recording, first, last));
        }
    };
    for stretch in missing {
        let last = times.partition_point(|t| *t <= stretch.start) - 1;
        add(first, last);
        first = times.partition_point(|t| *t < stretch.end);
    }
    add(first, times.len() - 1);
    pieces
}

/// Samples number `first` to `last` on an even grid.
fn piece(recording: &Recording, first: usize, last: usize) -> Piece {
    let times = &recording.times[first..=last];
    let span = times[times.len() - 1] - times[0];
    let rate = RATE.min((times.len() - 1) as f64 / span);
    let points = ((span * rate).round() as usize).max(1);
    let step = span / points as f64;
    let mut positions = DMatrix::zeros(recording.joints.len(), points + 1);
    // Samples closer than the grid leave two points, and nothing to smooth.
    let finest = SMOOTHING / step.max(1.0 / RATE);
    let passes = (2.0 * finest.powi(2)).round() as usize;
    for d in 0..recording.joints.len() {
        let mut y: Vec<f64> = recording.positions.column(d).as_slice()[first..=last].to_vec();
        unwrap(&mut y);
        let mut at = 0;
        let mut even: Vec<f64> = (0..=points)
            .map(|n| {
                let t = times[0] + step * n as f64;
                while at + 2 < times.len() && times[at + 1] <= t {
                    at += 1;
                }
                let share = ((t - times[at]) / (times[at + 1] - times[at])).clamp(0.0, 1.0);
                y[at] + share * (y[at + 1] - y[at])
            })
            .collect();
        for _ in 0..passes {
            smooth(&mut even);
        }
        for (n, y) in even.into_iter().enumerate() {
            positions[(d, n)] = y;
        }
    }
    Piece {
        start: times[0],
        step,
        positions,
    }
}

/// Takes whole turns out of every step of more than half a turn.
pub(super) fn unwrap(values: &mut [f64]) {
    let mut turns = 0.0;
    let mut before = values[0];
    for value in values.iter_mut().skip(1) {
        let step = *value - before;
        before = *value;
        turns -= (step / TAU).round();
        // What does not jump keeps its bits.
        if turns != 0.0 {
            *value += turns * TAU;
        }
    }
}

/// Binomial weights 1/4, 1/2, 1/4; the ends stay.
fn smooth(values: &mut [f64]) {
    let mut before = values[0];
    for n in 1..values.len() - 1 {
        let here = values[n];
        values[n] = 0.25 * (before + 2.0 * here + values[n + 1]);
        before = here;
    }
}

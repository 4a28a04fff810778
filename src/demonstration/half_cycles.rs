//! Turning points of a motion along one direction, and runs of regular cycles about them.

use std::ops::Range;

/// A turning point: its number among the values, and its value.
pub(super) type Turn = (usize, f64);

/// How alike the cycles of a run are.
struct Alike {
    /// Lengths, and heights, to the usual ones: within this factor.
    length: f64,
    height: f64,
    /// The drift at most.
    drift: f64,
}

/// Where a run begins and ends: raising and lowering the arm look like half a cycle, but do not come back.
const AT_ENDS: Alike = Alike {
    length: 1.4,
    height: 2.0,
    drift: 0.45,
};
/// In the middle of a run a cycle may hesitate.
const WITHIN: Alike = Alike {
    length: 1.5,
    height: 2.5,
    drift: 1.5,
};
/// Where the posture drifts all the time, a run begins and ends with no more than this times the usual drift.
const STEADIER: f64 = 1.5;
const MOST_STEADY: f64 = 0.8;
/// Turning points from which the usual is known.
const FEWEST: usize = 3;

/// A cycle about a turning point, from the one before to the one after.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cycle {
    /// In points.
    length: f64,
    /// Of the turning point above the line between those two. A line: posture may drift.
    pub height: f64,
    /// How far from where it began it ends, as a share of its height.
    drift: f64,
}

impl Alike {
    fn holds(&self, cycle: &Cycle, usual: &Cycle) -> bool {
        let like = |a: f64, b: f64, factor: f64| a <= b * factor && b <= a * factor;
        like(cycle.length, usual.length, self.length)
            && like(cycle.height, usual.height, self.height)
            && cycle.drift <= self.drift
    }
}

/// Turning points of `values`: from one to the next the motion is at least `threshold`, so that noise and small
/// hesitations are none. The last is where the motion ends.
pub(super) fn turning_points(values: impl Iterator<Item = f64>, threshold: f64) -> Vec<Turn> {
    let mut found: Vec<Turn> = Vec::new();
    let (mut lowest, mut highest) = ((0, f64::INFINITY), (0, f64::NEG_INFINITY));
    // +1 on the way up, -1 on the way down, 0 while it is not known.
    let mut sign = 0;
    for (n, y) in values.enumerate() {
        if y < lowest.1 {
            lowest = (n, y);
        }
        if y > highest.1 {
            highest = (n, y);
        }
        if sign >= 0 && highest.1 - y >= threshold {
            found.push(highest);
            sign = -1;
            lowest = (n, y);
            highest = (n, y);
        } else if sign <= 0 && y - lowest.1 >= threshold {
            found.push(lowest);
            sign = 1;
            lowest = (n, y);
            highest = (n, y);
        }
    }
    match sign {
        1 => found.push(highest),
        -1 => found.push(lowest),
        _ => {}
    }
    found
}

impl Cycle {
    /// About turning point number `i`.
    pub(super) fn about(turns: &[Turn], i: usize, drift: f64) -> Self {
        let [(a, p), (b, q), (c, r)] = [turns[i - 1], turns[i], turns[i + 1]];
        let share = (b - a) as f64 / (c - a) as f64;
        Self {
            length: (c - a) as f64,
            height: (q - p - share * (r - p)).abs(),
            drift,
        }
    }
}

/// The longest run of turning points about which the `cycles` (of all but the first and the last) are like those about the
/// points numbered `inside`, as a range that has the points at both ends too.
pub(super) fn regular(
    turns: &[Turn],
    cycles: &[Cycle],
    inside: &Range<usize>,
) -> Option<Range<usize>> {
    let looked_at: Vec<&Cycle> = turns
        .iter()
        .skip(1)
        .zip(cycles)
        .filter_map(|(turn, cycle)| inside.contains(&turn.0).then_some(cycle))
        .collect();
    if looked_at.len() < FEWEST {
        return None;
    }
    let usual = Cycle {
        length: median(looked_at.iter().map(|c| c.length).collect()),
        height: median(looked_at.iter().map(|c| c.height).collect()),
        drift: median(looked_at.iter().map(|c| c.drift).collect()),
    };
    let steady = (STEADIER * usual.drift).clamp(AT_ENDS.drift, MOST_STEADY);
    let at_ends = Alike {
        drift: steady,
        ..AT_ENDS
    };
    let mut best = 0..0;
    let mut first = 0;
    for i in 0..=cycles.len() {
        if i < cycles.len() && WITHIN.holds(&cycles[i], &usual) {
            continue;
        }
        let mut run = first..i;
        while !run.is_empty() && !at_ends.holds(&cycles[run.start], &usual) {
            run.start += 1;
        }
        while !run.is_empty() && !at_ends.holds(&cycles[run.end - 1], &usual) {
            run.end -= 1;
        }
        if run.len() > best.len() {
            best = run;
        }
        first = i + 1;
    }
    (!best.is_empty()).then_some(best.start..best.end + 2)
}

/// Twice the coefficient of variation of the cycles' lengths, that of their heights, and the median of their drifts: nearly the direction that tells noise from what
/// people do (Fisher 1936).
pub(super) fn irregularity(cycles: &[Cycle]) -> f64 {
    let variation = |of: fn(&Cycle) -> f64| {
        let count = cycles.len() as f64;
        let mean = cycles.iter().map(of).sum::<f64>() / count;
        let square = cycles.iter().map(|c| (of(c) - mean).powi(2)).sum::<f64>() / count;
        square.sqrt() / mean
    };
    2.0 * variation(|c| c.length)
        + variation(|c| c.height)
        + median(cycles.iter().map(|c| c.drift).collect())
}

pub(super) fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

//! Runs of regular cycles along the direction in which joints move most, wherever in a piece they are.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::half_cycles::{self, Cycle, Turn};
use super::pieces::Piece;
use super::rhythm::{FASTEST, SLOWEST};

/// Spans of time within which a rhythm and its direction are looked for \[s\]: three cycles of 1.5, 1, 0.7 and 0.4 Hz.
const SPANS: [f64; 4] = [2.0, 3.0, 4.5, 7.5];
/// They follow each other by this share of their length.
const HOP: f64 = 0.25;
/// Turning points are told apart by this share of the motion from peak to peak.
const HYSTERESIS: f64 = 0.3;
/// Half cycles that make a rhythm.
const FEWEST: usize = 5;
/// From peak to peak \[rad\], 2 degrees: what moves less does not wave.
const SMALLEST: f64 = 0.035;
/// What comes from noise is less regular than this, and what people do is more so.
const MOST_IRREGULAR: f64 = 0.95;
/// Two runs are one rhythm if their frequencies agree within this factor.
const ALIKE: f64 = 1.3;

/// A run of regular half cycles, from turning point to turning point, by the piece's points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Run {
    pub first: usize,
    pub last: usize,
    pub half_cycles: f64,
    /// Sum of the half cycles' heights \[rad\].
    pub path: f64,
    irregularity: f64,
}

impl Run {
    fn half_cycle(&self) -> f64 {
        (self.last - self.first) as f64 / self.half_cycles
    }

    /// Whether another run shows the same rhythm.
    fn is_like(&self, other: &Self) -> bool {
        alike(self.half_cycle(), other.half_cycle())
    }

    /// With what an overlapping run adds at either end.
    fn with(self, other: &Self) -> Self {
        let (first, last) = (self.first.min(other.first), self.last.max(other.last));
        let more = ((last - first) - (self.last - self.first)) as f64 / other.half_cycle();
        Self {
            first,
            last,
            half_cycles: self.half_cycles + more.round(),
            path: self.path + more * other.path / other.half_cycles,
            irregularity: self.irregularity,
        }
    }
}

/// Whether two frequencies, or two lengths, are those of one rhythm.
pub(super) fn alike(a: f64, b: f64) -> bool {
    a < ALIKE * b && b < ALIKE * a
}

/// The runs of a piece, by time; where spans of time show rhythms that differ, the one that moves most.
pub(super) fn runs(piece: &Piece) -> Vec<Run> {
    let points = piece.positions.ncols();
    let mut found = Vec::new();
    for span in SPANS {
        let width = ((span / piece.step).round() as usize).min(points);
        let hop = ((HOP * width as f64) as usize).max(1);
        let starts = (0..points - width).step_by(hop).chain([points - width]);
        found.extend(starts.filter_map(|first| run(piece, first, width)));
    }
    found.sort_by(|a, b| b.path.total_cmp(&a.path));
    let mut kept: Vec<Run> = Vec::new();
    for one in found {
        let (overlapping, apart): (Vec<_>, Vec<_>) = kept
            .into_iter()
            .partition(|k| k.first < one.last && one.first < k.last);
        kept = apart;
        if overlapping.iter().all(|k| k.is_like(&one)) {
            kept.push(overlapping.into_iter().fold(one, |all, k| k.with(&all)));
        } else {
            kept.extend(overlapping);
        }
    }
    // Only now: among many spans of noise some look regular, but not those that move most.
    kept.retain(|run| run.irregularity <= MOST_IRREGULAR);
    kept.sort_by_key(|run| run.first);
    kept
}

/// The longest run that a span of time shows, followed beyond it for as much again on both sides.
fn run(piece: &Piece, first: usize, width: usize) -> Option<Run> {
    let points = piece.positions.ncols();
    let (axis, size) = direction(&piece.positions, first, width)?;
    let (from, to) = (first.saturating_sub(width), (first + 2 * width).min(points));
    let along = |n: usize| -> f64 {
        let y = piece.positions.column(n);
        y.iter().zip(axis.iter()).map(|(a, b)| a * b).sum()
    };
    let turns = half_cycles::turning_points((from..to).map(along), HYSTERESIS * size);
    if turns.len() <= FEWEST {
        return None;
    }
    let cycles: Vec<Cycle> = (1..turns.len() - 1)
        .map(|i| Cycle::about(&turns, i, drift(piece, from, &turns, i)))
        .collect();
    let inside = first - from..first + width - from;
    let run = half_cycles::regular(&turns, &cycles, &inside)?;
    let count = run.len() - 1;
    let within = &cycles[run.start..run.end - 2];
    let height = within.iter().map(|c| c.height).sum::<f64>() / within.len() as f64;
    let (first, last) = (from + turns[run.start].0, from + turns[run.end - 1].0);
    let frequency = count as f64 / (2.0 * piece.step * (last - first) as f64);
    let is_rhythm =
        count >= FEWEST && height >= SMALLEST && (SLOWEST..FASTEST).contains(&frequency);
    is_rhythm.then_some(Run {
        first,
        last,
        half_cycles: count as f64,
        path: height * count as f64,
        irregularity: half_cycles::irregularity(within),
    })
}

/// How far the posture is, one cycle about turning point `i` later, from where it was, as a share of how far the turning point
/// is from both; of all joints, not only along the direction.
fn drift(piece: &Piece, from: usize, turns: &[Turn], i: usize) -> f64 {
    let [a, b, c] = [i - 1, i, i + 1].map(|i| turns[i].0);
    let [p, q, r] = [a, b, c].map(|n| piece.positions.column(from + n));
    let share = (b - a) as f64 / (c - a) as f64;
    let (mut drift, mut height) = (0.0, 0.0);
    for d in 0..p.len() {
        let way = r[d] - p[d];
        drift += way.powi(2);
        height += (q[d] - p[d] - share * way).powi(2);
    }
    (drift / height).sqrt()
}

/// The direction in which joints move most about their straight lines, and how far from peak to peak a sinusoid of that energy
/// goes.
fn direction(positions: &DMatrix<f64>, first: usize, width: usize) -> Option<(DVector<f64>, f64)> {
    let joints = positions.nrows();
    let within = positions.columns(first, width);
    let mean = within.column_mean();
    let (count, middle) = (width as f64, (width as f64 - 1.0) / 2.0);
    let mut slope = DVector::<f64>::zeros(joints);
    let mut moment = DMatrix::<f64>::zeros(joints, joints);
    for n in 0..width {
        let y = within.column(n);
        let t = n as f64 - middle;
        for i in 0..joints {
            let a = y[i] - mean[i];
            slope[i] += t * a;
            for j in 0..=i {
                moment[(i, j)] += a * (y[j] - mean[j]);
            }
        }
    }
    let spread = count * (count * count - 1.0) / 12.0;
    for i in 0..joints {
        for j in 0..=i {
            moment[(i, j)] = (moment[(i, j)] - slope[i] * slope[j] / spread) / count;
            moment[(j, i)] = moment[(i, j)];
        }
    }
    let finite = width > 1 && moment.iter().all(|m| m.is_finite());
    let eigen = finite.then(|| SymmetricEigen::new(moment))?;
    let largest = eigen.eigenvalues.imax();
    let variance = eigen.eigenvalues[largest];
    let axis = || eigen.eigenvectors.column(largest).into_owned();
    (variance > 0.0).then(|| (axis(), (8.0 * variance).sqrt()))
}

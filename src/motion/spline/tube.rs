//! The positions of a spline over intervals of time.

use super::super::Tube;
use super::{Motion, Spline};
use crate::fourier::Interval;

/// What adding and dividing times may lose, in machine epsilons of the times.
const LATE: f64 = 4.0 * f64::EPSILON;

/// What the Taylor sum of a displacement loses, in machine epsilons of the coefficients: ten operations deep with binomials
/// and powers of arguments whose sum is below 2, so 2^5 times the sum of the moduli.
const ROUNDING: f64 = 400.0 * f64::EPSILON;

/// And what the position itself loses, in machine epsilons of it.
const ABOUT: f64 = 16.0 * f64::EPSILON;

/// The positions of a spline over intervals: within one segment by Taylor's series about the middle, which is finite and so
/// needs no remainder; across knots by the same series on each part; over whole segments by a tree of their ranges.
#[derive(Debug)]
pub struct SplineTube<'a> {
    spline: &'a Spline,
    /// Where the last middle was: the next is near.
    segment: usize,
}

impl<'a> SplineTube<'a> {
    pub(super) fn new(spline: &'a Spline) -> Self {
        Self { spline, segment: 0 }
    }

    fn find(&mut self, t: f64) -> usize {
        let knots = &self.spline.knots;
        if !(knots[self.segment] <= t && t < knots[self.segment + 1]) {
            self.segment = self.spline.segment_at(t);
        }
        self.segment
    }

    /// Widens the radii so that they cover the positions from time `from` to `to`, both within 0..=duration.
    fn cover(&self, from: f64, to: f64, position: &[f64], radius: &mut [f64]) {
        let spline = self.spline;
        let (first, last) = (spline.segment_at(from), spline.segment_at(to));
        for segment in [first, last] {
            let (a, b) = (spline.local(segment, from), spline.local(segment, to));
            let (middle, half) = ((a + b) / 2.0, (b - a) / 2.0 + LATE);
            for joint in 0..position.len() {
                let piece = spline.piece(segment, joint);
                let series = piece.about(middle);
                let reach = displacement(&series, half) + loss(&piece.0);
                let hull = spline.hulls[(spline.segments() + segment) * position.len() + joint];
                widen(
                    Interval::point(series[0]).widened(reach).intersect(hull),
                    position[joint],
                    &mut radius[joint],
                );
            }
        }
        // The whole segments between them, bottom up.
        let (mut left, mut right) = (first + 1 + spline.segments(), last + spline.segments());
        while left < right {
            if left % 2 == 1 {
                self.cover_node(left, position, radius);
                left += 1;
            }
            if right % 2 == 1 {
                right -= 1;
                self.cover_node(right, position, radius);
            }
            left /= 2;
            right /= 2;
        }
    }

    fn cover_node(&self, node: usize, position: &[f64], radius: &mut [f64]) {
        let joints = position.len();
        let hulls = &self.spline.hulls[node * joints..(node + 1) * joints];
        for ((hull, position), radius) in hulls.iter().zip(position).zip(radius) {
            widen(*hull, *position, radius);
        }
    }
}

/// The sum of |b_i| h^i over i >= 1: bounds how far the polynomial goes from its value while its argument goes `h`.
fn displacement(series: &[f64; 6], h: f64) -> f64 {
    series[1..]
        .iter()
        .rev()
        .fold(0.0, |sum, b| (sum + b.abs()) * h)
}

fn loss(c: &[f64; 6]) -> f64 {
    ABOUT * c[0].abs() + ROUNDING * c[1..].iter().map(|c| c.abs()).sum::<f64>()
}

fn widen(hull: Interval, position: f64, radius: &mut f64) {
    *radius = radius.max(hull.upper - position).max(position - hull.lower);
}

/// Pieces to start from: segments, or runs of them where there are more.
const PIECES: usize = 256;

impl Tube for SplineTube<'_> {
    fn pieces(&self, pieces: &mut Vec<(f64, f64)>) {
        let knots = &self.spline.knots;
        let run = (knots.len() - 1).div_ceil(PIECES);
        for first in (0..knots.len() - 1).step_by(run) {
            let (from, to) = (knots[first], knots[(first + run).min(knots.len() - 1)]);
            pieces.push((from + (to - from) / 2.0, (to - from) / 2.0));
        }
    }

    /// A spline may do something else on every segment.
    fn smooth_pieces(&self, pieces: &mut Vec<(f64, f64)>) {
        let ends = self.spline.knots.windows(2);
        pieces.extend(ends.map(|w| (w[0] + (w[1] - w[0]) / 2.0, (w[1] - w[0]) / 2.0)));
    }

    fn over(&mut self, middle: f64, half: f64, position: &mut [f64], radius: &mut [f64]) {
        let spline = self.spline;
        let duration = spline.duration();
        // An instant that is none is any instant.
        let (middle, half) = if (middle + half).is_nan() {
            (0.0, f64::INFINITY)
        } else {
            (middle, half)
        };
        // So much wider that no rounding of a time below leaves out an instant.
        let half = half.abs() * (1.0 + LATE) + LATE * (middle.abs() + duration * f64::EPSILON);
        let (centre, from, to) = if spline.repeats {
            let centre = spline.reduced(middle);
            (centre, centre - half, centre + half)
        } else {
            let within = |t: f64| t.clamp(0.0, duration);
            (within(middle), within(middle - half), within(middle + half))
        };
        let segment = self.find(centre);
        let (start, end) = (spline.knots[segment], spline.knots[segment + 1]);
        let u = spline.local(segment, centre);
        let inside = start <= from && to <= end;
        let h = (centre - from).max(to - centre) / (end - start) * (1.0 + LATE) + LATE;
        for joint in 0..position.len() {
            let piece = spline.piece(segment, joint);
            let series = piece.about(u);
            position[joint] = series[0];
            radius[joint] = loss(&piece.0);
            if inside {
                let hull = spline.hulls[(spline.segments() + segment) * position.len() + joint];
                let within = (hull.upper - series[0]).max(series[0] - hull.lower);
                radius[joint] += displacement(&series, h).min(within);
            }
        }
        if inside {
            return;
        }
        if !spline.repeats {
            self.cover(from, to, position, radius);
        } else if 2.0 * half >= duration {
            self.cover(0.0, duration, position, radius);
        } else {
            self.cover(from.max(0.0), to.min(duration), position, radius);
            if from < 0.0 {
                self.cover((from + duration).max(0.0), duration, position, radius);
            }
            if to > duration {
                self.cover(0.0, (to - duration).min(duration), position, radius);
            }
        }
    }
}

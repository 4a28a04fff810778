//! A recording cut to its gesture, where it holds more than that.

use super::hand;
use super::recording::Recording;
use super::rhythmic_part::RhythmicPart;

/// More cycles than this outside the rhythm are something else.
const MOST_CYCLES: f64 = 2.0;
/// As are more than these, if they go this much farther from the mean posture than the rhythm does: raising and lowering.
const FEWEST_CYCLES: f64 = 0.3;
const FARTHER: f64 = 2.0;

impl Recording {
    /// The gestures in it: itself, as it is, where nothing but a rhythm is in it or where no rhythm is found; else each
    /// rhythmic part, named with its times. One that lies between something else at both ends has whole cycles.
    pub fn gestures(&self) -> Vec<Self> {
        let spans = self.spans(&hand::seen(self), &self.rhythmic_parts());
        if spans == [self.whole()] {
            return vec![self.clone()];
        }
        let cut = spans.iter().filter_map(|(start, end)| {
            let part = self.between(*start, *end).ok()?;
            Some(Self {
                name: format!("{}, {start:.2} s to {end:.2} s", self.name),
                ..part
            })
        });
        cut.collect()
    }

    fn whole(&self) -> (f64, f64) {
        (self.times[0], self.times[self.times.len() - 1])
    }

    /// From when to when \[s\] the gestures are, by what is seen of the recording and its rhythmic parts.
    pub(super) fn spans(&self, seen: &Self, parts: &[RhythmicPart]) -> Vec<(f64, f64)> {
        let (start, end) = self.whole();
        let (Some(first), Some(last)) = (parts.first(), parts.last()) else {
            return vec![(start, end)];
        };
        let lead = is_something_else(seen, first, start, first.start);
        let trail = is_something_else(seen, last, last.end, end);
        if lead && trail && parts.len() == 1 {
            let part = first.whole_cycles();
            return vec![(part.start, part.end)];
        }
        let mut from = if lead { first.start } else { start };
        let mut spans = Vec::new();
        for pair in parts.windows(2) {
            let [part, next] = pair else { continue };
            let between = |p| is_something_else(seen, p, part.end, next.start);
            if between(part) || between(next) {
                spans.push((from, part.end));
                from = next.start;
            }
        }
        spans.push((from, if trail { last.end } else { end }));
        spans
    }
}

/// Whether from `start` to `end` is more than a cycle or two that the rhythm of `part` does not hold quite so well.
fn is_something_else(seen: &Recording, part: &RhythmicPart, start: f64, end: f64) -> bool {
    let cycles = (end - start) * part.frequency;
    if !(FEWEST_CYCLES..=MOST_CYCLES).contains(&cycles) {
        return cycles > MOST_CYCLES;
    }
    let at = |t: f64| seen.times.partition_point(|u| *u < t);
    let (first, last) = (at(part.start), at(part.end));
    let mean = seen.positions.rows(first, last - first).row_mean();
    let farthest = |first: usize, last: usize| {
        let rows = seen.positions.rows(first, last - first);
        rows.row_iter()
            .map(|y| (y - &mean).norm())
            .fold(0.0, f64::max)
    };
    farthest(at(start), at(end)) > FARTHER * farthest(first, last)
}

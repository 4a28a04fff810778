//! [`RhythmicPart`]: where in a recording the gesture is.

use super::pieces::{self, Missing};
use super::runs::{self, alike};
use super::{Recording, hand};

/// A part that moves less than this share of the largest is none.
const LEAST_SHARE: f64 = 0.25;
/// Over shorter stretches \[s\] of which nothing is known the motion is taken to go straight on.
const SHORT: f64 = 0.3;
/// Over so many cycles of which nothing is known a rhythm goes on.
const BRIDGED: f64 = 2.0;

/// A part of a recording that is rhythmic, from turning point to turning point.
///
/// Wherever the motion is looked at for some seconds, it has a direction of most motion, along which it turns. The part is
/// a run of cycles about these turning points that are alike in length and height and that come back to the posture
/// where they began. Raising and lowering the arm do not come back. For a person's arm the path of the hand is looked at:
/// it goes on smoothly where the angles of the shoulder are near their singularity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RhythmicPart {
    /// Its first instant \[s\], in the recording's own time.
    pub start: f64,
    /// Its last \[s\].
    pub end: f64,
    /// Cycles within it, in halves; at least two and a half.
    pub cycles: f64,
    /// Mean frequency \[Hz\].
    pub frequency: f64,
    /// From peak to peak along the direction of most motion, mean over the cycles \[rad; for a person's arm, lengths of it\].
    pub size: f64,
}

impl RhythmicPart {
    /// \[s\]
    pub fn duration(&self) -> f64 {
        self.end - self.start
    }

    /// Without the half cycle that is left over at its end: what repeats.
    #[must_use]
    pub fn whole_cycles(&self) -> Self {
        let cycles = self.cycles.floor();
        Self {
            end: self.start + self.duration() * cycles / self.cycles,
            cycles,
            ..*self
        }
    }

    /// The part that goes on over a stretch of time of which nothing is known.
    fn bridged(&self, next: &Self) -> Self {
        let between =
            (next.start - self.end) * 2.0 / (self.frequency.recip() + next.frequency.recip());
        let cycles = self.cycles + next.cycles + (2.0 * between).round() / 2.0;
        let duration = next.end - self.start;
        Self {
            start: self.start,
            end: next.end,
            cycles,
            frequency: cycles / duration,
            size: (self.size * self.cycles + next.size * next.cycles) / (self.cycles + next.cycles),
        }
    }
}

impl Recording {
    /// Its rhythmic parts, by time; none where there is no rhythm of two and a half cycles. Gaps between stamps, frozen frames and
    /// jumps of 2 pi do not end a part.
    pub fn rhythmic_parts(&self) -> Vec<RhythmicPart> {
        find(&hand::seen(self), &pieces::missing(self))
    }

    /// The samples of a part, with their times.
    ///
    /// # Errors
    /// When there are fewer than two.
    pub fn cut(&self, part: &RhythmicPart) -> crate::error::Result<Self> {
        self.between(part.start, part.end)
    }

    /// The samples from `start` to `end` \[s\].
    pub(super) fn between(&self, start: f64, end: f64) -> crate::error::Result<Self> {
        // Instants of an even grid are those of the stamps but for rounding.
        let slack = 1e-9 * self.span();
        let first = self.times.partition_point(|t| *t < start - slack);
        let last = self.times.partition_point(|t| *t <= end + slack).max(first);
        Self::new(
            self.name.clone(),
            self.joints.clone(),
            self.times[first..last].to_vec(),
            self.positions.rows(first, last - first).into_owned(),
        )
    }
}

/// The parts of what is seen of a recording, where stretches of time are `missing`.
pub(super) fn find(seen: &Recording, missing: &[Missing]) -> Vec<RhythmicPart> {
    let missing: Vec<Missing> = missing
        .iter()
        .copied()
        .filter(|m| m.end - m.start > SHORT)
        .collect();
    let mut parts: Vec<RhythmicPart> = Vec::new();
    for piece in pieces::pieces(seen, &missing) {
        parts.extend(runs::runs(&piece).into_iter().map(|run| {
            let cycles = run.half_cycles / 2.0;
            let (start, end) = (piece.time(run.first), piece.time(run.last));
            RhythmicPart {
                start,
                end,
                cycles,
                frequency: cycles / (end - start),
                size: run.path / run.half_cycles,
            }
        }));
    }
    let largest = parts.iter().map(|p| p.size).fold(0.0, f64::max);
    parts.retain(|p| p.size >= LEAST_SHARE * largest);
    let mut joined: Vec<RhythmicPart> = Vec::new();
    for part in parts {
        match joined.last_mut() {
            Some(last) if goes_on(last, &part, &missing) => *last = last.bridged(&part),
            _ => joined.push(part),
        }
    }
    joined
}

/// Whether two parts are one: of one frequency and size, with something missing between them and little else.
fn goes_on(part: &RhythmicPart, next: &RhythmicPart, missing: &[Missing]) -> bool {
    let between = part.end..next.start;
    let first = missing.partition_point(|m| m.start < between.start);
    let is_missing = missing.get(first).is_some_and(|m| m.end <= between.end);
    let unknown = (next.start - part.end) * part.frequency;
    is_missing
        && unknown <= BRIDGED
        && alike(part.frequency, next.frequency)
        && next.size < 2.0 * part.size
        && part.size < 2.0 * next.size
}

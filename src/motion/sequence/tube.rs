//! Where a sequence is over intervals of time.

use super::{LATE, Leg, Sequence};
use crate::motion::{LANES, Motion, SplineTube, Tube, TubeRows, WaveTube};

/// The positions of a sequence over intervals: those of its legs, and over an interval with an end of one in it what holds both.
#[derive(Debug)]
pub struct SequenceTube<'a> {
    sequence: &'a Sequence,
    tubes: Vec<LegTube<'a>>,
    /// For the position and radius of one leg.
    room: [Vec<f64>; 2],
}

#[derive(Debug)]
enum LegTube<'a> {
    Move(SplineTube<'a>),
    /// And where the wave is entered \[s\].
    Wave(WaveTube<'a>, f64),
}

impl LegTube<'_> {
    fn over(&mut self, middle: f64, half: f64, position: &mut [f64], radius: &mut [f64]) {
        match self {
            Self::Move(tube) => tube.over(middle, half, position, radius),
            Self::Wave(tube, from) => tube.over(*from + middle, half, position, radius),
        }
    }
}

impl<'a> SequenceTube<'a> {
    pub(super) fn new(sequence: &'a Sequence) -> Self {
        let tubes = sequence.legs.iter().map(|leg| match leg {
            Leg::Move(spline) => LegTube::Move(spline.tube()),
            Leg::Wave { wave, from, .. } => LegTube::Wave(wave.tube(), *from),
        });
        let joints = sequence.joints().len();
        Self {
            sequence,
            tubes: tubes.collect(),
            room: [vec![0.0; joints], vec![0.0; joints]],
        }
    }

    /// So much wider that no rounding of a time leaves out an instant.
    fn widened(&self, half: f64) -> f64 {
        half + LATE * self.sequence.duration()
    }
}

impl SequenceTube<'_> {
    fn pieces_by(&self, smooth: bool, pieces: &mut Vec<(f64, f64)>) {
        let mut own = Vec::new();
        for ((tube, leg), start) in self
            .tubes
            .iter()
            .zip(&self.sequence.legs)
            .zip(&self.sequence.times)
        {
            own.clear();
            match (tube, leg) {
                (LegTube::Move(tube), _) if smooth => tube.smooth_pieces(&mut own),
                (LegTube::Move(tube), _) => tube.pieces(&mut own),
                (LegTube::Wave(tube, _), Leg::Wave { wave, duration, .. }) => {
                    tube.pieces(&mut own);
                    // As long as those of its period, over what is waved of it.
                    let count = (own.len() as f64 * duration / wave.period())
                        .ceil()
                        .max(1.0);
                    let half = duration / (2.0 * count);
                    own.clear();
                    own.extend((0..count as usize).map(|n| ((2 * n + 1) as f64 * half, half)));
                }
                _ => {}
            }
            pieces.extend(own.iter().map(|(middle, half)| (start + middle, *half)));
        }
    }
}

impl Tube for SequenceTube<'_> {
    fn pieces(&self, pieces: &mut Vec<(f64, f64)>) {
        self.pieces_by(false, pieces);
    }

    fn smooth_pieces(&self, pieces: &mut Vec<(f64, f64)>) {
        self.pieces_by(true, pieces);
    }
    fn over(&mut self, middle: f64, half: f64, position: &mut [f64], radius: &mut [f64]) {
        let sequence = self.sequence;
        let half = self.widened(half.abs());
        let duration = sequence.duration();
        // An instant that is none is any instant.
        let (from, to) = if (middle + half).is_nan() {
            (0.0, duration)
        } else {
            (
                (middle - half).clamp(0.0, duration),
                (middle + half).clamp(0.0, duration),
            )
        };
        let (first, last) = (sequence.leg_at(from), sequence.leg_at(to));
        let centre = sequence.leg_at(middle.clamp(from, to));
        let local = |leg: usize, t: f64| {
            (t - sequence.times[leg]).clamp(0.0, sequence.legs[leg].duration())
        };
        let others = (first..=last).filter(|leg| *leg != centre);
        for leg in std::iter::once(centre).chain(others) {
            let (a, b) = (local(leg, from), local(leg, to));
            let at = if leg == centre {
                local(leg, middle.clamp(from, to))
            } else {
                a + (b - a) / 2.0
            };
            let half = self.widened((at - a).max(b - at));
            let [q, r] = &mut self.room;
            self.tubes[leg].over(at, half, q, r);
            for joint in 0..position.len() {
                let (q, r) = (self.room[0][joint], self.room[1][joint]);
                if leg == centre {
                    (position[joint], radius[joint]) = (q, r);
                } else {
                    radius[joint] = radius[joint].max((q - position[joint]).abs() + r);
                }
            }
        }
    }

    /// Together where all intervals are within one wave, as most are.
    fn over_lanes(&mut self, middle: &[f64; LANES], half: &[f64; LANES], rows: &mut TubeRows) {
        let sequence = self.sequence;
        let leg = sequence.leg_at(middle[0]);
        let wide = half.map(|half| self.widened(half));
        let inside = (0..LANES).all(|lane| {
            sequence.times[leg] <= middle[lane] - wide[lane]
                && middle[lane] + wide[lane] <= sequence.times[leg + 1]
        });
        if inside && let LegTube::Wave(tube, from) = &mut self.tubes[leg] {
            let local = middle.map(|t| *from + (t - sequence.times[leg]));
            tube.over_lanes(&local, &wide, rows);
        } else {
            rows.one_by_one(self, middle, half);
        }
    }
}

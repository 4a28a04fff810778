//! [`Comparison`]: models of one gesture on the same left-out demonstrations.

mod bootstrap;
mod energy;
mod evaluation;
mod statistic;
mod yardstick;

#[cfg(test)]
mod tests;

pub use bootstrap::Estimate;
pub use evaluation::{Conditioned, Seconds};
pub use statistic::Statistic;

use crate::baseline::{ModelKind, Resolution};
use crate::demonstration::{CycleFits, LeftOut, Recording, Variation};
use crate::error::{Error, ErrorKind, Result};
use crate::parallel;
use evaluation::{Evaluation, FoldOutcome};

/// Demonstrations with a rhythm that a comparison needs: two to learn from, one to leave out, and one more for an interval.
const FEWEST: usize = 4;

/// How many distances there are.
pub(crate) const DISTANCES: usize = 4;

/// What is compared between drawn motions and a left-out demonstration, by the energy distance of the vectors that are seen of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Distance {
    /// Two cycles of all joints, from an upper turning point of the dominant joint on, in seconds of the left-out demonstration's tempo, in units of each joint's demonstrated standard deviation, root mean square; each joint about its mean, for postures differ
    /// more than gestures do and all models draw them alike.
    Motion,
    /// Amplitudes of all joints in third octaves from 0.3 to 10 Hz, of the whole length without its drift, in units of each joint's demonstrated standard deviation, root of the sum of squares: where
    /// the motion has its power.
    Power,
    /// The same amplitudes as levels, root mean square \[dB\], 0.1 deg added to each: a band that nobody sees counts as much as the gesture.
    Level,
    /// ln tempo, ln swing of the dominant joint, ln envelope variation, ln tempo variation over the whole length, in units of their demonstrated standard deviation.
    Course,
}

impl Distance {
    /// One of each.
    pub const ALL: [Self; DISTANCES] = [Self::Motion, Self::Power, Self::Level, Self::Course];

    /// In a word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Motion => "motion",
            Self::Power => "power",
            Self::Level => "level",
            Self::Course => "course",
        }
    }
}

/// How a comparison is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ComparisonOptions {
    /// Motions drawn of each model for each left-out demonstration.
    pub draws: u64,
    /// Of draws and resamples.
    pub seed: u64,
    /// Into how many folds demonstrations are dealt, one left out at a time; as many as there are leave out each alone.
    pub folds: Option<usize>,
    /// Of the intervals.
    pub confidence: f64,
    #[allow(missing_docs)]
    pub resolution: Resolution,
    /// Results are the same with any number of them.
    pub threads: usize,
}

impl Default for ComparisonOptions {
    fn default() -> Self {
        Self {
            draws: 100,
            seed: 0,
            folds: None,
            confidence: 0.95,
            resolution: Resolution::default(),
            threads: 1,
        }
    }
}

/// More demonstrations than this are dealt into ten folds, if nobody says otherwise.
const MOST_ALONE: usize = 40;
const FOLDS: usize = 10;

/// Models learned from all demonstrations but some, against these.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// The demonstrations that were left out in turn.
    pub demonstrations: Vec<String>,
    /// Recordings without a rhythm, which take no part.
    pub unusable: Vec<LeftOut>,
    /// How many folds there were.
    pub folds: usize,
    /// The joint whose turning points align motions.
    pub dominant: String,
    /// The demonstrations' own statistics, in the order of [`Statistic::ALL`].
    pub demonstrated: Vec<Estimate>,
    /// In the order of [`ModelKind::ALL`].
    pub models: Vec<Compared>,
    /// Both of ours against the best baseline, in each distance.
    pub paired: Vec<Paired>,
}

/// What one model came to.
#[derive(Debug, Clone)]
pub struct Compared {
    #[allow(missing_docs)]
    pub kind: ModelKind,
    /// In the order of [`Statistic::ALL`].
    pub statistics: Vec<Estimate>,
    /// In the order of [`Distance::ALL`].
    pub distances: [Estimate; DISTANCES],
    /// As drawn, and given each left-out demonstration's own swing of the dominant joint, or its frequency; the reason where a model cannot.
    pub given: [std::result::Result<Conditioned, String>; 3],
    /// Medians.
    pub seconds: Seconds,
}

/// Distances of the best baseline less those of ours, demonstration by demonstration: more than 0 is a win.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs)]
pub struct Paired {
    pub distance: Distance,
    pub ours: ModelKind,
    /// The one whose mean distance is smallest on these very demonstrations, which favours it.
    pub baseline: ModelKind,
    pub difference: Estimate,
}

impl Paired {
    /// Whether the interval leaves no other sign.
    pub fn is_clear(&self) -> bool {
        self.difference.lower > 0.0 || self.difference.upper < 0.0
    }
}

impl Comparison {
    /// Learns each model without each of `recordings` (uncut) and draws; `done` is called after each fold.
    ///
    /// # Errors
    /// When fewer than four recordings have a rhythm, options are out of range, or a model cannot be learned.
    pub fn new(
        recordings: &[Recording],
        options: &ComparisonOptions,
        mut done: impl FnMut(),
    ) -> Result<Self> {
        if options.draws < 2 {
            return Err(
                Error::new(ErrorKind::Setting, format!("{} draws", options.draws))
                    .expected("at least two"),
            );
        }
        if !(options.confidence > 0.0 && options.confidence < 1.0) {
            return Err(Error::new(
                ErrorKind::Setting,
                format!("a confidence of {}", options.confidence),
            )
            .expected("between 0 and 1"));
        }
        crate::demonstration::common_joints(recordings)?;
        let (usable, unusable) = usable(recordings, options.resolution.cycle_harmonics)?;
        let folds = options.folds.unwrap_or(match usable.len() {
            count if count > MOST_ALONE => FOLDS,
            count => count,
        });
        if !(2..=usable.len()).contains(&folds) {
            return Err(Error::new(ErrorKind::Setting, format!("{folds} folds"))
                .expected(format!("from 2 to {}, the demonstrations", usable.len())));
        }
        let joint = dominant(&usable)?;
        let fold = |k: usize| evaluation::fold(&usable, joint, k, folds, options);
        let mut outcomes: Vec<Result<FoldOutcome>> = Vec::new();
        parallel::in_order(
            folds,
            options.threads,
            || (),
            |(), k| fold(k),
            |outcome| {
                outcomes.push(outcome);
                done();
            },
        );
        let outcomes = outcomes.into_iter().collect::<Result<Vec<_>>>()?;
        let demonstrations = outcomes.iter().flat_map(|o| o.names.clone()).collect();
        let truths: Vec<Vec<f64>> = outcomes.iter().flat_map(|o| o.truths.clone()).collect();
        let evaluations: Vec<Evaluation> = (0..ModelKind::ALL.len())
            .map(|i| Evaluation::gathered(outcomes.iter().map(|o| &o.models[i])))
            .collect();
        let models: Vec<Compared> = ModelKind::ALL
            .iter()
            .zip(&evaluations)
            .map(|(kind, evaluation)| evaluation.compared(*kind, joint, options))
            .collect();
        Ok(Self {
            demonstrations,
            unusable,
            folds,
            dominant: usable[0].joints().name(joint).to_owned(),
            demonstrated: statistic::estimates(&truths, joint, options),
            paired: paired(&models, &evaluations, options),
            models,
        })
    }
}

fn usable(recordings: &[Recording], harmonics: usize) -> Result<(Vec<Recording>, Vec<LeftOut>)> {
    let (mut usable, mut unusable) = (Vec::new(), Vec::new());
    for recording in recordings {
        let fits = CycleFits::new(std::slice::from_ref(recording), harmonics);
        match fits.and(Variation::of(recording)) {
            Ok(_) => usable.push(recording.clone()),
            Err(error) => unusable.push(LeftOut {
                name: recording.name().to_owned(),
                reason: error.to_string(),
            }),
        }
    }
    if usable.len() < FEWEST {
        return Err(Error::new(
            ErrorKind::Infeasible,
            format!(
                "{} of {} recordings have a rhythm",
                usable.len(),
                recordings.len()
            ),
        )
        .expected(format!("at least {FEWEST}")));
    }
    Ok((usable, unusable))
}

/// The joint that is dominant in most demonstrations.
fn dominant(recordings: &[Recording]) -> Result<usize> {
    let mut votes = vec![0; recordings[0].joints().len()];
    for recording in recordings {
        let vote = votes.get_mut(Variation::of(recording)?.dominant);
        *vote.ok_or_else(|| Error::new(ErrorKind::Shape, "recordings of different joints"))? += 1;
    }
    Ok((0..votes.len()).fold(0, |best, d| if votes[d] > votes[best] { d } else { best }))
}

fn paired(
    models: &[Compared],
    evaluations: &[Evaluation],
    options: &ComparisonOptions,
) -> Vec<Paired> {
    let mut paired = Vec::new();
    for (i, distance) in Distance::ALL.into_iter().enumerate() {
        let value = |m: usize| models[m].distances[i].value;
        // A model of which no draw has a rhythm is infinitely far.
        let best = (0..models.len())
            .filter(|m| !models[*m].kind.is_ours() && value(*m).is_finite())
            .min_by(|a, b| value(*a).total_cmp(&value(*b)));
        let Some(best) = best else { continue };
        for (ours, model) in models.iter().enumerate().filter(|(_, m)| m.kind.is_ours()) {
            let (theirs, own) = (
                evaluations[best].distances(i),
                evaluations[ours].distances(i),
            );
            let differences: Vec<f64> = theirs.zip(own).map(|(b, o)| b - o).collect();
            paired.push(Paired {
                distance,
                ours: model.kind,
                baseline: models[best].kind,
                difference: Estimate::of_mean(&differences, options.confidence, options.seed),
            });
        }
    }
    paired
}

//! What a search over intervals of time looks for, and what it has found so far.

use crate::motion::LANES;

/// What is looked for.
#[derive(Debug, Clone, Copy)]
pub(super) enum Goal {
    /// A proof that every pair stays farther apart than this \[m\].
    Above(f64),
    /// The smallest distance, to this accuracy \[m\].
    Least(f64),
}

/// A distance, of which pair, when.
#[derive(Debug, Clone, Copy)]
pub(super) struct At {
    pub distance: f64,
    pub pair: usize,
    pub time: f64,
}

/// An interval on which something could be neither proven nor refuted.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stretch {
    pub from: f64,
    pub to: f64,
    pub pair: usize,
}

/// An interval with the pairs that are proven on it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Leaf {
    pub middle: f64,
    pub half: f64,
    pub pairs: Vec<usize>,
}

/// How much work a search was.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Work {
    /// Intervals of time that were looked at, each with the configuration in its middle.
    pub intervals: usize,
    /// Pairs of convex shapes whose distance was bounded beyond balls and capsules.
    pub distances: usize,
}

/// What a search found.
#[derive(Debug, Clone)]
pub(super) struct Found {
    pub goal: Goal,
    /// The least lower bound, over all pairs and times.
    pub lower: Option<At>,
    /// The least distance that is taken in the middle of an interval.
    pub upper: Option<At>,
    pub undecided: Vec<Stretch>,
    /// The tree, where it is kept.
    pub leaves: Option<Vec<Leaf>>,
    pub work: Work,
}

impl Found {
    pub fn new(goal: Goal, keep: bool) -> Self {
        Self {
            goal,
            lower: None,
            upper: None,
            undecided: Vec::new(),
            leaves: keep.then(Vec::new),
            work: Work::default(),
        }
    }

    /// Which of the intervals `lanes` stay open for a pair.
    #[inline(always)]
    pub fn settle(
        &mut self,
        lower: &[f64; LANES],
        lanes: u8,
        pair: usize,
        middle: &[f64; LANES],
        count: usize,
    ) -> u8 {
        let bar = self.bar();
        let mut open = lanes;
        for (lane, time) in middle.iter().enumerate() {
            if lanes >> lane & 1 == 1 && lower[lane] > bar {
                open &= !(1 << lane);
                self.proven(At {
                    distance: lower[lane],
                    pair,
                    time: *time,
                });
                self.keep(lane, count, pair);
            }
        }
        open
    }

    /// What is proven to stay above this is done with.
    #[inline(always)]
    pub fn bar(&self) -> f64 {
        match self.goal {
            Goal::Above(margin) => margin,
            Goal::Least(accuracy) => self
                .upper
                .map_or(f64::INFINITY, |at| at.distance - accuracy),
        }
    }

    /// While the least distance is sought: above which distance \[m\] of a pair with this padding nothing is found, and how near its bounds must then
    /// be.
    #[inline(always)]
    pub fn of_no_use(&self, padding: f64) -> (f64, f64) {
        match (self.goal, &self.upper) {
            (Goal::Least(accuracy), Some(best)) => (best.distance + padding, accuracy / 8.0),
            _ => (f64::INFINITY, 0.0),
        }
    }

    #[inline(always)]
    pub fn proven(&mut self, at: At) {
        if self.lower.is_none_or(|least| at.distance < least.distance) {
            self.lower = Some(at);
        }
    }

    /// Notes in the tree that a pair is proven on one of the last `count` intervals.
    #[inline(always)]
    pub fn keep(&mut self, lane: usize, count: usize, pair: usize) {
        if let Some(leaves) = &mut self.leaves {
            let start = leaves.len() - count;
            leaves[start + lane].pairs.push(pair);
        }
    }

    /// An interval that is left, with what is known of it from below \[m\]: enough have been looked at, or it is too narrow to be halved.
    pub fn give_up(&mut self, (middle, half): (f64, f64), lower: f64, pair: usize) {
        self.undecided.push(Stretch {
            from: middle - half,
            to: middle + half,
            pair,
        });
        self.proven(At {
            distance: lower,
            pair,
            time: middle,
        });
    }
}

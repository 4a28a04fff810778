//! Clearance over time: what a picture of it shows, and what may be relied on between its points.

use super::CollisionModel;
use super::certify::Moment;
use super::found::Goal;
use super::search::Search;
use crate::error::{Error, ErrorKind, Result};
use crate::motion::Motion;

/// No more intervals: a picture has fewer columns.
const MOST: usize = 100_000;

/// The smallest clearance within an interval of time.
#[derive(Debug, Clone, PartialEq)]
pub struct ProfileInterval {
    /// Its start \[s\].
    pub from: f64,
    /// Its end \[s\].
    pub to: f64,
    /// Proven: at no time within the interval are two checked parts nearer than this \[m\].
    pub lower: f64,
    /// The distance of a pair at a time within the interval: the smallest is no larger.
    pub nearest: Moment,
}

impl CollisionModel {
    /// The smallest clearance on each of `intervals` equal intervals of a motion, to `accuracy` \[m\]: the search of
    /// [`minimum_clearance`](Self::minimum_clearance), interval by interval. Where parts overlap it is minus the depth.
    ///
    /// # Errors
    /// When the motion is not of the robot's joints, no pair is checked, the accuracy is below a nanometre, or there are no
    /// intervals or more than 100 000.
    pub fn clearance_profile<M: Motion>(
        &self,
        motion: &M,
        intervals: usize,
        accuracy: f64,
    ) -> Result<Vec<ProfileInterval>> {
        self.require(motion.joints())?;
        super::certify::require_accuracy(accuracy)?;
        if !(1..=MOST).contains(&intervals) {
            return Err(
                Error::new(ErrorKind::Setting, format!("{intervals} intervals"))
                    .expected(format!("from 1 to {MOST}")),
            );
        }
        let exact = vec![0.0; self.joints().len()];
        let mut search = Search::new(self);
        let mut tube = motion.tube();
        let end = |n: usize| motion.duration() * n as f64 / intervals as f64;
        (0..intervals)
            .map(|n| {
                let (from, to) = (end(n), end(n + 1));
                let middle = 0.5 * (from + to);
                // The rounding of the ends is within what a tube reaches over.
                let piece = (middle, f64::max(middle - from, to - middle));
                let found = search.run_within(&mut tube, piece, Goal::Least(accuracy), &exact);
                let (Some(lower), Some(upper)) = (found.lower, found.upper) else {
                    return Err(Error::new(ErrorKind::Infeasible, "a motion of no duration"));
                };
                Ok(ProfileInterval {
                    from,
                    to,
                    lower: lower.distance.min(upper.distance),
                    nearest: self.moment(&upper, None::<&M>),
                })
            })
            .collect()
    }
}

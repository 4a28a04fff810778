//! The certificate: a proof that a motion keeps every pair apart, between the samples too.

use super::CollisionModel;
use super::found::{At, Found, Goal, Leaf, Work};
use super::search::Search;
use crate::error::{Error, ErrorKind, Result};
use crate::motion::Motion;

/// Two links, or an object of the scene and a link, at a time.
#[derive(Debug, Clone, PartialEq)]
pub struct Moment {
    /// Their names.
    pub pair: (String, String),
    /// Whether the first is an object of the scene.
    pub is_with_scene: bool,
    /// \[s\]
    pub time: f64,
    /// The distance, or a bound on it \[m\]; negative when they overlap, then minus the depth. Less what padding the pair has.
    pub distance: f64,
    /// The padding of the pair \[m\]: what is really between the two is `distance + padding`.
    pub padding: f64,
}

/// What could be said of a whole motion.
#[derive(Debug, Clone, PartialEq)]
pub enum Certification {
    /// Proven: at every time, and for all joint positions within the tolerance, every checked pair is farther apart than the margin.
    Clear {
        /// A lower bound on the clearance over the whole motion, above the margin, and the pair and the interval's middle that gave it. It
        /// is what the proof needed and not the clearance itself, for which see [`Prover::minimum_clearance`].
        bound: Moment,
        /// What it took.
        work: Work,
    },
    /// Refuted: at this time the pair is no farther apart than the margin and a tenth of a nanometre.
    Collides {
        /// The witness.
        witness: Moment,
        /// What it took.
        work: Work,
    },
    /// Neither: on these stretches the distance is within a nanometre of the margin, or within what the tolerance allows the joints, or half a million
    /// intervals were not enough. The motion itself is not found to come nearer than the margin.
    Undecided {
        /// Each with its pair, in order of time; at least one.
        stretches: Vec<Stretch>,
        /// What it took.
        work: Work,
    },
}

/// An interval of time \[s\] on which a pair is neither proven apart nor found to touch.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)]
pub struct Stretch {
    pub from: f64,
    pub to: f64,
    pub pair: (String, String),
}

impl Certification {
    /// Whether it is a proof.
    pub fn is_clear(&self) -> bool {
        matches!(self, Self::Clear { .. })
    }

    /// What it took.
    pub fn work(&self) -> Work {
        match self {
            Self::Clear { work, .. }
            | Self::Collides { work, .. }
            | Self::Undecided { work, .. } => *work,
        }
    }
}

/// The smallest distance over a whole motion.
#[derive(Debug, Clone, PartialEq)]
pub struct MinimumClearance {
    /// Nowhere are two checked parts nearer than this \[m\].
    pub lower: f64,
    /// The distance of this pair at this time: nowhere smaller by more than `distance - lower`.
    pub at: Moment,
    /// What it took.
    pub work: Work,
}

/// Proves motions clear, one after the other, in the same memory.
pub struct Prover<'m> {
    model: &'m CollisionModel,
    search: Search<'m>,
    tolerance: Vec<f64>,
}

impl CollisionModel {
    /// What proves motions of this robot clear.
    pub fn prover(&self) -> Prover<'_> {
        Prover {
            model: self,
            search: Search::new(self),
            tolerance: vec![0.0; self.joints().len()],
        }
    }

    /// [`Prover::certify`] for a single motion.
    ///
    /// # Errors
    /// Those of [`Prover::certify`].
    pub fn certify<M: Motion>(
        &self,
        motion: &M,
        margin: f64,
        tolerance: &[f64],
    ) -> Result<Certification> {
        self.prover().certify(motion, margin, tolerance)
    }

    /// [`Prover::minimum_clearance`] for a single motion.
    ///
    /// # Errors
    /// Those of [`Prover::minimum_clearance`].
    pub fn minimum_clearance<M: Motion>(
        &self,
        motion: &M,
        accuracy: f64,
    ) -> Result<MinimumClearance> {
        self.prover().minimum_clearance(motion, accuracy)
    }
}

impl Prover<'_> {
    /// Proves that over the whole motion every checked pair is farther apart than `margin` \[m\], while each joint is within its entry of
    /// `tolerance` \[rad, m\] of the motion (no entries: exactly on it), or finds a time at which one is not.
    ///
    /// Motions are covered by intervals. In the middle of each the distance of every pair is bounded from below by a plane between
    /// its shapes, and by how much it can fall in the interval follows from how far every joint can turn and how far from its axis
    /// points are. Where that does not suffice the interval is halved. Balls and capsules around the parts go first.
    ///
    /// # Errors
    /// When the motion is not of the robot's joints, no pair is checked, the margin is negative, or a tolerance is.
    pub fn certify<M: Motion>(
        &mut self,
        motion: &M,
        margin: f64,
        tolerance: &[f64],
    ) -> Result<Certification> {
        let found = self.found(motion, margin, tolerance, false)?;
        Ok(self.told(&found, motion))
    }

    /// A moment at which the motion itself makes links touch each other, or objects of the scene (`with_scene`), if there is one.
    ///
    /// # Errors
    /// When the motion is not of the robot's joints.
    pub fn touches<M: Motion>(&mut self, motion: &M, with_scene: bool) -> Result<Option<Moment>> {
        self.search.with_scene = Some(with_scene);
        let found = self.found(motion, 0.0, &[], false);
        self.search.with_scene = None;
        let witness = found?.upper;
        Ok(witness.map(|at| self.model.moment(&at, Some(motion))))
    }

    pub(super) fn model(&self) -> &CollisionModel {
        self.model
    }

    /// [`certify`](Self::certify) with the tree of the proof, and a little to spare in every step of it.
    pub(super) fn with_leaves<M: Motion>(
        &mut self,
        motion: &M,
        margin: f64,
        tolerance: &[f64],
    ) -> Result<(Certification, Vec<Leaf>)> {
        let mut found = self.found(motion, margin + SPARE, tolerance, true)?;
        let leaves = found.leaves.take().unwrap_or_default();
        Ok((self.told(&found, motion), leaves))
    }

    fn told<M: Motion>(&self, found: &Found, motion: &M) -> Certification {
        let model = self.model;
        let work = found.work;
        if let Some(witness) = found.upper {
            return Certification::Collides {
                witness: model.moment(&witness, Some(motion)),
                work,
            };
        }
        if !found.undecided.is_empty() {
            return Certification::Undecided {
                stretches: model.stretches(found),
                work,
            };
        }
        let bound = found.lower.unwrap_or(At {
            distance: f64::INFINITY,
            pair: model.checked[0],
            time: 0.0,
        });
        Certification::Clear {
            bound: model.moment(&bound, None::<&M>),
            work,
        }
    }

    fn found<M: Motion>(
        &mut self,
        motion: &M,
        margin: f64,
        tolerance: &[f64],
        keep: bool,
    ) -> Result<Found> {
        self.model.require(motion.joints())?;
        if !(margin >= 0.0 && margin.is_finite()) {
            return Err(
                Error::new(ErrorKind::Setting, format!("a margin of {margin} m"))
                    .expected("zero or more"),
            );
        }
        let joints = self.tolerance.len();
        if !(tolerance.is_empty() || tolerance.len() == joints) {
            return Err(
                Error::new(ErrorKind::Shape, format!("{} tolerances", tolerance.len()))
                    .expected(format!("one for each of {joints} joints, or none")),
            );
        }
        if let Some(wrong) = tolerance.iter().find(|t| !(**t >= 0.0 && t.is_finite())) {
            return Err(
                Error::new(ErrorKind::Setting, format!("a tolerance of {wrong}"))
                    .expected("zero or more"),
            );
        }
        self.tolerance.fill(0.0);
        self.tolerance[..tolerance.len()].copy_from_slice(tolerance);
        let goal = Goal::Above(margin);
        let found = self.search.run(motion, goal, &self.tolerance, keep);
        // What is left open for the sake of the tolerance may hide that the motion itself comes too near.
        if found.upper.is_none()
            && !found.undecided.is_empty()
            && self.tolerance.iter().any(|t| *t > 0.0)
        {
            self.tolerance.fill(0.0);
            let bare = self.search.run(motion, goal, &self.tolerance, false);
            if bare.upper.is_some() {
                return Ok(bare);
            }
        }
        Ok(found)
    }

    /// The smallest distance of any checked pair over the motion, to `accuracy` \[m\], and of which pair when, by the same tree as branch and
    /// bound. Where parts overlap it is minus the largest depth.
    ///
    /// # Errors
    /// When the motion is not of the robot's joints, no pair is checked, or the accuracy is below a nanometre.
    pub fn minimum_clearance<M: Motion>(
        &mut self,
        motion: &M,
        accuracy: f64,
    ) -> Result<MinimumClearance> {
        self.model.require(motion.joints())?;
        require_accuracy(accuracy)?;
        self.tolerance.fill(0.0);
        let found = self
            .search
            .run(motion, Goal::Least(accuracy), &self.tolerance, false);
        let (Some(lower), Some(upper)) = (found.lower, found.upper) else {
            return Err(Error::new(ErrorKind::Infeasible, "a motion of no duration"));
        };
        Ok(MinimumClearance {
            lower: lower.distance.min(upper.distance),
            at: self.model.moment(&upper, None::<&M>),
            work: found.work,
        })
    }
}

/// What a proof that is kept has to spare in every step \[m\]: whoever verifies it computes with other roundings.
const SPARE: f64 = 1e-7;

/// Distances are known no better \[m\].
const FINEST: f64 = 1e-9;

pub(super) fn require_accuracy(accuracy: f64) -> Result<()> {
    if accuracy >= FINEST && accuracy.is_finite() {
        return Ok(());
    }
    Err(
        Error::new(ErrorKind::Setting, format!("an accuracy of {accuracy} m"))
            .expected(format!("{FINEST:e} or more")),
    )
}

impl CollisionModel {
    /// With names; where there is a motion, with the distance of the pair at that time.
    pub(super) fn moment<M: Motion>(&self, at: &At, motion: Option<&M>) -> Moment {
        let distance = motion.map_or(at.distance, |motion| {
            let mut state = crate::fourier::State::zeros(self.joints().len());
            motion.state_into(at.time, &mut state);
            self.checker()
                .pair_clearance(state.position.as_slice(), at.pair)
                .distance
        });
        Moment {
            pair: self.names(at.pair),
            is_with_scene: self.pairs[at.pair].parts.0 < self.scene,
            time: at.time,
            distance,
            padding: self.pairs[at.pair].padding,
        }
    }

    /// Stretches that meet are one.
    fn stretches(&self, found: &Found) -> Vec<Stretch> {
        let mut undecided = found.undecided.clone();
        undecided.sort_by(|a, b| a.pair.cmp(&b.pair).then(a.from.total_cmp(&b.from)));
        let mut merged: Vec<super::found::Stretch> = Vec::new();
        for stretch in undecided {
            match merged.last_mut() {
                Some(last)
                    if last.pair == stretch.pair
                        && stretch.from <= last.to + f64::EPSILON * last.to.abs() =>
                {
                    last.to = last.to.max(stretch.to);
                }
                _ => merged.push(stretch),
            }
        }
        merged.sort_by(|a, b| a.from.total_cmp(&b.from));
        merged
            .iter()
            .map(|s| Stretch {
                from: s.from,
                to: s.to,
                pair: self.names(s.pair),
            })
            .collect()
    }
}

//! Which pairs touch in random configurations: always, never, sometimes.

use rand::rngs::ChaCha8Rng;
use rand::{Rng, SeedableRng};

use super::{CollisionModel, Pair};
use crate::error::{Error, ErrorKind, Result};
use crate::robot::Robot;

/// How often a pair touched in configurations drawn uniformly within the limits of the joints.
#[derive(Debug, Clone, PartialEq)]
pub struct PairContacts {
    /// The pair, checked or not.
    pub pair: Pair,
    /// Configurations in which it touched.
    pub touching: usize,
    /// Configurations looked at.
    pub samples: usize,
}

impl PairContacts {
    /// Whether it touched in all of them: by design, most likely, and then it is to be left out.
    pub fn always(&self) -> bool {
        self.touching == self.samples
    }

    /// Whether it touched in none, which proves nothing.
    pub fn never(&self) -> bool {
        self.touching == 0
    }
}

impl CollisionModel {
    /// Draws `samples` configurations uniformly within the joints' limits (of continuous joints all around) from a seed, and counts for
    /// every pair, also those that are not checked, in how many it touches: pairs that an SRDF disables and that do collide show here.
    ///
    /// # Errors
    /// When no sample is asked for.
    pub fn pair_contacts(
        &self,
        robot: &Robot,
        samples: usize,
        seed: u64,
    ) -> Result<Vec<PairContacts>> {
        let contacts = self.contacts(robot, samples, seed)?;
        Ok(self
            .pairs
            .iter()
            .zip(contacts)
            .map(|(pair, touching)| PairContacts {
                pair: pair.clone(),
                touching,
                samples,
            })
            .collect())
    }

    pub(super) fn contacts(&self, robot: &Robot, samples: usize, seed: u64) -> Result<Vec<usize>> {
        robot.require_joints(self.joints())?;
        if samples == 0 {
            return Err(
                Error::new(ErrorKind::Setting, "0 configurations").expected("some hundreds")
            );
        }
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut counts = vec![0; self.pairs.len()];
        let mut checker = self.checker();
        let mut q = vec![0.0; self.joints().len()];
        for _ in 0..samples {
            for (j, q) in q.iter_mut().enumerate() {
                let (lower, upper) = robot
                    .properties(j)
                    .position
                    .map_or((-std::f64::consts::PI, std::f64::consts::PI), |i| {
                        (i.lower, i.upper)
                    });
                let share = (rng.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
                *q = lower + share * (upper - lower);
            }
            for pair in checker.touching(&q) {
                counts[pair] += 1;
            }
        }
        Ok(counts)
    }
}

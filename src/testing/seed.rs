//! Seeds: what makes a statistical case the same again.

use proptest::prelude::*;
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;

use crate::primitive::stream;

/// The seed of all randomness of a statistical case.
///
/// ```
/// use undulate::rand::RngExt;
/// use undulate::testing::Seed;
///
/// let draw = |seed: Seed| seed.rng().random::<u64>();
/// assert_eq!(draw(Seed(3)), draw(Seed(3)));
/// assert_ne!(draw(Seed(3)), draw(Seed(4)));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Seed(pub u64);

impl Seed {
    /// The generator of this seed.
    pub fn rng(self) -> ChaCha8Rng {
        ChaCha8Rng::seed_from_u64(self.0)
    }

    /// The generator of sample number `index`: sample k does not depend on how many are drawn (see [`stream`]).
    pub fn stream(self, index: u64) -> ChaCha8Rng {
        stream(self.0, index)
    }
}

/// Any seed, and it does not shrink: a smaller seed is no simpler case, it is another one.
///
/// A statistical case draws its samples from its seed and from nothing else. While proptest shrinks the other arguments the seed
/// stays, so that a failure is met again and not drawn anew; it is printed with the counterexample.
///
/// ```
/// use proptest::prelude::*;
/// use rand::RngExt;
/// use undulate::testing::{bounded_mean, seeds};
///
/// proptest!(|(high in 1.0..9.0, seed in seeds())| {
///     let mut rng = seed.rng();
///     let samples: Vec<f64> = (0..2000).map(|_| rng.random_range(0.0..high)).collect();
///     bounded_mean(&samples, (0.0, high), high / 2.0, 1e-9).map_err(|alarm| alarm.of(seed))?;
/// });
/// ```
pub fn seeds() -> impl Strategy<Value = Seed> {
    any::<u64>().prop_map(Seed).no_shrink()
}

//! The assertion that two sets of samples come from one distribution, whatever it is.

use nalgebra::DVector;
use rand::RngExt;

use super::Seed;
use super::alarm::{Alarm, Power};
use super::argument::{needed, require_probability};
use super::law::{MISS, first_count};
use crate::proportion::{at_most, lower_bound};

/// Distances that sums in another order make differ are equal.
const ROUNDING: f64 = 1e-12;

/// Do two sets of vectors come from one distribution? By the energy distance 2 E|X - Y| - E|X - X'| - E|Y - Y'| (Szekely and Rizzo, Journal of
/// Statistical Planning and Inference 143, 2013), which is 0 for equal distributions and for no others, against what it is when the vectors are
/// dealt out to the sets anew, `permutations` times, as drawn by `seed`. If the distribution is one, all deals are alike, and p = (1 + those as
/// far apart) / (1 + `permutations`) is at most any level with no more than that probability: exact at any N, but for the steps of p. Entries
/// should be of one unit and size: an entry that is large hides the others.
///
/// What it is certain to catch is an energy distance of the distributions, by McDiarmid's inequality for the samples and its twin for
/// deals (El-Yaniv and Pechyony, JAIR 35, 2009), from the mean distances and the diameter that the samples have. That is a safe
/// number: distances a tenth as large are nearly always caught. Of few samples it is more than any two distributions of that diameter are apart,
/// and that is said.
///
/// ```
/// use nalgebra::{DVector, dvector};
/// use rand::RngExt;
/// use undulate::nalgebra;
/// use undulate::testing::{Seed, energy};
///
/// let mut rng = Seed(4).rng();
/// let mut draw = |width: f64| -> Vec<DVector<f64>> {
///     (0..60).map(|_| dvector![rng.random_range(-width..width)]).collect()
/// };
/// let (one, other, wider) = (draw(1.0), draw(1.0), draw(3.0));
/// assert!(energy(&one, &other, 999, Seed(0), 1e-3).is_ok());
/// assert!(energy(&one, &wider, 999, Seed(0), 1e-3).is_err());
/// ```
///
/// # Errors
/// When p is at most `false_alarm`; the alarm tells `seed`.
///
/// # Panics
/// When `false_alarm` is not within 0..1, there are so few `permutations` that p cannot be that small, so few samples that sets which are wholly
/// apart could pass unnoticed, or vectors of different dimensions.
#[track_caller]
pub fn energy(
    one: &[DVector<f64>],
    other: &[DVector<f64>],
    permutations: usize,
    seed: Seed,
    false_alarm: f64,
) -> Result<(), Alarm> {
    require_probability("false_alarm", false_alarm);
    let all: Vec<&DVector<f64>> = one.iter().chain(other).collect();
    let samples = all.len();
    assert!(
        all.iter().all(|x| x.len() == all[0].len()),
        "samples: vectors of different dimensions"
    );
    let least = (1.0 / false_alarm).ceil() - 1.0;
    assert!(
        permutations as f64 >= least,
        "permutations: {permutations} are too few for a false alarm of {false_alarm}, at least {least} are needed"
    );
    // Sets that are wholly apart: of all deals this one alone is as far, and where sets are of one size the one that swaps them.
    let bearable = bearable(permutations, false_alarm);
    let log_factorial = |n: usize| libm::lgamma(n as f64 + 1.0);
    let is_telling = |n: usize, m: usize| {
        let log_deals = log_factorial(n + m) - log_factorial(n) - log_factorial(m);
        let as_far = if n == m { 2.0 } else { 1.0 } * (-log_deals).exp();
        at_most(bearable, permutations as u64, as_far.min(1.0)) >= 1.0 - MISS
    };
    assert!(
        is_telling(one.len(), other.len()),
        "samples: {} and {} are too few, sets that are wholly apart could pass unnoticed; {}",
        one.len(),
        other.len(),
        needed(one.len().min(other.len()), " of each", |n| is_telling(n, n)),
    );
    Alarm::unless_finite(all.iter().flat_map(|x| x.iter()), samples)?;

    let distances = Distances::between(&all, one.len());
    let mut deal: Vec<usize> = (0..samples).collect();
    let observed = distances.energy(&deal) * (1.0 - ROUNDING);
    let mut rng = seed.rng();
    let mut dealt = Vec::with_capacity(permutations);
    for _ in 0..permutations {
        for i in 0..one.len() {
            deal.swap(i, rng.random_range(i..samples));
        }
        dealt.push(distances.energy(&deal));
    }
    dealt.sort_unstable_by(|a, b| b.total_cmp(a));
    // As far as the last of these is not farther. Rounding may leave less than nothing.
    let most = dealt[bearable as usize];
    let (observed, bounds) = (observed.max(0.0), (0.0, most.max(0.0)));
    Alarm::unless_within("energy distance", observed, bounds, samples, || {
        distances.power(permutations, false_alarm)
    })
    .map_err(|alarm| alarm.of(seed))
}

/// How many deals may be as far for an alarm: p = (1 + as far) / (1 + permutations) is at the level then.
fn bearable(permutations: usize, false_alarm: f64) -> u64 {
    let p = |as_far: u64| (1 + as_far) as f64 / (1 + permutations) as f64;
    first_count(permutations as u64, |as_far| p(as_far) > false_alarm).saturating_sub(1)
}

/// All distances between samples, of which the first so many are the first set.
struct Distances {
    first: usize,
    count: usize,
    /// Row by row.
    between: Vec<f64>,
    /// Sums of rows.
    of: Vec<f64>,
    total: f64,
}

impl Distances {
    fn between(all: &[&DVector<f64>], first: usize) -> Self {
        let count = all.len();
        let between: Vec<f64> = (0..count * count)
            .map(|i| (all[i / count] - all[i % count]).norm())
            .collect();
        let of: Vec<f64> = between.chunks(count).map(|row| row.iter().sum()).collect();
        Self {
            first,
            count,
            total: of.iter().sum(),
            between,
            of,
        }
    }

    /// Sums of distances within the set of the first of the deal, between the sets, and within the other.
    fn sums(&self, deal: &[usize]) -> [f64; 3] {
        let set = &deal[..self.first];
        let mut within = 0.0;
        for (k, i) in set.iter().enumerate() {
            let row = &self.between[i * self.count..(i + 1) * self.count];
            within += 2.0 * set[..k].iter().map(|j| row[*j]).sum::<f64>();
        }
        let between = set.iter().map(|i| self.of[*i]).sum::<f64>() - within;
        [within, between, self.total - 2.0 * between - within]
    }

    fn sizes(&self) -> (f64, f64) {
        (self.first as f64, (self.count - self.first) as f64)
    }

    fn energy(&self, deal: &[usize]) -> f64 {
        let (n, m) = self.sizes();
        let [one, between, other] = self.sums(deal);
        2.0 * between / (n * m) - one / (n * n) - other / (m * m)
    }

    /// The root of the energy distance is the norm of a difference of two means, of vectors whose squared distances are 2 |x - y|. So that of
    /// the samples is less than that of the distributions by no more than the norm of what the means are off, and that of a deal is a
    /// norm with a mean square that is known; both norms stay near their means, for no sample moves them by much.
    fn power(&self, permutations: usize, false_alarm: f64) -> Power {
        let (n, m) = self.sizes();
        let count = n + m;
        let deal: Vec<usize> = (0..self.count).collect();
        let [one, _, other] = self.sums(&deal);
        let diameter = self.between.iter().fold(0.0, |a: f64, b| a.max(*b));
        let parts = 1.0 / n + 1.0 / m;
        // What share of all deals may be as far, so that no more of the drawn ones are than p can bear.
        let bearable = bearable(permutations, false_alarm);
        let share = lower_bound(bearable + 1, permutations as u64, MISS / 2.0);
        let deals = n * m / ((count - 0.5) * (1.0 - 0.5 / n.max(m)));
        let swap = 2.0 * diameter * parts * parts;
        let dealt = (parts * self.total / (count * (count - 1.0))).sqrt()
            + (deals * swap * -share.ln() / 2.0).sqrt();
        let drawn = (one / (n * n * (n - 1.0)) + other / (m * m * (m - 1.0))).sqrt()
            + (2.0 * diameter * parts * (2.0 / MISS).ln() / 2.0).sqrt();
        let certain = (dealt + drawn).powi(2);
        // Of points within a diameter no two distributions are farther apart than by twice that.
        if certain > 2.0 * diameter {
            return Power {
                of: "no energy distance for certain, and within the diameter of these samples none is beyond",
                smallest: 2.0 * diameter,
            };
        }
        Power {
            of: "an energy distance of",
            smallest: certain,
        }
    }
}

//! Primitives.

use std::ops::RangeInclusive;

use proptest::prelude::*;

use super::gaussian::{numbers, of};
use super::waves;
use crate::primitive::{FourierMovementPrimitive, LogPolar};

/// Primitives of up to so many joints and harmonics, and of this rank: a chart of [`waves`] with a Gaussian of [`gaussians`](super::gaussians). They shrink as these
/// do, to fewer joints and harmonics, and to a mean of 0 without variance.
///
/// ```
/// use proptest::prelude::*;
/// use undulate::testing::primitives;
/// use undulate::FourierMovementPrimitive;
///
/// proptest!(|(primitive in primitives(1..=2, 1..=3, 4))| {
///     let again = FourierMovementPrimitive::from_json(&primitive.to_json())?;
///     prop_assert_eq!(again, primitive);
/// });
/// ```
///
/// # Panics
/// When `joints` or `harmonics` is an empty range or starts at 0.
#[track_caller]
pub fn primitives(
    joints: RangeInclusive<usize>,
    harmonics: RangeInclusive<usize>,
    rank: usize,
) -> impl Strategy<Value = FourierMovementPrimitive> {
    let largest = 2 * joints.end() * harmonics.end() + joints.end();
    (waves(joints, harmonics), numbers(largest, rank)).prop_map(move |(wave, numbers)| {
        let chart = LogPolar::of(&wave);
        let gaussian = of(&numbers, chart.dimension(), rank);
        FourierMovementPrimitive::new(chart, gaussian)
            .expect("a Gaussian of the chart's dimension, far from overflow")
    })
}

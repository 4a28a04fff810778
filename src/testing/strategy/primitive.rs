//! Primitives.

use std::ops::RangeInclusive;

use proptest::prelude::*;

use super::{gaussians, waves};
use crate::primitive::{FourierMovementPrimitive, LogPolar};

/// Primitives of up to so many joints and harmonics, and of this rank: a chart of [`waves`] with a Gaussian of [`gaussians`]. They shrink as these
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
pub fn primitives(
    joints: RangeInclusive<usize>,
    harmonics: RangeInclusive<usize>,
    rank: usize,
) -> impl Strategy<Value = FourierMovementPrimitive> {
    waves(joints, harmonics).prop_flat_map(move |wave| {
        let chart = LogPolar::of(&wave);
        gaussians(chart.dimension(), rank).prop_map(move |gaussian| {
            FourierMovementPrimitive::new(chart.clone(), gaussian)
                .expect("a Gaussian of the chart's dimension, far from overflow")
        })
    })
}

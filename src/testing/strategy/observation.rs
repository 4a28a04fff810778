//! Observations that a primitive can be conditioned on.

use std::ops::RangeInclusive;
use std::sync::Arc;

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::subsequence;

use super::super::argument::require_counts;
use super::latent::Latent;
use crate::primitive::{FourierMovementPrimitive, Observation};

/// So many observations of different coordinates of a primitive, which do not contradict each other: values of one wave that it draws, two
/// thirds of them exact, the others with a standard deviation of 0.01 to 0.5 (of the logarithm where the coordinate is one). They shrink to fewer
/// observations, exact ones, and values at the mean.
///
/// ```
/// use proptest::prelude::*;
/// use undulate::testing::observations;
/// use undulate::{FourierMovementPrimitive, LearnOptions, synthetic};
///
/// let primitive = FourierMovementPrimitive::learn_with(&synthetic(0)?, 5, &LearnOptions::paper())?;
/// proptest!(|(observations in observations(&primitive, 0..=4))| {
///     let conditioned = primitive.condition(&observations)?;
///     prop_assert!(conditioned.gaussian().rank() + observations.len() >= primitive.gaussian().rank());
/// });
/// # Ok::<(), undulate::Error>(())
/// ```
///
/// # Panics
/// When `count` is an empty range, or goes beyond the rank of the primitive: more exact values would contradict each other.
#[track_caller]
pub fn observations(
    primitive: &FourierMovementPrimitive,
    count: RangeInclusive<usize>,
) -> impl Strategy<Value = Vec<Observation>> + use<> {
    require_counts("count", &count, 0);
    let rank = primitive.gaussian().rank();
    assert!(
        *count.end() <= rank,
        "count = {count:?}: at most {rank}, the rank of the primitive"
    );
    let latent = Latent {
        entries: primitive.gaussian().latent(),
        parts: 0,
    };
    let primitive = Arc::new(primitive.clone());
    let coordinates: Vec<usize> = (0..primitive.chart().dimension()).collect();
    let deviation = prop::option::weighted(1.0 / 3.0, 0.01..0.5f64);
    let deviations = vec(deviation, *count.end());
    (latent, subsequence(coordinates, count), deviations).prop_filter_map(
        "observations that contradict each other",
        move |(mut draw, coordinates, deviations)| {
            let x = primitive.gaussian().at_latent(&mut draw.z);
            let chart = primitive.chart();
            let observations: Vec<Observation> = coordinates
                .iter()
                .zip(deviations)
                .map(|(i, deviation)| {
                    let coordinate = chart.coordinate(*i)?;
                    let value = chart.value(&coordinate, x[*i]).ok()?;
                    let is_logarithmic = chart.is_logarithmic(&coordinate).ok()?;
                    let scale = if is_logarithmic { value.abs() } else { 1.0 };
                    let deviation = deviation.unwrap_or(0.0) * scale;
                    Some(Observation::of(coordinate, value).within(deviation))
                })
                .collect::<Option<_>>()?;
            // A phase beyond its branch stands elsewhere than it was drawn, and may be certain to.
            primitive.condition(&observations).ok()?;
            Some(observations)
        },
    )
}

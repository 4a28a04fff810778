//! Gaussians.

use nalgebra::{DMatrix, DVector};
use proptest::collection::vec;
use proptest::prelude::*;

use crate::primitive::Gaussian;

/// Gaussians of `dimension` with factors of `rank` columns: means within 1, entries of the factor within 0.5, so that a covariance is as well
/// conditioned as chance has it ([`covariances`](super::covariances) are as one asks). They shrink to means and entries of 0.
///
/// ```
/// use proptest::prelude::*;
/// use undulate::testing::gaussians;
///
/// proptest!(|(gaussian in gaussians(3, 2))| {
///     prop_assert!(gaussian.covariance().symmetric_eigenvalues().min() > -1e-12);
/// });
/// ```
///
/// # Panics
/// When `dimension` is 0.
#[track_caller]
pub fn gaussians(dimension: usize, rank: usize) -> impl Strategy<Value = Gaussian> {
    assert!(dimension > 0, "dimension: at least 1");
    numbers(dimension, rank).prop_map(move |numbers| of(&numbers, dimension, rank))
}

/// Means, and factors by rows, of up to this dimension.
pub(super) fn numbers(dimension: usize, rank: usize) -> impl Strategy<Value = [Vec<f64>; 2]> {
    let factor = vec(-0.5..0.5f64, dimension * rank);
    (vec(-1.0..1.0f64, dimension), factor).prop_map(|(mean, factor)| [mean, factor])
}

/// The Gaussian of the first `dimension` of these.
pub(super) fn of([mean, factor]: &[Vec<f64>; 2], dimension: usize, rank: usize) -> Gaussian {
    Gaussian::new(
        DVector::from_column_slice(&mean[..dimension]),
        DMatrix::from_row_slice(dimension, rank, &factor[..dimension * rank]),
    )
    .expect("finite and of fitting sizes")
}

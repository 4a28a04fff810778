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
pub fn gaussians(dimension: usize, rank: usize) -> impl Strategy<Value = Gaussian> {
    assert!(dimension > 0, "dimension: at least 1");
    (
        vec(-1.0..1.0f64, dimension),
        vec(-0.5..0.5f64, dimension * rank),
    )
        .prop_map(move |(mean, factor)| {
            Gaussian::new(
                DVector::from_vec(mean),
                DMatrix::from_vec(dimension, rank, factor),
            )
            .expect("finite and of fitting sizes")
        })
}

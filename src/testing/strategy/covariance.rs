//! Covariances of a rank and a condition that are asked for.

use nalgebra::{DMatrix, DVector};
use proptest::collection::vec;
use proptest::prelude::*;

/// Factors F of covariances F F^T of `dimension`, of this `rank`, with singular values from 1 down to 1 / sqrt(`condition`), both of which are
/// there, the others between them (their logarithms uniform): what [`Gaussian::new`](crate::Gaussian::new) takes. The directions come from
/// `rank` reflections. They shrink to the axes, and the values between to 1.
///
/// ```
/// use proptest::prelude::*;
/// use undulate::testing::factors;
///
/// proptest!(|(factor in factors(5, 3, 1e4))| {
///     let values = factor.singular_values();
///     prop_assert!((values.max() / values.min() - 100.0).abs() < 1e-9);
/// });
/// ```
///
/// # Panics
/// When `rank` is 0 or more than `dimension`, or `condition` is not a finite number of at least 1 (of rank 1 it is 1).
#[track_caller]
pub fn factors(
    dimension: usize,
    rank: usize,
    condition: f64,
) -> impl Strategy<Value = DMatrix<f64>> {
    assert!(
        (1..=dimension).contains(&rank),
        "rank = {rank}: from 1 to the dimension, which is {dimension}"
    );
    assert!(
        condition.is_finite() && condition >= 1.0,
        "condition = {condition}: a finite number of at least 1"
    );
    assert!(
        rank > 1 || condition == 1.0,
        "condition = {condition}: of rank 1 it is 1"
    );
    (
        vec(vec(-1.0..1.0f64, dimension), rank),
        vec(0.0..1.0f64, rank.saturating_sub(2)),
    )
        .prop_map(move |(normals, between)| {
            let share = |j: usize| match j {
                0 => 0.0,
                _ if j + 1 == rank => 1.0,
                _ => between[j - 1],
            };
            let mut factor = DMatrix::from_fn(dimension, rank, |i, j| {
                f64::from(u8::from(i == j)) * condition.powf(-share(j) / 2.0)
            });
            for normal in normals {
                reflect(&mut factor, &DVector::from_vec(normal));
            }
            factor
        })
}

/// The columns mirrored in the plane of this normal; in none when it has no length.
fn reflect(columns: &mut DMatrix<f64>, normal: &DVector<f64>) {
    let squared = normal.norm_squared();
    if squared > f64::MIN_POSITIVE {
        let along = columns.tr_mul(normal);
        columns.ger(-2.0 / squared, normal, &along, 1.0);
    }
}

/// Covariance matrices of `dimension` with eigenvalues from 1 down to 1 / `condition`, `rank` of them, and else 0: F F^T of [`factors`],
/// drawn and shrunk as these.
///
/// ```
/// use proptest::prelude::*;
/// use undulate::testing::covariances;
///
/// proptest!(|(covariance in covariances(4, 4, 100.0))| {
///     prop_assert_eq!(&covariance, &covariance.transpose());
///     prop_assert!(covariance.cholesky().is_some());
/// });
/// ```
///
/// # Panics
/// As [`factors`] does.
#[track_caller]
pub fn covariances(
    dimension: usize,
    rank: usize,
    condition: f64,
) -> impl Strategy<Value = DMatrix<f64>> {
    factors(dimension, rank, condition).prop_map(|factor| {
        let product = &factor * factor.transpose();
        // Not only up to rounding.
        (&product + product.transpose()) / 2.0
    })
}

//! The Kronecker target: few numbers for the correlation of many coordinates.

use nalgebra::DMatrix;

use crate::error::Result;
use crate::primitive::{Kronecker, LogPolar};
use crate::vectors::dot;

/// Eigenvalues of a pooled correlation matrix below this are raised to it.
const LEAST_EIGENVALUE: f64 = 0.02;

/// No neighbouring harmonics are correlated more.
const LARGEST_DECAY: f64 = 0.95;

/// Standardised coordinates of one kind: `groups` joints, `length` harmonics each.
struct Kind {
    start: usize,
    groups: usize,
    length: usize,
}

fn kinds(chart: &LogPolar) -> Vec<Kind> {
    let (phases, offsets) = chart.starts();
    let (groups, length) = (chart.joints().len(), chart.harmonics());
    let kind = |start, length| Kind {
        start,
        groups,
        length,
    };
    let mut kinds = vec![kind(0, length), kind(phases, length), kind(offsets, 1)];
    // Swings, frequency and levels of jitter together: it is their relation that a change of tempo uses.
    kinds.extend(chart.tail().map(|start| Kind {
        start,
        groups: chart.dimension() - start,
        length: 1,
    }));
    kinds
}

/// Blocks of correlation A (x) AR(1) for log moduli and for phases, and one each for offsets and for swings, frequency and jitter (without harmonics),
/// nothing between them, from `directions` (M x n, unit
/// columns, or zero where a coordinate takes no part) of so many demonstrations, times `scales` (n).
///
/// A is pooled over the harmonics and shrunk by OAS, rho is the pooled correlation of neighbouring harmonics: O(D^2) numbers in all.
pub(super) fn blocks(
    chart: &LogPolar,
    directions: &DMatrix<f64>,
    count: f64,
    scales: &[f64],
) -> Result<Vec<Kronecker>> {
    kinds(chart)
        .into_iter()
        .filter_map(|kind| {
            let size = (kind.groups, kind.length);
            block(directions, count, scales, kind.start, size)
        })
        .collect()
}

/// The block of `groups` x `length` coordinates from `start` on, group by group; none where no coordinate takes part.
pub(crate) fn block(
    directions: &DMatrix<f64>,
    count: f64,
    scales: &[f64],
    start: usize,
    (groups, length): (usize, usize),
) -> Option<Result<Kronecker>> {
    let rows = directions.nrows();
    let column = |i: usize| &directions.as_slice()[i * rows..][..rows];
    let is_active = |i: usize| dot(column(i), column(i)) > 0.0;
    let all = start..start + groups * length;
    let active = all.clone().filter(|i| is_active(*i)).count();
    if active == 0 {
        return None;
    }
    let at = |d: usize, k: usize| start + d * length + k;
    let pooled = |pairs: &mut dyn Iterator<Item = (usize, usize)>| {
        let (mut sum, mut number) = (0.0, 0);
        for (i, j) in pairs.filter(|(i, j)| is_active(*i) && is_active(*j)) {
            sum += dot(column(i), column(j));
            number += 1;
        }
        if number > 0 {
            sum / f64::from(number)
        } else {
            0.0
        }
    };
    let mut correlation = DMatrix::identity(groups, groups);
    for d in 0..groups {
        for e in 0..d {
            let pooled = pooled(&mut (0..length).map(|k| (at(d, k), at(e, k))));
            correlation[(d, e)] = pooled;
            correlation[(e, d)] = pooled;
        }
    }
    // As many demonstrations of the joints' correlation as there are harmonics that tell of it.
    let samples = count * (active as f64 / groups as f64).max(1.0);
    let weight = super::oas(&correlation, groups as f64, samples);
    let diagonal = DMatrix::identity(groups, groups);
    correlation = correlation * (1.0 - weight) + diagonal * weight;
    let neighbours = &mut (0..groups)
        .flat_map(|d| (1..length).map(move |k| (d, k)))
        .map(|(d, k)| (at(d, k - 1), at(d, k)));
    let decay = pooled(neighbours).clamp(-LARGEST_DECAY, LARGEST_DECAY);
    let deviations = all.map(|i| if is_active(i) { scales[i] } else { 0.0 });
    Some(Kronecker::new(
        start,
        positive(correlation),
        decay,
        deviations.collect(),
    ))
}

/// The correlation matrix with its small and negative eigenvalues raised: pooling over pairs of which some take no part may leave such.
fn positive(correlation: DMatrix<f64>) -> DMatrix<f64> {
    let mut eigen = correlation.symmetric_eigen();
    eigen
        .eigenvalues
        .iter_mut()
        .for_each(|l| *l = l.max(LEAST_EIGENVALUE));
    let raised = eigen.recompose();
    DMatrix::from_fn(raised.nrows(), raised.ncols(), |i, j| {
        if i == j {
            return 1.0;
        }
        // From one triangle, so that it is symmetric to the last bit.
        let (i, j) = (i.max(j), i.min(j));
        raised[(i, j)] / (raised[(i, i)] * raised[(j, j)]).sqrt()
    })
}

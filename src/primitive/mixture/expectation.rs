//! Expectation maximisation (Dempster, Laird and Rubin, J. Royal Statistical Society B 39, 1977).

use nalgebra::{DMatrix, DVector};

use super::normalized;
use crate::error::{Error, ErrorKind, Result};
use crate::primitive::Estimator;
use crate::primitive::likelihood::Likelihood;
use crate::primitive::scatter::{Charted, Scatter};

/// A kind of fewer effective demonstrations has collapsed: two and a half are three of which one is half another's.
pub(super) const FEWEST: f64 = 2.5;

/// How many demonstrations the variances of all kinds together count for in each of them: as many as a kind needs. Without it, three kinds of 34 real recordings made
/// left-out ones less probable than one kind did.
const PRIOR: f64 = 3.0;

/// A rise of the log-likelihood below this \[nats\] is none.
const NO_RISE: f64 = 1e-7;

/// Steps after which it is taken as it is.
const MOST_STEPS: usize = 200;

/// Kinds as they are told apart: by the structured target alone, whatever the estimator. In the span of the demonstrations that a kind has already these are
/// more probable than anything else, and would never leave it; the target has a mean, standard deviations and O(D^2) numbers besides.
const TELLING: Estimator = Estimator::Kronecker { weight: Some(1.0) };

/// What expectation maximisation came to.
pub(super) struct Maximum {
    /// M x C; zeros for a demonstration that takes no part.
    pub responsibilities: DMatrix<f64>,
    /// ln of the density of all that take part, after each step \[nats\]: it never falls.
    pub log_likelihoods: Vec<f64>,
    /// ln of the density of each demonstration, also of one that takes no part.
    pub log_densities: Vec<f64>,
}

/// From responsibilities (M x C) to a maximum of the likelihood. `present` says which demonstrations take part.
///
/// Standard deviations and correlations are shrunk estimates and not those of maximum likelihood, so a step can also lead down, by little: it is then not taken,
/// and the search is over.
pub(super) fn maximize(
    charted: &Charted,
    present: &[bool],
    start: DMatrix<f64>,
) -> Result<Maximum> {
    let mut best: Option<Maximum> = None;
    let mut responsibilities = start;
    for _ in 0..MOST_STEPS {
        let next = step(charted, present, &responsibilities)?;
        let found = next.log_likelihoods[0];
        match &mut best {
            Some(best)
                if found <= best.log_likelihoods[best.log_likelihoods.len() - 1] + NO_RISE =>
            {
                break;
            }
            _ => {}
        }
        let mut log_likelihoods = best.map_or(Vec::new(), |b| b.log_likelihoods);
        log_likelihoods.push(found);
        responsibilities = next.responsibilities.clone();
        best = Some(Maximum {
            log_likelihoods,
            ..next
        });
    }
    best.ok_or_else(|| Error::new(ErrorKind::Infeasible, "no step of expectation maximisation"))
}

/// Shrinks the variances of each kind to the mean of those of all kinds, as if so many demonstrations more had shown it: a few demonstrations happen to be alike
/// in some of some hundred coordinates, and those that were left out are not. One kind alone stays as it is.
fn pool(scatters: &mut [Scatter]) {
    let n = scatters.first().map_or(0, |s| s.deviations.len());
    for i in 0..n {
        let varies = |s: &&Scatter| s.deviations[i] > 0.0;
        let count: f64 = scatters.iter().filter(varies).map(|s| s.count).sum();
        let square = |s: &Scatter| s.count * s.deviations[i].powi(2);
        let common = scatters.iter().filter(varies).map(square).sum::<f64>() / count;
        for scatter in scatters.iter_mut().filter(|s| s.deviations[i] > 0.0) {
            let own = scatter.count * scatter.deviations[i].powi(2);
            scatter.deviations[i] = ((own + PRIOR * common) / (scatter.count + PRIOR)).sqrt();
        }
    }
}

/// Components from responsibilities, and responsibilities from these components.
fn step(charted: &Charted, present: &[bool], shares: &DMatrix<f64>) -> Result<Maximum> {
    let (count, kinds) = shares.shape();
    let takes_part = present.iter().filter(|p| **p).count() as f64;
    let vectors: Vec<&DVector<f64>> = charted.vectors.iter().collect();
    let mut scatters = Vec::with_capacity(kinds);
    let mut sums = Vec::with_capacity(kinds);
    for c in 0..kinds {
        let own: Vec<f64> = shares
            .column(c)
            .iter()
            .zip(present)
            .map(|(r, present)| if *present { *r } else { 0.0 })
            .collect();
        let sum: f64 = own.iter().sum();
        // Many that are hardly of a kind are none, and neither is one that is wholly of it.
        let square: f64 = own.iter().map(|r| r * r).sum();
        let effective = sum.min(sum * sum / square.max(f64::MIN_POSITIVE));
        // One kind alone is the plain primitive, for which two demonstrations do.
        if kinds > 1 && effective < FEWEST {
            return Err(Error::new(
                ErrorKind::Infeasible,
                format!("one of {kinds} kinds is left with {effective:.1} demonstrations"),
            )
            .expected(format!(
                "at least {FEWEST} effective demonstrations in each"
            ))
            .help("look for fewer kinds, or record more of each"));
        }
        scatters.push(charted.scatter(&own));
        sums.push(sum);
    }
    pool(&mut scatters);
    let mut joint = DMatrix::zeros(count, kinds);
    for (c, scatter) in scatters.iter().enumerate() {
        let gaussian = TELLING.gaussian(scatter)?;
        let likelihood = Likelihood::of(&scatter.chart, &gaussian)?;
        let of_kind = libm::log(sums[c] / takes_part);
        for (m, l) in likelihood.logarithms(&vectors)?.into_iter().enumerate() {
            joint[(m, c)] = of_kind + l;
        }
    }
    let mut responsibilities = DMatrix::zeros(count, kinds);
    let mut log_densities = Vec::with_capacity(count);
    for m in 0..count {
        let row: Vec<f64> = joint.row(m).iter().copied().collect();
        let (logarithm, shares) = normalized(&row).ok_or_else(|| {
            Error::new(ErrorKind::Infeasible, "a demonstration of no kind")
                .expected("finite densities")
        })?;
        log_densities.push(logarithm);
        if present[m] {
            for (c, share) in shares.into_iter().enumerate() {
                responsibilities[(m, c)] = share;
            }
        }
    }
    let taking_part = log_densities.iter().zip(present).filter(|(_, p)| **p);
    Ok(Maximum {
        responsibilities,
        log_likelihoods: vec![taking_part.map(|(l, _)| l).sum()],
        log_densities,
    })
}

//! The textbook: a Gaussian given linear observations by the Schur complement of its dense covariance, in double-double arithmetic.
//!
//! It shares nothing with the library but the parts of the prior: V = A Sigma A^T + noise is formed and factored, which the
//! library never does.

use nalgebra::{DMatrix, DVector};
use undulate::{Covariance, FourierMovementPrimitive, Gaussian, LinearObservation};

use crate::double_double::DoubleDouble;

/// Sigma = F F^T + sum S (A (x) R) S + diag(s)^2, R_{kl} = rho^|k-l|.
fn dense(prior: &Covariance) -> DMatrix<DoubleDouble> {
    let number = DoubleDouble::from;
    let n = prior.dimension();
    let factor = prior.factor();
    let mut sigma = DMatrix::from_fn(n, n, |i, j| {
        let products = (0..factor.ncols()).map(|r| number(factor[(i, r)]) * number(factor[(j, r)]));
        products.sum::<DoubleDouble>()
    });
    for block in prior.blocks() {
        let harmonics = block.len() / block.correlation().nrows();
        let mut powers = vec![number(1.0)];
        for k in 1..harmonics {
            powers.push(powers[k - 1] * number(block.decay()));
        }
        let deviation = |i: usize| number(block.deviations()[i]);
        for i in 0..block.len() {
            for j in 0..block.len() {
                let joints = block.correlation()[(i / harmonics, j / harmonics)];
                let lag = (i % harmonics).abs_diff(j % harmonics);
                let at = (block.start() + i, block.start() + j);
                let correlation = number(joints) * powers[lag];
                sigma[at] = sigma[at] + deviation(i) * deviation(j) * correlation;
            }
        }
    }
    for i in 0..n {
        let alone = number(prior.independent()[i]);
        sigma[(i, i)] = sigma[(i, i)] + alone * alone;
    }
    sigma
}

/// What the oracle takes for granted, and its broken twins do not.
pub struct Textbook {
    /// Of G A Sigma in the covariance.
    pub sign: f64,
    /// The variance of an observation's noise, of its standard deviation.
    pub variance: fn(f64) -> f64,
}

pub const TEXTBOOK: Textbook = Textbook {
    sign: -1.0,
    variance: |deviation| deviation * deviation,
};

pub struct Moments {
    pub mean: DVector<f64>,
    pub covariance: DMatrix<f64>,
}

impl Moments {
    pub fn of(primitive: &FourierMovementPrimitive) -> Self {
        Self {
            mean: primitive.gaussian().mean().clone(),
            covariance: primitive.gaussian().covariance(),
        }
    }
}

/// mu + Sigma A^T V^-1 (b - A mu) and Sigma - Sigma A^T V^-1 A Sigma, V = A Sigma A^T + noise = L L^T.
pub fn schur(prior: &Gaussian, given: &[LinearObservation], textbook: &Textbook) -> Moments {
    let number = DoubleDouble::from;
    let sigma = dense(prior.prior_covariance());
    let (n, m) = (sigma.nrows(), given.len());
    let sum = |row: &[(usize, f64)], at: &dyn Fn(usize) -> DoubleDouble| -> DoubleDouble {
        row.iter().map(|(i, c)| number(*c) * at(*i)).sum()
    };
    let mean = |i: usize| number(prior.prior_mean()[i]);
    // One row an observation: of A Sigma, then b - A mu; forward substitution works on all of it.
    let mut rows = DMatrix::from_fn(m, n + 1, |p, j| {
        let row = &given[p].row;
        if j < n {
            sum(row, &|i| sigma[(i, j)])
        } else {
            number(given[p].value) - sum(row, &mean)
        }
    });
    let mut root = DMatrix::from_fn(m, m, |p, q| {
        let noise = if p == q {
            (textbook.variance)(given[p].deviation)
        } else {
            0.0
        };
        sum(&given[q].row, &|i| rows[(p, i)]) + number(noise)
    });
    for p in 0..m {
        for q in 0..=p {
            let known: DoubleDouble = (0..q).map(|k| root[(p, k)] * root[(q, k)]).sum();
            let rest = root[(p, q)] - known;
            root[(p, q)] = if p == q {
                assert!(rest.rounded() > 0.0, "row {p} of the oracle's V depends");
                rest.sqrt()
            } else {
                rest / root[(q, q)]
            };
        }
    }
    for j in 0..=n {
        for p in 0..m {
            let known: DoubleDouble = (0..p).map(|q| root[(p, q)] * rows[(q, j)]).sum();
            rows[(p, j)] = (rows[(p, j)] - known) / root[(p, p)];
        }
    }
    let explained =
        |i: usize, j: usize| -> DoubleDouble { (0..m).map(|p| rows[(p, i)] * rows[(p, j)]).sum() };
    let mut covariance = DMatrix::zeros(n, n);
    for i in 0..n {
        for j in 0..=i {
            let entry = sigma[(i, j)] + number(textbook.sign) * explained(i, j);
            covariance[(i, j)] = entry.rounded();
            covariance[(j, i)] = entry.rounded();
        }
    }
    Moments {
        mean: DVector::from_fn(n, |i, _| (mean(i) + explained(i, n)).rounded()),
        covariance,
    }
}

/// The largest of four relative errors: mean and covariance, as they are and in units of the prior's standard deviations.
/// What is zero but for rounding is compared with the prior's covariance instead.
pub fn error(prior: &Gaussian, found: &Moments, expected: &Moments) -> f64 {
    let of_prior = prior.prior_covariance().dense();
    let units = of_prior
        .diagonal()
        .map(|v| if v > 0.0 { 1.0 / v.sqrt() } else { 0.0 });
    let units = DMatrix::from_diagonal(&units);
    let relative = |error: f64, expected: f64, prior: f64| {
        let zero = expected < 1e-12 * prior;
        error / if zero { prior } else { expected }
    };
    let shift = &found.mean - &expected.mean;
    let difference = &found.covariance - &expected.covariance;
    let scaled = |m: &DMatrix<f64>| (&units * m * &units).norm();
    [
        shift.norm() / expected.mean.norm(),
        (&units * shift).norm() / (&units * &expected.mean).norm(),
        relative(
            difference.norm(),
            expected.covariance.norm(),
            of_prior.norm(),
        ),
        relative(
            scaled(&difference),
            scaled(&expected.covariance),
            scaled(&of_prior),
        ),
    ]
    .into_iter()
    .fold(
        0.0,
        |worst, e| if e > worst || e.is_nan() { e } else { worst },
    )
}

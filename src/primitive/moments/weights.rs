//! The first two moments of the Fourier weights, as functions of mu and Sigma.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use crate::primitive::{LogPolar, OffsetForm};

/// One Fourier weight of one joint, as a function of x.
pub(super) struct Weight {
    pub harmonic: usize,
    /// Where its real part stands in the vector of real numbers.
    pub at: usize,
    pub kind: Kind,
}

pub(super) enum Kind {
    /// x_i.
    Linear(usize),
    /// sign exp(x_l + i x_p): index of the logarithm and of the phase, and E.
    Exponential {
        logarithm: usize,
        phase: Option<usize>,
        mean: Complex<f64>,
    },
}

/// Sigma of x with every phase absolute.
pub(super) fn absolute(chart: &LogPolar, mut sigma: DMatrix<f64>) -> DMatrix<f64> {
    let (phases, offsets) = chart.starts();
    for mut column in sigma.column_iter_mut() {
        chart
            .phases()
            .absolute(&mut column.as_mut_slice()[phases..offsets]);
    }
    sigma.transpose_mut();
    for mut column in sigma.column_iter_mut() {
        chart
            .phases()
            .absolute(&mut column.as_mut_slice()[phases..offsets]);
    }
    sigma
}

/// Joint by joint, offset first.
pub(super) fn weights(chart: &LogPolar, mu: &DVector<f64>, sigma: &DMatrix<f64>) -> Vec<Weight> {
    let (phases, offsets) = chart.starts();
    let harmonics = chart.harmonics();
    let mut weights = Vec::with_capacity(chart.joints().len() * (harmonics + 1));
    for d in 0..chart.joints().len() {
        let at = d * (2 * harmonics + 1);
        let i = offsets + d;
        let sign = match chart.offset_forms()[d] {
            OffsetForm::Signed => None,
            OffsetForm::Positive => Some(1.0),
            OffsetForm::Negative => Some(-1.0),
        };
        weights.push(Weight {
            harmonic: 0,
            at,
            kind: sign.map_or(Kind::Linear(i), |sign| Kind::Exponential {
                logarithm: i,
                phase: None,
                mean: Complex::from(sign * (mu[i] + sigma[(i, i)] / 2.0).exp()),
            }),
        });
        for k in 1..=harmonics {
            let l = d * harmonics + k - 1;
            let p = phases + l;
            let exponent = Complex::new(
                mu[l] + (sigma[(l, l)] - sigma[(p, p)]) / 2.0,
                mu[p] + sigma[(l, p)],
            );
            weights.push(Weight {
                harmonic: k,
                at: at + 2 * k - 1,
                kind: Kind::Exponential {
                    logarithm: l,
                    phase: Some(p),
                    mean: exponent.exp(),
                },
            });
        }
    }
    weights
}

/// Covariance E a conj(b) - E a conj(E b) and pseudo-covariance E a b - E a E b of two weights, start included.
pub(super) fn pair(
    one: &Weight,
    other: &Weight,
    sigma: &DMatrix<f64>,
    f: impl Fn(f64) -> f64,
) -> (Complex<f64>, Complex<f64>) {
    let at = |i: Option<usize>, j: Option<usize>| match (i, j) {
        (Some(i), Some(j)) => sigma[(i, j)],
        _ => 0.0,
    };
    match (&one.kind, &other.kind) {
        (Kind::Linear(i), Kind::Linear(j)) => {
            let covariance = Complex::from(sigma[(*i, *j)]);
            (covariance, covariance)
        }
        (
            Kind::Linear(i),
            Kind::Exponential {
                logarithm,
                phase,
                mean,
            },
        ) => {
            let stein = Complex::new(sigma[(*i, *logarithm)], at(Some(*i), *phase));
            let pseudo = mean * stein * f(other.harmonic as f64);
            (pseudo.conj(), pseudo)
        }
        (
            Kind::Exponential {
                logarithm,
                phase,
                mean,
            },
            Kind::Linear(i),
        ) => {
            let stein = Complex::new(sigma[(*logarithm, *i)], at(*phase, Some(*i)));
            let covariance = mean * stein * f(one.harmonic as f64);
            (covariance, covariance)
        }
        (
            Kind::Exponential {
                logarithm: l,
                phase: p,
                mean: a,
            },
            Kind::Exponential {
                logarithm: m,
                phase: q,
                mean: b,
            },
        ) => {
            let (ll, pp) = (sigma[(*l, *m)], at(*p, *q));
            let (pl, lp) = (at(*p, Some(*m)), at(Some(*l), *q));
            let (j, k) = (one.harmonic as f64, other.harmonic as f64);
            let apart = f(j) * f(k);
            let hermitian = a
                * b.conj()
                * (expm1(Complex::new(ll + pp, pl - lp)) * f(j - k) + (f(j - k) - apart));
            let pseudo =
                a * b * (expm1(Complex::new(ll - pp, pl + lp)) * f(j + k) + (f(j + k) - apart));
            (hermitian, pseudo)
        }
    }
}

/// exp(z) - 1 without cancellation near 0.
fn expm1(z: Complex<f64>) -> Complex<f64> {
    let half = (z.im / 2.0).sin();
    Complex::new(
        z.re.exp_m1() * z.im.cos() - 2.0 * half * half,
        z.re.exp() * z.im.sin(),
    )
}

//! Expectation maximisation once more, from the formulas and on dense matrices.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use std::f64::consts::{PI, TAU};
use undulate::Wave;

/// What is done wrong on purpose.
#[derive(Clone, Copy, PartialEq)]
pub enum Twin {
    Sound,
    PhasesNotWrapped,
    NotNormalized,
    NotPooled,
}

pub struct Outcome {
    pub log_likelihoods: Vec<f64>,
    pub responsibilities: DMatrix<f64>,
}

fn wrapped(angle: f64) -> f64 {
    let turned = angle.rem_euclid(TAU);
    if turned > PI { turned - TAU } else { turned }
}

/// Of one coordinate: mean, variance and direction.
struct Column {
    mean: f64,
    variance: f64,
    direction: DVector<f64>,
}

/// Of all waves: log moduli, phases relative to the first joint, offsets.
struct Vectors {
    x: DMatrix<f64>,
    /// What each phase is weighted by.
    amplitudes: DMatrix<f64>,
    joints: usize,
    harmonics: usize,
}

impl Vectors {
    fn of(waves: &[Wave]) -> Self {
        let (joints, harmonics) = waves[0].weights().shape();
        let angles = joints * harmonics;
        let mut x = DMatrix::zeros(waves.len(), 2 * angles + joints);
        let mut amplitudes = DMatrix::zeros(waves.len(), angles);
        for (m, wave) in waves.iter().enumerate() {
            for d in 0..joints {
                for k in 0..harmonics {
                    let i = d * harmonics + k;
                    let (own, reference) = (wave.weights()[(d, k)], wave.weights()[(0, k)]);
                    x[(m, i)] = own.norm().ln();
                    let relative = if d == 0 { own } else { own / reference };
                    x[(m, angles + i)] = relative.arg();
                    let anchor = if d == 0 { 1.0 } else { reference.norm() };
                    amplitudes[(m, i)] = own.norm() * anchor;
                }
                x[(m, 2 * angles + d)] = wave.offsets()[d];
            }
        }
        Self {
            x,
            amplitudes,
            joints,
            harmonics,
        }
    }

    fn angles(&self) -> std::ops::Range<usize> {
        let count = self.joints * self.harmonics;
        count..2 * count
    }

    fn column(&self, i: usize, shares: &DVector<f64>) -> Column {
        let values = self.x.column(i);
        let weighted = |weights: &DVector<f64>, deviations: DVector<f64>| {
            let direction = deviations.component_mul(&weights.map(f64::sqrt));
            direction.normalize()
        };
        if self.angles().contains(&i) {
            let own = self.amplitudes.column(i - self.angles().start);
            let mut weights = shares.component_mul(&own);
            weights /= weights.sum();
            let pairs = values.iter().zip(&weights);
            let sum: Complex<f64> = pairs.map(|(v, w)| Complex::from_polar(*w, *v)).sum();
            let effective = 1.0 / weights.norm_squared();
            let square = (effective * sum.norm_sqr() - 1.0) / (effective - 1.0);
            let deviations = values.map(|v| wrapped(v - sum.arg()));
            return Column {
                mean: sum.arg(),
                variance: -square.ln(),
                direction: weighted(&weights, deviations),
            };
        }
        let total = shares.sum();
        let mean = values.dot(shares) / total;
        let deviations = values.map(|v| v - mean);
        Column {
            mean,
            variance: deviations.map(|d| d * d).dot(shares) / total,
            direction: weighted(shares, deviations),
        }
    }

    /// The correlation of `length` harmonics of each joint from coordinate `start` on, in the whole matrix.
    fn block(
        &self,
        columns: &[Column],
        count: f64,
        (start, length): (usize, usize),
        sigma: &mut DMatrix<f64>,
    ) {
        let at = |d: usize, k: usize| start + d * length + k;
        let dot = |i: usize, j: usize| columns[i].direction.dot(&columns[j].direction);
        let joints = self.joints;
        let pooled = DMatrix::from_fn(joints, joints, |d, e| {
            (0..length).map(|k| dot(at(d, k), at(e, k))).sum::<f64>() / length as f64
        });
        let p = joints as f64;
        let (square, trace) = (pooled.norm_squared(), pooled.trace());
        let n = count * length as f64;
        let numerator = (1.0 - 2.0 / p) * square + trace * trace;
        let shrink = (numerator / ((n + 1.0 - 2.0 / p) * (square - trace * trace / p))).min(1.0);
        let a = pooled * (1.0 - shrink) + DMatrix::identity(joints, joints) * shrink;
        let neighbours: Vec<f64> = (0..joints)
            .flat_map(|d| (1..length).map(move |k| (d, k)))
            .map(|(d, k)| dot(at(d, k - 1), at(d, k)))
            .collect();
        let rho: f64 = if neighbours.is_empty() {
            0.0
        } else {
            neighbours.iter().sum::<f64>() / neighbours.len() as f64
        };
        for (d, k) in (0..joints).flat_map(|d| (0..length).map(move |k| (d, k))) {
            for (e, l) in (0..joints).flat_map(|e| (0..length).map(move |l| (e, l))) {
                let (i, j) = (at(d, k), at(e, l));
                let scale = (columns[i].variance * columns[j].variance).sqrt();
                sigma[(i, j)] = scale * a[(d, e)] * rho.powi(k.abs_diff(l) as i32);
            }
        }
    }
}

/// ln N(deviation; 0, sigma).
pub fn log_normal(deviation: &DVector<f64>, sigma: &DMatrix<f64>) -> f64 {
    let cholesky = sigma.clone().cholesky().unwrap();
    let quadratic = deviation.dot(&cholesky.solve(deviation));
    let determinant: f64 = cholesky.l().diagonal().iter().map(|l| l.ln()).sum();
    -0.5 * (quadratic + deviation.len() as f64 * TAU.ln()) - determinant
}

/// So many steps from responsibilities (M x C).
pub fn expectation_maximization(
    waves: &[Wave],
    start: &DMatrix<f64>,
    steps: usize,
    twin: Twin,
) -> Outcome {
    let vectors = Vectors::of(waves);
    let (count, kinds) = start.shape();
    let n = vectors.x.ncols();
    let mut responsibilities = start.clone();
    let mut log_likelihoods = Vec::new();
    for _ in 0..steps {
        let mut parts = Vec::new();
        for c in 0..kinds {
            let shares: DVector<f64> = responsibilities.column(c).into_owned();
            let columns: Vec<Column> = (0..n).map(|i| vectors.column(i, &shares)).collect();
            let effective = shares.sum().powi(2) / shares.norm_squared();
            parts.push((shares.sum() / count as f64, effective, columns));
        }
        if kinds > 1 && twin != Twin::NotPooled {
            let total: f64 = parts.iter().map(|(_, n, _)| n).sum();
            for i in 0..n {
                let terms = parts.iter().map(|(_, n, columns)| n * columns[i].variance);
                let common = terms.sum::<f64>() / total;
                for (_, n, columns) in &mut parts {
                    columns[i].variance = (*n * columns[i].variance + 3.0 * common) / (*n + 3.0);
                }
            }
        }
        let mut joint = DMatrix::zeros(count, kinds);
        for (c, (weight, effective, columns)) in parts.iter().enumerate() {
            let mut sigma = DMatrix::zeros(n, n);
            let angles = vectors.angles();
            for (start, length) in [
                (0, vectors.harmonics),
                (angles.start, vectors.harmonics),
                (angles.end, 1),
            ] {
                vectors.block(columns, *effective, (start, length), &mut sigma);
            }
            sigma += DMatrix::identity(n, n) * 1e-6;
            for m in 0..count {
                let deviation = DVector::from_fn(n, |i, _| {
                    let deviation = vectors.x[(m, i)] - columns[i].mean;
                    if angles.contains(&i) && twin != Twin::PhasesNotWrapped {
                        wrapped(deviation)
                    } else {
                        deviation
                    }
                });
                joint[(m, c)] = weight.ln() + log_normal(&deviation, &sigma);
            }
        }
        let mut log_likelihood = 0.0;
        for m in 0..count {
            let densities: Vec<f64> = joint.row(m).iter().map(|l: &f64| l.exp()).collect();
            let sum: f64 = densities.iter().sum();
            log_likelihood += sum.ln();
            for (c, density) in densities.iter().enumerate() {
                let most = densities.iter().copied().fold(0.0, f64::max);
                let by = if twin == Twin::NotNormalized {
                    most
                } else {
                    sum
                };
                responsibilities[(m, c)] = density / by;
            }
        }
        log_likelihoods.push(log_likelihood);
    }
    Outcome {
        log_likelihoods,
        responsibilities,
    }
}

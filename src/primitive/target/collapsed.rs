//! Via-points with the offsets integrated out: given all else, positions are linear in them.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::{Posterior, Target, ViaPoint, WeightGradient};
use crate::error::Result;
use crate::fourier::Wave;
use crate::normal;
use crate::posterior::{EllipticalSlice, Hamiltonian, Schedule, Transition, run};
use crate::primitive::{FourierMovementPrimitive, OffsetForm, stream};

/// Up to so many points slices are the faster transition.
const FEW: usize = 3;

/// Slices for each transition of a schedule: one is cheap, and moves about a quarter as far as a trajectory.
const SLICES: usize = 4;

/// Chain c draws the offsets from stream 2^32 + c: no chain has so large a number.
const OFFSET_STREAMS: u64 = 1 << 32;

/// The part of a draw that moves offsets and nothing else is o = B_o z_o, z_o standard normal. With P the matrix that picks the joints of the
/// points, what all other numbers say of the positions is y_0, and the likelihood of them alone
///
/// ```text
/// v - y_0 ~ N(0, C),   C = P B_o B_o^T P^T + diag(deviation)^2
/// ```
///
/// while z_o given them is normal again: z_o = z* + (P B_o)^T C^-1 (v - y_0 - P B_o z* - noise*), by Matheron's rule.
pub(super) struct Collapsed<'a> {
    primitive: &'a FourierMovementPrimitive,
    points: Vec<&'a ViaPoint>,
    joints: Vec<usize>,
    /// Where z_o is among the latent numbers.
    own: std::ops::Range<usize>,
    /// P B_o (points x z_o).
    map: DMatrix<f64>,
    cholesky: Cholesky<f64, Dyn>,
    /// Of each point, 2 cos(k w t) and -2 sin(k w t).
    rows: Vec<Vec<(f64, f64)>>,
}

impl<'a> Collapsed<'a> {
    /// If all targets are via-points, and offsets have latent numbers of their own that nothing observed holds.
    pub fn of(primitive: &'a FourierMovementPrimitive, targets: &'a [Target]) -> Option<Self> {
        let chart = primitive.chart();
        let period = chart.period()?;
        if targets.is_empty()
            || chart
                .offset_forms()
                .iter()
                .any(|f| *f != OffsetForm::Signed)
        {
            return None;
        }
        let points: Vec<&ViaPoint> = targets
            .iter()
            .map(|target| match target {
                Target::ViaPoint(point) => Some(point),
                Target::Band(_) => None,
            })
            .collect::<Option<_>>()?;
        let joints: Vec<usize> = points
            .iter()
            .map(|point| chart.joints().index(&point.joint).ok())
            .collect::<Option<_>>()?;
        let (_, start) = chart.starts();
        let own = primitive.gaussian().untouched_latent(start)?;
        let columns: Vec<DVector<f64>> = own
            .clone()
            .map(|i| {
                let mut z = vec![0.0; primitive.latent()];
                z[i] = 1.0;
                let x = primitive.gaussian().at_latent(&mut z) - primitive.gaussian().mean();
                DVector::from_iterator(joints.len(), joints.iter().map(|d| x[start + d]))
            })
            .collect();
        let map = DMatrix::from_columns(&columns);
        let mut covariance = &map * map.transpose();
        for (i, point) in points.iter().enumerate() {
            covariance[(i, i)] += point.deviation.powi(2);
        }
        let rows = points
            .iter()
            .map(|point| {
                let turns = point.time / period;
                let angle = std::f64::consts::TAU * (turns - libm::floor(turns));
                (1..=chart.harmonics())
                    .map(|k| {
                        let (sin, cos) = libm::sincos(k as f64 * angle);
                        (2.0 * cos, -2.0 * sin)
                    })
                    .collect()
            })
            .collect();
        Some(Self {
            primitive,
            points,
            joints,
            own,
            map,
            cholesky: covariance.cholesky()?,
            rows,
        })
    }

    /// The wave of `z` without what offsets do alone, and v - y_0.
    fn residual(&self, z: &mut [f64]) -> (Wave, DVector<f64>) {
        z[self.own.clone()].fill(0.0);
        let wave = self.primitive.wave_at(z);
        let residual = DVector::from_fn(self.points.len(), |i, _| {
            let d = self.joints[i];
            let mut position = wave.offsets()[d];
            for (weight, (cos, sin)) in wave.weights().row(d).iter().zip(&self.rows[i]) {
                position += weight.re * cos + weight.im * sin;
            }
            self.points[i].position - position
        });
        (wave, residual)
    }

    fn log_likelihood(&self, mut residual: DVector<f64>) -> f64 {
        self.cholesky
            .l_dirty()
            .solve_lower_triangular_mut(&mut residual);
        -0.5 * residual.norm_squared()
    }

    /// The log-likelihood and its gradient over the latent numbers, of which offsets' own have none: C^-1 (v - y_0) is that over positions.
    pub fn with_gradient(&self, z: &mut [f64]) -> (f64, Vec<f64>) {
        let (wave, residual) = self.residual(z);
        let mut gradient = WeightGradient::zeros(wave.joints().len(), wave.harmonics());
        let slopes = self.cholesky.solve(&residual);
        for ((slope, d), row) in slopes.iter().zip(&self.joints).zip(&self.rows) {
            gradient.offsets[*d] += slope;
            for (weight, (cos, sin)) in gradient.weights.row_mut(*d).iter_mut().zip(row) {
                weight.re += slope * cos;
                weight.im += slope * sin;
            }
        }
        let mut gradient = gradient.latent(self.primitive, &wave);
        gradient[self.own.clone()].fill(0.0);
        (self.log_likelihood(residual), gradient)
    }

    /// Chains over all other numbers, completed by offsets.
    pub fn posterior(&self, schedule: &Schedule, seed: u64) -> Result<Posterior> {
        let n = self.primitive.latent();
        let others: Vec<usize> = (0..n).filter(|i| !self.own.contains(i)).collect();
        let mut z = vec![0.0; n];
        let spread = |short: &[f64], z: &mut [f64]| {
            for (i, value) in others.iter().zip(short) {
                z[*i] = *value;
            }
        };
        if self.points.len() <= FEW {
            let transition = EllipticalSlice::new(others.len(), |short: &DVector<f64>| {
                spread(short.as_slice(), &mut z);
                self.log_likelihood(self.residual(&mut z).1)
            });
            let schedule = Schedule {
                thinning: schedule.thinning.saturating_mul(SLICES),
                ..schedule.clone()
            };
            return self.completed(transition, &others, &schedule, seed);
        }
        let transition = Hamiltonian::new(others.len(), |short: &[f64], gradient: &mut [f64]| {
            spread(short, &mut z);
            let (value, whole) = self.with_gradient(&mut z);
            for (g, i) in gradient.iter_mut().zip(&others) {
                *g = whole[*i];
            }
            value
        });
        self.completed(transition, &others, schedule, seed)
    }

    fn completed(
        &self,
        mut transition: impl Transition,
        others: &[usize],
        schedule: &Schedule,
        seed: u64,
    ) -> Result<Posterior> {
        let n = self.primitive.latent();
        let draws = run(&mut transition, schedule, |chain| stream(seed, chain))?;
        let mut latent = Vec::new();
        let mut log_likelihoods = Vec::new();
        for (c, chain) in draws.chains().iter().enumerate() {
            let mut rng = stream(seed, OFFSET_STREAMS + c as u64);
            let completed = chain.z().column_iter().map(|short| {
                let mut z = vec![0.0; n];
                for (i, value) in others.iter().zip(short.iter()) {
                    z[*i] = *value;
                }
                let (_, residual) = self.residual(&mut z.clone());
                let mut normals = vec![0.0; self.own.len() + self.points.len()];
                normal::fill(&mut rng, &mut normals);
                let noise = normals.split_off(self.own.len());
                let mut own = DVector::from_vec(normals);
                let mut apart = residual - &self.map * &own;
                for ((r, point), e) in apart.iter_mut().zip(&self.points).zip(noise) {
                    *r -= point.deviation * e;
                }
                own += self.map.tr_mul(&self.cholesky.solve(&apart));
                z[self.own.clone()].copy_from_slice(own.as_slice());
                z
            });
            latent.push(completed.collect());
            log_likelihoods.push(chain.log_likelihoods().to_vec());
        }
        Ok(Posterior::new(self.primitive, latent, log_likelihoods))
    }
}

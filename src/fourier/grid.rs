//! Evaluation on a uniform grid over one period, four points for the work of one.

use nalgebra::DMatrix;

use super::{Derivative, Wave};

/// Points computed together: independent sums, so that the compiler may use vectors without changing a result.
const LANES: usize = 4;

/// The grid t_n = n T / N, n = 0..N, with the cosines and sines of every harmonic up to K on it.
///
/// Build it once and evaluate many waves on it. It depends on N and K, not on T.
///
/// The sum over the harmonics splits into an even and an odd part in time (cosines, sines), and each of them into the
/// even and the odd harmonics; from these four, for even N, follow the values at n, N/2 - n, N/2 + n and N - n.
/// So a quarter of the grid is summed. The order of summation is fixed: the same bits everywhere.
#[derive(Debug, Clone)]
pub struct PeriodGrid {
    points: usize,
    harmonics: usize,
    /// Points to sum, rounded up to whole blocks of `LANES`.
    blocks: usize,
    /// Block by block, harmonic by harmonic: `LANES` cosines, then `LANES` sines.
    table: Vec<[[f64; LANES]; 2]>,
}

impl PeriodGrid {
    /// A grid of `points` for waves of up to `harmonics` harmonics.
    pub fn new(points: usize, harmonics: usize) -> Self {
        let turn: Vec<(f64, f64)> = (0..points)
            .map(|n| libm::sincos(std::f64::consts::TAU * n as f64 / points as f64))
            .collect();
        let base = if points == 0 {
            0
        } else if points.is_multiple_of(2) {
            points / 4 + 1
        } else {
            points / 2 + 1
        };
        let blocks = base.div_ceil(LANES);
        let mut table = Vec::with_capacity(blocks * harmonics);
        for block in 0..blocks {
            for k in 1..=harmonics {
                let at = |lane: usize| turn[(k * (block * LANES + lane)) % points];
                table.push([
                    std::array::from_fn(|lane| at(lane).1),
                    std::array::from_fn(|lane| at(lane).0),
                ]);
            }
        }
        Self {
            points,
            harmonics,
            blocks,
            table,
        }
    }

    /// Number of points, N.
    pub fn points(&self) -> usize {
        self.points
    }

    /// The times n T / N \[s\] for a period of T.
    pub fn times(&self, period: f64) -> Vec<f64> {
        (0..self.points)
            .map(|n| period * n as f64 / self.points as f64)
            .collect()
    }

    /// N x D. A wave with more harmonics than the tables hold is evaluated by a grid of its own.
    pub(super) fn evaluate(&self, wave: &Wave, derivative: Derivative) -> DMatrix<f64> {
        if wave.harmonics() > self.harmonics {
            return Self::new(self.points, wave.harmonics()).evaluate(wave, derivative);
        }
        let joints = wave.joints().len();
        let order = derivative.order();
        let mut values = DMatrix::zeros(self.points, joints);
        // Twice the weights of the derivative, as cosine and sine coefficients of one joint.
        let mut coefficients = vec![(0.0, 0.0); wave.harmonics()];
        for d in 0..joints {
            let offset = if order == 0 { wave.offsets()[d] } else { 0.0 };
            for (k, c) in coefficients.iter_mut().enumerate() {
                let weight = wave.weights()[(d, k)];
                let scale = 2.0
                    * (0..order).fold(1.0, |s, _| s * (k + 1) as f64 * wave.angular_frequency());
                // Multiplication by i^order, spelt out: exact.
                let (re, im) = match order % 4 {
                    0 => (weight.re, weight.im),
                    1 => (-weight.im, weight.re),
                    2 => (-weight.re, -weight.im),
                    _ => (weight.im, -weight.re),
                };
                *c = (scale * re, -scale * im);
            }
            self.fold(offset, &coefficients, values.column_mut(d).as_mut_slice());
        }
        values
    }

    fn fold(&self, offset: f64, coefficients: &[(f64, f64)], values: &mut [f64]) {
        let n_points = self.points;
        for block in 0..self.blocks {
            let tables = &self.table[block * self.harmonics..][..coefficients.len()];
            // [even harmonics, odd harmonics] of the part even and the part odd in time.
            let mut even = [[0.0; LANES]; 2];
            let mut odd = [[0.0; LANES]; 2];
            for (k, (table, &(a, b))) in tables.iter().zip(coefficients).enumerate() {
                let parity = (k + 1) % 2;
                for lane in 0..LANES {
                    even[parity][lane] += a * table[0][lane];
                    odd[parity][lane] += b * table[1][lane];
                }
            }
            for lane in 0..LANES {
                let n = block * LANES + lane;
                if n_points.is_multiple_of(2) {
                    if n > n_points / 4 {
                        break;
                    }
                    let ([ce, co], [se, so]) =
                        ([even[0][lane], even[1][lane]], [odd[0][lane], odd[1][lane]]);
                    values[n] = offset + ((ce + co) + (se + so));
                    values[n_points / 2 - n] = offset + ((ce - co) - (se - so));
                    if n > 0 {
                        values[n_points - n] = offset + ((ce + co) - (se + so));
                        values[n_points / 2 + n] = offset + ((ce - co) + (se - so));
                    }
                } else {
                    if n > n_points / 2 {
                        break;
                    }
                    let cosines = even[0][lane] + even[1][lane];
                    let sines = odd[0][lane] + odd[1][lane];
                    values[n] = offset + (cosines + sines);
                    if n > 0 {
                        values[n_points - n] = offset + (cosines - sines);
                    }
                }
            }
        }
    }
}

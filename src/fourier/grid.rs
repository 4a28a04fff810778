//! Evaluation on a uniform grid over one period, four points for the work of one.

use nalgebra::DMatrix;

use super::{Derivative, Wave};

/// Points computed together: independent sums, so that the compiler may use vectors without changing a result.
const LANES: usize = 8;

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
    /// Points whose sums are formed; the rest follows from them.
    summed: usize,
    /// The same in whole blocks of `LANES`.
    blocks: usize,
    /// Of the even harmonics and of the odd ones: block by block, harmonic by harmonic, `LANES` cosines and `LANES` sines.
    tables: [Vec<[[f64; LANES]; 2]>; 2],
}

impl PeriodGrid {
    /// A grid of `points` for waves of up to `harmonics` harmonics.
    pub fn new(points: usize, harmonics: usize) -> Self {
        let turn: Vec<(f64, f64)> = (0..points)
            .map(|n| libm::sincos(std::f64::consts::TAU * n as f64 / points as f64))
            .collect();
        let summed = if points == 0 {
            0
        } else if points.is_multiple_of(2) {
            points / 4 + 1
        } else {
            points / 2 + 1
        };
        let blocks = summed.div_ceil(LANES);
        let mut tables = [Vec::new(), Vec::new()];
        for block in 0..blocks {
            for k in 1..=harmonics {
                let at = |lane: usize| turn[(k * (block * LANES + lane)) % points];
                tables[k % 2].push([
                    std::array::from_fn(|lane| at(lane).1),
                    std::array::from_fn(|lane| at(lane).0),
                ]);
            }
        }
        Self {
            points,
            harmonics,
            summed,
            blocks,
            tables,
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
        // By parity of the harmonic.
        let mut coefficients = [Vec::new(), Vec::new()];
        for d in 0..joints {
            let offset = if order == 0 { wave.offsets()[d] } else { 0.0 };
            coefficients.iter_mut().for_each(Vec::clear);
            for k in 0..wave.harmonics() {
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
                coefficients[(k + 1) % 2].push((scale * re, -scale * im));
            }
            self.fold(offset, &coefficients, values.column_mut(d).as_mut_slice());
        }
        values
    }

    fn fold(&self, offset: f64, coefficients: &[Vec<(f64, f64)>; 2], values: &mut [f64]) {
        let n = self.points;
        for block in 0..self.blocks {
            let [(even_cos, even_sin), (odd_cos, odd_sin)] = [0, 1].map(|parity| {
                let table = &self.tables[parity];
                sums(
                    &table[block * (table.len() / self.blocks)..],
                    &coefficients[parity],
                )
            });
            for lane in 0..LANES {
                let at = block * LANES + lane;
                if at >= self.summed {
                    return;
                }
                // The part even in time and the part odd in time, at `at` and at n/2 - `at`.
                let (cosines, sines) = (
                    even_cos[lane] + odd_cos[lane],
                    even_sin[lane] + odd_sin[lane],
                );
                values[at] = offset + (cosines + sines);
                if at > 0 {
                    values[n - at] = offset + (cosines - sines);
                }
                if n.is_multiple_of(2) {
                    let (cosines, sines) = (
                        even_cos[lane] - odd_cos[lane],
                        odd_sin[lane] - even_sin[lane],
                    );
                    values[n / 2 - at] = offset + (cosines + sines);
                    if at > 0 {
                        values[n / 2 + at] = offset + (cosines - sines);
                    }
                }
            }
        }
    }
}

/// Sums of the cosine and of the sine terms over the harmonics of one parity, for the points of a block.
#[inline(never)] // inlined, loops of different parity are woven into each other and become no vectors
fn sums(table: &[[[f64; LANES]; 2]], coefficients: &[(f64, f64)]) -> ([f64; LANES], [f64; LANES]) {
    let mut even = [0.0; LANES];
    let mut odd = [0.0; LANES];
    for ([cosines, sines], (a, b)) in table.iter().zip(coefficients) {
        for (sum, cos) in even.iter_mut().zip(cosines) {
            *sum += a * cos;
        }
        for (sum, sin) in odd.iter_mut().zip(sines) {
            *sum += b * sin;
        }
    }
    (even, odd)
}

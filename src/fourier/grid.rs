//! Evaluation on a uniform grid over one period, four points for the work of one.

use fearless_simd::{Level, Simd, SimdBase, dispatch, f64x8};
use nalgebra::DMatrix;

use super::{Derivative, Wave};

/// Points computed together.
const LANES: usize = 8;

/// Joints whose sums are formed together: with two, all of them fit into sixteen registers of four numbers.
const TOGETHER: usize = 2;

/// The grid t_n = n T / N, n = 0..N, with the cosines and sines of every harmonic up to K on it.
///
/// Build it once and evaluate many waves on it. It depends on N and K, not on T.
///
/// The sum over the harmonics splits into an even and an odd part in time (cosines, sines), and each of them into the
/// even and the odd harmonics; from these four, for even N, follow the values at n, N/2 - n, N/2 + n and N - n.
/// So a quarter of the grid is summed. The order of summation is fixed, and a point's sum never leaves its lane of a
/// vector, so the widest vectors that the processor has give the same bits as any other.
#[derive(Debug, Clone)]
pub struct PeriodGrid {
    points: usize,
    harmonics: usize,
    /// Points whose sums are formed; the rest follows from them.
    summed: usize,
    /// Block by block of points, the even harmonics and then the odd ones: cosines and sines.
    table: Vec<Terms>,
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
        let mut table = Vec::with_capacity(summed.div_ceil(LANES) * harmonics);
        for first in (0..summed).step_by(LANES) {
            for k in by_parity(harmonics) {
                let at = |lane: usize| turn[(k * (first + lane)) % points];
                table.push([
                    std::array::from_fn(|lane| at(lane).1),
                    std::array::from_fn(|lane| at(lane).0),
                ]);
            }
        }
        Self {
            points,
            harmonics,
            summed,
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

    /// N x D. A wave with more harmonics than the table holds is evaluated by a grid of its own.
    pub(super) fn evaluate(&self, wave: &Wave, derivative: Derivative) -> DMatrix<f64> {
        if wave.harmonics() > self.harmonics {
            return Self::new(self.points, wave.harmonics()).evaluate(wave, derivative);
        }
        let series = Series::new(wave, derivative);
        let mut values = DMatrix::zeros(self.points, series.offsets.len());
        dispatch!(Level::new(), simd => self.sum(simd, &series, values.as_mut_slice()));
        values
    }

    /// Fills `values`, N numbers a joint.
    #[inline(always)]
    fn sum<S: Simd>(&self, simd: S, series: &Series, values: &mut [f64]) {
        let joints = series.offsets.len();
        for first in (0..self.summed).step_by(LANES) {
            let whole = joints - joints % TOGETHER;
            for d in (0..whole).step_by(TOGETHER) {
                self.block::<S, TOGETHER>(simd, first, series, d, values);
            }
            for d in whole..joints {
                self.block::<S, 1>(simd, first, series, d, values);
            }
        }
    }

    /// The values that follow from the sums at `LANES` points from `first` on, for J joints from `d` on.
    #[inline(always)]
    fn block<S: Simd, const J: usize>(
        &self,
        simd: S,
        first: usize,
        series: &Series,
        d: usize,
        values: &mut [f64],
    ) {
        let table = &self.table[first / LANES * self.harmonics..][..self.harmonics];
        let (even, odd) = table.split_at(self.harmonics / 2);
        let pairs = series.parities();
        let joints = series.offsets.len();
        let even = sums::<S, J>(simd, even, pairs.0, joints, d);
        let odd = sums::<S, J>(simd, odd, pairs.1, joints, d);
        for j in 0..J {
            // The part even in time and the part odd in time; half a period later odd harmonics have changed their sign.
            let ([even_cos, even_sin], [odd_cos, odd_sin]) = (even[j], odd[j]);
            let (cos, sin) = (even_cos + odd_cos, even_sin + odd_sin);
            let (half_cos, half_sin) = (even_cos - odd_cos, even_sin - odd_sin);
            let offset = f64x8::splat(simd, series.offsets[d + j]);
            // Spelt out: the closure of an array's `map` would not be compiled for the vectors at hand.
            let after = offset + (cos + sin);
            let before = offset + (cos - sin);
            let half_after = offset + (half_cos + half_sin);
            let half_before = offset + (half_cos - half_sin);
            self.write(
                first,
                [after, before, half_after, half_before],
                &mut values[(d + j) * self.points..][..self.points],
            );
        }
    }

    /// Writes the values at n, N - n and, for even N, N/2 + n and N/2 - n, for the points n from `first` on.
    #[inline(always)]
    fn write<S: Simd>(&self, first: usize, values: [f64x8<S>; 4], column: &mut [f64]) {
        let (n, half) = (self.points, self.points / 2);
        let [after, before, half_after, half_before] = values;
        if first > 0 && first + LANES <= half {
            // Values beyond the quarter are written twice; the order of writing is fixed too.
            let last = first + LANES - 1;
            after.store_slice(&mut column[first..][..LANES]);
            before
                .reverse()
                .store_slice(&mut column[n - last..][..LANES]);
            if n.is_multiple_of(2) {
                half_after.store_slice(&mut column[half + first..][..LANES]);
                half_before
                    .reverse()
                    .store_slice(&mut column[half - last..][..LANES]);
            }
        } else {
            for lane in 0..LANES.min(self.summed - first) {
                let at = first + lane;
                column[at] = after[lane];
                column[(n - at) % n] = before[lane];
                if n.is_multiple_of(2) {
                    column[(half + at) % n] = half_after[lane];
                    column[half - at] = half_before[lane];
                }
            }
        }
    }
}

/// The cosines and the sines of a harmonic at points computed together.
type Terms = [[f64; LANES]; 2];

/// A derivative of a wave as y_d = offset + sum a cos + b sin.
struct Series {
    offsets: Vec<f64>,
    /// The pairs (a, b) of all joints, for the even harmonics and then for the odd ones.
    coefficients: Vec<[f64; 2]>,
    harmonics: usize,
}

impl Series {
    fn new(wave: &Wave, derivative: Derivative) -> Self {
        let order = derivative.order();
        let offsets = wave.offsets().iter();
        let mut coefficients = Vec::with_capacity(wave.weights().len());
        for k in by_parity(wave.harmonics()) {
            let scale = 2.0 * (0..order).fold(1.0, |s, _| s * k as f64 * wave.angular_frequency());
            coefficients.extend(
                wave.weights()
                    .column(k - 1)
                    .as_slice()
                    .iter()
                    .map(|weight| {
                        // Multiplication by i^order, spelt out: exact.
                        let (re, im) = match order % 4 {
                            0 => (weight.re, weight.im),
                            1 => (-weight.im, weight.re),
                            2 => (-weight.re, -weight.im),
                            _ => (weight.im, -weight.re),
                        };
                        [scale * re, -scale * im]
                    }),
            );
        }
        Self {
            offsets: offsets.map(|w| if order == 0 { *w } else { 0.0 }).collect(),
            coefficients,
            harmonics: wave.harmonics(),
        }
    }

    /// The pairs of the even harmonics and of the odd ones.
    #[inline(always)]
    fn parities(&self) -> (&[[f64; 2]], &[[f64; 2]]) {
        self.coefficients
            .split_at(self.harmonics / 2 * self.offsets.len())
    }
}

/// The harmonics up to K, the even ones first.
fn by_parity(harmonics: usize) -> impl Iterator<Item = usize> {
    let of = move |first: usize| (first..=harmonics).step_by(2);
    of(2).chain(of(1))
}

/// The sums of the cosine and of the sine terms over harmonics, for J of the `joints` joints, from `d` on.
#[inline(always)]
fn sums<S: Simd, const J: usize>(
    simd: S,
    table: &[Terms],
    coefficients: &[[f64; 2]],
    joints: usize,
    d: usize,
) -> [[f64x8<S>; 2]; J] {
    let mut sums = [[f64x8::splat(simd, 0.0); 2]; J];
    let mut at = d;
    for terms in table {
        let Some(pairs) = coefficients.get(at..at + J) else {
            break;
        };
        let cos = f64x8::load_array_ref(simd, &terms[0]);
        let sin = f64x8::load_array_ref(simd, &terms[1]);
        for (sums, [a, b]) in sums.iter_mut().zip(pairs) {
            sums[0] += cos * *a;
            sums[1] += sin * *b;
        }
        at += joints;
    }
    sums
}

#[cfg(test)]
mod tests;

//! Least squares of a steady rhythm: offset, straight drift and H harmonics of one frequency common to all joints.

use nalgebra::{Cholesky, DMatrix, DVector, QR};
use num_complex::Complex;

use crate::error::{Error, ErrorKind, Result};
use crate::fourier::WORST_CONDITION;

/// The fit y_d(t) = offset_d + slope_d (t - middle) + 2 Re sum_h w_{d,h} g exp(i h phase).
#[derive(Debug, Clone)]
pub(super) struct Steady {
    /// D, at mid-time \[rad\].
    pub offsets: DVector<f64>,
    /// D x H \[rad\].
    pub weights: DMatrix<Complex<f64>>,
    /// What the fit leaves, N x D \[rad\].
    pub left: DMatrix<f64>,
    /// An orthonormal basis of what was fitted, N x unknowns.
    pub fitted: DMatrix<f64>,
    /// Share of the energy about each joint's straight line that the harmonics explain, 0 to 1.
    pub explained: f64,
}

/// Columns 1, t - middle (scaled), g cos h phase, -g sin h phase.
fn design(times: &[f64], phases: &[f64], gains: &[f64], harmonics: usize) -> DMatrix<f64> {
    let (first, last) = (times[0], times[times.len() - 1]);
    let (middle, half) = ((first + last) / 2.0, (last - first) / 2.0);
    let mut design = DMatrix::zeros(times.len(), 2 + 2 * harmonics);
    for (n, t) in times.iter().enumerate() {
        design[(n, 0)] = 1.0;
        design[(n, 1)] = (t - middle) / half;
        let step = Complex::cis(phases[n]);
        let mut turn = Complex::new(gains[n], 0.0);
        for h in 1..=harmonics {
            turn *= step;
            design[(n, 2 * h)] = turn.re;
            design[(n, 2 * h + 1)] = -turn.im;
        }
    }
    design
}

/// Fits `positions` (N x D) along `phases` \[rad\] with relative amplitude `gains` (N each).
pub(super) fn fit(
    times: &[f64],
    positions: &DMatrix<f64>,
    phases: &[f64],
    gains: &[f64],
    harmonics: usize,
) -> Result<Steady> {
    let unknowns = 2 + 2 * harmonics;
    let design = design(times, phases, gains, harmonics);
    if design.iter().any(|x| !x.is_finite()) {
        return Err(Error::new(
            ErrorKind::Value,
            "positions or times too large to be fitted",
        ));
    }
    let qr = QR::new(design.clone());
    let singular_values = qr.r().singular_values();
    let condition = singular_values.max() / singular_values.min();
    let mut solution = positions.clone();
    qr.q_tr_mul(&mut solution);
    let mut solution = solution.rows(0, unknowns).into_owned();
    if condition.is_nan()
        || condition > WORST_CONDITION
        || !qr.r().solve_upper_triangular_mut(&mut solution)
    {
        return Err(Error::new(
            ErrorKind::Infeasible,
            format!(
                "{} samples leave {harmonics} harmonics undetermined: condition number {condition:.1e}",
                times.len()
            ),
        )
        .expected(format!("at most {WORST_CONDITION:.0e}"))
        .help("take fewer harmonics, or leave out a recording with gaps"));
    }
    let left = positions - &design * &solution;
    let line = QR::new(design.columns(0, 2).into_owned());
    let mut rotated = positions.clone();
    line.q_tr_mul(&mut rotated);
    let energy = positions.norm_squared() - rotated.rows(0, 2).norm_squared();
    Ok(Steady {
        offsets: solution.row(0).transpose(),
        weights: DMatrix::from_fn(positions.ncols(), harmonics, |d, h| {
            Complex::new(solution[(2 * h + 2, d)], solution[(2 * h + 3, d)]) / 2.0
        }),
        // A motion that is a straight line has no energy about it, and no rhythm.
        explained: if energy > 0.0 {
            (1.0 - left.norm_squared() / energy).max(0.0)
        } else {
            0.0
        },
        left,
        fitted: qr.q(),
    })
}

/// The frequency \[Hz\] near `tempo` of which the harmonics explain most, by variable projection (Golub and Pereyra 1973):
/// the linear unknowns are eliminated, and a search over the one that is left is a search over all.
pub(super) fn frequency(
    times: &[f64],
    positions: &DMatrix<f64>,
    tempo: f64,
    harmonics: usize,
) -> f64 {
    let start = times[0];
    let span = times[times.len() - 1] - start;
    let mut centred = positions.clone();
    for mut column in centred.column_iter_mut() {
        let mean = column.mean();
        column.add_scalar_mut(-mean);
    }
    let gains = vec![1.0; times.len()];
    let explained = |frequency: f64| -> f64 {
        let phases: Vec<f64> = times
            .iter()
            .map(|t| std::f64::consts::TAU * frequency * (t - start))
            .collect();
        let design = design(times, &phases, &gains, harmonics);
        let right = design.tr_mul(&centred);
        Cholesky::new(design.tr_mul(&design)).map_or(0.0, |c| right.dot(&c.solve(&right)))
    };
    // The h-th harmonic's lobe is 1/(h span) wide in the frequency of the first.
    let step = 1.0 / (8.0 * harmonics as f64 * span);
    let reach = 6 * harmonics as i32;
    let candidates = (-reach..=reach).map(|i| tempo + f64::from(i) * step);
    let best = candidates
        .filter(|f| *f > 0.5 * tempo)
        .map(|f| (f, explained(f)))
        .fold(
            (tempo, 0.0),
            |best, next| if next.1 > best.1 { next } else { best },
        )
        .0;
    // Golden section between the neighbours.
    let ratio = (5f64.sqrt() - 1.0) / 2.0;
    let (mut low, mut high) = (best - step, best + step);
    for _ in 0..25 {
        let third = ratio * (high - low);
        if explained(high - third) > explained(low + third) {
            high = low + third;
        } else {
            low = high - third;
        }
    }
    (low + high) / 2.0
}

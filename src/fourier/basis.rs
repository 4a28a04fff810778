//! [`FourierBasis`]: the least squares of Algorithm 1, line 5.

use nalgebra::{DMatrix, DVector, Dyn, QR};
use num_complex::Complex;
use realfft::RealFftPlanner;

use super::wave::check_period;
use super::{Joints, Wave};
use crate::error::{Error, ErrorKind, Result};

/// No recording has more.
const MOST_HARMONICS: usize = 1_000_000;

/// Beyond this condition number of the design matrix a fit is refused: an error of 1e-6 rad in the
/// samples could move a weight by 1 rad.
pub(crate) const WORST_CONDITION: f64 = 1e6;

/// Stamps this close to a uniform grid, as a share of the period, are that grid.
const GRID_TOLERANCE: f64 = 1e-12;

/// Harmonics 0..=K of a period T: fits [`Wave`]s to samples.
///
/// The Kronecker system (Phi (x) I_D) w = y of Algorithm 1 (Panteris, Manschitz and Calinon, HRI 2020) falls apart into
/// one problem a joint with one Gram matrix, and that matrix is known in closed form on uniform grids:
///
/// | stamps | Gram matrix over k = -K..K | solved by | samples needed |
/// |---|---|---|---|
/// | open grid, t_n = nT/N | N I | truncated FFT / N | 2K+1 |
/// | closed grid, t_n = nT/(N-1) | n I + 1 1^H, n = N-1 | FFT, then Sherman and Morrison's formula | 2K+2 |
/// | any other | - | real least squares, one QR for all joints | 2K+1 |
///
/// ```
/// use nalgebra::DMatrix;
/// use undulate::{FourierBasis, Joints};
///
/// let times: Vec<f64> = (0..40).map(|n| n as f64 / 40.0).collect();
/// let samples = DMatrix::from_fn(40, 1, |n, _| 0.3 + 0.2 * (std::f64::consts::TAU * 2.0 * times[n]).cos());
/// let wave = FourierBasis::new(1.0, 5)?.fit(&Joints::new(["elbow"])?, &times, &samples)?;
/// assert!((wave.weights()[(0, 1)].re - 0.1).abs() < 1e-15);
/// # Ok::<(), undulate::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct FourierBasis {
    period: f64,
    harmonics: usize,
}

/// What the stamps are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stamps {
    Open,
    Closed,
    Arbitrary,
}

impl FourierBasis {
    /// Harmonics 0..=`harmonics` of `period` seconds.
    ///
    /// # Errors
    /// When the period is not a positive number or there is no harmonic, or more than a million.
    pub fn new(period: f64, harmonics: usize) -> Result<Self> {
        check_period(period)?;
        if !(1..=MOST_HARMONICS).contains(&harmonics) {
            return Err(
                Error::new(ErrorKind::Setting, format!("{harmonics} harmonics"))
                    .expected(format!("from 1 to {MOST_HARMONICS}")),
            );
        }
        Ok(Self { period, harmonics })
    }

    /// T \[s\].
    pub fn period(&self) -> f64 {
        self.period
    }

    /// K.
    pub fn harmonics(&self) -> usize {
        self.harmonics
    }

    /// The least-squares wave through `samples` (N x D, rad) at `times` (N, s; usually from 0 to T, and otherwise
    /// taken modulo T, since the wave is periodic).
    ///
    /// # Errors
    /// When the sizes do not fit, there are too few samples for K harmonics, or the times leave the system without
    /// a well-conditioned solution; the message has the numbers.
    pub fn fit(&self, joints: &Joints, times: &[f64], samples: &DMatrix<f64>) -> Result<Wave> {
        self.fit_with(&mut RealFftPlanner::new(), joints, times, samples)
    }

    /// [`fit`](Self::fit) with a planner that lasts over many fits.
    pub(crate) fn fit_with(
        &self,
        planner: &mut RealFftPlanner<f64>,
        joints: &Joints,
        times: &[f64],
        samples: &DMatrix<f64>,
    ) -> Result<Wave> {
        if samples.nrows() != times.len() || samples.ncols() != joints.len() {
            return Err(Error::new(
                ErrorKind::Shape,
                format!("samples of {} x {}", samples.nrows(), samples.ncols()),
            )
            .expected(format!(
                "{} x {}, times x joints",
                times.len(),
                joints.len()
            )));
        }
        let stamps = self.classify(times);
        let needed = 2 * self.harmonics + 1 + usize::from(stamps == Stamps::Closed);
        if times.len() < needed {
            let most = times.len().saturating_sub(needed - 2 * self.harmonics) / 2;
            return Err(Error::new(
                ErrorKind::Shape,
                format!("{} samples for {} harmonics", times.len(), self.harmonics),
            )
            .expected(format!("at least {needed}"))
            .help(format!("take at most {most} harmonics")));
        }
        if let Some(t) = times.iter().find(|t| !t.is_finite()) {
            return Err(Error::new(ErrorKind::Value, format!("a time stamp is {t}")));
        }
        let (offsets, weights) = match stamps {
            Stamps::Open => self.fit_open(planner, samples)?,
            Stamps::Closed => self.fit_closed(planner, samples)?,
            Stamps::Arbitrary => self.fit_arbitrary(times, samples)?,
        };
        Wave::new(joints.clone(), self.period, offsets, weights)
    }

    fn classify(&self, times: &[f64]) -> Stamps {
        let n = times.len();
        let is_grid = |intervals: usize| {
            intervals > 0
                && times.iter().enumerate().all(|(i, t)| {
                    (t - self.period * i as f64 / intervals as f64).abs()
                        <= GRID_TOLERANCE * self.period
                })
        };
        if is_grid(n) {
            Stamps::Open
        } else if is_grid(n.saturating_sub(1)) {
            Stamps::Closed
        } else {
            Stamps::Arbitrary
        }
    }

    fn fit_open(
        &self,
        planner: &mut RealFftPlanner<f64>,
        samples: &DMatrix<f64>,
    ) -> Result<(DVector<f64>, DMatrix<Complex<f64>>)> {
        let scale = 1.0 / samples.nrows() as f64;
        self.transform(planner, samples, samples.nrows(), |_, spectrum| {
            spectrum.iter_mut().for_each(|g| *g *= scale);
        })
    }

    fn fit_closed(
        &self,
        planner: &mut RealFftPlanner<f64>,
        samples: &DMatrix<f64>,
    ) -> Result<(DVector<f64>, DMatrix<Complex<f64>>)> {
        let n = samples.nrows() - 1;
        let unknowns = (2 * self.harmonics + 1) as f64;
        self.transform(planner, samples, n, |joint, spectrum| {
            // The end point repeats the start: exp(i k w T) = 1 for every k.
            let end = samples[(n, joint)];
            spectrum.iter_mut().for_each(|g| *g += end);
            // (n I + 1 1^H)^-1 g = (g - 1 (1^H g) / (n + 2K+1)) / n; 1^H g is real.
            let sum = spectrum[0].re + 2.0 * spectrum[1..].iter().map(|g| g.re).sum::<f64>();
            let common = sum / (n as f64 + unknowns);
            spectrum
                .iter_mut()
                .for_each(|g| *g = (*g - common) / n as f64);
        })
    }

    /// FFT of the first `points` samples of each joint, harmonics 0..=K, through `solve`.
    fn transform(
        &self,
        planner: &mut RealFftPlanner<f64>,
        samples: &DMatrix<f64>,
        points: usize,
        mut solve: impl FnMut(usize, &mut [Complex<f64>]),
    ) -> Result<(DVector<f64>, DMatrix<Complex<f64>>)> {
        let fft = planner.plan_fft_forward(points);
        let mut input = fft.make_input_vec();
        let mut spectrum = fft.make_output_vec();
        let mut scratch = fft.make_scratch_vec();
        let joints = samples.ncols();
        let mut offsets = DVector::zeros(joints);
        let mut weights = DMatrix::zeros(joints, self.harmonics);
        for d in 0..joints {
            input.copy_from_slice(&samples.column(d).as_slice()[..points]);
            fft.process_with_scratch(&mut input, &mut spectrum, &mut scratch)
                .map_err(|e| Error::new(ErrorKind::Shape, e.to_string()))?;
            let kept = &mut spectrum[..=self.harmonics];
            solve(d, kept);
            offsets[d] = kept[0].re;
            for (k, weight) in kept[1..].iter().enumerate() {
                weights[(d, k)] = *weight;
            }
        }
        Ok((offsets, weights))
    }

    /// Columns 1, 2 cos(k w t), -2 sin(k w t): the unknowns are w_0, Re w_k, Im w_k themselves.
    fn fit_arbitrary(
        &self,
        times: &[f64],
        samples: &DMatrix<f64>,
    ) -> Result<(DVector<f64>, DMatrix<Complex<f64>>)> {
        let unknowns = 2 * self.harmonics + 1;
        let w = std::f64::consts::TAU / self.period;
        let mut design = DMatrix::zeros(times.len(), unknowns);
        for (n, t) in times.iter().enumerate() {
            design[(n, 0)] = 1.0;
            for k in 1..=self.harmonics {
                let (sin, cos) = libm::sincos(k as f64 * w * t);
                design[(n, 2 * k - 1)] = 2.0 * cos;
                design[(n, 2 * k)] = -2.0 * sin;
            }
        }
        let qr = QR::new(design);
        self.check_condition(&qr, times.len())?;
        let mut rotated = samples.clone();
        qr.q_tr_mul(&mut rotated);
        let mut solution = rotated.rows(0, unknowns).into_owned();
        if !qr.unpack_r().solve_upper_triangular_mut(&mut solution) {
            return Err(self.singular(f64::INFINITY, times.len()));
        }
        let offsets = solution.row(0).transpose();
        let weights = DMatrix::from_fn(samples.ncols(), self.harmonics, |d, k| {
            Complex::new(solution[(2 * k + 1, d)], solution[(2 * k + 2, d)])
        });
        Ok((offsets, weights))
    }

    fn check_condition(&self, qr: &QR<f64, Dyn, Dyn>, samples: usize) -> Result<()> {
        let singular_values = qr.r().singular_values();
        let condition = singular_values.max() / singular_values.min();
        if condition <= WORST_CONDITION {
            Ok(())
        } else {
            Err(self.singular(condition, samples))
        }
    }

    fn singular(&self, condition: f64, samples: usize) -> Error {
        Error::new(
            ErrorKind::Infeasible,
            format!(
                "{samples} samples leave {} harmonics of {} s undetermined: condition number {condition:.1e}",
                self.harmonics, self.period
            ),
        )
        .expected(format!("at most {WORST_CONDITION:.0e}"))
        .help("take fewer harmonics or a shorter period, or leave out a recording with gaps")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_nyquist_grid_determines_exactly_as_many_harmonics_as_the_table_says() {
        let joints = Joints::new(["a"]).unwrap();
        let fit = |points: usize, intervals: usize, harmonics: usize| {
            let times: Vec<f64> = (0..points).map(|n| n as f64 / intervals as f64).collect();
            let samples = DMatrix::from_fn(points, 1, |n, _| (n * n % 7) as f64);
            FourierBasis::new(1.0, harmonics)
                .unwrap()
                .fit(&joints, &times, &samples)
        };
        assert!(fit(51, 51, 25).is_ok());
        assert!(fit(51, 51, 26).is_err());
        assert!(fit(52, 51, 25).is_ok());
        let error = fit(51, 50, 25).unwrap_err();
        assert!(
            error.to_string().contains("51 samples for 25 harmonics"),
            "{error}"
        );
        assert!(error.to_string().contains("at most 24"), "{error}");
        assert!(fit(51, 50, 24).is_ok());
    }

    #[test]
    fn a_gap_that_hides_harmonics_is_refused_with_its_condition_number() {
        let times: Vec<f64> = (0..60).map(|n| 0.3 * n as f64 / 59.0).collect();
        let samples = DMatrix::zeros(60, 1);
        let error = FourierBasis::new(1.0, 10)
            .unwrap()
            .fit(&Joints::new(["a"]).unwrap(), &times, &samples)
            .unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Infeasible);
        assert!(error.to_string().contains("condition number"), "{error}");
    }
}

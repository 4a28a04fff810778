//! [`CycleResidual`]: what a cycle leaves of a motion, as a stationary process.

use nalgebra::DMatrix;

use super::{MOST_CYCLE_HARMONICS, Wave};
use crate::error::{Error, ErrorKind, Result};

/// Bands an octave where it is slow.
const BANDS: f64 = 3.0;
/// Where it is no longer slow \[cycles a cycle\], bands are half a cycle a cycle wide: about a harmonic, between two, about the next.
const SLOW: f64 = 0.75;
const WIDTH: f64 = 0.5;
/// The lowest band there may be, ten octaves down, and the first that may not, beyond the highest harmonic.
const LOWEST: i32 = -30;
const BEYOND: i32 = 2 * MOST_CYCLE_HARMONICS as i32 + 1;
/// No factor is larger: ten times what a wave itself is would be no residual of it, and this is a thousand.
const LARGEST: f64 = 1e3;
/// A pivot below this share of its diagonal is one of rounding.
const ROUNDING: f64 = 1e-12;

/// A stationary Gaussian process of all joints at once: how posture sways, and cycles differ joint by joint, while a rhythm goes on.
///
/// Of a motion of frequency f whose steady cycle has weights w_{d,h} it is relative to the size s = sqrt(sum |w_{d,h}|^2), for
/// the noise of a movement grows with the movement (Harris and Wolpert, "Signal-dependent noise determines motor planning",
/// Nature 394, 1998), though no farther than it was demonstrated. With frequency nu counted in cycles a cycle and r(u) the residual at u cycles,
///
/// ```text
/// E r_d(u) r_e(u + v) = s^2 int_0^inf S_de(nu) cos(2 pi nu v) d nu
/// ```
///
/// S is a cospectrum: joints go together or against each other, none behind another. It is constant in bands: third octaves up to 3/4 of the cycle's frequency, and then from
/// 3/4 to 5/4 about the first harmonic, from 5/4 to 7/4 between it and the second, and so on, for what joints do on their own lies beside the harmonics. Below and above them it is zero: what is
/// slower than a recording shows as its offsets, which are learned as posture.
///
/// ```
/// use undulate::{CycleFits, FourierMovementPrimitive, LearnOptions, synthetic};
///
/// let fits = CycleFits::new(synthetic(0)?.recordings(), 4)?;
/// // Half a cycle a cycle, where posture sways.
/// let slow = fits.residual().cospectrum(0.5).trace();
/// assert!(slow > 0.0 && fits.residual().share() < 0.2);
/// let options = LearnOptions { residual: true, ..LearnOptions::default() };
/// let primitive = FourierMovementPrimitive::from_cycles(&fits, 10, &options)?;
/// assert_eq!(primitive.chart().cycles().and_then(|c| c.residual()), Some(fits.residual()));
/// # Ok::<(), undulate::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct CycleResidual {
    joints: usize,
    /// The number of the lowest band; number 0 begins at 3/4 cycles a cycle.
    lowest: i32,
    /// L of each band (D x D, lower triangular), S = L L^T.
    factors: Vec<DMatrix<f64>>,
    /// The largest s that was demonstrated \[rad\].
    largest: f64,
}

impl CycleResidual {
    /// Of the factors L of bands (D x D, S = L L^T), of which the first is number `lowest`; number 0 is the one about the first harmonic. Waves of a size s beyond `largest` \[rad\] have the residual of that size.
    ///
    /// # Errors
    /// When there is no band, one is more than ten octaves below the first harmonic or beyond the fiftieth, the factors are not square and alike, or one has numbers above its diagonal,
    /// or such that are not finite or beyond a thousand, or the size is negative or not a number.
    pub fn new(lowest: i32, factors: Vec<DMatrix<f64>>, largest: f64) -> Result<Self> {
        let most = (BEYOND - lowest.clamp(LOWEST, BEYOND)) as usize;
        if lowest < LOWEST || factors.is_empty() || factors.len() > most {
            return Err(Error::new(
                ErrorKind::Shape,
                format!("a residual of {} bands from {lowest} on", factors.len()),
            )
            .expected(format!("bands from {LOWEST} on, below {BEYOND}")));
        }
        let joints = factors[0].nrows();
        for factor in &factors {
            if factor.shape() != (joints, joints) {
                return Err(Error::new(
                    ErrorKind::Shape,
                    format!("a factor of {} x {}", factor.nrows(), factor.ncols()),
                )
                .expected(format!("{joints} x {joints}")));
            }
            if (0..joints).any(|d| factor.row(d).iter().skip(d + 1).any(|x| *x != 0.0)) {
                return Err(Error::new(
                    ErrorKind::Value,
                    "a factor with numbers above its diagonal",
                )
                .expected("a lower triangular one"));
            }
            if let Some(x) = factor.iter().find(|x| x.is_nan() || x.abs() > LARGEST) {
                return Err(Error::new(
                    ErrorKind::Value,
                    format!("a residual of {x} times a wave"),
                )
                .expected(format!("at most {LARGEST}")));
            }
        }
        if largest.is_nan() || largest < 0.0 {
            return Err(
                Error::new(ErrorKind::Value, format!("a largest wave of {largest} rad"))
                    .expected("0 or more"),
            );
        }
        Ok(Self {
            joints,
            lowest,
            factors,
            largest,
        })
    }

    /// Of cospectra S (D x D, symmetric, positive semidefinite but for rounding), of which the lower triangles are read.
    ///
    /// # Errors
    /// Those of [`new`](Self::new).
    pub fn of_cospectra(lowest: i32, cospectra: &[DMatrix<f64>], largest: f64) -> Result<Self> {
        Self::new(lowest, cospectra.iter().map(root).collect(), largest)
    }

    /// D.
    pub fn joints(&self) -> usize {
        self.joints
    }

    /// The number of the lowest band.
    pub fn lowest(&self) -> i32 {
        self.lowest
    }

    /// L of each band, from the lowest on.
    pub fn factors(&self) -> &[DMatrix<f64>] {
        &self.factors
    }

    /// The largest s that was demonstrated \[rad\].
    pub fn largest(&self) -> f64 {
        self.largest
    }

    /// The band of a frequency \[cycles a cycle\]; of 0 and of what is no number one that nothing has.
    pub fn band(nu: f64) -> i32 {
        let nu = nu.abs();
        if nu < SLOW {
            (BANDS * libm::log2(nu / SLOW)).floor() as i32
        } else if nu >= SLOW {
            ((nu - SLOW) / WIDTH) as i32
        } else {
            i32::MAX
        }
    }

    /// Where a band begins \[cycles a cycle\].
    pub fn edge(band: i32) -> f64 {
        if band < 0 {
            SLOW * libm::exp2(f64::from(band) / BANDS)
        } else {
            SLOW + WIDTH * f64::from(band)
        }
    }

    /// Where the lowest band begins that there may be \[cycles a cycle\].
    pub fn slowest() -> f64 {
        Self::edge(LOWEST)
    }

    fn factor(&self, nu: f64) -> Option<&DMatrix<f64>> {
        let band = Self::band(nu).checked_sub(self.lowest)?;
        self.factors.get(usize::try_from(band).ok()?)
    }

    /// S at a frequency \[cycles a cycle\] (D x D).
    pub fn cospectrum(&self, nu: f64) -> DMatrix<f64> {
        self.factor(nu).map_or_else(
            || DMatrix::zeros(self.joints, self.joints),
            |l| l * l.transpose(),
        )
    }

    /// Its root mean square over that of the steady cycle, all joints together.
    pub fn share(&self) -> f64 {
        let power = |(i, factor): (usize, &DMatrix<f64>)| {
            let b = self.lowest + i as i32;
            factor.norm_squared() * (Self::edge(b + 1) - Self::edge(b))
        };
        // A steady cycle has a variance of 2 s^2.
        (self.factors.iter().enumerate().map(power).sum::<f64>() / 2.0).sqrt()
    }

    /// How many standard normal numbers make the residual of a wave with `harmonics` harmonics.
    pub fn latent(&self, harmonics: usize) -> usize {
        2 * self.joints * harmonics
    }

    /// `wave`, which repeats after so many cycles, with a residual of [`latent`](Self::latent) standard normal `normals`, where the steady cycle's size
    /// is s. On the ring of C cycles harmonic h has independent real and imaginary parts of covariance s^2 S(h/C) / (4 C), by which the
    /// covariance is the one stated but for the wrap and the steps of 1/C.
    ///
    /// # Errors
    /// When there is no cycle, the wave has other joints, the numbers are not as many, or a weight is too large.
    pub fn onto(&self, wave: &Wave, cycles: usize, size: f64, normals: &[f64]) -> Result<Wave> {
        let (joints, harmonics) = wave.weights().shape();
        if cycles == 0 || joints != self.joints || normals.len() != self.latent(harmonics) {
            return Err(Error::new(
                ErrorKind::Shape,
                format!(
                    "{cycles} cycles, {joints} joints, {} normal numbers",
                    normals.len()
                ),
            )
            .expected(format!(
                "at least one cycle, {} joints, {}",
                self.joints,
                self.latent(harmonics)
            )));
        }
        let scale = size.min(self.largest) / (4.0 * cycles as f64).sqrt();
        let mut weights = wave.weights().clone();
        for (h, (mut column, normals)) in weights
            .column_iter_mut()
            .zip(normals.chunks_exact(2 * joints))
            .enumerate()
        {
            let Some(factor) = self.factor((h + 1) as f64 / cycles as f64) else {
                continue;
            };
            let (real, imaginary) = normals.split_at(joints);
            for (d, weight) in column.iter_mut().enumerate() {
                for e in 0..=d {
                    let l = scale * factor[(d, e)];
                    weight.re += l * real[e];
                    weight.im += l * imaginary[e];
                }
            }
        }
        Wave::new(
            wave.joints().clone(),
            wave.period(),
            wave.offsets().clone(),
            weights,
        )
    }
}

/// L of S = L L^T by Cholesky's recursion; a direction without variance has a column of zeros.
fn root(s: &DMatrix<f64>) -> DMatrix<f64> {
    let count = s.nrows();
    let mut l = DMatrix::<f64>::zeros(count, count);
    for j in 0..count {
        let pivot = s[(j, j)] - l.row(j).norm_squared();
        if pivot <= ROUNDING * s[(j, j)] {
            continue;
        }
        let root = pivot.sqrt();
        for i in j..count {
            let known: f64 = (0..j).map(|k| l[(i, k)] * l[(j, k)]).sum();
            l[(i, j)] = (s[(i, j)] - known) / root;
        }
    }
    l
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fourier::Joints;
    use nalgebra::{dmatrix, dvector};
    use num_complex::Complex;
    use std::f64::consts::TAU;

    /// From 0.47 to 1.25 cycles a cycle; joints against each other in the lowest band, in step in the next, one still in the last.
    fn residual() -> CycleResidual {
        let cospectra = [
            dmatrix![0.04, -0.03; -0.03, 0.09],
            dmatrix![0.01, 0.01; 0.01, 0.01],
            dmatrix![0.0, 0.0; 0.0, 0.02],
        ];
        CycleResidual::of_cospectra(-2, &cospectra, 0.7).unwrap()
    }

    fn still(cycles: usize) -> Wave {
        let weights = DMatrix::from_element(2, 2 * cycles - 1, Complex::new(0.0, 0.0));
        let joints = Joints::new(["a", "b"]).unwrap();
        Wave::new(joints, 0.5 * cycles as f64, dvector![0.3, -1.0], weights).unwrap()
    }

    /// The draw is linear in its normals, so unit vectors give its matrix, and the matrix its exact covariance.
    #[test]
    fn covariance_on_the_ring_is_the_one_stated() {
        let residual = residual();
        let (cycles, size) = (4, 0.7);
        let wave = still(cycles);
        let latent = residual.latent(wave.harmonics());
        let draws: Vec<Wave> = (0..latent)
            .map(|i| {
                let mut unit = vec![0.0; latent];
                unit[i] = 1.0;
                residual.onto(&wave, cycles, size, &unit).unwrap()
            })
            .collect();
        let at = |wave: &Wave, d: usize, u: f64| wave.position_of(d, 0.5 * u) - wave.offsets()[d];
        for (u, v) in [(0.0, 0.0), (0.3, 0.9), (3.1, 0.2)] {
            for (d, e) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let found: f64 = draws.iter().map(|w| at(w, d, u) * at(w, e, v)).sum();
                let term = |h: usize| {
                    let nu = h as f64 / cycles as f64;
                    residual.cospectrum(nu)[(d, e)] * (TAU * nu * (u - v)).cos()
                };
                let sum: f64 = (1..=wave.harmonics()).map(term).sum();
                let expected = size * size * sum / cycles as f64;
                assert!((found - expected).abs() < 1e-12, "{found} {expected}");
            }
        }
    }

    #[test]
    fn a_wave_beyond_what_was_demonstrated_has_no_larger_residual() {
        let residual = residual();
        let normals = vec![0.5; residual.latent(7)];
        let [largest, beyond] = [0.7, 70.0].map(|s| residual.onto(&still(4), 4, s, &normals));
        assert_eq!(largest.unwrap(), beyond.unwrap());
    }

    /// With many cycles the sum over harmonics is the integral.
    #[test]
    fn the_share_is_what_is_drawn_over_the_cycle() {
        let residual = residual();
        let cycles = 1000;
        let variance: f64 = (1..2 * cycles)
            .map(|h| residual.cospectrum(h as f64 / cycles as f64).trace() / cycles as f64)
            .sum();
        let share = (variance / 2.0).sqrt();
        assert!((residual.share() / share - 1.0).abs() < 1e-3);
    }

    #[test]
    fn a_spectrum_is_flat_in_its_bands_and_none_beside_them() {
        let residual = residual();
        let near = |a: DMatrix<f64>, b: DMatrix<f64>| assert!((a - b).amax() < 1e-15);
        near(residual.cospectrum(0.47), DMatrix::zeros(2, 2));
        near(residual.cospectrum(0.5), dmatrix![0.04, -0.03; -0.03, 0.09]);
        near(residual.cospectrum(0.7), dmatrix![0.01, 0.01; 0.01, 0.01]);
        near(residual.cospectrum(1.2), dmatrix![0.0, 0.0; 0.0, 0.02]);
        near(residual.cospectrum(1.3), DMatrix::zeros(2, 2));
        for odd in [0.0, f64::INFINITY, f64::NAN, 1e-300, 1e300] {
            for lowest in [LOWEST, 0, 5] {
                let one = CycleResidual::new(lowest, vec![DMatrix::identity(1, 1)], 1.0).unwrap();
                assert_eq!(one.cospectrum(odd)[(0, 0)], 0.0, "{odd} {lowest}");
            }
        }
        near(residual.cospectrum(-0.5), residual.cospectrum(0.5));
        assert!(
            residual
                .onto(&still(4), 0, 1.0, &vec![0.1; residual.latent(7)])
                .is_err()
        );
        // Bands follow each other, and a frequency lies in its own.
        for band in LOWEST..BEYOND {
            let (from, to) = (CycleResidual::edge(band), CycleResidual::edge(band + 1));
            assert!(from < to);
            assert_eq!(CycleResidual::band(0.5 * (from + to)), band);
        }
    }

    #[test]
    fn what_is_no_residual_is_refused() {
        let one = || DMatrix::identity(2, 2);
        for (lowest, factors) in [
            (0, vec![]),
            (-31, vec![one()]),
            (BEYOND - 1, vec![one(), one()]),
            (i32::MIN, vec![one()]),
            (i32::MAX, vec![one()]),
            (0, vec![one(), DMatrix::identity(3, 3)]),
            (0, vec![DMatrix::zeros(2, 3)]),
            (0, vec![dmatrix![1.0, 0.1; 0.0, 1.0]]),
            (0, vec![one() * f64::NAN]),
            (0, vec![one() * 1e4]),
        ] {
            assert!(
                CycleResidual::new(lowest, factors, 1.0).is_err(),
                "{lowest}"
            );
        }
        for largest in [f64::NAN, -1.0] {
            assert!(CycleResidual::new(0, vec![one()], largest).is_err());
        }
        let residual = residual();
        let short = vec![0.0; residual.latent(7) - 1];
        assert!(residual.onto(&still(4), 4, 1.0, &short).is_err());
    }
}

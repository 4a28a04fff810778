//! [`LinearGaussian`]: real and imaginary parts in place of amplitude and phase.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use rand::Rng;

use super::aligned::{Aligned, aligned};
use super::{GestureModel, Wish, gaussian, ours};
use crate::demonstration::{Demonstrations, Duration, Recording};
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::{FourierBasis, Joints, Wave};
use crate::primitive::{Gaussian, LinearObservation};

/// A Gaussian over \[Re; Im\] of the weights of a Fourier series of a common period, and its offsets: the rhythmic ProMP of Fourier bases
/// (Kulak, Silverio and Calinon, "Fourier movement primitives: an approach for learning rhythmic robot skills from demonstrations", RSS 2020), linear in the trajectory.
///
/// Recordings are cut to a common period as ours are, and their series advanced to where the dominant joint first turns; the covariance is
/// [`Estimator::Kronecker`](crate::Estimator)'s shrinkage, joints x neighbouring harmonics for real and for imaginary parts. It passes through a position at a time. A draw is
/// a random mixture of the demonstrations' tempos and amplitudes, and neither is a coordinate that could be asked for.
pub struct LinearGaussian {
    joints: Joints,
    period: f64,
    harmonics: usize,
    /// The joint by which recordings are aligned, where they are.
    dominant: Option<usize>,
    gaussian: Gaussian,
}

impl LinearGaussian {
    /// Learns from recordings, cut to the period for which (recordings kept) x T is largest.
    ///
    /// # Errors
    /// When there are fewer than two recordings with a rhythm and of a common period.
    pub fn learn(recordings: &[Recording], harmonics: usize) -> Result<Self> {
        let demonstrations = Demonstrations::new(recordings.to_vec(), Duration::Auto)?;
        // By the part that is kept, and all of it has a rhythm or is left out.
        let (aligned, dominant) = aligned(demonstrations.recordings(), 1)?;
        let basis = FourierBasis::new(demonstrations.period(), harmonics)?;
        let waves = aligned
            .iter()
            .map(|a| {
                let wave = basis.fit(
                    a.recording.joints(),
                    a.recording.times(),
                    a.recording.positions(),
                )?;
                Ok(wave.advanced(a.start))
            })
            .collect::<Result<Vec<_>>>()?;
        Ok(Self {
            dominant: Some(dominant),
            ..Self::of_waves(&waves)?
        })
    }

    /// Learns from waves of one period, as they are.
    ///
    /// # Errors
    /// When there are fewer than two, or they differ in joints, period or harmonics.
    pub fn of_waves(waves: &[Wave]) -> Result<Self> {
        let (Some(first), true) = (waves.first(), waves.len() > 1) else {
            return Err(
                Error::new(ErrorKind::Shape, format!("{} waves", waves.len()))
                    .expected("at least two"),
            );
        };
        let shape = |w: &Wave| (w.joints().clone(), w.period(), w.harmonics());
        if waves.iter().any(|w| shape(w) != shape(first)) {
            return Err(Error::new(ErrorKind::Shape, "waves of different shapes"));
        }
        let (joints, period, harmonics) = shape(first);
        let vectors: Vec<DVector<f64>> = waves.iter().map(vector).collect();
        let parts = (joints.len(), harmonics);
        Ok(Self {
            gaussian: gaussian::shrunk(&vectors, &[parts, parts, (joints.len(), 1)])?,
            joints,
            period,
            harmonics,
            dominant: None,
        })
    }

    /// Over \[Re; Im; offsets\], joint by joint.
    pub fn gaussian(&self) -> &Gaussian {
        &self.gaussian
    }

    fn wave(&self, x: &DVector<f64>) -> Result<Wave> {
        let (d, k) = (self.joints.len(), self.harmonics);
        let weights = DMatrix::from_fn(d, k, |i, j| Complex::new(x[i * k + j], x[(d + i) * k + j]));
        let offsets = DVector::from_fn(d, |i, _| x[2 * d * k + i]);
        Wave::new(self.joints.clone(), self.period, offsets, weights)
    }
}

impl GestureModel for LinearGaussian {
    fn draw(&self, times: &[f64], rng: &mut dyn Rng) -> DMatrix<f64> {
        let x = self.gaussian.sample(rng);
        let wave = self.wave(&x).expect("a draw of finite weights is a wave");
        ours::positions(&wave, times)
    }

    fn log_density(&self, demonstration: &Recording) -> Option<f64> {
        let twice = vec![demonstration.clone(); 2];
        let cut = Demonstrations::new(twice, Duration::Seconds(self.period)).ok()?;
        let wave = cut.fit(self.harmonics).ok()?.swap_remove(0);
        let start = match self.dominant {
            Some(joint) => Aligned::of(&cut.recordings()[0], joint, 1)?.start,
            None => 0.0,
        };
        let x = vector(&wave.advanced(start));
        Some(gaussian::log_density(&self.gaussian, &x))
    }

    fn condition(&self, wish: &Wish) -> Result<Box<dyn GestureModel>> {
        let Wish::Position {
            joint,
            time,
            position,
        } = wish
        else {
            return Err(wish.refused("with a common period it is spread over harmonics"));
        };
        let (joints, k) = (self.joints.len(), self.harmonics);
        let d = self.joints.index(joint)?;
        // y = offset + 2 sum (Re cos - Im sin).
        let mut row = vec![(2 * joints * k + d, 1.0)];
        for j in 0..k {
            let turn = std::f64::consts::TAU * (j + 1) as f64 * time / self.period;
            row.push((d * k + j, 2.0 * turn.cos()));
            row.push(((joints + d) * k + j, -2.0 * turn.sin()));
        }
        let observation = LinearObservation {
            row,
            value: *position,
            deviation: 0.0,
        };
        let gaussian = self
            .gaussian
            .condition(&[observation])
            .map_err(|_| wish.refused("it contradicts what is certain already"))?;
        Ok(Box::new(Self {
            gaussian,
            joints: self.joints.clone(),
            ..*self
        }))
    }
}

fn vector(wave: &Wave) -> DVector<f64> {
    let weights = wave.weights().transpose();
    let real = weights.iter().map(|w| w.re);
    let imaginary = weights.iter().map(|w| w.im);
    let all = real.chain(imaginary).chain(wave.offsets().iter().copied());
    DVector::from_vec(all.collect())
}

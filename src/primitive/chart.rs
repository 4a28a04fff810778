//! The log-polar chart: waves as vectors in which amplitude and phase are coordinates.

use nalgebra::{DMatrix, DVector};

use super::observation::Coordinate;
use crate::elementary::{LARGEST, polar};
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::{Joints, Wave};

/// Moduli below this many radians carry no more than rounding; the vector holds the logarithm of this instead.
/// It acts on the statistics only: a wave's weights stay what they are.
const FLOOR: f64 = 1e-12;

/// Waves of D joints, K harmonics and period T as vectors of n = 2DK + D numbers,
///
/// ```text
/// x = [ ln|w_{d,k}| , Arg w_{d,k} , w_{d,0} ]     k = 1..K
/// ```
///
/// (Panteris, Manschitz and Calinon, HRI 2020, Algorithm 1): first all log moduli, joint by joint and harmonic by harmonic,
/// then all phases in the same order, then the D offsets. Moduli in radians, phases in (-pi, pi], offsets in radians with their sign.
#[derive(Debug, Clone, PartialEq)]
pub struct LogPolar {
    joints: Joints,
    period: f64,
    harmonics: usize,
}

impl LogPolar {
    /// The chart of waves like this one.
    pub fn of(wave: &Wave) -> Self {
        Self {
            joints: wave.joints().clone(),
            period: wave.period(),
            harmonics: wave.harmonics(),
        }
    }

    pub(super) fn new(joints: Joints, period: f64, harmonics: usize) -> Self {
        Self {
            joints,
            period,
            harmonics,
        }
    }

    /// The joints' names.
    pub fn joints(&self) -> &Joints {
        &self.joints
    }

    /// T \[s\].
    pub fn period(&self) -> f64 {
        self.period
    }

    /// K.
    pub fn harmonics(&self) -> usize {
        self.harmonics
    }

    /// n = 2DK + D.
    pub fn dimension(&self) -> usize {
        (2 * self.harmonics + 1) * self.joints.len()
    }

    fn phases(&self) -> usize {
        self.harmonics * self.joints.len()
    }

    /// Where a coordinate stands in x.
    ///
    /// # Errors
    /// When the joint or the harmonic is not of this chart.
    pub fn index(&self, coordinate: &Coordinate) -> Result<usize> {
        let harmonic = |joint: &str, k: usize| {
            let d = self.joints.index(joint)?;
            if k == 0 || k > self.harmonics {
                return Err(
                    Error::new(ErrorKind::Name, format!("no harmonic {k}")).expected(format!(
                        "1 to {}, where {} is {:.2} Hz",
                        self.harmonics,
                        self.harmonics,
                        self.harmonics as f64 / self.period
                    )),
                );
            }
            Ok(d * self.harmonics + k - 1)
        };
        match coordinate {
            Coordinate::Modulus { joint, harmonic: k } => harmonic(joint, *k),
            Coordinate::Phase { joint, harmonic: k } => {
                harmonic(joint, *k).map(|i| self.phases() + i)
            }
            Coordinate::Offset { joint } => self.joints.index(joint).map(|d| 2 * self.phases() + d),
        }
    }

    /// The coordinate at an index of x; `None` beyond its end.
    pub fn coordinate(&self, index: usize) -> Option<Coordinate> {
        let joint = |d: usize| self.joints.name(d).to_owned();
        let address = |i: usize| (joint(i / self.harmonics), i % self.harmonics + 1);
        let (phases, offsets) = (self.phases(), 2 * self.phases());
        if index < phases {
            let (joint, harmonic) = address(index);
            Some(Coordinate::Modulus { joint, harmonic })
        } else if index < offsets {
            let (joint, harmonic) = address(index - phases);
            Some(Coordinate::Phase { joint, harmonic })
        } else {
            let d = index - offsets;
            (d < self.joints.len()).then(|| Coordinate::Offset { joint: joint(d) })
        }
    }

    /// x of a wave (n).
    ///
    /// # Errors
    /// When the wave has other joints, another period or another number of harmonics.
    pub fn vector(&self, wave: &Wave) -> Result<DVector<f64>> {
        if *self != Self::of(wave) {
            return Err(Error::new(
                ErrorKind::Shape,
                format!(
                    "a wave of {}, {} harmonics, {} s",
                    wave.joints().listed(),
                    wave.harmonics(),
                    wave.period()
                ),
            )
            .expected(format!(
                "{}, {} harmonics, {} s",
                self.joints.listed(),
                self.harmonics,
                self.period
            )));
        }
        let mut x = DVector::zeros(self.dimension());
        for d in 0..self.joints.len() {
            for k in 0..self.harmonics {
                let weight = wave.weights()[(d, k)];
                let i = d * self.harmonics + k;
                x[i] = libm::log(libm::sqrt(weight.norm_sqr()).max(FLOOR));
                x[self.phases() + i] = libm::atan2(weight.im, weight.re);
            }
            x[2 * self.phases() + d] = wave.offsets()[d];
        }
        Ok(x)
    }

    /// The wave of a vector.
    ///
    /// # Errors
    /// When `x` is not of this chart's dimension, or an entry is not a number or beyond +-600, where a
    /// modulus would overflow.
    pub fn wave(&self, x: &DVector<f64>) -> Result<Wave> {
        if x.len() != self.dimension() {
            return Err(
                Error::new(ErrorKind::Shape, format!("a vector of {}", x.len()))
                    .expected(format!("{} entries, 2 D K + D", self.dimension())),
            );
        }
        if let Some(i) = x.iter().position(|v| v.abs() > LARGEST || v.is_nan()) {
            let place = self
                .coordinate(i)
                .map_or_else(String::new, |c| c.to_string());
            return Err(
                Error::new(ErrorKind::Value, format!("entry {i} is {}", x[i]))
                    .expected(format!("a number within +-{LARGEST}"))
                    .at(place),
            );
        }
        let (logarithms, rest) = x.as_slice().split_at(self.phases());
        let (phases, offsets) = rest.split_at(self.phases());
        let mut numbers = Vec::new();
        polar(logarithms, phases, &mut numbers);
        let weights = DMatrix::from_row_slice(self.joints.len(), self.harmonics, &numbers);
        let offsets = DVector::from_column_slice(offsets);
        Wave::new(self.joints.clone(), self.period, offsets, weights)
    }
}

//! The log-polar chart: waves as vectors in which amplitude and phase are coordinates.

mod form;
mod phases;
mod rows;

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

pub use form::{OffsetForm, PhaseForm};
pub(super) use phases::{Phases, principal};

use super::observation::Coordinate;
use crate::elementary::{LARGEST, exp, sin_cos};
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::{Joints, Wave};

/// Moduli below this many radians carry no more than rounding; the vector holds the logarithm of this instead.
/// It acts on the statistics only: a wave's weights stay what they are.
pub(super) const FLOOR: f64 = 1e-12;

/// exp of this is a weight that a wave can have, and so are its derivatives.
const LARGEST_LOGARITHM: f64 = 200.0;
/// Of phases and signed offsets \[rad\]: two of them together are an argument of `sin_cos`.
const LARGEST_ANGLE: f64 = LARGEST / 2.0;

/// Waves of D joints, K harmonics and period T as vectors of n = 2DK + D numbers,
///
/// ```text
/// x = [ ln|w_{d,k}| , phi_{d,k} , o_d ]     k = 1..K
/// ```
///
/// (Panteris, Manschitz and Calinon, HRI 2020, Algorithm 1): first all log moduli, joint by joint and harmonic by harmonic,
/// then all phases in the same order, then the D offsets. Moduli are radians.
///
/// Phases are angles, so each has a branch centre c, and stands in (c - pi, c + pi]. What phi is depends on the [`PhaseForm`]:
/// Arg w_{d,k} itself, or, for joints other than a reference, the phase relative to it: Arg w_{d,k} = phi_{d,k} + phi_{ref,k}. Either way
/// Arg w is a sum of entries of x with whole coefficients. The offset o is w_{d,0} or, by [`OffsetForm`], the logarithm of |w_{d,0}|.
#[derive(Debug, Clone, PartialEq)]
pub struct LogPolar {
    joints: Joints,
    period: f64,
    harmonics: usize,
    phases: Phases,
    offsets: Vec<OffsetForm>,
}

impl LogPolar {
    /// The paper's chart of waves like this one: principal phases in (-pi, pi], offsets with their sign.
    pub fn of(wave: &Wave) -> Self {
        Self::principal(wave.joints().clone(), wave.period(), wave.harmonics())
    }

    pub(super) fn principal(joints: Joints, period: f64, harmonics: usize) -> Self {
        let phases = Phases::principal(joints.len(), harmonics);
        let offsets = vec![OffsetForm::Signed; joints.len()];
        Self {
            joints,
            period,
            harmonics,
            phases,
            offsets,
        }
    }

    pub(super) fn with_phases(self, phases: Phases) -> Self {
        Self { phases, ..self }
    }

    pub(super) fn with_offsets(self, offsets: Vec<OffsetForm>) -> Self {
        Self { offsets, ..self }
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

    /// How phases enter the vector.
    pub fn phase_form(&self) -> PhaseForm {
        self.phases.form()
    }

    /// The joint to which phases are relative, where they are.
    pub fn reference(&self) -> Option<&str> {
        self.phases.reference().map(|d| self.joints.name(d))
    }

    /// How each joint's offset enters the vector.
    pub fn offset_forms(&self) -> &[OffsetForm] {
        &self.offsets
    }

    pub(super) fn phases(&self) -> &Phases {
        &self.phases
    }

    /// Where the phases start in x, and the offsets.
    pub(super) fn starts(&self) -> (usize, usize) {
        let angles = self.joints.len() * self.harmonics;
        (angles, 2 * angles)
    }

    /// Entry i of a wave's vector lies within +- this.
    pub(super) fn limit(&self, i: usize) -> f64 {
        let (phases, offsets) = self.starts();
        let signed = |d: usize| self.offsets[d] == OffsetForm::Signed;
        if i < phases || i >= offsets && !signed(i - offsets) {
            LARGEST_LOGARITHM
        } else {
            LARGEST_ANGLE
        }
    }

    /// x of a wave (n).
    ///
    /// # Errors
    /// When the wave has other joints, another period or another number of harmonics, or an offset of a sign that the chart has not.
    pub fn vector(&self, wave: &Wave) -> Result<DVector<f64>> {
        let like = (&self.joints, self.period, self.harmonics);
        if like != (wave.joints(), wave.period(), wave.harmonics()) {
            let told = |joints: &Joints, harmonics: usize, period: f64| {
                format!("{}, {harmonics} harmonics, {period} s", joints.listed())
            };
            return Err(Error::new(
                ErrorKind::Shape,
                format!(
                    "a wave of {}",
                    told(wave.joints(), wave.harmonics(), wave.period())
                ),
            )
            .expected(told(&self.joints, self.harmonics, self.period)));
        }
        let (phases, offsets) = self.starts();
        let mut x = DVector::zeros(self.dimension());
        for d in 0..self.joints.len() {
            for k in 0..self.harmonics {
                let weight = wave.weights()[(d, k)];
                let i = d * self.harmonics + k;
                x[i] = libm::log(libm::sqrt(weight.norm_sqr()).max(FLOOR));
                x[phases + i] = libm::atan2(weight.im, weight.re);
            }
            x[offsets + d] = self.offsets[d]
                .charted(wave.offsets()[d])
                .map_err(|e| e.at(format!("offset of `{}`", self.joints.name(d))))?;
        }
        self.phases.chart(&mut x.as_mut_slice()[phases..offsets]);
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
        let (phases, offsets) = self.starts();
        let mut angles = x.as_slice()[phases..offsets].to_vec();
        self.phases.absolute(&mut angles);
        let polar: Vec<Complex<f64>> = x.as_slice()[..phases]
            .iter()
            .zip(angles)
            .map(|(logarithm, phase)| {
                let modulus = exp(*logarithm);
                // A sum of two entries within bounds may lie beyond them.
                let (sin, cos) = sin_cos(phase.clamp(-LARGEST, LARGEST));
                Complex::new(modulus * cos, modulus * sin)
            })
            .collect();
        let weights = DMatrix::from_row_slice(self.joints.len(), self.harmonics, &polar);
        let offsets = DVector::from_fn(self.joints.len(), |d, _| {
            self.offsets[d].value(x[offsets + d])
        });
        Wave::new(self.joints.clone(), self.period, offsets, weights)
    }

    /// The coordinate at an index of x; `None` beyond its end.
    pub fn coordinate(&self, index: usize) -> Option<Coordinate> {
        let joint = |d: usize| self.joints.name(d).to_owned();
        let (phases, offsets) = self.starts();
        if index < phases {
            let (d, k) = (index / self.harmonics, index % self.harmonics + 1);
            Some(Coordinate::modulus(joint(d), k))
        } else if index < offsets {
            let i = index - phases;
            let (d, k) = (i / self.harmonics, i % self.harmonics + 1);
            Some(match self.phases.relative_to(d) {
                Some(reference) => Coordinate::relative_phase(joint(d), joint(reference), k),
                None => Coordinate::phase(joint(d), k),
            })
        } else {
            let d = index - offsets;
            (d < self.joints.len()).then(|| Coordinate::Offset { joint: joint(d) })
        }
    }
}

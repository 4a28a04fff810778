//! The log-polar chart: waves as vectors in which amplitude and phase are coordinates.

mod cycle;
mod form;
mod phases;
mod rows;

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

pub use cycle::{Cycles, Jitter};
pub use form::{ChartForm, OffsetForm, PhaseForm};
pub(super) use phases::{Phases, principal};
pub(super) use rows::add_to_row;

use super::example::Example;
use super::observation::{Coordinate, JitterOf};
use crate::elementary::{LARGEST, exp, polar};
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::{Interval, Joints, Wave};

/// Moduli below this many radians carry no more than rounding; the vector holds the logarithm of this instead.
/// It acts on the statistics only: a wave's weights stay what they are.
pub(super) const FLOOR: f64 = 1e-12;

/// exp of this is a weight that a wave can have, and so are its derivatives.
const LARGEST_LOGARITHM: f64 = 200.0;
/// Of phases and signed offsets \[rad\]: two of them together are an argument of `sin_cos`.
const LARGEST_ANGLE: f64 = LARGEST / 2.0;
/// ln of the seconds of the longest period, and of the shortest.
const LONGEST_PERIOD: f64 = 20.0;

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
///
/// # Cycles
///
/// Where the period is one cycle of the wave ([`Cycles`]), x holds what people ask for, and n = 2DK + 2D + 3:
///
/// ```text
/// x = [ ln(|w_{d,h}| / s_d) , phi_{d,h} , o_d , ln s_d , ln f , ln j_a , ln j_t ]     h = 1..K
/// ```
///
/// with s_d the swing of a joint, half of peak to peak of its cycle \[rad\], f the frequency \[Hz\], j_a and j_t the standard deviations of ln amplitude
/// and ln tempo from cycle to cycle. Relative phases are locked to the first harmonic of the reference joint, Arg w_{d,h} = phi_{d,h} + h phi_{ref,1}, so
/// that phi_{ref,1} is the start and nothing else depends on it. x gives a shape for each joint, which is scaled to its swing.
#[derive(Debug, Clone, PartialEq)]
pub struct LogPolar {
    joints: Joints,
    span: Span,
    harmonics: usize,
    phases: Phases,
    offsets: Vec<OffsetForm>,
}

/// What a period is.
#[derive(Debug, Clone, PartialEq)]
enum Span {
    /// T \[s\], common to all waves.
    Common(f64),
    /// One cycle, of each wave's own length.
    Cycle(Arc<Cycles>),
}

impl LogPolar {
    /// The paper's chart of waves like this one: a common period, principal phases in (-pi, pi], offsets with their sign.
    pub fn of(wave: &Wave) -> Self {
        Self::principal(wave.joints().clone(), wave.period(), wave.harmonics())
    }

    pub(super) fn principal(joints: Joints, period: f64, harmonics: usize) -> Self {
        let phases = Phases::principal(joints.len(), harmonics);
        let offsets = vec![OffsetForm::Signed; joints.len()];
        Self {
            joints,
            span: Span::Common(period),
            harmonics,
            phases,
            offsets,
        }
    }

    /// The chart of waves like this one in a form, phases relative to joint `reference` where they are, branches about `centres` (D K).
    pub(super) fn in_form(
        joints: Joints,
        (period, harmonics): (f64, usize),
        form: &ChartForm,
        reference: usize,
        centres: Vec<f64>,
    ) -> Self {
        let locked = form.cycles.is_some();
        Self {
            joints,
            span: match &form.cycles {
                None => Span::Common(period),
                Some(cycles) => Span::Cycle(cycles.clone()),
            },
            harmonics,
            phases: Phases::new(form.phases, reference, harmonics, centres, locked),
            offsets: form.offsets.clone(),
        }
    }

    /// The same with other branches.
    pub(super) fn about(self, centres: Vec<f64>) -> Self {
        let phases = self.phases.about(centres);
        Self { phases, ..self }
    }

    /// The joints' names.
    pub fn joints(&self) -> &Joints {
        &self.joints
    }

    /// T \[s\], where it is common to all waves.
    pub fn period(&self) -> Option<f64> {
        match self.span {
            Span::Common(period) => Some(period),
            Span::Cycle(_) => None,
        }
    }

    /// How cycles follow each other, where the period is one cycle.
    pub fn cycles(&self) -> Option<&Arc<Cycles>> {
        match &self.span {
            Span::Common(_) => None,
            Span::Cycle(cycles) => Some(cycles),
        }
    }

    /// K.
    pub fn harmonics(&self) -> usize {
        self.harmonics
    }

    /// n = 2DK + D, of cycles 2DK + 2D + 3.
    pub fn dimension(&self) -> usize {
        let common = (2 * self.harmonics + 1) * self.joints.len();
        match self.span {
            Span::Common(_) => common,
            Span::Cycle(_) => common + self.joints.len() + cycle::AFTER_SWINGS,
        }
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

    /// Where in x swings, frequency and levels of jitter are, of cycles.
    pub(super) fn tail(&self) -> Option<usize> {
        self.cycles().map(|_| self.starts().1 + self.joints.len())
    }

    /// Where ln f is, of cycles.
    pub(super) fn frequency(&self) -> Option<usize> {
        self.tail().map(|tail| tail + self.joints.len())
    }

    /// Whether entry i is of no harmonic, or of one of the lowest so that `most` moduli and `most` phases are.
    pub(super) fn is_low(&self, i: usize, most: usize) -> bool {
        i >= self.starts().1 || i % self.harmonics < (most / self.joints.len()).max(1)
    }

    /// Entry i of a wave's vector lies within +- this.
    pub(super) fn limit(&self, i: usize) -> f64 {
        let (phases, offsets) = self.starts();
        let is_angle =
            |i: usize| i < offsets || self.offsets.get(i - offsets) == Some(&OffsetForm::Signed);
        if self.frequency() == Some(i)
            && let Some(cycles) = self.cycles()
        {
            // C/f is a period, and so is 1/f.
            LONGEST_PERIOD - libm::log(cycles.count() as f64)
        } else if i >= phases && is_angle(i) {
            LARGEST_ANGLE
        } else if self.tail().is_some() {
            // Its weights are products of two.
            LARGEST_LOGARITHM / 2.0
        } else {
            LARGEST_LOGARITHM
        }
    }

    /// x of a wave (n); of a steady one, without jitter, in a chart of cycles.
    ///
    /// # Errors
    /// When the wave has other joints, another period or another number of harmonics, or an offset of a sign that the chart has not.
    pub fn vector(&self, wave: &Wave) -> Result<DVector<f64>> {
        let jitter = self.cycles().map(|_| Jitter {
            amplitude: 0.0,
            tempo: 0.0,
        });
        let wave = wave.clone();
        self.vector_of(&Example { wave, jitter })
    }

    /// x of a demonstration (n).
    pub(super) fn vector_of(&self, example: &Example) -> Result<DVector<f64>> {
        let wave = &example.wave;
        let period = self.period().unwrap_or(wave.period());
        let like = (&self.joints, period, self.harmonics);
        let found = (wave.joints(), wave.period(), wave.harmonics());
        if like != found || example.jitter.is_some() != self.cycles().is_some() {
            let told = |(joints, period, harmonics): (&Joints, f64, usize)| {
                format!("{}, {harmonics} harmonics, {period} s", joints.listed())
            };
            return Err(
                Error::new(ErrorKind::Shape, format!("a wave of {}", told(found)))
                    .expected(told(like)),
            );
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
        if let (Some(cycles), Some(tail), Some(jitter)) =
            (self.cycles(), self.tail(), example.jitter)
        {
            let swings = cycles.swings(wave);
            for (d, swing) in swings.iter().enumerate() {
                let logarithm = libm::log(swing.max(FLOOR));
                x[tail + d] = logarithm;
                let row = &mut x.as_mut_slice()[d * self.harmonics..][..self.harmonics];
                row.iter_mut().for_each(|l| *l -= logarithm);
            }
            let after = &mut x.as_mut_slice()[tail + self.joints.len()..];
            after.copy_from_slice(&Cycles::tail(wave, jitter));
        }
        Ok(x)
    }

    /// The wave of a vector; in a chart of cycles the steady one, whose period is one cycle.
    ///
    /// # Errors
    /// When `x` is not of this chart's dimension, or an entry is not a number or so large that the wave would overflow.
    pub fn wave(&self, x: &DVector<f64>) -> Result<Wave> {
        if x.len() != self.dimension() {
            return Err(
                Error::new(ErrorKind::Shape, format!("a vector of {}", x.len()))
                    .expected(format!("{} entries", self.dimension())),
            );
        }
        if let Some(i) = (0..x.len()).find(|i| !Interval::within(self.limit(*i)).contains(x[*i])) {
            let place = self
                .coordinate(i)
                .map_or_else(String::new, |c| c.to_string());
            return Err(
                Error::new(ErrorKind::Value, format!("entry {i} is {}", x[i]))
                    .expected(format!("a number within +-{}", self.limit(i)))
                    .at(place),
            );
        }
        let (phases, offsets) = self.starts();
        let mut angles = x.as_slice()[phases..offsets].to_vec();
        self.phases.absolute(&mut angles);
        // A sum of entries within bounds may lie beyond them.
        for angle in angles.iter_mut().filter(|a| a.abs() > LARGEST) {
            *angle = principal(*angle);
        }
        let mut numbers = Vec::new();
        polar(&x.as_slice()[..phases], &angles, &mut numbers);
        let mut weights = DMatrix::from_row_slice(self.joints.len(), self.harmonics, &numbers);
        let offsets = DVector::from_fn(self.joints.len(), |d, _| {
            self.offsets[d].value(x[offsets + d])
        });
        let (Some(cycles), Some(tail)) = (self.cycles(), self.tail()) else {
            let period = self.period().unwrap_or(1.0);
            return Wave::new(self.joints.clone(), period, offsets, weights);
        };
        let frequency = exp(x[tail + self.joints.len()]);
        let shape = Wave::new(self.joints.clone(), 1.0, offsets.clone(), weights.clone())?;
        for (d, found) in cycles.swings(&shape).iter().enumerate() {
            let scale = exp(x[tail + d]) / found.max(f64::MIN_POSITIVE);
            weights.row_mut(d).apply(|w| *w *= scale);
        }
        Wave::new(self.joints.clone(), 1.0 / frequency, offsets, weights)
    }

    /// The coordinate at an index of x; `None` beyond its end.
    pub fn coordinate(&self, index: usize) -> Option<Coordinate> {
        let joint = |d: usize| self.joints.name(d).to_owned();
        let (phases, offsets) = self.starts();
        if index < phases {
            let (d, k) = (index / self.harmonics, index % self.harmonics + 1);
            Some(match self.cycles() {
                None => Coordinate::modulus(joint(d), k),
                Some(_) => Coordinate::Shape {
                    joint: joint(d),
                    harmonic: k.into(),
                },
            })
        } else if index < offsets {
            let i = index - phases;
            let (d, k) = (i / self.harmonics, i % self.harmonics + 1);
            Some(match self.phases.anchor(d, k - 1) {
                None => Coordinate::phase(joint(d), k),
                Some(_) if self.tail().is_some() => Coordinate::LockedPhase {
                    joint: joint(d),
                    harmonic: k.into(),
                },
                Some((anchor, _)) => {
                    let reference = joint(anchor / self.harmonics);
                    Coordinate::relative_phase(joint(d), reference, k)
                }
            })
        } else if index < offsets + self.joints.len() {
            let joint = joint(index - offsets);
            Some(Coordinate::Offset { joint })
        } else {
            let after = index - self.tail()?;
            match after.checked_sub(self.joints.len()) {
                None => Some(Coordinate::Swing {
                    joint: joint(after),
                }),
                Some(0) => Some(Coordinate::Frequency),
                Some(1) => Some(Coordinate::Jitter(JitterOf::Amplitude)),
                Some(2) => Some(Coordinate::Jitter(JitterOf::Tempo)),
                Some(_) => None,
            }
        }
    }
}

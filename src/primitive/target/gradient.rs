//! [`WeightGradient`]: how a likelihood changes with the weights of a wave, and from there with the latent numbers of a primitive.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use crate::fourier::Wave;
use crate::primitive::{FourierMovementPrimitive, LogPolar, OffsetForm};

/// The gradient of a function of a wave: dL/dw_{d,0} (D), and dL/dRe w_{d,k} + i dL/dIm w_{d,k} (D x K).
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)]
pub struct WeightGradient {
    pub offsets: DVector<f64>,
    pub weights: DMatrix<Complex<f64>>,
}

impl WeightGradient {
    /// Zero, for waves of D joints and K harmonics.
    pub fn zeros(joints: usize, harmonics: usize) -> Self {
        Self {
            offsets: DVector::zeros(joints),
            weights: DMatrix::zeros(joints, harmonics),
        }
    }

    pub(super) fn is_of(&self, chart: &LogPolar) -> bool {
        let shape = (chart.joints().len(), chart.harmonics());
        self.weights.shape() == shape && self.offsets.len() == shape.0
    }

    pub(super) fn clear(&mut self) {
        self.offsets.fill(0.0);
        self.weights.fill(Complex::ZERO);
    }

    /// Adds `slope` times the gradient of the position of `joint` at time `t` \[s\]:
    /// dy/dw_0 = 1, dy/dRe w_k = 2 cos(k w t), dy/dIm w_k = -2 sin(k w t). Panics when there is no such joint, as slices do.
    pub fn add_position(&mut self, wave: &Wave, joint: usize, t: f64, slope: f64) {
        self.offsets[joint] += slope;
        let turns = t / wave.period();
        let angle = std::f64::consts::TAU * (turns - libm::floor(turns));
        let (sin, cos) = libm::sincos(angle);
        let step = Complex::new(cos, -sin);
        let mut rotation = step;
        for weight in self.weights.row_mut(joint).iter_mut() {
            *weight += rotation * (2.0 * slope);
            rotation *= step;
        }
    }

    /// The gradient with respect to x of a chart with a common period, at the wave of x.
    fn charted(&self, chart: &LogPolar, wave: &Wave) -> Vec<f64> {
        let (phases, offsets) = chart.starts();
        let mut g = vec![0.0; chart.dimension()];
        let harmonics = chart.harmonics();
        for d in 0..chart.joints().len() {
            for k in 0..harmonics {
                let (w, s) = (wave.weights()[(d, k)], self.weights[(d, k)]);
                let i = d * harmonics + k;
                g[i] = s.re * w.re + s.im * w.im;
                let turned = s.im * w.re - s.re * w.im;
                g[phases + i] += turned;
                if let Some((anchor, times)) = chart.phases().anchor(d, k) {
                    g[phases + anchor] += times * turned;
                }
            }
            g[offsets + d] = match chart.offset_forms()[d] {
                OffsetForm::Signed => self.offsets[d],
                _ => self.offsets[d] * wave.offsets()[d],
            };
        }
        g
    }

    /// The gradient with respect to the latent numbers of a primitive with a common period, at the wave of them.
    pub(super) fn latent(&self, primitive: &FourierMovementPrimitive, wave: &Wave) -> Vec<f64> {
        let charted = self.charted(primitive.chart(), wave);
        primitive.gaussian().latent_gradient(&charted)
    }
}

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::demonstration::synthetic;
    use crate::normal;
    use crate::primitive::target::Target;
    use crate::primitive::target::collapsed::Collapsed;
    use crate::primitive::{LearnOptions, Observation, Offsets, stream};

    const HARMONICS: usize = 14;

    /// Relative phases, logarithmic offsets where there are, conditions of both kinds.
    fn conditioned(offsets: Offsets) -> FourierMovementPrimitive {
        let options = LearnOptions {
            offsets,
            ..LearnOptions::default()
        };
        let learned =
            FourierMovementPrimitive::learn_with(&synthetic(0).unwrap(), HARMONICS, &options);
        let asked = [
            Observation::modulus("elbow_flexion", 10, 0.08),
            Observation::phase("wrist_deviation", 10, 0.4).within(0.3),
        ];
        learned.unwrap().condition(&asked).unwrap()
    }

    fn targets(texts: &[&str]) -> Vec<Target> {
        texts.iter().map(|text| text.parse().unwrap()).collect()
    }

    /// Of a function of latent numbers and its gradient: the largest difference from central differences, relative to the largest entry.
    fn error(n: usize, mut of: impl FnMut(&[f64]) -> (f64, Vec<f64>)) -> f64 {
        let mut z = vec![0.0; n];
        normal::fill(&mut stream(4, 0), &mut z);
        let gradient = of(&z).1;
        let mut worst = 0.0_f64;
        for i in 0..n {
            let at = z[i];
            z[i] = at + 1e-5;
            let above = of(&z).0;
            z[i] = at - 1e-5;
            let below = of(&z).0;
            z[i] = at;
            worst = worst.max(((above - below) / 2e-5 - gradient[i]).abs());
        }
        worst / gradient.iter().fold(0.0_f64, |most, g| most.max(g.abs()))
    }

    #[test]
    fn gradients_of_targets_are_their_slopes_in_the_latent_numbers() {
        let targets = targets(&[
            "elbow_flexion@1.2s=120deg+-2deg",
            "wrist_deviation@-3.3s=5deg+-3deg",
            "shoulder_abduction:1.2Hz..1.8Hz=4deg+-1deg",
        ]);
        for offsets in [Offsets::Signed, Offsets::ByData] {
            let primitive = conditioned(offsets);
            let joints = primitive.chart().joints();
            let of = |z: &[f64]| {
                let wave = primitive.wave_at(&mut z.to_vec());
                let mut gradient = WeightGradient::zeros(joints.len(), HARMONICS);
                let each = targets.iter().map(|target| {
                    let joint = target.joint(joints).unwrap();
                    target.with_gradient(&wave, joint, &mut gradient)
                });
                (each.sum(), gradient.latent(&primitive, &wave))
            };
            let error = error(primitive.latent(), of);
            assert!(error < 1e-7, "{offsets:?}: {error:e}");
        }
    }

    #[test]
    fn so_they_are_without_offsets() {
        let primitive = conditioned(Offsets::Signed);
        let targets = targets(&[
            "elbow_flexion@1.2s=120deg+-2deg",
            "elbow_flexion@1.5s=110deg+-2deg",
            "wrist_deviation@-3.3s=5deg+-3deg",
        ]);
        let collapsed = Collapsed::of(&primitive, &targets).unwrap();
        let of = |z: &[f64]| collapsed.with_gradient(&mut z.to_vec());
        let error = error(primitive.latent(), of);
        assert!(error < 1e-7, "{error:e}");
    }
}

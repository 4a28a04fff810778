//! [`CycleRing`]: a steady cycle becomes a periodic motion of C cycles that are not all alike.

use nalgebra::DMatrix;
use num_complex::Complex;

use super::Wave;
use crate::elementary;
use crate::error::{Error, ErrorKind, Result};

/// Points a cycle at which the modulation is sampled. Modulations fill frequencies up to 1/2 a cycle; their exponentials
/// decay beyond, and what lies above 2 a cycle folds.
const POINTS: usize = 4;

/// Largest |ln| of one cycle's amplitude or tempo relative to the mean: e^3 = 20 times as large is no variation of a wave.
pub(crate) const LARGEST_DEVIATION: f64 = 3.0;

/// No arm's cycle has more, and the search for its frequency takes time with their cube.
pub(crate) const MOST_CYCLE_HARMONICS: usize = 50;

/// No wave that repeats later than after so many cycles is of use, and the tables grow with their square.
const MOST_CYCLES: usize = 1000;

/// C successive cycles, the last followed by the first, whose amplitude and tempo differ from cycle to cycle.
///
/// A steady cycle of frequency f with weights w_{d,h} (a [`Wave`] of period 1/f) becomes a wave of period C/f. With time u
/// counted in mean cycles, a(u) and b(u) the band-limited periodic functions through the deviations a_c of ln amplitude and
/// b_c of ln tempo at u = c, and < > the mean over the ring,
///
/// ```text
/// g(u)   = exp(a(u)) / <exp a>                                  amplitude,       <g> = 1
/// p'(u)  = 2 pi (exp(b(u)) / <exp b> - 1),   <p> = 0            phase deviation, periodic
/// y_d(u) = w_{d,0} + 2 Re sum_h w_{d,h} z_h(u) exp(2 pi i h u),  z_h(u) = g(u) exp(i h p(u))
/// ```
///
/// z_h is periodic in C, and its Fourier coefficients at |j| < C become sidebands: harmonic h of the cycle is harmonic
/// h C + j of the ring. Those farther out are left out, so none folds over 0 into the offset. The result has
/// K = (H + 1) C - 1 harmonics.
///
/// The steady wave is the mean: amplitudes have its mean over the ring and there are exactly C cycles in C/f seconds,
/// whatever the means of a_c and b_c. All joints share a and b and so stay in step.
///
/// Made once for a number of cycles; drawing then takes sums in a fixed order only, the same bits everywhere.
///
/// ```
/// use nalgebra::{dmatrix, dvector};
/// use num_complex::Complex;
/// use undulate::{CycleRing, Joints, Wave};
///
/// let steady = Wave::new(Joints::new(["elbow"])?, 0.5, dvector![1.2], dmatrix![Complex::new(0.1, 0.0)])?;
/// let lively = CycleRing::new(4)?.wave(&steady, &[0.1, -0.1, 0.05, 0.0], &[0.0, 0.05, 0.0, -0.05])?;
/// assert_eq!((lively.period(), lively.harmonics()), (2.0, 7));
/// // The first cycle is larger than the second.
/// assert!(lively.position(0.0)[0] > lively.position(0.5)[0] + 0.02);
/// # Ok::<(), undulate::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct CycleRing {
    cycles: usize,
    /// Band-limited interpolation: the value at point n is sum_c x_c `interpolation[n - 4c]`. Two rounds, so that no
    /// index wraps.
    interpolation: Vec<f64>,
    /// Integration: p at point n is sum_m rate_m `integration[n - m]`. Two rounds.
    integration: Vec<f64>,
    /// Row n: cos and sin of 2 pi j n / N for j = 0..C, over N.
    cosines: Vec<f64>,
    sines: Vec<f64>,
}

impl CycleRing {
    /// Tables for rings of `cycles` cycles.
    ///
    /// # Errors
    /// When there is no cycle, or more than a thousand.
    pub fn new(cycles: usize) -> Result<Self> {
        if !(1..=MOST_CYCLES).contains(&cycles) {
            return Err(
                Error::new(ErrorKind::Setting, format!("a wave of {cycles} cycles"))
                    .expected(format!("from 1 to {MOST_CYCLES}")),
            );
        }
        let points = POINTS * cycles;
        let turn: Vec<(f64, f64)> = (0..points)
            .map(|n| libm::sincos(std::f64::consts::TAU * n as f64 / points as f64))
            .collect();
        let at = |j: usize, n: usize| turn[j * n % points];
        let interpolation = (0..2 * points).map(|n| {
            let mut sum = 1.0;
            for j in 1..=cycles / 2 {
                // The highest frequency of an even number of values is its own mirror image and counts once.
                let count = if 2 * j == cycles { 1.0 } else { 2.0 };
                sum += count * at(j, n).1;
            }
            sum / cycles as f64
        });
        // exp(2 pi i j u / C) integrates to itself times C / (2 pi i j), and phase is 2 pi times cycles.
        let integration = (0..2 * points).map(|n| {
            let mut sum = 0.0;
            for j in 1..points / 2 {
                sum += at(j, n).0 / j as f64;
            }
            2.0 * cycles as f64 * sum / points as f64
        });
        let table = |part: fn((f64, f64)) -> f64| {
            (0..points)
                .flat_map(|n| (0..cycles).map(move |j| (j, n)))
                .map(|(j, n)| part(at(j, n)) / points as f64)
                .collect()
        };
        Ok(Self {
            cycles,
            interpolation: interpolation.collect(),
            integration: integration.collect(),
            cosines: table(|(_, cos)| cos),
            sines: table(|(sin, _)| sin),
        })
    }

    /// C.
    pub fn cycles(&self) -> usize {
        self.cycles
    }

    /// The wave of C cycles about `steady`, a wave whose period is one cycle: `amplitude` and `tempo` are the deviations of
    /// ln amplitude and ln tempo, C of each.
    ///
    /// # Errors
    /// When there are not C deviations of each, one is not a number within -3 to 3, or C/f is no period of a wave.
    pub fn wave(&self, steady: &Wave, amplitude: &[f64], tempo: &[f64]) -> Result<Wave> {
        self.check("amplitude", amplitude)?;
        self.check("tempo", tempo)?;
        let mut gain = self.relative(amplitude);
        let rate = self.relative(tempo);
        let phase = self.round(1, &rate, &self.integration);
        let (step_re, step_im): (Vec<f64>, Vec<f64>) = phase
            .iter()
            .map(|p| {
                let (sin, cos) = libm::sincos(*p);
                (cos, sin)
            })
            .unzip();

        let cycles = self.cycles;
        let mut weights =
            DMatrix::zeros(steady.joints().len(), (steady.harmonics() + 1) * cycles - 1);
        // z_h, from z_0 = g by one multiplication a harmonic.
        let mut imaginary = vec![0.0; gain.len()];
        let real = &mut gain;
        for (h, column) in steady.weights().column_iter().enumerate() {
            let carrier = (h + 1) * cycles;
            for n in 0..real.len() {
                let (re, im) = (real[n], imaginary[n]);
                real[n] = re * step_re[n] - im * step_im[n];
                imaginary[n] = re * step_im[n] + im * step_re[n];
            }
            for (j, (above, below)) in self.sidebands(real, &imaginary).into_iter().enumerate() {
                for (d, weight) in column.iter().enumerate() {
                    weights[(d, carrier + j - 1)] += weight * above;
                    if j > 0 {
                        weights[(d, carrier - j - 1)] += weight * below;
                    }
                }
            }
        }
        Wave::new(
            steady.joints().clone(),
            steady.period() * cycles as f64,
            steady.offsets().clone(),
            weights,
        )
    }

    fn check(&self, what: &str, deviations: &[f64]) -> Result<()> {
        if deviations.len() != self.cycles {
            return Err(Error::new(
                ErrorKind::Shape,
                format!("{} deviations of {what}", deviations.len()),
            )
            .expected(format!("{}, one a cycle", self.cycles)));
        }
        match deviations
            .iter()
            .position(|x| !(-LARGEST_DEVIATION..=LARGEST_DEVIATION).contains(x))
        {
            None => Ok(()),
            Some(c) => Err(Error::new(
                ErrorKind::Value,
                format!("ln {what} deviates by {}", deviations[c]),
            )
            .expected(format!("at most {LARGEST_DEVIATION}"))
            .at(format!("cycle {}", c + 1))),
        }
    }

    /// exp of the band-limited function through `deviations`, over its mean: N points.
    fn relative(&self, deviations: &[f64]) -> Vec<f64> {
        let mut values = self.round(POINTS, deviations, &self.interpolation);
        let mut sum = 0.0;
        for value in &mut values {
            // Between nodes the function overshoots them at most by the Lebesgue constant, below 6 for a thousand nodes.
            *value = elementary::exp(*value);
            sum += *value;
        }
        let scale = values.len() as f64 / sum;
        values.iter_mut().for_each(|value| *value *= scale);
        values
    }

    /// Circular convolution: at point n the sum over i of x_i kernel[n - `spacing` i].
    fn round(&self, spacing: usize, x: &[f64], kernel: &[f64]) -> Vec<f64> {
        let points = POINTS * self.cycles;
        let mut sums = vec![0.0; points];
        for (i, x) in x.iter().enumerate() {
            let shifted = &kernel[points - spacing * i..][..points];
            for (sum, k) in sums.iter_mut().zip(shifted) {
                *sum += x * k;
            }
        }
        sums
    }

    /// Fourier coefficients of z at j and at -j, for j = 0..C.
    fn sidebands(&self, real: &[f64], imaginary: &[f64]) -> Vec<(Complex<f64>, Complex<f64>)> {
        let cycles = self.cycles;
        // sum Re z cos, sum Re z sin, sum Im z cos, sum Im z sin
        let mut sums = vec![[0.0; 4]; cycles];
        for (n, (re, im)) in real.iter().zip(imaginary).enumerate() {
            let cosines = &self.cosines[n * cycles..][..cycles];
            let sines = &self.sines[n * cycles..][..cycles];
            for (sum, (cos, sin)) in sums.iter_mut().zip(cosines.iter().zip(sines)) {
                sum[0] += re * cos;
                sum[1] += re * sin;
                sum[2] += im * cos;
                sum[3] += im * sin;
            }
        }
        sums.into_iter()
            .map(|[rc, rs, ic, is]| {
                // z exp(-i x) and z exp(i x), x = 2 pi j n / N
                (
                    Complex::new(rc + is, ic - rs),
                    Complex::new(rc - is, ic + rs),
                )
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fourier::Joints;
    use nalgebra::{DVector, dmatrix, dvector};
    use std::f64::consts::TAU;

    const AMPLITUDE: [f64; 7] = [0.12, -0.2, 0.05, 0.1, -0.08, 0.15, -0.1];
    const TEMPO: [f64; 7] = [0.05, 0.08, -0.06, 0.02, -0.09, 0.03, -0.02];

    /// 2 Hz, a swing of 10 deg in the first joint, with a second harmonic.
    fn steady() -> Wave {
        let half = 10f64.to_radians() / 2.0;
        Wave::new(
            Joints::new(["a", "b"]).unwrap(),
            0.5,
            dvector![0.3, -1.0],
            dmatrix![
                Complex::new(0.0, -half), Complex::ZERO;
                Complex::new(0.02, 0.05), Complex::new(0.01, -0.004)
            ],
        )
        .unwrap()
    }

    /// The band-limited function through values at whole u, by the definition: a sum of exponentials.
    fn band_limited(values: &[f64], u: f64) -> f64 {
        let c = values.len() as f64;
        let half = (values.len() as i32 - 1) / 2;
        (-half..=half)
            .map(|j| {
                let (mut re, mut im) = (0.0, 0.0);
                for (n, x) in values.iter().enumerate() {
                    let angle = TAU * f64::from(j) * n as f64 / c;
                    re += x * angle.cos() / c;
                    im -= x * angle.sin() / c;
                }
                let angle = TAU * f64::from(j) * u / c;
                re * angle.cos() - im * angle.sin()
            })
            .sum()
    }

    #[test]
    fn interpolation_goes_through_its_values() {
        for cycles in [1, 2, 3, 4, 10] {
            let ring = CycleRing::new(cycles).unwrap();
            for m in 0..cycles {
                let expected = f64::from(u8::from(m == 0));
                let found = ring.interpolation[POINTS * m];
                assert!((found - expected).abs() < 1e-12, "{cycles}, {m}: {found}");
            }
        }
    }

    /// The definition in the documentation, integrated by the midpoint rule on a fine grid over one ring.
    fn by_definition(steady: &Wave, points: usize) -> Vec<DVector<f64>> {
        let cycles = AMPLITUDE.len() as f64;
        let step = cycles / points as f64;
        let at = |n: usize| n as f64 * step;
        let mean = |f: &dyn Fn(f64) -> f64| {
            (0..points).map(|n| f(at(n) + step / 2.0)).sum::<f64>() / points as f64
        };
        let g_mean = mean(&|u| band_limited(&AMPLITUDE, u).exp());
        let rate_mean = mean(&|u| band_limited(&TEMPO, u).exp());
        let mut phase = vec![0.0];
        for n in 0..points {
            let rate = band_limited(&TEMPO, at(n) + step / 2.0).exp() / rate_mean;
            phase.push(phase[n] + TAU * (rate - 1.0) * step);
        }
        assert!(phase[points].abs() < 1e-9, "periodic");
        let phase_mean = phase[..points].iter().sum::<f64>() / points as f64;
        (0..points)
            .map(|n| {
                let g = band_limited(&AMPLITUDE, at(n)).exp() / g_mean;
                let angle = TAU * at(n) + phase[n] - phase_mean;
                let mut y = steady.offsets().clone();
                for (h, column) in steady.weights().column_iter().enumerate() {
                    let (sin, cos) = ((h + 1) as f64 * angle).sin_cos();
                    for (d, w) in column.iter().enumerate() {
                        y[d] += 2.0 * g * (w.re * cos - w.im * sin);
                    }
                }
                y
            })
            .collect()
    }

    #[test]
    fn the_wave_is_its_definition() {
        let ring = CycleRing::new(7).unwrap();
        let wave = ring.wave(&steady(), &AMPLITUDE, &TEMPO).unwrap();
        assert_eq!((wave.period(), wave.harmonics()), (3.5, 20));
        let expected = by_definition(&steady(), 7000);
        for (n, y) in expected.iter().enumerate() {
            let found = wave.position(3.5 * n as f64 / 7000.0);
            // What the sidebands beyond C - 1 hold; the deviations themselves come to 0.03.
            assert!((found - y).amax() < 1e-3, "{n}");
        }
    }

    #[test]
    fn no_deviation_or_the_same_for_all_is_the_steady_wave() {
        let steady = steady();
        for cycles in [1, 2, 5, 10] {
            let ring = CycleRing::new(cycles).unwrap();
            for level in [0.0, 0.3] {
                let same = vec![level; cycles];
                let wave = ring.wave(&steady, &same, &same).unwrap();
                assert_eq!(wave.period(), 0.5 * cycles as f64);
                for i in 0..50 {
                    let t = 0.083 * f64::from(i);
                    assert!((wave.position(t) - steady.position(t)).amax() < 1e-13);
                }
            }
        }
    }

    #[test]
    fn ten_degrees_stay_ten_degrees_and_seven_cycles_seven() {
        let wave = CycleRing::new(7)
            .unwrap()
            .wave(&steady(), &AMPLITUDE, &TEMPO)
            .unwrap();
        let y: Vec<f64> = (0..7000)
            .map(|n| wave.position(3.5 * f64::from(n) / 7000.0)[0] - 0.3)
            .collect();
        // Half of peak to peak of each swing between crossings of the middle.
        let crossings: Vec<usize> = (0..7000)
            .filter(|n| y[*n] < 0.0 && y[(n + 1) % 7000] >= 0.0)
            .collect();
        assert_eq!(crossings.len(), 7);
        let swing = |c: usize| {
            let end = crossings[(c + 1) % 7] + if c == 6 { 7000 } else { 0 };
            let cycle = (crossings[c]..end).map(|n| y[n % 7000]);
            let (low, high) = cycle.fold((0.0, 0.0), |(l, h): (f64, f64), y| (l.min(y), h.max(y)));
            (high - low) / 2.0
        };
        let mean = (0..7).map(swing).sum::<f64>() / 7.0;
        assert!((mean.to_degrees() / 10.0 - 1.0).abs() < 0.01, "{mean}");
        // And they are not all alike: the nodes' own standard deviation is 0.13.
        let spread = (0..7).map(|c| (swing(c) / mean - 1.0).powi(2)).sum::<f64>() / 6.0;
        assert!((0.08..0.16).contains(&spread.sqrt()), "{}", spread.sqrt());
    }

    #[test]
    fn what_is_no_deviation_is_refused_with_its_cycle() {
        assert!(CycleRing::new(0).is_err() && CycleRing::new(1001).is_err());
        let ring = CycleRing::new(3).unwrap();
        let steady = steady();
        assert!(ring.wave(&steady, &[0.0; 2], &[0.0; 3]).is_err());
        let error = ring
            .wave(&steady, &[0.0; 3], &[0.0, f64::NAN, 0.0])
            .unwrap_err();
        assert!(
            error
                .to_string()
                .starts_with("cycle 2: ln tempo deviates by NaN"),
            "{error}"
        );
        assert!(ring.wave(&steady, &[0.0, 0.0, 4.0], &[0.0; 3]).is_err());
        assert!(
            ring.wave(&steady, &[3.0, -3.0, 3.0], &[3.0, -3.0, -3.0])
                .is_ok()
        );
    }

    #[test]
    fn the_bits_are_the_same_on_every_machine() {
        let wave = CycleRing::new(7)
            .unwrap()
            .wave(&steady(), &AMPLITUDE, &TEMPO)
            .unwrap();
        let bits = wave.weights().iter().fold(0u64, |hash, w| {
            let hash = hash.rotate_left(7) ^ w.re.to_bits();
            hash.rotate_left(7) ^ w.im.to_bits()
        });
        assert_eq!(bits, 0xfd61_85b5_9305_6caa, "{bits:#x}");
    }
}

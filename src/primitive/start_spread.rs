//! How far the start of a wave varies.

use std::fmt;
use std::str::FromStr;

use rand::Rng;

use super::Start;
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::Wave;
use crate::normal;

/// How far the start of a wave varies in time, independently of all else. As text `none`, `uniform` or `0.1s`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum StartSpread {
    /// Not at all: it starts where the primitive says.
    #[default]
    None,
    /// Anywhere in the period.
    Uniform,
    /// Normally, with this standard deviation \[s\].
    Normal(f64),
}

impl StartSpread {
    /// The wave with a start drawn so.
    pub fn apply<R: Rng + ?Sized>(self, wave: &Wave, rng: &mut R) -> Wave {
        match self {
            Self::None => wave.clone(),
            Self::Uniform => Start::Redrawn.apply(wave, rng),
            Self::Normal(deviation) => {
                let mut delay = [0.0];
                normal::fill(rng, &mut delay);
                wave.advanced(deviation * delay[0])
            }
        }
    }

    /// E exp(i q w delta) for a delay delta.
    pub(super) fn characteristic(self, q: f64, w: f64) -> f64 {
        match self {
            Self::None => 1.0,
            Self::Uniform => f64::from(u8::from(q == 0.0)),
            Self::Normal(deviation) => (-0.5 * (q * w * deviation).powi(2)).exp(),
        }
    }
}

impl fmt::Display for StartSpread {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => f.write_str("none"),
            Self::Uniform => f.write_str("uniform"),
            Self::Normal(deviation) => write!(f, "{deviation}s"),
        }
    }
}

impl FromStr for StartSpread {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let seconds = || text.strip_suffix('s')?.trim().parse::<f64>().ok();
        match text {
            "none" => Ok(Self::None),
            "uniform" => Ok(Self::Uniform),
            _ => seconds()
                .filter(|deviation| *deviation >= 0.0 && deviation.is_finite())
                .map(Self::Normal)
                .ok_or_else(|| {
                    Error::new(ErrorKind::Setting, format!("start spread `{text}`"))
                        .expected("none, uniform, or a standard deviation such as 0.1s")
                }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fourier::Joints;
    use crate::primitive::stream;
    use nalgebra::{DMatrix, DVector};
    use num_complex::Complex;

    #[test]
    fn text_comes_back() {
        for (text, spread) in [
            ("none", StartSpread::None),
            ("uniform", StartSpread::Uniform),
            ("0.1s", StartSpread::Normal(0.1)),
            ("0s", StartSpread::Normal(0.0)),
        ] {
            assert_eq!(text.parse(), Ok(spread));
            assert_eq!(spread.to_string(), text);
        }
        for text in ["", "s", "0.1", "-0.1s", "NaNs", "infs", "0.1 m", "None"] {
            let error = text.parse::<StartSpread>().unwrap_err().to_string();
            assert!(error.contains(&format!("start spread `{text}`")), "{error}");
        }
    }

    const SEED: u64 = 5;
    const DRAWS: u64 = 20_000;
    /// Beyond this a standard normal number is with probability 5e-9: a false alarm of the four z below 1e-7.
    const Z: f64 = 5.85;

    #[test]
    fn draws_have_the_characteristic_function_stated() {
        let weights = DMatrix::from_element(1, 2, Complex::ONE);
        let joints = Joints::new(["elbow"]).unwrap();
        let wave = Wave::new(joints, 2.0, DVector::zeros(1), weights).unwrap();
        let w = wave.angular_frequency();
        // z of the mean of Re exp(i q w delta) over draws, were `stated` the spread.
        let z = |drawn: StartSpread, stated: StartSpread, q: usize| {
            let (mut sum, mut squares) = (0.0, 0.0);
            for k in 0..DRAWS {
                let started = drawn.apply(&wave, &mut stream(SEED, k));
                let off = started.weights()[(0, q - 1)].re - stated.characteristic(q as f64, w);
                sum += off;
                squares += off * off;
            }
            sum / (squares - sum * sum / DRAWS as f64).sqrt()
        };
        for spread in [StartSpread::Uniform, StartSpread::Normal(0.3)] {
            for q in [1, 2] {
                let z = z(spread, spread, q);
                assert!(z.abs() < Z, "{spread}, q = {q}: z = {z}, seed {SEED}");
            }
        }
        // Drawn with the variance for the deviation, it is caught.
        let caught = z(StartSpread::Normal(0.09), StartSpread::Normal(0.3), 1);
        assert!(caught.abs() > Z, "z = {caught}");
        assert_eq!(StartSpread::None.apply(&wave, &mut stream(0, 0)), wave);
    }
}

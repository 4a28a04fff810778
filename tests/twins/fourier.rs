//! Fits, waves and their chart.

use std::f64::consts::{PI, TAU};

use nalgebra::{DMatrix, dmatrix, dvector};
use num_complex::Complex;
use undulate::testing::{circular_mean, waves};
use undulate::{FourierBasis, Gaussian, LogPolar, Wave, stream};

use crate::{FAMILY, SEED, Twin, Verdict, for_all, near};

pub const TWINS: [Twin; 10] = [
    ("a dropped factor 1/2", |broken| {
        // w = (a - ib) / 2, a and b the cosine's and the sine's amplitudes.
        let half = if broken { 1.0 } else { 0.5 };
        fits(|y, k| spectrum(y, k, -1.0) * (2.0 * half))
    }),
    ("a missing conjugate", |broken| {
        fits(|y, k| spectrum(y, k, if broken { 1.0 } else { -1.0 }))
    }),
    ("a closed grid taken for an open one", |broken| {
        fits(|y, k| {
            let closed = [y, &y[..1]].concat();
            let samples = closed.len() - usize::from(!broken);
            spectrum(&closed[..samples], k, -1.0)
        })
    }),
    ("the negative harmonics forgotten", |broken| {
        let both = if broken { 1.0 } else { 2.0 };
        moves(|wave, t| {
            let turned = series(wave, t).map(|(w, _)| w.re).sum::<f64>();
            let velocity = series(wave, t).map(|(w, rate)| (w * Complex::i()).re * rate);
            [
                wave.offsets()[0] + both * turned,
                2.0 * velocity.sum::<f64>(),
            ]
        })
    }),
    ("a velocity without its harmonic", |broken| {
        moves(|wave, t| {
            let all = wave.angular_frequency();
            let rate = |own: f64| if broken { all } else { own };
            let velocity = series(wave, t).map(|(w, own)| (w * Complex::i()).re * rate(own));
            [wave.position(t)[0], 2.0 * velocity.sum::<f64>()]
        })
    }),
    ("a delay that turns all harmonics alike", |broken| {
        for_all(waves(1..=1, 2..=4), |wave| {
            let later = wave.advanced(0.3);
            for (k, w) in wave.weights().iter().enumerate() {
                let turns = if broken { 1.0 } else { k as f64 + 1.0 };
                let turned = w * Complex::cis(turns * wave.angular_frequency() * 0.3);
                near("weight", (later.weights()[k] - turned).norm(), 0.0)?;
            }
            Ok(())
        })
    }),
    ("a logarithm to base ten", |broken| {
        charts(
            |w| {
                if broken {
                    w.norm().log10()
                } else {
                    w.norm().ln()
                }
            },
            Complex::arg,
        )
    }),
    ("the parts of a number in each other's place", |broken| {
        charts(
            |w| w.norm().ln(),
            |w| {
                if broken {
                    w.re.atan2(w.im)
                } else {
                    w.im.atan2(w.re)
                }
            },
        )
    }),
    ("joints and harmonics transposed", |broken| {
        for_all(waves(2..=3, 2..=4), |wave| {
            let x = LogPolar::of(&wave).vector(&wave)?;
            let (joints, harmonics) = wave.weights().shape();
            let at = match broken {
                true => joints + 1,
                false => harmonics + 1,
            };
            near("ln modulus", x[at], wave.weights()[(1, 1)].norm().ln())
        })
    }),
    ("a phase that is not unwrapped", |broken| {
        // Of a wrist that swings against the elbow.
        let phase = Gaussian::new(dvector![PI], dmatrix![0.3]).unwrap();
        let wrapped: Vec<f64> = (0..400)
            .map(|k| phase.sample(&mut stream(SEED, k))[0])
            .map(|a| a - TAU * (a / TAU).round())
            .collect();
        let about = if broken { 0.0 } else { wrapped[0] };
        let unwrapped = |a: &f64| a - TAU * ((a - about) / TAU).round();
        let learned = wrapped.iter().map(unwrapped).sum::<f64>() / 400.0;
        let resultant = (-0.5f64 * 0.3 * 0.3).exp();
        circular_mean(&wrapped, learned, resultant, FAMILY.test()).map_err(|a| a.to_string())
    }),
];

/// 1/N sum y_n exp(sign 2 pi i k n / N)
fn spectrum(y: &[f64], k: usize, sign: f64) -> Complex<f64> {
    let turn = |n: usize| Complex::cis(sign * TAU * (k * n) as f64 / y.len() as f64);
    let terms = y.iter().enumerate().map(|(n, y)| turn(n) * y);
    terms.sum::<Complex<f64>>() / y.len() as f64
}

/// w_k exp(i k w t) and k w.
fn series(wave: &Wave, t: f64) -> impl Iterator<Item = (Complex<f64>, f64)> {
    let weights = wave.weights().row(0).iter().copied().collect::<Vec<_>>();
    let w = wave.angular_frequency();
    let terms = weights.into_iter().enumerate();
    terms.map(move |(k, weight)| {
        let rate = (k as f64 + 1.0) * w;
        (weight * Complex::cis(rate * t), rate)
    })
}

/// The weight of a harmonic from samples of a period, as the library's fit has it.
fn fits(weight: impl Fn(&[f64], usize) -> Complex<f64>) -> Verdict {
    for_all(waves(1..=1, 2..=4), |wave| {
        let points = 2 * wave.harmonics() + 3;
        let times: Vec<f64> = (0..points)
            .map(|n| wave.period() * n as f64 / points as f64)
            .collect();
        let samples = DMatrix::from_fn(points, 1, |n, _| wave.position(times[n])[0]);
        let basis = FourierBasis::new(wave.period(), wave.harmonics())?;
        let fitted = basis.fit(wave.joints(), &times, &samples)?;
        for (k, expected) in fitted.weights().iter().enumerate() {
            let found = weight(samples.as_slice(), k + 1);
            near("weight", (found - expected).norm(), 0.0)?;
        }
        Ok(())
    })
}

/// Position and velocity at a time, as the library's are.
fn moves(state: impl Fn(&Wave, f64) -> [f64; 2]) -> Verdict {
    for_all((waves(1..=1, 2..=4), -3.0..3.0f64), |(wave, t)| {
        let [position, velocity] = state(&wave, t);
        let expected = wave.state(t);
        near("position", position, expected.position[0])?;
        near("velocity", velocity, expected.velocity[0])
    })
}

/// ln modulus and phase of a weight, as the library's chart has them.
fn charts(ln: impl Fn(Complex<f64>) -> f64, phase: impl Fn(Complex<f64>) -> f64) -> Verdict {
    for_all(waves(1..=1, 1..=3), |wave| {
        let x = LogPolar::of(&wave).vector(&wave)?;
        for (k, w) in wave.weights().iter().enumerate() {
            near("ln modulus", ln(*w), x[k])?;
            near("phase", phase(*w), x[wave.harmonics() + k])?;
        }
        Ok(())
    })
}

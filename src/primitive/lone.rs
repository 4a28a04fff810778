//! [`LoneEnd`]: where the model rests on one demonstration, and so what to record next.

use super::example::Example;
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::{Derivative, Wave};

/// Of the median swing of the joint that moves most: below it a joint does not wave, and how much it does is no wish.
const STILL: f64 = 0.05;

/// What people see of a wave.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Seen {
    /// Its tempo \[Hz\].
    Tempo,
    /// Half of peak to peak of a joint \[rad\].
    Swing(String),
    /// The posture of a joint: its offset \[rad\].
    Posture(String),
}

/// One end of what was demonstrated of a quantity.
///
/// Given the quantity, a model regresses all the rest of a wave on it. The leverage of the demonstration at the end, h = 1/M + (q - mean)^2 / sum (q_m - mean)^2, is the
/// share that it has itself in what the regression says there, and the variance of that in units of the residuals' (Hoaglin and Welsch, The American Statistician
/// 32, 1978). Where it is near 1 the model rests on that demonstration alone. Another one there leaves h / (1 + h) of h. Tempo and swings count by
/// their logarithms.
#[derive(Debug, Clone, PartialEq)]
pub struct LoneEnd {
    /// Of what.
    pub seen: Seen,
    /// Whether it is the largest value, or the smallest.
    pub is_high: bool,
    /// The value at the end, in its unit.
    pub value: f64,
    /// The mean of all, geometric where logarithms count.
    pub typical: f64,
    /// h, from 1/M to 1.
    pub leverage: f64,
    /// Which demonstration it is.
    pub demonstration: usize,
}

impl LoneEnd {
    /// Both ends of every quantity, the loneliest first; what does not vary has none.
    ///
    /// # Errors
    /// When there are fewer than three demonstrations, or they differ in joints.
    pub fn all(examples: &[Example]) -> Result<Vec<Self>> {
        let Some(first) = examples.first().filter(|_| examples.len() >= 3) else {
            return Err(Error::new(
                ErrorKind::Shape,
                format!("{} demonstrations", examples.len()),
            )
            .expected("at least three"));
        };
        let joints = first.wave.joints();
        if examples.iter().any(|e| e.wave.joints() != joints) {
            return Err(Error::new(
                ErrorKind::Shape,
                "demonstrations of different joints",
            ));
        }
        let of = |value: &dyn Fn(&Example) -> f64| examples.iter().map(value).collect::<Vec<f64>>();
        let mut ends = Vec::new();
        ends.extend(Self::of(Seen::Tempo, &of(&tempo)));
        let swings: Vec<Vec<f64>> = (0..joints.len())
            .map(|d| of(&|e| e.wave.range(d, Derivative::Position).width() / 2.0))
            .collect();
        let widest = swings.iter().map(|s| median(s)).fold(0.0, f64::max);
        for (joint, swings) in joints.iter().zip(&swings) {
            if median(swings) > STILL * widest {
                ends.extend(Self::of(Seen::Swing(joint.clone()), swings));
            }
        }
        for (d, joint) in joints.iter().enumerate() {
            let offsets = of(&|e| e.wave.offsets()[d]);
            ends.extend(Self::of(Seen::Posture(joint.clone()), &offsets));
        }
        ends.sort_by(|a, b| b.leverage.total_cmp(&a.leverage));
        Ok(ends)
    }

    fn of(seen: Seen, values: &[f64]) -> Vec<Self> {
        let is_logarithmic = !matches!(seen, Seen::Posture(_));
        if is_logarithmic && values.iter().any(|v| *v <= 0.0) {
            return Vec::new();
        }
        let charted: Vec<f64> = values
            .iter()
            .map(|v| if is_logarithmic { v.ln() } else { *v })
            .collect();
        let count = charted.len() as f64;
        let mean = charted.iter().sum::<f64>() / count;
        let squares: f64 = charted.iter().map(|v| (v - mean).powi(2)).sum();
        if squares <= f64::EPSILON {
            return Vec::new();
        }
        let least = |sign: f64| {
            let keys = charted.iter().map(|v| sign * v).enumerate();
            keys.fold((0, f64::INFINITY), |best, next| {
                if next.1 < best.1 { next } else { best }
            })
            .0
        };
        [(false, least(1.0)), (true, least(-1.0))]
            .into_iter()
            .map(|(is_high, m)| Self {
                seen: seen.clone(),
                is_high,
                value: values[m],
                typical: if is_logarithmic { mean.exp() } else { mean },
                leverage: 1.0 / count + (charted[m] - mean).powi(2) / squares,
                demonstration: m,
            })
            .collect()
    }
}

/// Of cycles their frequency, else that of the harmonic with most energy \[Hz\].
fn tempo(example: &Example) -> f64 {
    let wave = &example.wave;
    let harmonic = match example.jitter {
        Some(_) => 1,
        None => strongest(wave),
    };
    harmonic as f64 / wave.period()
}

fn strongest(wave: &Wave) -> usize {
    let energies = wave.weights().column_iter().map(|c| c.norm_squared());
    1 + energies
        .enumerate()
        .fold(
            (0, -1.0),
            |best, next| {
                if next.1 > best.1 { next } else { best }
            },
        )
        .0
}

fn median(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

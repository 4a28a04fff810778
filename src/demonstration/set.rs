//! Recordings beside each other: which is unlike the others.

use super::finding::{Finding, Flag};
use super::half_cycles::median;
use super::inspection::{Inspection, Rhythm};
use super::recording::Recording;
use crate::error::Result;

/// Fewer recordings do not tell which of them is the odd one.
const FEWEST: usize = 4;
/// Standard deviations from the median, by the median absolute deviation, beyond which a value is odd.
const FAR: f64 = 4.0;
/// Of normal values the standard deviation over the median absolute deviation.
const NORMAL: f64 = 1.4826;
/// However alike the others are, a value nearer to the median than this is not odd: a factor of frequency, of size, and
/// \[rad\] of posture.
const LEAST_FREQUENCY: f64 = 1.25;
const LEAST_SIZE: f64 = 1.8;
/// However the others vary, a frequency farther off than this factor is odd: it may be twice the tempo, or half.
const MOST_FREQUENCY: f64 = 1.75;
const LEAST_POSTURE: f64 = 0.35;

impl Inspection {
    /// Looks at recordings of one gesture, each for itself and then beside the others.
    ///
    /// # Errors
    /// When their joints differ, or there are none.
    pub fn of_set(recordings: &[Recording]) -> Result<Vec<Self>> {
        let joints = super::common_joints(recordings)?;
        let mut inspections = recordings
            .iter()
            .map(Self::of)
            .collect::<Result<Vec<_>>>()?;
        let frequency = |r: &Rhythm| r.variation.frequency.ln();
        let near = (LEAST_FREQUENCY.ln(), MOST_FREQUENCY.ln());
        mark(&mut inspections, frequency, near, |x| {
            (Flag::OddFrequency, None, x.exp())
        });
        let size = |r: &Rhythm| r.swing().ln();
        let near = (LEAST_SIZE.ln(), f64::INFINITY);
        mark(&mut inspections, size, near, |x| {
            (Flag::OddSize, None, x.exp())
        });
        for (d, joint) in joints.iter().enumerate() {
            mark(
                &mut inspections,
                |r| r.posture[d],
                (LEAST_POSTURE, f64::INFINITY),
                |x| (Flag::OddPosture, Some(joint.clone()), x),
            );
        }
        Ok(inspections)
    }
}

impl Rhythm {
    /// The largest swing of a joint, half of peak to peak of a cycle \[rad\].
    pub fn swing(&self) -> f64 {
        self.variation.swing.iter().copied().fold(0.0, f64::max)
    }
}

/// Marks those of which a value is far from the median: by the spread of the others, but not where it is nearer than the first number of `near`, and always beyond the second.
fn mark(
    inspections: &mut [Inspection],
    value: impl Fn(&Rhythm) -> f64,
    near: (f64, f64),
    finding: impl Fn(f64) -> (Flag, Option<String>, f64),
) {
    let values: Vec<f64> = inspections
        .iter()
        .filter_map(|i| i.rhythm.as_ref().map(&value))
        .collect();
    if values.len() < FEWEST {
        return;
    }
    let middle = median(values.clone());
    let spread = median(values.iter().map(|x| (x - middle).abs()).collect());
    let most = (FAR * NORMAL * spread).clamp(near.0, near.1);
    for inspection in inspections {
        let Some(far) = inspection.rhythm.as_ref().map(|r| value(r) - middle) else {
            continue;
        };
        if far.abs() > most {
            let (flag, joint, value) = finding(far);
            inspection.findings.push(Finding {
                flag,
                time: None,
                joint,
                value,
            });
        }
    }
}

//! Demonstrations.

use std::ops::RangeInclusive;

use nalgebra::{DMatrix, DVector};
use proptest::collection::vec;
use proptest::prelude::*;

use super::super::argument::require_counts;
use super::waves;
use crate::demonstration::{Demonstrations, Duration, Recording};
use crate::fourier::Wave;
use crate::primitive::LogPolar;

/// How far a recording's log moduli, phases \[rad\] and offsets \[rad\] may be from those of the gesture.
const VARIATION: f64 = 0.3;

/// Demonstrations of a gesture, one of [`waves`], by so many recordings of one period each, at evenly spaced times and without noise: log moduli,
/// phases and offsets of each are within 0.3 of the gesture's. They shrink to fewer recordings, joints and harmonics, and to recordings that
/// are alike.
///
/// ```
/// use proptest::prelude::*;
/// use undulate::FourierMovementPrimitive;
/// use undulate::testing::demonstrations;
///
/// proptest!(|(demonstrations in demonstrations(1..=2, 1..=3, 3..=6))| {
///     let primitive = FourierMovementPrimitive::learn(&demonstrations, 3)?;
///     prop_assert_eq!(primitive.chart().joints(), demonstrations.joints());
/// });
/// ```
///
/// # Panics
/// When `joints` or `harmonics` is an empty range or starts at 0, or `recordings` is empty or starts below 2.
#[track_caller]
pub fn demonstrations(
    joints: RangeInclusive<usize>,
    harmonics: RangeInclusive<usize>,
    recordings: RangeInclusive<usize>,
) -> impl Strategy<Value = Demonstrations> {
    require_counts("recordings", &recordings, 2);
    let largest = 2 * joints.end() * harmonics.end() + joints.end();
    let variation = vec(-VARIATION..VARIATION, largest);
    (waves(joints, harmonics), vec(variation, recordings)).prop_map(|(gesture, variations)| {
        let chart = LogPolar::of(&gesture);
        let mean = chart.vector(&gesture).expect("its own chart");
        let recordings = variations.iter().enumerate().map(|(i, variation)| {
            let varied = &mean + DVector::from_column_slice(&variation[..chart.dimension()]);
            let wave = chart.wave(&varied).expect("far from overflow");
            recording(format!("recording {}", i + 1), &wave)
        });
        Demonstrations::new(recordings.collect(), Duration::Seconds(gesture.period()))
            .expect("recordings of one period in which every joint moves")
    })
}

/// One period, its end included.
fn recording(name: String, wave: &Wave) -> Recording {
    let steps = 4 * wave.harmonics() + 8;
    let times: Vec<f64> = (0..=steps)
        .map(|n| wave.period() * (n as f64 / steps as f64))
        .collect();
    let positions = DMatrix::from_fn(times.len(), wave.joints().len(), |n, d| {
        wave.position_of(d, times[n])
    });
    Recording::new(name, wave.joints().clone(), times, positions)
        .expect("finite positions at increasing times")
}

//! Configurations of a robot.

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use proptest::prelude::*;

use crate::robot::Robot;

/// Configurations q within the limits of a robot \[rad, m\], uniform in each joint; of joints without limits from -pi to pi. They shrink to 0, or
/// the position nearest to it that the limits allow: [`Robot::rest`].
///
/// ```
/// use proptest::prelude::*;
/// use undulate::testing::configurations;
///
/// let robot = undulate::shipped::robot("wave_arm")?;
/// proptest!(|(q in configurations(&robot))| {
///     for (j, q) in q.iter().enumerate() {
///         prop_assert!(robot.properties(j).position.is_none_or(|range| range.contains(*q)));
///     }
/// });
/// # Ok::<(), undulate::Error>(())
/// ```
pub fn configurations(robot: &Robot) -> impl Strategy<Value = Vec<f64>> + use<> {
    let ranges: Vec<RangeInclusive<f64>> = (0..robot.joints().len())
        .map(|j| match robot.properties(j).position {
            Some(range) => range.lower..=range.upper,
            None => -PI..=PI,
        })
        .collect();
    ranges
}

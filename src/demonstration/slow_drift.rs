//! Slow drift of posture, of any shape, beside a rhythm.

use super::demodulation::{self, Window};
use super::recording::Recording;

impl Recording {
    /// Without slow changes of posture: of each joint what remains of a mean over two cycles that moves along it and leaves the
    /// rhythm out (the offset beside which amplitude and phase are demodulated), its mean kept. The straight line of
    /// [`without_drift`](Self::without_drift) goes first. Where there is no rhythm, nothing but the line goes.
    #[must_use]
    pub fn without_slow_drift(&self) -> Self {
        let mut flat = self.without_drift();
        let parts = flat.rhythmic_parts();
        let frequency = parts.iter().max_by(|a, b| a.cycles.total_cmp(&b.cycles));
        let Some(frequency) = frequency.map(|part| part.frequency) else {
            return flat;
        };
        let windows = demodulation::demodulate(&flat, frequency);
        if windows.len() < 2 {
            return flat;
        }
        let start = flat.times[0];
        for d in 0..flat.joints.len() {
            let slow: Vec<f64> = flat
                .times
                .iter()
                .map(|t| offset(&windows, d, (t - start) * frequency))
                .collect();
            let mean = slow.iter().sum::<f64>() / slow.len() as f64;
            for (y, slow) in flat.positions.column_mut(d).iter_mut().zip(slow) {
                *y -= slow - mean;
            }
        }
        flat
    }
}

/// The offset at an instant \[cycles\], on straight lines through those of neighbouring windows.
fn offset(windows: &[Window], joint: usize, at: f64) -> f64 {
    let next = windows
        .partition_point(|w| w.centre <= at)
        .clamp(1, windows.len() - 1);
    let (a, b) = (&windows[next - 1], &windows[next]);
    // Beyond the ends the last one holds: a slope over an eighth of a cycle says little.
    let share = ((at - a.centre) / (b.centre - a.centre)).clamp(0.0, 1.0);
    a.offsets[joint] + share * (b.offsets[joint] - a.offsets[joint])
}

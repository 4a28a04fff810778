//! [`Statistic`]: numbers of a set of motions that are compared to those of the demonstrations.

use num_complex::Complex;

use super::ComparisonOptions;
use super::bootstrap::Estimate;
use super::yardstick::Measured;

/// A number of a set of motions: demonstrations, or draws each as long as one of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Statistic {
    /// Standard deviation over mean of the dominant joint's swing, from motion to motion.
    SwingBetween,
    /// The same of the frequency.
    TempoBetween,
    /// Standard deviation over mean of the amplitude along a motion ([`Variation::envelope`](crate::Variation)), mean over motions.
    Envelope,
    /// 5 % quantile over mean of the amplitude along a motion, mean over motions.
    EnvelopeLow,
    /// Standard deviation over mean of the frequency along a motion, mean over motions.
    TempoWithin,
    /// One less the phase lock of the joints along a motion, mean over joints and motions.
    Unlocked,
    /// Circular standard deviation of the joints' phases relative to the dominant one, from motion to motion, weighted by amplitude \[rad\].
    PhaseSpread,
    /// RMS jerk over RMS velocity and squared angular frequency, mean over motions; 1 for a sinusoid.
    Jerk,
    /// Share of motions in which a joint is farther than 1.5 times the demonstrated half range from its middle.
    Beyond,
    /// Share of motions without two and a half cycles of a rhythm; in the statistics above but the last they are left out.
    Rhythmless,
}

impl Statistic {
    /// One of each.
    pub const ALL: [Self; 10] = [
        Self::SwingBetween,
        Self::TempoBetween,
        Self::Envelope,
        Self::EnvelopeLow,
        Self::TempoWithin,
        Self::Unlocked,
        Self::PhaseSpread,
        Self::Jerk,
        Self::Beyond,
        Self::Rhythmless,
    ];

    /// In JSON.
    pub fn key(self) -> &'static str {
        match self {
            Self::SwingBetween => "swing_between_cv",
            Self::TempoBetween => "tempo_between_cv",
            Self::Envelope => "envelope_cv",
            Self::EnvelopeLow => "envelope_low",
            Self::TempoWithin => "tempo_cv",
            Self::Unlocked => "unlocked",
            Self::PhaseSpread => "phase_spread_rad",
            Self::Jerk => "jerk",
            Self::Beyond => "beyond",
            Self::Rhythmless => "rhythmless",
        }
    }

    /// In words, with its unit where it has one.
    pub fn label(self) -> &'static str {
        match self {
            Self::SwingBetween => "swing varies between motions [%]",
            Self::TempoBetween => "tempo varies between motions [%]",
            Self::Envelope => "amplitude varies within [%]",
            Self::EnvelopeLow => "its 5 % quantile over its mean [%]",
            Self::TempoWithin => "tempo varies within [%]",
            Self::Unlocked => "joints out of lock [%]",
            Self::PhaseSpread => "phases spread between motions [deg]",
            Self::Jerk => "jerk over a sinusoid's",
            Self::Beyond => "beyond demonstrated range x 1.5 [%]",
            Self::Rhythmless => "without a rhythm [%]",
        }
    }

    /// What a value is multiplied with to be of the label's unit.
    pub fn scale(self) -> f64 {
        match self {
            Self::PhaseSpread => 1f64.to_degrees(),
            Self::Jerk => 1.0,
            _ => 100.0,
        }
    }

    /// From the mean row of motions.
    fn of(self, row: &[f64], joint: usize) -> f64 {
        let mean = |i: usize| row[i] / row[0];
        let variation = |i: usize| (mean(i + 1) - mean(i).powi(2)).max(0.0).sqrt() / mean(i);
        match self {
            Self::Envelope => mean(1),
            Self::EnvelopeLow => mean(2),
            Self::TempoWithin => mean(3),
            Self::Unlocked => mean(4),
            Self::Jerk => mean(5),
            Self::Beyond => row[6],
            Self::SwingBetween => variation(7),
            Self::TempoBetween => variation(9),
            Self::Rhythmless => row[11],
            Self::PhaseSpread => {
                let others = row[NUMBERS..]
                    .chunks(3)
                    .enumerate()
                    .filter(|(d, _)| *d != joint);
                let (resultant, total) = others.fold((0.0, 0.0), |(r, t), (_, joint)| {
                    (r + joint[0].hypot(joint[1]), t + joint[2])
                });
                (-2.0 * (resultant / total).min(1.0).ln()).sqrt()
            }
        }
    }
}

/// Numbers of a row before those of the joints.
const NUMBERS: usize = 12;

/// What statistics are made of: sums over motions divided by how many there are.
pub(super) fn row(motions: &[Measured], joint: usize) -> Vec<f64> {
    let joints = motions.first().map_or(0, |m| m.relative.len());
    let mut row = vec![0.0; NUMBERS + 3 * joints];
    for motion in motions {
        row[6] += f64::from(u8::from(motion.is_beyond));
        let Ok(v) = &motion.variation else {
            row[11] += 1.0;
            continue;
        };
        let lock = v.lock.iter().sum::<f64>() / joints as f64;
        let (swing, f) = (v.swing[joint], v.frequency);
        let numbers = [
            1.0,
            v.envelope,
            v.envelope_low,
            v.tempo,
            1.0 - lock,
            motion.jerk,
        ];
        for (sum, x) in row.iter_mut().zip(numbers) {
            *sum += x;
        }
        for (sum, x) in row[7..].iter_mut().zip([swing, swing * swing, f, f * f]) {
            *sum += x;
        }
        let own = motion.relative[joint].norm();
        for (sums, z) in row[NUMBERS..].chunks_mut(3).zip(&motion.relative) {
            let z: Complex<f64> = if own > 0.0 { z / own } else { Complex::ZERO };
            sums[0] += z.re;
            sums[1] += z.im;
            sums[2] += z.norm();
        }
    }
    let count = motions.len().max(1) as f64;
    row.iter_mut().for_each(|x| *x /= count);
    row
}

/// All statistics of rows, one a left-out demonstration.
pub(super) fn estimates(
    rows: &[Vec<f64>],
    joint: usize,
    options: &ComparisonOptions,
) -> Vec<Estimate> {
    Statistic::ALL
        .into_iter()
        .map(|s| {
            Estimate::of(
                rows,
                |row| s.of(row, joint),
                options.confidence,
                options.seed,
            )
        })
        .collect()
}

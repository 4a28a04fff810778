//! Waves made executable, at the least change of one kind after the other.

use super::efforts::{EffortUse, efforts};
use super::{CheckOptions, LimitUse, Verdict, limits_with};
use crate::collision::Prover;
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::{Derivative, Interval, Wave};
use crate::robot::{BodyJoint, Robot};

/// How a wave may be changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Means {
    /// Its offsets are shifted into the range of positions, where the wave fits in.
    Shift,
    /// It is made slower, until velocities, accelerations and efforts are within their limits.
    Slow,
    /// The amplitudes of the joints that break a limit are made smaller.
    ShrinkOffending,
    /// All amplitudes are made smaller by one factor, until limits are kept and nothing touches.
    Shrink,
}

/// What was changed of a wave.
#[derive(Debug, Clone, PartialEq)]
pub enum Change {
    /// The offset of a joint, by so much \[rad, m\].
    Shifted {
        /// The joint.
        joint: String,
        /// \[rad, m\]
        by: f64,
    },
    /// The period, by this factor.
    Slowed {
        /// More than 1.
        factor: f64,
    },
    /// The amplitudes of one joint, or of all, by this factor.
    Shrunk {
        /// `None` for all.
        joint: Option<String>,
        /// Less than 1.
        factor: f64,
    },
}

/// A wave after mending.
#[derive(Debug, Clone)]
pub struct Mended {
    /// As it was where nothing had to be changed.
    pub wave: Wave,
    /// What was changed, in order.
    pub changes: Vec<Change>,
    /// On the wave as it is now: it passes, or says what no allowed means could mend.
    pub verdict: Verdict,
}

/// Factors are found to this share of themselves, on the safe side.
const FINE: f64 = 1e-6;
/// A factor that follows from an enclosure is taken this much farther, for rounding.
const SPARE: f64 = 1e-9;
/// Limits are scaled towards again where rounding has left something of them.
const ROUNDS: usize = 4;
/// No wave is made slower than this.
const SLOWEST: f64 = 64.0;
/// What remains of the effort of a joint, for it is estimated and not proven.
const EFFORT_SPARE: f64 = 1e-6;

/// Changes `wave` by `means`, one after the other and each no more than it takes, until it passes what `options` ask for. Nothing is changed
/// of a wave that passes.
///
/// Time scale and amplitudes are the least that keep the limits: for positions, velocities and accelerations they follow from the exact range of the
/// motion, for efforts and collisions from bisection to a millionth, which takes it that what is slower or smaller is easier. Where that is not so
/// the verdict says that the wave does not pass.
///
/// ```
/// use undulate::{nalgebra::{DMatrix, DVector}, num_complex::Complex};
/// use undulate::{CheckOptions, CollisionModel, CollisionOptions, Means, Wave, mend, shipped};
///
/// let robot = shipped::robot("wave_arm")?;
/// let collision = CollisionModel::new(&robot, &CollisionOptions::default())?;
/// // 20 Hz at 0.2 rad: far too fast.
/// let mut weights = DMatrix::zeros(6, 1);
/// weights[(3, 0)] = Complex::new(0.1, 0.0);
/// let wave = Wave::new(robot.joints().clone(), 0.05, DVector::from_element(6, 0.4), weights)?;
/// let mended = mend(&robot, &mut collision.prover(), &wave, &CheckOptions::default(), &[Means::Slow])?;
/// assert!(mended.verdict.passes() && mended.wave.period() > 0.05);
/// # Ok::<(), undulate::Error>(())
/// ```
///
/// # Errors
/// Those of [`Verdict::with`].
pub fn mend(
    robot: &Robot,
    prover: &mut Prover<'_>,
    wave: &Wave,
    options: &CheckOptions,
    means: &[Means],
) -> Result<Mended> {
    let mut mended = Mended {
        wave: wave.clone(),
        changes: Vec::new(),
        verdict: Verdict::with(robot, prover, wave, options)?,
    };
    for means in means {
        if mended.verdict.passes() {
            break;
        }
        let mut workshop = Workshop {
            robot,
            prover: &mut *prover,
            options,
        };
        let (wave, changes) = match means {
            Means::Shift => workshop.shift(&mended.wave)?,
            Means::Slow => workshop.slow(&mended.wave)?,
            Means::ShrinkOffending => workshop.shrink_offending(&mended.wave)?,
            Means::Shrink => workshop.shrink(&mended.wave)?,
        };
        if !changes.is_empty() {
            mended.verdict = Verdict::with(robot, prover, &wave, options)?;
            mended.wave = wave;
            mended.changes.extend(changes);
        }
    }
    Ok(mended)
}

struct Workshop<'a, 'm> {
    robot: &'a Robot,
    prover: &'a mut Prover<'m>,
    options: &'a CheckOptions,
}

type Changed = (Wave, Vec<Change>);

impl Workshop<'_, '_> {
    fn limits(&self, wave: &Wave) -> Result<Vec<LimitUse>> {
        limits_with(self.robot, wave, &self.options.limits)
    }

    fn broken_efforts(&self, wave: &Wave) -> Result<Vec<EffortUse>> {
        if self.robot.require_dynamics().is_err() {
            return Ok(Vec::new());
        }
        let mut uses = efforts(self.robot, wave)?;
        for limit in uses.iter_mut().filter_map(|use_| use_.limit.as_mut()) {
            *limit *= 1.0 - EFFORT_SPARE;
        }
        uses.retain(|use_| use_.excess() > 0.0);
        Ok(uses)
    }

    /// The joint of a use, commanded or mimicking.
    fn joint(&self, name: &str) -> Result<&BodyJoint> {
        let found = self.robot.moving().find(|(_, joint)| joint.name == name);
        found
            .map(|(_, joint)| joint)
            .ok_or_else(|| Error::new(ErrorKind::Name, format!("no joint `{name}`")))
    }

    fn shift(&self, wave: &Wave) -> Result<Changed> {
        let joints = wave.joints();
        let mut allowed = vec![
            Interval {
                lower: f64::NEG_INFINITY,
                upper: f64::INFINITY
            };
            joints.len()
        ];
        for limit in self.limits(wave)? {
            let joint = self.joint(&limit.joint)?;
            if limit.quantity == Derivative::Position && joint.multiplier != 0.0 {
                let ends = [limit.limit.lower, limit.limit.upper]
                    .map(|end| (end - joint.offset) / joint.multiplier);
                let own = Interval {
                    lower: ends[0].min(ends[1]),
                    upper: ends[0].max(ends[1]),
                };
                allowed[joint.index] = allowed[joint.index].intersect(own);
            }
        }
        let mut shifts = vec![0.0; joints.len()];
        let mut changes = Vec::new();
        for (j, allowed) in allowed.iter().enumerate() {
            let range = wave.range(j, Derivative::Position);
            let (low, high) = (allowed.lower - range.lower, allowed.upper - range.upper);
            // What is too wide for its range is not moved from one limit over the other.
            let by = match () {
                () if low > high => 0.0,
                () if low > 0.0 => (low * (1.0 + SPARE)).min(high),
                () if high < 0.0 => (high * (1.0 + SPARE)).max(low),
                () => 0.0,
            };
            if by != 0.0 {
                shifts[j] = by;
                changes.push(Change::Shifted {
                    joint: joints.name(j).to_owned(),
                    by,
                });
            }
        }
        Ok((wave.shifted(&shifts)?, changes))
    }

    fn slow(&self, wave: &Wave) -> Result<Changed> {
        let mut factor = 1.0;
        for _ in 0..ROUNDS {
            let mut more: f64 = 1.0;
            for limit in self.limits(&wave.slowed(factor)?)? {
                if limit.excess() > 0.0 {
                    let share = limit.range.magnitude() / limit.limit.magnitude();
                    more = match limit.quantity {
                        Derivative::Velocity => more.max(share),
                        Derivative::Acceleration => more.max(share.sqrt()),
                        _ => more,
                    };
                }
            }
            if more == 1.0 {
                break;
            }
            factor *= more * (1.0 + SPARE);
        }
        let is_enough = |factor: f64| Ok(self.broken_efforts(&wave.slowed(factor)?)?.is_empty());
        if !is_enough(factor)? && is_enough(SLOWEST.max(factor))? {
            factor = bisect(SLOWEST.max(factor), factor, is_enough)?;
        }
        let changes = (factor > 1.0).then_some(Change::Slowed { factor });
        Ok((wave.slowed(factor)?, changes.into_iter().collect()))
    }

    /// For each joint the factor that its limits of position, velocity and acceleration allow, 1 where all are kept that any would keep.
    fn factors(&self, wave: &Wave) -> Result<Vec<f64>> {
        let mut factors = vec![1.0_f64; wave.joints().len()];
        for limit in self.limits(wave)? {
            if limit.excess() == 0.0 {
                continue;
            }
            let joint = self.joint(&limit.joint)?;
            let middle = match limit.quantity {
                Derivative::Position => {
                    joint.multiplier * wave.offsets()[joint.index] + joint.offset
                }
                _ => 0.0,
            };
            let share = |room: f64, taken: f64| if taken > room { room / taken } else { 1.0 };
            let factor = share(limit.limit.upper - middle, limit.range.upper - middle).min(share(
                middle - limit.limit.lower,
                middle - limit.range.lower,
            ));
            // Where the offset itself is beyond a limit, no amplitude helps: what the other limits need is told all the same.
            if factor >= 0.0 {
                let known = &mut factors[joint.index];
                *known = known.min(factor * (1.0 - SPARE));
            }
        }
        Ok(factors)
    }

    fn shrink_offending(&self, wave: &Wave) -> Result<Changed> {
        let mut factors = vec![1.0; wave.joints().len()];
        for _ in 0..ROUNDS {
            let found = self.factors(&wave.scaled(&factors)?)?;
            if found.iter().all(|f| *f == 1.0) {
                break;
            }
            for (factor, found) in factors.iter_mut().zip(found) {
                *factor *= found;
            }
        }
        // Of those that need too much effort, together.
        let mut offending = vec![false; factors.len()];
        for effort in self.broken_efforts(&wave.scaled(&factors)?)? {
            offending[self.joint(&effort.joint)?.index] = true;
        }
        if offending.contains(&true) {
            let with = |factor: f64| -> Vec<f64> {
                let own = factors.iter().zip(&offending);
                own.map(|(f, is)| if *is { f * factor } else { *f })
                    .collect()
            };
            let is_enough = |f: f64| Ok(self.broken_efforts(&wave.scaled(&with(f))?)?.is_empty());
            if is_enough(0.0)? {
                factors = with(bisect(0.0, 1.0, is_enough)?);
            }
        }
        let changes = wave.joints().iter().zip(&factors);
        let changes = changes
            .filter(|(_, factor)| **factor < 1.0)
            .map(|(joint, factor)| Change::Shrunk {
                joint: Some(joint.clone()),
                factor: *factor,
            });
        Ok((wave.scaled(&factors)?, changes.collect()))
    }

    fn shrink(&mut self, wave: &Wave) -> Result<Changed> {
        let joints = wave.joints().len();
        let mut factor = 1.0;
        for _ in 0..ROUNDS {
            let found = self.factors(&wave.scaled(&vec![factor; joints])?)?;
            let least = found.iter().fold(1.0, |a: f64, b| a.min(*b));
            if least == 1.0 {
                break;
            }
            factor *= least;
        }
        let mut passes = |factor: f64| -> Result<bool> {
            let wave = wave.scaled(&vec![factor; joints])?;
            if !self.broken_efforts(&wave)?.is_empty() {
                return Ok(false);
            }
            let options = self.options;
            let found = self
                .prover
                .certify(&wave, options.margin, &options.tolerance)?;
            Ok(found.is_clear())
        };
        if !passes(factor)? && passes(0.0)? {
            factor = bisect(0.0, factor, passes)?;
        }
        let change = (factor < 1.0).then_some(Change::Shrunk {
            joint: None,
            factor,
        });
        let changed = wave.scaled(&vec![factor; joints])?;
        Ok((changed, change.into_iter().collect()))
    }
}

/// The factor nearest to `bad` that is good, to a millionth, from one that is.
fn bisect(
    mut good: f64,
    mut bad: f64,
    mut is_good: impl FnMut(f64) -> Result<bool>,
) -> Result<f64> {
    while (good - bad).abs() > FINE * good.abs().max(bad.abs()) {
        let middle = 0.5 * (good + bad);
        if is_good(middle)? {
            good = middle;
        } else {
            bad = middle;
        }
    }
    Ok(good)
}

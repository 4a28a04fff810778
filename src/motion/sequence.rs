//! [`Sequence`]: moves and waves one after the other, as one motion.

mod tube;

use super::{Motion, Spline};
use crate::error::{Error, ErrorKind, Reason, Result};
use crate::fourier::{Derivative, Extremes, Interval, Joints, State, Wave};

pub use tube::SequenceTube;

/// Where two legs meet, positions, velocities and accelerations are the same to this share of their size, and of 1.
const SMOOTH: f64 = 1e-6;

/// A wave goes on for no more cycles of its highest harmonic: proofs look at each of them.
const MOST_CYCLES: f64 = 1e6;

/// What reducing a time to that of a leg may lose, in machine epsilons of the times.
const LATE: f64 = 8.0 * f64::EPSILON;

/// A part of a [`Sequence`].
#[derive(Debug, Clone, PartialEq)]
pub enum Leg {
    /// A move through waypoints, from its start to its end.
    Move(Spline),
    /// A wave, from time `from` in its period, for a duration \[s\].
    Wave {
        /// Of the same joints as all other legs.
        wave: Wave,
        /// Where in its period it is entered \[s\].
        from: f64,
        /// How long it goes on \[s\].
        duration: f64,
    },
}

impl Leg {
    fn joints(&self) -> &Joints {
        match self {
            Self::Move(spline) => Motion::joints(spline),
            Self::Wave { wave, .. } => wave.joints(),
        }
    }

    /// \[s\]
    pub fn duration(&self) -> f64 {
        match self {
            Self::Move(spline) => spline.duration(),
            Self::Wave { duration, .. } => *duration,
        }
    }

    /// At a time since the leg began \[s\].
    fn state_into(&self, t: f64, state: &mut State) {
        match self {
            Self::Move(spline) => spline.state_into(t, state),
            Self::Wave { wave, from, .. } => wave.state_into(from + t, state),
        }
    }

    fn extremes(&self, joint: usize, derivative: Derivative) -> Extremes {
        match self {
            // That it begins or ends in motion is no jump here: its neighbours move likewise.
            Self::Move(spline) => spline.inner_extremes(joint, derivative),
            Self::Wave {
                wave,
                from,
                duration,
            } => {
                // What holds for the whole wave holds for a part of it: of two enclosures of the same curve neither may be the wider, lest a wave
                // that is just within a limit be beyond it in here.
                let whole = wave.extremes(joint, derivative);
                let part = if *duration < wave.period() {
                    let part = wave.extremes_within(joint, derivative, *from, from + duration);
                    Extremes {
                        range: part.range.intersect(whole.range),
                        ..part
                    }
                } else {
                    whole
                };
                // The first time that it is there since the wave was entered.
                let since = |t: f64| (t - from).rem_euclid(wave.period()).min(*duration);
                Extremes {
                    lower_time: since(part.lower_time),
                    upper_time: since(part.upper_time),
                    ..part
                }
            }
        }
    }
}

/// Legs one after the other, each beginning as the one before it ends: in position, velocity and acceleration.
///
/// ```
/// use undulate::{Joints, Leg, Motion, Sequence, Spline, StartPosture, Wave, Waypoint, Waypoints};
/// use undulate::nalgebra::{dmatrix, dvector};
/// use undulate::num_complex::Complex;
///
/// let joints = Joints::new(["elbow"])?;
/// let wave = Wave::new(joints.clone(), 2.0, dvector![0.5], dmatrix![Complex::new(0.1, 0.0)])?;
/// let enter = wave.state(0.0);
/// let rest = Waypoint { time: 0.0, positions: &[0.0], velocities: Some(&[0.0]), accelerations: Some(&[0.0]) };
/// let there = Waypoint {
///     time: 1.5,
///     positions: enter.position.as_slice(),
///     velocities: Some(enter.velocity.as_slice()),
///     accelerations: Some(enter.acceleration.as_slice()),
/// };
/// let raise = Spline::new(&Waypoints::new(joints, [rest, there])?, StartPosture::Given)?;
/// let motion = Sequence::new(vec![Leg::Move(raise), Leg::Wave { wave, from: 0.0, duration: 6.0 }])?;
/// assert_eq!(motion.duration(), 7.5);
/// # Ok::<(), undulate::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Sequence {
    legs: Vec<Leg>,
    /// When each begins, and when the last one ends \[s\].
    times: Vec<f64>,
}

impl Sequence {
    /// # Errors
    /// When there is no leg, one has no duration or other joints than the first, or one does not begin as the one before it ends.
    pub fn new(legs: Vec<Leg>) -> Result<Self> {
        let Some(first) = legs.first() else {
            return Err(
                Error::new(ErrorKind::Shape, "a sequence of nothing").because(Reason::NoDuration)
            );
        };
        let joints = first.joints().clone();
        let mut times = vec![0.0];
        let mut end: Option<State> = None;
        let (mut start, mut last) = (State::zeros(joints.len()), State::zeros(joints.len()));
        for (number, leg) in legs.iter().enumerate() {
            let place = || format!("leg {}", number + 1);
            if *leg.joints() != joints {
                return Err(Error::new(
                    ErrorKind::Name,
                    format!("a motion of {}", leg.joints().listed()),
                )
                .expected(joints.listed())
                .at(place()));
            }
            let duration = leg.duration();
            if !(duration > 0.0 && duration.is_finite()) {
                return Err(
                    Error::new(ErrorKind::Value, format!("a duration of {duration} s"))
                        .because(Reason::NoDuration)
                        .expected("a positive number of seconds")
                        .at(place()),
                );
            }
            if let Leg::Wave { wave, .. } = leg
                && duration / wave.period() * wave.harmonics() as f64 > MOST_CYCLES
            {
                return Err(
                    Error::new(ErrorKind::Value, format!("a wave for {duration} s"))
                        .because(Reason::TooLarge)
                        .expected(format!(
                            "at most {MOST_CYCLES:e} cycles of its highest harmonic"
                        ))
                        .at(place()),
                );
            }
            leg.state_into(0.0, &mut start);
            leg.state_into(duration, &mut last);
            if let Some(end) = &end
                && let Some((joint, what)) = gap(end, &start)
            {
                return Err(Error::new(
                    ErrorKind::Infeasible,
                    format!("{what} of joint `{}` jumps", joints.name(joint)),
                )
                .expected("a leg that begins as the one before it ends")
                .at(place()));
            }
            end = Some(last.clone());
            times.push(times[number] + duration);
        }
        Ok(Self { legs, times })
    }

    /// Its legs.
    pub fn legs(&self) -> &[Leg] {
        &self.legs
    }

    /// When each leg begins, and when the last one ends \[s\].
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The leg of a time; the later one where two meet.
    fn leg_at(&self, t: f64) -> usize {
        let later = self.times.partition_point(|start| *start <= t);
        later.saturating_sub(1).min(self.legs.len() - 1)
    }
}

/// The joint and quantity in which two states differ.
fn gap(a: &State, b: &State) -> Option<(usize, &'static str)> {
    let differs = |x: f64, y: f64| {
        let far = (x - y).abs() > SMOOTH * (1.0 + x.abs().max(y.abs()));
        far || (x - y).is_nan()
    };
    (0..a.position.len()).find_map(|joint| {
        let all = [
            (a.position[joint], b.position[joint], "the position"),
            (a.velocity[joint], b.velocity[joint], "the velocity"),
            (
                a.acceleration[joint],
                b.acceleration[joint],
                "the acceleration",
            ),
        ];
        all.into_iter()
            .find(|(x, y, _)| differs(*x, *y))
            .map(|(_, _, what)| (joint, what))
    })
}

impl Motion for Sequence {
    type Tube<'a> = SequenceTube<'a>;

    fn joints(&self) -> &Joints {
        self.legs[0].joints()
    }

    fn duration(&self) -> f64 {
        self.times[self.legs.len()]
    }

    fn is_periodic(&self) -> bool {
        false
    }

    /// Before and after, as at the start and at the end.
    fn state_into(&self, t: f64, state: &mut State) {
        let leg = self.leg_at(t);
        let local = (t - self.times[leg]).clamp(0.0, self.legs[leg].duration());
        self.legs[leg].state_into(local, state);
    }

    fn extremes(&self, joint: usize, derivative: Derivative) -> Extremes {
        let mut all: Option<Extremes> = None;
        for (leg, start) in self.legs.iter().zip(&self.times) {
            let own = leg.extremes(joint, derivative);
            let (lower_time, upper_time) = (start + own.lower_time, start + own.upper_time);
            all = Some(match all {
                None => Extremes {
                    lower_time,
                    upper_time,
                    ..own
                },
                Some(all) => Extremes {
                    range: all.range.hull(own.range),
                    lower_time: if own.range.lower < all.range.lower {
                        lower_time
                    } else {
                        all.lower_time
                    },
                    upper_time: if own.range.upper > all.range.upper {
                        upper_time
                    } else {
                        all.upper_time
                    },
                },
            });
        }
        // There is a leg.
        all.unwrap_or(Extremes {
            range: Interval::within(f64::INFINITY),
            lower_time: 0.0,
            upper_time: 0.0,
        })
    }

    fn tube(&self) -> SequenceTube<'_> {
        SequenceTube::new(self)
    }
}

#[cfg(test)]
mod tests;

//! Ways from rest into a wave and back, and from one wave into another.

use nalgebra::DVector;
use rand::rngs::ChaCha8Rng;
use rand::{Rng, SeedableRng};

use super::{CheckOptions, Verdict, keeps_limits};
use crate::collision::Prover;
use crate::error::{Error, ErrorKind, Reason, Result};
use crate::fourier::{Joints, State, Wave};
use crate::motion::{Leg, Motion, Sequence, Spline, StartPosture, Waypoint, Waypoints};
use crate::robot::Robot;

/// Durations that are tried \[s\]: the first, the last, and the factor from one to the next.
const SHORTEST: f64 = 0.05;
const LONGEST: f64 = 20.0;
const LONGER: f64 = 1.1;

/// An arm is not raised or lowered in less \[s\], nor taken from one wave into another in less than half of it, unless that is asked for.
const EASE: f64 = 1.0;

/// Phases of a period at which a wave may be entered or left.
const PHASES: usize = 16;

/// Slower ways that are tried where the quickest touches.
const SLOWER: usize = 5;

/// Postures on the way that are tried where no straight way is clear.
const DETOURS: u64 = 200;
/// How long one runs up to a motion, or out of it \[s\].
const RUN: [f64; 4] = [0.0, 0.1, 0.25, 0.5];
/// Phases from which detours are tried where nothing goes straight.
const APPROACHES: usize = 4;

/// A wave with its beginning and its end.
#[derive(Debug, Clone)]
pub struct Performance {
    /// From rest into the wave, the wave, and back to rest.
    pub sequence: Sequence,
    /// On all of it: it passes.
    pub verdict: Verdict,
}

/// Ways between states of a robot, within what `options` ask for: quintic in every joint, as quick as limits allow, and proven clear.
pub struct Passages<'a, 'm> {
    robot: &'a Robot,
    prover: Prover<'m>,
    options: CheckOptions,
    ease: f64,
}

impl<'a, 'm> Passages<'a, 'm> {
    /// Of `robot`, by what proves its motions clear.
    pub fn new(robot: &'a Robot, prover: Prover<'m>, options: CheckOptions) -> Self {
        Self {
            robot,
            prover,
            options: CheckOptions {
                // Only whether it passes is asked for.
                accuracy: None,
                ..options
            },
            ease: EASE,
        }
    }

    /// The same, but ways out of rest and back take `seconds` at least, and those from wave to wave half of it: 1 s when nothing is said, 0 for as
    /// quick as limits allow.
    ///
    /// # Errors
    /// When that is negative or more than 20 s.
    pub fn eased(self, seconds: f64) -> Result<Self> {
        if !(0.0..=LONGEST).contains(&seconds) {
            return Err(
                Error::new(ErrorKind::Setting, format!("ways of at least {seconds} s"))
                    .expected(format!("from 0 to {LONGEST} s")),
            );
        }
        Ok(Self {
            ease: seconds,
            ..self
        })
    }

    /// From the posture `rest` \[rad, m\] into the first wave, from each wave into the next, and back to rest from the last, twice continuously
    /// differentiable and proven as a whole. Each wave goes on for `duration` \[s\] or up to a period longer: where it is entered and left is chosen so
    /// that the ways are short.
    ///
    /// ```
    /// use undulate::{nalgebra::{DMatrix, DVector}, num_complex::Complex};
    /// use undulate::{CheckOptions, CollisionModel, CollisionOptions, Motion, Passages, Wave, shipped};
    ///
    /// let robot = shipped::robot("wave_arm")?;
    /// let collision = CollisionModel::new(&robot, &CollisionOptions::default())?;
    /// let mut weights = DMatrix::zeros(6, 1);
    /// weights[(3, 0)] = Complex::new(0.1, 0.0);
    /// let wave = Wave::new(robot.joints().clone(), 1.0, DVector::from_element(6, 0.4), weights)?;
    /// let mut passages = Passages::new(&robot, collision.prover(), CheckOptions::default());
    /// let performance = passages.perform(&[&wave], &robot.rest(), 3.0)?;
    /// assert!(performance.verdict.passes() && performance.sequence.duration() > 3.0);
    /// # Ok::<(), undulate::Error>(())
    /// ```
    ///
    /// # Errors
    /// When there is no wave or one does not pass by itself, the posture is beyond a limit or touches, the duration is not positive, or no way is found.
    pub fn perform(&mut self, waves: &[&Wave], rest: &[f64], duration: f64) -> Result<Performance> {
        if !(duration > 0.0 && duration.is_finite()) {
            return Err(
                Error::new(ErrorKind::Setting, format!("a duration of {duration} s"))
                    .expected("a positive number of seconds"),
            );
        }
        let Some(mut wave) = waves.first().copied() else {
            return Err(Error::new(ErrorKind::Shape, "no wave").expected("one at least"));
        };
        for (number, wave) in waves.iter().enumerate() {
            let what = match waves.len() {
                1 => "the wave".to_owned(),
                _ => format!("wave number {}", number + 1),
            };
            self.require(*wave, &what)
                .map_err(|e| e.help("mend it (`undulate mend`) or sample another"))?;
        }
        let still = self.posture(rest)?;
        let (raise, mut from) = self.enter(&still, wave)?;
        let mut legs = vec![Leg::Move(raise)];
        for next in &waves[1..] {
            let (way, (until, phase)) = self.cross(wave, from + duration, next)?;
            legs.push(waved(wave, from, until));
            legs.push(Leg::Move(way));
            (wave, from) = (next, phase);
        }
        let (lower, until) = self.leave(wave, from + duration, &still)?;
        legs.push(waved(wave, from, until));
        legs.push(Leg::Move(lower));
        let sequence = Sequence::new(legs)?;
        let verdict = self.require(&sequence, "the whole motion")?;
        Ok(Performance { sequence, verdict })
    }

    /// A state at rest in a posture that is within the limits and touches nothing.
    ///
    /// # Errors
    /// When it is not.
    pub fn posture(&mut self, posture: &[f64]) -> Result<State> {
        let joints = self.robot.joints();
        if posture.len() != joints.len() {
            return Err(Error::new(
                ErrorKind::Shape,
                format!("a posture of {} numbers", posture.len()),
            )
            .because(Reason::WrongSize)
            .expected(format!("one for each of {} joints", joints.len())));
        }
        let mut still = State::zeros(joints.len());
        still.position.copy_from_slice(posture);
        // Standing there is a move as well.
        let standing = between(joints, &[&still, &still], &[1.0])?;
        self.require(&standing, "the posture at rest")?;
        Ok(still)
    }

    /// # Errors
    /// When a motion does not pass; the error has the reason.
    pub(super) fn require<M: Motion>(&mut self, motion: &M, what: &str) -> Result<Verdict> {
        let verdict = Verdict::with(self.robot, &mut self.prover, motion, &self.options)?;
        let reasons = verdict.reasons();
        let Some(first) = reasons.first() else {
            return Ok(verdict);
        };
        let faults = verdict.faults().join("; ");
        Err(Error::new(
            ErrorKind::Refused,
            format!("{what} does not pass: {faults}"),
        )
        .because(*first)
        .expected("a motion within limits that is proven clear")
        .at(format!("robot `{}`", self.robot.name())))
    }

    /// What a way from wave to wave takes at least \[s\].
    pub(super) fn least_between(&self) -> f64 {
        self.ease / 2.0
    }

    /// From a state at rest into a wave: the way, and where in its period it is entered \[s\].
    pub(super) fn enter(&mut self, still: &State, wave: &Wave) -> Result<(Spline, f64)> {
        let phases = (0..PHASES).map(|n| wave.period() * n as f64 / PHASES as f64);
        let ways = phases.map(|phase| (0.0, still.clone(), wave.state(phase), phase));
        self.best(ways.collect(), self.ease, "into the wave")
    }

    /// Out of a wave at time `from` \[s\] or later, within a period, to a state at rest: the way, and when the wave is left \[s\].
    fn leave(&mut self, wave: &Wave, from: f64, still: &State) -> Result<(Spline, f64)> {
        let waits = (0..PHASES).map(|n| wave.period() * n as f64 / PHASES as f64);
        let ways = waits.map(|wait| (wait, wave.state(from + wait), still.clone(), from + wait));
        self.best(ways.collect(), self.ease, "out of the wave")
    }

    /// Out of a wave at time `from` \[s\] or later, within a period, into another: the way, when the one is left and where the other is entered \[s\].
    fn cross(&mut self, wave: &Wave, from: f64, next: &Wave) -> Result<(Spline, (f64, f64))> {
        let at = |wave: &Wave, n: usize| wave.period() * n as f64 / PHASES as f64;
        let mut ways = Vec::with_capacity(PHASES * PHASES);
        for n in 0..PHASES {
            let wait = at(wave, n);
            let leave = wave.state(from + wait);
            for m in 0..PHASES {
                let phase = at(next, m);
                ways.push((wait, leave.clone(), next.state(phase), (from + wait, phase)));
            }
        }
        self.best(ways, self.least_between(), "from one wave into the next")
    }

    /// The way that is done first, of several with what they cost before they begin \[s\] and what is known of each; none takes less than `least` \[s\].
    pub(super) fn best<T: Clone>(
        &mut self,
        ways: Vec<(f64, State, State, T)>,
        least: f64,
        what: &str,
    ) -> Result<(Spline, T)> {
        let mut quickest = Vec::new();
        for (number, (before, from, to, _)) in ways.iter().enumerate() {
            if let Some(way) = self.quickest(from, to, least)? {
                quickest.push((before + way.duration(), number, way));
            }
        }
        quickest.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, number, way) in &quickest {
            let (_, from, to, known) = &ways[*number];
            let mut way = way.clone();
            for _ in 0..=SLOWER {
                if self.is_clear(&way)? {
                    return Ok((way, known.clone()));
                }
                way = between(self.robot.joints(), &[from, to], &[way.duration() * LONGER])?;
                if !self.is_within(&way)? {
                    break;
                }
            }
        }
        // Where no straight way keeps the limits, any may have one by a posture.
        let tried: Vec<usize> = match quickest.first() {
            Some((_, number, _)) => vec![*number],
            None => (0..ways.len())
                .step_by(ways.len().div_ceil(APPROACHES).max(1))
                .collect(),
        };
        for number in tried {
            let (_, from, to, known) = &ways[number];
            if let Some(way) = self.detour(from, to, least)? {
                return Ok((way, known.clone()));
            }
        }
        let why = if quickest.is_empty() {
            "none keeps the limits"
        } else {
            "none of those that keep the limits is proven clear"
        };
        Err(
            Error::new(ErrorKind::Refused, format!("no way {what}: {why}"))
                .expected("a way of at most 20 s, straight or by one posture")
                .help("start from another posture of rest, or wave elsewhere, slower or smaller")
                .at(format!("robot `{}`", self.robot.name())),
        )
    }

    /// The quickest straight way that keeps the limits and takes `least` \[s\] or more.
    fn quickest(&self, from: &State, to: &State, least: f64) -> Result<Option<Spline>> {
        let mut duration = SHORTEST.max(least);
        while duration <= LONGEST {
            let way = between(self.robot.joints(), &[from, to], &[duration])?;
            if self.is_within(&way)? {
                return Ok(Some(way));
            }
            duration *= LONGER;
        }
        Ok(None)
    }

    /// By a posture on the way, at rest there.
    fn detour(&mut self, from: &State, to: &State, least: f64) -> Result<Option<Spline>> {
        let joints = self.robot.joints();
        let mut random = ChaCha8Rng::seed_from_u64(0);
        // A run-up to where it goes, or a run-out from where it comes, is short at either end.
        let near = RUN.iter().flat_map(|run| {
            [
                &to.position - &to.velocity * *run,
                &from.position + &from.velocity * *run,
            ]
        });
        for position in near {
            let mut via = State::zeros(joints.len());
            via.position = position;
            if let Some(way) = self.by(from, &via, to, least)? {
                return Ok(Some(way));
            }
        }
        for n in 0..DETOURS {
            // About the middle, and farther and farther from it.
            let spread = 0.2 + 2.0 * n as f64 / DETOURS as f64;
            let mut via = State::zeros(joints.len());
            for j in 0..joints.len() {
                let unit = (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
                let middle = 0.5 * (from.position[j] + to.position[j]);
                let position = middle + spread * (2.0 * unit - 1.0);
                via.position[j] = match self.robot.properties(j).position {
                    Some(limit) => position.clamp(limit.lower, limit.upper),
                    None => position,
                };
            }
            if let Some(way) = self.by(from, &via, to, least)? {
                return Ok(Some(way));
            }
        }
        Ok(None)
    }

    /// By a posture, at rest there, if that keeps the limits and is clear.
    fn by(&mut self, from: &State, via: &State, to: &State, least: f64) -> Result<Option<Spline>> {
        let half = least / 2.0;
        let (Some(first), Some(second)) = (
            self.quickest(from, via, half)?,
            self.quickest(via, to, half)?,
        ) else {
            return Ok(None);
        };
        let lengths = [first.duration(), second.duration()];
        let way = between(self.robot.joints(), &[from, via, to], &lengths)?;
        Ok((self.is_within(&way)? && self.is_clear(&way)?).then_some(way))
    }

    fn is_within(&self, way: &Spline) -> Result<bool> {
        // As a part of something, it may begin and end in motion.
        let way = Sequence::new(vec![Leg::Move(way.clone())])?;
        keeps_limits(self.robot, &way, &self.options)
    }

    fn is_clear(&mut self, way: &Spline) -> Result<bool> {
        let options = &self.options;
        let found = self
            .prover
            .certify(way, options.margin, &options.tolerance)?;
        Ok(found.is_clear())
    }

    /// From a state to a standstill, not far from where it is: the quickest way that keeps the limits, if it is proven clear.
    pub(super) fn halt(&mut self, from: &State) -> Result<Option<Spline>> {
        let mut duration = SHORTEST;
        while duration <= LONGEST {
            let mut still = State::zeros(from.position.len());
            // As far as constant deceleration goes.
            still.position = &from.position + &from.velocity * (duration / 2.0);
            let way = between(self.robot.joints(), &[from, &still], &[duration])?;
            if self.is_within(&way)? {
                return Ok(if self.is_clear(&way)? {
                    Some(way)
                } else {
                    None
                });
            }
            duration *= LONGER;
        }
        Ok(None)
    }
}

fn waved(wave: &Wave, from: f64, until: f64) -> Leg {
    Leg::Wave {
        wave: wave.clone(),
        from,
        duration: until - from,
    }
}

/// The quintic spline through states, so many seconds apart.
pub(super) fn between(joints: &Joints, states: &[&State], lengths: &[f64]) -> Result<Spline> {
    let mut time = 0.0;
    let slice = |v: &'_ DVector<f64>| v.as_slice().to_vec();
    let rows: Vec<(f64, [Vec<f64>; 3])> = states
        .iter()
        .enumerate()
        .map(|(n, state)| {
            if n > 0 {
                time += lengths[n - 1];
            }
            let row = [&state.position, &state.velocity, &state.acceleration].map(slice);
            (time, row)
        })
        .collect();
    let waypoints = rows.iter().map(|(time, [q, v, a])| Waypoint {
        time: *time,
        positions: q,
        velocities: Some(v),
        accelerations: Some(a),
    });
    let waypoints = Waypoints::new(joints.clone(), waypoints)?;
    Spline::new(&waypoints, StartPosture::Given)
}

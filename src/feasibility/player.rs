//! A wave at the controller's rate, changed while it runs.

use super::passage::Passages;
use super::{CheckOptions, keeps_limits};
use crate::collision::CollisionModel;
use crate::error::{Error, ErrorKind, Reason, Result};
use crate::fourier::{Joints, State, Wave};
use crate::motion::{Leg, Motion, Sequence, Spline};
use crate::robot::Robot;

/// Phases of a period at which a stop is held ready.
const STOPS: usize = 64;
/// Phases of the wave that runs at which it may be left for another, and of the other at which it may be entered.
const DEPARTURES: usize = 8;
const ARRIVALS: usize = 16;
/// Parts of a timeline: what runs, what it goes over to, a passage between, a stop.
const PARTS: usize = 8;

/// Plans what a [`Player`] plays: away from the controller's thread, for planning takes as long as it takes.
pub struct Planner<'a, 'm> {
    passages: Passages<'a, 'm>,
    robot: &'a Robot,
    options: CheckOptions,
    time_step: f64,
}

/// A change of what is played, proven: a passage out of what runs, and a wave with its stops.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Of the timeline that it continues.
    version: u64,
    /// When it takes over \[s\], and in which state.
    at: f64,
    leaves: State,
    parts: Vec<(f64, Part)>,
    stops: Stops,
}

impl Plan {
    /// When it takes over, on the player's clock \[s\]: after that it is too late to take it.
    pub fn at(&self) -> f64 {
        self.at
    }
}

/// What the joints are told, tick by tick: first from rest into a wave, then the wave until it is changed or stopped.
///
/// A tick allocates nothing. Whatever is played, a stop that is proven to keep the limits and to touch nothing stands ready: at once where a wave passes
/// the phase of the next one, else when the passage under way is over.
#[derive(Debug, Clone)]
pub struct Player {
    joints: Joints,
    time_step: f64,
    ticks: u64,
    version: u64,
    /// Each with when it begins \[s\].
    parts: Vec<(f64, Part)>,
    /// The one that runs.
    now: usize,
    stops: Stops,
    is_stopping: bool,
    /// Where it would be when a plan takes over.
    scratch: State,
}

#[derive(Debug, Clone)]
enum Part {
    Move(Spline),
    /// And where it is entered \[s\].
    Wave(Wave, f64),
    /// The stop of this number.
    Stop(usize),
}

/// Ways from a wave to a standstill, by the phase at which they leave it.
#[derive(Debug, Clone)]
struct Stops {
    /// Phase within the period \[s\], and the way; in order of phase, at least one.
    ways: Vec<(f64, Spline)>,
    period: f64,
}

impl Stops {
    /// Number of the first stop at or after time `t` of the wave, and how long that is to wait \[s\].
    fn next(&self, t: f64) -> (usize, f64) {
        let phase = t.rem_euclid(self.period);
        match self.ways.iter().position(|(at, _)| *at >= phase) {
            Some(number) => (number, self.ways[number].0 - phase),
            None => (0, self.ways[0].0 + self.period - phase),
        }
    }

    /// From any time of the wave to a standstill, at most \[s\].
    fn longest(&self) -> f64 {
        let count = self.ways.len();
        (0..count)
            .map(|n| {
                let (at, way) = &self.ways[n];
                let before = match n {
                    0 => self.ways[count - 1].0 - self.period,
                    n => self.ways[n - 1].0,
                };
                at - before + way.duration()
            })
            .fold(0.0, f64::max)
    }
}

impl<'a, 'm> Planner<'a, 'm> {
    /// For ticks `time_step` \[s\] apart.
    ///
    /// # Errors
    /// When the time step is not positive.
    pub fn new(
        robot: &'a Robot,
        collision: &'m CollisionModel,
        options: CheckOptions,
        time_step: f64,
    ) -> Result<Self> {
        if !(time_step > 0.0 && time_step.is_finite()) {
            return Err(
                Error::new(ErrorKind::Setting, format!("a time step of {time_step} s"))
                    .expected("a positive number of seconds"),
            );
        }
        Ok(Self {
            passages: Passages::new(robot, collision.prover(), options.clone()),
            robot,
            options,
            time_step,
        })
    }

    /// From the posture `rest` \[rad, m\] into `wave`.
    ///
    /// ```
    /// use undulate::{nalgebra::{DMatrix, DVector}, num_complex::Complex};
    /// use undulate::{CheckOptions, CollisionModel, CollisionOptions, Planner, State, Wave, shipped};
    ///
    /// let robot = shipped::robot("wave_arm")?;
    /// let collision = CollisionModel::new(&robot, &CollisionOptions::default())?;
    /// let mut weights = DMatrix::zeros(6, 1);
    /// weights[(3, 0)] = Complex::new(0.1, 0.0);
    /// let wave = Wave::new(robot.joints().clone(), 1.0, DVector::from_element(6, 0.4), weights)?;
    /// let mut planner = Planner::new(&robot, &collision, CheckOptions::default(), 0.001)?;
    /// let mut player = planner.start(&wave, &robot.rest())?;
    /// let mut state = State::zeros(6);
    /// for _ in 0..2000 {
    ///     player.tick(&mut state); // send it
    /// }
    /// let faster = planner.change(&player, &wave.slowed(0.8)?, 0.05)?;
    /// player.take(faster)?;
    /// player.stop();
    /// # Ok::<(), undulate::Error>(())
    /// ```
    ///
    /// # Errors
    /// When the wave or the posture does not pass, there is no way from one to the other, or no stop out of the wave.
    pub fn start(&mut self, wave: &Wave, rest: &[f64]) -> Result<Player> {
        let stops = self.stops(wave)?;
        let still = self.passages.posture(rest)?;
        let (way, from) = self.passages.enter(&still, wave)?;
        let mut parts = Vec::with_capacity(PARTS);
        let end = way.duration();
        parts.push((0.0, Part::Move(way)));
        parts.push((end, Part::Wave(wave.clone(), from)));
        Ok(Player {
            joints: wave.joints().clone(),
            time_step: self.time_step,
            ticks: 0,
            version: 0,
            parts,
            now: 0,
            stops,
            is_stopping: false,
            scratch: State::zeros(wave.joints().len()),
        })
    }

    /// From the wave that `player` plays, or is about to, into another one, `lead` \[s\] from now or later: as much as planning and handing over take.
    ///
    /// # Errors
    /// When the player is stopping, the wave does not pass, there is no way into it, or no stop out of it: what runs goes on.
    pub fn change(&mut self, player: &Player, wave: &Wave, lead: f64) -> Result<Plan> {
        let Some((begin, Part::Wave(runs, from))) = player.parts.last() else {
            return Err(Error::new(
                ErrorKind::Infeasible,
                "the player is stopping, or has stopped",
            )
            .help("start anew from where it stands"));
        };
        let stops = self.stops(wave)?;
        let earliest = (player.time() + lead.max(0.0)).max(*begin);
        let mut ways = Vec::with_capacity(DEPARTURES * ARRIVALS);
        for n in 0..DEPARTURES {
            let wait = runs.period() * n as f64 / DEPARTURES as f64;
            // On a tick, so that none falls between.
            let at = ((earliest + wait) / self.time_step).ceil() * self.time_step;
            let leave = runs.state(from + (at - begin));
            for m in 0..ARRIVALS {
                let phase = wave.period() * m as f64 / ARRIVALS as f64;
                ways.push((at - earliest, leave.clone(), wave.state(phase), (at, phase)));
            }
        }
        let least = self.passages.least_between();
        let (way, (at, phase)) = self.passages.best(ways, least, "into the other wave")?;
        // As a whole: limits where the parts meet, and the way itself.
        let whole = Sequence::new(vec![
            Leg::Move(way.clone()),
            Leg::Wave {
                wave: wave.clone(),
                from: phase,
                duration: wave.period(),
            },
        ])?;
        if !keeps_limits(self.robot, &whole, &self.options)? {
            return Err(Error::new(ErrorKind::Refused, "the change breaks a limit")
                .because(Reason::AccelerationLimit));
        }
        let end = at + way.duration();
        let mut parts = Vec::with_capacity(PARTS);
        parts.push((at, Part::Move(way)));
        parts.push((end, Part::Wave(wave.clone(), phase)));
        Ok(Plan {
            version: player.version,
            at,
            leaves: runs.state(from + (at - begin)),
            parts,
            stops,
        })
    }

    /// Ways out of a wave that passes.
    fn stops(&mut self, wave: &Wave) -> Result<Stops> {
        self.passages.require(wave, "the wave")?;
        let mut ways = Vec::new();
        for n in 0..STOPS {
            let phase = wave.period() * n as f64 / STOPS as f64;
            if let Some(way) = self.passages.halt(&wave.state(phase))? {
                ways.push((phase, way));
            }
        }
        if ways.is_empty() {
            return Err(Error::new(
                ErrorKind::Refused,
                "no stop out of the wave keeps the limits and is proven clear",
            )
            .help("wave smaller or slower"));
        }
        Ok(Stops {
            ways,
            period: wave.period(),
        })
    }
}

impl Player {
    /// The joints' names.
    pub fn joints(&self) -> &Joints {
        &self.joints
    }

    /// Of the next tick \[s\].
    pub fn time(&self) -> f64 {
        self.ticks as f64 * self.time_step
    }

    /// Position to jerk for this tick; then the clock goes on. Allocates nothing. Panics when `state` was made for another number of joints.
    pub fn tick(&mut self, state: &mut State) {
        let time = self.time();
        self.ticks += 1;
        while self.parts.get(self.now + 1).is_some_and(|p| p.0 <= time) {
            self.now += 1;
        }
        let (begin, part) = &self.parts[self.now];
        let local = time - begin;
        match part {
            Part::Move(way) => way.state_into(local, state),
            Part::Wave(wave, from) => wave.state_into(from + local, state),
            // When it is over, the spline stands still.
            Part::Stop(number) => self.stops.ways[*number].1.state_into(local, state),
        }
    }

    /// Whether a plan goes on from where this player will be.
    fn leads_to(&mut self, plan: &Plan) -> bool {
        let Some((begin, Part::Wave(wave, from))) = self.parts.last() else {
            return false;
        };
        if plan.leaves.position.len() != self.joints.len() {
            return false;
        }
        wave.state_into(from + (plan.at - begin), &mut self.scratch);
        self.scratch == plan.leaves
    }

    /// Takes a plan; what it replaces is given back, to be dropped where that costs nothing. Allocates nothing.
    ///
    /// # Errors
    /// When it is too late for it, something else was taken since it was made, or it was made for another player: what runs goes on.
    pub fn take(&mut self, plan: Plan) -> Result<Plan> {
        let late = plan.at < self.time();
        if late || plan.version != self.version || self.is_stopping || !self.leads_to(&plan) {
            let why = if late {
                "a plan whose time has passed"
            } else {
                "a plan for what is not played, or no longer"
            };
            return Err(Error::new(ErrorKind::Infeasible, why)
                .expected("a plan made from the player as it is, with lead enough")
                .help("plan again, with more lead"));
        }
        let Plan {
            mut parts,
            stops,
            at,
            leaves,
            ..
        } = plan;
        // What runs and what is to come before goes on, in the plan's memory, which has room for it and for a stop.
        let own = self.parts.len() - self.now;
        parts.reserve(own + 1);
        parts.extend(self.parts.drain(self.now..));
        parts.rotate_right(own);
        self.now = 0;
        self.version += 1;
        Ok(Plan {
            version: self.version,
            at,
            leaves,
            parts: std::mem::replace(&mut self.parts, parts),
            stops: std::mem::replace(&mut self.stops, stops),
        })
    }

    /// Comes to a standstill by the next stop, and tells how long that takes \[s\]. Allocates nothing.
    pub fn stop(&mut self) -> f64 {
        let time = self.time();
        if !self.is_stopping
            && let Some((begin, Part::Wave(_, from))) = self.parts.last()
        {
            // At the wave's entry where it has not begun.
            let t = from + (time - begin).max(0.0);
            let (number, wait) = self.stops.next(t);
            let start = time.max(*begin) + wait;
            self.parts.push((start, Part::Stop(number)));
            self.version += 1;
            self.is_stopping = true;
        }
        self.remaining()
    }

    /// How long a stop would take at most that is asked for at the next tick \[s\], or the one under way takes still.
    pub fn longest_stop(&self) -> f64 {
        match self.parts.last() {
            Some((begin, Part::Wave(..))) => (begin - self.time()).max(0.0) + self.stops.longest(),
            _ => self.remaining(),
        }
    }

    /// Whether it has come to a standstill.
    pub fn has_stopped(&self) -> bool {
        self.is_stopping && self.remaining() == 0.0
    }

    fn remaining(&self) -> f64 {
        match self.parts.last() {
            Some((begin, Part::Stop(number))) => {
                let end = begin + self.stops.ways[*number].1.duration();
                (end - self.time()).max(0.0)
            }
            _ => f64::INFINITY,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::passage::between;
    use super::*;

    #[test]
    fn the_next_stop_may_be_that_of_the_next_period() {
        let joints = Joints::new(["a"]).unwrap();
        let still = State::zeros(1);
        let way = between(&joints, &[&still, &still], &[0.3]).unwrap();
        let stops = Stops {
            ways: vec![(0.25, way.clone()), (0.5, way)],
            period: 2.0,
        };
        assert_eq!(stops.next(0.25), (0, 0.0));
        assert_eq!(stops.next(0.375), (1, 0.125));
        assert_eq!(stops.next(1.5), (0, 0.75));
        assert_eq!(stops.next(5.5), (0, 0.75));
        // From 0.5 to 0.25 of the next period, and the way.
        assert!((stops.longest() - 2.05).abs() < 1e-12);
    }
}

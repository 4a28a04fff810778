//! The controller: where the motion wants the joints next, and the torque that takes them there.

use nalgebra::DVector;

use super::loads::{Losses, gathered};
use super::observer::Observer;
use super::options::{Control, Plant, SimulationOptions};
use super::semi_implicit::SemiImplicit;
use crate::fourier::State;
use crate::motion::Motion;
use crate::robot::{Dynamics, GRAVITY, Robot};

/// Postures that stand for a motion, evenly spaced in time.
const POSTURES: usize = 16;

/// From one mass matrix for the observer to the next, where the feed-forward needs none \[s\]. In it a wave of 0.4 rad at 3 Hz turns a joint by
/// 0.06 rad.
const STALE: f64 = 8e-3;

/// What the controller sends; it holds until the next. Drives go evenly from one end to the other.
#[derive(Debug, Clone)]
pub(super) struct Command {
    /// Where the joints are to be now, and when the next comes \[rad, m\].
    pub position: [DVector<f64>; 2],
    /// How fast they are to be then \[rad/s, m/s\].
    pub velocity: [DVector<f64>; 2],
    /// What is fed forward along the joint of each body \[N m, N\].
    pub forward: Vec<f64>,
}

/// Gains of one position loop, critically damped about the inertia that its joint moves in a posture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gains {
    /// \[N m/rad, N/m\]
    pub stiffness: f64,
    /// \[N m s/rad, N s/m\]
    pub damping: f64,
}

impl Gains {
    /// For `inertia` \[kg m^2, kg\] and a natural frequency in Hz.
    pub fn critical(inertia: f64, bandwidth: f64) -> Self {
        let w = std::f64::consts::TAU * bandwidth;
        Self {
            stiffness: inertia * w * w,
            damping: 2.0 * inertia * w,
        }
    }
}

/// Follows a motion, once every `period`.
///
/// The feed-forward is inverse dynamics of what the plant makes of it in a period, so it differs by plant:
///
/// * Rapier takes v' = v + a dt, q' = q + v' dt. So it is inverse dynamics of its step (see [`SemiImplicit`]) at (q_n,
///   (q_n - q_{n-1})/T, second difference of q) plus the damping at (q_{n+1} - q_n)/T, which is also the velocity that is wanted.
///   Where a period is several steps, it is taken in the middle.
/// * Runge-Kutta makes of a torque that is held over a period the velocity of its mean. So it is inverse dynamics in the middle
///   of the period, at (q, v) there and (v_{n+1} - v_n)/T; what is wanted is the motion itself.
///
/// What it misses of the plant's dynamics is observed and fed forward too; see [`Observer`].
pub(super) struct Controller<'a, M> {
    robot: &'a Robot,
    motion: &'a M,
    plant: Plant,
    period: f64,
    dt: f64,
    /// What the feed-forward is multiplied by.
    share: f64,
    losses: Vec<Losses>,
    dynamics: Dynamics,
    step: SemiImplicit,
    before: State,
    now: State,
    after: State,
    /// Old rate and new one; or position and velocity in the middle.
    rates: [DVector<f64>; 2],
    acceleration: DVector<f64>,
    observer: Option<Observer>,
    /// Messages from one mass matrix for it to the next.
    stale: usize,
    efforts: Vec<f64>,
    command: Command,
}

impl<'a, M: Motion> Controller<'a, M> {
    pub fn new(robot: &'a Robot, motion: &'a M, options: &SimulationOptions, period: f64) -> Self {
        let joints = robot.joints().len();
        let zeros = State::zeros(joints);
        let losses = Losses::of_model(robot);
        let mut this = Self {
            robot,
            motion,
            plant: options.plant,
            period,
            dt: options.time_step,
            share: match options.control {
                Control::FeedForward => 1.0 + options.torque_error,
                Control::Feedback | Control::Free => 0.0,
            },
            step: SemiImplicit::new(robot, &losses),
            losses,
            dynamics: Dynamics::new(robot),
            before: zeros.clone(),
            now: zeros.clone(),
            after: zeros,
            rates: [DVector::zeros(joints), DVector::zeros(joints)],
            acceleration: DVector::zeros(joints),
            observer: options
                .observer
                .then(|| Observer::new(robot, options.bandwidth, period)),
            stale: ((STALE / period) as usize).max(1),
            efforts: vec![0.0; joints],
            command: Command {
                position: [DVector::zeros(joints), DVector::zeros(joints)],
                velocity: [DVector::zeros(joints), DVector::zeros(joints)],
                forward: vec![0.0; robot.bodies().len()],
            },
        };
        motion.state_into(-period, &mut this.before);
        motion.state_into(0.0, &mut this.now);
        this
    }

    /// Where the robot starts, and how fast: on the motion where it repeats, at rest at its start where it does not.
    pub fn start(&self) -> (DVector<f64>, DVector<f64>) {
        let velocity = match self.plant {
            _ if !self.motion.is_periodic() => DVector::zeros(self.now.position.len()),
            Plant::Rapier => (&self.now.position - &self.before.position) / self.period,
            Plant::Rk4 => self.now.velocity.clone(),
        };
        (self.now.position.clone(), velocity)
    }

    /// What is sent at the time `tick` periods after the start; to be asked for 0, 1, 2 and so on. The joints have come to a position and
    /// `velocity`, and motors `gave` so much on average since what was sent before.
    pub fn next(
        &mut self,
        tick: usize,
        [position, velocity, gave]: [&DVector<f64>; 3],
    ) -> &Command {
        let period = self.period;
        let (before, now, after) = (&self.before, &self.now, &mut self.after);
        self.motion.state_into((tick + 1) as f64 * period, after);
        let command = &mut self.command;
        for (to, from) in [now, &*after].into_iter().enumerate() {
            command.position[to].copy_from(&from.position);
            command.velocity[to].copy_from(&from.velocity);
        }
        let a = &mut self.acceleration;
        let (q, v, losing) = match self.plant {
            Plant::Rapier if period == self.dt => {
                let [old, new] = &mut self.rates;
                old.copy_from(&now.position);
                *old -= &before.position;
                *old /= period;
                new.copy_from(&after.position);
                *new -= &now.position;
                *new /= period;
                a.copy_from(new);
                *a -= &*old;
                *a /= period;
                (&now.position, &*old, &*new)
            }
            Plant::Rapier | Plant::Rk4 => {
                // Cubic between the ends, which at a period of a millisecond is the motion to rounding.
                let [q, v] = &mut self.rates;
                for j in 0..a.len() {
                    let ends = [&now.position, &after.position].map(|q| q[j]);
                    let rates = [&now.velocity, &after.velocity].map(|v| v[j]);
                    q[j] = ends[0].midpoint(ends[1]) + 0.125 * period * (rates[0] - rates[1]);
                    v[j] = 1.5 * (ends[1] - ends[0]) / period - 0.25 * (rates[0] + rates[1]);
                    a[j] = (rates[1] - rates[0]) / period;
                }
                (&*q, &*v, &*v)
            }
        };
        if self.share != 0.0 {
            let robot = self.robot;
            let efforts = match self.plant {
                Plant::Rapier => self.step.efforts(robot, [q, v, a], None, self.dt),
                Plant::Rk4 => {
                    if self.observer.is_some() && tick.is_multiple_of(self.stale) {
                        self.dynamics.mass_matrix(robot, q.as_slice());
                    }
                    let [q, v, a] = [q, v, a].map(|x| x.as_slice());
                    self.dynamics.inverse(robot, q, v, a, &GRAVITY);
                    self.dynamics.body_efforts()
                }
            };
            for (body, joint) in robot.moving() {
                let resistance = self.losses[body].at(joint.multiplier * losing[joint.index]);
                command.forward[body] = self.share * (efforts[body] + resistance);
            }
        }
        if self.share != 0.0
            && let Some(observer) = &mut self.observer
        {
            let robot = self.robot;
            let mass = match self.plant {
                Plant::Rapier => self.step.last_mass_matrix(),
                Plant::Rk4 => self.dynamics.last_mass_matrix(),
            };
            if tick > 0 {
                observer.see([position, velocity, gave]);
            }
            gathered(robot, &command.forward, &mut self.efforts);
            observer.expect(&self.efforts, (mass, self.share), a, velocity);
            for (body, joint) in robot.moving() {
                if joint.is_commanded {
                    command.forward[body] += observer.missing()[joint.index];
                }
            }
        }
        std::mem::swap(&mut self.before, &mut self.now);
        std::mem::swap(&mut self.now, &mut self.after);
        &self.command
    }
}

/// Postures along a motion.
pub(super) fn postures<M: Motion>(motion: &M) -> Vec<DVector<f64>> {
    let mut state = State::zeros(motion.joints().len());
    (0..POSTURES)
        .map(|n| {
            motion.state_into(motion.duration() * n as f64 / POSTURES as f64, &mut state);
            state.position.clone()
        })
        .collect()
}

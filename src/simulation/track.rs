//! Tracking of a wave by motors with feed-forward.

use nalgebra::DMatrix;

use super::Rollout;
use super::world::{Motor, MultibodyWorld};
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::{State, Wave};
use crate::robot::{BodyJoint, Dynamics, GRAVITY, Robot};

/// Stiffer than this against their damping, saturated motors limit-cycle: kd / kp must be at least this \[s\].
const LEAST_DAMPING_TIME: f64 = 0.02;

/// Beyond so many steps a rollout does not fit into memory.
const MOST_STEPS: f64 = 1e6;

/// Of its effort limit, what counts as being at it.
const SATURATION: f64 = 0.999;

/// How a wave is executed.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackOptions {
    /// Step of controller and simulation \[s\]; 1 ms by default.
    pub time_step: f64,
    /// How long \[s\]; one period of the wave when `None`, the default.
    pub duration: Option<f64>,
    /// Natural frequency of each critically damped position loop \[Hz\]; 12 by default.
    pub bandwidth: f64,
    /// Whether the motors are fed the torque that the robot's model says the motion needs; yes by default.
    pub feed_forward: bool,
}

impl Default for TrackOptions {
    fn default() -> Self {
        Self {
            time_step: 1e-3,
            duration: None,
            bandwidth: 12.0,
            feed_forward: true,
        }
    }
}

/// Executes `wave` on `robot` in Rapier, started on the wave's own position and velocity, under gravity, with the
/// damping, friction, position and effort limits of its URDF.
///
/// Each motor is a spring and damper whose target is moved by tau / kp. The feed-forward tau is discrete-consistent: Rapier
/// takes v' = v + a dt, q' = q + v' dt with M, C and g of (q, v) and damping of v', so tau is inverse dynamics at
/// (q_n, (q_n - q_{n-1})/dt, second difference of q) plus the damping at (q_{n+1} - q_n)/dt, which is also the velocity
/// target.
///
/// ```
/// use undulate::nalgebra::{DMatrix, DVector};
/// use undulate::{TrackOptions, Wave, shipped, track};
///
/// let robot = shipped::robot("wave_arm")?;
/// let still = Wave::new(robot.joints().clone(), 0.2, DVector::from_element(6, 0.3), DMatrix::zeros(6, 1))?;
/// let rollout = track(&robot, &still, &TrackOptions::default())?;
/// assert!(rollout.rms_error().max() < 1e-6);
/// # Ok::<(), undulate::Error>(())
/// ```
///
/// # Errors
/// When the wave is not of the robot's joints, the robot lacks masses, an option is out of range, or the simulation
/// leaves the finite numbers.
pub fn track(robot: &Robot, wave: &Wave, options: &TrackOptions) -> Result<Rollout> {
    robot.require_joints(wave.joints())?;
    let steps = options.steps(wave)?;
    let dt = options.time_step;
    let joints = robot.joints().len();
    let state = |n: i64, state: &mut State| wave.state_into(n as f64 * dt, state);

    let mut before = State::zeros(joints);
    let mut now = State::zeros(joints);
    let mut after = State::zeros(joints);
    state(-1, &mut before);
    state(0, &mut now);
    let velocity = (&now.position - &before.position) / dt;
    let mut world = MultibodyWorld::new(robot, now.position.as_slice(), velocity.as_slice(), dt)?;
    let moving: Vec<(usize, &BodyJoint)> = robot.moving().collect();
    let mut dynamics = Dynamics::new(robot);
    let motors = options.motors(robot, &moving, wave, &mut dynamics);

    let table = || DMatrix::zeros(steps + 1, joints);
    let (mut reference, mut position, mut rates, mut torque) = (table(), table(), table(), table());
    let mut saturated = vec![0; joints];
    // Buffers of the plant's own state: before the step, and what it made of it.
    let mut q = now.position.clone();
    let mut v = velocity;
    let mut v_after = v.clone();
    for n in 0..=steps {
        reference.row_mut(n).tr_copy_from(&now.position);
        position.row_mut(n).tr_copy_from(&q);
        rates.row_mut(n).tr_copy_from(&v);
        if n == steps {
            break;
        }
        state(n as i64 + 1, &mut after);
        let rate = (&after.position - &now.position) / dt;
        let acceleration = (&after.position - 2.0 * &now.position + &before.position) / (dt * dt);
        let old_rate = (&now.position - &before.position) / dt;
        dynamics.inverse(
            robot,
            now.position.as_slice(),
            old_rate.as_slice(),
            acceleration.as_slice(),
            &GRAVITY,
        );
        for (&(body, joint), motor) in moving.iter().zip(&motors) {
            let speed = joint.multiplier * rate[joint.index];
            let forward = if options.feed_forward {
                dynamics.body_efforts()[body] + resistance(joint, speed)
            } else {
                0.0
            };
            let target = joint.position(now.position.as_slice()) + forward / motor.stiffness;
            world.set_motor(body, target, speed, *motor);
        }
        world.step();
        let mut q_after = q.clone();
        for &(body, joint) in &moving {
            if robot.is_commanded(joint) {
                let (p, r) = world.joint_state(body);
                q_after[joint.index] = p;
                v_after[joint.index] = r;
            }
        }
        // Motor impulses are not told by Rapier: they are what the motion that came of them needs.
        let came = (&v_after - &v) / dt;
        dynamics.inverse(robot, q.as_slice(), v.as_slice(), came.as_slice(), &GRAVITY);
        for &(body, joint) in &moving {
            if !robot.is_commanded(joint) {
                continue;
            }
            let j = joint.index;
            let effort = dynamics.body_efforts()[body] + resistance(joint, v_after[j]);
            torque[(n, j)] = effort;
            if joint
                .properties
                .effort
                .is_some_and(|limit| effort.abs() >= SATURATION * limit)
            {
                saturated[j] += 1;
            }
        }
        let numbers = q_after.iter().chain(v_after.iter());
        if !numbers
            .copied()
            .chain(torque.row(n).iter().copied())
            .all(f64::is_finite)
        {
            return Err(Error::new(
                ErrorKind::Infeasible,
                format!(
                    "the simulation leaves the finite numbers after {:.3} s",
                    (n + 1) as f64 * dt
                ),
            )
            .help("a wave beyond the robot's limits does this, as do a large time step and absurd masses")
            .at(format!("robot `{}`", robot.name())));
        }
        q = q_after;
        v.copy_from(&v_after);
        std::mem::swap(&mut before, &mut now);
        std::mem::swap(&mut now, &mut after);
    }
    if steps > 0 {
        let last = torque.row(steps - 1).into_owned();
        torque.row_mut(steps).copy_from(&last);
    }
    Ok(Rollout {
        joints: robot.joints().clone(),
        kinds: (0..joints).map(|j| robot.joint(j).kind).collect(),
        times: (0..=steps).map(|n| n as f64 * dt).collect(),
        reference,
        position,
        velocity: rates,
        torque,
        saturated,
    })
}

impl TrackOptions {
    fn steps(&self, wave: &Wave) -> Result<usize> {
        let refuse = |what: String, expected: &str| {
            Err(Error::new(ErrorKind::Setting, what).expected(expected.to_owned()))
        };
        if !(self.time_step > 0.0 && self.time_step <= 0.02) {
            return refuse(
                format!("time step of {} s", self.time_step),
                "more than 0, at most 0.02 s",
            );
        }
        let stiffest = 1.0 / (std::f64::consts::PI * LEAST_DAMPING_TIME);
        if !(self.bandwidth > 0.0 && self.bandwidth <= stiffest) {
            return refuse(
                format!("bandwidth of {} Hz", self.bandwidth),
                &format!(
                    "more than 0, at most {stiffest:.1} Hz: stiffer motors limit-cycle when they saturate"
                ),
            );
        }
        let duration = self.duration.unwrap_or(wave.period());
        let steps = duration / self.time_step;
        if !(duration > 0.0 && steps <= MOST_STEPS) {
            return refuse(
                format!("duration of {duration} s"),
                &format!("a positive time of at most {MOST_STEPS:e} steps"),
            );
        }
        Ok(steps.round().max(1.0) as usize)
    }

    /// Critically damped loops about the inertia that each joint moves in the posture of the wave.
    fn motors(
        &self,
        robot: &Robot,
        moving: &[(usize, &BodyJoint)],
        wave: &Wave,
        dynamics: &mut Dynamics,
    ) -> Vec<Motor> {
        let inertia = dynamics.mass_diagonal(robot, wave.offsets().as_slice());
        let w = std::f64::consts::TAU * self.bandwidth;
        moving
            .iter()
            .map(|(_, joint)| {
                let own = inertia[joint.index] / joint.multiplier.powi(2).max(f64::MIN_POSITIVE);
                Motor {
                    stiffness: own * w * w,
                    damping: 2.0 * own * w,
                    effort: joint.properties.effort.unwrap_or(f64::MAX),
                }
            })
            .collect()
    }
}

/// What damping and friction take at a rate.
fn resistance(joint: &BodyJoint, rate: f64) -> f64 {
    joint.properties.damping * rate + joint.properties.friction * signum(rate)
}

/// The sign, 0 at rest.
fn signum(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}

//! [`DirectionFit`]: the wave of a robot whose arm points as a person's does, as nearly as it can.

use nalgebra::{DMatrix, DVector, Matrix3xX, Vector3};
use num_complex::Complex;

use super::arm::{Pointing, RobotArm};
use super::least_squares::Problem;
use super::person::{Person, Segment};
use crate::error::{Error, ErrorKind, Reason, Result};
use crate::fourier::{Derivative, Interval, Wave};
use crate::robot::{Kinematics, Robot};

/// Instants of the fit for each of the highest harmonics at hand: directions have multiples of what angles have.
const INSTANTS: usize = 8;

/// Instants between two of the fit at which it is looked at afterwards.
const BETWEEN: usize = 4;

/// Postures to start from.
const STARTS: usize = 24;

/// So many of the postures that these lead to are fitted as waves.
const TRIED: usize = 4;

/// Postures nearer than this \[rad, m\] in every joint are one.
const SAME: f64 = 0.1;

/// Another posture must cost less than this share of the one before to be preferred: what is alike goes to the nearer to rest.
const BETTER: f64 = 0.99;

/// How much of a radian of error a radian from rest counts as while a posture is sought: of equals the nearer to rest is found.
const PULL: f64 = 0.01;

/// How much more a radian beyond a limit counts than one of error; the last leaves so little that it may be cut off.
const STIFFNESS: [f64; 3] = [10.0, 100.0, 1000.0];

/// Steps downhill, of a posture, of a wave to see which is best, and of that one for each stiffness.
const STEPS: [usize; 3] = [60, 15, 100];

/// A joint that comes as near to a limit \[rad, m\] is at it.
const AT_LIMIT: f64 = 1e-3;

/// Rounding of limits, as a share of them: what a check forgives.
const ROUNDING: f64 = 1e-12;

/// The most harmonics of a wave that is fitted: beyond, the normal equations fill the memory.
const MOST_HARMONICS: usize = 60;

/// A robot's wave, fitted to where a person's arm points over the whole period.
#[derive(Debug, Clone, PartialEq)]
pub struct DirectionFit {
    /// Of the robot's joints, with the person's period. Joints that move nothing that points are at rest.
    pub wave: Wave,
    /// What is left of each direction, in the order of [`RobotArm::segments`].
    pub residuals: Vec<Residual>,
    /// Joints that come to a limit of theirs, and so may be why.
    pub at_limit: Vec<String>,
}

/// The angle between where a robot's arm points and where the person's does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    /// Of what.
    pub segment: Segment,
    /// Root mean square over the period \[rad\].
    pub rms: f64,
    /// The largest \[rad\].
    pub peak: f64,
    /// When that is \[s\].
    pub peak_time: f64,
}

impl RobotArm {
    /// Least squares on the Fourier weights of the robot's joints, up to `harmonics`, between where its arm points and where the
    /// person's does, over the whole period and within the limits of positions. Postures are sought from several starts; the same
    /// input gives the same wave.
    ///
    /// What a robot cannot do is in the residuals; a fit is never refused for being bad.
    ///
    /// # Errors
    /// When the robot lacks a link that is named, nothing that points can be moved, or the harmonics are not 1 to 60.
    pub fn fit(&self, person: &Person, robot: &Robot, harmonics: usize) -> Result<DirectionFit> {
        let pointers = self.on(robot)?;
        let wave = person.wave();
        let targets = |t: f64| {
            let directions = person.directions(t);
            let of = |p: &Pointing<'_>| self.to_base() * directions[p.segment as usize];
            pointers.iter().map(of).collect()
        };
        let finest = harmonics.max(wave.harmonics());
        Fit::new(robot, &pointers, wave.period(), harmonics, finest, &targets)?.run()
    }
}

/// Where each pointer is to point at a time.
type Targets<'a> = dyn Fn(f64) -> Vec<Vector3<f64>> + 'a;

struct Fit<'a> {
    robot: &'a Robot,
    pointers: &'a [Pointing<'a>],
    period: f64,
    harmonics: usize,
    instants: usize,
    targets: &'a Targets<'a>,
    rest: Vec<f64>,
    limits: Vec<Option<Interval>>,
    active: Vec<usize>,
}

impl<'a> Fit<'a> {
    /// Of `harmonics` to targets that have up to `finest`.
    fn new(
        robot: &'a Robot,
        pointers: &'a [Pointing<'a>],
        period: f64,
        harmonics: usize,
        finest: usize,
        targets: &'a Targets<'a>,
    ) -> Result<Self> {
        if !(1..=MOST_HARMONICS).contains(&harmonics) {
            return Err(
                Error::new(ErrorKind::Setting, format!("{harmonics} harmonics"))
                    .expected(format!("from 1 to {MOST_HARMONICS}")),
            );
        }
        let rest = robot.rest();
        let mut fit = Self {
            robot,
            pointers,
            period,
            harmonics,
            instants: INSTANTS * (finest + 1),
            targets,
            limits: limits(robot),
            active: (0..rest.len()).collect(),
            rest,
        };
        fit.active = fit.moving();
        if fit.active.is_empty() {
            return Err(
                Error::new(ErrorKind::Infeasible, "no joint moves what is to point")
                    .because(Reason::MissingJoint)
                    .expected("links that joints move")
                    .at(format!("robot `{}`", robot.name())),
            );
        }
        Ok(fit)
    }

    /// Joints that move a pointer at any of the starts.
    fn moving(&self) -> Vec<usize> {
        let mut kinematics = Kinematics::new(self.robot);
        let mut rates = Matrix3xX::zeros(self.rest.len());
        let mut moves = vec![false; self.rest.len()];
        for n in 0..STARTS {
            let q = self.start(n);
            for pointer in self.pointers {
                pointer.linearised(self.robot, &mut kinematics, &q, &mut rates);
                for (moves, rate) in moves.iter_mut().zip(rates.column_iter()) {
                    *moves |= rate.norm() > f64::EPSILON;
                }
            }
        }
        (0..moves.len()).filter(|j| moves[*j]).collect()
    }

    fn run(&self) -> Result<DirectionFit> {
        let mut best: Option<(f64, DMatrix<f64>)> = None;
        for posture in self.postures() {
            let (weights, cost) = self
                .problem(self.harmonics, STIFFNESS[0], 0.0)
                .descend(posture, STEPS[1]);
            if best.as_ref().is_none_or(|(least, _)| cost < BETTER * least) {
                best = Some((cost, weights));
            }
        }
        let (_, mut parameters) = best.expect("there is a start, so there is a posture");
        for stiffness in STIFFNESS {
            let problem = self.problem(self.harmonics, stiffness, 0.0);
            (parameters, _) = problem.descend(parameters, STEPS[2]);
        }
        let wave = self.within_limits(&self.wave(&parameters)?)?;
        let at_limit = self.robot.joints().iter().enumerate().filter(|(j, _)| {
            let range = wave.range(*j, Derivative::Position);
            let near =
                |l: Interval| range.lower - l.lower < AT_LIMIT || l.upper - range.upper < AT_LIMIT;
            self.active.contains(j) && self.limits[*j].is_some_and(near)
        });
        Ok(DirectionFit {
            at_limit: at_limit.map(|(_, joint)| joint.clone()).collect(),
            residuals: self.residuals(&wave),
            wave,
        })
    }

    fn problem(&self, harmonics: usize, stiffness: f64, pull: f64) -> Problem<'_> {
        let share = |n: usize| n as f64 / self.instants as f64;
        Problem {
            robot: self.robot,
            pointers: self.pointers,
            active: &self.active,
            limits: &self.limits,
            rest: &self.rest,
            // 1, then a cosine and a sine of each harmonic.
            basis: DMatrix::from_fn(self.instants, 1 + 2 * harmonics, |n, f| {
                let k = f.div_ceil(2);
                let turns = share(n * k % self.instants);
                let (sin, cos) = libm::sincos(std::f64::consts::TAU * turns);
                if f % 2 == 0 && f > 0 { sin } else { cos }
            }),
            targets: (0..self.instants)
                .map(|n| (self.targets)(self.period * share(n)))
                .collect(),
            stiffness,
            pull,
        }
    }

    /// Parameters of waves that stand still, the best first, no two alike.
    fn postures(&self) -> Vec<DMatrix<f64>> {
        let problem = self.problem(0, STIFFNESS[0], PULL);
        let mut found: Vec<(DMatrix<f64>, f64)> = (0..STARTS)
            .map(|n| {
                let q = self.start(n);
                let start = DMatrix::from_fn(1, self.active.len(), |_, a| q[self.active[a]]);
                problem.descend(start, STEPS[0])
            })
            .collect();
        found.sort_by(|a, b| a.1.total_cmp(&b.1));
        let mut kept: Vec<DMatrix<f64>> = Vec::new();
        for (posture, _) in found {
            if kept.len() < TRIED && kept.iter().all(|k| (k - &posture).amax() > SAME) {
                kept.push(posture);
            }
        }
        kept.iter()
            .map(|posture| {
                let mut parameters = DMatrix::zeros(1 + 2 * self.harmonics, self.active.len());
                parameters.row_mut(0).copy_from(posture);
                parameters
            })
            .collect()
    }

    /// Posture `number` to start from: rest, then points that fill the limits, and half a turn where there are none, evenly (the
    /// additive recurrence by powers of the root of g^(d+1) = g + 1).
    fn start(&self, number: usize) -> Vec<f64> {
        let mut q = self.rest.clone();
        if number == 0 {
            return q;
        }
        let d = self.active.len();
        let mut root: f64 = 1.5;
        for _ in 0..60 {
            root = libm::pow(1.0 + root, 1.0 / (d as f64 + 1.0));
        }
        let mut step = 1.0;
        for joint in &self.active {
            step /= root;
            let share = 0.5 + number as f64 * step;
            let share = share - libm::floor(share);
            let turn = Interval::within(std::f64::consts::PI);
            let room = self.limits[*joint].map_or(turn, |l| Interval {
                lower: l.lower.max(turn.lower).min(l.upper),
                upper: l.upper.min(turn.upper).max(l.lower),
            });
            q[*joint] = room.lower + share * room.width();
        }
        q
    }

    fn wave(&self, parameters: &DMatrix<f64>) -> Result<Wave> {
        let mut offsets = DVector::from_column_slice(&self.rest);
        let mut weights = DMatrix::zeros(self.rest.len(), self.harmonics);
        for (a, joint) in self.active.iter().enumerate() {
            offsets[*joint] = parameters[(0, a)];
            for k in 0..self.harmonics {
                let (cos, sin) = (parameters[(1 + 2 * k, a)], parameters[(2 + 2 * k, a)]);
                weights[(*joint, k)] = Complex::new(cos / 2.0, -sin / 2.0);
            }
        }
        Wave::new(self.robot.joints().clone(), self.period, offsets, weights)
    }

    /// The wave with each joint shifted, and where it is wider than its limits made smaller, until its exact range keeps them: what
    /// the stiffness has left.
    fn within_limits(&self, wave: &Wave) -> Result<Wave> {
        let mut wave = wave.clone();
        for (joint, limit) in self.limits.iter().enumerate() {
            let Some(limit) = limit else { continue };
            let over = |range: Interval| {
                (limit.lower - range.lower).max(range.upper - limit.upper)
                    > ROUNDING * limit.magnitude()
            };
            for _ in 0..8 {
                let range = wave.range(joint, Derivative::Position);
                if !over(range) {
                    break;
                }
                let room = limit.width() * (1.0 - 1e-9);
                let (mut offsets, mut weights) = (wave.offsets().clone(), wave.weights().clone());
                let scale = if range.width() > room {
                    room / range.width()
                } else {
                    1.0
                };
                weights.row_mut(joint).apply(|w| *w *= scale);
                let offset = offsets[joint];
                let (low, high) = (
                    scale * (range.lower - offset),
                    scale * (range.upper - offset),
                );
                let lowest = limit.lower - low;
                offsets[joint] = offset.min(limit.upper - high).max(lowest);
                wave = Wave::new(wave.joints().clone(), wave.period(), offsets, weights)?;
            }
            if over(wave.range(joint, Derivative::Position)) {
                return Err(
                    Error::new(ErrorKind::Infeasible, "the fit does not keep its limits")
                        .because(Reason::PositionLimit)
                        .at(format!("joint `{}`", wave.joints().name(joint))),
                );
            }
        }
        Ok(wave)
    }

    fn residuals(&self, wave: &Wave) -> Vec<Residual> {
        let mut kinematics = Kinematics::new(self.robot);
        let instants = BETWEEN * self.instants;
        let mut residuals: Vec<Residual> = self
            .pointers
            .iter()
            .map(|p| Residual {
                segment: p.segment,
                rms: 0.0,
                peak: 0.0,
                peak_time: 0.0,
            })
            .collect();
        for n in 0..instants {
            let t = self.period * n as f64 / instants as f64;
            let q = wave.position(t);
            let targets = (self.targets)(t);
            for ((residual, pointer), target) in
                residuals.iter_mut().zip(self.pointers).zip(&targets)
            {
                let direction = pointer.direction(self.robot, &mut kinematics, q.as_slice());
                // Of two unit vectors, without the loss of an arc cosine near 0.
                let angle = 2.0 * libm::asin(((direction - target).norm() / 2.0).min(1.0));
                residual.rms += angle * angle;
                if angle > residual.peak {
                    (residual.peak, residual.peak_time) = (angle, t);
                }
            }
        }
        for residual in &mut residuals {
            residual.rms = libm::sqrt(residual.rms / instants as f64);
        }
        residuals
    }
}

/// The positions of each joint that its own limits and those of joints that mimic it allow.
fn limits(robot: &Robot) -> Vec<Option<Interval>> {
    let mut limits = vec![None; robot.joints().len()];
    for (_, joint) in robot.moving() {
        let Some(own) = joint.properties.position else {
            continue;
        };
        if joint.multiplier == 0.0 {
            continue;
        }
        let ends = [own.lower, own.upper].map(|x| (x - joint.offset) / joint.multiplier);
        let allowed = Interval {
            lower: ends[0].min(ends[1]),
            upper: ends[0].max(ends[1]),
        };
        let limit: &mut Option<Interval> = &mut limits[joint.index];
        *limit = Some(limit.map_or(allowed, |l: Interval| l.intersect(allowed)));
    }
    limits
}

#[cfg(test)]
mod tests;

//! Samplers with a fault, for tests that must catch it.

use rand::Rng;
use undulate::posterior::{Effort, Transition};
use undulate::{Result, rand};

use crate::Target;

/// What is wrong with a [`Broken`] sampler.
#[derive(Clone, Copy, PartialEq)]
pub enum Fault {
    /// Elliptical: the other axis of the ellipse is a tenth too long.
    Axis,
    /// Elliptical: a rejected angle is halved, instead of becoming an end of the bracket.
    Halving,
    /// Elliptical: the threshold lies at the likelihood, not under it.
    Threshold,
    /// Hamiltonian: the momentum is a tenth too large.
    Momentum,
    /// Hamiltonian: every trajectory is accepted, at two thirds of the largest stable step.
    NoMetropolis(f64),
}

/// Both samplers in a few lines, with a fault.
pub struct Broken {
    fault: Fault,
    target: Target,
    z: Vec<f64>,
    gradient: Vec<f64>,
    value: f64,
}

pub fn broken(n: usize, target: Target, fault: Fault) -> Broken {
    Broken {
        fault,
        target,
        z: vec![0.0; n],
        gradient: vec![0.0; n],
        value: 0.0,
    }
}

pub fn uniform<R: Rng + ?Sized>(rng: &mut R) -> f64 {
    rand::RngExt::random(rng)
}

pub fn normals<R: Rng + ?Sized>(rng: &mut R, n: usize) -> Vec<f64> {
    let draw = |_| rand::distr::Distribution::sample(&rand_distr::StandardNormal, rng);
    (0..n).map(draw).collect()
}

fn turned(a: &[f64], b: &[f64], angle: f64) -> Vec<f64> {
    let (sin, cos) = angle.sin_cos();
    a.iter().zip(b).map(|(a, b)| a * cos + b * sin).collect()
}

impl Broken {
    fn ellipse<R: Rng + ?Sized>(&mut self, rng: &mut R) {
        let scale = if self.fault == Fault::Axis { 1.1 } else { 1.0 };
        let other: Vec<f64> = normals(rng, self.z.len())
            .iter()
            .map(|x| scale * x)
            .collect();
        let under = if self.fault == Fault::Threshold {
            1.0
        } else {
            uniform(rng)
        };
        let threshold = self.value + under.ln();
        let mut angle = std::f64::consts::TAU * uniform(rng);
        let mut bracket = (angle - std::f64::consts::TAU, angle);
        loop {
            let tried = turned(&self.z, &other, angle);
            self.value = (self.target)(&tried, &mut self.gradient);
            if self.value >= threshold {
                self.z = tried;
                return;
            }
            if self.fault == Fault::Halving {
                angle /= 2.0;
                continue;
            }
            if angle < 0.0 {
                bracket.0 = angle;
            } else {
                bracket.1 = angle;
            }
            angle = bracket.0 + (bracket.1 - bracket.0) * uniform(rng);
        }
    }

    fn trajectory<R: Rng + ?Sized>(&mut self, rng: &mut R, step: f64, scale: f64) {
        let mut momentum: Vec<f64> = normals(rng, self.z.len())
            .iter()
            .map(|x| scale * x)
            .collect();
        let count = 1 + (uniform(rng) * 2.0 / step) as usize;
        for _ in 0..count {
            for half in 0..2 {
                self.value = (self.target)(&self.z, &mut self.gradient);
                for (p, g) in momentum.iter_mut().zip(&self.gradient) {
                    *p += step / 2.0 * g;
                }
                if half == 0 {
                    let z = turned(&self.z, &momentum, step);
                    let back: Vec<f64> = self.z.iter().map(|z| -z).collect();
                    momentum = turned(&momentum, &back, step);
                    self.z = z;
                }
            }
        }
    }
}

impl Transition for Broken {
    fn dimension(&self) -> usize {
        self.z.len()
    }
    fn start(&mut self, z: &[f64]) -> Result<bool> {
        self.z.copy_from_slice(z);
        self.value = (self.target)(z, &mut self.gradient);
        Ok(true)
    }
    fn step<R: Rng + ?Sized>(&mut self, rng: &mut R) -> Result<()> {
        match self.fault {
            Fault::Momentum => self.trajectory(rng, 0.1, 1.1),
            Fault::NoMetropolis(step) => self.trajectory(rng, step, 1.0),
            _ => self.ellipse(rng),
        }
        Ok(())
    }
    fn adapt(&mut self, _done: usize, _total: usize) {}
    fn position(&self) -> &[f64] {
        &self.z
    }
    fn log_likelihood(&self) -> f64 {
        self.value
    }
    fn effort(&self) -> Effort {
        Effort::default()
    }
}

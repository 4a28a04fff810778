//! [`Hamiltonian`]: Hamiltonian Monte Carlo that follows the prior exactly.

use rand::Rng;

use super::options::HamiltonianOptions;
use super::reference::Reference;
use super::step_size::DualAveraging;
use super::{Effort, Transition, checked, uniform};
use crate::error::{Error, ErrorKind, Result};
use crate::normal;
use crate::vectors::{add_scaled, dot};

/// First step [rad]; dual averaging soon knows better.
const FIRST_STEP: f64 = 0.1;

/// An energy that is off by this much is lost (Stan's threshold).
const DIVERGENT: f64 = 1000.0;

/// |z| beyond sqrt(n) + this counts as impossible: the prior has less than e^-5000 there, and where trajectories diverge to
/// likelihoods tend to overflow.
const REACH: f64 = 100.0;

/// How much smaller steps are after a rejection.
const FINER: f64 = 4.0;

/// Shares of the warm-up after which the reference is learned anew, from the draws since the one before; up to the
/// first the chain travels from its start. What is left belongs to the step size.
const LEARNED_AFTER: [f64; 4] = [0.1, 0.2, 0.4, 0.85];

/// A place: x of the reference, its z, L there and the gradient over z.
#[derive(Debug, Clone)]
struct Place {
    x: Vec<f64>,
    z: Vec<f64>,
    value: f64,
    gradient: Vec<f64>,
}

/// Where a leapfrog led.
enum Region {
    Possible,
    /// Likelihood zero.
    Impossible,
    OutOfReach,
}

/// How a trajectory ended.
struct Outcome {
    /// Energy at its end less energy at its start; infinite, when it led to where the target has no density.
    gain: f64,
    /// The same as far as it was possible: whether the step is small enough does not show where the likelihood ends, and
    /// no step is so small that trajectories never end there. Infinite after not even one leapfrog.
    followed: f64,
    /// Whether it diverged.
    lost: bool,
}

impl Outcome {
    const LOST: Self = Self {
        gain: f64::INFINITY,
        followed: f64::INFINITY,
        lost: true,
    };
}

/// What warm-up collects.
#[derive(Debug, Clone, Default)]
struct Window {
    draws: Vec<Vec<f64>>,
    gradients: Vec<Vec<f64>>,
}

/// Hamiltonian Monte Carlo whose leapfrogs rotate instead of drift.
///
/// With momentum p ~ N(0, I) the energy H = |p|^2/2 + |x|^2/2 - L splits into a harmonic oscillator, which is followed
/// exactly, and the likelihood, which kicks:
///
/// ```text
/// p += (h/2) dL/dx;   (x, p) := (x cos h + p sin h, p cos h - x sin h);   p += (h/2) dL/dx
/// ```
///
/// so a flat likelihood takes steps of any size in any dimension (Beskos, Pinski, Sanz-Serna and Stuart, "Hybrid Monte Carlo on
/// Hilbert spaces", Stochastic Processes and their Applications 121, 2011; Shahbaba, Lan, Johnson and Neal, "Split
/// Hamiltonian Monte Carlo", Statistics and Computing 24, 2014). What limits the step is how much narrower than the prior the
/// likelihood is; so in warm-up the prior is replaced, as the Gaussian that is followed exactly, by one that is as narrow
/// as the posterior in the few directions that the observations hold (the target stays what it is; see `reference.rs`).
/// The step size is found by dual averaging (Hoffman and Gelman 2014), the length of trajectories varies.
///
/// No one step size suits where large amplitudes make an observation steep: chains would stick there. So a rejected trajectory is followed by one
/// of the same momentum in finer steps, accepted with the probability that leaves the target as it is (Modi, Barnett and Carpenter,
/// "Delayed rejection Hamiltonian Monte Carlo for sampling multiscale distributions", Bayesian Analysis 19, 2024):
///
/// ```text
/// min(1, e^(H - H'') (1 - a(x'', -p'')) / (1 - a(x, p))),   a = min(1, e^(H - H')) for the first trajectory from a place
/// ```
#[derive(Debug, Clone)]
pub struct Hamiltonian<F> {
    log_likelihood: F,
    options: HamiltonianOptions,
    reference: Reference,
    step: f64,
    adaptation: DualAveraging,
    window: Window,
    at: Place,
    tried: Place,
    momentum: Vec<f64>,
    /// The momentum of a transition, and where its second trajectory led.
    first_momentum: Vec<f64>,
    second: Place,
    slope: Vec<f64>,
    /// Of the last trajectory, as far as it was possible.
    followed: f64,
    effort: Effort,
}

impl<F: FnMut(&[f64], &mut [f64]) -> f64> Hamiltonian<F> {
    /// For `log_likelihood` L of z in R^n, n = `dimension`, which writes its gradient into its second argument (n). Minus
    /// infinity says that z is impossible; the gradient is not read then.
    pub fn new(dimension: usize, log_likelihood: F) -> Self {
        let options = HamiltonianOptions::default();
        let place = Place {
            x: vec![0.0; dimension],
            z: vec![0.0; dimension],
            value: f64::NEG_INFINITY,
            gradient: vec![0.0; dimension],
        };
        Self {
            log_likelihood,
            reference: Reference::prior(dimension),
            step: FIRST_STEP,
            adaptation: adaptation(&options, FIRST_STEP),
            options,
            window: Window::default(),
            at: place.clone(),
            tried: place.clone(),
            momentum: vec![0.0; dimension],
            first_momentum: vec![0.0; dimension],
            second: place,
            slope: vec![0.0; dimension],
            followed: f64::INFINITY,
            effort: Effort::default(),
        }
    }

    /// The same with other trajectories.
    ///
    /// # Errors
    /// When an option is out of its range.
    pub fn with_options(self, options: HamiltonianOptions) -> Result<Self> {
        options.check()?;
        Ok(Self {
            adaptation: adaptation(&options, FIRST_STEP),
            options,
            ..self
        })
    }

    /// Step size \[rad\]; after warm-up, the one that was found.
    pub fn step_size(&self) -> f64 {
        self.step
    }

    /// Evaluates L and its gradient where `tried.z` is.
    fn evaluate(&mut self) -> Result<Region> {
        let Place {
            z, gradient, value, ..
        } = &mut self.tried;
        let reach = (z.len() as f64).sqrt() + REACH;
        let square = dot(z, z);
        if square.is_nan() || square > reach * reach {
            return Ok(Region::OutOfReach);
        }
        self.effort.evaluations += 1;
        *value = checked((self.log_likelihood)(z, gradient))?;
        if *value == f64::NEG_INFINITY {
            return Ok(Region::Impossible);
        }
        if let Some(i) = gradient.iter().position(|g| !g.is_finite()) {
            return Err(Error::new(
                ErrorKind::Value,
                format!(
                    "gradient of the log-likelihood is {} in dimension {i}",
                    gradient[i]
                ),
            )
            .expected(format!(
                "a finite number, since the log-likelihood is {value}"
            )));
        }
        Ok(Region::Possible)
    }

    /// dL'/dx, where L' = L - |z|^2/2 + |x|^2/2 is the likelihood relative to the reference.
    fn find_slope(&mut self) {
        let Place { x, z, gradient, .. } = &self.tried;
        self.slope.copy_from_slice(gradient);
        add_scaled(&mut self.slope, -1.0, z);
        self.reference.pull_back(&mut self.slope);
        add_scaled(&mut self.slope, 1.0, x);
    }

    fn kick(&mut self, time: f64) {
        add_scaled(&mut self.momentum, time, &self.slope);
    }

    fn rotate(&mut self, angle: f64) {
        let (sin, cos) = libm::sincos(angle);
        for (x, p) in self.tried.x.iter_mut().zip(&mut self.momentum) {
            (*x, *p) = (*x * cos + *p * sin, *p * cos - *x * sin);
        }
        self.reference.latent(&self.tried.x, &mut self.tried.z);
    }

    /// H at the place that is tried, up to a constant: |x|^2/2 - L' = |z|^2/2 - L.
    fn energy(&self) -> f64 {
        let Place { z, value, .. } = &self.tried;
        0.5 * (dot(&self.momentum, &self.momentum) + dot(z, z)) - value
    }

    fn trajectory(&mut self, step: f64, count: usize) -> Result<Outcome> {
        let before = self.energy();
        let mut followed = f64::INFINITY;
        self.find_slope();
        for _ in 0..count {
            self.kick(step / 2.0);
            self.rotate(step);
            match self.evaluate()? {
                Region::Possible => {}
                Region::Impossible => {
                    return Ok(Outcome {
                        gain: f64::INFINITY,
                        followed,
                        lost: false,
                    });
                }
                Region::OutOfReach => return Ok(Outcome::LOST),
            }
            self.find_slope();
            self.kick(step / 2.0);
            followed = self.energy() - before;
            // Infinite energies: nothing that comes after would be a number.
            if followed.is_nan() {
                return Ok(Outcome::LOST);
            }
        }
        Ok(Outcome {
            gain: followed,
            followed,
            lost: followed > DIVERGENT,
        })
    }

    /// After a trajectory that was rejected, one in finer steps; whether it is accepted.
    fn delayed<R: Rng + ?Sized>(
        &mut self,
        rng: &mut R,
        (step, count): (f64, usize),
        rejected: &Outcome,
    ) -> Result<bool> {
        let threshold = libm::log(uniform(rng));
        self.tried.copy_from(&self.at);
        self.momentum.copy_from_slice(&self.first_momentum);
        let outcome = self.trajectory(step / FINER, count)?;
        let most = -outcome.gain - libm::log(-libm::expm1(-rejected.gain));
        if outcome.gain == f64::INFINITY || threshold > most {
            return Ok(false);
        }
        // The way back is as likely if from there, too, the first trajectory is rejected.
        self.momentum.iter_mut().for_each(|p| *p = -*p);
        self.second.copy_from(&self.tried);
        let back = self.trajectory(step, count)?;
        std::mem::swap(&mut self.second, &mut self.tried);
        Ok(threshold <= most + libm::log(1.0 - acceptance(back.gain)))
    }

    fn learn_reference(&mut self) {
        let Window { draws, gradients } = std::mem::take(&mut self.window);
        self.reference = Reference::learn(&draws, &gradients, self.options.directions);
        self.reference.whitened(&self.at.z, &mut self.at.x);
        self.adaptation = adaptation(&self.options, self.adaptation.averaged());
        self.step = self.adaptation.step();
    }
}

fn adaptation(options: &HamiltonianOptions, step: f64) -> DualAveraging {
    DualAveraging::new(
        options.acceptance,
        step,
        options.angle * (1.0 + options.jitter),
    )
}

/// min(1, e^-gain), Metropolis' probability.
fn acceptance(gain: f64) -> f64 {
    libm::exp(-gain.max(0.0))
}

impl Place {
    fn copy_from(&mut self, other: &Self) {
        self.x.copy_from_slice(&other.x);
        self.z.copy_from_slice(&other.z);
        self.value = other.value;
        self.gradient.copy_from_slice(&other.gradient);
    }
}

impl<F: FnMut(&[f64], &mut [f64]) -> f64> Transition for Hamiltonian<F> {
    fn dimension(&self) -> usize {
        self.at.z.len()
    }

    fn start(&mut self, z: &[f64]) -> Result<bool> {
        self.reference = Reference::prior(z.len());
        self.adaptation = adaptation(&self.options, FIRST_STEP);
        self.step = self.adaptation.step();
        self.window = Window::default();
        self.effort = Effort::default();
        self.tried.z.copy_from_slice(z);
        self.tried.x.copy_from_slice(z);
        let possible = matches!(self.evaluate()?, Region::Possible);
        std::mem::swap(&mut self.at, &mut self.tried);
        Ok(possible)
    }

    fn step<R: Rng + ?Sized>(&mut self, rng: &mut R) -> Result<()> {
        normal::fill(rng, &mut self.momentum);
        // Length and number of steps do not depend on the state, so that the way back is as likely as the way there.
        let spread = self.options.jitter * (2.0 * uniform(rng) - 1.0);
        let angle = self.options.angle * (1.0 + spread);
        let needed = (angle / self.step).ceil();
        let (step, count) = if needed <= self.options.most_steps as f64 {
            let count = needed.max(1.0);
            (angle / count, count as usize)
        } else {
            (self.step, self.options.most_steps)
        };
        let threshold = libm::log(uniform(rng));
        self.first_momentum.copy_from_slice(&self.momentum);
        self.tried.copy_from(&self.at);
        let outcome = self.trajectory(step, count)?;
        self.followed = outcome.followed;
        self.effort.transitions += 1;
        self.effort.acceptance_sum += acceptance(outcome.gain);
        self.effort.divergent += u64::from(outcome.lost);
        if threshold <= -outcome.gain || self.delayed(rng, (step, count), &outcome)? {
            std::mem::swap(&mut self.at, &mut self.tried);
        }
        Ok(())
    }

    fn adapt(&mut self, done: usize, total: usize) {
        self.adaptation.update(acceptance(self.followed));
        self.step = self.adaptation.step();
        let ends = LEARNED_AFTER.map(|share| (share * total as f64) as usize);
        if self.options.directions > 0 && (ends[0]..ends[3]).contains(&done) {
            self.window.draws.push(self.at.z.clone());
            self.window.gradients.push(self.at.gradient.clone());
            if ends[1..].contains(&(done + 1)) {
                self.learn_reference();
            }
        }
        if done + 1 == total {
            self.step = self.adaptation.averaged();
        }
    }

    fn position(&self) -> &[f64] {
        &self.at.z
    }

    fn log_likelihood(&self) -> f64 {
        self.at.value
    }

    fn effort(&self) -> Effort {
        self.effort
    }
}

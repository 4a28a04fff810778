//! Dual averaging of a step size.

/// gamma, t_0 and kappa of Hoffman and Gelman 2014, section 3.2.1.
const SHRINKAGE: f64 = 0.05;
const OFFSET: f64 = 10.0;
const FORGETTING: f64 = 0.75;

/// A step size that makes the mean acceptance probability what it should be (Hoffman and Gelman, "The No-U-Turn Sampler",
/// Journal of Machine Learning Research 15, 2014, equation (6)), on the logarithm of the step.
#[derive(Debug, Clone)]
pub(super) struct DualAveraging {
    acceptance: f64,
    /// mu: ten times the first step, since too large a step costs less than too small a one.
    towards: f64,
    largest: f64,
    count: f64,
    /// H: the mean shortfall of acceptance.
    shortfall: f64,
    logarithm: f64,
    averaged: f64,
}

impl DualAveraging {
    /// Towards a mean `acceptance`, from `step`, never above `largest`.
    pub fn new(acceptance: f64, step: f64, largest: f64) -> Self {
        Self {
            acceptance,
            towards: libm::log((10.0 * step).min(largest)),
            largest: libm::log(largest),
            count: 0.0,
            shortfall: 0.0,
            logarithm: libm::log(step.min(largest)),
            averaged: libm::log(step.min(largest)),
        }
    }

    /// Learns from the acceptance probability of a trajectory with [`step`](Self::step).
    pub fn update(&mut self, acceptance: f64) {
        self.count += 1.0;
        let t = self.count;
        let weight = 1.0 / (t + OFFSET);
        self.shortfall += weight * (self.acceptance - acceptance - self.shortfall);
        let unbounded = self.towards - self.shortfall * libm::sqrt(t) / SHRINKAGE;
        self.logarithm = unbounded.min(self.largest);
        let weight = libm::pow(t, -FORGETTING);
        self.averaged += weight * (self.logarithm - self.averaged);
    }

    /// The step to try next.
    pub fn step(&self) -> f64 {
        libm::exp(self.logarithm)
    }

    /// The step to stay with: late steps averaged.
    pub fn averaged(&self) -> f64 {
        libm::exp(self.averaged)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_known_curve_of_acceptance_is_met() {
        // Acceptance exp(-step): 0.8 at step -ln 0.8 = 0.223.
        let mut adaptation = DualAveraging::new(0.8, 5.0, 10.0);
        for _ in 0..2000 {
            adaptation.update(libm::exp(-adaptation.step()));
        }
        assert!((adaptation.averaged() + 0.8f64.ln()).abs() < 0.01);
        // And where all is accepted, the largest step.
        let mut adaptation = DualAveraging::new(0.8, 0.1, 1.5);
        for _ in 0..50 {
            adaptation.update(1.0);
        }
        assert!((adaptation.averaged() - 1.5).abs() < 0.01);
    }
}

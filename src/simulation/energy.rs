//! [`Energy`]: where the energy of a rollout came from and went.

/// Energies and works at each row of a rollout \[J\]; works count from its start.
///
/// What moves and what is lifted has been worked for: kinetic + potential = their start + motors + losses + pushes + stops, to the
/// order of the plant in its time step.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Energy {
    /// Of all bodies, payload included.
    pub kinetic: Vec<f64>,
    /// Under gravity; 0 for masses at the base's origin.
    pub potential: Vec<f64>,
    /// What the motors gave.
    pub motors: Vec<f64>,
    /// What damping and friction took: negative.
    pub losses: Vec<f64>,
    /// What pushes gave.
    pub pushes: Vec<f64>,
    /// What the stops of the joints took.
    pub stops: Vec<f64>,
}

/// Works since the start \[J\].
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Work {
    pub motors: f64,
    pub losses: f64,
    pub pushes: f64,
    pub stops: f64,
}

impl Energy {
    pub(super) fn with_capacity(rows: usize) -> Self {
        let series = || Vec::with_capacity(rows);
        Self {
            kinetic: series(),
            potential: series(),
            motors: series(),
            losses: series(),
            pushes: series(),
            stops: series(),
        }
    }

    pub(super) fn push(&mut self, [kinetic, potential]: [f64; 2], work: &Work) {
        self.kinetic.push(kinetic);
        self.potential.push(potential);
        self.motors.push(work.motors);
        self.losses.push(work.losses);
        self.pushes.push(work.pushes);
        self.stops.push(work.stops);
    }

    /// By how much, at each row, kinetic and potential energy exceed what they were and what was worked since.
    pub fn surplus(&self) -> impl Iterator<Item = f64> {
        let held = |n: usize| self.kinetic[n] + self.potential[n];
        (0..self.kinetic.len()).map(move |n| {
            let worked = self.motors[n] + self.losses[n] + self.pushes[n] + self.stops[n];
            held(n) - held(0) - worked
        })
    }

    /// The largest modulus of [`surplus`](Self::surplus): what the integration made up or lost \[J\].
    pub fn imbalance(&self) -> f64 {
        self.surplus().fold(0.0, |most, s| most.max(s.abs()))
    }
}

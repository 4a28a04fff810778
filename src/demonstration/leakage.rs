//! What the harmonics cannot tell of a demonstration.

use super::Recording;
use crate::fourier::{State, Wave};

/// How well one demonstration is described by its wave, over all joints.
#[derive(Debug, Clone, PartialEq)]
pub struct Leakage {
    /// The recording.
    pub name: String,
    /// Share of the energy about the mean that the harmonics 1..=K leave, 0 to 1.
    pub residual_energy: f64,
    /// The largest step from the end of the window back to its start \[rad\]: a period that is not a whole number of
    /// cycles, or drift.
    pub end_jump: f64,
    /// The joint with that step.
    pub end_jump_joint: String,
}

impl Recording {
    /// What `wave`, fitted to this recording, leaves of it.
    pub(super) fn leakage(&self, wave: &Wave) -> Leakage {
        let mut left = 0.0;
        let mut energy = 0.0;
        let mut state = State::zeros(self.joints.len());
        for (n, &t) in self.times.iter().enumerate() {
            wave.state_into(t, &mut state);
            for d in 0..self.joints.len() {
                let y = self.positions[(n, d)];
                left += (y - state.position[d]).powi(2);
                energy += (y - wave.offsets()[d]).powi(2);
            }
        }
        let last = self.times.len() - 1;
        let (joint, end_jump) = (0..self.joints.len())
            .map(|d| {
                (
                    d,
                    (self.positions[(last, d)] - self.positions[(0, d)]).abs(),
                )
            })
            .fold(
                (0, 0.0),
                |best, next| if next.1 > best.1 { next } else { best },
            );
        Leakage {
            name: self.name.clone(),
            residual_energy: left / energy,
            end_jump,
            end_jump_joint: self.joints.name(joint).to_owned(),
        }
    }
}

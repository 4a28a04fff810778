//! A wave as a motion.

use super::{Motion, Tube};
use crate::fourier::{Derivative, Extremes, Joints, State, Wave};

impl Motion for Wave {
    type Tube<'a> = WaveTube<'a>;

    fn joints(&self) -> &Joints {
        self.joints()
    }

    fn duration(&self) -> f64 {
        self.period()
    }

    fn is_periodic(&self) -> bool {
        true
    }

    fn state_into(&self, t: f64, state: &mut State) {
        self.state_into(t, state);
    }

    fn extremes(&self, joint: usize, derivative: Derivative) -> Extremes {
        self.extremes(joint, derivative)
    }

    fn tube(&self) -> WaveTube<'_> {
        WaveTube { wave: self }
    }
}

/// The positions of a wave over intervals, by Taylor's theorem with the harmonic sums as remainders.
#[derive(Debug)]
pub struct WaveTube<'a> {
    wave: &'a Wave,
}

impl Tube for WaveTube<'_> {
    fn over(&mut self, middle: f64, half: f64, position: &mut [f64], radius: &mut [f64]) {
        for joint in 0..self.wave.joints().len() {
            let enclosure = self
                .wave
                .enclosure(joint, Derivative::Position, middle, half);
            position[joint] = enclosure.lower / 2.0 + enclosure.upper / 2.0;
            radius[joint] =
                (enclosure.upper - position[joint]).max(position[joint] - enclosure.lower);
        }
    }
}

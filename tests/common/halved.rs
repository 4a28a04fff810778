//! A motion whose bounds are halved on purpose.

use undulate::{Derivative, Extremes, Joints, Motion, State, Tube, Wave, WaveTube};

/// A wave that says it goes half as far as it does.
pub struct Halved(pub Wave);

pub struct HalvedTube<'a>(WaveTube<'a>);

impl Motion for Halved {
    type Tube<'a> = HalvedTube<'a>;

    fn joints(&self) -> &Joints {
        self.0.joints()
    }

    fn duration(&self) -> f64 {
        self.0.period()
    }

    fn is_periodic(&self) -> bool {
        true
    }

    fn state_into(&self, t: f64, state: &mut State) {
        self.0.state_into(t, state);
    }

    fn extremes(&self, joint: usize, derivative: Derivative) -> Extremes {
        Motion::extremes(&self.0, joint, derivative)
    }

    fn tube(&self) -> HalvedTube<'_> {
        HalvedTube(self.0.tube())
    }
}

impl Tube for HalvedTube<'_> {
    fn pieces(&self, pieces: &mut Vec<(f64, f64)>) {
        self.0.pieces(pieces);
    }

    fn over(&mut self, middle: f64, half: f64, position: &mut [f64], radius: &mut [f64]) {
        self.0.over(middle, half, position, radius);
        radius.iter_mut().for_each(|r| *r /= 2.0);
    }
}

//! A bound that is halved on purpose is caught: the same fuzz, on motions that understate how far they go.

use undulate::{
    Certification, CollisionModel, CollisionOptions, Derivative, Extremes, Joints, Motion, State,
    Tube, Wave, WaveTube, stream,
};

use crate::dense::Dense;
use crate::robots::{THIN, carousel};
use crate::waves::random_wave;

/// A wave that says it goes half as far as it does.
struct Halved(Wave);

struct HalvedTube<'a>(WaveTube<'a>);

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

#[test]
fn a_bound_that_is_halved_is_caught() {
    let robot = carousel(THIN);
    let model = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
    let dense = Dense::new(&robot, &model);
    let mut prover = model.prover();
    let caught = (0..1000).find(|number| {
        let wave = random_wave(&robot, 26, 6.7, 2.0, &mut stream(5, *number));
        let Certification::Collides { witness, .. } = prover.certify(&wave, 0.0, &[]).unwrap()
        else {
            return false;
        };
        assert!(
            dense.at(
                &robot,
                wave.position(witness.time).as_slice(),
                f64::INFINITY
            ) < 1e-9
        );
        prover.certify(&Halved(wave), 0.0, &[]).unwrap().is_clear()
    });
    println!("caught by wave {caught:?}");
    assert!(caught.is_some());
}

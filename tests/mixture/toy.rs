//! Small demonstrations of two kinds.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use rand::RngExt;
use rand::distr::Distribution;
use rand_distr::StandardNormal;
use undulate::{
    ChartForm, Estimator, Example, Grouping, Joints, LearnOptions, Mixture, Wave, stream,
};

/// Of `counts` demonstrations of each kind: two joints, two harmonics; the second kind is `apart` standard deviations larger, and its second joint lags about
/// half a turn, so that its phases stand on both sides of the cut.
pub fn waves(counts: [usize; 2], apart: f64, seed: u64) -> Vec<Wave> {
    let mut rng = stream(seed, 0);
    let mut waves = Vec::new();
    for (kind, count) in counts.into_iter().enumerate() {
        let kind = kind as f64;
        for _ in 0..count {
            let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
            let common = normal();
            let size = |own: f64| (0.2 * (0.8 * common + 0.6 * own + apart * kind)).exp();
            let first = [0.2 * size(normal()), 0.05 * size(normal())];
            let second = [0.1 * size(normal()), 0.03 * size(normal())];
            let start = 0.3 * normal();
            let lag = 0.15 * apart * kind + 2.7 + 0.3 * normal();
            let weights = DMatrix::from_row_slice(
                2,
                2,
                &[
                    Complex::from_polar(first[0], start),
                    Complex::from_polar(first[1], start + 0.2 * normal()),
                    Complex::from_polar(second[0], start + lag),
                    Complex::from_polar(second[1], start + lag + 0.2 * normal()),
                ],
            );
            let offsets = DVector::from_vec(vec![
                0.3 * normal(),
                1.0 + 0.2 * normal() - 0.1 * apart * kind,
            ]);
            let joints = Joints::new(["shoulder", "elbow"]).unwrap();
            waves.push(Wave::new(joints, 2.0, offsets, weights).unwrap());
        }
    }
    waves
}

pub fn form(waves: &[Wave]) -> (Vec<Example>, ChartForm) {
    let options = LearnOptions::default();
    let examples = options.examples(waves).unwrap();
    let form = options.form(&examples).unwrap();
    (examples, form)
}

pub fn labelled(counts: [usize; 2], apart: f64, estimator: Estimator) -> Mixture {
    let (examples, form) = form(&waves(counts, apart, 3));
    let labels = ["small", "large"].iter().zip(counts);
    let labels: Vec<&str> = labels.flat_map(|(l, n)| vec![*l; n]).collect();
    let grouping = Grouping::labelled(&labels).unwrap();
    Mixture::learn(&examples, &form, estimator, &grouping).unwrap()
}

/// Responsibilities that are not sure of anything.
pub fn guess(count: usize, seed: u64) -> DMatrix<f64> {
    let mut rng = stream(seed, 1);
    let mut guess = DMatrix::zeros(count, 2);
    for mut row in guess.row_iter_mut() {
        let share = 0.3 + 0.4 * rng.random::<f64>();
        row[0] = share;
        row[1] = 1.0 - share;
    }
    guess
}

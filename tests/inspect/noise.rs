//! What has no rhythm is seldom taken for one.

use std::f64::consts::TAU;

use rand::distr::Distribution;
use rand_distr::StandardNormal;
use undulate::nalgebra::DMatrix;
use undulate::{Recording, RhythmicPart, stream};

use crate::{RATE, joints};

/// White noise, and the same through two low passes of 1 to 4 Hz; seed 12, 75 recordings of each. 36 are; without the bound on irregularity 236 were. Between seeds 36 scatters
/// by 6 (binomial), so the bound stands 1.6 of these above it, and this seed is fixed.
#[test]
fn noise_is_seldom_taken_for_a_rhythm() {
    let mut rng = stream(12, 0);
    let times: Vec<f64> = (0..600).map(|n| f64::from(n) / RATE).collect();
    let mut found = 0;
    for keeps in [0.0, 1.0, 2.0, 4.0].map(|cut: f64| (-TAU * cut / RATE).exp() % 1.0) {
        for _ in 0..75 {
            let mut passed = [[0.0; 2]; 3];
            let mut rows = Vec::new();
            for _ in &times {
                for [first, second] in &mut passed {
                    let white: f64 = StandardNormal.sample(&mut rng);
                    *first = keeps * *first + (1.0 - keeps) * white;
                    *second = keeps * *second + (1.0 - keeps) * *first;
                    rows.push(*second);
                }
            }
            let positions = DMatrix::from_row_slice(times.len(), 3, &rows);
            let noise = Recording::new("noise", joints(), times.clone(), positions).unwrap();
            found += usize::from(!noise.rhythmic_parts().is_empty());
        }
    }
    println!("taken for a rhythm: {found} of 300");
    assert!(found <= 45, "{found}");
}

/// Smooth motion without a period: random targets a second apart on average, gone to smoothly. Seed 9, 100 motions of 12 s.
#[test]
fn motion_without_a_period_is_seldom_taken_for_a_rhythm() {
    let mut rng = stream(9, 0);
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let mut found = 0.0;
    for _ in 0..100 {
        let mut knots = vec![(0.0, [0.0; 3])];
        while knots[knots.len() - 1].0 < 12.0 {
            let t = knots[knots.len() - 1].0 + (0.7 * normal()).exp();
            knots.push((t, [normal(), normal(), normal()]));
        }
        let times: Vec<f64> = (0..720).map(|n| f64::from(n) / RATE).collect();
        let positions = DMatrix::from_fn(times.len(), 3, |n, d| {
            let next = knots.partition_point(|k| k.0 <= times[n]);
            let ((a, from), (b, to)) = (knots[next - 1], knots[next]);
            let x = (times[n] - a) / (b - a);
            from[d] + (to[d] - from[d]) * x * x * (3.0 - 2.0 * x)
        });
        let recording = Recording::new("random", joints(), times, positions).unwrap();
        let parts = recording.rhythmic_parts();
        found += parts.iter().map(RhythmicPart::duration).sum::<f64>();
    }
    println!("taken for a rhythm: {:.1} % of the time", found / 12.0);
    assert!(found / 1200.0 < 0.1);
}

//! Distances tell models that are broken on purpose from the one that is true.

use nalgebra::DMatrix;
use rand::distr::Distribution;

use super::energy;
use super::yardstick::{Measured, Yardstick};
use super::{DISTANCES, Distance, Estimate};
use crate::demonstration::{CycleFits, Recording, synthetic};
use crate::fourier::{Joints, Wave};
use crate::primitive::{FourierMovementPrimitive, LearnOptions, stream};

/// Demonstrations that are drawn from the true model, and draws for each.
const LEFT_OUT: u64 = 24;
const DRAWS: u64 = 30;

fn positions(times: &[f64], wave: &Wave) -> DMatrix<f64> {
    DMatrix::from_fn(times.len(), wave.joints().len(), |n, d| {
        wave.position_of(d, times[n])
    })
}

/// Seed 9: the true model is one of cycles, its draws are the demonstrations, and all twins draw from it and then break what they draw. The
/// interval of the difference has one of a million beyond either end.
#[test]
fn wrong_tempos_shuffled_phases_beating_and_copies_lie_farther_off_than_the_truth() {
    let fits = CycleFits::new(synthetic(0).unwrap().recordings(), 4).unwrap();
    let truth = FourierMovementPrimitive::from_cycles(&fits, 12, &LearnOptions::default()).unwrap();
    let times: Vec<f64> = (0..240).map(|n| f64::from(n) / 50.0).collect();
    let joints: Joints = truth.chart().joints().clone();
    let shown: Vec<Recording> = (0..LEFT_OUT)
        .map(|m| {
            let y = positions(&times, &truth.sample(&mut stream(9, 1000 + m)));
            Recording::new(m.to_string(), joints.clone(), times.clone(), y).unwrap()
        })
        .collect();
    let drawn = |k: u64| truth.sample(&mut stream(9, 10_000 + k));
    let faster: Vec<f64> = times.iter().map(|t| 1.3 * t).collect();
    let as_drawn = |k: u64| positions(&times, &drawn(k));
    type Twin<'a> = &'a dyn Fn(u64) -> DMatrix<f64>;
    let too_fast: Twin = &|k| positions(&faster, &drawn(k));
    // Each joint from a time of its own on.
    let shuffled: Twin = &|k| {
        let wave = drawn(k);
        DMatrix::from_fn(times.len(), joints.len(), |n, d| {
            let late = 0.11 * ((k + 3) * (d as u64 + 1) % 7) as f64;
            wave.position_of(d, times[n] + late)
        })
    };
    // As where two tones a tenth of a hertz apart take turns.
    let beating: Twin = &|k| {
        let (mut y, mean) = (as_drawn(k), as_drawn(k).row_mean());
        for (mut row, t) in y.row_iter_mut().zip(&times) {
            let swell = 1.0 + 0.8 * (std::f64::consts::TAU * 0.4 * t).cos();
            row.copy_from(&((&row - &mean) * swell + &mean));
        }
        y
    };
    let copy: Twin = &|k| shown[(k % 2) as usize].positions().clone();
    let twins = [
        ("too fast", too_fast),
        ("shuffled", shuffled),
        ("beating", beating),
        ("copies", copy),
    ];
    let distances = |twin: Twin, m: usize| -> [f64; DISTANCES] {
        let mut rest = shown.clone();
        let left_out = rest.remove(m);
        let yardstick = Yardstick::new(&rest, &left_out, 4).unwrap();
        let motions: Vec<Measured> = (0..DRAWS)
            .map(|k| yardstick.measure(twin(m as u64 * DRAWS + k)).unwrap())
            .collect();
        let own = yardstick.measure(left_out.positions().clone()).unwrap();
        std::array::from_fn(|i| {
            let vectors: Vec<_> = motions.iter().map(|m| m.vectors[i].clone()).collect();
            energy::distance(&vectors, &own.vectors[i])
        })
    };
    // The first two are what is copied.
    let left_out = || 2..shown.len();
    let of = |twin: Twin| -> Vec<_> { left_out().map(|m| distances(twin, m)).collect() };
    let true_ones = of(&as_drawn);
    for (name, twin) in twins {
        let broken = of(twin);
        let differs = |d: Distance| {
            let pairs = broken.iter().zip(&true_ones);
            let differences: Vec<f64> = pairs.map(|(b, t)| b[d as usize] - t[d as usize]).collect();
            Estimate::of_mean(&differences, 0.999, 9)
        };
        let noticed: Vec<Distance> = Distance::ALL
            .into_iter()
            .filter(|d| differs(*d).lower > 0.0)
            .collect();
        let expected: &[Distance] = match name {
            "too fast" => &Distance::ALL,
            // Each joint alone moves as it should.
            "shuffled" => &[Distance::Motion],
            "beating" => &[Distance::Level, Distance::Course],
            _ => &[Distance::Motion],
        };
        for distance in expected {
            assert!(noticed.contains(distance), "{name}: {noticed:?}");
        }
        println!("{name}: {noticed:?}");
    }
}

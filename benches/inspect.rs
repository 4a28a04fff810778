//! What it costs to look at a recording of an hour: `cargo bench --bench inspect`. One core; the bound is 2 s.

use std::f64::consts::TAU;
use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use undulate::nalgebra::DMatrix;
use undulate::{ARM_ANGLES, Inspection, Joints, Recording};

const RATE: f64 = 120.0;
const HOUR: f64 = 3600.0;

/// Seven joints that wave for `on` seconds of every minute at a tempo that wanders, and stand still for the rest.
fn hour(names: [&str; 7], on: f64) -> Recording {
    let times: Vec<f64> = (0..(HOUR * RATE) as usize)
        .map(|n| n as f64 / RATE)
        .collect();
    let positions = DMatrix::from_fn(times.len(), 7, |n, d| {
        let t = times[n];
        let phase = TAU * 1.8 * t + 3.0 * (t / 40.0).sin();
        let wave = if t % 60.0 < on { phase.sin() } else { 0.0 };
        // No two frames repeat.
        0.1 * d as f64 + 0.04 * (d + 1) as f64 * wave + 1e-3 * (t * (7.0 + d as f64)).sin()
    });
    Recording::new("hour", Joints::new(names).unwrap(), times, positions).unwrap()
}

fn bench(c: &mut Criterion) {
    let robot = ["a", "b", "c", "d", "e", "f", "g"];
    let mut group = c.benchmark_group("an hour at 120 Hz");
    group
        .sample_size(10)
        .measurement_time(Duration::from_secs(20));
    for (name, recording) in [
        ("a person's arm, one wave", hour(ARM_ANGLES, 60.0)),
        ("a person's arm, sixty waves", hour(ARM_ANGLES, 20.0)),
        ("seven joints, one wave", hour(robot, 60.0)),
    ] {
        group.bench_function(name, |b| b.iter(|| Inspection::of(black_box(&recording))));
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);

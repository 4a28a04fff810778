//! How long a tick of a player takes: percentiles, beside an empty pair of clock readings and the wave itself, in the same run. Means of a criterion
//! bench would hide what a controller fears.

use std::hint::black_box;
use std::time::Instant;

use undulate::nalgebra::{DMatrix, DVector};
use undulate::num_complex::Complex;
use undulate::{CheckOptions, CollisionModel, CollisionOptions, Planner, State, Wave, shipped};

const TICKS: usize = 1_000_000;
/// As people wave.
const HARMONICS: usize = 26;
const PERIOD: f64 = 6.7;

fn wave(turn: f64) -> Wave {
    let robot = shipped::robot("wave_arm").unwrap();
    let mut weights = DMatrix::zeros(6, HARMONICS);
    for j in 0..6 {
        for k in 0..HARMONICS {
            let size = 0.05 / (k + 1) as f64;
            weights[(j, k)] = Complex::from_polar(size, turn * (j + 3 * k) as f64);
        }
    }
    let offsets = DVector::from_element(6, 0.5);
    Wave::new(robot.joints().clone(), PERIOD, offsets, weights).unwrap()
}

/// Nanoseconds of each call, in order of size.
fn timed(mut call: impl FnMut(usize)) -> Vec<u128> {
    let mut times: Vec<u128> = (0..TICKS)
        .map(|n| {
            let start = Instant::now();
            call(n);
            start.elapsed().as_nanos()
        })
        .collect();
    times.sort_unstable();
    times
}

fn tell(what: &str, times: &[u128]) {
    let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize];
    println!(
        "{what:<28} median {:>6} ns, 99 % {:>6}, 99.9 % {:>6}, 99.99 % {:>7}, longest {:>9}",
        at(0.5),
        at(0.99),
        at(0.999),
        at(0.9999),
        at(1.0)
    );
}

fn main() {
    // `cargo test --benches` and the like ask benches for nothing.
    if !std::env::args().any(|argument| argument == "--bench") {
        return;
    }
    let robot = shipped::robot("wave_arm").unwrap();
    let collision = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
    let options = CheckOptions::default();
    let mut planner = Planner::new(&robot, &collision, options, 1e-3).unwrap();
    let (one, other) = (wave(0.7), wave(1.1));
    let mut player = planner.start(&one, &robot.rest()).unwrap();
    let mut state = State::zeros(6);
    tell("two readings of the clock", &timed(|_| {}));
    tell(
        "a state of the wave",
        &timed(|n| one.state_into(black_box(1e-3 * n as f64), &mut state)),
    );
    tell("a tick", &timed(|_| player.tick(black_box(&mut state))));
    let start = Instant::now();
    let plan = planner.change(&player, &other, 0.0).unwrap();
    println!("a change is planned in {:?}", start.elapsed());
    player.take(plan).unwrap();
    tell(
        "a tick, into another wave",
        &timed(|_| player.tick(black_box(&mut state))),
    );
    println!("a stop takes {:.3} s at most", player.longest_stop());
}

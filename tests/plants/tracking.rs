//! Tracking at 1 kHz under effort limits, over the whole first period.

use undulate::nalgebra::{DMatrix, DVector};
use undulate::num_complex::Complex;
use undulate::{
    CheckOptions, CollisionModel, CollisionOptions, Joints, Means, Plant, Robot, Simulation,
    SimulationOptions, Spline, StartPosture, Wave, Waypoint, Waypoints, mend, stream,
};

use crate::waves::uniform;
use crate::{PLANTS, arms, told, with};

const SEEDS: u64 = 20;

/// A wave of two harmonics of `frequency`, the higher a tenth of the lower, about a posture a radian from the stops or more, where the
/// range is wide enough; each joint as fast at most as half to all of 1 rad/s: more saturates
/// the UR5's shoulder at 3 Hz.
fn wave(robot: &Robot, frequency: f64, seed: u64) -> Wave {
    let w = std::f64::consts::TAU * frequency;
    swinging(robot, frequency, 1.0 / w / 1.2, seed)
}

/// Waves that swing by up to 0.4 rad in every joint, and then by no more than limits of position, velocity and effort allow.
fn mended(robot: &Robot, frequency: f64) -> Vec<Wave> {
    let collision = CollisionModel::new(robot, &CollisionOptions::default()).unwrap();
    let mut prover = collision.prover();
    let means = [Means::Shift, Means::ShrinkOffending, Means::Shrink];
    let mended = (0..).map(|seed| {
        let wave = swinging(robot, frequency, 0.4, seed);
        mend(robot, &mut prover, &wave, &CheckOptions::default(), &means).unwrap()
    });
    // Postures that touch cannot be mended.
    let waves = mended.filter(|m| m.verdict.passes()).map(|m| m.wave);
    waves.take(SEEDS as usize).collect()
}

/// With first harmonics between half of `amplitude` \[rad\] and all of it.
fn swinging(robot: &Robot, frequency: f64, amplitude: f64, seed: u64) -> Wave {
    let mut rng = stream(seed, 0);
    let joints = robot.joints();
    let offsets = DVector::from_fn(joints.len(), |j, _| {
        let range = robot.properties(j).position.unwrap();
        let (middle, half) = (range.lower.midpoint(range.upper), range.upper - range.lower);
        let room = (half / 2.0 - 1.0).clamp(0.0, 1.5);
        middle + room * (2.0 * uniform(&mut rng) - 1.0)
    });
    let weights = DMatrix::from_fn(joints.len(), 2, |_, k| {
        let amplitude = amplitude * (0.5 + 0.5 * uniform(&mut rng));
        let modulus = if k == 0 {
            amplitude / 2.0
        } else {
            amplitude / 20.0
        };
        Complex::from_polar(modulus, std::f64::consts::TAU * uniform(&mut rng))
    });
    Wave::new(joints.clone(), 1.0 / frequency, offsets, weights).unwrap()
}

/// The worst RMS error of any joint over the seeds.
fn worst(robot: &Robot, frequency: f64, options: &SimulationOptions) -> f64 {
    let simulation = Simulation::new(robot, options.clone()).unwrap();
    let errors = (0..SEEDS).map(|seed| {
        let rollout = simulation.run(&wave(robot, frequency, seed)).unwrap();
        assert_eq!(rollout.saturated, [0; 6], "{} seed {seed}", robot.name());
        // The whole period, to the next whole step.
        let last = rollout.times[rollout.times.len() - 1];
        assert!((0.0..options.time_step).contains(&(last - 1.0 / frequency + 1e-9)));
        rollout.rms_error().max()
    });
    errors.fold(0.0, f64::max)
}

#[test]
fn both_plants_track_waves_of_both_arms() {
    for robot in arms() {
        for plant in PLANTS {
            for (frequency, exact, wrong) in [(1.5, 5e-5, 1e-3), (3.0, 3e-4, 3e-3)] {
                let options = with(plant);
                let error = worst(&robot, frequency, &options);
                let off = [-0.05, 0.05].map(|torque_error| {
                    let options = SimulationOptions {
                        torque_error,
                        ..options.clone()
                    };
                    worst(&robot, frequency, &options)
                });
                println!(
                    "{} {plant:?} {frequency} Hz: {error:.1e} rad, torque 5 % off {:.1e} {:.1e}",
                    robot.name(),
                    off[0],
                    off[1]
                );
                assert!(error < exact, "{error:e}");
                assert!(
                    off.iter().all(|e| *e < wrong && *e > 2.0 * error),
                    "{off:?}"
                );
            }
        }
    }
}

#[test]
fn both_plants_track_large_waves_that_were_mended() {
    for robot in arms() {
        for (frequency, exact, wrong) in [(1.5, 5e-5, 1e-3), (3.0, 3e-4, 3e-3)] {
            let waves = mended(&robot, frequency);
            for plant in PLANTS {
                for (torque_error, bar) in [(0.0, exact), (-0.05, wrong), (0.05, wrong)] {
                    let options = SimulationOptions {
                        torque_error,
                        ..with(plant)
                    };
                    let simulation = Simulation::new(&robot, options).unwrap();
                    let errors: Vec<f64> = waves
                        .iter()
                        .map(|wave| simulation.run(wave).unwrap().rms_error().max())
                        .collect();
                    let worst = errors.iter().copied().fold(0.0, f64::max);
                    println!(
                        "{} {plant:?} {frequency} Hz, torque off by {torque_error}: {worst:.1e} rad",
                        robot.name()
                    );
                    assert!(worst < bar, "{}", told(&errors));
                }
            }
        }
    }
}

#[test]
fn feed_forward_is_what_tracks() {
    for robot in arms() {
        for plant in PLANTS {
            let fed = worst(&robot, 1.5, &with(plant));
            let options = SimulationOptions {
                control: undulate::Control::Feedback,
                ..with(plant)
            };
            let alone = worst(&robot, 1.5, &options);
            println!(
                "{} {plant:?}: {fed:.1e} rad, feedback alone {alone:.1e}",
                robot.name()
            );
            assert!(alone > 50.0 * fed);
        }
    }
}

/// A move that ends: it starts and stops at rest, with quintic segments.
fn reach(robot: &Robot) -> Spline {
    let start: Vec<f64> = robot.rest();
    let goal: Vec<f64> = start.iter().map(|q| q + 0.5).collect();
    let zeros = vec![0.0; start.len()];
    let point = |time, positions| Waypoint {
        time,
        positions,
        velocities: Some(&zeros[..]),
        accelerations: Some(&zeros[..]),
    };
    let joints: Joints = robot.joints().clone();
    let waypoints = Waypoints::new(
        joints,
        [
            point(0.0, &start[..]),
            point(0.8, &goal[..]),
            point(1.0, &goal[..]),
        ],
    );
    Spline::new(&waypoints.unwrap(), StartPosture::Given).unwrap()
}

#[test]
fn a_move_that_ends_is_tracked_and_held() {
    for robot in arms() {
        for plant in PLANTS {
            let options = SimulationOptions {
                duration: Some(1.5),
                ..with(plant)
            };
            let simulation = Simulation::new(&robot, options).unwrap();
            let rollout = simulation.run(&reach(&robot)).unwrap();
            let (rms, peak) = (rollout.rms_error().max(), rollout.peak_error().max());
            let left = rollout.velocity.row(1500).amax();
            println!(
                "{} {plant:?}: {rms:.1e} rad, peak {peak:.1e}, {left:.1e} rad/s left",
                robot.name()
            );
            assert!(rms < 1e-4 && left < 1e-4, "{rms:e} {left:e}");
            // What it achieved is a motion again, and within its tolerance of what was asked.
            let achieved = rollout.achieved().unwrap();
            let tolerance = rollout.tolerance();
            let motion = reach(&robot);
            let (mut a, mut b) = (undulate::State::zeros(6), undulate::State::zeros(6));
            for n in 0..15_000 {
                let t = f64::from(n) * 1e-4;
                undulate::Motion::state_into(&achieved, t, &mut a);
                undulate::Motion::state_into(&motion, t, &mut b);
                for (j, most) in tolerance.iter().enumerate() {
                    let off = (a.position[j] - b.position[j]).abs();
                    assert!(off <= *most, "joint {j} at {t}: {off:e} > {most:e}");
                }
            }
        }
    }
}

#[test]
fn a_slower_controller_tracks_less_well() {
    let robot = &arms()[0];
    for plant in PLANTS {
        let at = |controller_period| {
            let options = SimulationOptions {
                controller_period,
                time_step: 5e-4,
                ..with(plant)
            };
            let simulation = Simulation::new(robot, options).unwrap();
            let rollout = simulation.run(&wave(robot, 1.5, 0)).unwrap();
            rollout.rms_error().max()
        };
        let errors = [None, Some(1e-3), Some(4e-3)].map(at);
        println!("{plant:?} {} rad", told(&errors));
        assert!(errors[0] < errors[1] && errors[1] < errors[2] && errors[2] < 2e-3);
    }
    assert_eq!(with(Plant::Rapier), SimulationOptions::default());
}

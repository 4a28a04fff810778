//! Many rollouts over threads.

use undulate::{Push, Pushed, Simulation, SimulationOptions, Wave, shipped, stream};

use crate::waves::random_wave;
use crate::{PLANTS, with};

#[test]
fn any_number_of_threads_gives_the_same_bits_in_the_same_order() {
    let robot = shipped::robot("wave_arm").unwrap();
    // Of different lengths, so that they end in another order than they begin.
    let waves: Vec<Wave> = (0..8)
        .map(|k| random_wave(&robot, 5, 0.6 - 0.05 * k as f64, 0.3, &mut stream(3, k)))
        .collect();
    for plant in PLANTS {
        let options = SimulationOptions {
            friction: Some(0.05),
            pushes: vec![Push {
                on: Pushed::Joint {
                    joint: robot.joints().name(2).to_owned(),
                    effort: 3.0,
                },
                from: 0.1,
                to: 0.15,
            }],
            ..with(plant)
        };
        let simulation = Simulation::new(&robot, options).unwrap();
        let run = |threads| simulation.run_all(&waves, threads, |n, rollout| (n, rollout.unwrap()));
        let one = run(1);
        assert!(one.iter().enumerate().all(|(n, (at, _))| n == *at));
        for (wave, (_, rollout)) in waves.iter().zip(&one) {
            assert_eq!(*rollout, simulation.run(wave).unwrap());
        }
        assert_eq!(one, run(2));
        assert_eq!(one, run(5));
        // They differ from each other.
        assert_ne!(one[0].1.position, one[1].1.position);
        assert!(run(0).len() == 8);
    }
}

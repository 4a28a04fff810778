//! What is worked is what moves and what is lifted.

use undulate::{
    Control, Energy, Plant, Push, Pushed, Robot, Simulation, SimulationOptions, Wave, shipped,
    stream,
};

use crate::waves::random_wave;
use crate::{still, told, with};

/// The most that moved at once \[J\].
fn liveliest(energy: &Energy) -> f64 {
    energy.kinetic.iter().copied().fold(0.0, f64::max)
}

fn energy(robot: &Robot, wave: &Wave, options: SimulationOptions) -> Energy {
    let simulation = Simulation::new(robot, options).unwrap();
    simulation.run(wave).unwrap().energy
}

/// A wave with a push on a link, damping, friction and motors at work.
fn busy(robot: &Robot, plant: Plant, time_step: f64) -> Energy {
    let wave = random_wave(robot, 3, 0.8, 0.3, &mut stream(5, 0));
    let options = SimulationOptions {
        time_step,
        damping: Some(0.4),
        friction: Some(0.2),
        // The load is more than an observer bears.
        observer: false,
        // Damping of 0.4 on the hand is stable at this step by Runge-Kutta where it holds something.
        payload: Some(undulate::Payload {
            link: "hand".to_owned(),
            mass: 1.0,
            center: undulate::nalgebra::Point3::new(0.05, 0.05, 0.1),
        }),
        pushes: vec![Push {
            on: Pushed::Link {
                link: "hand".to_owned(),
                at: undulate::nalgebra::Point3::new(0.0, 0.05, 0.0),
                force: undulate::nalgebra::Vector3::new(5.0, -8.0, 3.0),
            },
            from: 0.1,
            to: 0.5,
        }],
        ..with(plant)
    };
    energy(robot, &wave, options)
}

#[test]
fn a_fall_without_losses_keeps_its_energy() {
    let robot = shipped::robot("wave_arm").unwrap();
    let options = |plant, time_step| SimulationOptions {
        control: Control::Free,
        damping: Some(0.0),
        // Before anything meets its stop.
        duration: Some(0.2),
        time_step,
        ..with(plant)
    };
    let wave = still(&robot, &[0.4, 0.5, 0.4, 0.6, 0.4, 0.1]);
    let share = |plant, time_step| {
        let energy = energy(&robot, &wave, options(plant, time_step));
        assert!(
            energy
                .motors
                .iter()
                .all(|w| w.abs() < 1e-9 || plant == Plant::Rapier)
        );
        energy.imbalance() / liveliest(&energy)
    };
    let rk4 = [2e-3, 1e-3].map(|dt| share(Plant::Rk4, dt));
    let rapier = [2e-3, 1e-3].map(|dt| share(Plant::Rapier, dt));
    println!(
        "RK4 {}, Rapier {} of the kinetic energy, at 2 and 1 ms",
        told(&rk4),
        told(&rapier)
    );
    assert!(rk4[1] < 1e-7 && rk4[1] < rk4[0] / 12.0, "{rk4:?}");
    assert!((1.8..2.2).contains(&(rapier[0] / rapier[1])), "{rapier:?}");
}

#[test]
fn motors_pushes_and_losses_account_for_all_of_it() {
    let robot = shipped::robot("wave_arm").unwrap();
    for plant in [Plant::Rapier, Plant::Rk4] {
        let [coarse, fine] = [1e-3, 5e-4].map(|dt| busy(&robot, plant, dt));
        let share = [&coarse, &fine].map(|e| e.imbalance() / liveliest(e));
        let end = fine.kinetic.len() - 1;
        println!(
            "{plant:?} {}: kinetic {:.2}, motors {:.2}, pushes {:.2}, losses {:.2} J",
            told(&share),
            liveliest(&fine),
            fine.motors[end],
            fine.pushes[end],
            fine.losses[end]
        );
        assert!(fine.losses.windows(2).all(|w| w[1] <= w[0] + 1e-5));
        let bound = match plant {
            Plant::Rapier => 5e-2,
            Plant::Rk4 => 1e-7,
        };
        assert!(share[0] < bound, "{share:?}");
        assert!(share[1] < 0.7 * share[0], "{share:?}");
        // Nothing of it may be left out.
        type Leave = fn(&mut Energy);
        let terms: [Leave; 3] = [
            |e| e.motors.fill(0.0),
            |e| e.pushes.fill(0.0),
            |e| e.losses.fill(0.0),
        ];
        for leave in terms {
            let mut broken = coarse.clone();
            leave(&mut broken);
            assert!(broken.imbalance() > 2.0 * coarse.imbalance());
        }
    }
}

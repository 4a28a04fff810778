//! The disturbance observer where it could do harm: loads heavier than the model, stops, friction.

use undulate::nalgebra::{DMatrix, DVector, Point3};
use undulate::num_complex::Complex;
use undulate::{Payload, Plant, Push, Pushed, Robot, Rollout, Simulation, SimulationOptions, Wave};

use crate::loads::wheel;
use crate::{PLANTS, still, with};

/// Of the wheel \[kg m^2\].
const INERTIA: f64 = 0.5;

fn pushed(effort: f64, from: f64, to: f64) -> Vec<Push> {
    let on = Pushed::Joint {
        joint: "axle".to_owned(),
        effort,
    };
    vec![Push { on, from, to }]
}

/// The wheel, which is `ratio` times as inert as the controller knows, pushed for 30 ms.
fn carrying(ratio: f64, options: SimulationOptions) -> undulate::Result<Rollout> {
    let wheel = wheel("", -9.0, 9.0);
    let options = SimulationOptions {
        duration: Some(4.0),
        effort_limits: false,
        payload: (ratio != 1.0).then(|| Payload {
            link: "rim".to_owned(),
            mass: (ratio - 1.0) * INERTIA,
            center: Point3::new(1.0, 0.0, 0.0),
        }),
        pushes: pushed(5.0, 0.1, 0.13),
        ..options
    };
    Simulation::new(&wheel, options)?.run(&still(&wheel, &[0.0]))
}

/// The largest error from one time to another.
fn worst(rollout: &Rollout, from: f64, to: f64) -> f64 {
    let errors = (0..rollout.times.len())
        .filter(|n| (from..to).contains(&rollout.times[*n]))
        .map(|n| (rollout.position[(n, 0)] - rollout.reference[(n, 0)]).abs());
    errors.fold(0.0, f64::max)
}

#[test]
fn what_the_observer_cannot_bear_is_refused_and_what_it_can_settles() {
    for plant in PLANTS {
        let settled = |ratio: f64, options: SimulationOptions| {
            let rollout = carrying(ratio, options).unwrap();
            let ends = [worst(&rollout, 0.0, 1.0), worst(&rollout, 3.0, 4.0)];
            println!(
                "{plant:?} {ratio}: {:.1e} rad, then {:.1e}",
                ends[0], ends[1]
            );
            assert!(ends[1] < 0.5 * ends[0]);
        };
        settled(10.4, with(plant));
        let alone = SimulationOptions {
            observer: false,
            ..with(plant)
        };
        settled(15.0, alone);
        let error = carrying(10.6, with(plant)).unwrap_err().to_string();
        for word in [
            "10.6 times the inertia",
            "up to 10.5 times",
            "--no-observer",
        ] {
            assert!(error.contains(word), "{error}");
        }
        // Messages every 10 ms leave a margin of 2 / 0.896.
        let seldom = |torque_error| SimulationOptions {
            torque_error,
            controller_period: Some(0.01),
            ..with(plant)
        };
        settled(1.0, seldom(1.2));
        let error = carrying(1.0, seldom(1.3)).unwrap_err().to_string();
        assert!(
            error.contains("at least 0.448 with a message every 0.01 s"),
            "{error}"
        );
    }
}

#[test]
fn a_joint_that_friction_holds_is_brought_back() {
    let wheel = wheel("", -9.0, 9.0);
    for plant in PLANTS {
        let options = SimulationOptions {
            duration: Some(3.0),
            friction: Some(3.0),
            pushes: pushed(8.0, 0.1, 0.5),
            ..with(plant)
        };
        let simulation = Simulation::new(&wheel, options).unwrap();
        let rollout = simulation.run(&still(&wheel, &[0.0])).unwrap();
        let [pushed, left] = [worst(&rollout, 0.1, 0.6), worst(&rollout, 2.5, 3.0)];
        println!("{plant:?}: {pushed:.1e} rad, {left:.1e} left");
        assert!(pushed > 1e-4 && left < 1e-5);
    }
}

/// It turns to 0.01 rad beyond its stop and back.
fn beyond(robot: &Robot) -> Wave {
    let weight = DMatrix::from_element(1, 1, Complex::new(0.03, 0.0));
    let offset = DVector::from_element(1, 0.45);
    Wave::new(robot.joints().clone(), 2.0, offset, weight).unwrap()
}

#[test]
fn a_stop_does_not_wind_it_up() {
    let stop = 0.5;
    let wheel = wheel("", -9.0, stop);
    for plant in PLANTS {
        let run = |observer| {
            let options = SimulationOptions {
                observer,
                effort_limits: false,
                duration: Some(4.0),
                ..with(plant)
            };
            let simulation = Simulation::new(&wheel, options).unwrap();
            simulation.run(&beyond(&wheel)).unwrap()
        };
        let [observed, alone] = [run(true), run(false)].map(|rollout| {
            // The way back from the stop, in the second period.
            let back = (2000..3000)
                .find(|n| rollout.reference[(*n, 0)] < stop)
                .unwrap();
            let time = rollout.times[back];
            (worst(&rollout, time, time + 0.5), rollout.torque.amax())
        });
        println!("{plant:?}: observed {observed:?}, alone {alone:?}");
        assert!(observed.0 < 1.5 * alone.0 + 1e-4 && observed.1 < 1.5 * alone.1);
    }
}

/// The two plants are of one opinion about it.
#[test]
fn plants_agree_where_there_is_friction() {
    let robot = undulate::shipped::robot("wave_arm").unwrap();
    let weights = DMatrix::from_fn(6, 1, |d, _| Complex::from_polar(0.05, d as f64));
    let offsets = DVector::from_row_slice(&[0.5, 0.6, 0.3, 1.2, 0.2, 0.1]);
    let wave = Wave::new(robot.joints().clone(), 1.0 / 1.5, offsets, weights).unwrap();
    let [rapier, rk4] = [Plant::Rapier, Plant::Rk4].map(|plant| {
        let options = SimulationOptions {
            friction: Some(0.1),
            duration: Some(2.0),
            ..with(plant)
        };
        let simulation = Simulation::new(&robot, options).unwrap();
        simulation.run(&wave).unwrap().rms_error().max()
    });
    println!("Rapier {rapier:.2e} rad, Runge-Kutta {rk4:.2e}");
    assert!(rk4 < 1.3 * rapier && rapier < 1.3 * rk4);
}

//! Bad input is told before anything is simulated, and a plant that fails is an error.

use undulate::nalgebra::Point3;
use undulate::{
    ErrorKind, Payload, Plant, Push, Pushed, Robot, Simulation, SimulationOptions, shipped,
};

use crate::{PLANTS, still, with};

const POSTURE: [f64; 6] = [0.5, 0.6, 0.3, 1.2, 0.2, 0.1];

fn said(options: SimulationOptions) -> (ErrorKind, String) {
    let robot = shipped::robot("wave_arm").unwrap();
    let error = Simulation::new(&robot, options)
        .and_then(|simulation| simulation.run(&still(&robot, &POSTURE)))
        .map(|rollout| rollout.peak_error())
        .unwrap_err();
    (error.kind(), error.to_string())
}

#[test]
fn what_cannot_be_is_refused_with_what_could() {
    let plain = SimulationOptions::default;
    let push = |on, from, to| vec![Push { on, from, to }];
    let joint = |name: &str, effort| Pushed::Joint {
        joint: name.to_owned(),
        effort,
    };
    let cases = [
        (
            SimulationOptions {
                time_step: 0.0,
                ..plain()
            },
            "time step of 0 s",
        ),
        (
            SimulationOptions {
                time_step: f64::NAN,
                ..plain()
            },
            "time step of NaN s",
        ),
        (
            SimulationOptions {
                duration: Some(1.0),
                time_step: 3e-3,
                ..plain()
            },
            "duration of 1 s with a time step of 0.003 s, expected a whole number of time steps: 0.999 s or 1.002 s",
        ),
        (
            SimulationOptions {
                controller_period: Some(2.5e-3),
                ..plain()
            },
            "controller period of 0.0025 s with a time step of 0.001 s, expected a whole number of time steps: 0.002 s or 0.003 s",
        ),
        (
            SimulationOptions {
                controller_period: Some(5e-4),
                ..plain()
            },
            "expected at least one time step, 0.001 s",
        ),
        (
            SimulationOptions {
                controller_period: Some(f64::NAN),
                ..plain()
            },
            "controller period of NaN s",
        ),
        (
            SimulationOptions {
                duration: Some(-1.0),
                ..plain()
            },
            "duration of -1 s",
        ),
        (
            SimulationOptions {
                duration: Some(1e9),
                ..plain()
            },
            "duration of 1000000000 s",
        ),
        (
            SimulationOptions {
                bandwidth: 20.0,
                ..plain()
            },
            "limit-cycle when they saturate",
        ),
        (
            SimulationOptions {
                bandwidth: f64::INFINITY,
                effort_limits: false,
                ..plain()
            },
            "bandwidth of inf Hz",
        ),
        (
            SimulationOptions {
                damping: Some(-1.0),
                ..plain()
            },
            "damping of -1",
        ),
        (
            SimulationOptions {
                friction: Some(f64::NAN),
                ..plain()
            },
            "friction of NaN",
        ),
        (
            SimulationOptions {
                torque_error: -1.0,
                ..plain()
            },
            "torque error of -1",
        ),
        (
            SimulationOptions {
                solver_iterations: 0,
                ..plain()
            },
            "0 iterations",
        ),
        (
            SimulationOptions {
                pushes: push(joint("elbo", 1.0), 0.0, 1.0),
                ..plain()
            },
            "elbo",
        ),
        (
            SimulationOptions {
                pushes: push(joint("elbow", f64::NAN), 0.0, 1.0),
                ..plain()
            },
            "not finite",
        ),
        (
            SimulationOptions {
                pushes: push(joint("elbow", 1.0), 1.0, 1.0),
                ..plain()
            },
            "a push from 1 s to 1 s",
        ),
        (
            SimulationOptions {
                pushes: push(joint("elbow", 1.0), 1.0, 2.0),
                ..plain()
            },
            "a push from 1 s to 2 s, in which no step begins, expected one within 1 s",
        ),
        (
            SimulationOptions {
                pushes: push(joint("elbow", 1.0), 0.0101, 0.0109),
                ..plain()
            },
            "in which no step begins",
        ),
        (
            SimulationOptions {
                payload: Some(Payload {
                    link: "hand".to_owned(),
                    mass: 0.0,
                    center: Point3::origin(),
                }),
                ..plain()
            },
            "a mass of 0 kg",
        ),
        (
            SimulationOptions {
                payload: Some(Payload {
                    link: "torso".to_owned(),
                    mass: 1.0,
                    center: Point3::origin(),
                }),
                ..plain()
            },
            "the base",
        ),
        (
            SimulationOptions {
                time_step: 0.02,
                ..plain()
            },
            "a bandwidth of 12 Hz with a time step of 0.02 s, expected below 7.958 Hz",
        ),
        (
            SimulationOptions {
                damping: Some(1e3),
                ..with(Plant::Rk4)
            },
            "damping is unstable with a time step of 0.001 s",
        ),
    ];
    for (options, expected) in cases {
        let (kind, text) = said(options);
        assert!(text.contains(expected), "{text}");
        assert!(matches!(
            kind,
            ErrorKind::Setting | ErrorKind::Name | ErrorKind::Infeasible
        ));
    }
}

#[test]
fn a_robot_without_inertials_is_refused() {
    let robot = Robot::from_urdf(
        r#"<robot name="bare"><link name="a"/><link name="b"/><joint name="j" type="revolute"><parent link="a"/>
        <child link="b"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1" effort="1"/></joint></robot>"#,
    )
    .unwrap();
    for plant in PLANTS {
        let error = Simulation::new(&robot, with(plant)).unwrap_err();
        assert!(
            error.to_string().contains("link `b` moves and has no mass"),
            "{error}"
        );
    }
}

#[test]
fn what_leaves_the_finite_numbers_is_an_error() {
    for plant in PLANTS {
        let options = SimulationOptions {
            pushes: vec![Push {
                on: Pushed::Joint {
                    joint: "elbow".to_owned(),
                    effort: 1e200,
                },
                from: 0.0,
                to: 1.0,
            }],
            ..with(plant)
        };
        let (kind, text) = said(options);
        println!("{plant:?}: {text}");
        assert_eq!(kind, ErrorKind::Infeasible);
    }
}

/// Gains that are accepted bring a pushed arm back to rest, in postures where joints move each other much too.
#[test]
fn whatever_gains_are_accepted_are_stable() {
    let robot = shipped::robot("wave_arm").unwrap();
    // With the arm straight, shoulder and forearm turn about nearly one axis.
    for posture in [POSTURE, [0.5, 0.6, 0.3, 0.05, 0.2, 0.1]] {
        for plant in PLANTS {
            for (time_step, bandwidth) in [
                (1e-3, 5.0),
                (1e-3, 15.9),
                (5e-3, 12.0),
                (2e-2, 5.0),
                (2e-2, 7.9),
                (1e-3, 150.0),
            ] {
                let options = SimulationOptions {
                    time_step,
                    bandwidth,
                    effort_limits: bandwidth < 15.9,
                    duration: Some(6.0),
                    pushes: vec![Push {
                        on: Pushed::Joint {
                            joint: robot.joints().name(0).to_owned(),
                            effort: 0.1,
                        },
                        from: 0.0,
                        to: 0.1,
                    }],
                    ..with(plant)
                };
                let simulation = Simulation::new(&robot, options).unwrap();
                let rollout = simulation.run(&still(&robot, &posture)).unwrap();
                let left = rollout.velocity.row(rollout.times.len() - 1).amax();
                println!("{plant:?} {time_step} s, {bandwidth} Hz: {left:.1e} rad/s left");
                assert!(
                    left < 1e-6,
                    "{plant:?} {time_step} s, {bandwidth} Hz: {left:e} rad/s"
                );
            }
        }
    }
}

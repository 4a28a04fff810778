//! Pushes, payloads, friction, damping and stops against closed forms.

use undulate::nalgebra::{DMatrix, DVector, Point3, Vector3};
use undulate::num_complex::Complex;
use undulate::{
    CollisionModel, CollisionOptions, Control, Dynamics, EventKind, GRAVITY, Payload, Plant, Push,
    Pushed, Robot, Rollout, Scene, Simulation, SimulationOptions, Wave, shipped,
};

use crate::{PLANTS, still, with};

const POSTURE: [f64; 6] = [0.5, 0.6, 0.3, 1.2, 0.2, 0.1];

/// By how much the arm, held in its posture for 2 s, gives way in the end.
fn held(options: SimulationOptions) -> DVector<f64> {
    let robot = shipped::robot("wave_arm").unwrap();
    let options = SimulationOptions {
        duration: Some(2.0),
        ..options
    };
    let simulation = Simulation::new(&robot, options).unwrap();
    let rollout = simulation.run(&still(&robot, &POSTURE)).unwrap();
    let end = rollout.times.len() - 1;
    (rollout.position.row(end) - rollout.reference.row(end)).transpose()
}

/// Held by springs alone. What they yield to, the observer takes from them in the end.
fn yielding(options: SimulationOptions) -> DVector<f64> {
    let left = held(options.clone()).amax();
    println!("{left:.1e} rad with the observer");
    assert!(left < 1e-9);
    held(SimulationOptions {
        observer: false,
        ..options
    })
}

/// How the arm `robot` yields to forces, held by loops of 12 Hz about the inertias of `model`: their stiffness is inertia times the square of the
/// natural frequency, and gravity's changes with the posture.
fn yields(model: &Robot, robot: &Robot, forces: &DVector<f64>) -> DVector<f64> {
    let inertia = Dynamics::new(model).mass_diagonal(model, &POSTURE);
    let springs = DVector::from_vec(inertia) * (std::f64::consts::TAU * 12.0).powi(2);
    let mut dynamics = Dynamics::new(robot);
    let mut gravity = |j: usize, step: f64| {
        let mut q = POSTURE;
        q[j] += step;
        DVector::from_row_slice(dynamics.gravity_forces(robot, &q, &GRAVITY))
    };
    let mut stiffness = DMatrix::from_diagonal(&springs);
    for j in 0..6 {
        let slope = (gravity(j, 1e-5) - gravity(j, -1e-5)) / 2e-5;
        let column = stiffness.column(j) + slope;
        stiffness.set_column(j, &column);
    }
    stiffness.lu().solve(forces).unwrap()
}

/// Small angles yield in proportion: a hundredth of what is expected, for what they change of the arm.
fn assert_near(what: &str, found: &DVector<f64>, expected: &DVector<f64>) {
    let off = (found - expected).amax();
    println!("{what}: {:.2e} rad, {off:.1e} off", expected.amax());
    assert!(
        expected.amax() > 1e-4 && off < 0.01 * expected.amax(),
        "{found} {expected}"
    );
}

#[test]
fn what_pushes_and_weighs_is_held_by_springs() {
    let robot = shipped::robot("wave_arm").unwrap();
    let (at, force) = (Point3::new(0.02, 0.01, -0.03), Vector3::new(0.2, -0.3, 0.1));
    let push = |on| Push {
        on,
        from: 0.0,
        to: 5.0,
    };
    let link = robot.link("hand").unwrap();
    let point = link.pose * at;
    // Forces at the joints as work over small steps of them.
    let reach = |q: &[f64]| robot.body_poses(q)[link.body] * point;
    let pushed = DVector::from_fn(6, |j, _| {
        let (mut above, mut below) = (POSTURE, POSTURE);
        above[j] += 1e-6;
        below[j] -= 1e-6;
        (reach(&above) - reach(&below)).dot(&force) / 2e-6
    });
    let mut dynamics = Dynamics::new(&robot);
    let loaded = robot.carrying("hand", 0.05, &at).unwrap();
    let own = DVector::from_row_slice(dynamics.gravity_forces(&robot, &POSTURE, &GRAVITY));
    let all = DVector::from_row_slice(dynamics.gravity_forces(&loaded, &POSTURE, &GRAVITY));
    for plant in PLANTS {
        let by_link = SimulationOptions {
            pushes: vec![push(Pushed::Link {
                link: "hand".to_owned(),
                at,
                force,
            })],
            ..with(plant)
        };
        assert_near("link", &yielding(by_link), &yields(&robot, &robot, &pushed));
        let by_joint = SimulationOptions {
            pushes: vec![push(Pushed::Joint {
                joint: robot.joints().name(1).to_owned(),
                effort: 0.5,
            })],
            ..with(plant)
        };
        let effort = DVector::from_fn(6, |j, _| if j == 1 { 0.5 } else { 0.0 });
        assert_near(
            "joint",
            &yielding(by_joint),
            &yields(&robot, &robot, &effort),
        );
        let carrying = SimulationOptions {
            payload: Some(Payload {
                link: "hand".to_owned(),
                mass: 0.05,
                center: at,
            }),
            ..with(plant)
        };
        assert_near(
            "payload",
            &yielding(carrying),
            &yields(&robot, &loaded, &(&own - &all)),
        );
        // All of the feed-forward is too large, and here it is gravity's.
        let wrong = SimulationOptions {
            torque_error: 0.05,
            ..with(plant)
        };
        assert_near(
            "torque",
            &yielding(wrong),
            &yields(&robot, &robot, &(0.05 * &own)),
        );
    }
}

/// A wheel about the vertical, that gravity does not move.
pub fn wheel(properties: &str, lower: f64, upper: f64) -> Robot {
    let text = format!(
        r#"<robot name="wheel"><link name="base"/><link name="rim"><inertial><mass value="1"/>
        <inertia ixx="0.5" ixy="0" ixz="0" iyy="0.5" iyz="0" izz="0.5"/></inertial></link>
        <joint name="axle" type="revolute"><parent link="base"/><child link="rim"/><axis xyz="0 0 1"/>
        <limit lower="{lower}" upper="{upper}" velocity="10" effort="100"/>{properties}</joint></robot>"#
    );
    Robot::from_urdf(&text).unwrap()
}

/// A wave that passes 0 at 2 rad/s.
fn spin(robot: &Robot) -> Wave {
    let weight = DMatrix::from_element(1, 1, Complex::new(0.0, -1.0 / std::f64::consts::TAU));
    Wave::new(robot.joints().clone(), 1.0, DVector::zeros(1), weight).unwrap()
}

fn released(robot: &Robot, plant: Plant) -> Rollout {
    let options = SimulationOptions {
        control: Control::Free,
        duration: Some(1.0),
        ..with(plant)
    };
    let simulation = Simulation::new(robot, options).unwrap();
    simulation.run(&spin(robot)).unwrap()
}

#[test]
fn friction_and_damping_slow_a_wheel_as_they_should() {
    for plant in PLANTS {
        let near = match plant {
            Plant::Rapier => 3e-3,
            Plant::Rk4 => 1e-9,
        };
        // v' = -d / I v
        let rollout = released(&wheel(r#"<dynamics damping="1.5"/>"#, -9.0, 9.0), plant);
        let v = rollout.velocity[(400, 0)];
        let expected = 2.0 * (-1.5 / 0.5 * 0.4_f64).exp();
        println!("{plant:?} damping: {v} rad/s, {expected}");
        assert!((v - expected).abs() < near);
        // v' = -f / I: at rest after 2 I / f = 0.8 s and f / I 0.8^2 / 2 rad, and from then on.
        let rollout = released(&wheel(r#"<dynamics friction="1.25"/>"#, -9.0, 9.0), plant);
        let expected = 1.25 / 0.5 * 0.8 * 0.8 / 2.0;
        let (v, q) = (rollout.velocity[(400, 0)], rollout.position[(1000, 0)]);
        println!("{plant:?} friction: {v} rad/s, {q} rad, {expected}");
        assert!((v - 1.0).abs() < near && (q - expected).abs() < near);
        assert!(rollout.velocity[(1000, 0)].abs() < 1e-12 + near * 1e-3);
        let lost = rollout.energy.losses[1000];
        assert!((lost + 0.5 * 0.5 * 4.0).abs() < 2.0 * near, "{lost}");
    }
}

#[test]
fn a_stop_stops() {
    for plant in PLANTS {
        let rollout = released(&wheel("", -9.0, 0.5), plant);
        let most = rollout.position.max();
        let (v, taken) = (rollout.velocity[(1000, 0)], rollout.energy.stops[1000]);
        println!("{plant:?}: at most {most} rad, {v} rad/s left, the stop took {taken} J");
        // In Rapier it gives back a little of the speed.
        let near = if plant == Plant::Rk4 { 1e-9 } else { 0.05 };
        assert!((most - 0.5).abs() < 3e-3 && v.abs() < near, "{v}");
        assert!((taken + 0.5 * 0.5 * 4.0).abs() < near);
        let event = &rollout.events[0];
        let axle = "axle".to_owned();
        assert_eq!(event.kind, EventKind::Stopped { joint: axle });
        // 0.5 rad at 2 rad/s
        assert!((event.from - 0.25).abs() < 2e-3, "{event:?}");
        assert!(event.to == 1.0 || plant == Plant::Rapier, "{event:?}");
    }
}

#[test]
fn friction_holds_an_arm_against_gravity() {
    let robot = shipped::robot("wave_arm").unwrap();
    for plant in PLANTS {
        let options = SimulationOptions {
            control: Control::Free,
            friction: Some(40.0),
            ..with(plant)
        };
        let simulation = Simulation::new(&robot, options).unwrap();
        let rollout = simulation.run(&still(&robot, &POSTURE)).unwrap();
        let moved = rollout.peak_error().max();
        println!("{plant:?}: {moved:.1e} rad");
        assert!(moved < 1e-4);
    }
}

#[test]
fn effort_limits_hold_and_are_told() {
    let robot = shipped::robot("wave_arm").unwrap();
    for plant in PLANTS {
        let options = SimulationOptions {
            pushes: vec![Push {
                on: Pushed::Joint {
                    joint: robot.joints().name(3).to_owned(),
                    effort: -55.0,
                },
                from: 0.1,
                to: 0.15,
            }],
            ..with(plant)
        };
        let run = |effort_limits| {
            let options = SimulationOptions {
                effort_limits,
                ..options.clone()
            };
            let simulation = Simulation::new(&robot, options).unwrap();
            simulation.run(&still(&robot, &POSTURE)).unwrap()
        };
        let (held, free) = (run(true), run(false));
        let limit = robot.properties(3).effort.unwrap();
        println!(
            "{plant:?}: {:.2} and {:.2} N m of {limit}",
            held.torque.column(3).max(),
            free.torque.column(3).max()
        );
        assert!(held.torque.column(3).max() < 1.001 * limit && held.saturated[3] > 20);
        assert!(free.torque.column(3).max() > 1.1 * limit);
        let joint = robot.joints().name(3).to_owned();
        let event = held.events.iter().find(|e| {
            e.kind
                == EventKind::Saturated {
                    joint: joint.clone(),
                }
        });
        assert!((0.1..0.2).contains(&event.unwrap().from), "{event:?}");
    }
}

#[test]
fn an_arm_settles_after_a_push_that_its_motors_cannot_hold() {
    // Limits neither wind up what is observed, nor make a cycle of it.
    let robot = shipped::robot("wave_arm").unwrap();
    for plant in PLANTS {
        for bandwidth in [5.0, 12.0, 15.9] {
            for joint in 0..6 {
                let limit = robot.properties(joint).effort.unwrap();
                let options = SimulationOptions {
                    bandwidth,
                    duration: Some(3.0),
                    pushes: vec![Push {
                        on: Pushed::Joint {
                            joint: robot.joints().name(joint).to_owned(),
                            effort: -2.0 * limit,
                        },
                        from: 0.1,
                        to: 0.13,
                    }],
                    ..with(plant)
                };
                let simulation = Simulation::new(&robot, options).unwrap();
                let rollout = simulation.run(&still(&robot, &POSTURE)).unwrap();
                let end = rollout.times.len() - 1;
                let off = (rollout.position.row(end) - rollout.reference.row(end)).amax();
                let left = rollout.velocity.row(end).amax();
                let saturated: usize = rollout.saturated.iter().sum();
                assert!(saturated > 0);
                assert!(
                    off < 1e-6 && left < 1e-6,
                    "{plant:?} {bandwidth} Hz, joint {joint}: {off:e} rad, {left:e} rad/s"
                );
            }
        }
    }
}

#[test]
fn contacts_of_what_was_achieved_are_told() {
    let robot = shipped::robot("wave_arm").unwrap();
    let run = |pushes| {
        let options = SimulationOptions {
            pushes,
            observer: false,
            ..with(Plant::Rk4)
        };
        let simulation = Simulation::new(&robot, options).unwrap();
        simulation.run(&still(&robot, &POSTURE)).unwrap()
    };
    // A push that lifts the arm, or lowers it.
    let push = |effort| Push {
        on: Pushed::Joint {
            joint: robot.joints().name(0).to_owned(),
            effort,
        },
        from: 0.2,
        to: 0.4,
    };
    let quiet = run(Vec::new());
    let wall = |x: f64| {
        let text = format!(
            "[[object]]\nname = \"wall\"\nhalf_space = {{ normal = [-1, 0, 0], offset = {} }}",
            -x
        );
        let options = CollisionOptions {
            scene: Scene::from_toml(&text).unwrap(),
            ..CollisionOptions::default()
        };
        CollisionModel::new(&robot, &options).unwrap()
    };
    // How near a wall may be, to a millimetre, that the arm does not touch at a row.
    let reach = |rollout: &Rollout, row: usize| {
        let q: Vec<f64> = rollout.position.row(row).iter().copied().collect();
        (0..2000)
            .map(|mm| f64::from(mm) * 1e-3)
            .find(|x| wall(*x).collision(&q).is_none())
            .unwrap()
    };
    let free = reach(&quiet, 0);
    let pushed = [40.0, -40.0].map(|effort| run(vec![push(effort)]));
    let (pushed, there) = pushed
        .iter()
        .map(|rollout| (rollout, reach(rollout, 390)))
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap();
    println!("a wall is touched below {free} m, pushed below {there} m");
    assert!(there > free + 2e-3);
    let wall = wall(free.midpoint(there));
    assert!(quiet.contacts(&wall).unwrap().is_empty());
    let contacts = pushed.contacts(&wall).unwrap();
    println!("{contacts:?}");
    let EventKind::Contact { pair } = &contacts[0].kind else {
        panic!("{contacts:?}")
    };
    assert_eq!(pair.0, "wall");
    assert!((0.2..0.4).contains(&contacts[0].from) && contacts[0].to > contacts[0].from);
}

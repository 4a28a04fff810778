//! Values that Pinocchio computed: for real robots, and (`tests/oracle/dynamics.py`) for those of this project.

use std::collections::BTreeSet;

use nalgebra::{DMatrix, DVector};
use serde_json::Value;
use undulate::{Dynamics, GRAVITY, Kinematics, Robot, shipped};

use crate::common::shared;

/// Of the largest number of each vector or matrix, and at least of 1.
const TOLERANCE: f64 = 1e-10;

fn numbers(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .unwrap()
        .iter()
        .map(|x| x.as_f64().unwrap())
        .collect()
}

/// What is compared, and what does not agree.
#[derive(Default)]
struct Outcome {
    seen: BTreeSet<&'static str>,
    wrong: Vec<String>,
}

impl Outcome {
    fn check(&mut self, key: &'static str, found: &[f64], expected: &[f64]) {
        assert_eq!(found.len(), expected.len(), "{key}");
        let scale = expected.iter().fold(1.0, |s: f64, x| s.max(x.abs()));
        for (f, e) in found.iter().zip(expected) {
            // False where one is no number.
            let agrees = (f - e).abs() < TOLERANCE * scale;
            if !agrees {
                self.wrong.push(format!("{key}: {f} {e}, scale {scale}"));
            }
        }
        self.seen.insert(key);
    }
}

/// Compares all that a case holds.
fn compare(robot: &Robot, order: &[usize], case: &Value) -> Outcome {
    let n = order.len();
    let mut dynamics = Dynamics::new(robot);
    let mut kinematics = Kinematics::new(robot);
    let mut outcome = Outcome::default();
    let arranged = |key: &str| {
        let values = case[key].as_array().map(|_| numbers(&case[key]))?;
        Some(order.iter().map(|i| values[*i]).collect::<Vec<f64>>())
    };
    let q = arranged("q").unwrap();
    let v = arranged("v").unwrap_or_else(|| vec![0.0; n]);
    let a = arranged("a").unwrap_or_else(|| vec![0.0; n]);
    for (link, pose) in robot.links().iter().zip(robot.link_poses(&q)) {
        let expected = &case["link_pose_3x4_row_major"][&link.name];
        if !expected.is_null() {
            let matrix = pose.to_homogeneous();
            let found = matrix.fixed_rows::<3>(0).transpose();
            outcome.check("link poses", found.as_slice(), &numbers(expected));
        }
        let expected = &case["link_jacobian_row_major"][&link.name];
        if !expected.is_null() {
            let jacobian = kinematics.link_jacobian(robot, &q, link);
            let expected = DMatrix::from_row_slice(6, n, &numbers(expected)).select_columns(order);
            outcome.check("link Jacobians", jacobian.as_slice(), expected.as_slice());
        }
    }
    if let Some(tau) = arranged("rnea_tau") {
        let found = dynamics.inverse(robot, &q, &v, &a, &GRAVITY);
        outcome.check("inverse", found, &tau);
        let half: Vec<f64> = tau.iter().map(|t| t / 2.0).collect();
        let expected = arranged("aba_of_half_tau").unwrap();
        let found = dynamics.forward(robot, &q, &v, &half, &GRAVITY).unwrap();
        outcome.check("forward", found, &expected);
    }
    if let Some(expected) = arranged("gravity_tau") {
        let found = dynamics.gravity_forces(robot, &q, &GRAVITY);
        outcome.check("gravity", found, &expected);
    }
    if case["mass_matrix"].is_array() {
        let expected = DMatrix::from_row_slice(n, n, &numbers(&case["mass_matrix"]));
        let expected = expected.select_columns(order).select_rows(order);
        let found = dynamics.mass_matrix(robot, &q).as_slice();
        outcome.check("mass matrix", found, expected.as_slice());
    }
    if let Some(expected) = case["kinetic_energy"].as_f64() {
        let found = dynamics.kinetic_energy(robot, &q, &v);
        outcome.check("kinetic energy", &[found], &[expected]);
        // Of the potential energy its change from the rest at zero: whether the base counts is a matter of taste.
        let zero = dynamics.potential_energy(robot, &vec![0.0; n], &GRAVITY);
        let found = dynamics.potential_energy(robot, &q, &GRAVITY) - zero;
        let expected = case["potential_energy_above_zero"].as_f64().unwrap();
        outcome.check("potential energy", &[found], &[expected]);
    }
    outcome
}

/// How many kinds of values agree; all must.
fn agreeing(robot: &Robot, order: &[usize], case: &Value) -> usize {
    let outcome = compare(robot, order, case);
    assert!(
        outcome.wrong.is_empty(),
        "{}: {:#?}",
        robot.name(),
        outcome.wrong
    );
    outcome.seen.len()
}

fn order(robot: &Robot, oracle: &Value) -> Vec<usize> {
    let names: Vec<&str> = oracle["joints_in_order_of_q"]
        .as_array()
        .unwrap()
        .iter()
        .map(|n| n.as_str().unwrap())
        .collect();
    assert_eq!(names.len(), robot.joints().len(), "{names:?}");
    robot
        .joints()
        .iter()
        .map(|j| names.iter().position(|n| n == j).unwrap())
        .collect()
}

/// The text without its mimics: the oracle of real robots has these joints free.
fn freed(text: &str) -> String {
    let mut parts = text.split("<mimic");
    let mut freed = parts.next().unwrap().to_owned();
    for part in parts {
        freed.push_str(part.split_once("/>").unwrap().1);
    }
    freed
}

#[test]
fn all_real_robots_agree() {
    let Some(folder) = shared("Pinocchio's values of real robots") else {
        return;
    };
    let (mut robots, mut with_dynamics) = (0, 0);
    let mut files: Vec<_> = std::fs::read_dir(folder.join("oracle"))
        .unwrap()
        .map(|e| e.unwrap().path())
        .collect();
    files.sort();
    for file in files
        .iter()
        .filter(|f| f.extension().is_some_and(|e| e == "json"))
    {
        let oracle: Value = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
        if oracle["joints_in_order_of_q"].is_null() {
            continue;
        }
        let name = oracle["robot"].as_str().unwrap();
        let text = std::fs::read_to_string(folder.join("robots").join(name)).unwrap();
        let robot = Robot::from_urdf(&freed(&text)).unwrap();
        let order = order(&robot, &oracle);
        for case in oracle["cases"].as_array().unwrap() {
            let expected = if oracle["dynamics"] == true { 5 } else { 1 };
            assert_eq!(agreeing(&robot, &order, case), expected, "{name}");
        }
        robots += 1;
        with_dynamics += usize::from(oracle["dynamics"] == true);
    }
    assert_eq!((robots, with_dynamics), (7, 5));
}

/// Mimics included: the script multiplies Pinocchio's matrices of free joints by the gears.
#[test]
fn our_robots_and_a_random_tree_agree() {
    let oracle: Value = serde_json::from_str(include_str!("../oracle/dynamics.json")).unwrap();
    let mut names = BTreeSet::new();
    for entry in oracle["robots"].as_array().unwrap() {
        let name = entry["robot"].as_str().unwrap();
        let robot = match entry["urdf"].as_str() {
            Some(text) => Robot::from_urdf(text).unwrap(),
            None => shipped::robot(name).unwrap(),
        };
        let order = order(&robot, entry);
        for case in entry["cases"].as_array().unwrap() {
            assert_eq!(agreeing(&robot, &order, case), 8, "{name}");
        }
        names.insert(name);
    }
    for name in shipped::robots() {
        assert!(
            names.contains(name),
            "no values for {name}; run tests/oracle/dynamics.py"
        );
    }
    assert!(names.contains("tree"));
}

#[test]
fn a_number_off_by_a_billionth_is_noticed() {
    let oracle: Value = serde_json::from_str(include_str!("../oracle/dynamics.json")).unwrap();
    let entry = &oracle["robots"][0];
    let robot = shipped::robot(entry["robot"].as_str().unwrap()).unwrap();
    let order = order(&robot, entry);
    for (key, what) in [
        ("rnea_tau", "inverse"),
        ("mass_matrix", "mass matrix"),
        ("aba_of_half_tau", "forward"),
        ("gravity_tau", "gravity"),
    ] {
        let mut case = entry["cases"][0].clone();
        let values = DVector::from_vec(numbers(&case[key]));
        let most = values.iamax();
        case[key][most] = (values[most] + 1e-9 * values[most].abs().max(1.0)).into();
        let wrong = compare(&robot, &order, &case).wrong;
        assert!(
            wrong.iter().any(|w| w.starts_with(what)),
            "{key}: {wrong:?}"
        );
    }
}

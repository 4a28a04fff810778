//! What holds for every robot: random trees with branches, slides, loads and mimics.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use proptest::prelude::*;
use undulate::rand::RngExt;
use undulate::testing::trees;
use undulate::{Dynamics, Frame, GRAVITY, JointKind, Kinematics, Robot, stream};

/// Weights of central differences with steps of 1, 2, 3: exact for polynomials of degree six.
const STENCIL: [f64; 3] = [3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0];
/// Step of the differences: the truncation h^6 and the rounding 1e-16 / h balance about here.
const STEP: f64 = 4e-3;

/// Eight joints deep, twenty roundings each, of 1.1e-16.
const ROUNDING: f64 = 2e-14;

/// The derivative of `f` at 0.
fn derivative<T>(f: impl Fn(f64) -> T) -> T
where
    T: std::ops::Sub<Output = T> + std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>,
{
    let term = |k: usize| {
        let h = k as f64 * STEP;
        (f(h) - f(-h)) * (STENCIL[k - 1] / STEP)
    };
    term(1) + term(2) + term(3)
}

/// Vectors with an entry a joint, within 1, of a seed.
fn random<const N: usize>(robot: &Robot, seed: u64) -> [DVector<f64>; N] {
    let mut rng = stream(seed, 0);
    std::array::from_fn(|_| {
        DVector::from_fn(robot.joints().len(), |_, _| 2.0 * rng.random::<f64>() - 1.0)
    })
}

/// The vector of a skew matrix.
fn vee(m: &Matrix3<f64>) -> Vector3<f64> {
    Vector3::new(m.m32 - m.m23, m.m13 - m.m31, m.m21 - m.m12) / 2.0
}

fn frame(robot: &Robot, q: &DVector<f64>, link: usize) -> Frame {
    let mut frames = vec![Frame::identity(); robot.bodies().len()];
    robot.body_frames_into(q.as_slice(), &mut frames);
    let link = &robot.links()[link];
    frames[link.body].carry(&Frame {
        rotation: link.pose.rotation.to_rotation_matrix().into_inner(),
        origin: link.pose.translation.vector,
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn matrices_and_quaternions_put_links_in_one_place(text in trees(1..=8), seed: u64) {
        let robot = Robot::from_urdf(&text).unwrap();
        // Hundreds of turns too.
        let [small] = random::<1>(&robot, seed);
        for q in [&small * 3.0, &small * 2000.0] {
            for (link, pose) in robot.link_poses(q.as_slice()).iter().enumerate() {
                let found = frame(&robot, &q, link).to_isometry();
                let offset = (found.translation.vector - pose.translation.vector).norm();
                let angle = 2.0 * found.rotation.rotation_to(&pose.rotation).imag().norm();
                prop_assert!(angle < ROUNDING, "{angle:e} rad");
                prop_assert!(offset < ROUNDING * reach(&robot, &q), "{offset:e} m of {}", reach(&robot, &q));
            }
        }
    }

    #[test]
    fn the_jacobian_is_the_derivative_of_the_pose(text in trees(1..=8), seed: u64) {
        let robot = Robot::from_urdf(&text).unwrap();
        let mut kinematics = Kinematics::new(&robot);
        let [q, v] = random(&robot, seed);
        for (i, link) in robot.links().iter().enumerate() {
            let jacobian = kinematics.link_jacobian(&robot, q.as_slice(), link).clone();
            let here = frame(&robot, &q, i).rotation;
            for j in 0..q.len() {
                let moved = |h: f64| {
                    let mut q = q.clone();
                    q[j] += h;
                    frame(&robot, &q, i)
                };
                let linear = derivative(|h| moved(h).origin);
                let angular = vee(&(derivative(|h| moved(h).rotation) * here.transpose()));
                let column = jacobian.column(j);
                let error = (column.fixed_rows::<3>(0) - linear).amax().max((column.fixed_rows::<3>(3) - angular).amax());
                // h^6 / 140 times a seventh derivative: a body turns by at most the sum of multipliers along its chain.
                let turns = column.fixed_rows::<3>(3).norm() + followed(&robot, j);
                let bound = 1e-11 + STEP.powi(6) / 140.0 * turns.powi(7) * (4.0 + turns);
                prop_assert!(error < bound, "{} joint {j}: {error:e} {bound:e}", link.name);
            }
            let twist = kinematics.link_twist(&robot, q.as_slice(), v.as_slice(), link);
            let product = jacobian * &v;
            prop_assert!((product.fixed_rows::<3>(0) - twist.linear).amax() < 1e-13 * (1.0 + twist.linear.amax()));
            prop_assert!((product.fixed_rows::<3>(3) - twist.angular).amax() < 1e-13 * (1.0 + twist.angular.amax()));
        }
    }

    #[test]
    fn the_mass_matrix_is_what_inverse_dynamics_and_energy_say(text in trees(1..=8), seed: u64) {
        let robot = Robot::from_urdf(&text).unwrap();
        robot.require_dynamics().unwrap();
        let mut dynamics = Dynamics::new(&robot);
        let [q, v] = random(&robot, seed);
        let n = q.len();
        let mass = dynamics.mass_matrix(&robot, q.as_slice()).clone();
        prop_assert_eq!(&mass, &mass.transpose());
        prop_assert!(mass.clone().cholesky().is_some(), "not positive definite: {}", mass);
        let still = vec![0.0; n];
        let columns = DMatrix::from_fn(n, n, |i, j| {
            let unit: Vec<f64> = (0..n).map(|k| f64::from(k == j)).collect();
            dynamics.inverse(&robot, q.as_slice(), &still, &unit, &Vector3::zeros())[i]
        });
        prop_assert!((&mass - columns).amax() < 1e-13 * mass.amax());
        let kinetic = dynamics.kinetic_energy(&robot, q.as_slice(), v.as_slice());
        let form = (&mass * &v).dot(&v) / 2.0;
        prop_assert!((kinetic - form).abs() < 1e-13 * mass.amax(), "{} {}", kinetic, form);
    }

    #[test]
    fn forward_undoes_inverse(text in trees(1..=8), seed: u64) {
        let robot = Robot::from_urdf(&text).unwrap();
        let mut dynamics = Dynamics::new(&robot);
        let [q, v, tau] = random(&robot, seed).map(|x| x * 3.0);
        let a = dynamics.forward(&robot, q.as_slice(), v.as_slice(), tau.as_slice(), &GRAVITY).unwrap().to_vec();
        let back = dynamics.inverse(&robot, q.as_slice(), v.as_slice(), &a, &GRAVITY);
        let error = (DVector::from_column_slice(back) - &tau).amax();
        prop_assert!(error < 1e-10 * tau.amax().max(1.0), "{:e}", error);
    }

    /// d/dt (kinetic + potential) = tau . v along q(t) = q + v t + a t^2 / 2.
    #[test]
    fn power_goes_into_energy(text in trees(1..=8), seed: u64) {
        let robot = Robot::from_urdf(&text).unwrap();
        let mut dynamics = Dynamics::new(&robot);
        // Slow, so that the truncation of the differences (seven times the fastest turn, to the seventh power) stays small.
        let [q, v, a] = random(&robot, seed);
        let (v, a) = (v / 4.0, a / 4.0);
        let tau = DVector::from_column_slice(dynamics.inverse(&robot, q.as_slice(), v.as_slice(), a.as_slice(), &GRAVITY));
        let energy = |t: f64| {
            let mut dynamics = Dynamics::new(&robot);
            let (q, v) = (&q + &v * t + &a * (t * t / 2.0), &v + &a * t);
            dynamics.kinetic_energy(&robot, q.as_slice(), v.as_slice()) + dynamics.potential_energy(&robot, q.as_slice(), &GRAVITY)
        };
        let error = (derivative(energy) - tau.dot(&v)).abs();
        let scale = 1.0 + tau.abs().dot(&v.abs());
        prop_assert!(error < 1e-9 * scale, "{:e} of {:e}", error, scale);
    }
}

/// What no link is farther away than \[m\]: a metre a link, and the slides.
fn reach(robot: &Robot, q: &DVector<f64>) -> f64 {
    let slides = robot
        .moving()
        .filter(|(_, joint)| joint.kind == JointKind::Prismatic);
    let slid: f64 = slides
        .map(|(_, joint)| joint.position(q.as_slice()).abs())
        .sum();
    slid + robot.links().len() as f64
}

/// The sum of the multipliers' moduli of all that follows joint `j`, itself included.
fn followed(robot: &Robot, j: usize) -> f64 {
    robot
        .moving()
        .filter(|(_, joint)| joint.index == j)
        .map(|(_, joint)| joint.multiplier.abs())
        .sum()
}

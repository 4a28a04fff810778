//! Forces and accelerations: inverse and forward dynamics, the mass matrix, energies.
//!
//! Everything is in the coordinates of the commanded joints: a joint that mimics another moves as a gear would make it,
//! and its force counts, times its multiplier, towards that of the joint it mimics. Damping and friction of the joints are not in it.

mod energy;
mod forward;
mod inertia;
mod inverse;
mod mass_matrix;
#[cfg(feature = "simulation")]
mod stepping;

use nalgebra::{DMatrix, Matrix3, Vector3};

pub(super) use inertia::SpatialInertia;
use inertia::Wrench;
pub(super) use mass_matrix::mass_diagonal;
#[cfg(feature = "simulation")]
pub(crate) use stepping::{factorise, solve};

use super::Robot;
use super::kinematics::Kinematics;

/// Acceleration of gravity in the base frame \[m/s^2\]: the base stands upright, z up.
pub const GRAVITY: Vector3<f64> = Vector3::new(0.0, 0.0, -9.81);

/// Workspace of the dynamics of one robot, whose mass matrix it has room for; nothing is allocated once it exists.
///
/// Every method takes the robot that the workspace was made for, and panics for one of another size and for slices that
/// have not one entry a joint. Damping and friction are in none of them; bodies without mass count as massless.
///
/// ```
/// use undulate::{Dynamics, GRAVITY, shipped};
///
/// let robot = shipped::robot("wave_arm")?;
/// let mut dynamics = Dynamics::new(&robot);
/// let (q, v, tau) = ([0.2; 6], [1.0; 6], [3.0; 6]);
/// let a = dynamics.forward(&robot, &q, &v, &tau, &GRAVITY)?.to_vec();
/// let back = dynamics.inverse(&robot, &q, &v, &a, &GRAVITY);
/// assert!(back.iter().all(|t| (t - 3.0).abs() < 1e-12));
/// # Ok::<(), undulate::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Dynamics {
    kinematics: Kinematics,
    placed: Vec<Placed>,
    bodies: Vec<BodyState>,
    /// Of each body with all that it carries.
    composites: Vec<SpatialInertia>,
    /// Generalized forces of the last call, an entry a joint.
    forces: Vec<f64>,
    /// The force along each body's own joint in the last call; it differs from `forces` where joints mimic others.
    efforts: Vec<f64>,
    accelerations: Vec<f64>,
    /// As many zeros as there are joints.
    still: Vec<f64>,
    mass: DMatrix<f64>,
    factor: DMatrix<f64>,
}

/// A body in a configuration. Directions are those of the base frame, so that nothing is turned on its way from body to body, and points of
/// reference the origins of the bodies' frames, so that no inertia is lost in that of a long lever.
#[derive(Debug, Clone)]
struct Placed {
    /// From the body's directions.
    rotation: Matrix3<f64>,
    /// From the origin of the parent's frame.
    arm: Vector3<f64>,
    /// Of the joint.
    axis: Vector3<f64>,
    inertia: SpatialInertia,
}

impl Placed {
    fn base() -> Self {
        Self {
            rotation: Matrix3::identity(),
            arm: Vector3::zeros(),
            axis: Vector3::zeros(),
            inertia: SpatialInertia::zero(),
        }
    }
}

/// How a body moves and what it takes, as it is [`Placed`].
#[derive(Debug, Clone)]
struct BodyState {
    angular_velocity: Vector3<f64>,
    angular_acceleration: Vector3<f64>,
    /// Of the frame's origin, gravity included as an upward acceleration of the base.
    acceleration: Vector3<f64>,
    /// About the frame's origin.
    wrench: Wrench,
}

impl Dynamics {
    /// A workspace for `robot`.
    pub fn new(robot: &Robot) -> Self {
        let (bodies, joints) = (robot.bodies().len(), robot.joints().len());
        let still = BodyState {
            angular_velocity: Vector3::zeros(),
            angular_acceleration: Vector3::zeros(),
            acceleration: Vector3::zeros(),
            wrench: Wrench::zero(),
        };
        Self {
            kinematics: Kinematics::new(robot),
            placed: vec![Placed::base(); bodies],
            bodies: vec![still; bodies],
            composites: vec![SpatialInertia::zero(); bodies],
            forces: vec![0.0; joints],
            efforts: vec![0.0; bodies],
            accelerations: vec![0.0; joints],
            still: vec![0.0; joints],
            mass: DMatrix::zeros(joints, joints),
            factor: DMatrix::zeros(joints, joints),
        }
    }

    /// Puts every body where `q` has it.
    fn place(&mut self, robot: &Robot, q: &[f64]) {
        assert_eq!(
            self.placed.len(),
            robot.steps.len(),
            "the workspace is for a robot of as many bodies"
        );
        assert_eq!(q.len(), self.forces.len(), "one position a joint");
        place(robot, q, &mut self.placed);
    }
}

fn place(robot: &Robot, q: &[f64], placed: &mut [Placed]) {
    for (i, step) in robot.steps.iter().enumerate().skip(1) {
        let (parent, frame) = (&placed[step.parent].rotation, step.frame(q));
        let rotation = parent * frame.rotation;
        placed[i] = Placed {
            arm: parent * frame.origin,
            axis: rotation * step.axis,
            inertia: step.inertia.turned(&rotation),
            rotation,
        };
    }
}

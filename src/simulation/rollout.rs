//! [`Rollout`]: what happened.

use std::fmt::Write as _;

use nalgebra::{DMatrix, DVector};

use crate::fourier::Joints;
use crate::robot::JointKind;

/// An executed motion: one row a time step, one column a joint of the robot. rad, rad/s, N m (m, m/s, N for prismatic joints).
#[derive(Debug, Clone, PartialEq)]
pub struct Rollout {
    /// The robot's joints.
    pub joints: Joints,
    /// Whether a joint's numbers are rad, rad/s and N m, or m, m/s and N.
    pub kinds: Vec<JointKind>,
    /// Time of each row \[s\].
    pub times: Vec<f64>,
    /// What was asked for.
    pub reference: DMatrix<f64>,
    /// What came.
    pub position: DMatrix<f64>,
    /// Its rates.
    pub velocity: DMatrix<f64>,
    /// What acted along the joint over the step that starts at the row: its motor and, at a position limit, its stop
    /// (the last row repeats the one before).
    pub torque: DMatrix<f64>,
    /// Steps in which that was at the effort limit of the motor or beyond, by joint.
    pub saturated: Vec<usize>,
}

impl Rollout {
    /// Root mean square of position less reference, by joint (D).
    pub fn rms_error(&self) -> DVector<f64> {
        let rows = self.times.len() as f64;
        self.error()
            .map_with_location(|_, _, e| e * e)
            .row_sum()
            .transpose()
            .map(|s| (s / rows).sqrt())
    }

    /// Largest |position - reference|, by joint (D).
    pub fn peak_error(&self) -> DVector<f64> {
        let error = self.error();
        DVector::from_iterator(error.ncols(), error.column_iter().map(|c| c.amax()))
    }

    /// Largest |torque|, by joint (D).
    pub fn peak_torque(&self) -> DVector<f64> {
        DVector::from_iterator(
            self.torque.ncols(),
            self.torque.column_iter().map(|c| c.amax()),
        )
    }

    fn error(&self) -> DMatrix<f64> {
        &self.position - &self.reference
    }

    /// A table: `time_s`, then for each joint its reference, position, velocity and torque.
    pub fn to_csv(&self) -> String {
        let mut text = String::from("time_s");
        for (joint, kind) in self.joints.iter().zip(&self.kinds) {
            let name = quoted(joint);
            let quantities = match kind {
                JointKind::Revolute => [
                    "reference_rad",
                    "position_rad",
                    "velocity_rad_s",
                    "torque_nm",
                ],
                JointKind::Prismatic => ["reference_m", "position_m", "velocity_m_s", "force_n"],
            };
            for quantity in quantities {
                let _ = write!(text, ",{}", name.replace("{}", quantity));
            }
        }
        text.push('\n');
        for (n, t) in self.times.iter().enumerate() {
            let _ = write!(text, "{t}");
            for j in 0..self.joints.len() {
                for series in [
                    &self.reference,
                    &self.position,
                    &self.velocity,
                    &self.torque,
                ] {
                    let _ = write!(text, ",{}", series[(n, j)]);
                }
            }
            text.push('\n');
        }
        text
    }
}

/// A column name `joint.{}`, quoted when the joint's name needs it.
fn quoted(joint: &str) -> String {
    if joint.contains(['"', ',', '\n', '\r']) {
        format!("\"{}.{{}}\"", joint.replace('"', "\"\""))
    } else {
        format!("{joint}.{{}}")
    }
}

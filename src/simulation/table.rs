//! A rollout as text.

use std::fmt::Write as _;

use super::Rollout;
use crate::robot::JointKind;

impl Rollout {
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

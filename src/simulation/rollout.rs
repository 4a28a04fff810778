//! [`Rollout`]: what happened.

use nalgebra::{DMatrix, DVector};

use super::{Energy, Event};
use crate::error::Result;
use crate::fourier::Joints;
use crate::motion::{Spline, StartPosture, Waypoint, Waypoints};
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
    /// What its motor gave over the step that starts at the row (the last row repeats the one before).
    pub torque: DMatrix<f64>,
    /// Steps in which that was at the effort limit of the motor or beyond, by joint.
    pub saturated: Vec<usize>,
    /// Where energy came from and went.
    pub energy: Energy,
    /// What joints ran into, by time.
    pub events: Vec<Event>,
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

    /// Largest |velocity|, by joint (D).
    pub fn peak_velocity(&self) -> DVector<f64> {
        let columns = self.velocity.column_iter();
        DVector::from_iterator(self.velocity.ncols(), columns.map(|c| c.amax()))
    }

    /// How far each joint was from the motion at most, between rows too \[rad, m\]: what a certificate of the motion is to allow for,
    /// if it is to hold for the way that the robot went ([`achieved`](Self::achieved)).
    ///
    /// Between two rows, the way is off their chord by 4/27 dt (|v - s| + |v' - s|) at most, s being the chord's slope; the motion, with a
    /// second derivative of r'', by r'' dt^2 / 8. Twice that is allowed for, since r'' dt^2 is taken from the second differences of rows.
    pub fn tolerance(&self) -> Vec<f64> {
        let error = self.error();
        let dt = self.times[1] - self.times[0];
        let series = self.position.column_iter().zip(self.velocity.column_iter());
        let tables = series.zip(self.reference.column_iter());
        let columns = tables.zip(error.column_iter());
        columns
            .map(|(((q, v), r), e)| {
                let mut off = 0.0_f64;
                for n in 0..q.len() - 1 {
                    let moved = q[n + 1] - q[n];
                    off = off.max((dt * v[n] - moved).abs() + (dt * v[n + 1] - moved).abs());
                }
                let bends = r.as_slice().windows(3);
                let bend = bends.map(|r| (r[0] - 2.0 * r[1] + r[2]).abs());
                e.amax() + 4.0 / 27.0 * off + 0.25 * bend.fold(0.0, f64::max)
            })
            .collect()
    }

    /// The way that the robot went, as a motion: cubic from row to row.
    ///
    /// # Errors
    /// When it is too long to be one.
    pub fn achieved(&self) -> Result<Spline> {
        let rows = |table: &DMatrix<f64>| table.transpose().as_slice().to_vec();
        let (positions, velocities) = (rows(&self.position), rows(&self.velocity));
        let joints = self.joints.len();
        let waypoints = self.times.iter().enumerate().map(|(n, time)| Waypoint {
            time: *time,
            positions: &positions[n * joints..][..joints],
            velocities: Some(&velocities[n * joints..][..joints]),
            accelerations: None,
        });
        let waypoints = Waypoints::new(self.joints.clone(), waypoints)?;
        Spline::new(&waypoints, StartPosture::Given)
    }

    fn error(&self) -> DMatrix<f64> {
        &self.position - &self.reference
    }
}

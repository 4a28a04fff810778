//! The same spline through more waypoints.

use super::{Degree, Spline};
use crate::error::Result;
use crate::motion::waypoints::{Rows, Waypoint, Waypoints};
use crate::motion::write::{segments, whole_nanoseconds};

impl Spline {
    /// The waypoints of this move and, between them, evenly as many more as leave no segment longer than 1 / `rate` \[Hz\]; times
    /// rounded to nanoseconds. They have what their segments interpolate, so a controller runs the same move by them, to rounding: linear,
    /// cubic and quintic where this is.
    ///
    /// # Errors
    /// When the rate is not above 0 and at most 1e6, or there would be more waypoints than [`Waypoints`] take.
    pub fn resampled(&self, rate: f64) -> Result<Waypoints> {
        let mut rows = Rows::new(self.joints.clone());
        for s in 0..self.segments() {
            let (start, length) = (self.knots[s], self.length(s));
            let n = segments(length, rate)?;
            // A knot has what the segment of the higher degree gives it.
            let first = s.checked_sub(1).filter(|b| self.order(*b) > self.order(s));
            match first {
                Some(before) => rows.push(self.values(before, 1.0, start).waypoint())?,
                None => rows.push(self.values(s, 0.0, start).waypoint())?,
            }
            for i in 1..n {
                let time = whole_nanoseconds(start + length * i as f64 / n as f64);
                rows.push(self.values(s, self.local(s, time), time).waypoint())?;
            }
        }
        let last = self.segments() - 1;
        rows.push(self.values(last, 1.0, self.knots[last + 1]).waypoint())?;
        rows.finish()
    }

    /// How many derivatives the ends of a segment have.
    fn order(&self, segment: usize) -> usize {
        match self.degrees[segment] {
            Degree::Linear => 0,
            Degree::Cubic => 1,
            Degree::Quintic => 2,
        }
    }

    fn values(&self, segment: usize, u: f64, time: f64) -> Values {
        let length = self.length(segment);
        let mut rows: [Vec<f64>; 3] = Default::default();
        for joint in 0..self.joints.len() {
            let b = self.piece(segment, joint).about(u);
            rows[0].push(b[0]);
            rows[1].push(b[1] / length);
            rows[2].push(2.0 * b[2] / (length * length));
        }
        Values {
            time: whole_nanoseconds(time),
            rows,
            order: self.order(segment),
        }
    }
}

/// A waypoint that owns its numbers.
struct Values {
    time: f64,
    rows: [Vec<f64>; 3],
    order: usize,
}

impl Values {
    fn waypoint(&self) -> Waypoint<'_> {
        let [positions, velocities, accelerations] = &self.rows;
        Waypoint {
            time: self.time,
            positions,
            velocities: (self.order > 0).then_some(velocities),
            accelerations: (self.order > 1).then_some(accelerations),
        }
    }
}

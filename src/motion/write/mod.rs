//! Writers of moves: waypoints of a motion, as text that the readers read back and as a log.

mod csv;
mod json;
mod mcap;
mod yaml;

use super::waypoints::{Rows, Waypoint};
use super::{Motion, Waypoints};
use crate::error::{Error, ErrorKind, Reason, Result};
use crate::fourier::State;

/// Nanoseconds in a second: the unit of time of messages.
const NANO: f64 = 1e9;

/// The most waypoints a second.
const FASTEST: f64 = 1e6;

/// A product of a duration and a rate is a whole number when it is one but for this share.
const WHOLE: f64 = 1e-9;

impl Waypoints {
    /// A motion as waypoints with velocities and accelerations: its duration divided evenly into as few segments as are no
    /// longer than 1 / `rate` \[Hz\], both ends included, times rounded to nanoseconds.
    ///
    /// The controller's quintics through them leave the motion by h^6 / 46080 of the sixth derivative at most, h the length of
    /// a segment (the remainder of Hermite interpolation). Positions alone leave it by h^2 / 8 of the second.
    /// Of a motion whose velocities or accelerations jump, such as some [`Spline`](super::Spline)s, this is another one there;
    /// [`Spline::resampled`](super::Spline::resampled) is not.
    ///
    /// ```
    /// use nalgebra::{dmatrix, dvector};
    /// use num_complex::Complex;
    /// use undulate::{Joints, Wave, Waypoints};
    /// # use undulate::{nalgebra, num_complex};
    ///
    /// let elbow = Joints::new(["elbow"])?;
    /// let wave = Wave::new(elbow, 2.0, dvector![0.3], dmatrix![Complex::new(0.1, 0.0)])?;
    /// let waypoints = Waypoints::sampled(&wave, 100.0)?;
    /// assert_eq!(waypoints.len(), 201);
    /// assert_eq!(waypoints.get(200).time, 2.0);
    /// # Ok::<(), undulate::Error>(())
    /// ```
    ///
    /// # Errors
    /// When the rate is not above 0 and at most 1e6, and those of [`Waypoints::new`]: a motion that is too long or too large.
    pub fn sampled<M: Motion>(motion: &M, rate: f64) -> Result<Self> {
        let duration = motion.duration();
        let segments = segments(duration, rate)?;
        let mut rows = Rows::new(motion.joints().clone());
        let mut state = State::zeros(motion.joints().len());
        for n in 0..=segments {
            let time = whole_nanoseconds(duration * n as f64 / segments as f64);
            motion.state_into(time.min(duration), &mut state);
            rows.push(Waypoint {
                time,
                positions: state.position.as_slice(),
                velocities: Some(state.velocity.as_slice()),
                accelerations: Some(state.acceleration.as_slice()),
            })?;
        }
        rows.finish()
    }

    /// What is written, unless it reads back as another move: not every format can hold every name and any size.
    fn held(&self, written: Vec<u8>, read: Result<Self>, format: &str) -> Result<Vec<u8>> {
        let read = read.map_err(|e| e.at(format!("as {format}")))?;
        if read.joints() == self.joints() && read.len() == self.len() {
            return Ok(written);
        }
        Err(Error::new(
            ErrorKind::Unsupported,
            format!("joints {} read back as others", self.joints().listed()),
        )
        .because(Reason::Unsupported)
        .expected("names without spaces at their ends that are no column of another kind")
        .help("write another format")
        .at(format!("as {format}")))
    }
}

/// The fewest equal segments of a `length` \[s\] that are no longer than 1 / `rate` \[Hz\].
pub(super) fn segments(length: f64, rate: f64) -> Result<usize> {
    if !(rate > 0.0 && rate <= FASTEST) {
        return Err(
            Error::new(ErrorKind::Setting, format!("a rate of {rate} Hz"))
                .because(Reason::OutOfRange)
                .expected(format!("more than 0 and at most {FASTEST:e}")),
        );
    }
    // There are fewer than a usize holds, or waypoints will say that they are too many.
    Ok(libm::ceil(length * rate * (1.0 - WHOLE)).max(1.0) as usize)
}

/// The nearest time of so many whole nanoseconds: what every format holds \[s\].
pub(super) fn whole_nanoseconds(t: f64) -> f64 {
    libm::round(t * NANO) / NANO
}

/// Seconds and nanoseconds of a waypoint's time, which is 0 at least.
fn seconds_and_nanoseconds(t: f64) -> (u64, u64) {
    let all = libm::round(t * NANO) as u64;
    (all / NANO as u64, all % NANO as u64)
}

//! [`Motion`]: what the robot side consumes, whether it comes from a Fourier series or from a recorded move.

mod polynomial;
mod read;
mod sequence;
mod spline;
mod wave;
mod waypoints;
mod write;

pub use read::{MoveOptions, PlayMotion};
pub use sequence::{Leg, Sequence, SequenceTube};
pub use spline::{Degree, Jump, Spline, SplineTube, StartPosture};
pub use wave::WaveTube;
pub use waypoints::{Waypoint, Waypoints};

use crate::fourier::{Derivative, Extremes, Interval, Joints, State};

/// Intervals that a [`Tube`] is asked about together: two vectors of four numbers, so that neither waits for the other, or one of eight.
pub const LANES: usize = 8;

/// A motion of a robot's joints over a stretch of time: a state at each instant, and rigorous bounds over intervals.
///
/// Time runs from 0 to [`duration`](Self::duration); a periodic motion is defined for every time and repeats.
pub trait Motion: Sync {
    /// Encloses the positions over intervals.
    type Tube<'a>: Tube
    where
        Self: 'a;

    /// The joints that move, in the order of every vector of numbers.
    fn joints(&self) -> &Joints;

    /// One period, or the time from start to end \[s\].
    fn duration(&self) -> f64;

    /// Whether the motion begins anew after its duration.
    fn is_periodic(&self) -> bool;

    /// Position to jerk at time `t` \[s\]. Panics when `state` was made for another number of joints.
    fn state_into(&self, t: f64, state: &mut State);

    /// An enclosure of a derivative of one joint over the whole motion, and when its ends are reached.
    fn extremes(&self, joint: usize, derivative: Derivative) -> Extremes;

    /// [`extremes`](Self::extremes) without the times.
    fn range(&self, joint: usize, derivative: Derivative) -> Interval {
        self.extremes(joint, derivative).range
    }

    /// What encloses the positions over intervals; made once for many of them.
    fn tube(&self) -> Self::Tube<'_>;
}

/// Encloses the positions of all joints over intervals of time.
pub trait Tube {
    /// Appends intervals (middle, half width) \[s\] that cover the motion from 0 to its duration without a gap and suit it: few
    /// enough to be quick, short enough that [`over_lanes`](Self::over_lanes) is tight. Neighbours share an end.
    fn pieces(&self, pieces: &mut Vec<(f64, f64)>);

    /// For each joint a position and a radius \[rad, m\] such that |q(t) - position| <= radius while |t - `middle`| <= `half` \[s\],
    /// and a few machine epsilons of the duration beyond, so that neighbours overlap whatever their ends were rounded to.
    ///
    /// The position is that at `middle`, as nearly as it can be computed; the radius covers what rounding does to it, and
    /// goes to it as `half` goes to 0.
    fn over(&mut self, middle: f64, half: f64, position: &mut [f64], radius: &mut [f64]);

    /// [`over`](Self::over) for several intervals at once: what is asked for in inner loops. Without more being known of a motion, it bends by
    /// all that it moves.
    fn over_lanes(&mut self, middle: &[f64; LANES], half: &[f64; LANES], rows: &mut TubeRows) {
        rows.one_by_one(self, middle, half);
    }
}

/// What is known of a motion on several intervals of time |t - middle| <= half, a row a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct TubeRows {
    /// In the middle \[rad, m\].
    pub position: Vec<[f64; LANES]>,
    /// |q(t) - position| is no more.
    pub radius: Vec<[f64; LANES]>,
    /// In the middle \[rad/s, m/s\].
    pub velocity: Vec<[f64; LANES]>,
    /// |q(t) - position - velocity (t - middle)| is no more \[rad, m\].
    pub bend: Vec<[f64; LANES]>,
    /// Room for what is known of a single interval.
    single: [Vec<f64>; 2],
}

impl TubeRows {
    /// For so many joints.
    pub fn new(joints: usize) -> Self {
        let zero = vec![[0.0; LANES]; joints];
        Self {
            position: zero.clone(),
            radius: zero.clone(),
            velocity: zero.clone(),
            bend: zero,
            single: [vec![0.0; joints], vec![0.0; joints]],
        }
    }

    /// What a tube says of one interval after the other.
    fn one_by_one<T: Tube + ?Sized>(
        &mut self,
        tube: &mut T,
        middle: &[f64; LANES],
        half: &[f64; LANES],
    ) {
        let Self {
            position,
            radius,
            velocity,
            bend,
            single: [q, r],
        } = self;
        for lane in 0..LANES {
            let before = lane.saturating_sub(1);
            let is_new = lane == 0 || [middle[lane], half[lane]] != [middle[before], half[before]];
            if is_new {
                tube.over(middle[lane], half[lane], q, r);
            }
            for joint in 0..q.len() {
                position[joint][lane] = q[joint];
                radius[joint][lane] = r[joint];
                velocity[joint][lane] = 0.0;
                bend[joint][lane] = r[joint];
            }
        }
    }
}

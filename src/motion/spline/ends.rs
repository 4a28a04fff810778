//! Where a spline is less smooth than its pieces: jumps at knots, and at the beginning and end.

use super::{Degree, Spline};
use crate::fourier::Derivative;

/// A derivative that changes at once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jump {
    /// When \[s\].
    pub time: f64,
    /// By how much, the later minus the earlier value \[rad/s, rad/s^2; m/s, m/s^2\].
    pub size: f64,
}

/// What the rounding of decimal numbers in a file may do to a derivative, in machine epsilons of its parts.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// A one-sided value of a derivative, and what rounding may have done to it.
#[derive(Clone, Copy)]
struct Side {
    value: f64,
    rounding: f64,
}

impl Spline {
    /// The largest jump of a joint's velocity or acceleration; `None` when it has none beyond the rounding of decimal
    /// numbers. Before and after a move that does not repeat the robot is at rest, so a start or end in motion is a jump.
    pub fn jump(&self, joint: usize, derivative: Derivative) -> Option<Jump> {
        let order = derivative.order();
        let rest = Side {
            value: 0.0,
            rounding: 0.0,
        };
        let last = self.segments() - 1;
        let mut largest: Option<Jump> = None;
        for knot in 0..=self.segments() {
            let (before, after) = match (knot.checked_sub(1), knot <= last) {
                (Some(s), true) => (Some(s), Some(knot)),
                _ if self.repeats && knot == 0 => (Some(last), Some(0)),
                // The end of a move that repeats was seen at its beginning.
                _ if self.repeats => continue,
                (before, inside) => (before, inside.then_some(knot)),
            };
            if let (Some(a), Some(b)) = (before, after)
                && knot > 0
                && self.shares(a, order)
                && self.shares(b, order)
            {
                continue;
            }
            let a = before.map_or(rest, |s| self.side(s, joint, order, 1.0));
            let b = after.map_or(rest, |s| self.side(s, joint, order, 0.0));
            let size = b.value - a.value;
            if size.abs() > a.rounding + b.rounding
                && largest.is_none_or(|l| size.abs() > l.size.abs())
            {
                largest = Some(Jump {
                    time: self.knots[knot],
                    size,
                });
            }
        }
        largest
    }

    /// Whether a segment takes the derivative from its waypoints, and so shares it with its neighbours that do.
    fn shares(&self, segment: usize, order: i32) -> bool {
        match self.degrees[segment] {
            Degree::Linear => order < 1,
            Degree::Cubic => order < 2,
            Degree::Quintic => order < 3,
        }
    }

    fn side(&self, segment: usize, joint: usize, order: i32, u: f64) -> Side {
        let length = self.length(segment);
        let piece = self.piece(segment, joint);
        let p = piece.derivative(order, length);
        // Positions and times were rounded when they were read: by parts of their own size, not of their differences.
        let scale = piece.0.iter().map(|c| c.abs()).sum::<f64>() / length.powi(order);
        let late = self.knots[segment + 1] / length;
        let slope = p.0.iter().map(|c| c.abs()).sum::<f64>();
        Side {
            value: p.value(u),
            rounding: ROUNDING * (scale + late * slope),
        }
    }

    /// What a controller may not like of this move, in words: it starts from rest, and comes to rest when the move ends.
    pub fn notes(&self) -> Vec<String> {
        if self.repeats {
            return Vec::new();
        }
        let mut notes = Vec::new();
        for (joint, name) in self.joints.iter().enumerate() {
            for (segment, u, when) in [(0, 0.0, "starts"), (self.segments() - 1, 1.0, "ends")] {
                let side = self.side(segment, joint, 1, u);
                if side.value.abs() > side.rounding && self.degrees[segment] != Degree::Linear {
                    notes.push(format!(
                        "the move {when} with joint `{name}` at {} a second; a controller is at rest then",
                        side.value
                    ));
                }
            }
        }
        notes
    }
}

//! [`CaptureNote`]: what a user should know of a captured motion, and what stops nothing.

use std::fmt;

use crate::anatomy::ShoulderOrder;

/// What a user should know of a captured motion, and what stops nothing. Its text is one line.
#[derive(Debug, Clone, PartialEq)]
pub enum CaptureNote {
    /// The upper arm comes near to where the order of the shoulder's angles is singular: cosines of its middle angle at the
    /// nearest, 0 where it is singular, of this order and of the other.
    Singular {
        /// The order that was taken.
        order: ShoulderOrder,
        /// Of this order.
        nearest: f64,
        /// Of the other.
        other: f64,
    },
    /// Frames that repeat the one before them.
    Frozen {
        /// All of them.
        frames: usize,
        /// The longest row \[s\].
        longest: f64,
        /// When it begins \[s\].
        at: f64,
    },
    /// No sample for longer than the samples' distance.
    Gap {
        /// How many there are.
        gaps: usize,
        /// The longest \[s\].
        longest: f64,
        /// When it begins \[s\].
        at: f64,
    },
    /// The elbow was too straight for its plane to say how the upper arm is turned about itself, which is carried on from where it could be told.
    Straight {
        /// Samples without an own plane.
        samples: usize,
        /// Of so many.
        of: usize,
    },
    /// The elbow never bends enough to say about which axis: the rotation's zero is that of the skeleton's T-pose.
    NoHinge,
}

impl fmt::Display for CaptureNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Singular {
                order,
                nearest,
                other,
            } => {
                let [own, others] = [nearest, other].map(|cosine| libm::acos(*cosine).to_degrees());
                let order_of_others = order.other();
                write!(
                    f,
                    "the upper arm comes within {:.0} deg of where order {order} is singular: its angles there are faster than the arm",
                    90.0 - own
                )?;
                if other > nearest {
                    write!(f, "; {order_of_others} stays {:.0} deg away", 90.0 - others)
                } else {
                    write!(f, ", and {order_of_others} is no better")
                }
            }
            Self::Frozen {
                frames,
                longest,
                at,
            } => write!(
                f,
                "{frames} frames repeat the one before; the longest row is {longest:.2} s, from {at:.2} s on"
            ),
            Self::Gap { gaps, longest, at } => write!(
                f,
                "{gaps} gaps; the longest is {longest:.2} s, from {at:.2} s on"
            ),
            Self::Straight { samples, of } => write!(
                f,
                "the elbow is straight in {samples} of {of} samples: shoulder_rotation is carried on there"
            ),
            Self::NoHinge => f.write_str(
                "the elbow hardly bends: shoulder_rotation counts from the skeleton's T-pose, not from the axis of the elbow",
            ),
        }
    }
}

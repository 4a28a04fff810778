//! Motion capture: the rotations of a skeleton's bones, or positions of shoulder, elbow and hand, to the angles of an arm.

mod arm;
mod branch;
mod bvh;
mod known;
mod note;
mod positions;
mod segments;
mod skeleton;

pub use arm::{ArmMotion, Captured};
pub use bvh::Bvh;
pub use note::CaptureNote;
pub use positions::PositionOptions;
pub use skeleton::{BoneMap, Side};

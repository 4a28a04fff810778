//! Wave gestures for robots.
mod document;
pub mod error;
pub mod units;
pub mod demonstration;
pub mod fourier;
pub mod geometry;
pub mod primitive;
#[cfg(feature="robot")]
pub mod robot;
#[cfg(feature="robot")]
pub mod retarget;
#[cfg(feature="robot")]
pub mod collision;
#[cfg(feature="robot")]
pub mod feasibility;
#[cfg(feature="simulation")]
pub mod simulation;

pub use demonstration::*;
pub use error::{Error, ErrorKind, Result};
pub use fourier::*;
pub use primitive::*;
pub use robot::*;
pub use retarget::*;
pub use collision::*;
pub use feasibility::*;pub use simulation::*;
#[cfg(feature="robot")]
pub mod shipped;

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

pub use demonstration::*;
pub use error::{Error, ErrorKind, Result};
pub use fourier::*;
pub use primitive::*;
pub use robot::*;

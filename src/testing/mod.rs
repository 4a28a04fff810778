//! Strategies and statistical assertions for property tests (feature `testing`).
//!
//! Wrong arguments (a probability outside 0..1, too few samples to mean anything) panic and name the argument: they are
//! mistakes in a test, not input.

mod statistics;
mod strategy;
mod urdf;

pub use statistics::{Alarm, gaussian};
pub use strategy::{gaussians, primitives, waves};
pub use urdf::trees;

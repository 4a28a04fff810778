//! Execution of a wave by a simulated robot: a Rapier multibody in f64 behind computed-torque motors.

mod rollout;
mod track;
mod world;

pub use rollout::Rollout;
pub use track::{TrackOptions, track};
pub use world::MultibodyWorld;

//! Strategies: what proptest draws. One file a concept.

#[cfg(feature = "robot")]
mod arm;
#[cfg(feature = "robot")]
mod configuration;
mod covariance;
mod demonstration;
mod drawn;
mod gaussian;
mod hostile;
mod latent;
#[cfg(feature = "robot")]
mod moves;
mod observation;
mod primitive;
#[cfg(feature = "robot")]
mod scene;
mod tree;
mod wave;

#[cfg(feature = "robot")]
pub use arm::{Arm, arms};
#[cfg(feature = "robot")]
pub use configuration::configurations;
pub use covariance::{covariances, factors};
pub use demonstration::demonstrations;
pub use drawn::{DrawnWave, waves_of};
pub use gaussian::gaussians;
pub use hostile::{Hostile, hostile, hostile_bytes};
#[cfg(feature = "robot")]
pub use moves::{Format, moves, waypoints};
pub use observation::observations;
pub use primitive::primitives;
#[cfg(feature = "robot")]
pub use scene::{scene_texts, scenes};
pub use tree::trees;
pub use wave::waves;

//! Execution of a motion by a simulated robot: two plants of different making behind one controller.

mod controller;
mod drive;
mod energy;
mod event;
mod impulses;
mod loads;
mod observer;
mod options;
mod plant;
mod rapier;
mod rollout;
mod run;
mod runge_kutta;
mod semi_implicit;
mod stability;
mod table;
mod world;

pub use energy::Energy;
pub use event::{Event, EventKind};
pub use options::{Control, Payload, Plant, Push, Pushed, SimulationOptions};
pub use rollout::Rollout;
pub use run::Simulation;
pub use world::MultibodyWorld;

//! Pictures, as bytes: plots as SVG and PNG, robots as PNG.

mod axis;
mod bands;
mod canvas;
mod comparison;
mod font;
mod frame;
mod image;
mod inspection;
mod legend;
mod plot;
mod trace;
mod waves;

#[cfg(feature = "robot")]
mod camera;
#[cfg(feature = "robot")]
mod clearance;
#[cfg(feature = "robot")]
mod ground;
#[cfg(feature = "robot")]
mod layer;
#[cfg(feature = "robot")]
mod poses;
#[cfg(feature = "robot")]
mod ray;
#[cfg(feature = "robot")]
mod robot_view;
#[cfg(feature = "robot")]
mod tube;

pub use bands::bands;
#[cfg(feature = "robot")]
pub use clearance::{ClearanceCourse, clearance};
pub use comparison::comparison;
pub use image::{Color, Image, MAX_PIXELS, MAX_SIDE};
pub use inspection::{inspection, inspection_svg};
pub use plot::{Mark, Picture, Plot, Series, draw};
#[cfg(feature = "robot")]
pub use poses::Poses;
pub use waves::{Labelled, spectra, trajectories};

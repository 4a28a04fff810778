//! Shapes of links: primitives, convex hulls, meshes, and the distance between two of them.

mod convex;
pub mod distance;
mod enclosing;
mod shape;

pub use convex::{Convex, Placed, Placement};
pub use enclosing::{Ball, BoundingCapsule};
pub use shape::{Shape, Solid};

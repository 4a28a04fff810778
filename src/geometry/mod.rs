//! Shapes of links: primitives, convex hulls, meshes, and the distance between two of them.

mod shape;

pub use shape::{Shape, Solid};

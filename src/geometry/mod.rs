//! Shapes of links: primitives, convex hulls, meshes, and the distance between two of them.

mod bounds;
mod hull;
mod mesh;
mod shape;

pub use hull::Hull;
pub use mesh::Mesh;
pub use shape::{Shape, Solid};

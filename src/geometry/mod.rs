//! Shapes of links: primitives, convex hulls, meshes, and the distance between two of them.

mod bounds;
mod decomposition;
mod enclosure;
mod hull;
mod mesh;
mod shape;

pub use decomposition::Decomposition;
pub use enclosure::Enclosure;
pub use hull::Hull;
pub use mesh::Mesh;
pub use shape::{Shape, Solid};

//! Shapes of links: primitives, convex hulls, meshes, and the distance between two of them.

mod bounds;
mod convex;
mod decomposition;
mod distance;
mod enclosing;
mod enclosure;
mod hull;
mod mesh;
mod shape;

pub use convex::{Convex, Placed, Placement};
pub use decomposition::Decomposition;
pub use distance::{
    HalfSpace, Separation, SignedDistance, Warm, intersects, rough_separation, separation,
    signed_distance,
};
pub(crate) use distance::{separation_until, separation_with, signed_distance_with};
pub use enclosing::{Ball, BoundingCapsule};
pub use enclosure::Enclosure;
pub use hull::Hull;
pub use mesh::Mesh;
pub use shape::{Shape, Solid};

//! What a caller decides about the reading of a robot.

use std::path::PathBuf;

use crate::geometry::{Decomposition, Enclosure};

/// How a robot is read. The default reads no mesh files and changes nothing.
#[derive(Debug, Clone, Default)]
pub struct LoadOptions {
    /// Where the meshes are that the URDF names.
    pub meshes: MeshFiles,
    /// What becomes of inertias that no body has.
    pub inertia: Inconsistent,
    /// How meshes become convex.
    pub convex: MeshConvex,
    /// Whether to measure how closely hulls enclose their meshes, up to a second each:
    /// [`Robot::enclosures`](crate::Robot::enclosures).
    pub measure: bool,
    /// The link at the end of the chain that matters. Default: the end of the longest chain.
    pub tip: Option<String>,
}

/// Where mesh files are looked for. No path leads out of these places, whatever links and `..` it holds.
#[derive(Debug, Clone, Default)]
pub enum MeshFiles {
    /// Nowhere: links with meshes have no collision geometry that is known.
    #[default]
    None,
    /// In folders, the first first. `package://X/y` is y in a folder of the name X, or X/y in any other;
    /// relative paths are as they stand; `file://` and absolute paths must lie in one of the folders, or else the longest
    /// end of the path that exists in one is taken, and said in the notes.
    Folders(Vec<PathBuf>),
    /// In the program: path and content. `package://X/y` is X/y, or y.
    Embedded(&'static [(&'static str, &'static [u8])]),
}

/// What becomes of inertias that no body has: not positive semidefinite, or against the triangle inequality.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Inconsistent {
    /// Not positive semidefinite is an error, and against the triangle inequality one of
    /// [`require_dynamics`](crate::Robot::require_dynamics): kinematics and collision need no inertia.
    #[default]
    Refuse,
    /// The nearest consistent inertia is put in its place, and said in the notes.
    Mend,
}

/// How a mesh becomes convex.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum MeshConvex {
    /// One convex hull: encloses the mesh, and fills what is hollow.
    #[default]
    Hull,
    /// Several hulls that together enclose the mesh, and leave more of what is hollow free.
    Parts(Decomposition),
}

/// How closely the hulls of a mesh enclose it.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshEnclosure {
    /// The mesh's name in the URDF.
    pub mesh: String,
    /// How many hulls.
    pub hulls: usize,
    /// Volume and largest gap.
    pub enclosure: Enclosure,
}

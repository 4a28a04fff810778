//! Mesh files of a robot: found, read within a budget, and made convex.

pub(super) mod paths;

use std::collections::HashMap;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use nalgebra::{Point3, Vector3};

use self::paths::{Roots, embedded, shown};
use super::load::{LoadOptions, MeshConvex, MeshEnclosure, MeshFiles};
use crate::error::{Error, ErrorKind, Result};
use crate::geometry::{Hull, Mesh, Shape};

/// Bytes of one mesh file: in memory a mesh takes a few times as much.
const LARGEST_FILE: u64 = 16 << 20;

/// Bytes read for one robot: a file is read again for each scale.
const MOST_BYTES: u64 = 256 << 20;

/// Corners of all hulls of one robot.
const MOST_CORNERS: usize = 400_000;

/// Vertices of a mesh that are enclosed at a time.
const PIECE: usize = 1 << 16;

/// Corners that the pieces of one mesh may have together.
const MOST_OF_ONE: usize = 200_000;

/// Pairs of name and scale that are looked for.
const MOST_MESHES: usize = 4096;

/// Shapes, or why there are none: collision is refused, kinematics are not.
type Outcome = std::result::Result<Vec<Shape>, String>;

/// The meshes of one robot.
pub(super) struct Meshes<'a> {
    options: &'a LoadOptions,
    roots: Roots,
    /// By name and the bits of the scale.
    known: HashMap<(String, [u64; 3]), Outcome>,
    bytes: u64,
    corners: usize,
    notes: Vec<String>,
    enclosures: Vec<MeshEnclosure>,
}

/// Where a mesh was found.
enum Source {
    File(PathBuf),
    Program(&'static [u8]),
}

impl<'a> Meshes<'a> {
    pub fn new(options: &'a LoadOptions) -> Result<Self> {
        let folders = match &options.meshes {
            MeshFiles::Folders(folders) => folders.as_slice(),
            MeshFiles::None | MeshFiles::Embedded(_) => &[],
        };
        Ok(Self {
            options,
            roots: Roots::new(folders)?,
            known: HashMap::new(),
            bytes: 0,
            corners: 0,
            notes: Vec::new(),
            enclosures: Vec::new(),
        })
    }

    /// What is told of names that were not found as they stand, and what was measured.
    pub fn finish(self) -> (Vec<String>, Vec<MeshEnclosure>) {
        (self.notes, self.enclosures)
    }

    /// The convex shapes of the mesh that is called `name` in the URDF, stretched by `scale`.
    ///
    /// # Errors
    /// When the file was read and contradicts itself, or the robot's meshes are beyond the budget.
    pub fn shapes(&mut self, name: &str, scale: &Vector3<f64>) -> Result<Outcome> {
        let key = (name.to_owned(), (*scale).map(f64::to_bits).into());
        if let Some(known) = self.known.get(&key) {
            return Ok(known.clone());
        }
        if self.known.len() >= MOST_MESHES {
            return Err(beyond(format!("more than {MOST_MESHES} meshes")));
        }
        let outcome = match self.source(name) {
            Err(why) => Err(why),
            Ok(source) => self.read(&source, name, scale)?,
        };
        self.known.insert(key, outcome.clone());
        Ok(outcome)
    }

    fn source(&mut self, name: &str) -> std::result::Result<Source, String> {
        match &self.options.meshes {
            MeshFiles::None => Err("no folder for meshes is given".to_owned()),
            MeshFiles::Embedded(files) => embedded(files, name)
                .map(Source::Program)
                .ok_or_else(|| "it is not in the program".to_owned()),
            MeshFiles::Folders(_) => {
                let found = self.roots.find(name)?;
                if found.by_end {
                    self.notes.push(format!(
                        "mesh {}: {} is taken for it, the longest end of the path that is there",
                        shown(name),
                        shown(&found.path.display().to_string())
                    ));
                }
                Ok(Source::File(found.path))
            }
        }
    }

    fn read(&mut self, source: &Source, name: &str, scale: &Vector3<f64>) -> Result<Outcome> {
        let read = match source {
            Source::Program(bytes) => Mesh::read(&shown(name), bytes),
            Source::File(path) => match self.content(path)? {
                Ok(bytes) => Mesh::read(&shown(name), &bytes),
                Err(why) => return Ok(Err(why)),
            },
        };
        let mesh = match read {
            Ok(mesh) => mesh,
            Err(e) if e.kind() == ErrorKind::Unsupported => return Ok(Err(e.what().to_owned())),
            Err(e) => return Err(e),
        };
        let made = match (&self.options.convex, self.options.measure) {
            (MeshConvex::Hull, false) => hull(mesh, scale).map(|hull| vec![hull]),
            (convex, measure) => stretched(mesh, scale).and_then(|mesh| {
                let hulls = match convex {
                    MeshConvex::Hull => vec![mesh.hull()?],
                    MeshConvex::Parts(settings) => mesh.decomposed(settings)?,
                };
                if measure {
                    self.enclosures.push(MeshEnclosure {
                        mesh: name.to_owned(),
                        hulls: hulls.len(),
                        enclosure: mesh.enclosure(&hulls),
                    });
                }
                Ok(hulls)
            }),
        };
        let hulls = match made {
            Ok(hulls) => hulls,
            Err(e) => return Ok(Err(e.to_string())),
        };
        self.corners += hulls.iter().map(|h| h.vertices().len()).sum::<usize>();
        if self.corners > MOST_CORNERS {
            return Err(beyond(format!("hulls of more than {MOST_CORNERS} corners")));
        }
        let shape = |hull| Shape::Hull(Arc::new(hull));
        Ok(Ok(hulls.into_iter().map(shape).collect()))
    }

    /// The content of a file, or why it has none.
    fn content(&mut self, path: &Path) -> Result<std::result::Result<Vec<u8>, String>> {
        let mut bytes = Vec::new();
        let read = File::open(path).and_then(|file| {
            // It may have become another since it was looked at.
            if !file.metadata()?.is_file() {
                return Err(std::io::Error::other("it is no regular file"));
            }
            file.take(LARGEST_FILE + 1).read_to_end(&mut bytes)
        });
        if let Err(e) = read {
            return Ok(Err(e.to_string()));
        }
        if bytes.len() as u64 > LARGEST_FILE {
            return Ok(Err(format!("it is larger than {} MB", LARGEST_FILE >> 20)));
        }
        self.bytes += bytes.len() as u64;
        if self.bytes > MOST_BYTES {
            return Err(beyond(format!(
                "more than {} MB of meshes",
                MOST_BYTES >> 20
            )));
        }
        Ok(Ok(bytes))
    }
}

fn beyond(what: String) -> Error {
    Error::new(ErrorKind::Value, what)
        .expected("what a robot needs")
        .help("simplify the collision meshes")
}

fn stretched(mesh: Mesh, scale: &Vector3<f64>) -> Result<Mesh> {
    match *scale == Vector3::repeat(1.0) {
        true => Ok(mesh),
        false => mesh.scaled(scale),
    }
}

/// The hull of a stretched mesh. The hull of hulls is the hull of all: large meshes are enclosed piece by piece, which
/// takes memory for a piece and for the corners of the whole, not for all that lies inside.
fn hull(mesh: Mesh, scale: &Vector3<f64>) -> Result<Hull> {
    let corner = |v: &Point3<f64>| Point3::from(v.coords.component_mul(scale));
    let mut corners: Vec<Point3<f64>> = mesh.vertices().iter().map(corner).collect();
    drop(mesh);
    if corners.len() > PIECE {
        let mut kept = Vec::new();
        for piece in corners.chunks(PIECE) {
            kept.extend_from_slice(Hull::new(piece)?.vertices());
            if kept.len() > MOST_OF_ONE {
                let what = format!("a hull of more than {MOST_OF_ONE} corners");
                return Err(Error::new(ErrorKind::Value, what)
                    .expected("a mesh that is simple enough to collide with"));
            }
        }
        corners = kept;
    }
    Hull::new(&corners)
}

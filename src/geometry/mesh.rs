//! Triangle meshes, as files hold them.

mod obj;
mod stl;

use std::collections::HashMap;

use nalgebra::{Point3, Vector3};

use super::hull::{self, Hull};
use crate::error::{Error, ErrorKind, Result};

/// Triangles in space: at least one, every vertex belonging to one, no two vertices equal, coordinates finite and within
/// 1000 km. Nothing else is promised: it may be open, inside out, flat, or have triangles without area.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    vertices: Vec<Point3<f64>>,
    triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// A mesh of `vertices` \[m\] and `triangles` of indices into them; equal vertices become one, and those of no triangle go.
    ///
    /// # Errors
    /// No triangles, an index beyond the vertices, or a coordinate that is not finite or beyond 1e6 m.
    pub fn new(vertices: &[Point3<f64>], triangles: &[[u32; 3]]) -> Result<Self> {
        let mut builder = Builder::default();
        for (n, triangle) in triangles.iter().enumerate() {
            let mut corners = [Point3::origin(); 3];
            for (corner, index) in corners.iter_mut().zip(triangle) {
                *corner = *vertices.get(*index as usize).ok_or_else(|| {
                    Error::new(ErrorKind::Shape, format!("no vertex {index}"))
                        .expected(format!("less than {}", vertices.len()))
                        .at(format!("triangle {}", n + 1))
                })?;
            }
            builder
                .push(&corners)
                .map_err(|e| e.at(format!("triangle {}", n + 1)))?;
        }
        builder.finish()
    }

    /// The mesh in a file called `name`, by its extension: `.stl` or `.obj`, in metres.
    ///
    /// # Errors
    /// Other formats; else as [`from_stl`](Self::from_stl) and [`from_obj`](Self::from_obj).
    pub fn read(name: &str, bytes: &[u8]) -> Result<Self> {
        let extension = name.rsplit_once('.').map_or("", |(_, extension)| extension);
        match extension.to_ascii_lowercase().as_str() {
            "stl" => Self::from_stl(bytes),
            "obj" => Self::from_obj(bytes),
            _ => Err(Error::new(
                ErrorKind::Unsupported,
                format!("a mesh of format `{}`", crate::error::listed(&[extension])),
            )
            .expected("STL or OBJ")
            .help("export it as STL or OBJ")),
        }
        .map_err(|e| e.at(name))
    }

    /// The mesh in a file of STL, binary or text, in metres.
    ///
    /// A file whose length is that of the triangles it says it has is binary, also if it begins with `solid`; one that begins
    /// with `solid` is text otherwise. After the triangles of a binary file fewer bytes than a triangle has (50) are allowed and
    /// not read: some programs append a line break or padding. A whole triangle more, or one too few, is an error: what
    /// is missing would not be collided with. Normals and attributes are not read.
    ///
    /// # Errors
    /// Another number of triangles than the file says, text that is not STL, no triangles, or a coordinate that is not finite or
    /// beyond 1e6 m, with the number of triangle or line.
    pub fn from_stl(bytes: &[u8]) -> Result<Self> {
        stl::read(bytes)
    }

    /// The mesh in a file of OBJ, in metres: `v` and `f`, indices from 1 or back from the end (-1), polygons as fans about their
    /// first corner. Other statements are not read, nor are texture coordinates and normals.
    ///
    /// # Errors
    /// Numbers that are none, faces of fewer than three corners or of vertices not given before, no faces, or a coordinate that
    /// is not finite or beyond 1e6 m, with the line.
    pub fn from_obj(bytes: &[u8]) -> Result<Self> {
        obj::read(bytes)
    }

    /// \[m\], each of a triangle, no two equal.
    pub fn vertices(&self) -> &[Point3<f64>] {
        &self.vertices
    }

    /// Indices into the vertices, counterclockwise from outside in a sound file. Two may be equal.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The mesh stretched by `scale` along x, y, z. A mirrored one is turned back, so that outside stays outside.
    ///
    /// # Errors
    /// Scales of 0, or that lead out of the range of coordinates.
    pub fn scaled(&self, scale: &Vector3<f64>) -> Result<Self> {
        if scale.iter().any(|s| *s == 0.0 || !s.is_finite()) {
            return Err(Error::new(
                ErrorKind::Value,
                format!("a scale of {}, {}, {}", scale.x, scale.y, scale.z),
            )
            .expected("three finite numbers other than 0"));
        }
        let vertices: Vec<_> = self
            .vertices
            .iter()
            .map(|v| Point3::from(v.coords.component_mul(scale)))
            .collect();
        let mirrored = scale.product() < 0.0;
        let triangles: Vec<_> = self
            .triangles
            .iter()
            .map(|&[a, b, c]| if mirrored { [a, c, b] } else { [a, b, c] })
            .collect();
        Self::new(&vertices, &triangles)
            .map_err(|e| e.help("check the scale: meshes in millimetres have 0.001"))
    }

    /// The convex hull of all triangles. Which way round these are, and whether they close, does not matter to it.
    ///
    /// # Errors
    /// As [`Hull::new`], when it would take too long.
    pub fn hull(&self) -> Result<Hull> {
        Hull::new(&self.vertices)
    }

    /// The enclosed volume \[m^3\], negative inside out; of no meaning when the mesh is not closed.
    pub fn signed_volume(&self) -> f64 {
        hull::volume(&self.vertices, &self.triangles)
    }

    /// Whether every edge is passed once in each direction: then there is an inside. Triangles with a corner twice do not count.
    pub fn is_closed(&self) -> bool {
        let proper = self
            .triangles
            .iter()
            .filter(|[a, b, c]| a != b && b != c && c != a);
        let proper: Vec<_> = proper.copied().collect();
        !proper.is_empty() && hull::is_paired(&proper)
    }

    /// Whether it is closed and its triangles are clockwise from outside: a mirrored or faulty export. Hulls do not care.
    pub fn is_inside_out(&self) -> bool {
        self.is_closed() && self.signed_volume() < 0.0
    }
}

/// Collects triangles and makes equal vertices one.
#[derive(Default)]
struct Builder {
    /// By the bits of the coordinates. Never iterated over: its order is not always the same.
    numbers: HashMap<[u64; 3], u32>,
    vertices: Vec<Point3<f64>>,
    triangles: Vec<[u32; 3]>,
}

impl Builder {
    fn push(&mut self, corners: &[Point3<f64>; 3]) -> Result<()> {
        let mut triangle = [0; 3];
        for (index, corner) in triangle.iter_mut().zip(corners) {
            check(corner)?;
            // -0 becomes 0.
            let corner = corner.map(|x| x + 0.0);
            let next = u32::try_from(self.vertices.len())
                .map_err(|_| Error::new(ErrorKind::Infeasible, "more than 2^32 vertices"))?;
            *index = *self
                .numbers
                .entry([corner.x, corner.y, corner.z].map(f64::to_bits))
                .or_insert(next);
            if *index == next {
                self.vertices.push(corner);
            }
        }
        self.triangles.push(triangle);
        Ok(())
    }

    fn finish(self) -> Result<Mesh> {
        if self.triangles.is_empty() {
            return Err(Error::new(ErrorKind::Shape, "no triangles").expected("at least one"));
        }
        Ok(Mesh {
            vertices: self.vertices,
            triangles: self.triangles,
        })
    }
}

fn check(point: &Point3<f64>) -> Result<()> {
    if point.iter().all(|x| x.abs() <= hull::FARTHEST) {
        Ok(())
    } else {
        Err(hull::out_of_range(point))
    }
}

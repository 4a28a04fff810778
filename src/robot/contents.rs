//! What a link brings to its body: mass and inertia, shapes that collide, shapes to be drawn.

use std::collections::HashMap;

use nalgebra::{Isometry3, Vector3};
use urdf_rs::Geometry;

use super::build::isometry;
use super::inertia::{self, Fault};
use super::lint::Doubtful;
use super::load::Inconsistent;
use super::meshes::{Meshes, paths};
use super::{Body, Inertial};
use crate::error::{Error, ErrorKind, Result, listed};
use crate::geometry::{Shape, Solid};

/// All that links are read with.
pub(super) struct Contents<'a> {
    /// By the names of materials.
    pub colors: HashMap<&'a str, [f32; 3]>,
    /// Links whose inertia no body has.
    pub doubtful: &'a Doubtful,
    pub inconsistent: Inconsistent,
    pub meshes: Meshes<'a>,
    pub notes: Vec<String>,
}

impl<'a> Contents<'a> {
    /// Adds a link to its body; `frame` is the link's in the body's.
    pub fn add(
        &mut self,
        body: &mut Body,
        (index, link): (usize, &urdf_rs::Link),
        frame: &Isometry3<f64>,
    ) -> Result<()> {
        let here = |e: Error| e.at(format!("link `{}`", listed(&[&link.name])));
        if let Some(inertial) = self.inertial(link, frame).map_err(here)? {
            body.inertial = Some(match body.inertial.take() {
                None => inertial,
                Some(other) => other.joined(&inertial),
            });
        }
        if let Some(told) = self.doubtful.get(&link.name) {
            body.doubtful_inertia.push(told.clone());
        }
        let solid = |origin: &urdf_rs::Pose, shape, color| Solid {
            shape,
            pose: frame * isometry(origin),
            link: index,
            color,
        };
        let before = body.collision.len();
        for collision in &link.collision {
            match primitive(&collision.geometry) {
                Ok(shape) => body.collision.push(solid(&collision.origin, shape, None)),
                Err((name, scale)) => match self.meshes.shapes(name, &scale).map_err(here)? {
                    Ok(shapes) => body.collision.extend(
                        shapes
                            .into_iter()
                            .map(|shape| solid(&collision.origin, shape, None)),
                    ),
                    Err(why) => body.unread_collision.push(format!(
                        "link `{}`: mesh {}: {why}",
                        link.name,
                        paths::shown(name)
                    )),
                },
            }
        }
        let visible = body.visual.len();
        for visual in &link.visual {
            let color = visual.material.as_ref().and_then(|m| {
                m.color
                    .as_ref()
                    .map(rgb)
                    .or_else(|| self.colors.get(m.name.as_str()).copied())
            });
            match primitive(&visual.geometry) {
                Ok(shape) => body.visual.push(solid(&visual.origin, shape, color)),
                // A mesh that collides too is read already; none is read for its looks alone.
                Err(mesh) if collides(link, mesh) => {
                    if let Ok(shapes) = self.meshes.shapes(mesh.0, &mesh.1).map_err(here)? {
                        let drawn = shapes
                            .into_iter()
                            .map(|shape| solid(&visual.origin, shape, color));
                        body.visual.extend(drawn);
                    }
                }
                Err(_) => {}
            }
        }
        if body.visual.len() == visible {
            body.visual.extend_from_slice(&body.collision[before..]);
        }
        Ok(())
    }

    /// The inertial of a link in the frame of its body; `None` when it has no mass.
    fn inertial(
        &mut self,
        link: &urdf_rs::Link,
        frame: &Isometry3<f64>,
    ) -> Result<Option<Inertial>> {
        let mass = link.inertial.mass.value;
        let i = &link.inertial.inertia;
        if mass <= 0.0 {
            if mass < 0.0 || i.ixx != 0.0 {
                self.notes.push(format!(
                    "link `{}`: a mass of {mass} kg is left out",
                    link.name
                ));
            }
            return Ok(None);
        }
        let mut tensor = inertia::tensor([i.ixx, i.ixy, i.ixz, i.iyy, i.iyz, i.izz]);
        match (inertia::fault(&tensor), self.inconsistent) {
            (Some(fault), Inconsistent::Mend) => {
                let mended = inertia::mended(&tensor);
                self.notes.push(format!(
                    "link `{}`: {}; mended to the nearest that one has, by {:.1e} kg m^2",
                    link.name,
                    fault.told(),
                    (mended - tensor).norm()
                ));
                tensor = mended;
            }
            (Some(fault @ Fault::Indefinite(_)), Inconsistent::Refuse) => {
                return Err(Error::new(ErrorKind::Value, fault.told()));
            }
            (Some(Fault::Triangle(_)), Inconsistent::Refuse) => {
                if let Some(told) = self.doubtful.get(&link.name) {
                    self.notes.push(told.clone());
                }
            }
            (None, _) => {}
        }
        let pose = frame * isometry(&link.inertial.origin);
        let rotation = pose.rotation.to_rotation_matrix().into_inner();
        Ok(Some(Inertial {
            mass,
            center: pose.translation.vector,
            inertia: rotation * tensor * rotation.transpose(),
        }))
    }
}

/// The shape, or the name and scale of the mesh that it is instead.
fn primitive(geometry: &Geometry) -> std::result::Result<Shape, (&str, Vector3<f64>)> {
    match geometry {
        Geometry::Box { size } => Ok(Shape::Box {
            half_extents: Vector3::from(**size) / 2.0,
        }),
        Geometry::Sphere { radius } => Ok(Shape::Sphere { radius: *radius }),
        Geometry::Cylinder { radius, length } => Ok(Shape::Cylinder {
            radius: *radius,
            length: *length,
        }),
        Geometry::Capsule { radius, length } => Ok(Shape::Capsule {
            radius: *radius,
            length: *length,
        }),
        Geometry::Mesh { filename, scale } => Err((
            filename,
            scale.map_or(Vector3::repeat(1.0), |s| Vector3::from(*s)),
        )),
    }
}

/// Whether a mesh is among the collision shapes of a link.
fn collides(link: &urdf_rs::Link, mesh: (&str, Vector3<f64>)) -> bool {
    let mut shapes = link.collision.iter().map(|c| primitive(&c.geometry));
    shapes.any(|shape| shape.is_err_and(|other| other == mesh))
}

pub(super) fn rgb(color: &urdf_rs::Color) -> [f32; 3] {
    let [red, green, blue, _] = *color.rgba;
    [red, green, blue].map(|c| (c as f32).clamp(0.0, 1.0))
}

//! What may touch: the collision geometry of one link, or one object of the scene.

use nalgebra::{Isometry3, Vector3};

use super::scene::{SceneObject, SceneShape};
use crate::error::Result;
use crate::geometry::{Ball, BoundingCapsule, Convex, HalfSpace, Solid};

/// The collision geometry of one link or of one object of the scene, in the frame of its body.
#[derive(Debug, Clone)]
pub(super) struct Part {
    pub name: String,
    /// Its body, 0 for the base and the scene.
    pub body: usize,
    pub geometry: PartGeometry,
    /// How far the cores of the shapes reach from the axis of the capsule around them \[m\]. 0 for a single capsule or sphere.
    pub girth: f64,
    /// How far they reach from the middle of the ball around them \[m\]. 0 for a single sphere.
    pub core_radius: f64,
}

#[derive(Debug, Clone)]
pub(super) enum PartGeometry {
    /// At least one shape, and a ball and a capsule around all of them.
    Convexes {
        convexes: Vec<Convex>,
        ball: Ball,
        capsule: BoundingCapsule,
    },
    /// In the base frame.
    HalfSpace(HalfSpace),
}

impl Part {
    /// Of at least one solid; `frame` takes the coordinates of their body to those of its frame here.
    ///
    /// # Errors
    /// When a length or coordinate is not finite or out of all proportion.
    pub fn new(
        name: String,
        body: usize,
        frame: &Isometry3<f64>,
        solids: &[&Solid],
    ) -> Result<Self> {
        let convexes = solids
            .iter()
            .map(|solid| Convex::new(&solid.shape, &(frame * solid.pose)))
            .collect::<Result<Vec<_>>>()
            .map_err(|e| e.at(format!("`{name}`")))?;
        let (ball, capsule) = match convexes.as_slice() {
            [one] => (*one.ball(), *one.capsule()),
            several => (ball_around(several), capsule_around(several)),
        };
        // What encloses all shapes encloses their cores with the least of their margins to spare.
        let margins = convexes.iter().map(Convex::margin);
        let margin = margins.fold(f64::INFINITY, f64::min);
        Ok(Self {
            name,
            body,
            girth: (capsule.radius - margin).max(0.0),
            core_radius: (ball.radius - margin).max(0.0),
            geometry: PartGeometry::Convexes {
                convexes,
                ball,
                capsule,
            },
        })
    }

    /// An object of a scene.
    ///
    /// # Errors
    /// When a length or coordinate is not finite or out of all proportion.
    pub fn of_object(object: &SceneObject) -> Result<Self> {
        match &object.shape {
            SceneShape::Solid(shape, pose) => {
                let solid = Solid {
                    shape: shape.clone(),
                    pose: *pose,
                    link: 0,
                    color: None,
                };
                Self::new(object.name.clone(), 0, &Isometry3::identity(), &[&solid])
            }
            SceneShape::HalfSpace(half_space) => Ok(Self {
                name: object.name.clone(),
                body: 0,
                geometry: PartGeometry::HalfSpace(*half_space),
                girth: 0.0,
                core_radius: 0.0,
            }),
        }
    }

    /// The largest distance of a point from the body's origin \[m\]; of a half-space that of its plane.
    pub fn reach(&self) -> f64 {
        match &self.geometry {
            PartGeometry::Convexes { convexes, .. } => {
                convexes.iter().map(Convex::reach).fold(0.0, f64::max)
            }
            PartGeometry::HalfSpace(half_space) => half_space.offset().abs(),
        }
    }
}

/// What rounding takes from a sum of a few lengths.
const OUTWARD: f64 = 1.0 + 64.0 * f64::EPSILON;

fn ball_around(convexes: &[Convex]) -> Ball {
    let center = convexes
        .iter()
        .map(|c| c.ball().center)
        .sum::<Vector3<f64>>()
        / convexes.len() as f64;
    let radius = convexes
        .iter()
        .map(|c| (c.ball().center - center).norm() + c.ball().radius)
        .fold(0.0, f64::max);
    Ball {
        center,
        radius: radius * OUTWARD,
    }
}

/// About the segment between the two capsule ends that are farthest apart: a capsule is within another when its ends are, by
/// its radius.
fn capsule_around(convexes: &[Convex]) -> BoundingCapsule {
    let ends: Vec<(Vector3<f64>, f64)> = convexes
        .iter()
        .flat_map(|c| c.capsule().ends.map(|end| (end, c.capsule().radius)))
        .collect();
    let mut segment = [ends[0].0; 2];
    for (i, (a, _)) in ends.iter().enumerate() {
        for (b, _) in &ends[..i] {
            if (b - a).norm_squared() > (segment[1] - segment[0]).norm_squared() {
                segment = [*a, *b];
            }
        }
    }
    let along = segment[1] - segment[0];
    let square = along.norm_squared().max(f64::MIN_POSITIVE);
    let radius = ends
        .iter()
        .map(|(end, radius)| {
            let share = ((end - segment[0]).dot(&along) / square).clamp(0.0, 1.0);
            (segment[0] + along * share - end).norm() + radius
        })
        .fold(0.0, f64::max);
    BoundingCapsule {
        ends: segment,
        radius: radius * OUTWARD,
    }
}

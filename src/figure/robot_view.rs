//! Pictures of a robot: overlaid poses that fade with age, and the path of the hand.
//!
//! Each set of solids is a layer with its own depth buffer, so that overlapping links of one
//! transparent pose do not show through each other. Solids are met by rays in closed form,
//! which gives round things exact outlines and normals.

use std::sync::Mutex;

use nalgebra::{Isometry3, Point3};

use crate::error::{Error, ErrorKind, Result};
use crate::figure::camera::{Camera, box_around, corners};
use crate::figure::ground::Ground;
use crate::figure::image::{Color, Image};
use crate::figure::layer::{Layer, MARGIN, TILE, Tile};
use crate::figure::ray::Target;
use crate::figure::tube::tube;
use crate::geometry::Shape;

/// Samples per pixel side.
pub(crate) const SUPERSAMPLING: usize = 3;

/// Opacity of the oldest of several poses.
const OLDEST: f64 = 0.10;

/// Radius of the path's tube relative to the height of the view at its target.
const PATH_RADIUS: f64 = 0.0038;

/// A coloured solid in the world.
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    /// Form, in its own frame.
    pub shape: Shape,
    /// Place of the shape's frame in the world (m, z up).
    pub pose: Isometry3<f64>,
    /// Colour; the opacity is ignored.
    pub color: Color,
}

/// Where the picture is taken from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Place of the eye in the world, m.
    pub eye: Point3<f64>,
    /// Point of the world at the centre of the picture, m.
    pub target: Point3<f64>,
    /// Vertical angle of view, rad, between 0 and pi.
    pub field_of_view: f64,
}

/// Draws `still` opaque; over it `ghosts`, each a full set of the moving solids, the oldest
/// first, nearly transparent, to the newest, opaque; and the `path` of the hand through the
/// points (world, m) as a tube whose colour runs from dark blue at the first to yellow at the
/// last. `still` and the path hide what is behind them; of two ghosts, the newer is on top.
/// The ground is at the height of the lowest solid. `size` is (width, height) in px.
///
/// # Errors
/// Numbers that are not finite, shapes without extent, a view without direction, or a `size`
/// of zero or beyond the limits of an [`Image`].
pub fn render(
    view: &View,
    still: &[Solid],
    ghosts: &[Vec<Solid>],
    path: &[Point3<f64>],
    size: (u32, u32),
) -> Result<Image> {
    let solids = || still.iter().chain(ghosts.iter().flatten());
    check(view, solids(), path)?;
    let mut image = Image::filled(size.0, size.1, Color::WHITE)?;
    let samples = (
        size.0 as usize * SUPERSAMPLING,
        size.1 as usize * SUPERSAMPLING,
    );
    let camera = Camera::new(view, samples);
    let samples = (samples.0 + MARGIN, samples.1 + MARGIN);

    let layer = |solids: &[Solid], alpha: f64| {
        let mut layer = Layer::new(alpha);
        for solid in solids {
            let target = Target::new(&solid.shape, &solid.pose, &camera, samples);
            layer.push(target, solid.color.rgb.map(f64::from), true);
        }
        layer
    };
    let mut scene = layer(still, 1.0);
    let distance = (view.target - view.eye).norm();
    let radius = PATH_RADIUS * 2.0 * distance * (0.5 * view.field_of_view).tan();
    for (shape, pose, color) in tube(path, radius) {
        scene.push(Target::new(&shape, &pose, &camera, samples), color, false);
    }
    let last = ghosts.len().saturating_sub(1).max(1) as f64;
    let mut layers = vec![scene];
    for (index, ghost) in ghosts.iter().enumerate() {
        // Counted from the newest, so that a single one is opaque.
        let age = (ghosts.len() - 1 - index) as f64 / last;
        layers.push(layer(ghost, OLDEST + (1.0 - OLDEST) * (1.0 - age).powi(2)));
    }
    let low = solids()
        .flat_map(|solid| corners(&solid.shape, &solid.pose))
        .map(|corner| corner.z)
        .fold(f64::INFINITY, f64::min);
    // The newest pose stands for all in the shadow.
    let shown: Vec<&Solid> = still
        .iter()
        .chain(ghosts.last().into_iter().flatten())
        .collect();
    let ground = low.is_finite().then(|| Ground::new(low, &shown));

    let band = 3 * image.width as usize * TILE;
    let width = image.width as usize;
    let bands = Mutex::new(image.pixels.chunks_mut(band).enumerate());
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                let mut tile = Tile::new();
                // The lock must not be held while drawing, so not in the head of a `while let`.
                loop {
                    let next = bands.lock().ok().and_then(|mut bands| bands.next());
                    let Some((index, pixels)) = next else { break };
                    for left in (0..width).step_by(TILE) {
                        tile.draw(&camera, &layers, ground.as_ref(), (left, index * TILE));
                        tile.copy(pixels, width, left);
                    }
                }
            });
        }
    });
    Ok(image)
}

fn check<'a>(
    view: &View,
    mut solids: impl Iterator<Item = &'a Solid>,
    path: &[Point3<f64>],
) -> Result<()> {
    let fail = |what: &str| Err(Error::new(ErrorKind::Value, what));
    let distance = (view.target - view.eye).norm();
    if !(distance.is_finite() && distance > 0.0) {
        return fail("a view without direction");
    }
    if !(view.field_of_view > 0.0 && view.field_of_view < std::f64::consts::PI) {
        return fail("a field of view outside 0..pi");
    }
    if path
        .iter()
        .any(|point| !point.coords.iter().all(|value| value.is_finite()))
    {
        return fail("a path that is not finite");
    }
    let sound = solids.all(|solid| {
        let placed = solid
            .pose
            .to_homogeneous()
            .iter()
            .all(|value| value.is_finite());
        let (_, half) = box_around(&solid.shape);
        let sized = half.iter().all(|&half| half.is_finite() && half > 0.0);
        let straight = !matches!(solid.shape, Shape::Capsule { length, .. } if length < 0.0);
        placed && sized && straight
    });
    if sound {
        Ok(())
    } else {
        fail("a solid without finite place and extent")
    }
}

#[cfg(test)]
mod tests;

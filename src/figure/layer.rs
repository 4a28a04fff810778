//! Shading and compositing of layers of solids, tile by tile.

use nalgebra::Vector3;

use crate::figure::camera::Camera;
use crate::figure::ground::Ground;
use crate::figure::ray::Target;
use crate::figure::robot_view::SUPERSAMPLING;

/// Side of a tile, px: small enough for its buffers to stay in the cache.
pub(crate) const TILE: usize = 16;

/// Samples around a tile that are needed to find the outlines within it; half the width of an
/// outline.
pub(crate) const MARGIN: usize = 2;

/// Side of a tile with its margins, in samples.
const SIDE: usize = TILE * SUPERSAMPLING + 2 * MARGIN;

/// Colour where nothing is, sRGB 0..=255.
pub(crate) const BACKGROUND: [f64; 3] = [255.0; 3];

/// Colour of outlines, sRGB 0..=255.
const INK: [f64; 3] = [38.0, 42.0, 50.0];

/// A step in depth that is an outline, m.
const DEPTH_STEP: f64 = 0.02;

/// Solids drawn together with one depth buffer.
pub(crate) struct Layer {
    alpha: f64,
    targets: Vec<Target>,
    /// Per target: linear colour of the surface (0..=1) and whether it has outlines.
    looks: Vec<(Vector3<f64>, bool)>,
}

impl Layer {
    /// An empty layer of opacity `alpha`.
    pub(crate) fn new(alpha: f64) -> Self {
        Self {
            alpha,
            targets: Vec::new(),
            looks: Vec::new(),
        }
    }

    /// Adds a solid with an sRGB colour of 0..=255.
    pub(crate) fn push(&mut self, target: Target, color: [f64; 3], outlined: bool) {
        self.targets.push(target);
        // A square is near enough to the sRGB curve, and its inverse is cheap.
        self.looks.push((
            Vector3::from(color.map(|part| (part / 255.0).powi(2))),
            outlined,
        ));
    }
}

/// What a sample of a layer sees.
#[derive(Clone, Copy)]
struct Seen {
    depth: f64,
    normal: Vector3<f64>,
    index: usize,
}

const NOTHING: Seen = Seen {
    depth: f64::INFINITY,
    normal: Vector3::new(0.0, 0.0, 0.0),
    index: 0,
};

/// Buffers for one tile.
pub(crate) struct Tile {
    directions: Vec<Vector3<f64>>,
    scene: Vec<Seen>,
    seen: Vec<Seen>,
    color: Vec<Vector3<f64>>,
}

impl Tile {
    pub(crate) fn new() -> Self {
        Self {
            directions: vec![Vector3::zeros(); SIDE * SIDE],
            scene: vec![NOTHING; SIDE * SIDE],
            seen: vec![NOTHING; SIDE * SIDE],
            color: vec![Vector3::zeros(); SIDE * SIDE],
        }
    }

    /// Draws the tile whose upper left pixel is `corner` (column, row): first of the `layers`
    /// is the scene that hides parts of the others.
    pub(crate) fn draw(
        &mut self,
        camera: &Camera,
        layers: &[Layer],
        ground: Option<&Ground>,
        corner: (usize, usize),
    ) {
        // Sample that the first of the buffers stands for, plus the margin to stay positive.
        let origin = (corner.0 * SUPERSAMPLING, corner.1 * SUPERSAMPLING);
        for (at, direction) in self.directions.iter_mut().enumerate() {
            // At the left and upper edge of the picture the margin repeats the first sample.
            let column = (origin.0 + at % SIDE).saturating_sub(MARGIN);
            let row = (origin.1 + at / SIDE).saturating_sub(MARGIN);
            *direction = camera.direction(column, row);
        }
        for (color, direction) in self.color.iter_mut().zip(&self.directions) {
            *color = ground.map_or(Vector3::from(BACKGROUND), |g| {
                g.color(&camera.eye, direction)
            });
        }
        let mut layers = layers.iter();
        self.scene.fill(NOTHING);
        if let Some(layer) = layers.next()
            && trace(layer, &self.directions, &mut self.scene, origin)
        {
            blend(
                layer,
                camera,
                &self.directions,
                &self.scene,
                &self.scene,
                &mut self.color,
            );
        }
        for layer in layers {
            if trace(layer, &self.directions, &mut self.seen, origin) {
                blend(
                    layer,
                    camera,
                    &self.directions,
                    &self.seen,
                    &self.scene,
                    &mut self.color,
                );
            }
        }
    }

    /// Copies the tile to a band of the image, `width` px wide, at the column `left`.
    pub(crate) fn copy(&self, band: &mut [u8], width: usize, left: usize) {
        let area = (SUPERSAMPLING * SUPERSAMPLING) as f64;
        for (row, line) in band.chunks_exact_mut(3 * width).enumerate() {
            let pixels = line.chunks_exact_mut(3).skip(left).take(TILE);
            for (column, pixel) in pixels.enumerate() {
                let mut sum = Vector3::zeros();
                for y in 0..SUPERSAMPLING {
                    let at =
                        (row * SUPERSAMPLING + y + MARGIN) * SIDE + column * SUPERSAMPLING + MARGIN;
                    sum += self.color[at..at + SUPERSAMPLING]
                        .iter()
                        .sum::<Vector3<f64>>();
                }
                for (part, value) in pixel.iter_mut().zip(sum.iter()) {
                    *part = (value / area).round() as u8;
                }
            }
        }
    }
}

/// Finds the nearest solid per sample; returns false, and leaves `seen` alone, if the tile is
/// out of reach of all solids.
fn trace(
    layer: &Layer,
    directions: &[Vector3<f64>],
    seen: &mut [Seen],
    origin: (usize, usize),
) -> bool {
    let mut any = false;
    // Part of the buffers that a span of samples of the picture covers.
    let part = |(first, end): (usize, usize), origin: usize| {
        // What is cut off by the picture goes on in the margin, or its cut would be outlined.
        let from = if first == 0 {
            0
        } else {
            (first + MARGIN).saturating_sub(origin)
        };
        from.min(SIDE)..(end + MARGIN).saturating_sub(origin).min(SIDE)
    };
    for (index, target) in layer.targets.iter().enumerate() {
        let (columns, rows) = (part(target.columns, origin.0), part(target.rows, origin.1));
        if columns.is_empty() || rows.is_empty() {
            continue;
        }
        if !any {
            // Only now, for most layers miss most tiles.
            seen.fill(NOTHING);
            any = true;
        }
        for row in rows {
            for at in columns.clone().map(|column| row * SIDE + column) {
                let direction = target.local(&directions[at]);
                let depth = target.depth(&direction);
                if depth < seen[at].depth {
                    let normal = target.normal(&direction, depth);
                    seen[at] = Seen {
                        depth,
                        normal,
                        index,
                    };
                }
            }
        }
    }
    any
}

/// Paints what the layer sees in front of the scene over the colours.
fn blend(
    layer: &Layer,
    camera: &Camera,
    directions: &[Vector3<f64>],
    seen: &[Seen],
    scene: &[Seen],
    color: &mut [Vector3<f64>],
) {
    for row in MARGIN..SIDE - MARGIN {
        for at in (row * SIDE + MARGIN)..(row * SIDE + SIDE - MARGIN) {
            let here = &seen[at];
            // Of the scene itself, equal depths pass.
            if !here.depth.is_finite() || here.depth > scene[at].depth {
                continue;
            }
            let (albedo, outlined) = layer.looks[here.index];
            let mut shade = shaded(&albedo, &here.normal, &directions[at], camera);
            if outlined {
                shade = shade.lerp(&Vector3::from(INK), outline(seen, at));
            }
            color[at] = color[at].lerp(&shade, layer.alpha);
        }
    }
}

/// How much of an outline a sample is, 0 to 1.
fn outline(seen: &[Seen], at: usize) -> f64 {
    let here = &seen[at];
    let mut strength = 0.0_f64;
    for step in [1, SIDE, SIDE + 1, SIDE - 1] {
        // Diagonal neighbours at the full distance would make slanted outlines wider.
        let reach = if step == 1 || step == SIDE { MARGIN } else { 1 };
        for there in [&seen[at - reach * step], &seen[at + reach * step]] {
            if there.depth > here.depth + DEPTH_STEP {
                strength = strength.max(0.8);
            } else if there.index != here.index && there.normal.dot(&here.normal) < 0.6 {
                strength = strength.max(0.3);
            }
        }
    }
    strength
}

/// Colour (sRGB 0..=255) of a lit surface with the linear colour `albedo`.
fn shaded(
    albedo: &Vector3<f64>,
    normal: &Vector3<f64>,
    direction: &Vector3<f64>,
    camera: &Camera,
) -> Vector3<f64> {
    // The lights go with the camera, so that no view shows only the dark side.
    let normal = Vector3::new(
        normal.dot(&camera.right),
        normal.dot(&camera.up),
        -normal.dot(&camera.forward),
    );
    let to_eye = Vector3::new(
        -direction.dot(&camera.right),
        -direction.dot(&camera.up),
        direction.dot(&camera.forward),
    )
    .normalize();
    let key = Vector3::new(-0.48, 0.64, 0.60);
    let fill = Vector3::new(0.80, 0.10, 0.59);
    // Half-wrapped light has no hard terminator.
    let wrapped = |light: &Vector3<f64>| (0.8 * normal.dot(light) + 0.2).max(0.0);
    let sky = 0.5 + 0.5 * normal.y;
    let light = 0.17 + 0.17 * sky + 0.82 * wrapped(&key) + 0.22 * wrapped(&fill);
    let gloss = normal.dot(&(key + to_eye).normalize()).max(0.0).powi(40);
    let rim = (1.0 - normal.dot(&to_eye).max(0.0)).powi(4);
    let lit = albedo * light + Vector3::repeat(0.07 * gloss + 0.10 * rim);
    lit.map(|part| 255.0 * part.clamp(0.0, 1.0).sqrt())
}

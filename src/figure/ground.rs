//! The floor under the robot.

use nalgebra::{Point3, Vector3};

use crate::figure::camera::{NEAR, box_around};
use crate::figure::layer::BACKGROUND;
use crate::figure::robot_view::Solid;

/// Cells per side of the grid of the shadow.
const CELLS: usize = 72;

/// The floor with the soft shadow of the solids above.
pub(crate) struct Ground {
    height: f64,
    /// Middle of the grid, m.
    centre: (f64, f64),
    /// From the middle to the side of the grid, m.
    reach: f64,
    /// Darkness at the nodes of the grid, 0 to 1.
    shadow: Vec<f64>,
}

impl Ground {
    /// The floor at `height` (m) under `solids`.
    pub(crate) fn new(height: f64, solids: &[&Solid]) -> Self {
        // A shadow is the sum of those of points within the solids, each the softer the higher.
        let mut points = Vec::new();
        for solid in solids {
            let (middle, half) = box_around(&solid.shape);
            for index in 0..27 {
                let cell = |bit: usize| (index / 3_usize.pow(bit as u32) % 3) as f64 - 1.0;
                let offset = Vector3::new(cell(0), cell(1), cell(2)).component_mul(&half) * 0.67;
                let size = half.norm() / 3.0;
                points.push((solid.pose * Point3::from(middle + offset), size));
            }
        }
        let count = points.len().max(1) as f64;
        let centre = points.iter().fold((0.0, 0.0), |sum, (p, _)| {
            (sum.0 + p.x / count, sum.1 + p.y / count)
        });
        let blur = |point: &Point3<f64>, size: f64| 0.8 * size + 0.45 * (point.z - height).max(0.0);
        let reach = points
            .iter()
            .map(|(p, size)| (p.x - centre.0).hypot(p.y - centre.1) + 3.0 * blur(p, *size))
            .fold(NEAR, f64::max);
        let place = |cell: usize| (2.0 * cell as f64 / (CELLS - 1) as f64 - 1.0) * reach;
        let shadow = (0..CELLS * CELLS).map(|at| {
            let (x, y) = (centre.0 + place(at % CELLS), centre.1 + place(at / CELLS));
            let sum: f64 = points
                .iter()
                .map(|(p, size)| {
                    let blur = blur(p, *size);
                    let off = ((p.x - x).powi(2) + (p.y - y).powi(2)) / (blur * blur);
                    0.16 * (size / blur).powi(2) * (-0.5 * off).exp()
                })
                .sum();
            1.0 - (-sum).exp()
        });
        Self {
            height,
            centre,
            reach,
            shadow: shadow.collect(),
        }
    }

    /// Colour (sRGB 0..=255) of the floor or the background on a ray.
    pub(crate) fn color(&self, eye: &Point3<f64>, direction: &Vector3<f64>) -> Vector3<f64> {
        let background = Vector3::from(BACKGROUND);
        let depth = (self.height - eye.z) / direction.z;
        // Seen from below, a floor would hide the robot.
        if eye.z <= self.height || depth <= NEAR || !depth.is_finite() {
            return background;
        }
        let place =
            |at: f64, centre: f64| (0.5 + 0.5 * (at - centre) / self.reach) * (CELLS - 1) as f64;
        let x = place(eye.x + depth * direction.x, self.centre.0);
        let y = place(eye.y + depth * direction.y, self.centre.1);
        let end = (CELLS - 1) as f64;
        if !(0.0..end).contains(&x) || !(0.0..end).contains(&y) {
            return background;
        }
        let (column, row) = (x as usize, y as usize);
        let (across, down) = (x.fract(), y.fract());
        let node = |column: usize, row: usize| self.shadow[row * CELLS + column];
        let upper = node(column, row) * (1.0 - across) + node(column + 1, row) * across;
        let lower = node(column, row + 1) * (1.0 - across) + node(column + 1, row + 1) * across;
        background * (1.0 - 0.28 * (upper * (1.0 - down) + lower * down))
    }
}

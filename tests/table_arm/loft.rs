//! Bodies lofted through rounded rectangles, as OBJ.

use std::fmt::Write as _;

/// The axis along which sections are stacked.
#[derive(Clone, Copy)]
pub enum Along {
    X,
    Y,
    Z,
}

/// A rounded rectangle across the axis. Its sides run along the two axes that follow in the order x, y, z, x, y. Metres.
pub struct Section {
    /// Where on the axis.
    pub at: f64,
    /// Half of each side.
    pub half: [f64; 2],
    /// Radius of the corners.
    pub corner: f64,
    pub center: [f64; 2],
}

/// A circle about `center`.
pub const fn round(at: f64, radius: f64, center: [f64; 2]) -> Section {
    Section {
        at,
        half: [radius; 2],
        corner: radius,
        center,
    }
}

/// A rounded rectangle about the axis.
pub const fn rectangle(at: f64, half: [f64; 2], corner: f64) -> Section {
    Section {
        at,
        half,
        corner,
        center: [0.0; 2],
    }
}

pub struct Part {
    pub name: &'static str,
    pub along: Along,
    /// Points of each corner's quarter circle.
    pub corner_points: usize,
    pub sections: &'static [Section],
}

impl Part {
    /// Vertices \[m\], section by section, and triangles that turn left seen from outside.
    fn mesh(&self) -> (Vec<[f64; 3]>, Vec<[usize; 3]>) {
        let ring = 4 * self.corner_points;
        let mut vertices = Vec::new();
        for section in self.sections {
            for k in 0..ring {
                let quarter = std::f64::consts::FRAC_PI_2;
                // In the middle of each share of the quarter: quarters never meet in one point, however round.
                let angle = quarter * (k as f64 + 0.5) / self.corner_points as f64;
                let (sin, cos) = libm::sincos(angle);
                let u = cos.signum() * (section.half[0] - section.corner) + section.corner * cos;
                let v = sin.signum() * (section.half[1] - section.corner) + section.corner * sin;
                let (u, v) = (section.center[0] + u, section.center[1] + v);
                vertices.push(match self.along {
                    Along::X => [section.at, u, v],
                    Along::Y => [v, section.at, u],
                    Along::Z => [u, v, section.at],
                });
            }
        }
        let mut triangles = Vec::new();
        for lower in (0..vertices.len() - ring).step_by(ring) {
            for k in 0..ring {
                let next = (k + 1) % ring;
                let [a, b] = [lower + k, lower + next];
                triangles.extend([[a, b, b + ring], [a, b + ring, a + ring]]);
            }
        }
        let top = vertices.len() - ring;
        for k in 1..ring - 1 {
            triangles.extend([[0, k + 1, k], [top, top + k, top + k + 1]]);
        }
        (vertices, triangles)
    }

    /// The file, to a hundredth of a millimetre.
    pub fn obj(&self) -> String {
        let (vertices, triangles) = self.mesh();
        let mut text = format!("# undulate, table_arm: {}; metres\n", self.name);
        for v in vertices {
            // No negative zeros.
            let [x, y, z] = v.map(|x| (x * 1e5).round() / 1e5 + 0.0);
            let _ = writeln!(text, "v {x:.5} {y:.5} {z:.5}");
        }
        for [a, b, c] in triangles {
            let _ = writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1);
        }
        text
    }
}

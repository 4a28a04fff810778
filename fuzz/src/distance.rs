//! Signed distance of two shapes that the bytes describe: the answer must hold by its own bracket.

use undulate::nalgebra::{Isometry3, UnitQuaternion};

#[path = "../../tests/distance/bracket.rs"]
mod bracket;
#[allow(dead_code)]
#[path = "../../tests/distance/drawn.rs"]
mod drawn;

use drawn::{Case, Drawn, V};

/// Numbers as the bytes have them, zeros after their end.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn choice(&mut self, of: u8) -> u8 {
        let [first, rest @ ..] = self.0 else {
            return 0;
        };
        self.0 = rest;
        first % of
    }

    /// From -1 to 1; a few of them are 0 or whole.
    fn number(&mut self) -> f64 {
        match self.choice(16) {
            0 => f64::from(self.choice(3)) - 1.0,
            high => {
                let low = u16::from_le_bytes([self.choice(u8::MAX), self.choice(u8::MAX)]);
                (f64::from(high) + f64::from(low) / 65536.0 - 8.5) / 7.5
            }
        }
    }

    fn vector(&mut self) -> V {
        V::from_fn(|_, _| self.number())
    }

    /// From 1 mm to 1 m.
    fn size(&mut self) -> f64 {
        10f64.powf(1.5 * (self.number().clamp(-1.0, 1.0) - 1.0))
    }

    fn shape(&mut self) -> Drawn {
        match self.choice(5) {
            0 => Drawn::Box(V::from_fn(|_, _| self.size())),
            1 => Drawn::Sphere(self.size()),
            2 => Drawn::Capsule(self.size(), self.size()),
            3 => Drawn::Cylinder(self.size(), self.size()),
            _ => {
                let size = self.size();
                let count = 1 + self.choice(40);
                Drawn::Points((0..count).map(|_| self.vector() * size).collect())
            }
        }
    }

    fn turn(&mut self) -> UnitQuaternion<f64> {
        UnitQuaternion::from_scaled_axis(self.vector())
    }
}

pub fn distance(data: &[u8]) {
    let mut bytes = Bytes(data);
    let shapes = [bytes.shape(), bytes.shape()];
    let turns = match bytes.choice(3) {
        0 => [bytes.turn(); 2],
        _ => [bytes.turn(), bytes.turn()],
    };
    let direction = bytes.vector().try_normalize(1e-3).unwrap_or(V::x());
    let away = match bytes.choice(3) {
        // Touching along the direction, but for so little.
        0 => {
            let [here, there] = [&direction, &-direction];
            let gap = 10f64.powf(-6.0 - f64::from(bytes.choice(7)));
            let heights = shapes[0].height(&turns[0].inverse_transform_vector(here))
                + shapes[1].height(&turns[1].inverse_transform_vector(there));
            heights + if bytes.choice(2) == 0 { gap } else { -gap }
        }
        _ => bytes.number().abs() * (shapes[0].convex().reach() + shapes[1].convex().reach()),
    };
    let at = bytes.vector();
    let poses = [
        Isometry3::from_parts(at.into(), turns[0]),
        Isometry3::from_parts((at + direction * away).into(), turns[1]),
    ];
    let case = Case { shapes, poses };
    if let Err(failure) = bracket::bracket(&case) {
        panic!("{failure}: {case:?}");
    }
}

//! Drawing with plotters in fractions of a pixel, the same for SVG and bitmaps.

use plotters::backend::DrawingBackend;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{
    Color as _, FontDesc, FontFamily, FontStyle, FontTransform, RGBAColor, ShapeStyle, TextStyle,
};

use crate::error::{Error, ErrorKind, Result};
use crate::figure::font::sans;
use crate::figure::image::Color;

/// A point of the picture: px to the right and px down from the upper left corner.
pub(crate) type Spot = (f64, f64);

/// A rectangle of the picture, px.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Area {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
}

impl Area {
    pub(crate) fn contains(&self, (x, y): Spot) -> bool {
        (self.left..=self.right).contains(&x) && (self.top..=self.bottom).contains(&y)
    }

    pub(crate) fn corners(&self) -> [Spot; 4] {
        let Self {
            left,
            top,
            right,
            bottom,
        } = *self;
        [(left, top), (right, top), (right, bottom), (left, bottom)]
    }
}

/// Where a text lies relative to its spot, which is on its baseline.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// A drawing backend whose whole-numbered pixels are `scale` times smaller than ours.
pub(crate) struct Canvas<'a, B: DrawingBackend> {
    pub(crate) backend: &'a mut B,
    pub(crate) scale: f64,
    /// Whether the backend keeps text as text; otherwise it is drawn dot by dot.
    pub(crate) keeps_text: bool,
}

fn rgba(color: Color) -> RGBAColor {
    let [red, green, blue] = color.rgb;
    RGBAColor(red, green, blue, color.alpha)
}

/// Whether of three points the second is a turn of more than a right angle.
fn turns_back(spots: &[(i32, i32)]) -> bool {
    let way = |n: usize| {
        let ((a, b), (c, d)) = (spots[n], spots[n + 1]);
        [i64::from(c) - i64::from(a), i64::from(d) - i64::from(b)]
    };
    let [p, q] = [way(0), way(1)];
    p[0] * q[0] + p[1] * q[1] < 0
}

fn failed(error: impl std::fmt::Display) -> Error {
    Error::new(ErrorKind::Infeasible, error.to_string())
}

impl<B: DrawingBackend> Canvas<'_, B> {
    fn spot(&self, (x, y): Spot) -> (i32, i32) {
        (
            (x * self.scale).round() as i32,
            (y * self.scale).round() as i32,
        )
    }

    fn spots(&self, points: &[Spot]) -> Vec<(i32, i32)> {
        let mut spots: Vec<_> = points.iter().map(|&point| self.spot(point)).collect();
        spots.dedup();
        spots
    }

    /// An open polyline `width` px wide.
    pub(crate) fn line(&mut self, points: &[Spot], color: Color, width: f64) -> Result<()> {
        let spots = self.spots(points);
        if spots.len() < 2 {
            return Ok(());
        }
        let stroke_width = (width * self.scale).round().max(1.0) as u32;
        let style = ShapeStyle {
            color: rgba(color),
            filled: false,
            stroke_width,
        };
        // Of a bitmap lines that turn back would end in spikes as long as the turn is sharp.
        let mut first = 0;
        for n in 1..spots.len() {
            let is_last = n + 1 == spots.len();
            if is_last || (!self.keeps_text && turns_back(&spots[n - 1..=n + 1])) {
                let piece = spots[first..=n].to_vec();
                self.backend.draw_path(piece, &style).map_err(failed)?;
                first = n;
            }
        }
        Ok(())
    }

    /// A filled polygon.
    pub(crate) fn polygon(&mut self, points: &[Spot], color: Color) -> Result<()> {
        let spots = self.spots(points);
        if spots.len() < 3 {
            return Ok(());
        }
        let style = ShapeStyle {
            color: rgba(color),
            filled: true,
            stroke_width: 0,
        };
        self.backend.fill_polygon(spots, &style).map_err(failed)
    }

    /// A filled rectangle.
    pub(crate) fn rectangle(&mut self, area: Area, color: Color) -> Result<()> {
        let [from, _, to, _] = area.corners();
        let style = ShapeStyle {
            color: rgba(color),
            filled: true,
            stroke_width: 0,
        };
        let (from, to) = (self.spot(from), self.spot(to));
        self.backend
            .draw_rect(from, to, &style, true)
            .map_err(failed)
    }

    /// One line of text with its baseline at `spot`, reading upwards if `upwards`.
    pub(crate) fn text(
        &mut self,
        text: &str,
        spot: Spot,
        size: f64,
        anchor: Anchor,
        upwards: bool,
    ) -> Result<()> {
        let font = sans()?;
        let (x, y) = self.spot(spot);
        let size = size * self.scale;
        if self.keeps_text {
            // The backend lowers the baseline by 0.76 em below a spot at the top of the text,
            // and takes an em for 1 / 1.24 of a font size.
            let em = size * font.em();
            let drop = (0.76 * em).round() as i32;
            let spot = if upwards {
                (x - drop, y)
            } else {
                (x, y - drop)
            };
            let h_pos = match anchor {
                Anchor::Start => HPos::Left,
                Anchor::Middle => HPos::Center,
                Anchor::End => HPos::Right,
            };
            let turn = if upwards {
                FontTransform::Rotate270
            } else {
                FontTransform::None
            };
            // Viewers without Helvetica have a face of the same widths for it.
            let family = FontFamily::Name("Helvetica, Arial, sans-serif");
            let style = TextStyle {
                font: FontDesc::new(family, 1.24 * em, FontStyle::Normal).transform(turn),
                color: rgba(Color::BLACK).to_backend_color(),
                pos: Pos::new(h_pos, VPos::Top),
            };
            return self.backend.draw_text(text, &style, spot).map_err(failed);
        }
        let width = font.width(text, size);
        let shift = match anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -0.5 * width,
            Anchor::End => -width,
        };
        let shift = shift.round() as i32;
        // The face is too light for print: a second impression thickens it by a quarter of a
        // pixel.
        let impressions = [0, 1];
        font.pixels(text, size, |dx, dy, coverage| {
            let color = RGBAColor(0, 0, 0, coverage).to_backend_color();
            for thicker in impressions {
                let along = shift + dx + thicker;
                let spot = if upwards {
                    (x + dy, y - along)
                } else {
                    (x + along, y + dy)
                };
                self.backend.draw_pixel(spot, color).map_err(failed)?;
            }
            Ok(())
        })
    }
}

//! The legend of a panel, out of the way of the data.

use plotters::backend::DrawingBackend;

use crate::error::Result;
use crate::figure::canvas::{Anchor, Area, Canvas, Spot};
use crate::figure::font::sans;
use crate::figure::image::Color;
use crate::figure::plot::{Mark, Series};
use crate::figure::trace::{BAND, Panel, clipped_segment};

/// Room beyond the width of a label in our font: viewers of an SVG may set it in a wider one.
const SPARE: f64 = 1.12;

/// A legend with its place in the picture.
pub(crate) struct Legend<'a> {
    /// Series with a label, each with the width of its entry, px.
    entries: Vec<(&'a Series, f64)>,
    /// Font size, px.
    text: f64,
    place: Place,
}

enum Place {
    /// In a box over the plot.
    Within(Area),
    /// In a row that ends at the spot, above the plot.
    Above(Spot),
}

impl<'a> Legend<'a> {
    /// The legend of a panel, if any series has a label: in a place free of data; or else above
    /// the plot, to the right of its title; or else where it hides the least. Also the height
    /// in px that the plot would have to gain for the legend to hide nothing.
    pub(crate) fn placed(panel: &Panel<'a>) -> Result<Option<(Self, f64)>> {
        let font = sans()?;
        let text = 0.92 * panel.text;
        let (gap, head) = (0.5 * text, 2.2 * text);
        let entries: Vec<(&Series, f64)> = panel
            .plot
            .series
            .iter()
            .filter(|series| !series.label.is_empty())
            .map(|series| (series, head + SPARE * font.width(&series.label, text)))
            .collect();
        if entries.is_empty() {
            return Ok(None);
        }
        let Area {
            left,
            top,
            right,
            bottom,
        } = panel.area;
        let width = entries.iter().map(|(_, width)| *width).fold(0.0, f64::max) + 2.0 * gap;
        let height = 1.3 * text * entries.len() as f64 + gap;
        let lefts = [
            right - gap - width,
            left + gap,
            0.5 * (left + right - width),
        ];
        let tops = [top + gap, bottom - gap - height];
        let best = tops
            .iter()
            .flat_map(|&top| lefts.map(|left| (left, top)))
            .map(|(left, top)| {
                let area = Area {
                    left,
                    top,
                    right: left + width,
                    bottom: top + height,
                };
                (hidden(panel, area), area)
            })
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let title = font.width(&panel.plot.title, 1.1 * panel.text);
        let row: f64 = entries.iter().map(|(_, width)| width + 2.0 * gap).sum();
        let fits = height + gap < bottom - top && width + gap < right - left;
        let (place, lack) = match best {
            Some((cost, area)) if fits && (cost == 0.0 || title + row > right - left) => (
                Place::Within(area),
                if cost == 0.0 { 0.0 } else { height + 2.0 * gap },
            ),
            _ => (Place::Above((right, top - 0.9 * panel.text)), 0.0),
        };
        Ok(Some((
            Self {
                entries,
                text,
                place,
            },
            lack,
        )))
    }

    /// Draws the legend.
    pub(crate) fn draw<B: DrawingBackend>(&self, canvas: &mut Canvas<'_, B>) -> Result<()> {
        let gap = 0.5 * self.text;
        match self.place {
            Place::Within(area) => {
                canvas.rectangle(area, Color::WHITE.with_alpha(0.85))?;
                let mut border = area.corners().to_vec();
                border.push(border[0]);
                canvas.line(&border, Color::new(210, 210, 210), self.text / 20.0)?;
                for (index, (series, _)) in self.entries.iter().enumerate() {
                    let middle = area.top + 0.5 * gap + 1.3 * self.text * (index as f64 + 0.5);
                    draw_entry(series, (area.left + gap, middle), self.text, canvas)?;
                }
            }
            Place::Above((mut end, middle)) => {
                for (series, width) in self.entries.iter().rev() {
                    draw_entry(series, (end - width, middle), self.text, canvas)?;
                    end -= width + 2.0 * gap;
                }
            }
        }
        Ok(())
    }
}

/// How much of the data lies within `area`; zero is nothing.
fn hidden(panel: &Panel<'_>, area: Area) -> f64 {
    let mut length = 0.0;
    let mut add = |from: Spot, to: Spot, weight: f64| {
        if let Some((start, end)) = clipped_segment(from, to, area) {
            length += weight * (1.0 + (end.0 - start.0).hypot(end.1 - start.1));
        }
    };
    for series in &panel.plot.series {
        let weight = series.color.alpha;
        match &series.mark {
            Mark::Line { points, .. } => {
                panel
                    .spots(points)
                    .windows(2)
                    .for_each(|pair| add(pair[0], pair[1], weight));
            }
            Mark::Band { lower, upper } => {
                for edge in [lower, upper] {
                    panel
                        .spots(edge)
                        .windows(2)
                        .for_each(|pair| add(pair[0], pair[1], weight));
                }
                // A box within a wide band meets no edge of it.
                for (low, high) in panel.spots(lower).into_iter().zip(panel.spots(upper)) {
                    add(low, high, 0.1 * weight);
                }
            }
        }
    }
    length
}

/// One entry: a sample of the mark, starting at the spot, and the label.
fn draw_entry<B: DrawingBackend>(
    series: &Series,
    (left, middle): Spot,
    text: f64,
    canvas: &mut Canvas<'_, B>,
) -> Result<()> {
    let swatch = 1.7 * text;
    let ends = [(left, middle), (left + swatch, middle)];
    let color = series.color;
    match &series.mark {
        Mark::Line { width, .. } => canvas.line(&ends, color, f64::from(*width))?,
        Mark::Band { .. } => {
            let half = 0.3 * text;
            let area = Area {
                left,
                top: middle - half,
                right: left + swatch,
                bottom: middle + half,
            };
            canvas.rectangle(area, color.with_alpha(BAND * color.alpha))?;
        }
    }
    let spot = (left + swatch + 0.5 * text, middle + 0.3 * text);
    canvas.text(&series.label, spot, text, Anchor::Start, false)
}

//! Curves, bands and the legend within one panel.

use plotters::backend::DrawingBackend;

use crate::error::Result;
use crate::figure::axis::Axis;
use crate::figure::canvas::{Area, Canvas, Spot};
use crate::figure::plot::{Mark, Plot, Series};

/// Opacity of a band relative to its colour's.
pub(crate) const BAND: f64 = 0.2;

/// A plot with its axes and its place in the picture.
pub(crate) struct Panel<'a> {
    pub(crate) plot: &'a Plot,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    /// What the axes enclose.
    pub(crate) area: Area,
    /// Left end of all that belongs to the panel, px.
    pub(crate) cell_left: f64,
    /// Font size, px.
    pub(crate) text: f64,
}

impl Panel<'_> {
    /// Place in the picture of a point of the data.
    pub(crate) fn spot(&self, (x, y): (f64, f64)) -> Spot {
        let Area {
            left,
            top,
            right,
            bottom,
        } = self.area;
        // Far outside it makes no difference where, but whole numbers must not overflow.
        let along = self.x.fraction(x).clamp(-100.0, 100.0);
        let up = self.y.fraction(y).clamp(-100.0, 100.0);
        (left + along * (right - left), bottom - up * (bottom - top))
    }

    pub(crate) fn spots(&self, points: &[(f64, f64)]) -> Vec<Spot> {
        points.iter().map(|&point| self.spot(point)).collect()
    }
}

/// Draws the data of one series, cut off at the axes.
pub(crate) fn draw_series<B: DrawingBackend>(
    panel: &Panel<'_>,
    series: &Series,
    canvas: &mut Canvas<'_, B>,
) -> Result<()> {
    let color = series.color;
    match &series.mark {
        Mark::Line { points, width } => {
            for piece in clipped_line(&panel.spots(points), panel.area) {
                canvas.line(&piece, color, f64::from(*width))?;
            }
        }
        Mark::Band { lower, upper } => {
            let mut outline = panel.spots(lower);
            outline.extend(panel.spots(upper).into_iter().rev());
            let color = color.with_alpha(BAND * color.alpha);
            canvas.polygon(&clipped_polygon(outline, panel.area), color)?;
        }
    }
    Ok(())
}

/// The part of a segment inside `area`.
pub(crate) fn clipped_segment(from: Spot, to: Spot, area: Area) -> Option<(Spot, Spot)> {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    let sides = [
        (-dx, from.0 - area.left),
        (dx, area.right - from.0),
        (-dy, from.1 - area.top),
        (dy, area.bottom - from.1),
    ];
    for (outward, room) in sides {
        if outward == 0.0 {
            if room < 0.0 {
                return None;
            }
        } else if outward < 0.0 {
            enter = enter.max(room / outward);
        } else {
            leave = leave.min(room / outward);
        }
    }
    let at = |part: f64| (from.0 + part * dx, from.1 + part * dy);
    (enter <= leave).then(|| (at(enter), at(leave)))
}

/// The pieces of a polyline inside `area`.
fn clipped_line(points: &[Spot], area: Area) -> Vec<Vec<Spot>> {
    let mut pieces: Vec<Vec<Spot>> = Vec::new();
    let mut whole = false;
    for pair in points.windows(2) {
        let &[from, to] = pair else { continue };
        let Some((start, end)) = clipped_segment(from, to, area) else {
            whole = false;
            continue;
        };
        match pieces.last_mut() {
            Some(piece) if whole => piece.push(end),
            _ => pieces.push(vec![start, end]),
        }
        whole = area.contains(to);
    }
    pieces
}

/// The part of a polygon inside `area`, side by side (Sutherland and Hodgman).
fn clipped_polygon(mut outline: Vec<Spot>, area: Area) -> Vec<Spot> {
    let sides: [&dyn Fn(Spot) -> f64; 4] = [
        &|(x, _)| x - area.left,
        &|(x, _)| area.right - x,
        &|(_, y)| y - area.top,
        &|(_, y)| area.bottom - y,
    ];
    for inside in sides {
        let mut kept = Vec::with_capacity(outline.len());
        for (index, &to) in outline.iter().enumerate() {
            let Some(&from) = outline.get((index + outline.len() - 1) % outline.len()) else {
                continue;
            };
            let (before, after) = (inside(from), inside(to));
            if (before < 0.0) != (after < 0.0) {
                let part = before / (before - after);
                kept.push((
                    from.0 + part * (to.0 - from.0),
                    from.1 + part * (to.1 - from.1),
                ));
            }
            if after >= 0.0 {
                kept.push(to);
            }
        }
        outline = kept;
    }
    outline
}

//! The places of the panels; the grid, the axes and their labels.

use plotters::backend::DrawingBackend;

use crate::error::{Error, ErrorKind, Result};
use crate::figure::axis::Axis;
use crate::figure::canvas::{Anchor, Area, Canvas};
use crate::figure::font::sans;
use crate::figure::image::Color;
use crate::figure::legend::Legend;
use crate::figure::plot::{Mark, Plot};
use crate::figure::trace::Panel;

/// Axes and places of the panels.
pub(crate) fn layout(plots: &[Plot], columns: usize, size: (u32, u32)) -> Result<Vec<Panel<'_>>> {
    let font = sans()?;
    let rows = plots.len().div_ceil(columns);
    let columns = columns.min(plots.len());
    let cell_width = f64::from(size.0) / columns as f64;
    let cell_height = f64::from(size.1) / rows as f64;
    let text = (cell_width / 30.0).min(cell_height / 12.0).clamp(7.0, 60.0);
    let headed = plots.iter().any(|plot| {
        !plot.title.is_empty() || plot.series.iter().any(|series| !series.label.is_empty())
    });
    let top = if headed { 1.75 * text } else { 0.8 * text };
    let bottom = 3.1 * text;
    let height = cell_height - top - bottom;
    let y_count = (height / (2.4 * text)).clamp(2.0, 8.0) as usize;
    let x_count = (cell_width / (5.0 * text)).clamp(2.0, 8.0) as usize;

    let axes = plots
        .iter()
        .map(|plot| {
            let marks = || plot.series.iter().map(|series| &series.mark);
            let points = || marks().flat_map(Mark::points);
            let x = if plot.names.is_empty() {
                Axis::new(plot.x_range, points().map(|(x, _)| x), 0.0, x_count)?
            } else {
                Axis::of_names(&plot.names)
            };
            let ys = points().map(|(_, y)| y);
            Ok((x, Axis::new(plot.y_range, ys, 0.05, y_count)?))
        })
        .collect::<Result<Vec<_>>>()?;
    // The same margin for all keeps the panels aligned.
    let widest = axes
        .iter()
        .flat_map(|(_, y)| &y.ticks)
        .map(|(_, label)| font.width(label, text))
        .fold(0.0, f64::max);
    let left = widest + 2.5 * text;
    let right = 1.0 * text;
    if cell_width - left - right < 3.0 * text || height < 2.0 * text {
        let (width, height) = size;
        return Err(Error::new(
            ErrorKind::Value,
            format!("no room for {columns} x {rows} panels in {width} x {height} px"),
        ));
    }
    let panels = plots
        .iter()
        .zip(axes)
        .enumerate()
        .map(|(index, (plot, (x, y)))| {
            let cell_left = cell_width * (index % columns) as f64;
            let cell_top = cell_height * (index / columns) as f64;
            let area = Area {
                left: (cell_left + left).round(),
                top: (cell_top + top).round(),
                right: (cell_left + cell_width - right).round(),
                bottom: (cell_top + cell_height - bottom).round(),
            };
            Panel {
                plot,
                x,
                y,
                area,
                cell_left,
                text,
            }
        });
    Ok(panels.collect())
}

/// Raises the upper end of a fitted ordinate if else the legend would hide data.
pub(crate) fn give_headroom(panel: &mut Panel<'_>) -> Result<()> {
    let Some((_, lack)) = Legend::placed(panel)? else {
        return Ok(());
    };
    let height = panel.area.bottom - panel.area.top;
    if panel.plot.y_range.is_none() && lack > 0.0 && lack < 0.6 * height {
        let span = (panel.y.high - panel.y.low) * height / (height - lack);
        let ends = (panel.y.low, panel.y.low + span);
        let count = panel.y.ticks.len();
        panel.y = Axis::new(Some(ends), std::iter::empty(), 0.0, count)?;
    }
    Ok(())
}

/// Draws the grid, which belongs behind the data.
pub(crate) fn draw_grid<B: DrawingBackend>(
    panel: &Panel<'_>,
    canvas: &mut Canvas<'_, B>,
) -> Result<()> {
    let Area {
        left,
        top,
        right,
        bottom,
    } = panel.area;
    let color = Color::new(228, 228, 228);
    let width = panel.text / 20.0;
    for (value, _) in &panel.x.ticks {
        let x = panel.spot((*value, panel.y.low)).0;
        canvas.line(&[(x, top), (x, bottom)], color, width)?;
    }
    for (value, _) in &panel.y.ticks {
        let y = panel.spot((panel.x.low, *value)).1;
        canvas.line(&[(left, y), (right, y)], color, width)?;
    }
    Ok(())
}

/// Draws the title.
pub(crate) fn draw_title<B: DrawingBackend>(
    panel: &Panel<'_>,
    canvas: &mut Canvas<'_, B>,
) -> Result<()> {
    let (text, area) = (panel.text, panel.area);
    let above = (area.left, area.top - 0.6 * text);
    canvas.text(&panel.plot.title, above, 1.1 * text, Anchor::Start, false)
}

/// Draws the axes with their ticks and labels.
pub(crate) fn draw_axes<B: DrawingBackend>(
    panel: &Panel<'_>,
    canvas: &mut Canvas<'_, B>,
) -> Result<()> {
    let Area {
        left,
        top,
        right,
        bottom,
    } = panel.area;
    let text = panel.text;
    let color = Color::new(90, 90, 90);
    let (width, tick) = (text / 16.0, 0.3 * text);
    canvas.line(
        &[(left, top), (left, bottom), (right, bottom)],
        color,
        width,
    )?;
    for (value, label) in &panel.x.ticks {
        let x = panel.spot((*value, panel.y.low)).0;
        canvas.line(&[(x, bottom), (x, bottom + tick)], color, width)?;
        canvas.text(
            label,
            (x, bottom + tick + 0.95 * text),
            text,
            Anchor::Middle,
            false,
        )?;
    }
    for (value, label) in &panel.y.ticks {
        let y = panel.spot((panel.x.low, *value)).1;
        canvas.line(&[(left - tick, y), (left, y)], color, width)?;
        // Digits are about 0.6 of the font size high; this centres them on the tick.
        let spot = (left - tick - 0.3 * text, y + 0.3 * text);
        canvas.text(label, spot, text, Anchor::End, false)?;
    }
    let (middle, centre) = (0.5 * (left + right), 0.5 * (top + bottom));
    let below = (middle, bottom + 2.5 * text);
    canvas.text(&panel.plot.x_label, below, text, Anchor::Middle, false)?;
    let beside = (panel.cell_left + 1.15 * text, centre);
    canvas.text(&panel.plot.y_label, beside, text, Anchor::Middle, true)
}

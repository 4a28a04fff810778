//! Scientific plots, as SVG and PNG from the same drawing code.

use plotters::backend::{BitMapBackend, DrawingBackend, SVGBackend};

use crate::error::{Error, ErrorKind, Result};
use crate::figure::canvas::Canvas;
use crate::figure::frame::{draw_axes, draw_grid, draw_title, give_headroom, layout};
use crate::figure::image::{Color, Image, MAX_SIDE};
use crate::figure::legend::Legend;
use crate::figure::trace::{self, Panel};

/// Sub-pixels per pixel side of the bitmap.
const SUPERSAMPLING: u32 = 4;

/// Steps per pixel of the coordinates in the SVG, which plotters rounds to whole numbers.
const SVG_STEPS: u32 = 16;

/// One panel with a pair of axes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Plot {
    /// Title above the panel, may be empty.
    pub title: String,
    /// Label of the abscissa, with the unit in brackets.
    pub x_label: String,
    /// Label of the ordinate, with the unit in brackets.
    pub y_label: String,
    /// Ends of the abscissa in its units; `None` fits the data.
    pub x_range: Option<(f64, f64)>,
    /// Ends of the ordinate in its units; `None` fits the data with a margin.
    pub y_range: Option<(f64, f64)>,
    /// Names of the places 0, 1, .. of the abscissa, which takes them in place of numbers and ends half a place beyond; none for numbers.
    pub names: Vec<String>,
    /// What is drawn, the first at the back.
    pub series: Vec<Series>,
}

/// Data drawn in one way.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name in the legend; empty leaves it out of the legend.
    pub label: String,
    /// Colour; its opacity counts.
    pub color: Color,
    /// Data and how they are drawn.
    pub mark: Mark,
}

/// Data, all as (x, y) in the units of the axes, and how they are drawn.
#[derive(Debug, Clone, PartialEq)]
pub enum Mark {
    /// A polyline.
    Line {
        /// Vertices in order.
        points: Vec<(f64, f64)>,
        /// Width, px.
        width: u32,
    },
    /// The area between two polylines, filled with a fifth of the colour's opacity.
    Band {
        /// Vertices of the lower edge in order.
        lower: Vec<(f64, f64)>,
        /// Vertices of the upper edge in order; may differ in number from those of the lower.
        upper: Vec<(f64, f64)>,
    },
}

impl Mark {
    /// All points of the data.
    pub(crate) fn points(&self) -> impl Iterator<Item = (f64, f64)> {
        let (first, second): (&[_], &[_]) = match self {
            Self::Band { lower, upper } => (lower, upper),
            Self::Line { points, .. } => (points, &[]),
        };
        first.iter().chain(second).copied()
    }
}

/// A finished figure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// SVG document; text is kept as text.
    pub svg: String,
    /// PNG file.
    pub png: Vec<u8>,
}

/// Draws `plots` row by row in `columns` columns of equal panels into a picture of `size`
/// (width, height) px. Text grows with the panels: a picture as wide as two columns of a paper
/// (18 cm) gets text of about 8 pt with two panels side by side.
///
/// # Errors
/// No plots or columns, data or ranges that are not finite, or a `size` that leaves no room for
/// the panels.
pub fn draw(plots: &[Plot], columns: usize, size: (u32, u32)) -> Result<Picture> {
    let panels = panels(plots, columns, size, MAX_SIDE / SUPERSAMPLING)?;
    let (width, height) = (size.0 * SUPERSAMPLING, size.1 * SUPERSAMPLING);
    let mut image = Image::filled(width, height, Color::WHITE)?;
    let mut bitmap = BitMapBackend::with_buffer(&mut image.pixels, (width, height));
    draw_panels(&panels, &mut bitmap, SUPERSAMPLING, false)?;
    drop(bitmap);
    Ok(Picture {
        svg: svg(&panels, size)?,
        png: image.downsampled(SUPERSAMPLING)?.to_png()?,
    })
}

/// [`draw`] of an SVG alone, which may be as large as the panels of hundreds of recordings need.
///
/// # Errors
/// Those of `draw`.
pub(crate) fn draw_svg(plots: &[Plot], columns: usize, size: (u32, u32)) -> Result<String> {
    svg(&panels(plots, columns, size, MAX_SIDE)?, size)
}

fn panels(
    plots: &[Plot],
    columns: usize,
    size: (u32, u32),
    longest: u32,
) -> Result<Vec<Panel<'_>>> {
    if plots.is_empty() || columns == 0 {
        return Err(Error::new(ErrorKind::Value, "a figure without panels"));
    }
    let mut numbers = plots
        .iter()
        .flat_map(|plot| &plot.series)
        .flat_map(|series| series.mark.points());
    if !numbers.all(|(x, y)| x.is_finite() && y.is_finite()) {
        return Err(Error::new(ErrorKind::Value, "data that are not finite"));
    }
    if size.0.max(size.1) > longest {
        return Err(Error::new(
            ErrorKind::Value,
            format!("a figure of {} x {} px", size.0, size.1),
        ));
    }
    let mut panels = layout(plots, columns, size)?;
    for panel in &mut panels {
        give_headroom(panel)?;
    }
    Ok(panels)
}

fn svg(panels: &[Panel<'_>], size: (u32, u32)) -> Result<String> {
    let mut drawing = String::new();
    let mut vectors = SVGBackend::with_string(&mut drawing, (0, 0));
    draw_panels(panels, &mut vectors, SVG_STEPS, true)?;
    drop(vectors);
    // The head that plotters wrote knows nothing of our steps.
    let body = drawing.split_once('\n').map_or("", |(_, body)| body);
    let (width, height) = size;
    Ok(format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {} {}\" stroke-linejoin=\"round\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>\n{body}",
        width * SVG_STEPS,
        height * SVG_STEPS,
    ))
}

fn draw_panels<B: DrawingBackend>(
    panels: &[Panel<'_>],
    backend: &mut B,
    steps: u32,
    keeps_text: bool,
) -> Result<()> {
    let mut canvas = Canvas {
        backend,
        scale: f64::from(steps),
        keeps_text,
    };
    for panel in panels {
        draw_title(panel, &mut canvas)?;
        let series = &panel.plot.series;
        // A panel of labels alone is a key, and has no axes.
        let is_key = !series.is_empty() && series.iter().all(|s| s.mark.points().next().is_none());
        if !is_key {
            draw_grid(panel, &mut canvas)?;
            for series in series {
                trace::draw_series(panel, series, &mut canvas)?;
            }
            draw_axes(panel, &mut canvas)?;
        }
        if let Some((legend, _)) = Legend::placed(panel)? {
            legend.draw(&mut canvas)?;
        }
    }
    canvas
        .backend
        .present()
        .map_err(|error| Error::new(ErrorKind::Infeasible, error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::canvas::Area;

    fn plot(points: Vec<(f64, f64)>) -> Plot {
        Plot {
            title: "(a) Elbow & <wrist>".into(),
            x_label: "Time (s)".into(),
            y_label: "Angle (°)".into(),
            series: vec![Series {
                label: "sample one".into(),
                color: Color::BLUE,
                mark: Mark::Line { points, width: 3 },
            }],
            ..Plot::default()
        }
    }

    fn decoded(picture: &Picture) -> Image {
        let source = std::io::Cursor::new(&picture.png);
        let mut reader = png::Decoder::new(source).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        Image {
            width: info.width,
            height: info.height,
            pixels,
        }
    }

    #[test]
    fn svg_has_the_labels_as_text_and_png_the_size_and_the_colour() {
        let picture = draw(&[plot(vec![(0.0, 1.0), (2.0, 3.0)])], 1, (400, 300)).unwrap();
        for text in [
            "Time (s)",
            "Angle (°)",
            "sample one",
            "(a) Elbow &amp; &lt;wrist&gt;",
        ] {
            assert!(
                picture.svg.contains(&format!(">\n{text}\n</text>")),
                "{text}"
            );
        }
        assert!(picture.svg.contains("sans-serif") && picture.svg.ends_with("</svg>\n"));
        let image = decoded(&picture);
        assert_eq!((image.width, image.height), (400, 300));
        let blue = image
            .pixels
            .chunks_exact(3)
            .filter(|pixel| *pixel == Color::BLUE.rgb)
            .count();
        assert!(blue > 300, "{blue} px of the curve");
    }

    #[test]
    fn a_line_that_turns_back_has_no_spike_in_a_bitmap() {
        let mut sharp = plot(vec![(0.0, 0.0), (1.0, 1.0), (1.002, 0.0)]);
        sharp.x_range = Some((0.0, 2.0));
        sharp.y_range = Some((0.0, 4.0));
        sharp.series[0].label.clear();
        let image = decoded(&draw(&[sharp], 1, (400, 400)).unwrap());
        let highest = image
            .pixels
            .chunks_exact(3)
            .position(|pixel| *pixel == Color::BLUE.rgb)
            .unwrap() as u32
            / image.width;
        // The turn is at a quarter of the axis; a miter would stand out by a hundred pixels.
        assert!(highest > 240, "row {highest}");
    }

    #[test]
    fn a_key_has_labels_and_no_axes() {
        let svg = draw(&[plot(Vec::new())], 1, (400, 300)).unwrap().svg;
        assert!(svg.contains("sample one") && svg.contains("(a) Elbow"));
        assert!(!svg.contains("Time (s)"), "{svg}");
        let svg = draw(&[plot(vec![(0.0, 1.0), (2.0, 3.0)])], 1, (400, 300))
            .unwrap()
            .svg;
        assert!(svg.contains("Time (s)"));
    }

    #[test]
    fn nothing_is_drawn_beyond_the_axes() {
        let mut wild = plot(vec![(-5.0, -90.0), (6.0, 91.0), (7.0, 0.5), (7.0, 1e300)]);
        (wild.x_range, wild.y_range) = (Some((0.0, 1.0)), Some((0.0, 1.0)));
        wild.series[0].label.clear();
        let panel = layout(std::slice::from_ref(&wild), 1, (400, 300))
            .unwrap()
            .remove(0);
        let image = decoded(&draw(std::slice::from_ref(&wild), 1, (400, 300)).unwrap());
        let mut inside = 0;
        for (index, pixel) in image.pixels.chunks_exact(3).enumerate() {
            let blue = pixel[2] > pixel[0].saturating_add(40);
            let (x, y) = ((index % 400) as f64, (index / 400) as f64);
            let Area {
                left,
                top,
                right,
                bottom,
            } = panel.area;
            let near = x > left - 4.0 && x < right + 4.0 && y > top - 4.0 && y < bottom + 4.0;
            assert!(!blue || near, "{x} {y}");
            inside += usize::from(blue);
        }
        assert!(inside > 50);
    }

    #[test]
    fn empty_and_constant_data_are_drawn() {
        for points in [vec![], vec![(1.0, 2.0)], vec![(0.0, 0.0); 3]] {
            assert!(draw(&[plot(points)], 3, (300, 200)).is_ok());
        }
    }

    #[test]
    fn impossible_input_is_an_error() {
        for bad in [f64::NAN, f64::INFINITY] {
            assert!(draw(&[plot(vec![(0.0, 1.0), (bad, 1.0)])], 1, (300, 200)).is_err());
            let mut ranged = plot(vec![(0.0, 1.0)]);
            ranged.y_range = Some((0.0, bad));
            assert!(draw(&[ranged], 1, (300, 200)).is_err());
        }
        let good = [plot(vec![(0.0, 1.0)])];
        assert!(draw(&[], 1, (300, 200)).is_err());
        assert!(draw(&good, 0, (300, 200)).is_err());
        for size in [(0, 0), (30, 20), (u32::MAX, 200)] {
            assert!(draw(&good, 1, size).is_err(), "{size:?}");
        }
    }
}

//! The paper's figures 1 and 2: spectra and trajectories of joints.

use super::image::Color;
use super::plot::{self, Mark, Picture, Plot, Series};
use crate::error::Result;
use crate::fourier::{Derivative, PeriodGrid, Wave};
use crate::primitive::{Coordinate, FourierMovementPrimitive};

/// A primitive with the name and colour it has in a figure.
pub struct Labelled<'a> {
    /// Name in the legend.
    pub label: &'a str,
    /// Colour of its curve and band.
    pub color: Color,
    /// What is drawn.
    pub primitive: &'a FourierMovementPrimitive,
}

/// Spectra as in figure 1 of the paper: for each of `joints` (name, title), |w_{d,k}| in degrees over k; the median exp(mu)
/// of each primitive with the band from exp(mu - sigma) to exp(mu + sigma), and the demonstrations in thin lines. `size` in px.
///
/// # Errors
/// When a joint is not among those of a primitive or of the demonstrations.
pub fn spectra(
    demonstrations: &[Wave],
    primitives: &[Labelled],
    joints: &[(&str, &str)],
    size: (u32, u32),
) -> Result<Picture> {
    let mut plots = Vec::new();
    // One scale for all panels, so that they can be compared.
    let mut highest: f64 = 0.0;
    for (panel, (joint, title)) in joints.iter().enumerate() {
        // One legend, in the first panel, is for all.
        let label = |text: &str| {
            if panel == 0 {
                text.to_owned()
            } else {
                String::new()
            }
        };
        let mut series = Vec::new();
        for (i, wave) in demonstrations.iter().enumerate() {
            let d = wave.joints().index(joint)?;
            let points: Vec<(f64, f64)> = (1..=wave.harmonics())
                .map(|k| (k as f64, wave.weights()[(d, k - 1)].norm().to_degrees()))
                .collect();
            highest = points.iter().fold(highest, |h, p| h.max(p.1));
            series.push(Series {
                label: if i == 0 {
                    label("demonstrations")
                } else {
                    String::new()
                },
                color: Color::GREY.with_alpha(0.35),
                mark: Mark::Line { points, width: 1 },
            });
        }
        let mut lines = Vec::new();
        for labelled in primitives {
            let chart = labelled.primitive.chart();
            let (mut lower, mut median, mut upper) = (Vec::new(), Vec::new(), Vec::new());
            for harmonic in 1..=chart.harmonics() {
                let coordinate = Coordinate::modulus(*joint, harmonic);
                let middle = labelled.primitive.median(&coordinate)?;
                let sd = labelled.primitive.standard_deviation(&coordinate)?;
                let at = |factor: f64| (harmonic as f64, (middle * factor).to_degrees());
                lower.push(at((-sd).exp()));
                median.push(at(1.0));
                upper.push(at(sd.exp()));
            }
            highest = median.iter().fold(highest, |h, p| h.max(p.1));
            series.push(Series {
                label: String::new(),
                color: labelled.color,
                mark: Mark::Band { lower, upper },
            });
            lines.push(Series {
                label: label(labelled.label),
                color: labelled.color,
                mark: Mark::Line {
                    points: median,
                    width: 2,
                },
            });
        }
        series.append(&mut lines);
        plots.push(Plot {
            title: (*title).into(),
            x_label: "harmonic k (cycles in T)".into(),
            y_label: "|wₖ| (°)".into(),
            series,
            ..Plot::default()
        });
    }
    for plot in &mut plots {
        plot.y_range = Some((0.0, highest * 1.05));
    }
    plot::draw(&plots, joints.len(), size)
}

/// Trajectories as in figure 2 of the paper: one panel for each of `joints` (name, title), positions in degrees over one
/// period in seconds, a line for each of `waves` (label, colour, wave). `size` in px.
///
/// # Errors
/// When a joint is not among those of a wave.
pub fn trajectories(
    waves: &[(&str, Color, &Wave)],
    joints: &[(&str, &str)],
    size: (u32, u32),
) -> Result<Picture> {
    const POINTS: usize = 600;
    let mut plots = Vec::new();
    for (panel, (joint, title)) in joints.iter().enumerate() {
        let mut series = Vec::new();
        for (label, color, wave) in waves {
            let d = wave.joints().index(joint)?;
            let grid = PeriodGrid::new(POINTS, wave.harmonics());
            let positions = wave.on_grid(&grid, Derivative::Position);
            let points = grid
                .times(wave.period())
                .into_iter()
                .zip(positions.column(d).iter().map(|y| y.to_degrees()))
                .collect();
            series.push(Series {
                label: if panel == 0 {
                    (*label).into()
                } else {
                    String::new()
                },
                color: *color,
                mark: Mark::Line { points, width: 2 },
            });
        }
        plots.push(Plot {
            title: (*title).into(),
            x_label: "time (s)".into(),
            y_label: "angle (°)".into(),
            series,
            ..Plot::default()
        });
    }
    plot::draw(&plots, 1, size)
}

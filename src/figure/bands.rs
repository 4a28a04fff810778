//! Mean and standard deviation of trajectories over time.

use super::image::Color;
use super::plot::{self, Mark, Picture, Plot, Series};
use crate::error::Result;
use crate::fourier::{Derivative, PeriodGrid, Wave};
use crate::primitive::TrajectoryMoments;

/// Instants of a curve.
const POINTS: usize = 600;
/// Standard deviations on either side of the mean that a panel shows: the tails are heavy, and a draw far out would press all else flat.
const SHOWN: f64 = 2.5;

/// Moments of trajectories: for each of `joints` (name, title), the mean with the band of one standard deviation on either side,
/// in degrees (per second ..) over one period in seconds, and `draws` in thin lines behind them, cut off where they go far beyond.
/// In `columns` of panels; `size` in px.
///
/// # Errors
/// When a joint is not among those of the moments or of a draw, or the panels have no room.
pub fn bands(
    moments: &TrajectoryMoments,
    draws: &[Wave],
    derivative: Derivative,
    joints: &[(&str, &str)],
    columns: usize,
    size: (u32, u32),
) -> Result<Picture> {
    let (mean, deviation) = moments.on_grid(POINTS, derivative);
    let drawn: Vec<_> = draws
        .iter()
        .map(|wave| {
            let grid = PeriodGrid::new(POINTS, wave.harmonics());
            (wave, wave.on_grid(&grid, derivative))
        })
        .collect();
    // A period ends as it began.
    let course = |period: f64, y: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
        (0..=POINTS)
            .map(|n| {
                let t = period * n as f64 / POINTS as f64;
                (t, y(n % POINTS).to_degrees())
            })
            .collect()
    };
    let mut plots = Vec::new();
    for (panel, (joint, title)) in joints.iter().enumerate() {
        // One legend, in the first panel, is for all.
        let label = |text: &str, shown: bool| {
            if panel == 0 && shown {
                text.to_owned()
            } else {
                String::new()
            }
        };
        let mut series = Vec::new();
        for (i, (wave, values)) in drawn.iter().enumerate() {
            let d = wave.joints().index(joint)?;
            series.push(Series {
                label: label("draws", i == 0),
                color: Color::GREY.with_alpha(0.45),
                mark: Mark::Line {
                    points: course(wave.period(), &|n| values[(n, d)]),
                    width: 1,
                },
            });
        }
        let d = moments.joints().index(joint)?;
        let at = |sds: f64| {
            course(moments.period(), &|n| {
                mean[(n, d)] + sds * deviation[(n, d)]
            })
        };
        series.push(Series {
            label: label("±1 sd", true),
            color: Color::BLUE,
            mark: Mark::Band {
                lower: at(-1.0),
                upper: at(1.0),
            },
        });
        series.push(Series {
            label: label("mean", true),
            color: Color::BLUE,
            mark: Mark::Line {
                points: at(0.0),
                width: 2,
            },
        });
        let ends = at(-SHOWN).into_iter().chain(at(SHOWN)).map(|(_, y)| y);
        let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| {
            (low.min(y), high.max(y))
        });
        plots.push(Plot {
            title: (*title).into(),
            x_label: "time (s)".into(),
            y_label: match derivative {
                Derivative::Position => "angle (°)",
                Derivative::Velocity => "velocity (°/s)",
                Derivative::Acceleration => "acceleration (°/s²)",
                Derivative::Jerk => "jerk (°/s³)",
            }
            .into(),
            x_range: Some((0.0, moments.period())),
            // Without any variation the data are fitted.
            y_range: (low < high).then_some((low, high)),
            series,
            ..Plot::default()
        });
    }
    plot::draw(&plots, columns, size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::demonstration::synthetic;
    use crate::error::ErrorKind;
    use crate::primitive::{FourierMovementPrimitive, StartSpread};
    use num_complex::Complex;

    #[test]
    fn panels_are_named_and_one_legend_is_for_all() {
        let primitive = FourierMovementPrimitive::learn(&synthetic(0).unwrap(), 25).unwrap();
        let moments = primitive.moments(StartSpread::None).unwrap();
        let drawn = |draws: &[Wave], joint: &str| {
            let joints = [("elbow_flexion", "the elbow"), (joint, "another")];
            bands(&moments, draws, Derivative::Jerk, &joints, 2, (900, 300))
        };
        let svg = drawn(&[primitive.mean_wave()], "wrist_deviation")
            .unwrap()
            .svg;
        for (text, count) in [
            ("the elbow", 1),
            ("another", 1),
            ("mean", 1),
            ("draws", 1),
            ("jerk (°/s³)", 2),
        ] {
            let found = svg.matches(&format!(">\n{text}\n</text>")).count();
            assert_eq!(found, count, "{text}");
        }
        // A draw far out is cut off, the axes stay where they were.
        let wave = primitive.mean_wave();
        let far = Wave::new(
            wave.joints().clone(),
            wave.period(),
            wave.offsets().clone(),
            wave.weights() * Complex::from(1e6),
        )
        .unwrap();
        let axes = |draws: &[Wave]| -> Vec<String> {
            let svg = drawn(draws, "wrist_deviation").unwrap().svg;
            let texts = svg.lines().filter(|line| !line.starts_with('<'));
            texts.map(str::to_owned).collect()
        };
        assert_eq!(axes(&[far]), axes(&[wave]));
        assert!(!drawn(&[], "wrist_deviation").unwrap().svg.contains("draws"));
        assert_eq!(drawn(&[], "knee").unwrap_err().kind(), ErrorKind::Name);
    }
}

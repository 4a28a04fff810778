//! Clearance over time.

use super::image::Color;
use super::plot::{self, Mark, Picture, Plot, Series};
use crate::collision::{ProfileInterval, Stretch};
use crate::error::{Error, ErrorKind, Result};

/// A stretch is drawn this share of the duration wide at least: what is undecided is often too short to be seen.
const NARROWEST: f64 = 0.004;

/// The clearance of one motion.
#[derive(Debug, Clone, Copy)]
pub struct ClearanceCourse<'a> {
    /// What its panel is called, besides its worst pair; may be empty.
    pub title: &'a str,
    /// Its smallest clearance on intervals that follow each other, at least one.
    pub profile: &'a [ProfileInterval],
    /// What it must stay above \[m\].
    pub margin: f64,
    /// Where nobody can say whether it does.
    pub undecided: &'a [Stretch],
}

/// Clearance in mm over time in s, a panel a motion in `columns` of them: between what is proven and what is reached there is a
/// band, most often thin; the pair that comes nearest is named where it does, and stretches that stay undecided are marked. `size` in px.
///
/// # Errors
/// When a motion has no intervals, or the panels have no room.
pub fn clearance(
    courses: &[ClearanceCourse<'_>],
    columns: usize,
    size: (u32, u32),
) -> Result<Picture> {
    let plots = courses
        .iter()
        .map(|course| panel_of(course, courses.len() == 1))
        .collect::<Result<Vec<_>>>()?;
    plot::draw(&plots, columns, size)
}

fn panel_of(course: &ClearanceCourse<'_>, is_alone: bool) -> Result<Plot> {
    let none = || Error::new(ErrorKind::Shape, "a course of no intervals");
    let (first, last) = (
        course.profile.first().ok_or_else(none)?,
        course.profile.last().ok_or_else(none)?,
    );
    let worst = course
        .profile
        .iter()
        .min_by(|a, b| a.nearest.distance.total_cmp(&b.nearest.distance))
        .unwrap_or(first);
    // Beside others a panel has no room for a legend.
    let label = |text: &str| {
        if is_alone {
            text.to_owned()
        } else {
            String::new()
        }
    };
    let steps = |height: fn(&ProfileInterval) -> f64| -> Vec<(f64, f64)> {
        course
            .profile
            .iter()
            .flat_map(|i| [(i.from, 1e3 * height(i)), (i.to, 1e3 * height(i))])
            .collect()
    };
    let (lower, upper) = (steps(|i| i.lower), steps(|i| i.nearest.distance));
    let margin = 1e3 * course.margin;
    let ends = lower.iter().chain(&upper).map(|p| p.1);
    let (low, high) = ends.fold((0.0_f64, margin), |(low, high), y| {
        (low.min(y), high.max(y))
    });
    let duration = last.to - first.from;

    let mut series = Vec::new();
    for (i, stretch) in course.undecided.iter().enumerate() {
        let missing = 0.5 * f64::max(NARROWEST * duration - (stretch.to - stretch.from), 0.0);
        let ends = [stretch.from - missing, stretch.to + missing];
        series.push(Series {
            label: if i == 0 {
                "undecided".into()
            } else {
                String::new()
            },
            color: Color::VERMILION,
            mark: Mark::Band {
                lower: ends.map(|t| (t, low)).to_vec(),
                upper: ends.map(|t| (t, high)).to_vec(),
            },
        });
    }
    let mut lines = vec![("contact", 0.0, Color::GREY)];
    if course.margin > 0.0 {
        lines.push(("margin", margin, Color::VERMILION));
    }
    for (text, height, color) in lines {
        series.push(Series {
            label: label(text),
            color,
            mark: Mark::Line {
                points: vec![(first.from, height), (last.to, height)],
                width: 1,
            },
        });
    }
    series.push(Series {
        label: label("reached"),
        color: Color::BLUE.with_alpha(0.8),
        mark: Mark::Band {
            lower: lower.clone(),
            upper,
        },
    });
    series.push(Series {
        label: label("proven"),
        color: Color::BLUE,
        mark: Mark::Line {
            points: lower,
            width: 2,
        },
    });
    let at = (worst.nearest.time, 1e3 * worst.nearest.distance);
    let (across, up) = (0.006 * duration, 0.025 * (high - low));
    for (dx, dy) in [(across, up), (across, -up)] {
        series.push(Series {
            label: String::new(),
            color: Color::BLACK,
            mark: Mark::Line {
                points: vec![(at.0 - dx, at.1 - dy), (at.0 + dx, at.1 + dy)],
                width: 2,
            },
        });
    }
    let (a, b) = &worst.nearest.pair;
    let named = format!("{a} and {b}, {:.2} mm at {:.3} s", at.1, at.0);
    Ok(Plot {
        title: match course.title {
            "" => named,
            title => format!("{title}: {named}"),
        },
        x_label: "time (s)".into(),
        y_label: "clearance (mm)".into(),
        x_range: Some((first.from, last.to)),
        series,
        // With room for the legend.
        ..Plot::default()
    })
}

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
    /// Title of its panel.
    pub title: &'a str,
    /// Its smallest clearance on intervals that follow each other, at least one.
    pub profile: &'a [ProfileInterval],
    /// What it must stay above \[m\].
    pub margin: f64,
    /// Where nobody can say whether it does.
    pub undecided: &'a [Stretch],
}

/// Clearance in mm over time in s, a panel a motion in `columns` of them: between what is proven and what is reached there is a
/// band, most often thin; the pair that comes nearest is named, and stretches that stay undecided are marked. `size` in px.
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
        .enumerate()
        .map(|(panel, course)| panel_of(course, panel == 0))
        .collect::<Result<Vec<_>>>()?;
    plot::draw(&plots, columns, size)
}

fn panel_of(course: &ClearanceCourse<'_>, is_first: bool) -> Result<Plot> {
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
    // One legend, in the first panel, is for all, but for what has a name of its own in each.
    let label = |text: &str| {
        if is_first {
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
    let (low, high) = ends.fold((margin.min(0.0), margin), |(low, high), y| {
        (low.min(y), high.max(y))
    });
    let room = 0.05 * f64::max(high - low, 1e-3);
    let y_range = (low - room, high + room);
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
                lower: ends.map(|t| (t, y_range.0)).to_vec(),
                upper: ends.map(|t| (t, y_range.1)).to_vec(),
            },
        });
    }
    series.push(Series {
        label: label(if course.margin > 0.0 {
            "margin"
        } else {
            "contact"
        }),
        color: Color::VERMILION,
        mark: Mark::Line {
            points: vec![(first.from, margin), (last.to, margin)],
            width: 1,
        },
    });
    series.push(Series {
        label: label("proven to reached"),
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
    let cross = 0.008 * duration;
    let up = 0.02 * (y_range.1 - y_range.0);
    for (i, (dx, dy)) in [(cross, up), (cross, -up)].into_iter().enumerate() {
        series.push(Series {
            label: if i == 0 {
                format!("{} and {}", worst.nearest.pair.0, worst.nearest.pair.1)
            } else {
                String::new()
            },
            color: Color::BLACK,
            mark: Mark::Line {
                points: vec![(at.0 - dx, at.1 - dy), (at.0 + dx, at.1 + dy)],
                width: 2,
            },
        });
    }
    Ok(Plot {
        title: course.title.to_owned(),
        x_label: "time (s)".into(),
        y_label: "clearance (mm)".into(),
        x_range: Some((first.from, last.to)),
        y_range: Some(y_range),
        series,
    })
}

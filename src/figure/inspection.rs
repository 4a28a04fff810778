//! Recordings on one page: which part of each is learned, and which of them spoils the set.

use super::image::Color;
use super::plot::{self, Mark, Picture, Plot, Series};
use crate::demonstration::{Inspection, Recording, Rhythm};
use crate::error::{Error, ErrorKind, Result};

/// Width and height of a panel \[px\].
const PANEL: (u32, u32) = (330, 190);
const COLUMNS: usize = 4;
/// More rows are no page: then there are more columns.
const MOST_ROWS: usize = 40;
/// Lowest and highest point of so many stretches of time make a curve: more than a panel has pixels.
const STRETCHES: usize = 250;
/// Of all recordings the share whose lowest and highest points are beyond the axes at either side: one that is far off shall
/// not press the others flat.
const BEYOND: f64 = 0.1;
/// Characters of a panel's title and of its findings.
const LONGEST_NAME: usize = 36;
const LONGEST_CODES: usize = 48;

/// Joints one after the other; those beyond go round.
const COLORS: [Color; 8] = [
    Color::BLUE,
    Color::ORANGE,
    Color::GREEN,
    Color::PURPLE,
    Color::SKY,
    Color::BLACK,
    Color::new(150, 110, 60),
    Color::GREY,
];

/// All `recordings` with what was found, in small panels of the same angles: joints in degrees over time in s, the part that would
/// be learned shaded, and those that something spoils framed in red with its code below. Before them frequency, swing and
/// distance from the median posture of each by its number, with medians, and the joints' colours.
///
/// # Errors
/// When there are no recordings, or not as many inspections.
pub fn inspection(recordings: &[Recording], inspections: &[Inspection]) -> Result<Picture> {
    let (plots, columns, size) = page(recordings, inspections)?;
    plot::draw(&plots, columns, size)
}

/// The same as an SVG document alone, of however many recordings.
///
/// # Errors
/// Those of [`inspection`].
pub fn inspection_svg(recordings: &[Recording], inspections: &[Inspection]) -> Result<String> {
    let (plots, columns, size) = page(recordings, inspections)?;
    plot::draw_svg(&plots, columns, size)
}

fn page(
    recordings: &[Recording],
    inspections: &[Inspection],
) -> Result<(Vec<Plot>, usize, (u32, u32))> {
    if recordings.is_empty() || recordings.len() != inspections.len() {
        return Err(Error::new(
            ErrorKind::Shape,
            format!(
                "{} recordings and {} inspections",
                recordings.len(),
                inspections.len()
            ),
        )
        .expected("one for each"));
    }
    let mut plots = overview(inspections);
    plots.push(key(&recordings[0]));
    let range = range(recordings);
    for (i, (recording, inspection)) in recordings.iter().zip(inspections).enumerate() {
        plots.push(panel(i, recording, inspection, range));
    }
    let columns = COLUMNS.max(plots.len().div_ceil(MOST_ROWS));
    let rows = plots.len().div_ceil(columns) as u32;
    let size = (PANEL.0 * columns as u32, PANEL.1 * rows);
    Ok((plots, columns, size))
}

/// What is shown of each recording: its title and unit, and its value.
type Measure<'a> = (&'a str, &'a str, &'a dyn Fn(&Rhythm) -> f64);

/// Frequency, swing, posture by number.
fn overview(inspections: &[Inspection]) -> Vec<Plot> {
    let rhythms: Vec<(usize, &Rhythm, bool)> = inspections
        .iter()
        .enumerate()
        .filter_map(|(i, one)| Some((i, one.rhythm.as_ref()?, one.is_spoilt())))
        .collect();
    let joints = rhythms.first().map_or(0, |(_, r, _)| r.posture.len());
    let posture: Vec<f64> = (0..joints)
        .map(|d| middle(rhythms.iter().map(|(_, r, _)| r.posture[d]).collect()))
        .collect();
    let away = |r: &Rhythm| {
        let far = r.posture.iter().zip(&posture).map(|(a, b)| (a - b).abs());
        far.fold(0.0, f64::max).to_degrees()
    };
    let measures: [Measure; 3] = [
        ("dominant frequency", "Hz", &|r| r.variation.frequency),
        ("largest swing", "°", &|r| r.swing().to_degrees()),
        ("farthest joint from the median posture", "°", &away),
    ];
    let count = inspections.len() as f64;
    let plot = |(title, unit, measure): &Measure| {
        let values: Vec<f64> = rhythms.iter().map(|(_, r, _)| measure(r)).collect();
        let median = middle(values.clone());
        let mut series = vec![line(
            Color::GREY,
            1,
            vec![(0.5, median), (count + 0.5, median)],
        )];
        for ((i, _, spoilt), value) in rhythms.iter().zip(&values) {
            let x = *i as f64 + 1.0;
            let color = if *spoilt {
                Color::VERMILION
            } else {
                Color::BLUE
            };
            series.push(line(color, 4, vec![(x - 0.35, *value), (x + 0.35, *value)]));
        }
        let highest = values.iter().copied().fold(0.0, f64::max);
        Plot {
            title: format!("{title}, median {median:.1} {unit}"),
            x_label: "number of the recording".into(),
            y_label: (*unit).into(),
            x_range: Some((0.5, count + 0.5)),
            y_range: (highest > 0.0).then_some((0.0, 1.1 * highest)),
            names: Vec::new(),
            series,
        }
    };
    measures.iter().map(plot).collect()
}

/// The legend, in a panel of its own.
fn key(recording: &Recording) -> Plot {
    let mut series: Vec<Series> = recording
        .joints()
        .iter()
        .enumerate()
        .map(|(d, joint)| Series {
            label: joint.clone(),
            ..line(color(d), 2, Vec::new())
        })
        .collect();
    series.push(Series {
        label: "learned".into(),
        ..shade(Color::BLUE, Vec::new(), Vec::new())
    });
    series.push(Series {
        label: "look at this one".into(),
        ..line(Color::VERMILION, 4, Vec::new())
    });
    Plot {
        title: "joints".into(),
        series,
        ..Plot::default()
    }
}

/// Ends of the angles' axis \[deg\].
fn range(recordings: &[Recording]) -> Option<(f64, f64)> {
    let mut lows: Vec<f64> = recordings.iter().map(|r| r.positions().min()).collect();
    let mut highs: Vec<f64> = recordings.iter().map(|r| -r.positions().max()).collect();
    lows.sort_by(f64::total_cmp);
    highs.sort_by(f64::total_cmp);
    let at = (BEYOND * recordings.len() as f64) as usize;
    let (low, high) = (lows[at].to_degrees(), -highs[at].to_degrees());
    let margin = 0.05 * (high - low);
    (low < high).then_some((low - margin, high + margin))
}

fn panel(
    number: usize,
    recording: &Recording,
    inspection: &Inspection,
    range: Option<(f64, f64)>,
) -> Plot {
    let times = recording.times();
    let ends = (times[0], times[times.len() - 1]);
    let (low, high) = range.unwrap_or((
        recording.positions().min().to_degrees() - 1.0,
        recording.positions().max().to_degrees() + 1.0,
    ));
    let mut series: Vec<Series> = inspection
        .used
        .iter()
        .filter(|_| inspection.rhythm.is_some())
        .map(|(start, end)| {
            shade(
                Color::BLUE,
                vec![(*start, low), (*end, low)],
                vec![(*start, high), (*end, high)],
            )
        })
        .collect();
    for d in 0..recording.joints().len() {
        series.push(line(color(d), 1, course(recording, d)));
    }
    let mut codes: Vec<&str> = inspection.findings.iter().map(|f| f.flag.code()).collect();
    codes.sort_unstable();
    codes.dedup();
    if inspection.is_spoilt() {
        let corners = [
            (ends.0, low),
            (ends.1, low),
            (ends.1, high),
            (ends.0, high),
            (ends.0, low),
        ];
        series.push(line(Color::VERMILION, 4, corners.to_vec()));
    }
    let rhythm = inspection.rhythm.as_ref().map_or("no rhythm".into(), |r| {
        format!("{:.2} Hz", r.variation.frequency)
    });
    let name = shortened(file_name(recording.name()), LONGEST_NAME);
    Plot {
        title: format!("{} {name}: {rhythm}", number + 1),
        x_label: if codes.is_empty() {
            "time (s)".into()
        } else {
            shortened(&codes.join(", "), LONGEST_CODES)
        },
        y_label: "°".into(),
        x_range: Some(ends),
        y_range: Some((low, high)),
        names: Vec::new(),
        series,
    }
}

/// Positions of a joint in degrees: every sample, or the lowest and highest of each stretch of time.
fn course(recording: &Recording, joint: usize) -> Vec<(f64, f64)> {
    let y = recording.positions().column(joint);
    let at = |n: usize| (recording.times()[n], y[n].to_degrees());
    let count = recording.times().len();
    if count <= 2 * STRETCHES {
        return (0..count).map(at).collect();
    }
    let mut points = Vec::new();
    for i in 0..STRETCHES {
        let stretch = i * count / STRETCHES..(i + 1) * count / STRETCHES;
        let first = stretch.start;
        let low = stretch
            .clone()
            .fold(first, |best, n| if y[n] < y[best] { n } else { best });
        let high = stretch.fold(first, |best, n| if y[n] > y[best] { n } else { best });
        points.push(at(low.min(high)));
        points.push(at(low.max(high)));
    }
    points
}

fn line(color: Color, width: u32, points: Vec<(f64, f64)>) -> Series {
    Series {
        label: String::new(),
        color,
        mark: Mark::Line { points, width },
    }
}

fn shade(color: Color, lower: Vec<(f64, f64)>, upper: Vec<(f64, f64)>) -> Series {
    Series {
        label: String::new(),
        color,
        mark: Mark::Band { lower, upper },
    }
}

fn color(joint: usize) -> Color {
    COLORS[joint % COLORS.len()]
}

fn middle(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

fn file_name(name: &str) -> &str {
    name.rsplit(['/', '\\']).next().unwrap_or(name)
}

/// The end of a name tells more than its start.
fn shortened(text: &str, most: usize) -> String {
    let count = text.chars().count();
    if count <= most {
        return text.to_owned();
    }
    let end: String = text.chars().skip(count - most + 1).collect();
    format!("…{end}")
}

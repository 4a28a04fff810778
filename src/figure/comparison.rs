//! Models side by side: a small panel for each number, with intervals.

use super::image::Color;
use super::plot::{self, Mark, Picture, Plot, Series};
use crate::comparison::{Comparison, Distance, Estimate, Statistic};
use crate::error::Result;

/// Panels in a row.
const COLUMNS: usize = 4;

/// Half of the length of the line that marks a value, in places of the abscissa.
const HALF: f64 = 0.22;

/// Statistics, each with the demonstrations' interval as a band, energy distances, and what the best baseline lies farther off than ours. `size` in px.
///
/// # Errors
/// When `size` leaves no room for the panels.
pub fn comparison(comparison: &Comparison, size: (u32, u32)) -> Result<Picture> {
    let names: Vec<String> = comparison
        .models
        .iter()
        .map(|m| m.kind.short_name().to_owned())
        .collect();
    let colors: Vec<Color> = comparison
        .models
        .iter()
        .map(|m| {
            if m.kind.is_ours() {
                Color::BLUE
            } else {
                Color::VERMILION
            }
        })
        .collect();
    let places = names.len() as f64;
    let mut plots = Vec::new();
    let statistics = Statistic::ALL.into_iter().enumerate();
    // Of a comparison in which all have a rhythm, or stay within the range, there is nothing to be seen.
    let told = statistics.filter(|(i, _)| {
        comparison
            .models
            .iter()
            .any(|m| m.statistics[*i].value != 0.0)
    });
    for (panel, (i, statistic)) in told.enumerate() {
        let scaled = |e: Estimate| [e.value, e.lower, e.upper].map(|x| statistic.scale() * x);
        let across = |y: f64| vec![(-0.5, y), (places - 0.5, y)];
        let mut series = Vec::new();
        let demonstrated = scaled(comparison.demonstrated[i]);
        if demonstrated.iter().all(|x| x.is_finite()) {
            let [value, lower, upper] = demonstrated;
            series.push(Series {
                label: String::new(),
                color: Color::GREY,
                mark: Mark::Band {
                    lower: across(lower),
                    upper: across(upper),
                },
            });
            series.push(Series {
                label: if panel == 0 {
                    "demonstrations".into()
                } else {
                    String::new()
                },
                color: Color::GREY,
                mark: Mark::Line {
                    points: across(value),
                    width: 1,
                },
            });
        }
        for (place, model) in comparison.models.iter().enumerate() {
            series.extend(interval(place, scaled(model.statistics[i]), colors[place]));
        }
        plots.push(Plot {
            y_label: statistic.label().into(),
            names: names.clone(),
            series,
            ..Plot::default()
        });
    }
    for (i, distance) in Distance::ALL.into_iter().enumerate() {
        let of = |e: Estimate| [e.value, e.lower, e.upper];
        let models = comparison.models.iter().enumerate();
        plots.push(Plot {
            y_label: format!("energy distance of {}", distance.name()),
            names: names.clone(),
            series: models
                .flat_map(|(place, m)| interval(place, of(m.distances[i]), colors[place]))
                .collect(),
            ..Plot::default()
        });
    }
    let paired = comparison
        .paired
        .iter()
        .filter(|p| p.ours == comparison.models[0].kind);
    let mut series = vec![Series {
        label: String::new(),
        color: Color::GREY,
        mark: Mark::Line {
            points: vec![(-0.5, 0.0), (Distance::ALL.len() as f64 - 0.5, 0.0)],
            width: 1,
        },
    }];
    let mut names = Vec::new();
    for (place, p) in paired.enumerate() {
        // Of another size each: in shares of the baseline's own.
        let baseline = comparison.models.iter().find(|m| m.kind == p.baseline);
        let whole = baseline.map_or(1.0, |m| m.distances[place].value);
        let percent = [p.difference.value, p.difference.lower, p.difference.upper];
        series.extend(interval(
            place,
            percent.map(|x| 100.0 * x / whole),
            Color::BLUE,
        ));
        names.push(p.distance.name().to_owned());
    }
    plots.push(Plot {
        y_label: format!(
            "{} nearer than best baseline [%]",
            comparison.models[0].kind.short_name()
        ),
        names,
        series,
        ..Plot::default()
    });
    plot::draw(&plots, COLUMNS, size)
}

/// A line from end to end of an interval, and one across at the value; nothing where they are not known.
fn interval(place: usize, [value, lower, upper]: [f64; 3], color: Color) -> Vec<Series> {
    if ![value, lower, upper].iter().all(|x| x.is_finite()) {
        return Vec::new();
    }
    let at = place as f64;
    let line = |points: Vec<(f64, f64)>, width| Series {
        label: String::new(),
        color,
        mark: Mark::Line { points, width },
    };
    vec![
        line(vec![(at, lower), (at, upper)], 2),
        line(vec![(at - HALF, value), (at + HALF, value)], 3),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comparison::ComparisonOptions;
    use crate::demonstration::synthetic;

    #[test]
    fn every_model_has_its_place_in_every_panel() {
        let options = ComparisonOptions {
            draws: 3,
            folds: Some(3),
            threads: 2,
            ..ComparisonOptions::default()
        };
        let demonstrations = synthetic(0).unwrap();
        let compared = Comparison::new(demonstrations.recordings(), &options, || ()).unwrap();
        let picture = comparison(&compared, (1440, 1160)).unwrap();
        let told = |text: &str| picture.svg.matches(&format!(">\n{text}\n</text>")).count();
        for distance in Distance::ALL {
            assert_eq!(told(&format!("energy distance of {}", distance.name())), 1);
        }
        let panels = told(compared.models[0].kind.short_name());
        assert!(panels >= 2 * Distance::ALL.len(), "{panels}");
        for model in &compared.models {
            assert_eq!(told(model.kind.short_name()), panels);
        }
    }
}

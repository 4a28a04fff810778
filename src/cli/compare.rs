//! `undulate compare`.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::recordings::Recordings;
use super::trajectory::Form;
use super::{Outcome, output};
use crate::baseline::Resolution;
use crate::comparison::{
    Compared, Comparison, ComparisonOptions, Conditioned, DISTANCES, Distance, Estimate, Statistic,
};
use crate::error::{Error, ErrorKind, Result};
use crate::figure;

/// Width and height of the figure \[px\].
const SIZE: (u32, u32) = (1440, 1160);

/// What is given to the models in turn.
const GIVEN: [&str; 3] = ["nothing", "its swing", "its frequency"];

/// Compare our models with movement primitives of other kinds on the same left-out demonstrations.
#[derive(Args)]
#[command(
    after_help = "Every demonstration is left out once (of more than 40, a tenth at a time). Motions as long as it, at its rate, are drawn from models that are learned from\n\
    the rest: ours with a cycle of each recording's own tempo and its residual, ours with a common period, a stroke ProMP, a rhythmic ProMP with each recording's own\n\
    tempo, and a Gaussian over real and imaginary parts. All are aligned, and their covariances shrunk, as ours are. Energy distances tell how far draws\n\
    lie from what was left out; less is better, and copying does not help. Intervals are of demonstrations that are resampled (bootstrap, expanded\n\
    percentiles). What is compared is exact for a seed; times are not.\n\n\
    Examples:\n  \
    undulate compare recordings/ -o compare.svg\n  \
    undulate compare --draws 200 --json > compare.json"
)]
pub(super) struct Arguments {
    #[command(flatten)]
    recordings: Recordings,
    /// The highest harmonic of the common period; the stroke ProMP has as many bases as that has weights.
    #[arg(long, short = 'k', value_name = "K", default_value_t = 25)]
    harmonics: usize,
    /// The highest harmonic of a cycle; the rhythmic ProMP has as many bases as that has weights.
    #[arg(long, value_name = "H", default_value_t = 4)]
    cycle_harmonics: usize,
    /// Draw cycles without what they leave.
    #[arg(long)]
    no_residual: bool,
    /// How many motions are drawn of each model for each left-out demonstration.
    #[arg(short = 'n', long, value_name = "N", default_value_t = 50)]
    draws: u64,
    /// Seed of draws and of the bootstrap.
    #[arg(long, value_name = "SEED", default_value_t = 0)]
    draw_seed: u64,
    /// Deal the demonstrations into so many folds [default: each alone, ten where there are more than 40].
    #[arg(long, value_name = "FOLDS")]
    folds: Option<usize>,
    /// Of the intervals.
    #[arg(long, value_name = "SHARE", default_value_t = 0.95)]
    confidence: f64,
    /// Threads [default: one a core].
    #[arg(long, short, value_name = "N")]
    jobs: Option<usize>,
    /// A figure (.svg or .png): a panel for each number.
    #[arg(long, short = 'o', value_name = "FILE")]
    figure: Option<PathBuf>,
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    let form = arguments.figure.as_deref().map(Form::of).transpose()?;
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let threads = match arguments.jobs {
        Some(0) => return Err(Error::new(ErrorKind::Setting, "0 jobs").expected("at least 1")),
        jobs => jobs.unwrap_or(cores),
    };
    let recordings = arguments.recordings.gestures()?;
    let options = ComparisonOptions {
        draws: arguments.draws,
        seed: arguments.draw_seed,
        folds: arguments.folds,
        confidence: arguments.confidence,
        resolution: Resolution {
            harmonics: arguments.harmonics,
            cycle_harmonics: arguments.cycle_harmonics,
            residual: !arguments.no_residual,
        },
        threads,
    };
    let folds = arguments.folds.unwrap_or(recordings.len());
    let bar = output::progress(folds as u64, "leaving out demonstrations");
    let comparison = Comparison::new(&recordings, &options, || bar.inc(1))?;
    bar.finish_and_clear();
    for left_out in &comparison.unusable {
        output::warn(format!(
            "{} is left out: {}",
            left_out.name, left_out.reason
        ));
    }
    if let (Some(path), Some(form)) = (&arguments.figure, form) {
        let picture = figure::comparison(&comparison, SIZE)?;
        output::write(path, &form.bytes(picture))?;
    }
    output::report(json, &value(&comparison, arguments), || {
        words(&comparison, arguments)
    });
    Ok(Outcome::Done)
}

fn value(comparison: &Comparison, arguments: &Arguments) -> Value {
    let number = |e: &Estimate| json!({"value": e.value, "lower": e.lower, "upper": e.upper});
    let statistics = |estimates: &[Estimate]| -> Value {
        let entries = Statistic::ALL.iter().zip(estimates);
        entries
            .map(|(s, e)| (s.key().to_owned(), number(e)))
            .collect()
    };
    let distances = |estimates: &[Estimate; DISTANCES]| -> Value {
        let entries = Distance::ALL.iter().zip(estimates);
        entries
            .map(|(d, e)| (d.name().to_owned(), number(e)))
            .collect()
    };
    let given = |given: &std::result::Result<Conditioned, String>| match given {
        Err(reason) => json!({"refused": reason}),
        Ok(conditioned) => json!({
            "swing_off": number(&conditioned.swing_off),
            "frequency_off": number(&conditioned.frequency_off),
            "distances": distances(&conditioned.distances),
        }),
    };
    let models = comparison.models.iter().map(|m| {
        json!({
            "model": m.kind.name(),
            "ours": m.kind.is_ours(),
            "statistics": statistics(&m.statistics),
            "distances": distances(&m.distances),
            "given": {"nothing": given(&m.given[0]), "swing": given(&m.given[1]), "frequency": given(&m.given[2])},
        })
    });
    let seconds: Value = comparison
        .models
        .iter()
        .map(|m| {
            let s = m.seconds;
            let seconds = json!({"learn": s.learn, "condition": s.condition, "draw": s.draw});
            (m.kind.name().to_owned(), seconds)
        })
        .collect();
    json!({
        "demonstrations": comparison.demonstrations,
        "left_out": comparison.unusable.iter().map(|l| json!({"name": l.name, "reason": l.reason})).collect::<Vec<_>>(),
        "folds": comparison.folds,
        "draws": arguments.draws,
        "seed": arguments.draw_seed,
        "confidence": arguments.confidence,
        "interval": "bootstrap over demonstrations, expanded percentiles",
        "dominant": comparison.dominant,
        "demonstrated": statistics(&comparison.demonstrated),
        "models": models.collect::<Vec<_>>(),
        "paired": comparison.paired.iter().map(|p| json!({
            "distance": p.distance.name(),
            "ours": p.ours.name(),
            "baseline": p.baseline.name(),
            "baseline_less_ours": number(&p.difference),
        })).collect::<Vec<_>>(),
        "figure": arguments.figure,
        "seconds": seconds,
    })
}

fn words(comparison: &Comparison, arguments: &Arguments) -> String {
    let figure = arguments
        .figure
        .as_ref()
        .map_or_else(String::new, |path| format!("\n\nwrote {}", path.display()));
    format!(
        "{} demonstrations in {} folds, {} motions of each model for each; {} % intervals\n\n{}\n\n\
         Distances of the best baseline less ours, demonstration by demonstration: more than 0 is nearer\n\n{}\n\n\
         Given something of the left-out demonstration (swing of `{}`): how far draws are off it, root mean square, and energy distances\n\n{}\n\n{}{figure}",
        comparison.demonstrations.len(),
        comparison.folds,
        arguments.draws,
        100.0 * arguments.confidence,
        statistics(comparison),
        paired(comparison),
        comparison.dominant,
        given(comparison),
        seconds(comparison),
    )
}

fn cell(estimate: Estimate, scale: f64, decimals: usize) -> String {
    let [value, lower, upper] = [estimate.value, estimate.lower, estimate.upper]
        .map(|x| format!("{:.decimals$}", scale * x));
    if estimate.value.is_finite() {
        format!("{value} ({lower} .. {upper})")
    } else {
        "-".into()
    }
}

fn statistics(comparison: &Comparison) -> String {
    let mut header = vec!["", "demonstrations"];
    header.extend(comparison.models.iter().map(|m| m.kind.name()));
    let mut rows = Vec::new();
    for (i, statistic) in Statistic::ALL.into_iter().enumerate() {
        let own = comparison.demonstrated[i];
        let all = std::iter::once(own).chain(comparison.models.iter().map(|m| m.statistics[i]));
        let cells = all.map(|e| cell(e, statistic.scale(), 1));
        rows.push(
            std::iter::once(statistic.label().to_owned())
                .chain(cells)
                .collect(),
        );
    }
    for (i, distance) in Distance::ALL.into_iter().enumerate() {
        let mut row = vec![
            format!("energy distance of {}", distance.name()),
            String::new(),
        ];
        row.extend(
            comparison
                .models
                .iter()
                .map(|m| cell(m.distances[i], 1.0, 2)),
        );
        rows.push(row);
    }
    output::table(&header, &rows)
}

fn paired(comparison: &Comparison) -> String {
    let rows: Vec<Vec<String>> = comparison
        .paired
        .iter()
        .map(|p| {
            vec![
                p.distance.name().to_owned(),
                p.ours.name().to_owned(),
                p.baseline.name().to_owned(),
                cell(p.difference, 1.0, 3),
                match (p.is_clear(), p.difference.value) {
                    // Of ours no draw has a rhythm.
                    (_, f64::NEG_INFINITY) => "lost".to_owned(),
                    (false, _) => "open".to_owned(),
                    (true, 0.0..) => "won".to_owned(),
                    (true, _) => "lost".to_owned(),
                },
            ]
        })
        .collect();
    output::table(
        &["distance", "ours", "best baseline", "difference", ""],
        &rows,
    )
}

fn given(comparison: &Comparison) -> String {
    let mut header = vec!["given", "model", "swing off [%]", "tempo off [%]"];
    header.extend(Distance::ALL.map(Distance::name));
    let mut rows = Vec::new();
    for (i, what) in GIVEN.into_iter().enumerate() {
        for model in &comparison.models {
            let mut row = vec![what.to_owned(), model.kind.name().to_owned()];
            match &model.given[i] {
                Err(_) => row.push("cannot".into()),
                Ok(c) => {
                    row.push(cell(c.swing_off, 100.0, 1));
                    row.push(cell(c.frequency_off, 100.0, 1));
                    row.extend(c.distances.map(|d| cell(d, 1.0, 2)));
                }
            }
            rows.push(row);
        }
    }
    output::table(&header, &rows)
}

fn seconds(comparison: &Comparison) -> String {
    let row = |m: &Compared| {
        let milliseconds = |s: f64| format!("{:.3}", 1e3 * s);
        vec![
            m.kind.name().to_owned(),
            milliseconds(m.seconds.learn),
            m.seconds
                .condition
                .map_or_else(|| "cannot".into(), milliseconds),
            milliseconds(m.seconds.draw),
        ]
    };
    let rows: Vec<Vec<String>> = comparison.models.iter().map(row).collect();
    output::table(&["median [ms]", "learn", "condition", "draw"], &rows)
}

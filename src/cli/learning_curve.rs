//! `undulate learning-curve`.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::assumptions::Assumptions;
use super::learn::{self, Period};
use super::learn_cycle;
use super::recordings::Recordings;
use super::trajectory::Form;
use super::{Outcome, output};
use crate::demonstration::CycleFits;
use crate::error::Result;
use crate::figure::{Color, Mark, Plot, Series, draw};
use crate::primitive::{ChartForm, CurvePoint, Example, LearningCurve, LoneEnd, SampleMean, Seen};

/// Ends of quantities that are told.
const TOLD: usize = 5;
/// Width and height of the figure \[px\].
const SIZE: (u32, u32) = (900, 500);
/// Width of its line \[px\].
const WIDTH: u32 = 3;

/// How many demonstrations are enough, what each is worth, and which to record next.
#[derive(Args)]
#[command(
    after_help = "Every recording is left out in turn, and models of more and more of the others, in random orders, say how probable it is given its own largest\n\
    modulus or swing (nats a dimension; higher is better). The worth of a recording is what a model loses without it, on the others. What to record\n\
    next is where the model rests on one recording: its leverage, from 1 over their number to 1, is its own share in what the model says of such waves.\n\n\
    Examples:\n  \
    undulate learning-curve recordings/ --period cycle -o curve.svg\n  \
    undulate learning-curve recordings/ --draws 20"
)]
pub(super) struct Arguments {
    #[command(flatten)]
    recordings: Recordings,
    /// What a period is, as in `undulate learn`.
    #[arg(long, value_enum, default_value_t = Period::Common)]
    period: Period,
    /// The highest harmonic, K [default: 25 of a common period, 4 of a cycle].
    #[arg(long, short = 'k', value_name = "K")]
    harmonics: Option<usize>,
    #[command(flatten)]
    assumptions: Assumptions,
    /// From how many random orders of the recordings models are learned.
    #[arg(long, value_name = "N", default_value_t = 4)]
    draws: u64,
    /// Draw the curve.
    #[arg(long, short, value_name = "FILE.svg|FILE.png")]
    output: Option<PathBuf>,
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    let form_of_picture = arguments.output.as_deref().map(Form::of).transpose()?;
    let (names, examples, form) = arguments.examples()?;
    let estimator = arguments.assumptions.options().estimator;
    let bar = output::progress(1, "learning from some of the recordings");
    let curve = LearningCurve::of(&examples, &form, estimator, arguments.draws, 0)?;
    let worth = if examples.len() > 4 {
        LearningCurve::worth(&examples, &form, estimator)?
    } else {
        Vec::new()
    };
    let ends = LoneEnd::all(&examples)?;
    bar.finish_and_clear();
    if let (Some(path), Some(form)) = (&arguments.output, form_of_picture) {
        let picture = draw(&[plot(curve.points())], 1, SIZE)?;
        output::write(path, &form.bytes(picture))?;
    }

    let estimate = |e: SampleMean| json!({"mean": e.mean, "standard_error": e.error});
    let value = json!({
        "curve": curve.points().iter().map(|p| json!({
            "demonstrations": p.demonstrations,
            "density": p.density.mean,
            "standard_error": p.density.error,
        })).collect::<Vec<_>>(),
        "last_doubling": curve.last_doubling().map(estimate),
        "next_doubling": curve.next_doubling().map(estimate),
        "still_rises": curve.last_doubling().map(SampleMean::is_certain),
        "worth": worth.iter().zip(&names).map(|(w, name)| json!({
            "name": name, "density": w.mean, "standard_error": w.error,
        })).collect::<Vec<_>>(),
        "record_next": ends.iter().map(|end| json!({
            "quantity": quantity(&end.seen),
            "wish": wish(end),
            "value": end.value,
            "typical": end.typical,
            "leverage": end.leverage,
            "rests_on": names[end.demonstration],
        })).collect::<Vec<_>>(),
        "figure": arguments.output,
    });
    output::report(json, &value, || {
        let mut parts = vec![points(curve.points()), verdict(&curve)];
        if !worth.is_empty() {
            parts.push(worths(&names, &worth));
        }
        parts.push(nexts(&names, &ends));
        if let Some(path) = &arguments.output {
            parts.push(format!("wrote {}", path.display()));
        }
        parts.join("\n\n")
    });
    Ok(Outcome::Done)
}

impl Arguments {
    /// The recordings' names, what is learned of them, and in which form.
    fn examples(&self) -> Result<(Vec<String>, Vec<Example>, ChartForm)> {
        let options = self.assumptions.options();
        match self.period {
            Period::Common => {
                let demonstrations = self.recordings.demonstrations()?;
                let waves = demonstrations.fit(self.harmonics.unwrap_or(learn::HARMONICS))?;
                let recordings = demonstrations.recordings().iter();
                let names = recordings.map(|r| r.name().to_owned()).collect();
                let examples = options.examples(&waves)?;
                let form = options.form(&examples)?;
                Ok((names, examples, form))
            }
            Period::Cycle => {
                let harmonics = self.harmonics.unwrap_or(learn_cycle::HARMONICS);
                let fits = CycleFits::new(&self.recordings.gestures()?, harmonics)?;
                let names = fits.fits().iter().map(|fit| fit.name.clone()).collect();
                let examples = fits.fits().iter().map(Example::from).collect();
                Ok((names, examples, options.form_of_cycles(&fits, 1)?))
            }
        }
    }
}

fn told(estimate: SampleMean) -> String {
    format!("{:.3} +- {:.3}", estimate.mean, estimate.error)
}

fn points(points: &[CurvePoint]) -> String {
    let rows: Vec<Vec<String>> = points
        .iter()
        .map(|p| vec![p.demonstrations.to_string(), told(p.density)])
        .collect();
    output::table(
        &["learned from", "density of a left-out one [nats/dim]"],
        &rows,
    )
}

fn verdict(curve: &LearningCurve) -> String {
    let (Some(last), Some(next)) = (curve.last_doubling(), curve.next_doubling()) else {
        return "too few recordings to say whether more would help: record six".to_owned();
    };
    if last.is_certain() {
        format!(
            "twice as many gave {}: the curve still rises. Twice as many again would give about {}, if what is missing falls like 1/M",
            told(last),
            told(next)
        )
    } else {
        format!(
            "twice as many gave {}, no more than the error: more recordings of the same would not be seen to help",
            told(last)
        )
    }
}

/// From the most useful to the one that spoils most.
fn worths(names: &[String], worth: &[SampleMean]) -> String {
    let mut order: Vec<usize> = (0..worth.len()).collect();
    order.sort_by(|a, b| worth[*b].mean.total_cmp(&worth[*a].mean));
    let rows: Vec<Vec<String>> = order
        .into_iter()
        .map(|m| {
            let spoils = SampleMean {
                mean: -worth[m].mean,
                ..worth[m]
            };
            let word = match (worth[m].is_certain(), spoils.is_certain()) {
                (true, _) => "helps",
                (_, true) => "spoils the set: look at it",
                _ => "",
            };
            vec![names[m].clone(), told(worth[m]), word.to_owned()]
        })
        .collect();
    output::table(&["recording", "worth to the others [nats/dim]", ""], &rows)
}

fn nexts(names: &[String], ends: &[LoneEnd]) -> String {
    let rows: Vec<Vec<String>> = ends
        .iter()
        .take(TOLD)
        .map(|end| {
            let value = |x: f64| match end.seen {
                Seen::Tempo => format!("{x:.2} Hz"),
                Seen::Swing(_) | Seen::Posture(_) => format!("{} deg", output::degrees(x)),
            };
            vec![
                wish(end),
                format!("about {}", value(end.value)),
                value(end.typical),
                format!("{:.0} %", 100.0 * end.leverage),
                names[end.demonstration].clone(),
            ]
        })
        .collect();
    output::table(&["record next", "at", "typical", "rests by", "on"], &rows)
}

fn quantity(seen: &Seen) -> String {
    match seen {
        Seen::Tempo => "tempo".to_owned(),
        Seen::Swing(joint) => format!("swing of {joint}"),
        Seen::Posture(joint) => format!("posture of {joint}"),
    }
}

/// What to ask of a demonstrator.
fn wish(end: &LoneEnd) -> String {
    let of = |more: &str, less: &str| if end.is_high { more } else { less }.to_owned();
    match &end.seen {
        Seen::Tempo => of("a faster wave", "a slower wave"),
        Seen::Swing(joint) => of("more", "less") + " swing of " + joint,
        Seen::Posture(joint) => of("a higher", "a lower") + " posture of " + joint,
    }
}

fn plot(points: &[CurvePoint]) -> Plot {
    let at = |sign: f64| {
        let value = move |p: &CurvePoint| p.density.mean + sign * p.density.error;
        points
            .iter()
            .map(move |p| (p.demonstrations as f64, value(p)))
            .collect::<Vec<_>>()
    };
    let color = Color::BLUE;
    Plot {
        title: "A left-out demonstration, given its own size".to_owned(),
        x_label: "demonstrations".to_owned(),
        y_label: "density [nats/dim]".to_owned(),
        series: vec![
            Series {
                label: "one standard error".to_owned(),
                color,
                mark: Mark::Band {
                    lower: at(-1.0),
                    upper: at(1.0),
                },
            },
            Series {
                label: "mean".to_owned(),
                color,
                mark: Mark::Line {
                    points: at(0.0),
                    width: WIDTH,
                },
            },
        ],
        ..Plot::default()
    }
}

//! `undulate learn --kinds`.

use std::collections::BTreeMap;
use std::path::Path;
use std::str::FromStr;

use serde_json::json;

use super::learn::Arguments;
use super::{Outcome, output};
use crate::error::{Error, ErrorKind, Result};
use crate::primitive::{
    ChartForm, Component, Coordinate, Estimator, Example, FourierMovementPrimitive, Grouping,
    GroupingOptions, Kinds, Mixture,
};

/// A recording of which its kind is less certain than this is worth a word.
const CERTAIN: f64 = 0.9;
/// Recordings that make a kind.
const FEWEST: usize = 3;

/// Where kinds come from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum KindsFrom {
    /// They are found, as many as left-out recordings ask for.
    Data,
    /// So many are found.
    Number(usize),
    /// Each folder of recordings is one, and gives its name.
    Folders,
}

impl FromStr for KindsFrom {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        match (text, text.parse::<usize>()) {
            ("auto", _) => Ok(Self::Data),
            ("folders", _) => Ok(Self::Folders),
            (_, Ok(number)) if number > 0 => Ok(Self::Number(number)),
            _ => Err(Error::new(ErrorKind::Setting, format!("`{text}` kinds"))
                .expected("auto, folders or a number")),
        }
    }
}

/// Learns a mixture of the demonstrations of these names.
pub(super) fn run(
    arguments: &Arguments,
    from: KindsFrom,
    names: &[String],
    (examples, form): (&[Example], &ChartForm),
    estimator: Estimator,
    json: bool,
) -> Result<Outcome> {
    let found = |kinds| {
        let options = GroupingOptions {
            kinds,
            ..GroupingOptions::default()
        };
        Grouping::find(examples, form, &options)
    };
    let bar = output::progress(1, "looking for kinds");
    let grouping = match from {
        KindsFrom::Data => found(GroupingOptions::default().kinds)?,
        KindsFrom::Number(number) => found(Kinds::Number(number))?,
        KindsFrom::Folders => Grouping::labelled(&folders(names)?)?,
    };
    bar.finish_and_clear();
    let mixture = Mixture::learn(examples, form, estimator, &grouping)?;
    output::write(&arguments.output, mixture.to_json().as_bytes())?;

    let responsibilities = grouping.responsibilities();
    let sure = |m: usize| responsibilities[(m, grouping.kind(m))];
    for (m, name) in names.iter().enumerate().filter(|(m, _)| sure(*m) < CERTAIN) {
        output::warn(format!(
            "{name} is between kinds: {} only by {:.0} %",
            grouping.names()[grouping.kind(m)],
            100.0 * sure(m)
        ));
    }
    let value = json!({
        "model": arguments.output,
        "kinds": mixture.components().iter().map(|c| json!({
            "name": c.name,
            "weight": c.weight,
            "frequency_hz": look(&c.primitive).map(|l| l.0),
            "swing_rad": look(&c.primitive).map(|l| l.1),
            "swinging_joint": look(&c.primitive).map(|l| l.2),
            "rank": c.primitive.gaussian().rank(),
        })).collect::<Vec<_>>(),
        "demonstrations": names.iter().enumerate().map(|(m, name)| json!({
            "name": name,
            "kind": grouping.names()[grouping.kind(m)],
            "responsibilities": responsibilities.row(m).iter().collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
        "held_out": grouping.held_out().iter().map(|h| json!({
            "kinds": h.kinds,
            "density": h.density,
            "less_than_best": h.less_than_best,
            "standard_error": h.error,
        })).collect::<Vec<_>>(),
        "log_likelihoods": grouping.log_likelihoods(),
    });
    output::report(json, &value, || {
        let rows: Vec<Vec<String>> = names
            .iter()
            .enumerate()
            .map(|(m, name)| {
                let kind = grouping.names()[grouping.kind(m)].clone();
                vec![name.clone(), kind, format!("{:.1} %", 100.0 * sure(m))]
            })
            .collect();
        let kinds: Vec<String> = mixture
            .components()
            .iter()
            .map(|c| format!("{} {:.0} %", c.name, 100.0 * c.weight))
            .collect();
        let mut text = output::table(&["recording", "kind", "probability"], &rows);
        if !grouping.held_out().is_empty() {
            text.push_str(&format!("\n\n{}", numbers(&grouping)));
            text.push_str("\ntaken are as few as are within the error of the best");
        }
        if let Some(looks) = looks(mixture.components()) {
            text.push_str(&format!("\n\n{looks}"));
        }
        text.push_str(&format!(
            "\n\n{} kinds of wave: {}\nwrote {}",
            kinds.len(),
            kinds.join(", "),
            arguments.output.display()
        ));
        text
    });
    Ok(Outcome::Done)
}

/// Median frequency \[Hz\], largest median swing \[rad\] and its joint, of a model of cycles.
fn look(primitive: &FourierMovementPrimitive) -> Option<(f64, f64, String)> {
    let frequency = primitive.median(&Coordinate::Frequency).ok()?;
    let swings = primitive.chart().joints().iter().filter_map(|joint| {
        let joint = joint.clone();
        let swing = primitive.median(&Coordinate::Swing {
            joint: joint.clone(),
        });
        Some((swing.ok()?, joint))
    });
    let (swing, joint) = swings.max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some((frequency, swing, joint))
}

/// How the kinds wave, where they are of cycles.
fn looks(components: &[Component]) -> Option<String> {
    let rows = components
        .iter()
        .map(|c| {
            let (frequency, swing, joint) = look(&c.primitive)?;
            Some(vec![
                c.name.clone(),
                format!("{:.0} %", 100.0 * c.weight),
                format!("{frequency:.2} Hz"),
                format!("{} deg of {joint}", output::degrees(swing)),
            ])
        })
        .collect::<Option<Vec<_>>>()?;
    Some(output::table(
        &["kind", "weight", "median frequency", "largest swing"],
        &rows,
    ))
}

/// How probable left-out recordings are, by number of kinds.
fn numbers(grouping: &Grouping) -> String {
    let rows: Vec<Vec<String>> = grouping
        .held_out()
        .iter()
        .map(|h| {
            vec![
                h.kinds.to_string(),
                format!("{:.3}", h.density),
                if h.error > 0.0 {
                    format!("{:.3} +- {:.3}", -h.less_than_best, h.error)
                } else {
                    "best".to_owned()
                },
            ]
        })
        .collect();
    output::table(
        &[
            "kinds",
            "density of left-out ones [nats/dim]",
            "less the best",
        ],
        &rows,
    )
}

/// The names of the folders that files are in.
fn folders(names: &[String]) -> Result<Vec<String>> {
    let refuse = |what: String, at: &str| {
        Error::new(ErrorKind::Setting, what)
            .expected("--kinds folders, with a folder of its own name, and three recordings at least, for each kind")
            .at(at.to_owned())
    };
    let mut kinds: BTreeMap<String, (&Path, usize)> = BTreeMap::new();
    let mut of_each = Vec::new();
    for name in names {
        let folder = Path::new(name).parent().unwrap_or(Path::new(""));
        let Some(kind) = folder.file_name() else {
            return Err(refuse("a recording in no folder of a name".into(), name));
        };
        let kind = kind.to_string_lossy().into_owned();
        let (first, count) = kinds.entry(kind.clone()).or_insert((folder, 0));
        if *first != folder {
            let what = format!("two folders named `{kind}`: {}", first.display());
            return Err(refuse(what, &folder.display().to_string()));
        }
        *count += 1;
        of_each.push(kind);
    }
    match kinds.values().find(|(_, count)| *count < FEWEST) {
        Some((folder, count)) => Err(refuse(
            format!("{count} recordings of a kind"),
            &folder.display().to_string(),
        )),
        None => Ok(of_each),
    }
}

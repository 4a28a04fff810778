//! `undulate inspect-demos`.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use super::learn::warn_of_units;
use super::recordings::Recordings;
use super::trajectory::Form;
use super::{Outcome, output};
use crate::demonstration::{Finding, Inspection, Recording};
use crate::error::{Error, ErrorKind, Result};
use crate::figure;

/// Look at recordings before they are learned: which part is rhythmic, how it goes, and what may spoil the set.
#[derive(Args)]
#[command(
    mut_arg("duration", |option| option.hide(true)),
    mut_arg("remove_drift", |option| option.hide(true)),
    mut_arg("uncut", |option| option.hide(true)),
    after_help = "Of each recording are shown: the part that would be learned, its cycles, frequency and jitter from cycle to cycle, the energy beyond four\n\
    harmonics of a cycle, the step from its end to its start, and findings by code: gaps, frozen frames, jumps, joints that stand still, a shoulder near\n\
    its singularity, no rhythm, and what is far from the median of the set. `--codes` lists them. The figure has all recordings on one page.\n\n\
    Examples:\n  \
    undulate inspect-demos recordings/ -o page.svg\n  \
    undulate inspect-demos --list set.txt --root recordings --json"
)]
pub(super) struct Arguments {
    #[command(flatten)]
    recordings: Recordings,
    /// The page to draw.
    #[arg(long, short, value_name = "FILE.svg|FILE.png")]
    output: Option<PathBuf>,
    /// Print the codes of findings and what they mean.
    #[arg(long)]
    codes: bool,
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    if arguments.codes {
        codes(json);
        return Ok(Outcome::Done);
    }
    if let Some(option) = arguments.recordings.about_gestures() {
        return Err(Error::new(
            ErrorKind::Setting,
            format!("{option} with recordings that are looked at as they are"),
        )
        .expected("it for `learn`"));
    }
    let form = arguments.output.as_deref().map(Form::of).transpose()?;
    let (recordings, unreadable) = arguments.recordings.readable()?;
    warn_of_units(&recordings);
    let inspections = Inspection::of_set(&recordings)?;
    if let (Some(path), Some(form)) = (&arguments.output, form) {
        let bytes = match form {
            Form::Svg => figure::inspection_svg(&recordings, &inspections)?.into_bytes(),
            Form::Png => figure::inspection(&recordings, &inspections)?.png,
        };
        output::write(path, &bytes)?;
    }
    let spoilt = inspections.iter().filter(|i| i.is_spoilt()).count();
    let value = json!({
        "recordings": inspections.iter().zip(&recordings).map(|(i, r)| told(i, r)).collect::<Vec<_>>(),
        "unreadable": unreadable.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "spoilt": spoilt,
        "figure": arguments.output,
    });
    output::report(json, &value, || {
        let mut text = table(&inspections);
        let findings = findings(&inspections);
        if !findings.is_empty() {
            text.push_str(&format!("\n\n{findings}"));
        }
        for error in &unreadable {
            text.push_str(&format!("\n\ncannot be learned: {error}"));
        }
        text.push_str(&format!(
            "\n\n{} recordings, {} with something to look at",
            inspections.len() + unreadable.len(),
            spoilt + unreadable.len()
        ));
        if let Some(path) = &arguments.output {
            text.push_str(&format!("\nwrote {}", path.display()));
        }
        text
    });
    Ok(Outcome::Done)
}

fn codes(json: bool) {
    use crate::demonstration::Flag;
    let value = Flag::ALL
        .iter()
        .map(|flag| json!({"code": flag.code(), "meaning": flag.meaning()}))
        .collect::<Value>();
    output::report(json, &value, || {
        let rows: Vec<Vec<String>> = Flag::ALL
            .iter()
            .map(|flag| vec![format!("{:14} {}", flag.code(), flag.meaning())])
            .collect();
        output::table(&["code           meaning"], &rows)
    });
}

fn told(inspection: &Inspection, recording: &Recording) -> Value {
    json!({
        "name": inspection.name,
        "span_s": recording.span(),
        "used_s": inspection.used,
        "parts": inspection.parts.iter().map(|part| json!({
            "start_s": part.start,
            "end_s": part.end,
            "cycles": part.cycles,
            "frequency_hz": part.frequency,
        })).collect::<Vec<_>>(),
        "rhythm": inspection.rhythm.as_ref().map(|rhythm| json!({
            "start_s": rhythm.part.start,
            "end_s": rhythm.part.end,
            "cycles": rhythm.part.cycles,
            "frequency_hz": rhythm.variation.frequency,
            "dominant_joint": recording.joints().name(rhythm.variation.dominant),
            "swing_rad": rhythm.variation.swing,
            "posture_rad": rhythm.posture.as_slice(),
            "amplitude_varies_by": rhythm.variation.envelope,
            "tempo_varies_by": rhythm.variation.tempo,
            "residual_energy": rhythm.leakage.residual_energy,
            "end_jump_rad": rhythm.leakage.end_jump,
            "end_jump_joint": rhythm.leakage.end_jump_joint,
        })),
        "findings": inspection.findings.iter().map(|finding| json!({
            "code": finding.flag.code(),
            "time_s": finding.time,
            "joint": finding.joint,
            "value": finding.value,
            "spoils": finding.flag.spoils(),
        })).collect::<Vec<_>>(),
    })
}

/// Parts of a recording that the table names; `--json` has them all.
const MOST_PARTS: usize = 3;

fn table(inspections: &[Inspection]) -> String {
    let percent = |x: f64| format!("{:.1} %", 100.0 * x);
    let rows: Vec<Vec<String>> = inspections
        .iter()
        .enumerate()
        .map(|(i, inspection)| {
            let mut used: Vec<String> = inspection
                .used
                .iter()
                .take(MOST_PARTS)
                .map(|(start, end)| format!("{start:.2} .. {end:.2}"))
                .collect();
            if inspection.used.len() > MOST_PARTS {
                used.push(format!("{} more", inspection.used.len() - MOST_PARTS));
            }
            let name = Path::new(&inspection.name).file_name();
            let name = name.map_or(inspection.name.as_str().into(), |n| n.to_string_lossy());
            let mut row = vec![format!("{} {name}", i + 1), used.join(", ")];
            row.extend(match &inspection.rhythm {
                None => vec!["-".to_owned(); 6],
                Some(rhythm) => vec![
                    format!("{:.0}", rhythm.part.cycles),
                    format!("{:.2}", rhythm.variation.frequency),
                    percent(rhythm.variation.envelope),
                    percent(rhythm.variation.tempo),
                    percent(rhythm.leakage.residual_energy),
                    output::degrees(rhythm.leakage.end_jump),
                ],
            });
            let mut codes: Vec<&str> = inspection.findings.iter().map(|f| f.flag.code()).collect();
            codes.dedup();
            row.push(codes.join(", "));
            row
        })
        .collect();
    output::table(
        &[
            "recording",
            "used [s]",
            "cycles",
            "Hz",
            "amplitude varies",
            "tempo varies",
            "beyond harmonics",
            "end jump [deg]",
            "findings",
        ],
        &rows,
    )
}

/// A line a finding, no more of a kind in one recording than these.
fn findings(inspections: &[Inspection]) -> String {
    const MOST: usize = 3;
    let mut lines = Vec::new();
    for (i, inspection) in inspections.iter().enumerate() {
        let mut of_a_kind = 0;
        for (n, finding) in inspection.findings.iter().enumerate() {
            let before = n.checked_sub(1).map(|n| inspection.findings[n].flag);
            of_a_kind = if before == Some(finding.flag) {
                of_a_kind + 1
            } else {
                0
            };
            match of_a_kind {
                count if count < MOST => lines.push(line(i, finding)),
                MOST => lines.push(format!("{} {}: and more", i + 1, finding.flag.code())),
                _ => {}
            }
        }
    }
    lines.join("\n")
}

fn line(recording: usize, finding: &Finding) -> String {
    let mut text = format!("{} {}", recording + 1, finding.flag.code());
    if let Some(joint) = &finding.joint {
        text.push_str(&format!(", {joint}"));
    }
    if let Some(time) = finding.time {
        text.push_str(&format!(", at {time:.2} s"));
    }
    if finding.value != 0.0 {
        text.push_str(&format!(", {:.3}", finding.value));
    }
    format!("{text}: {}", finding.flag.meaning())
}

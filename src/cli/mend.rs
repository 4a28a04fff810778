//! `undulate mend`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use serde_json::{Value, json};

use super::demands::{Apart, Demands};
use super::robot::{RobotArguments, tell_notes};
use super::verdict::codes;
use super::{Outcome, output, read_wave};
use crate::collision::CollisionModel;
use crate::error::Result;
use crate::feasibility::{Change, Means, mend};

/// Make a wave executable on a robot: slower, smaller or elsewhere, and no more than it takes.
#[derive(Args)]
#[command(
    after_help = "Means are tried in the order given, each only while the wave does not pass. The wave written is one of the robot's own joints: check it with the\n\
    same options and without a map. Exit code 3 when no means helps; nothing is written then.\n\n\
    Examples:\n  \
    undulate mend wave.json --robot wave_arm --by slow -o slower.json\n  \
    undulate mend wave.json --robot my.urdf --map my.toml --by shift,shrink-offending,slow --margin 0.005 -o mended.json"
)]
pub(super) struct Arguments {
    /// The wave file.
    wave: PathBuf,
    #[command(flatten)]
    robot: RobotArguments,
    #[command(flatten)]
    demands: Demands,
    #[command(flatten)]
    apart: Apart,
    /// How it may be changed.
    #[arg(long, value_name = "MEANS,..", value_delimiter = ',', required = true)]
    by: Vec<By>,
    /// Where the mended wave goes.
    #[arg(long, short, value_name = "FILE.json")]
    output: PathBuf,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum By {
    /// Move offsets so that the wave lies within the range of positions.
    Shift,
    /// Play it slower, for velocities, accelerations and efforts.
    Slow,
    /// Make the amplitudes of the joints that break a limit smaller.
    ShrinkOffending,
    /// Make all amplitudes smaller by one factor, for any limit and for collisions.
    Shrink,
}

impl By {
    pub fn means(self) -> Means {
        match self {
            Self::Shift => Means::Shift,
            Self::Slow => Means::Slow,
            Self::ShrinkOffending => Means::ShrinkOffending,
            Self::Shrink => Means::Shrink,
        }
    }
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    let wave = read_wave(&arguments.wave)?;
    let (robot, map) = arguments.robot.load(wave.joints())?;
    let notes = tell_notes(&robot);
    let wave = map.apply(&wave, &robot)?;
    let (options, _) = arguments.demands.options(&robot)?;
    let apart = arguments.apart.options(&arguments.robot.reading, &robot)?;
    let collision = CollisionModel::new(&robot, &apart)?;
    let means: Vec<Means> = arguments.by.iter().map(|by| by.means()).collect();
    let mended = mend(&robot, &mut collision.prover(), &wave, &options, &means)?;
    let reasons = mended.verdict.reasons();
    if reasons.is_empty() {
        output::write(&arguments.output, mended.wave.to_json().as_bytes())?;
    }
    let value = json!({
        "robot": robot.name(),
        "notes": notes,
        "passes": reasons.is_empty(),
        "reasons": codes(&reasons),
        "changes": mended.changes.iter().map(change_json).collect::<Vec<_>>(),
        "written": reasons.is_empty().then_some(&arguments.output),
    });
    output::report(json, &value, || {
        let mut lines: Vec<String> = mended.changes.iter().map(change_words).collect();
        if reasons.is_empty() {
            if lines.is_empty() {
                lines.push("passes as it is".to_owned());
            }
            lines.push(format!("wrote {}", arguments.output.display()));
        } else {
            lines.extend(reasons.iter().map(|r| format!("reason: {r}")));
            lines.push("does not pass all the same; nothing is written".to_owned());
        }
        lines.join("\n")
    });
    Ok(if reasons.is_empty() {
        Outcome::Done
    } else {
        Outcome::Refused
    })
}

pub(super) fn change_json(change: &Change) -> Value {
    match change {
        Change::Shifted { joint, by } => json!({"shifted": joint, "by": by}),
        Change::Slowed { factor } => json!({"slowed": factor}),
        Change::Shrunk { joint, factor } => json!({"shrunk": joint, "factor": factor}),
    }
}

fn change_words(change: &Change) -> String {
    match change {
        Change::Shifted { joint, by } => format!("{joint} shifted by {by:.4}"),
        Change::Slowed { factor } => format!("slowed: the period is {factor:.4} times as long"),
        Change::Shrunk { joint, factor } => {
            let whose = joint.as_deref().unwrap_or("all joints");
            format!("shrunk: the amplitudes of {whose} are {factor:.4} times what they were")
        }
    }
}

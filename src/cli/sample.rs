//! `undulate sample`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::robot::{Reading, RobotArguments, tell_notes};
use super::source::Source;
use super::wishes::Wishes;
use super::{Model, Outcome, output};
use crate::collision::{Certification, CollisionModel};
use crate::error::{Error, ErrorKind, Result};
use crate::feasibility::Verdict;
use crate::fourier::{Derivative, Joints, PeriodGrid, Wave};
use crate::primitive::{Bound, Bounds, Start, Target};
use crate::retarget::JointMap;
use crate::robot::Robot;

/// Draws a wave after which the check is thought hopeless.
const MOST_DRAWS: u64 = 1000;

/// No table is longer.
const MOST_ROWS: f64 = 1e6;

/// Draw waves from a model.
#[derive(Args)]
#[command(
    after_help = "Sample number i of a seed is the same wave on every machine, however many are drawn.\n\n\
    Examples:\n  \
    undulate sample model.json --seed 7 --robot wave_arm -o wave.json\n  \
    undulate sample model.json -n 20 --seed 7 --given modulus:elbow_flexion:10=5deg --csv 100 -o waves/\n  \
    undulate sample lively.json --tempo 1.2x --size 0.8x --start 0deg --within elbow_flexion=20deg..130deg -o wave.json\n  \
    undulate sample model.json --towards elbow_flexion@1.2s=120deg+-2deg -o wave.json"
)]
pub(super) struct Arguments {
    /// The model file.
    model: PathBuf,
    /// How many waves.
    #[arg(short = 'n', long, value_name = "N", default_value_t = 1)]
    count: u64,
    /// Seed of the random numbers.
    #[arg(long, value_name = "SEED", default_value_t = 0)]
    seed: u64,
    /// Number of the first sample.
    #[arg(long, value_name = "INDEX", default_value_t = 0)]
    first: u64,
    /// Keep only waves that pass `undulate check` on this robot (a URDF file, or the name of a shipped one).
    #[arg(long, value_name = "URDF|NAME")]
    robot: Option<String>,
    /// The joint map for --robot, as in `undulate check`.
    #[arg(long, value_name = "TOML|NAME", requires = "robot")]
    map: Option<String>,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    wishes: Wishes,
    /// Where in its period a wave starts: `kept` as the demonstrations did, `redrawn` anywhere, or at a phase of its strongest harmonic, such as 0deg,
    /// which is about the upper turning point of the joint that moves most.
    #[arg(long, value_name = "START", default_value = "kept")]
    start: Start,
    /// Something to aim at that is no condition: a position at a time, elbow@1.2s=90deg+-2deg, or the amplitude of a band of frequencies,
    /// elbow:1.2Hz..1.8Hz=10deg+-1deg; may be given several times. Drawn by Markov chains, whose convergence is told.
    #[arg(long, value_name = "TARGET")]
    towards: Vec<Target>,
    /// Keep only waves of which a joint never leaves an interval, such as elbow_flexion=20deg..130deg; may be given several times.
    #[arg(long, value_name = "JOINT=LOW..HIGH")]
    within: Vec<Bound>,
    /// Write a table of joint positions beside each wave file, so many rows a second (`time_s`, then a column a joint [rad]).
    #[arg(long, value_name = "HERTZ", allow_negative_numbers = true)]
    csv: Option<f64>,
    /// A wave file (`.json`) for one wave, or a folder for wave_0000.json and so on.
    #[arg(long, short, value_name = "FILE|FOLDER")]
    output: PathBuf,
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    let is_file = arguments.output.extension().is_some_and(|e| e == "json");
    if arguments.count == 0 || (is_file && arguments.count != 1) {
        return Err(
            Error::new(ErrorKind::Setting, format!("{} waves", arguments.count)).expected(
                if is_file {
                    "1 for a file; name a folder for more"
                } else {
                    "at least 1"
                },
            ),
        );
    }
    let rows = match arguments.csv {
        Some(rate) if !(rate > 0.0 && rate <= 1e6) => {
            return Err(Error::new(ErrorKind::Setting, format!("--csv {rate}"))
                .expected("rows a second, more than 0 and at most 1e6"));
        }
        rate => rate,
    };
    let model = Model::read(&arguments.model)?.conditioned(&arguments.wishes)?;
    let bounds = Bounds::new(model.joints(), &arguments.within)?;
    let gate = match &arguments.robot {
        Some(robot) => {
            let arguments = RobotArguments {
                robot: robot.clone(),
                map: arguments.map.clone(),
                reading: arguments.reading.clone(),
            };
            Some(Gate::new(&arguments, model.joints())?)
        }
        None => None,
    };
    let period = model.period();
    let source = Source::new(model, &arguments.towards, arguments.seed, arguments.start)?;
    let bar = output::progress(arguments.count, "drawing waves");
    let mut kept = Vec::new();
    let mut refusals: BTreeMap<String, u64> = BTreeMap::new();
    let (mut draws, mut within) = (0, 0);
    while (kept.len() as u64) < arguments.count {
        if draws >= MOST_DRAWS.saturating_mul(arguments.count) {
            let most = refusals.iter().max_by_key(|(_, times)| **times);
            let most = most.map_or(String::new(), |(why, times)| {
                format!("; most often, {times} times, {why}")
            });
            return Err(Error::new(
                ErrorKind::Infeasible,
                format!("{} of {draws} draws can be used{most}", kept.len()),
            )
            .expected(format!("{} waves", arguments.count))
            .help("nothing is written; ask for a smaller or slower wave, another posture, or less narrow bounds"));
        }
        let index = arguments
            .first
            .checked_add(draws)
            .ok_or_else(|| Error::new(ErrorKind::Setting, "--first is too large"))?;
        draws += 1;
        let wave = source.wave(index)?;
        if !bounds.admit(&wave) {
            *refusals.entry("it leaves --within".into()).or_default() += 1;
            continue;
        }
        within += 1;
        if let Some(gate) = &gate
            && let Some(why) = gate.refusal(&wave)?
        {
            *refusals.entry(why).or_default() += 1;
            continue;
        }
        kept.push((index, wave));
        bar.inc(1);
    }
    bar.finish_and_clear();
    // Only now that there are as many as were asked for.
    let mut files = Vec::new();
    for (index, wave) in kept {
        let path = if is_file {
            arguments.output.clone()
        } else {
            arguments.output.join(format!("wave_{index:04}.json"))
        };
        output::write(&path, wave.to_json().as_bytes())?;
        if let Some(rate) = rows {
            output::write(&path.with_extension("csv"), &table(&wave, rate)?)?;
        }
        files.push(path);
    }
    let stale = if is_file {
        0
    } else {
        others(&arguments.output, &files)
    };
    if stale > 0 {
        output::warn(format!(
            "{} holds {stale} wave files that were there before",
            arguments.output.display()
        ));
    }
    let value = json!({"seed": arguments.seed, "period_s": period, "chains": source.diagnostics_json(), "reached": source.reached_json(), "draws": draws, "within_bounds": within, "waves": files});
    output::report(json, &value, || {
        let mut text = match files.as_slice() {
            [one] => format!("wrote {}", one.display()),
            _ => format!(
                "wrote {} waves into {}",
                files.len(),
                arguments.output.display()
            ),
        };
        if rows.is_some() {
            text.push_str(", and a table beside each");
        }
        if let Some(diagnostics) = source.diagnostics() {
            text.push_str(&format!("; the chains: {diagnostics}"));
        }
        if !arguments.within.is_empty() {
            text.push_str(&format!(
                "; {within} of {draws} draws stay within the bounds ({:.0} %)",
                100.0 * f64::from(within) / draws as f64
            ));
        }
        if gate.is_some() {
            text.push_str(&format!(
                "; {} of {draws} draws pass the check",
                files.len()
            ));
        }
        text
    });
    Ok(Outcome::Done)
}

/// The check that waves must pass.
struct Gate {
    robot: Robot,
    map: JointMap,
    collision: CollisionModel,
}

impl Gate {
    fn new(arguments: &RobotArguments, learned: &Joints) -> Result<Self> {
        let (robot, map) = arguments.load(learned)?;
        tell_notes(&robot);
        let collision = CollisionModel::new(&robot, &arguments.reading.collision(&robot)?)?;
        Ok(Self {
            robot,
            map,
            collision,
        })
    }

    /// Why the wave does not pass, if it does not.
    fn refusal(&self, wave: &Wave) -> Result<Option<String>> {
        let wave = self.map.apply(wave, &self.robot)?;
        let verdict = Verdict::of(&self.robot, &self.collision, &wave, 0.0)?;
        if verdict.passes() {
            return Ok(None);
        }
        let broken = verdict
            .limits
            .iter()
            .filter(|limit| limit.excess() > 0.0)
            .max_by(|a, b| a.excess().total_cmp(&b.excess()));
        let weak = verdict.efforts.iter().flatten();
        if let Some(effort) = weak.max_by(|a, b| a.excess().total_cmp(&b.excess()))
            && effort.excess() > 0.0
        {
            return Ok(Some(format!("`{}` is too weak", effort.joint)));
        }
        Ok(Some(match (broken, &verdict.collision) {
            (Some(limit), _) => {
                let quantity = match limit.quantity {
                    Derivative::Velocity => "velocity",
                    _ => "position",
                };
                format!("the {quantity} limit of `{}` is exceeded", limit.joint)
            }
            (None, Some(Certification::Collides { witness, .. })) => {
                format!("`{}` and `{}` touch", witness.pair.0, witness.pair.1)
            }
            (None, Some(_)) => "nobody can say whether it touches".to_owned(),
            (None, None) => "it does not pass the check".to_owned(),
        }))
    }
}

/// Wave files in a folder that are none of these.
fn others(folder: &Path, files: &[PathBuf]) -> usize {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries
        .map(|entry| entry.path())
        .filter(|path| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            name.starts_with("wave_") && name.ends_with(".json") && !files.contains(path)
        })
        .count()
}

fn table(wave: &Wave, rate: f64) -> Result<Vec<u8>> {
    let points = (rate * wave.period()).round().max(1.0);
    if points > MOST_ROWS {
        return Err(
            Error::new(ErrorKind::Setting, format!("--csv {rate}: {points:e} rows"))
                .expected(format!("at most {MOST_ROWS:e}")),
        );
    }
    let points = points as usize;
    let grid = PeriodGrid::new(points, wave.harmonics());
    let positions = wave.on_grid(&grid, Derivative::Position);
    let header = std::iter::once("time_s".to_owned()).chain(wave.joints().iter().cloned());
    let times = grid.times(wave.period());
    let rows = times
        .iter()
        .zip(positions.row_iter())
        .map(|(t, row)| std::iter::once(*t).chain(row.iter().copied().collect::<Vec<_>>()));
    output::csv(header, rows)
}

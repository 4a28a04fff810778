//! `undulate assess` and `undulate merge`.

use std::path::{Path, PathBuf};

use clap::Args;
use rand::distr::Distribution;
use serde_json::{Value, json};

use super::demands::{Apart, Demands};
use super::mend::By;
use super::robot::{RobotArguments, tell_notes};
use super::verdict::millimetres;
use super::{Model, Outcome, output, read_text};
use crate::collision::{CollisionModel, Evidence};
use crate::error::{Error, ErrorKind, Result};
use crate::feasibility::{Assessment, Means, Verdict, mend};
use crate::parallel;
use crate::primitive::stream;

/// No more waves.
const MOST: u64 = 1_000_000_000;
/// Rows of a histogram in words.
const ROWS: usize = 16;
/// Its longest bar.
const BAR: usize = 40;

/// How probable each kind of failure is on a robot: exact bounds from many draws, in one piece or in shards.
#[derive(Args)]
#[command(
    after_help = "Each draw is put through limits, efforts, the proof of clearance and the search for the smallest clearance. Of each kind of failure the exact\n\
    one-sided bound of Clopper and Pearson is told: with confidence C its probability is below. Draws and results are the same however many jobs, shards\n\
    or machines of one kind there are; `undulate merge` makes one of the files of all shards, to the same bytes as one run.\n\n\
    Examples:\n  \
    undulate assess model.json --robot wave_arm -n 10000 --confidence 0.99 -o assessment.json --worst worst/\n  \
    undulate assess model.json --robot my.urdf --map my.toml --scene table.toml -n 1000000 --shard 3/64 -o shard_3.json\n  \
    undulate merge shard_*.json -o assessment.json"
)]
pub(super) struct Arguments {
    /// The model file.
    model: PathBuf,
    #[command(flatten)]
    robot: RobotArguments,
    #[command(flatten)]
    demands: Demands,
    #[command(flatten)]
    apart: Apart,
    /// How many waves are drawn, over all shards.
    #[arg(short = 'n', long, value_name = "N", default_value_t = 1000)]
    count: u64,
    /// Seed of the draws.
    #[arg(long, value_name = "SEED", default_value_t = 0)]
    seed: u64,
    /// Only this part of the draws: part I of N, counted from 0, as cluster jobs are.
    #[arg(long, value_name = "I/N")]
    shard: Option<String>,
    /// Mend the draws that fail, by these means in this order, and tell how many pass then.
    #[arg(long, value_name = "MEANS,..", value_delimiter = ',')]
    by: Vec<By>,
    /// How many threads [default: as many as the machine has].
    #[arg(long, short, value_name = "JOBS")]
    jobs: Option<usize>,
    #[command(flatten)]
    report: Report,
}

/// Make one assessment of those of all shards.
#[derive(Args)]
#[command(
    after_help = "Example:\n  undulate merge shard_*.json --confidence 0.99 -o assessment.json"
)]
pub(super) struct MergeArguments {
    /// Assessment files of one model, robot, seed and number of waves.
    #[arg(required = true, value_name = "FILE.json")]
    files: Vec<PathBuf>,
    #[command(flatten)]
    report: Report,
}

#[derive(Args)]
struct Report {
    /// Of each bound.
    #[arg(long, value_name = "C", default_value_t = 0.99)]
    confidence: f64,
    /// Write the assessment.
    #[arg(long, short, value_name = "FILE.json")]
    output: Option<PathBuf>,
    /// Write the worst wave of each kind of failure into a folder, a wave file of the robot's joints each.
    #[arg(long, value_name = "FOLDER")]
    worst: Option<PathBuf>,
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    arguments.report.require()?;
    if !(1..=MOST).contains(&arguments.count) {
        return Err(
            Error::new(ErrorKind::Setting, format!("{} waves", arguments.count))
                .expected(format!("from 1 to {MOST}")),
        );
    }
    let (from, to) = shard(arguments.shard.as_deref(), arguments.count)?;
    let text = read_text(&arguments.model)?;
    let model = Model::read(&arguments.model)?;
    let target = &arguments.robot;
    let (robot, map) = target.load(model.joints())?;
    let (_, map_evidence) = target.map(model.joints())?;
    tell_notes(&robot);
    let (options, given) = arguments.demands.options(&robot)?;
    let apart = arguments.apart.options(&target.reading, &robot)?;
    let collision = CollisionModel::new(&robot, &apart)?;
    let means: Vec<Means> = arguments.by.iter().map(|by| by.means()).collect();

    let mut rests_on = target.reading.evidence(&target.robot)?;
    rests_on.extend(map_evidence);
    rests_on.push(Evidence::new("model", "", text.as_bytes()));
    let pairs: Vec<String> = collision
        .pairs()
        .iter()
        .filter(|pair| pair.is_checked())
        .map(|pair| format!("{}:{} {}", pair.names.0, pair.names.1, pair.padding))
        .collect();
    // Limits that a file gives are told by its bytes.
    let given = given.replace(|c: char| c.is_control(), " ");
    let words = [
        ("undulate", env!("CARGO_PKG_VERSION").to_owned()),
        (
            "geometry",
            format!("sha256 {}", collision.geometry_sha256(&robot)),
        ),
        ("pairs", pairs.join(", ")),
        ("margin", format!("{} m", options.margin)),
        ("tolerance", format!("{:?}", options.tolerance)),
        ("accuracy", format!("{:?}", options.accuracy)),
        ("limits", limits_words(&given)),
        ("means", format!("{means:?}")),
    ];
    let mut assessment = Assessment::new(&rests_on, &words, arguments.seed, arguments.count);

    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let threads = match arguments.jobs {
        Some(0) => return Err(Error::new(ErrorKind::Setting, "0 jobs").expected("at least 1")),
        jobs => jobs.unwrap_or(cores),
    };
    let bar = output::progress(to - from, "assessing waves");
    parallel::in_order(
        (to - from) as usize,
        threads,
        || collision.prover(),
        |prover, index| {
            let draw = from + index as u64;
            let wave = model.sample(&mut stream(arguments.seed, draw));
            let outcome = map.apply(&wave, &robot).and_then(|wave| {
                let verdict = Verdict::with(&robot, prover, &wave, &options)?;
                Ok((wave, verdict))
            });
            let mended = match &outcome {
                Ok((wave, verdict)) if !means.is_empty() && !verdict.passes() => {
                    mend(&robot, prover, wave, &options, &means).ok()
                }
                _ => None,
            };
            (draw, outcome, mended)
        },
        |(draw, outcome, mended)| {
            assessment.add(draw, &outcome, mended.as_ref());
            bar.inc(1);
        },
    );
    bar.finish_and_clear();
    arguments.report.tell(&assessment, json)
}

/// What `--limits` and the like gave, without the name of the file.
fn limits_words(given: &str) -> String {
    match (given.split_once("--limits "), given.split_once("(sha256 ")) {
        (Some((before, _)), Some((_, after))) => format!("{before}--limits (sha256 {after}"),
        _ => given.to_owned(),
    }
}

/// The draws of a shard, the end left out.
fn shard(text: Option<&str>, count: u64) -> Result<(u64, u64)> {
    let Some(text) = text else {
        return Ok((0, count));
    };
    let wrong = || {
        Error::new(ErrorKind::Setting, format!("--shard {text}"))
            .expected("I/N with I from 0 to N - 1, such as 3/64")
    };
    let (part, of) = text.split_once('/').ok_or_else(wrong)?;
    let part: u64 = part.trim().parse().map_err(|_| wrong())?;
    let of: u64 = of.trim().parse().map_err(|_| wrong())?;
    if part >= of || of > count {
        return Err(if part < of {
            wrong().help(format!("{count} waves do not make {of} parts"))
        } else {
            wrong()
        });
    }
    let start = |part: u64| (u128::from(count) * u128::from(part) / u128::from(of)) as u64;
    Ok((start(part), start(part + 1)))
}

pub(super) fn merge(arguments: &MergeArguments, json: bool) -> Result<Outcome> {
    arguments.report.require()?;
    let mut merged: Option<Assessment> = None;
    for path in &arguments.files {
        let here = |e: Error| e.at(path.display().to_string());
        let part = Assessment::from_json(&read_text(path)?).map_err(here)?;
        merged = Some(match merged {
            None => part,
            Some(merged) => merged.merge(&part).map_err(here)?,
        });
    }
    let Some(merged) = merged else {
        return Err(Error::new(ErrorKind::Setting, "no files").expected("at least one"));
    };
    arguments.report.tell(&merged, json)
}

impl Report {
    fn require(&self) -> Result<()> {
        if self.confidence > 0.5 && self.confidence < 1.0 {
            return Ok(());
        }
        Err(Error::new(
            ErrorKind::Setting,
            format!("--confidence {}", self.confidence),
        )
        .expected("above 0.5 and below 1"))
    }

    fn tell(&self, assessment: &Assessment, json: bool) -> Result<Outcome> {
        let mut written = Vec::new();
        if let Some(path) = &self.output {
            output::write(path, assessment.to_json().as_bytes())?;
            written.push(path.clone());
        }
        if let Some(folder) = &self.worst {
            for (code, _, worst) in assessment.failures(self.confidence) {
                if let Some(wave) = &worst.wave {
                    let path = folder.join(format!("{code}.json"));
                    output::write(&path, wave.as_bytes())?;
                    written.push(path);
                }
            }
        }
        if assessment.drawn() < assessment.waves() {
            output::warn(format!(
                "{} of {} waves are drawn: bounds are of these",
                assessment.drawn(),
                assessment.waves()
            ));
        }
        output::report(json, &self.value(assessment, &written), || {
            self.words(assessment, &written)
        });
        Ok(Outcome::Done)
    }

    fn value(&self, assessment: &Assessment, written: &[PathBuf]) -> Value {
        let passed = assessment.passed(self.confidence);
        let (bins, unknown) = assessment.clearances();
        let (tried, mended, [shifted, slowed, joints_shrunk, all_shrunk]) = assessment.mending();
        json!({
            "waves": assessment.waves(),
            "drawn": assessment.drawn(),
            "confidence": self.confidence,
            "passed": {"count": passed.count, "probability_above": passed.bound},
            "failures": assessment
                .failures(self.confidence)
                .map(|(code, failure, worst)| json!({
                    "reason": code,
                    "count": failure.count,
                    "probability_below": failure.bound,
                    "worst": {"draw": worst.draw, "severity": worst.severity},
                }))
                .collect::<Vec<_>>(),
            "any_other_probability_below": assessment.unseen(self.confidence),
            "clearance_m": bins,
            "clearance_unknown": unknown,
            "mending": {
                "tried": tried, "mended": mended, "shifted": shifted, "slowed": slowed,
                "joints_shrunk": joints_shrunk, "all_shrunk": all_shrunk,
            },
            "written": written,
        })
    }

    fn words(&self, assessment: &Assessment, written: &[PathBuf]) -> String {
        let drawn = assessment.drawn();
        let share = |count: u64| format!("{:.2} %", 100.0 * count as f64 / drawn.max(1) as f64);
        let percent = |p: f64| format!("{:.3} %", 100.0 * p);
        let passed = assessment.passed(self.confidence);
        let confidence = 100.0 * self.confidence;
        let mut blocks = vec![format!(
            "{} of {drawn} waves pass ({}); at {confidence} % confidence the probability is above {}",
            passed.count,
            share(passed.count),
            percent(passed.bound)
        )];
        let rows: Vec<Vec<String>> = assessment
            .failures(self.confidence)
            .map(|(code, failure, worst)| {
                vec![
                    code.to_owned(),
                    failure.count.to_string(),
                    share(failure.count),
                    percent(failure.bound),
                    format!("{} ({:.3e})", worst.draw, worst.severity),
                ]
            })
            .collect();
        if !rows.is_empty() {
            blocks.push(output::table(
                &[
                    "reason",
                    "waves",
                    "share",
                    "probability below",
                    "worst draw",
                ],
                &rows,
            ));
        }
        blocks.push(format!(
            "any other kind: probability below {}",
            percent(assessment.unseen(self.confidence))
        ));
        let (tried, mended, [shifted, slowed, joints, all]) = assessment.mending();
        if tried > 0 {
            blocks.push(format!(
                "{mended} of the {tried} that fail pass after mending: {shifted} shifted, {slowed} slowed, {joints} with joints shrunk, {all} shrunk as a whole"
            ));
        }
        blocks.push(histogram(assessment));
        if !written.is_empty() {
            let names: Vec<String> = written.iter().map(|p: &PathBuf| name(p)).collect();
            blocks.push(format!("wrote {}", names.join(", ")));
        }
        blocks.join("\n\n")
    }
}

fn name(path: &Path) -> String {
    path.display().to_string()
}

/// Smallest clearances as bars, neighbouring bins together where there are many.
fn histogram(assessment: &Assessment) -> String {
    let (bins, unknown) = assessment.clearances();
    let (Some(first), Some(last)) = (bins.first(), bins.last()) else {
        return format!("no clearance is known of {unknown} waves");
    };
    let width = bins[0].1 - bins[0].0;
    let all = ((last.1 - first.0) / width).round() as usize;
    let together = all.div_ceil(ROWS).max(1);
    let mut counts = vec![0; all.div_ceil(together)];
    for (from, _, count) in &bins {
        let bin = ((from - first.0) / width).round() as usize;
        // Beyond 2^53 bins their numbers are rounded.
        let last = counts.len() - 1;
        counts[(bin / together).min(last)] += count;
    }
    let most = counts.iter().copied().max().unwrap_or(1).max(1);
    let mut lines = vec!["smallest clearance [mm]".to_owned()];
    for (n, count) in counts.iter().enumerate() {
        let from = first.0 + (n * together) as f64 * width;
        let bar = "#".repeat((BAR as u64 * count).div_ceil(most) as usize);
        let to = from + together as f64 * width;
        lines.push(
            format!(
                "{:>8} .. {:<8} {count:>8} {bar}",
                millimetres(from),
                millimetres(to)
            )
            .trim_end()
            .to_owned(),
        );
    }
    if unknown > 0 {
        lines.push(format!("not known of {unknown}"));
    }
    lines.join("\n")
}

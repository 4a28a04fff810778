//! `undulate screen`.

use std::path::{Path, PathBuf};

use clap::Args;
use rand::distr::Distribution;

use super::demands::{Apart, Demands};
use super::moves::{Course, Loaded, MoveArguments};
use super::robot::{RobotArguments, tell_notes};
use super::screened::{Line, share, summary, words};
use super::trajectory::Form;
use super::{Model, Outcome, output};
use crate::collision::{Certification, CollisionModel, Prover, Stretch};
use crate::error::{Error, ErrorKind, Result};
use crate::feasibility::{CheckOptions, Verdict};
use crate::figure::{ClearanceCourse, clearance};
use crate::fourier::Wave;
use crate::motion::Motion;
use crate::parallel;
use crate::primitive::stream;
use crate::retarget::JointMap;
use crate::robot::Robot;

/// No more waves at once.
const MOST: usize = 10_000_000;
/// Motions that a figure shows, those that come nearest.
const SHOWN: usize = 6;
/// Intervals of a panel, and how exactly it tells the clearance \[m\].
const PANEL: (usize, f64) = (400, 2e-4);
/// Width and height of a panel \[px\].
const SIZE: (u32, u32) = (760, 300);

/// Check many waves at once: draws of a model, or files; the share that passes, and what stops the others.
#[derive(Args)]
#[command(
    after_help = "Each wave is checked as `undulate check` does it, over all cores; results come in order and are the same however many work. Wave i of a\n\
    seed is the one that `undulate sample` draws. The interval of a share is that of Clopper and Pearson, exact for independent draws. Exit code 0\n\
    when all could be looked at; with --least, 3 when the interval reaches below that share.\n\n\
    Examples:\n  \
    undulate screen model.json --robot wave_arm -n 1000 --output waves.jsonl --figure nearest.svg\n  \
    undulate screen waves/ --robot my.urdf --map my.toml --margin 0.01 --json\n  \
    undulate screen model.json --robot wave_arm -n 1000 --least 0.9"
)]
pub(super) struct Arguments {
    /// A model file, or wave files and moves, or folders of them.
    #[arg(value_name = "MODEL|MOTION|FOLDER", required = true)]
    inputs: Vec<PathBuf>,
    #[command(flatten)]
    robot: RobotArguments,
    #[command(flatten)]
    moves: MoveArguments,
    #[command(flatten)]
    demands: Demands,
    #[command(flatten)]
    apart: Apart,
    /// How many waves are drawn of a model [default: 100].
    #[arg(short = 'n', long, value_name = "N")]
    count: Option<usize>,
    /// Seed of the draws.
    #[arg(long, value_name = "SEED", default_value_t = 0)]
    seed: u64,
    /// How many threads [default: as many as the machine has].
    #[arg(long, short, value_name = "JOBS")]
    jobs: Option<usize>,
    /// The share that must pass, for certain at 95 %: exit code 3 if not.
    #[arg(long, value_name = "SHARE")]
    least: Option<f64>,
    /// Write one JSON line a wave.
    #[arg(long, short, value_name = "FILE.jsonl")]
    pub output: Option<PathBuf>,
    /// Draw the clearance over time of those that come nearest.
    #[arg(long, value_name = "FILE.svg|FILE.png")]
    pub figure: Option<PathBuf>,
}

/// Where motions come from.
enum Motions {
    Drawn {
        model: Model,
        map: JointMap,
        count: usize,
        seed: u64,
    },
    Read(Vec<(String, Result<Loaded>)>),
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    let form = arguments.figure.as_deref().map(Form::of).transpose()?;
    if let Some(share) = arguments.least
        && !(0.0..=1.0).contains(&share)
    {
        return Err(
            Error::new(ErrorKind::Setting, format!("--least {share}")).expected("from 0 to 1")
        );
    }
    let target = &arguments.robot;
    let robot = target.reading.robot(&target.robot)?;
    tell_notes(&robot);
    let (options, _) = arguments.demands.options(&robot)?;
    let apart = arguments.apart.options(&target.reading, &robot)?;
    let collision = CollisionModel::new(&robot, &apart)?;
    let motions = arguments.motions(&robot)?;
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let threads = match arguments.jobs {
        Some(0) => return Err(Error::new(ErrorKind::Setting, "0 jobs").expected("at least 1")),
        jobs => jobs.unwrap_or(cores),
    };
    let bar = output::progress(motions.count() as u64, "checking waves");
    let mut lines = Vec::new();
    parallel::in_order(
        motions.count(),
        threads,
        || collision.prover(),
        |prover, index| motions.judge(index, &robot, prover, &options),
        |line: Line| {
            if json {
                output::say(&line.text);
            }
            bar.inc(1);
            lines.push(line);
        },
    );
    bar.finish_and_clear();
    if let Some(path) = &arguments.output {
        let text: String = lines.iter().flat_map(|l| [l.text.as_str(), "\n"]).collect();
        output::write(path, text.as_bytes())?;
    }
    if let (Some(path), Some(form)) = (&arguments.figure, form) {
        let picture = motions.figure(&lines, &robot, &collision, &options)?;
        if let Some(picture) = picture {
            output::write(path, &form.bytes(picture))?;
        }
    }
    let passed = lines.iter().filter(|l| l.reasons.is_empty()).count();
    let (lower, _) = share(passed, lines.len());
    let value = summary(&lines, arguments);
    output::report(json, &value, || words(&lines, arguments));
    let mut errors: Vec<Error> = lines.into_iter().filter_map(|l| l.error).collect();
    let last = errors.pop();
    errors.iter().for_each(output::failure);
    match last {
        Some(error) => Err(error),
        None if arguments.least.is_some_and(|least| lower < least) => Ok(Outcome::Refused),
        None => Ok(Outcome::Done),
    }
}

impl Arguments {
    fn motions(&self, robot: &Robot) -> Result<Motions> {
        if let [path] = self.inputs.as_slice()
            && is_model(path)
        {
            let count = self.count.unwrap_or(100);
            if !(1..=MOST).contains(&count) {
                return Err(Error::new(ErrorKind::Setting, format!("{count} waves"))
                    .expected(format!("from 1 to {MOST}")));
            }
            let model = Model::read(path)?;
            let (map, _) = self.robot.map(model.joints())?;
            return Ok(Motions::Drawn {
                model,
                map,
                count,
                seed: self.seed,
            });
        }
        if self.count.is_some() {
            return Err(
                Error::new(ErrorKind::Setting, "-n, and no model to draw from")
                    .expected("one model file, or motions without -n"),
            );
        }
        let mut files = Vec::new();
        for input in &self.inputs {
            if input.is_dir() {
                files.extend(files_in(input)?);
            } else {
                files.push(input.clone());
            }
        }
        let bar = output::progress(files.len() as u64, "reading waves");
        let mut read = Vec::new();
        for file in &files {
            read.extend(self.moves.open(file, robot, &self.robot));
            bar.inc(1);
        }
        bar.finish_and_clear();
        Ok(Motions::Read(read))
    }
}

/// Whether a file calls itself a model; what is wrong with it is said when it is read.
fn is_model(path: &Path) -> bool {
    #[derive(serde::Deserialize)]
    struct Header {
        format: String,
    }
    let bytes = crate::document::bytes(path).unwrap_or_default();
    serde_json::from_slice::<Header>(&bytes)
        .is_ok_and(|h| matches!(h.format.as_str(), "undulate model" | "undulate mixture"))
}

/// Files of motions in a folder, by name.
fn files_in(folder: &Path) -> Result<Vec<PathBuf>> {
    let fail = |e: std::io::Error| Error::io(folder, &e);
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(fail)? {
        let path = entry.map_err(fail)?.path();
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
        if matches!(extension, "json" | "csv" | "yaml" | "yml") {
            files.push(path);
        }
    }
    files.sort();
    if files.is_empty() {
        return Err(Error::new(ErrorKind::Io, "no motions in the folder")
            .expected("files that end in .json, .csv, .yaml or .yml")
            .at(folder.display().to_string()));
    }
    Ok(files)
}

impl Motions {
    fn count(&self) -> usize {
        match self {
            Self::Drawn { count, .. } => *count,
            Self::Read(read) => read.len(),
        }
    }

    /// A draw on the robot's joints.
    fn drawn(&self, index: usize, robot: &Robot) -> Option<Result<Wave>> {
        match self {
            Self::Drawn {
                model, map, seed, ..
            } => {
                let wave = model.sample(&mut stream(*seed, index as u64));
                Some(map.apply(&wave, robot))
            }
            Self::Read(_) => None,
        }
    }

    fn judge(
        &self,
        index: usize,
        robot: &Robot,
        prover: &mut Prover<'_>,
        options: &CheckOptions,
    ) -> Line {
        let mut name = None;
        let verdict = match (self, self.drawn(index, robot)) {
            (_, Some(wave)) => wave.and_then(|w| Verdict::with(robot, prover, &w, options)),
            (Self::Read(read), None) => {
                name = Some(read[index].0.clone());
                match &read[index].1 {
                    Err(error) => Err(error.clone()),
                    Ok(loaded) => match &loaded.course {
                        Course::Wave(wave) => Verdict::with(robot, prover, &**wave, options),
                        Course::Move(spline) => Verdict::with(robot, prover, &**spline, options),
                    },
                }
            }
            (Self::Drawn { .. }, None) => {
                Err(Error::new(ErrorKind::Infeasible, "a draw that is none"))
            }
        };
        Line::new(index, name, verdict)
    }

    /// Clearance over time of those that come nearest.
    fn figure(
        &self,
        lines: &[Line],
        robot: &Robot,
        collision: &CollisionModel,
        options: &CheckOptions,
    ) -> Result<Option<crate::figure::Picture>> {
        let mut nearest: Vec<&Line> = lines.iter().filter(|l| l.nearest.is_some()).collect();
        let distance = |l: &Line| l.nearest.as_ref().map_or(f64::INFINITY, |n| n.1);
        nearest.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.truncate(SHOWN);
        let mut panels = Vec::new();
        for line in nearest {
            let title = line
                .name
                .clone()
                .unwrap_or_else(|| format!("wave {}", line.index));
            let (profile, undecided) = match (self, self.drawn(line.index, robot)) {
                (_, Some(wave)) => course(collision, &wave?, options)?,
                (Self::Read(read), None) => match &read[line.index].1 {
                    Err(_) => continue,
                    Ok(loaded) => match &loaded.course {
                        Course::Wave(wave) => course(collision, &**wave, options)?,
                        Course::Move(spline) => course(collision, &**spline, options)?,
                    },
                },
                (Self::Drawn { .. }, None) => continue,
            };
            panels.push((title, profile, undecided));
        }
        if panels.is_empty() {
            return Ok(None);
        }
        let courses: Vec<ClearanceCourse<'_>> = panels
            .iter()
            .map(|(title, profile, undecided)| ClearanceCourse {
                title,
                profile,
                margin: options.margin,
                undecided,
            })
            .collect();
        let columns = courses.len().min(2);
        let rows = courses.len().div_ceil(columns);
        let size = (SIZE.0 * columns as u32, SIZE.1 * rows as u32);
        clearance(&courses, columns, size).map(Some)
    }
}

type Profile = Vec<crate::collision::ProfileInterval>;

fn course<M: Motion>(
    collision: &CollisionModel,
    motion: &M,
    options: &CheckOptions,
) -> Result<(Profile, Vec<Stretch>)> {
    let profile = collision.clearance_profile(motion, PANEL.0, PANEL.1)?;
    let undecided = match collision.certify(motion, options.margin, &options.tolerance)? {
        Certification::Undecided { stretches, .. } => stretches,
        _ => Vec::new(),
    };
    Ok((profile, undecided))
}

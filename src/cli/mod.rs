//! The command line: arguments, files, progress, words. Only this module prints.

mod assess;
mod assumptions;
mod capture;
mod check;
mod compare;
mod compare_estimators;
mod compare_periods;
mod condition;
mod demands;
mod describe;
mod execution;
mod export;
mod fit;
mod inspect_demos;
mod learn;
mod learn_cycle;
mod learn_kinds;
mod learning_curve;
mod map;
mod mend;
mod model;
mod moves;
mod output;
mod pairs;
mod perform;
mod recordings;
mod reproduce;
mod robot;
mod sample;
mod screen;
mod screened;
mod simulate;
mod source;
mod trajectory;
mod verdict;
mod verify;
mod wishes;

use std::path::Path;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::error::{Error, ErrorKind, Result};
use crate::fourier::Wave;
use crate::primitive::FourierMovementPrimitive;
use model::Model;

/// Wave gestures for robots: learn them from recordings, sample, check and execute them.
#[derive(Parser)]
#[command(
    version,
    about,
    after_help = "Exit codes: 0 done, 1 an input cannot be used, 2 the command line is wrong, 3 checked and refused.\n\n\
        Example, from recordings to a robot:\n  \
        undulate learn recordings/ -o model.json\n  \
        undulate sample model.json --seed 7 -o wave.json\n  \
        undulate check wave.json --robot wave_arm\n  \
        undulate simulate wave.json --robot wave_arm -o rollout.csv"
)]
struct Cli {
    #[command(subcommand)]
    verb: Verb,
    /// Print one JSON object instead of words (`screen`: one a line).
    #[arg(long, global = true)]
    json: bool,
}

#[derive(Subcommand)]
enum Verb {
    Reproduce(reproduce::Arguments),
    Capture(capture::Arguments),
    Learn(learn::Arguments),
    InspectDemos(inspect_demos::Arguments),
    LearningCurve(learning_curve::Arguments),
    Compare(compare::Arguments),
    CompareEstimators(compare_estimators::Arguments),
    ComparePeriods(compare_periods::Arguments),
    Condition(condition::Arguments),
    Sample(sample::Arguments),
    Trajectory(trajectory::Arguments),
    Check(check::Arguments),
    Mend(mend::Arguments),
    Perform(perform::Arguments),
    Verify(verify::Arguments),
    Screen(screen::Arguments),
    Assess(assess::Arguments),
    Merge(assess::MergeArguments),
    Simulate(simulate::Arguments),
    Map(map::Arguments),
    Fit(fit::Arguments),
    Export(export::Arguments),
    Robot(describe::Arguments),
}

/// What a verb came to, where it came to something.
enum Outcome {
    Done,
    /// The input was looked at and does not pass.
    Refused,
}

/// Runs the program on the arguments of the process.
pub fn main() -> ExitCode {
    let cli = Cli::parse();
    let result = match &cli.verb {
        Verb::Reproduce(arguments) => reproduce::run(arguments, cli.json),
        Verb::Capture(arguments) => capture::run(arguments, cli.json),
        Verb::Learn(arguments) => learn::run(arguments, cli.json),
        Verb::InspectDemos(arguments) => inspect_demos::run(arguments, cli.json),
        Verb::LearningCurve(arguments) => learning_curve::run(arguments, cli.json),
        Verb::Compare(arguments) => compare::run(arguments, cli.json),
        Verb::CompareEstimators(arguments) => compare_estimators::run(arguments, cli.json),
        Verb::ComparePeriods(arguments) => compare_periods::run(arguments, cli.json),
        Verb::Condition(arguments) => condition::run(arguments, cli.json),
        Verb::Sample(arguments) => sample::run(arguments, cli.json),
        Verb::Trajectory(arguments) => trajectory::run(arguments, cli.json),
        Verb::Check(arguments) => check::run(arguments, cli.json),
        Verb::Perform(arguments) => perform::run(arguments, cli.json),
        Verb::Mend(arguments) => mend::run(arguments, cli.json),
        Verb::Verify(arguments) => verify::run(arguments, cli.json),
        Verb::Screen(arguments) => screen::run(arguments, cli.json),
        Verb::Assess(arguments) => assess::run(arguments, cli.json),
        Verb::Merge(arguments) => assess::merge(arguments, cli.json),
        Verb::Simulate(arguments) => simulate::run(arguments, cli.json),
        Verb::Map(arguments) => map::run(arguments, cli.json),
        Verb::Fit(arguments) => fit::run(arguments, cli.json),
        Verb::Export(arguments) => export::run(arguments, cli.json),
        Verb::Robot(arguments) => describe::run(arguments, cli.json),
    };
    match result {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::Refused) => ExitCode::from(3),
        Err(error) => {
            output::failure(&error);
            match error.kind() {
                ErrorKind::Setting => ExitCode::from(2),
                ErrorKind::Refused => ExitCode::from(3),
                _ => ExitCode::FAILURE,
            }
        }
    }
}

fn read_text(path: &Path) -> Result<String> {
    let bytes = crate::document::bytes(path)?;
    String::from_utf8(bytes).map_err(|_| {
        Error::new(ErrorKind::Syntax, "text that is not UTF-8").at(path.display().to_string())
    })
}

/// Of one primitive.
fn read_model(path: &Path) -> Result<FourierMovementPrimitive> {
    Model::read(path)?
        .one()
        .map_err(|e| e.at(path.display().to_string()))
}

fn read_wave(path: &Path) -> Result<Wave> {
    read_wave_text(path, &read_text(path)?)
}

fn read_wave_text(path: &Path, text: &str) -> Result<Wave> {
    Wave::from_json(text).map_err(|e| {
        e.help("`undulate sample` draws wave files from a model")
            .at(path.display().to_string())
    })
}

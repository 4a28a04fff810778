//! The recordings that a verb learns from, as arguments.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::output;
use crate::demonstration::{
    CsvOptions, Demonstrations, Duration, Flag, Inspection, Recording, same_joints, synthetic,
};
use crate::error::{Error, ErrorKind, Result};

/// Recordings, or the synthetic demonstrator.
#[derive(Args)]
pub(super) struct Recordings {
    /// CSV files, or folders of them.
    #[arg(value_name = "CSV|FOLDER")]
    inputs: Vec<PathBuf>,
    /// A file that names recordings, one path a line.
    #[arg(long, value_name = "FILE")]
    list: Option<PathBuf>,
    /// What the paths in the list are relative to [default: the folder of the list].
    #[arg(long, value_name = "FOLDER", requires = "list")]
    root: Option<PathBuf>,
    /// The columns to learn, in this order [default: all but `time_s`].
    #[arg(long, value_name = "A,B,..", value_delimiter = ',')]
    joints: Option<Vec<String>>,
    /// Positions are degrees.
    #[arg(long)]
    degrees: bool,
    /// The common period T [s] [default: the span for which (recordings kept) x T is largest].
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    duration: Option<f64>,
    /// Take drift out of each joint's recording first: a straight line, or `=slow`, whatever changes slowly beside the rhythm.
    #[arg(
        long,
        value_enum,
        value_name = "line|slow",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "line"
    )]
    remove_drift: Option<Drift>,
    /// Take recordings whole, with whatever comes before and after the rhythm.
    #[arg(long)]
    uncut: bool,
    /// Seed of the synthetic demonstrator, where nothing else is learned.
    #[arg(long, value_name = "SEED", default_value_t = 0)]
    seed: u64,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Drift {
    Line,
    Slow,
}

/// Says that recordings may spoil the set, and which verb shows it.
fn warn_of_findings(recordings: &[Recording]) -> Result<()> {
    let mut found: BTreeMap<Flag, usize> = BTreeMap::new();
    let mut spoilt = Vec::new();
    for recording in recordings {
        let findings = Inspection::of(recording)?.findings;
        let flags: BTreeSet<Flag> = findings.iter().map(|finding| finding.flag).collect();
        let flags: Vec<Flag> = flags.into_iter().filter(|flag| flag.spoils()).collect();
        if !flags.is_empty() {
            spoilt.push(recording.name());
        }
        for flag in flags {
            *found.entry(flag).or_default() += 1;
        }
    }
    let Some(first) = spoilt.first() else {
        return Ok(());
    };
    let what: Vec<String> = found
        .iter()
        .map(|(flag, count)| format!("{count} {}", flag.code()))
        .collect();
    output::warn(format!(
        "{} of {} recordings, such as {first}, have something to look at ({}): `undulate inspect-demos` shows it",
        spoilt.len(),
        recordings.len(),
        what.join(", ")
    ));
    Ok(())
}

/// Whole turns are in how angles were written, and in no motion.
fn without_jumps(recording: Recording) -> Recording {
    let unwrapped = recording.unwrapped();
    if unwrapped != recording {
        output::note(format!(
            "{}: jumps of whole turns are taken out",
            recording.name()
        ));
    }
    unwrapped
}

impl Recordings {
    /// Gestures, cut to a common period.
    pub fn demonstrations(&self) -> Result<Demonstrations> {
        self.cut(&self.gestures()?)
    }

    /// Gestures that were read, cut to a common period.
    pub fn cut(&self, recordings: &[Recording]) -> Result<Demonstrations> {
        if self.is_synthetic()? {
            return synthetic(self.seed);
        }
        let duration = self.duration.map_or(Duration::Auto, Duration::Seconds);
        Demonstrations::new(recordings.to_vec(), duration)
    }

    pub fn has_duration(&self) -> bool {
        self.duration.is_some()
    }

    /// An option that says how gestures are cut and mended, where there is one.
    pub fn about_gestures(&self) -> Option<&'static str> {
        let options = [
            (self.has_duration(), "--duration"),
            (self.remove_drift.is_some(), "--remove-drift"),
            (self.uncut, "--uncut"),
        ];
        options.iter().find(|(given, _)| *given).map(|o| o.1)
    }

    /// What of the recordings is rhythmic, each at its own length; says what is left out.
    pub fn gestures(&self) -> Result<Vec<Recording>> {
        let recordings = self.recorded()?;
        let synthetic = self.is_synthetic()?;
        if !synthetic {
            warn_of_findings(&recordings)?;
        }
        let mut gestures = Vec::new();
        for recording in recordings {
            let recording = without_jumps(recording);
            if self.uncut || synthetic {
                gestures.push(recording);
                continue;
            }
            let found = recording.gestures();
            if found
                .iter()
                .any(|gesture| gesture.name() != recording.name())
            {
                let (used, all) = (
                    found.iter().map(Recording::span).sum::<f64>(),
                    recording.span(),
                );
                output::note(format!(
                    "{}: {used:.2} of {all:.2} s are a rhythm, and used: {}; --uncut takes all",
                    recording.name(),
                    match found.len() {
                        1 => "one part".to_owned(),
                        count => format!("{count} parts"),
                    }
                ));
            }
            gestures.extend(found);
        }
        Ok(gestures
            .into_iter()
            .map(|gesture| match self.remove_drift {
                None => gesture,
                Some(Drift::Line) => gesture.without_drift(),
                Some(Drift::Slow) => gesture.without_slow_drift(),
            })
            .collect())
    }

    /// As they were recorded.
    fn recorded(&self) -> Result<Vec<Recording>> {
        self.read()?.into_iter().collect()
    }

    /// Those that can be read and have the joints of the first that can, and what is wrong with the others.
    ///
    /// # Errors
    /// When there is none.
    pub fn readable(&self) -> Result<(Vec<Recording>, Vec<Error>)> {
        let (mut recordings, mut errors): (Vec<Recording>, Vec<Error>) = (Vec::new(), Vec::new());
        for one in self.read()? {
            match one.and_then(|one| {
                same_joints(recordings.first().unwrap_or(&one), &one)?;
                Ok(one)
            }) {
                Ok(one) => recordings.push(one),
                Err(error) => errors.push(error),
            }
        }
        if recordings.is_empty() && !errors.is_empty() {
            return Err(errors.swap_remove(0));
        }
        Ok((recordings, errors))
    }

    fn is_synthetic(&self) -> Result<bool> {
        if self.inputs.is_empty() && self.list.is_none() {
            let about_files = self.joints.is_some()
                || self.degrees
                || self.remove_drift.is_some()
                || self.uncut
                || self.duration.is_some();
            if about_files {
                return Err(Error::new(
                    ErrorKind::Setting,
                    "options for recordings, and no recordings",
                )
                .expected("CSV files, a folder of them, or --list"));
            }
            return Ok(true);
        }
        Ok(false)
    }

    /// File by file.
    fn read(&self) -> Result<Vec<Result<Recording>>> {
        if self.is_synthetic()? {
            let demonstrations = synthetic(self.seed)?;
            return Ok(demonstrations
                .recordings()
                .iter()
                .cloned()
                .map(Ok)
                .collect());
        }
        let mut files = Vec::new();
        for input in &self.inputs {
            if input.is_dir() {
                files.extend(Recording::files_in(input)?);
            } else {
                files.push(input.clone());
            }
        }
        if let Some(list) = &self.list {
            files.extend(Recording::files_listed(list, self.root.as_deref())?);
        }
        let options = CsvOptions {
            degrees: self.degrees,
            joints: self.joints.clone(),
        };
        let bar = output::progress(files.len() as u64, "reading recordings");
        let mut recordings = Vec::new();
        for file in &files {
            recordings.push(Recording::open(file, &options));
            bar.inc(1);
        }
        bar.finish_and_clear();
        Ok(recordings)
    }
}

//! The recordings that a verb learns from, as arguments.

use std::path::PathBuf;

use clap::Args;

use super::output;
use crate::demonstration::{CsvOptions, Demonstrations, Duration, Recording, synthetic};
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
    /// Take a straight line out of each joint's recording first.
    #[arg(long)]
    remove_drift: bool,
    /// Seed of the synthetic demonstrator, where nothing else is learned.
    #[arg(long, value_name = "SEED", default_value_t = 0)]
    seed: u64,
}

impl Recordings {
    /// Cut to a common period.
    pub fn demonstrations(&self) -> Result<Demonstrations> {
        self.cut(&self.uncut()?)
    }

    /// Those that were read, cut to a common period.
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

    /// As they were recorded.
    pub fn uncut(&self) -> Result<Vec<Recording>> {
        if self.is_synthetic()? {
            return Ok(synthetic(self.seed)?.recordings().to_vec());
        }
        self.read()
    }

    fn is_synthetic(&self) -> Result<bool> {
        if self.inputs.is_empty() && self.list.is_none() {
            let about_files = self.joints.is_some()
                || self.degrees
                || self.remove_drift
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

    fn read(&self) -> Result<Vec<Recording>> {
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
            let recording = Recording::open(file, &options)?;
            recordings.push(if self.remove_drift {
                recording.without_drift()
            } else {
                recording
            });
            bar.inc(1);
        }
        bar.finish_and_clear();
        Ok(recordings)
    }
}

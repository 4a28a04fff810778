//! Words, tables, progress, and files that appear whole or not at all.

use std::io::{IsTerminal, Write as _};
use std::path::Path;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::Value;

use crate::error::{Error, ErrorKind, Result};

/// Writes a line to standard output. A reader that has gone away is no error of ours.
pub(super) fn say(text: impl AsRef<str>) {
    let _ = writeln!(std::io::stdout(), "{}", text.as_ref());
}

/// The report of a verb: the JSON object, or the words.
pub(super) fn report(json: bool, value: &Value, words: impl FnOnce() -> String) {
    if json {
        say(value.to_string());
    } else {
        say(words());
    }
}

/// A line beside the report, on standard error.
pub(super) fn note(text: impl AsRef<str>) {
    let _ = writeln!(std::io::stderr(), "{}", text.as_ref());
}

/// Something that the user should know and that stops nothing.
pub(super) fn warn(text: impl AsRef<str>) {
    let _ = writeln!(
        std::io::stderr(),
        "{}: {}",
        painted("warning", "33"),
        text.as_ref()
    );
}

pub(super) fn failure(error: &Error) {
    let _ = writeln!(std::io::stderr(), "{}: {error}", painted("error", "31"));
}

/// Colour only on a terminal, and not where the user asked for none.
fn painted(word: &str, color: &str) -> String {
    if std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none() {
        format!("\u{1b}[1;{color}m{word}\u{1b}[0m")
    } else {
        word.to_owned()
    }
}

/// A bar on standard error for work of `steps` steps; nothing where that is no terminal.
pub(super) fn progress(steps: u64, doing: &str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(steps), ProgressDrawTarget::stderr_with_hz(10));
    if let Ok(style) = ProgressStyle::with_template("{msg:32} {wide_bar} {pos}/{len} {eta}") {
        bar.set_style(style);
    }
    bar.set_message(doing.to_owned());
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

/// Writes a file under another name beside it first, so that it appears whole or not at all. A link is followed, and what
/// is no regular file (a pipe, a device) is written to as it is.
pub(super) fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    let fail = |e: std::io::Error| Error::io(path, &e);
    let target = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    if std::fs::metadata(&target).is_ok_and(|m| !m.is_file() && !m.is_dir()) {
        let mut stream = std::fs::OpenOptions::new()
            .write(true)
            .open(&target)
            .map_err(fail)?;
        return stream.write_all(bytes).map_err(fail);
    }
    if let Some(folder) = target.parent().filter(|p| !p.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(fail)?;
    }
    let mut name = target.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}.part", std::process::id()));
    let part = target.with_file_name(name);
    let done = std::fs::write(&part, bytes).and_then(|()| std::fs::rename(&part, &target));
    done.map_err(|e| {
        let _ = std::fs::remove_file(&part);
        fail(e)
    })
}

/// A file of numbers in columns, with a header.
pub(super) fn csv<R: IntoIterator<Item = f64>>(
    header: impl IntoIterator<Item = String>,
    rows: impl IntoIterator<Item = R>,
) -> Result<Vec<u8>> {
    let fail = |e: csv::Error| Error::new(ErrorKind::Io, e.to_string());
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(header).map_err(fail)?;
    for row in rows {
        let row = row.into_iter().map(|number| number.to_string());
        writer.write_record(row).map_err(fail)?;
    }
    writer
        .into_inner()
        .map_err(|e| Error::new(ErrorKind::Io, e.to_string()))
}

/// A table with a header, its first column to the left and the others to the right.
pub(super) fn table(header: &[&str], rows: &[Vec<String>]) -> String {
    let width = |column: usize| {
        let cells = rows
            .iter()
            .filter_map(|row| row.get(column))
            .map(|c| c.chars().count());
        cells
            .chain([header[column].chars().count()])
            .max()
            .unwrap_or(0)
    };
    let widths: Vec<usize> = (0..header.len()).map(width).collect();
    let line = |cells: &[String]| {
        let padded: Vec<String> = cells
            .iter()
            .zip(&widths)
            .enumerate()
            .map(|(i, (cell, width))| {
                if i == 0 {
                    format!("{cell:<width$}")
                } else {
                    format!("{cell:>width$}")
                }
            })
            .collect();
        padded.join("  ").trim_end().to_owned()
    };
    let header: Vec<String> = header.iter().map(|h| (*h).to_owned()).collect();
    let mut lines = vec![line(&header)];
    lines.extend(rows.iter().map(|row| line(row)));
    lines.join("\n")
}

/// Degrees with a decimal, from radians.
pub(super) fn degrees(radians: f64) -> String {
    let text = format!("{:.1}", radians.to_degrees());
    // What is zero but for rounding has no sign.
    if text == "-0.0" { "0.0".into() } else { text }
}

//! Recordings from CSV: one file a demonstration, a `time_s` column in seconds, a column a joint.

use std::path::{Path, PathBuf};

use nalgebra::DMatrix;

use super::Recording;
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::Joints;
use crate::table::Table;

/// The column of time stamps.
const TIME: &str = "time_s";

/// How to read a table of joint positions.
#[derive(Debug, Clone, Default)]
pub struct CsvOptions {
    /// Positions are degrees, not radians.
    pub degrees: bool,
    /// Which columns are joints, in this order; all but `time_s` when `None`.
    pub joints: Option<Vec<String>>,
}

impl Recording {
    /// Reads a CSV text. Columns that are not picked are not looked at.
    ///
    /// ```
    /// use undulate::{CsvOptions, Recording};
    ///
    /// let text = "time_s,elbow\n0.0,0.1\n0.5,0.2\n";
    /// let recording = Recording::from_csv("wave.csv", text.as_bytes(), &CsvOptions::default())?;
    /// assert_eq!(recording.positions()[(1, 0)], 0.2);
    /// # Ok::<(), undulate::Error>(())
    /// ```
    ///
    /// # Errors
    /// Names line and column of whatever is not a table of finite numbers at increasing times.
    pub fn from_csv(name: &str, text: &[u8], options: &CsvOptions) -> Result<Self> {
        parse(name, text, options).map_err(|e| e.at(name))
    }

    /// [`from_csv`](Self::from_csv) of a file, named after it.
    ///
    /// # Errors
    /// Those of `from_csv`, and when the file cannot be read.
    pub fn open(path: &Path, options: &CsvOptions) -> Result<Self> {
        let text = crate::document::bytes(path)?;
        Self::from_csv(&path.display().to_string(), &text, options)
    }

    /// The CSV files of a folder, by name.
    ///
    /// # Errors
    /// When the folder cannot be read or holds none.
    pub fn files_in(folder: &Path) -> Result<Vec<PathBuf>> {
        let entries = std::fs::read_dir(folder).map_err(|e| Error::io(folder, &e))?;
        let mut files = Vec::new();
        let mut is_captured = false;
        for entry in entries {
            let path = entry.map_err(|e| Error::io(folder, &e))?.path();
            let is = |kind: &str| {
                path.extension()
                    .is_some_and(|e| e.eq_ignore_ascii_case(kind))
            };
            is_captured |= is("bvh");
            if is("csv") {
                files.push(path);
            }
        }
        files.sort();
        if files.is_empty() {
            let error = Error::new(ErrorKind::Shape, "no CSV files")
                .expected("one file a demonstration")
                .at(folder.display().to_string());
            return Err(if is_captured {
                error.help("`undulate capture` makes them of BVH files")
            } else {
                error
            });
        }
        Ok(files)
    }

    /// The entries of a list file: one path a line, relative ones against `root` (the list's own folder when `None`);
    /// empty lines and those that start with `#` are passed over.
    ///
    /// # Errors
    /// When the list cannot be read, names nothing, or names a file that is not there (with its line).
    pub fn files_listed(list: &Path, root: Option<&Path>) -> Result<Vec<PathBuf>> {
        let text = std::fs::read_to_string(list).map_err(|e| Error::io(list, &e))?;
        let root = root.unwrap_or_else(|| list.parent().unwrap_or(Path::new("")));
        let mut files = Vec::new();
        for (i, line) in text.lines().enumerate() {
            let line = line.trim_start_matches('\u{feff}').trim();
            if line.is_empty() || line.starts_with('#') {
                continue;
            }
            let path = root.join(line);
            if !path.is_file() {
                return Err(
                    Error::new(ErrorKind::Io, format!("no file {}", path.display()))
                        .help("entries resolve against --root, by default the folder of the list")
                        .at(format!("line {}", i + 1))
                        .at(list.display().to_string()),
                );
            }
            files.push(path);
        }
        if files.is_empty() {
            return Err(Error::new(ErrorKind::Shape, "the list is empty")
                .expected("one path a line")
                .at(list.display().to_string()));
        }
        Ok(files)
    }
}

fn parse(name: &str, text: &[u8], options: &CsvOptions) -> Result<Recording> {
    if text.trim_ascii_start().starts_with(b"HIERARCHY") {
        return Err(Error::new(ErrorKind::Unsupported, "motion capture (BVH)")
            .expected("a CSV table of joint angles")
            .help("`undulate capture` makes one of it"));
    }
    let table = Table::new(
        text,
        &format!("a header `{TIME},joint,..` and one row a sample"),
    )?;
    let time = table
        .column(TIME)
        .map_err(|e| e.help("the column of times in seconds is called `time_s`"))?;
    let names: Vec<String> = match &options.joints {
        Some(names) => names.clone(),
        None => table
            .columns()
            .into_iter()
            .enumerate()
            .filter(|(i, _)| *i != time)
            .map(|(_, c)| c.to_owned())
            .collect(),
    };
    let picked = names
        .iter()
        .map(|n| table.column(n))
        .collect::<Result<Vec<_>>>()?;
    let joints = Joints::new(names).map_err(|e| e.at("line 1"))?;

    let (unit, expected) = if options.degrees {
        (1f64.to_radians(), "an angle in degrees")
    } else {
        (1.0, "an angle in radians")
    };
    let mut times: Vec<f64> = Vec::new();
    let mut rows: Vec<f64> = Vec::new();
    table.rows(|row| {
        let t = row.number(time, "a time in seconds")?;
        if let Some(before) = times.last()
            && t <= *before
        {
            return Err(Error::new(
                ErrorKind::Value,
                format!("time {t} s does not come after {before} s"),
            )
            .expected("strictly increasing times")
            .help("sort the rows by time and remove repeated ones"));
        }
        times.push(t);
        for &column in &picked {
            rows.push(row.number(column, expected)? * unit);
        }
        Ok(())
    })?;
    if times.len() < 2 {
        return Err(
            Error::new(ErrorKind::Shape, format!("{} samples", times.len()))
                .expected("at least two rows under the header"),
        );
    }
    let positions = DMatrix::from_row_slice(times.len(), joints.len(), &rows);
    Recording::new(name, joints, times, positions)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Recording> {
        Recording::from_csv("r.csv", text.as_bytes(), &CsvOptions::default())
    }

    #[test]
    fn columns_are_picked_by_name_and_degrees_become_radians() {
        let options = CsvOptions {
            degrees: true,
            joints: Some(vec!["b".into()]),
        };
        let text = "\u{feff}a, b ,time_s\r\nx,180,0\r\ny,-90,0.5\r\n";
        let r = Recording::from_csv("r.csv", text.as_bytes(), &options).unwrap();
        assert_eq!(r.joints().name(0), "b");
        assert_eq!(r.positions()[(0, 0)], std::f64::consts::PI);
        assert_eq!(r.times(), [0.0, 0.5]);
    }

    #[test]
    fn each_bad_input_gets_its_place() {
        for (text, places) in [
            ("", "r.csv: the file is empty"),
            ("t,a\n0,0\n", "no column `time_s`"),
            ("time_s\n0\n1\n", "no joints"),
            ("time_s,a\n", "r.csv: 0 samples"),
            ("time_s,a\n0,0\n", "r.csv: 1 samples"),
            (
                "time_s,a\n0,0\n0,1\n",
                "r.csv, line 3: time 0 s does not come after 0 s",
            ),
            (
                "time_s,a\n1,0\n0,1\n",
                "r.csv, line 3: time 0 s does not come after 1 s",
            ),
            (
                "time_s,a\n0,0\n1,NaN\n",
                "r.csv, line 3, column `a`: found `NaN`, expected an angle in radians",
            ),
            ("time_s,a\n0,0\n1,\n", "r.csv, line 3, column `a`: found ``"),
            (
                "time_s,a\n0,one\n",
                "r.csv, line 2, column `a`: found `one`",
            ),
            (
                "time_s,a\ninf,1\n",
                "r.csv, line 2, column `time_s`: found `inf`",
            ),
            ("time_s,a\n0,1,2\n", "r.csv, line 2: 3 fields, expected 2"),
            ("time_s,a,a\n0,1,2\n", "two columns `a`"),
            (
                "HIERARCHY\nROOT hip\n",
                "r.csv: motion capture (BVH), expected a CSV table of joint angles; `undulate capture`",
            ),
            ("time_s;a\n0;1\n", "columns are separated by ';'"),
        ] {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains(places), "{text:?} got: {error}");
        }
    }
}

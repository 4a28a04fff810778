//! The one error of the crate: what went wrong, where, what was expected and what to do about it.

mod reason;

use std::fmt;
use std::path::Path;

pub use reason::Reason;

/// What sort of thing went wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// A file or stream could not be read or written.
    Io,
    /// Text does not follow the grammar of its format.
    Syntax,
    /// A number is not finite, out of its range, or otherwise not a value of the quantity it stands for.
    Value,
    /// A setting of the caller's, not a datum, is out of its range: a time step, a number of harmonics.
    Setting,
    /// Counts do not fit together: samples and harmonics, joints of two files, rows and columns.
    Shape,
    /// A name (joint, link, file, coordinate) that is not there, or is there twice.
    Name,
    /// Everything is well-formed, and yet what was asked for cannot be had from it.
    Infeasible,
    /// What was asked about was looked at, and breaks a limit or lacks a proof: a motion that does not pass, a way that there is not.
    Refused,
    /// A file of a later version, or a feature that this version does not support.
    Unsupported,
}

/// What went wrong, where, what was expected and what to do.
///
/// Its text is one line, fit to be shown to the person whose input it is about:
///
/// ```
/// use undulate::{Error, ErrorKind};
///
/// let error = Error::new(ErrorKind::Value, "found `12,5`")
///     .expected("an angle in radians")
///     .help("write decimals with a point")
///     .at("column `elbow_flexion`")
///     .at("line 17")
///     .at("wave_3.csv");
/// assert_eq!(
///     error.to_string(),
///     "wave_3.csv, line 17, column `elbow_flexion`: found `12,5`, expected an angle in radians; write decimals with a point"
/// );
/// ```
#[derive(Clone, PartialEq, Eq)]
pub struct Error(Box<Detail>);

#[derive(Clone, PartialEq, Eq)]
struct Detail {
    kind: ErrorKind,
    what: String,
    /// Innermost first: each caller that knows more adds its own.
    places: Vec<String>,
    expected: Option<String>,
    help: Option<String>,
    reason: Option<Reason>,
}

/// The crate's result.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// An error of `kind`; `what` says what was found.
    pub fn new(kind: ErrorKind, what: impl Into<String>) -> Self {
        Self(Box::new(Detail {
            kind,
            what: what.into(),
            places: Vec::new(),
            expected: None,
            help: None,
            reason: None,
        }))
    }

    /// A file that could not be read or written.
    pub fn io(path: &Path, error: &std::io::Error) -> Self {
        Self::new(ErrorKind::Io, error.to_string())
            .help("check that the path exists and may be accessed")
            .at(path.display().to_string())
    }

    /// Says what would have been right.
    #[must_use]
    pub fn expected(mut self, expected: impl Into<String>) -> Self {
        self.0.expected = Some(expected.into());
        self
    }

    /// Says what to do, unless somebody nearer to the cause has said so already.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.0.help.get_or_insert_with(|| help.into());
        self
    }

    /// Names the reason for which a gate refuses, unless somebody nearer to the cause has named one.
    #[must_use]
    pub fn because(mut self, reason: Reason) -> Self {
        self.0.reason.get_or_insert(reason);
        self
    }

    /// The reason for which a gate refuses, where one was named; [`Reason::of`] has one for every error.
    pub fn reason(&self) -> Option<Reason> {
        self.0.reason
    }

    /// Adds a place around the places already named: a column, then its line, then its file.
    #[must_use]
    pub fn at(mut self, place: impl Into<String>) -> Self {
        self.0.places.push(place.into());
        self
    }

    /// What sort of thing went wrong.
    pub fn kind(&self) -> ErrorKind {
        self.0.kind
    }

    /// What was found.
    pub fn what(&self) -> &str {
        &self.0.what
    }

    /// Where, outermost first: file, line, column; robot, link.
    pub fn places(&self) -> impl Iterator<Item = &str> {
        self.0.places.iter().rev().map(String::as_str)
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, place) in self.places().enumerate() {
            write!(f, "{}{place}", if i == 0 { "" } else { ", " })?;
        }
        if !self.0.places.is_empty() {
            f.write_str(": ")?;
        }
        f.write_str(&self.0.what)?;
        if let Some(expected) = &self.0.expected {
            write!(f, ", expected {expected}")?;
        }
        if let Some(help) = &self.0.help {
            write!(f, "; {help}")?;
        }
        Ok(())
    }
}

/// The same line as `Display`, so that a test that unwraps shows what a user would read.
impl fmt::Debug for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}

impl std::error::Error for Error {}

/// Names in one line, for a message: not more than a dozen, and none at any length.
pub(crate) fn listed<S: AsRef<str>>(names: &[S]) -> String {
    const MOST: usize = 12;
    const LONGEST: usize = 40;
    let mut shown: Vec<String> = names
        .iter()
        .take(MOST)
        .map(|name| {
            let name = name.as_ref();
            match name.char_indices().nth(LONGEST) {
                Some((end, _)) => format!("{}..", &name[..end]),
                None => name.to_owned(),
            }
        })
        .collect();
    if names.len() > MOST {
        shown.push(format!("and {} more", names.len() - MOST));
    }
    shown.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_names_places_from_the_outside_in() {
        let error = Error::new(ErrorKind::Name, "no joint `elbo`")
            .at("line 3")
            .at("map.toml");
        assert_eq!(error.to_string(), "map.toml, line 3: no joint `elbo`");
        assert_eq!(error.places().collect::<Vec<_>>(), ["map.toml", "line 3"]);
    }

    #[test]
    fn lists_stay_short_whatever_they_list() {
        let names: Vec<String> = (0..1000)
            .map(|i| format!("{i}{}", "é".repeat(100)))
            .collect();
        let text = listed(&names);
        assert!(
            text.chars().count() < 700 && text.ends_with("and 988 more"),
            "{text}"
        );
        assert_eq!(listed(&["a", "b"]), "a, b");
    }
}

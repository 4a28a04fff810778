//! Tables as comma-separated text: a header of names, rows of numbers, errors that name line and column.

use crate::error::{Error, ErrorKind, Reason, Result, listed};

/// A table whose header has been read.
pub(crate) struct Table<'a> {
    reader: csv::Reader<&'a [u8]>,
    header: csv::StringRecord,
    /// The columns in the order of their names: a file may have as many columns as it likes.
    by_name: Vec<usize>,
}

impl<'a> Table<'a> {
    /// Reads the header; lines that start with `#` are passed over.
    ///
    /// # Errors
    /// When the text is empty, or its columns are not separated by commas.
    pub(crate) fn new(text: &'a [u8], expected: &str) -> Result<Self> {
        let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .from_reader(text);
        let header = reader.headers().map_err(syntax)?.clone();
        if header.is_empty() {
            return Err(Error::new(ErrorKind::Shape, "the file is empty").expected(expected));
        }
        if header.len() == 1
            && let Some(separator) = [';', '\t'].into_iter().find(|s| header[0].contains(*s))
        {
            return Err(Error::new(
                ErrorKind::Syntax,
                format!("columns are separated by {separator:?}"),
            )
            .expected("commas between columns and points in numbers")
            .at("line 1"));
        }
        let mut by_name: Vec<usize> = (0..header.len()).collect();
        by_name.sort_by_key(|i| &header[*i]);
        Ok(Self {
            reader,
            header,
            by_name,
        })
    }

    /// The names of the columns.
    pub(crate) fn columns(&self) -> Vec<&str> {
        self.header.iter().collect()
    }

    /// The one column called `wanted`.
    ///
    /// # Errors
    /// When there is none, or two.
    pub(crate) fn column(&self, wanted: &str) -> Result<usize> {
        let first = self.by_name.partition_point(|i| self.header[*i] < *wanted);
        let mut found = self.by_name[first..]
            .iter()
            .copied()
            .take_while(|i| self.header[*i] == *wanted);
        match (found.next(), found.next()) {
            (Some(i), None) => Ok(i),
            (None, _) => Err(Error::new(
                ErrorKind::Name,
                format!("no column `{wanted}` among {}", listed(&self.columns())),
            )
            .at("line 1")),
            (Some(_), Some(_)) => {
                Err(Error::new(ErrorKind::Name, format!("two columns `{wanted}`")).at("line 1"))
            }
        }
    }

    /// Hands every row to `take`; what goes wrong there is said to be in its line.
    ///
    /// # Errors
    /// Those of `take`, and when a row has not as many fields as the header.
    pub(crate) fn rows(mut self, mut take: impl FnMut(&Row<'_>) -> Result<()>) -> Result<()> {
        let mut record = csv::StringRecord::new();
        while self.reader.read_record(&mut record).map_err(syntax)? {
            let line = record.position().map_or(0, csv::Position::line);
            let row = Row {
                record: &record,
                header: &self.header,
            };
            take(&row).map_err(|e| e.at(format!("line {line}")))?;
        }
        Ok(())
    }
}

/// One row under the header.
pub(crate) struct Row<'a> {
    record: &'a csv::StringRecord,
    header: &'a csv::StringRecord,
}

impl Row<'_> {
    /// Whether the field is empty.
    pub(crate) fn is_empty(&self, column: usize) -> bool {
        self.record.get(column).unwrap_or("").is_empty()
    }

    /// The finite number of a column.
    ///
    /// # Errors
    /// When the field is not `expected`, a finite number.
    pub(crate) fn number(&self, column: usize, expected: &str) -> Result<f64> {
        let text = self.record.get(column).unwrap_or("");
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(Error::new(ErrorKind::Value, format!("found `{text}`"))
                .because(Reason::NotFinite)
                .expected(expected)
                .at(format!(
                    "column `{}`",
                    self.header.get(column).unwrap_or("")
                ))),
        }
    }
}

fn syntax(error: csv::Error) -> Error {
    let line = error.position().map(csv::Position::line);
    let what = match error.kind() {
        csv::ErrorKind::UnequalLengths {
            expected_len, len, ..
        } => {
            return Error::new(ErrorKind::Shape, format!("{len} fields"))
                .expected(format!("{expected_len}, as in the header"))
                .at(line.map_or("a row".into(), |l| format!("line {l}")));
        }
        csv::ErrorKind::Utf8 { .. } => "text that is not UTF-8".to_owned(),
        _ => error.to_string(),
    };
    let error = Error::new(ErrorKind::Syntax, what).expected("comma-separated numbers");
    match line {
        Some(line) => error.at(format!("line {line}")),
        None => error,
    }
}

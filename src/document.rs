//! Files that are read whole, and versioned JSON documents: a header that says what the rest is, looked at before the rest.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use serde::{Deserialize, Serialize, de::DeserializeOwned};

use crate::error::{Error, ErrorKind, Result};

/// Bytes of any input: an hour at 1 kHz of seven joints is below this, and what it is read into within a gigabyte.
const LARGEST: u64 = 256 << 20;

/// The bytes of a file. A pipe or a device says nothing of its size, so the bound is on what is read.
pub(crate) fn bytes(path: &Path) -> Result<Vec<u8>> {
    let fail = |e: std::io::Error| Error::io(path, &e);
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(fail)?;
    file.take(LARGEST + 1)
        .read_to_end(&mut bytes)
        .map_err(fail)?;
    if bytes.len() as u64 > LARGEST {
        return Err(Error::new(ErrorKind::Value, "the file is too large")
            .expected(format!("at most {} MB", LARGEST >> 20))
            .at(path.display().to_string()));
    }
    Ok(bytes)
}

/// What every document starts with.
#[derive(Deserialize)]
struct Header {
    format: String,
    version: u64,
}

/// The text of a document; every number reads back bit for bit.
pub(crate) fn write<T: Serialize>(file: &T) -> String {
    let mut text =
        serde_json::to_string(file).expect("strings and finite numbers have a JSON form");
    text.push('\n');
    text
}

/// The version of a document that must call itself `format`, from 1 to `latest`.
pub(crate) fn version(text: &str, format: &str, latest: u64) -> Result<u64> {
    let header: Header = serde_json::from_str(text).map_err(|e| syntax(&e, format))?;
    if header.format != format {
        return Err(
            Error::new(ErrorKind::Syntax, format!("format `{}`", header.format))
                .expected(format!("`{format}`")),
        );
    }
    if header.version == 0 || header.version > latest {
        return Err(Error::new(
            ErrorKind::Unsupported,
            format!("version {}", header.version),
        )
        .expected(format!("1 to {latest}"))
        .help("the file was written by a later undulate: update, or write it again"));
    }
    Ok(header.version)
}

/// Reads a document that must call itself `format`, of a version from 1 to `latest`.
pub(crate) fn read<T: DeserializeOwned>(text: &str, format: &str, latest: u64) -> Result<T> {
    version(text, format, latest)?;
    serde_json::from_str(text).map_err(|e| syntax(&e, format))
}

fn syntax(e: &serde_json::Error, format: &str) -> Error {
    let what = if e.is_eof() {
        "the file is cut short".to_owned()
    } else {
        e.to_string()
    };
    Error::new(ErrorKind::Syntax, what)
        .expected(format!("an {format} file"))
        .at(format!("line {}, column {}", e.line(), e.column()))
}

//! Files of OBJ (Wavefront): vertices and faces.

use nalgebra::Point3;

use super::stl::number;
use super::{Builder, Mesh, check};
use crate::error::{Error, ErrorKind, Result, listed};

pub(super) fn read(bytes: &[u8]) -> Result<Mesh> {
    let mut builder = Builder::default();
    let mut vertices: Vec<Point3<f64>> = Vec::new();
    let mut statement: Vec<&[u8]> = Vec::new();
    for (n, line) in bytes.split(|b| *b == b'\n').enumerate() {
        let line = line.trim_ascii_end();
        let here = |e: Error| e.at(format!("line {}", n + 1));
        // A backslash at the end of a line continues it.
        let open = line.strip_suffix(b"\\");
        let words = open.unwrap_or(line).split(u8::is_ascii_whitespace);
        statement.extend(words.filter(|word| !word.is_empty()));
        if open.is_some() {
            continue;
        }
        match statement.split_first() {
            Some((&b"v", numbers)) => vertices.push(vertex(numbers).map_err(here)?),
            Some((&b"f", corners)) => face(corners, &vertices, &mut builder).map_err(here)?,
            _ => {}
        }
        statement.clear();
    }
    if !statement.is_empty() {
        return Err(Error::new(ErrorKind::Syntax, "the file ends within a line")
            .help("it is cut off: export the mesh again"));
    }
    builder.finish()
}

/// x, y, z; weights and colours may follow.
fn vertex(words: &[&[u8]]) -> Result<Point3<f64>> {
    let mut point = Point3::origin();
    for (i, x) in point.iter_mut().enumerate() {
        *x = words.get(i).and_then(|word| number(word)).ok_or_else(|| {
            let found: Vec<_> = words.iter().map(|w| String::from_utf8_lossy(w)).collect();
            Error::new(
                ErrorKind::Syntax,
                format!("`v {}`", listed(&found).replace(',', "")),
            )
            .expected("`v` and three numbers")
        })?;
    }
    check(&point)?;
    Ok(point)
}

/// Corners as `v`, `v/vt`, `v//vn` or `v/vt/vn`.
fn face(words: &[&[u8]], vertices: &[Point3<f64>], builder: &mut Builder) -> Result<()> {
    if words.len() < 3 {
        return Err(Error::new(
            ErrorKind::Syntax,
            format!("a face of {} corners", words.len()),
        )
        .expected("at least three"));
    }
    let corner = |word: &[u8]| {
        let digits = word.split(|b| *b == b'/').next().unwrap_or(word);
        let index: Option<i64> = std::str::from_utf8(digits)
            .ok()
            .and_then(|t| t.parse().ok());
        let found = match index {
            Some(i) if i > 0 => usize::try_from(i - 1).ok(),
            // Back from the last vertex so far.
            Some(i) if i < 0 => usize::try_from(i.unsigned_abs())
                .ok()
                .and_then(|back| vertices.len().checked_sub(back)),
            _ => None,
        };
        found.and_then(|i| vertices.get(i)).copied().ok_or_else(|| {
            Error::new(
                ErrorKind::Syntax,
                format!("a corner `{}`", listed(&[String::from_utf8_lossy(word)])),
            )
            .expected(format!("one of the {} vertices so far", vertices.len()))
        })
    };
    let first = corner(words[0])?;
    let mut previous = corner(words[1])?;
    for word in &words[2..] {
        let next = corner(word)?;
        builder.push(&[first, previous, next])?;
        previous = next;
    }
    Ok(())
}

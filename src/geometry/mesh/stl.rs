//! Files of STL.

use nalgebra::Point3;

use super::{Builder, Mesh};
use crate::error::{Error, ErrorKind, Result, listed};

/// Bytes before the triangles of a binary file; the last four are their number.
const HEADER: usize = 84;

/// Bytes of one of them: a normal and three corners of three numbers each of 4 bytes, and two bytes of attributes.
const TRIANGLE: usize = 50;

pub(super) fn read(bytes: &[u8]) -> Result<Mesh> {
    let counted = bytes.get(HEADER - 4..HEADER).map(|b| little(b) as usize);
    let room = bytes.len().saturating_sub(HEADER) / TRIANGLE;
    let exact = bytes.len() >= HEADER && (bytes.len() - HEADER).is_multiple_of(TRIANGLE);
    let begins = bytes.trim_ascii_start();
    let solid = begins.len() >= 5 && begins[..5].eq_ignore_ascii_case(b"solid");
    match counted {
        Some(count) if count == room && (exact || !solid) => binary(&bytes[HEADER..]),
        _ if solid => text(bytes),
        Some(count) => Err(Error::new(
            ErrorKind::Syntax,
            format!("{count} triangles announced, but there are {room}"),
        )
        .help("the file is cut off or damaged: export the mesh again")),
        None => Err(
            Error::new(ErrorKind::Syntax, format!("{} bytes", bytes.len()))
                .expected("a file of STL, which begins with `solid` or has at least 84 bytes"),
        ),
    }
}

fn little(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |n, b| n << 8 | u32::from(*b))
}

fn binary(bytes: &[u8]) -> Result<Mesh> {
    let mut builder = Builder::default();
    for (n, triangle) in bytes.chunks_exact(TRIANGLE).enumerate() {
        let number = |corner: usize, axis: usize| {
            let at = 12 + 12 * corner + 4 * axis;
            f64::from(f32::from_bits(little(&triangle[at..at + 4])))
        };
        let corner = |c| Point3::new(number(c, 0), number(c, 1), number(c, 2));
        builder
            .push(&[corner(0), corner(1), corner(2)])
            .map_err(|e| e.at(format!("triangle {}", n + 1)))?;
    }
    builder.finish()
}

/// Text: `facet`, `outer loop`, three times `vertex x y z`, `endloop`, `endfacet`, in lines, between `solid` and `endsolid`.
fn text(bytes: &[u8]) -> Result<Mesh> {
    let mut builder = Builder::default();
    let mut corners = Vec::with_capacity(3);
    let mut within = false;
    for (n, line) in bytes.split(|b| *b == b'\n').enumerate() {
        let here = |e: Error| e.at(format!("line {}", n + 1));
        let wrong = |expected: &str| {
            let found = String::from_utf8_lossy(line.trim_ascii());
            here(
                Error::new(ErrorKind::Syntax, format!("`{}`", listed(&[found]))).expected(expected),
            )
        };
        // Names of solids may be in any encoding, so not the whole line need be text.
        let mut words = line
            .split(u8::is_ascii_whitespace)
            .filter(|word| !word.is_empty());
        match words.next().map(<[u8]>::to_ascii_lowercase).as_deref() {
            None | Some(b"solid" | b"endsolid" | b"facet" | b"endfacet") if !within => {}
            Some(b"outer") if !within => within = true,
            Some(b"vertex") if within && corners.len() < 3 => {
                let mut point = Point3::origin();
                for x in point.iter_mut() {
                    *x = words
                        .next()
                        .and_then(number)
                        .ok_or_else(|| wrong("`vertex` and three numbers"))?;
                }
                super::check(&point).map_err(here)?;
                corners.push(point);
            }
            Some(b"endloop") if within => {
                let triangle = corners[..]
                    .try_into()
                    .map_err(|_| wrong("three vertices first"))?;
                builder.push(triangle).map_err(here)?;
                corners.clear();
                within = false;
            }
            None => {}
            Some(_) if within => return Err(wrong("`vertex` three times, then `endloop`")),
            Some(_) => return Err(wrong("`facet`, `outer loop`, `endfacet` or `endsolid`")),
        }
    }
    if within {
        return Err(
            Error::new(ErrorKind::Syntax, "the file ends within a triangle")
                .help("it is cut off: export the mesh again"),
        );
    }
    builder.finish()
}

/// A number, also `nan`: what it may be is asked later.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

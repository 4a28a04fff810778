//! How much a text may ask for, counted before anything is built of it.
//!
//! Trees of XML cost many times their text, and parsers spend time on what no robot needs: a million elements took 1 GB,
//! 1e5 attributes of one element 21 s. One pass over the bytes counts what the parsers behind it would build; what it
//! does not understand it leaves to them. With these bounds the largest text is read within 200 MB (measured, tests/loader.rs).

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::error::{Error, ErrorKind, Result};

/// Bytes of a URDF or SRDF.
pub(super) const LARGEST_TEXT: usize = 16 << 20;

/// Elements, comments and processing instructions of a text: 20 000 links with all that belongs to them have 280 000.
const MOST_ELEMENTS: usize = 300_000;

/// Attributes of a text.
const MOST_ATTRIBUTES: usize = 600_000;

/// Attributes of one element: a parser compares each with each.
const MOST_OF_ONE: usize = 64;

/// Declarations of namespaces: a parser copies those in scope for each that is added.
const MOST_NAMESPACES: usize = 256;

/// No real file nests deeper; the parsers behind this recurse.
const DEEPEST: usize = 64;

/// The text of a file of at most [`LARGEST_TEXT`] bytes, without its mark of byte order.
pub(super) fn read(path: &Path) -> Result<String> {
    let fail = |e: std::io::Error| Error::io(path, &e);
    let here = |e: Error| e.at(path.display().to_string());
    // A pipe says nothing of its size: the bound is on what is read.
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(fail)?;
    file.take(LARGEST_TEXT as u64 + 1)
        .read_to_end(&mut bytes)
        .map_err(fail)?;
    if bytes.len() > LARGEST_TEXT {
        return Err(here(too_large()));
    }
    let utf16 = bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]);
    String::from_utf8(bytes).map_err(|_| {
        let error = Error::new(ErrorKind::Syntax, "text that is not UTF-8");
        here(if utf16 {
            error.help("it is UTF-16: save it as UTF-8")
        } else {
            error
        })
    })
}

fn too_large() -> Error {
    Error::new(ErrorKind::Value, "the text is too large")
        .expected(format!("at most {} MB", LARGEST_TEXT >> 20))
}

/// What has been counted, and where the count stands.
struct Counts<'a> {
    text: &'a str,
    elements: usize,
    attributes: usize,
    namespaces: usize,
    depth: usize,
}

/// Refuses a text that asks for more than the bounds above.
pub(super) fn check(text: &str) -> Result<()> {
    if text.len() > LARGEST_TEXT {
        return Err(too_large());
    }
    let mut counts = Counts {
        text,
        elements: 0,
        attributes: 0,
        namespaces: 0,
        depth: 0,
    };
    let mut at = 0;
    // What is cut short ends the count; the parser says so.
    while let Some(start) = text[at..].find('<').map(|i| at + i) {
        let rest = &text[start..];
        let closed_by = |end: &str| rest.find(end).map(|i| start + i + end.len());
        let end = if rest.starts_with("<!--") {
            counts.element(start)?;
            closed_by("-->")
        } else if rest.starts_with("<![CDATA[") {
            counts.element(start)?;
            closed_by("]]>")
        } else if rest.starts_with("<!DOCTYPE") {
            return Err(doctype(text, start));
        } else if rest.starts_with("<!") {
            // The parser goes no farther either.
            break;
        } else if rest.starts_with("<?") {
            counts.element(start)?;
            closed_by("?>")
        } else if rest.starts_with("</") {
            counts.depth = counts.depth.saturating_sub(1);
            closed_by(">")
        } else {
            counts.element(start)?;
            counts.tag(start)?
        };
        let Some(end) = end else { break };
        at = end;
    }
    Ok(())
}

/// Entities are declared there, and expand without end.
pub(super) fn doctype(text: &str, at: usize) -> Error {
    Error::new(ErrorKind::Syntax, "a document type declaration")
        .expected("a complete XML text without entities")
        .at(line(text, at))
}

/// The line of a byte of the text.
fn line(text: &str, at: usize) -> String {
    let breaks = text.as_bytes()[..at].iter().filter(|b| **b == b'\n');
    format!("line {}", 1 + breaks.count())
}

impl Counts<'_> {
    fn refuse(&self, what: String, at: usize) -> Error {
        Error::new(ErrorKind::Value, what)
            .expected("a robot description")
            .at(line(self.text, at))
    }

    fn element(&mut self, at: usize) -> Result<()> {
        self.elements += 1;
        if self.elements > MOST_ELEMENTS {
            return Err(self.refuse(format!("more than {MOST_ELEMENTS} elements"), at));
        }
        Ok(())
    }

    /// The tag that opens at `start`: its attributes, and where it ends.
    fn tag(&mut self, start: usize) -> Result<Option<usize>> {
        let bytes = self.text.as_bytes();
        let mut quote = None;
        let mut name = start + 1;
        let mut gap = false;
        let mut own = 0;
        for (i, byte) in bytes.iter().enumerate().skip(start + 1) {
            match (quote, byte) {
                (Some(q), b) if q == b => {
                    quote = None;
                    gap = true;
                }
                (Some(_), _) => {}
                (None, b'"' | b'\'') => quote = Some(byte),
                (None, b'>') => {
                    if bytes[i - 1] != b'/' {
                        self.depth += 1;
                        if self.depth > DEEPEST {
                            let what = format!("elements nest deeper than {DEEPEST}");
                            return Err(self.refuse(what, start));
                        }
                    }
                    return Ok(Some(i + 1));
                }
                (None, b'=') => {
                    own += 1;
                    self.attributes += 1;
                    self.namespaces += usize::from(bytes[name..].starts_with(b"xmlns"));
                    if own > MOST_OF_ONE {
                        let what = format!("an element of more than {MOST_OF_ONE} attributes");
                        return Err(self.refuse(what, start));
                    }
                    if self.attributes > MOST_ATTRIBUTES {
                        let what = format!("more than {MOST_ATTRIBUTES} attributes");
                        return Err(self.refuse(what, start));
                    }
                    if self.namespaces > MOST_NAMESPACES {
                        let what = format!("more than {MOST_NAMESPACES} namespaces");
                        return Err(self.refuse(what, start));
                    }
                }
                (None, b) if b.is_ascii_whitespace() => gap = true,
                // A name starts after a gap, and may be followed by another before its `=`.
                (None, _) if gap => {
                    name = i;
                    gap = false;
                }
                _ => {}
            }
        }
        Ok(None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(text: &str) -> String {
        check(text).unwrap_err().to_string()
    }

    #[test]
    fn each_bound_is_told_with_its_line() {
        let many = |piece: &str, n: usize| format!("<robot>\n{}</robot>", piece.repeat(n));
        for (text, message) in [
            (
                many("<a/>", MOST_ELEMENTS),
                "line 2: more than 300000 elements",
            ),
            (many("<!---->", MOST_ELEMENTS), "more than 300000 elements"),
            (many("<?p?>", MOST_ELEMENTS), "more than 300000 elements"),
            (
                many("<![CDATA[x]]>", MOST_ELEMENTS),
                "more than 300000 elements",
            ),
            (many("<a>", DEEPEST), "line 2: elements nest deeper than 64"),
            (
                format!("<robot\n{}/>", " a = 'x>'".repeat(MOST_OF_ONE + 1)),
                "line 1: an element of more than 64 attributes",
            ),
            (
                many(
                    &format!("<a {}/>", "b='' ".repeat(60)),
                    MOST_ATTRIBUTES / 60 + 1,
                ),
                "more than 600000 attributes",
            ),
            (
                many("<a xmlns:b ='c' d='e'/>", MOST_NAMESPACES + 1),
                "more than 256 namespaces",
            ),
            ("<!DOCTYPE r>".into(), "line 1: a document type declaration"),
            (
                " ".repeat(LARGEST_TEXT + 1),
                "the text is too large, expected at most 16 MB",
            ),
        ] {
            let error = refusal(&text);
            assert!(error.contains(message), "`{message}`, got: {error}");
        }
    }

    #[test]
    fn what_looks_like_markup_in_values_and_comments_is_none() {
        let quiet = "<a b='<c d=&quot;' e=\"'>=\"/>".repeat(MOST_OF_ONE);
        let comment = format!("<!-- {} -->", "<a b='c'>".repeat(1000));
        let data = format!("<![CDATA[{}]]>", "<a><b>".repeat(1000));
        check(&format!("<robot>{quiet}{comment}{data}<b></b></robot>")).unwrap();
        // Cut short anywhere, the count ends quietly.
        let text = "<r a='b'><!-- c --><![CDATA[d]]><?e?></r>";
        for end in 0..text.len() {
            check(&text[..end]).unwrap();
        }
    }
}

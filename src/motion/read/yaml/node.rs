//! The values of a YAML text with their lines, no more of them than the text holds.

use std::borrow::Cow;

use saphyr_parser::{Event, Parser, ScalarStyle};

use super::{Error, ErrorKind, Reason, Result};

/// Deeper nesting is no motion file.
const DEEPEST: usize = 32;

/// The largest file: some five thousand waypoints of seven joints, and such files are written by hand. The parser may hold
/// all tokens of a line, and takes two hundred times the bytes of one that is made to overwhelm it.
pub(super) const MOST_BYTES: usize = 1 << 19;

/// The most keys of one mapping.
const MOST_KEYS: usize = 1_000;

/// A value of the file and the line where it starts.
pub(super) struct Node<'a> {
    pub(super) line: usize,
    value: Value<'a>,
}

enum Value<'a> {
    /// Plain, when it was not quoted: only then may it be a number.
    Scalar {
        text: Cow<'a, str>,
        plain: bool,
    },
    List(Vec<Node<'a>>),
    Map(Vec<(Cow<'a, str>, Node<'a>)>),
}

impl<'a> Node<'a> {
    pub(super) fn map(&self) -> Option<&[(Cow<'a, str>, Node<'a>)]> {
        match &self.value {
            Value::Map(entries) => Some(entries),
            _ => None,
        }
    }

    pub(super) fn get(&self, key: &str) -> Option<&Node<'a>> {
        let entries = self.map()?;
        entries.iter().find(|(k, _)| k == key).map(|(_, node)| node)
    }

    pub(super) fn error(&self, what: impl Into<String>) -> Error {
        Error::new(ErrorKind::Syntax, what)
            .because(Reason::Unreadable)
            .at(format!("line {}", self.line))
    }

    fn scalars(&self, what: &str) -> Result<&[Node<'a>]> {
        match &self.value {
            Value::List(items) => Ok(items),
            _ => Err(self.error(format!("{what} that are no list"))),
        }
    }

    pub(super) fn numbers(&self, what: &str) -> Result<Vec<f64>> {
        self.scalars(what)?
            .iter()
            .map(|item| {
                let found = match &item.value {
                    Value::Scalar { text, plain: true } => match text.parse::<f64>() {
                        Ok(number) if number.is_finite() => return Ok(number),
                        _ => format!("found `{text}` among {what}"),
                    },
                    _ => format!("no number among {what}"),
                };
                Err(Error::new(ErrorKind::Value, found)
                    .because(Reason::NotFinite)
                    .expected("a finite number")
                    .at(format!("line {}", item.line)))
            })
            .collect()
    }

    pub(super) fn names(&self, what: &str) -> Result<Vec<String>> {
        self.scalars(what)?
            .iter()
            .map(|item| match &item.value {
                Value::Scalar { text, .. } => Ok(text.clone().into_owned()),
                _ => Err(item.error(format!("no name among {what}"))),
            })
            .collect()
    }
}

/// A list or mapping that has begun; a mapping with the key whose value comes next.
struct Open<'a> {
    node: Node<'a>,
    key: Option<Cow<'a, str>>,
}

pub(super) fn parse(text: &str) -> Result<Node<'_>> {
    let mut open: Vec<Open<'_>> = Vec::new();
    let mut root = None;
    if text.len() > MOST_BYTES {
        return Err(
            Error::new(ErrorKind::Unsupported, format!("{} bytes", text.len()))
                .because(Reason::TooLarge)
                .expected(format!("at most {MOST_BYTES}"))
                .help("write long moves as CSV or JSON"),
        );
    }
    for event in Parser::new_from_str(text) {
        let (event, span) = event.map_err(|e| {
            Error::new(ErrorKind::Syntax, e.info())
                .because(Reason::Unreadable)
                .expected("a YAML file of play_motion2")
                .at(format!("line {}", e.marker().line()))
        })?;
        let line = span.start.line();
        let unsupported = |what: &str| {
            Err(Error::new(ErrorKind::Unsupported, what)
                .because(Reason::Unsupported)
                .expected("plain mappings, lists, names and numbers")
                .at(format!("line {line}")))
        };
        let (value, begins) = match event {
            Event::Scalar(text, style, _, None) => {
                let plain = style == ScalarStyle::Plain;
                (Value::Scalar { text, plain }, false)
            }
            Event::SequenceStart(_, None) => (Value::List(Vec::new()), true),
            Event::MappingStart(_, None) => (Value::Map(Vec::new()), true),
            Event::SequenceEnd | Event::MappingEnd => {
                // The parser closes what it has opened and nothing else.
                if let Some(Open { node, .. }) = open.pop() {
                    place(node, &mut open, &mut root)?;
                }
                continue;
            }
            Event::Alias(_) => return unsupported("an alias"),
            Event::Scalar(..) | Event::SequenceStart(..) | Event::MappingStart(..) => {
                return unsupported("a tag");
            }
            Event::DocumentStart(_) if root.is_some() => return unsupported("a second document"),
            _ => continue,
        };
        if open.len() >= DEEPEST {
            return Err(Error::new(ErrorKind::Unsupported, "nested too deep")
                .because(Reason::TooLarge)
                .expected(format!("{DEEPEST} levels at most"))
                .at(format!("line {line}")));
        }
        let node = Node { line, value };
        if begins {
            open.push(Open { node, key: None });
        } else {
            place(node, &mut open, &mut root)?;
        }
    }
    root.ok_or_else(|| {
        Error::new(ErrorKind::Syntax, "the file is empty")
            .because(Reason::Unreadable)
            .expected("a YAML file of play_motion2")
    })
}

/// Puts a whole node where it belongs: into what is open, or at the root.
fn place<'a>(node: Node<'a>, open: &mut [Open<'a>], root: &mut Option<Node<'a>>) -> Result<()> {
    let Some(parent) = open.last_mut() else {
        *root = Some(node);
        return Ok(());
    };
    match &mut parent.node.value {
        Value::List(items) => items.push(node),
        Value::Map(entries) => match (parent.key.take(), node) {
            (Some(key), node) => entries.push((key, node)),
            (
                None,
                Node {
                    value: Value::Scalar { text, .. },
                    line,
                },
            ) => {
                // As many keys as there are motions: a scan will do, but not of a million.
                if entries.len() >= MOST_KEYS {
                    return Err(Error::new(
                        ErrorKind::Unsupported,
                        format!("more than {MOST_KEYS} keys in one mapping"),
                    )
                    .because(Reason::TooLarge)
                    .at(format!("line {line}")));
                }
                if entries.iter().any(|(k, _)| *k == text) {
                    return Err(Error::new(ErrorKind::Name, format!("key `{text}` twice"))
                        .because(Reason::Unreadable)
                        .at(format!("line {line}")));
                }
                parent.key = Some(text);
            }
            (None, node) => return Err(node.error("a key that is no name")),
        },
        Value::Scalar { .. } => {}
    }
    Ok(())
}

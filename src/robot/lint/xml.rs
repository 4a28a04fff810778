//! Attributes of XML elements as checked values.

use std::collections::HashMap;

use roxmltree::{Document, Node};

use super::LONGEST;
use crate::error::{Error, ErrorKind, Result, listed};

/// No length, angle, mass or inertia of a robot is larger; sums and products of such numbers stay finite.
const LARGEST: f64 = 1e9;

/// Elements by their `name`.
pub(super) type Names<'a> = HashMap<&'a str, Node<'a, 'a>>;

/// A parsed text, with the lines of its elements.
pub(in crate::robot) struct Xml<'a> {
    document: &'a Document<'a>,
    /// Of the format: 1.1 turns by quaternions too, 1.2 reads limits that are not there as none.
    pub version: (u32, u32),
}

impl<'a> Xml<'a> {
    /// As the parser behind this does, a version that is not there or no version counts as 1.0.
    pub(in crate::robot) fn of(document: &'a Document<'a>) -> Self {
        let version = document
            .root_element()
            .attribute("version")
            .and_then(|v| v.trim().split_once('.'))
            .and_then(|(major, minor)| Some((major.parse().ok()?, minor.parse().ok()?)))
            .unwrap_or((1, 0));
        Self { document, version }
    }

    pub(super) fn line(&self, node: Node) -> String {
        format!("line {}", self.document.text_pos_at(node.range().start).row)
    }

    pub(in crate::robot) fn refuse(&self, node: Node, what: impl Into<String>) -> Error {
        Error::new(ErrorKind::Value, what).at(self.line(node))
    }

    pub(super) fn inside(&self, error: Error, node: Node) -> Error {
        error.at(format!(
            "{} `{}`",
            node.tag_name().name(),
            listed(&[node.attribute("name").unwrap_or("")])
        ))
    }

    /// The children of the root called `tag`, by name.
    pub(super) fn named(&self, root: Node<'a, 'a>, tag: &str) -> Result<Names<'a>> {
        let mut names = Names::new();
        for node in root.children().filter(|n| n.has_tag_name(tag)) {
            let name = self.text(node, "name")?;
            if names.insert(name, node).is_some() {
                return Err(Error::new(
                    ErrorKind::Name,
                    format!("two {tag}s are called `{}`", listed(&[name])),
                )
                .at(self.line(node)));
            }
        }
        Ok(names)
    }

    /// An attribute that must be there, free of leftovers of a macro language.
    pub(in crate::robot) fn text(&self, node: Node<'a, 'a>, attribute: &str) -> Result<&'a str> {
        let tag = node.tag_name().name();
        match node.attribute(attribute) {
            None => Err(self.refuse(node, format!("<{tag}> without `{attribute}`"))),
            Some(text) if text.contains("${") || text.contains("$(") => Err(Error::new(
                ErrorKind::Unsupported,
                format!("unexpanded xacro in {attribute}=\"{}\"", listed(&[text])),
            )
            .help("expand the file first: xacro robot.xacro > robot.urdf")
            .at(self.line(node))),
            Some(text) if text.len() > LONGEST => Err(self
                .refuse(node, format!("{attribute} of {} bytes", text.len()))
                .expected(format!("at most {LONGEST}"))),
            Some(text) if text.contains(char::is_control) => Err(self
                .refuse(node, format!("a control character in {attribute}"))
                .expected("printable text")),
            Some("") => Err(self.refuse(node, format!("<{tag}> with an empty `{attribute}`"))),
            Some(text) => Ok(text),
        }
    }

    /// Numbers of moderate size: lengths, angles, masses.
    pub(super) fn numbers(
        &self,
        node: Node<'a, 'a>,
        attribute: &str,
        count: usize,
    ) -> Result<Vec<f64>> {
        let numbers = self.any_numbers(node, attribute, count)?;
        if numbers.iter().all(|x| x.abs() <= LARGEST) {
            return Ok(numbers);
        }
        let text = listed(&[node.attribute(attribute).unwrap_or("")]);
        Err(self
            .refuse(node, format!("{attribute}=\"{text}\""))
            .expected(format!("numbers within +-{LARGEST:e}")))
    }

    /// Finite numbers; limits are often given as 1e16 or the like.
    pub(super) fn any_numbers(
        &self,
        node: Node<'a, 'a>,
        attribute: &str,
        count: usize,
    ) -> Result<Vec<f64>> {
        let text = self.text(node, attribute)?;
        let numbers: Option<Vec<f64>> = text
            .split_whitespace()
            .map(|word| word.parse().ok().filter(|x: &f64| x.is_finite()))
            .collect();
        numbers.filter(|n| n.len() == count).ok_or_else(|| {
            self.refuse(node, format!("{attribute}=\"{}\"", listed(&[text])))
                .expected(match count {
                    1 => "a finite number".to_owned(),
                    _ => format!("{count} finite numbers"),
                })
        })
    }

    pub(super) fn number(&self, node: Node<'a, 'a>, attribute: &str) -> Result<f64> {
        Ok(self.numbers(node, attribute, 1)?[0])
    }

    pub(super) fn optional_limit(
        &self,
        node: Node<'a, 'a>,
        attribute: &str,
    ) -> Result<Option<f64>> {
        node.attribute(attribute)
            .map(|_| Ok(self.any_numbers(node, attribute, 1)?[0]))
            .transpose()
    }

    pub(super) fn optional_number(
        &self,
        node: Node<'a, 'a>,
        attribute: &str,
    ) -> Result<Option<f64>> {
        node.attribute(attribute)
            .map(|_| self.number(node, attribute))
            .transpose()
    }

    pub(super) fn positive(&self, node: Node<'a, 'a>, attribute: &str, count: usize) -> Result<()> {
        let numbers = self.numbers(node, attribute, count)?;
        if numbers.iter().all(|x| *x > 0.0) {
            return Ok(());
        }
        let text = listed(&[node.attribute(attribute).unwrap_or("")]);
        Err(self
            .refuse(node, format!("{attribute}=\"{text}\""))
            .expected("positive lengths"))
    }

    pub(super) fn child(&self, node: Node<'a, 'a>, tag: &str) -> Option<Node<'a, 'a>> {
        node.children().find(|n| n.has_tag_name(tag))
    }

    pub(super) fn origin(&self, node: Node<'a, 'a>) -> Result<()> {
        if let Some(origin) = self.child(node, "origin") {
            for attribute in ["xyz", "rpy"] {
                if origin.has_attribute(attribute) {
                    self.numbers(origin, attribute, 3)?;
                }
            }
            if self.version >= (1, 1) && origin.has_attribute("quat_xyzw") {
                return Err(Error::new(ErrorKind::Unsupported, "a turn by `quat_xyzw`")
                    .expected("`rpy`")
                    .at(self.line(origin)));
            }
        }
        Ok(())
    }
}

//! Attributes of XML elements as checked values.

use std::collections::HashMap;

use roxmltree::{Document, Node};

use super::DEEPEST;

use crate::error::{Error, ErrorKind, Result, listed};

/// No length, angle, mass or inertia of a robot is larger; sums and products of such numbers stay finite.
const LARGEST: f64 = 1e9;

/// Elements by their `name`.
pub(super) type Names<'a> = HashMap<&'a str, Node<'a, 'a>>;

/// A parsed text, with the lines of its elements.
pub(super) struct Xml<'a>(pub &'a Document<'a>);

impl<'a> Xml<'a> {
    pub(super) fn line(&self, node: Node) -> String {
        format!("line {}", self.0.text_pos_at(node.range().start).row)
    }

    pub(super) fn refuse(&self, node: Node, what: impl Into<String>) -> Error {
        Error::new(ErrorKind::Value, what).at(self.line(node))
    }

    pub(super) fn inside(&self, error: Error, node: Node) -> Error {
        error.at(format!(
            "{} `{}`",
            node.tag_name().name(),
            node.attribute("name").unwrap_or("")
        ))
    }

    pub(super) fn check_depth(&self) -> Result<()> {
        let mut depths: HashMap<roxmltree::NodeId, usize> = HashMap::new();
        for node in self.0.descendants() {
            let depth = node.parent().map_or(0, |p| depths[&p.id()] + 1);
            if depth > DEEPEST {
                return Err(self
                    .refuse(node, format!("elements nest deeper than {DEEPEST}"))
                    .expected("a robot description"));
            }
            depths.insert(node.id(), depth);
        }
        Ok(())
    }

    /// The children of the root called `tag`, by name.
    pub(super) fn named(&self, root: Node<'a, 'a>, tag: &str) -> Result<Names<'a>> {
        let mut names = Names::new();
        for node in root.children().filter(|n| n.has_tag_name(tag)) {
            let name = self.text(node, "name")?;
            if names.insert(name, node).is_some() {
                return Err(
                    Error::new(ErrorKind::Name, format!("two {tag}s are called `{name}`"))
                        .at(self.line(node)),
                );
            }
        }
        Ok(names)
    }

    /// An attribute that must be there, free of leftovers of a macro language.
    pub(super) fn text(&self, node: Node<'a, 'a>, attribute: &str) -> Result<&'a str> {
        let tag = node.tag_name().name();
        match node.attribute(attribute) {
            None => Err(self.refuse(node, format!("<{tag}> without `{attribute}`"))),
            Some(text) if text.contains("${") || text.contains("$(") => Err(Error::new(
                ErrorKind::Unsupported,
                format!("unexpanded xacro in {attribute}=\"{text}\""),
            )
            .help("expand the file first: xacro robot.xacro > robot.urdf")
            .at(self.line(node))),
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
        let text = node.attribute(attribute).unwrap_or("");
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
        }
        Ok(())
    }
}

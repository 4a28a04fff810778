//! What a URDF text must satisfy before a parser that hardly validates may see it.
//!
//! `urdf-rs` reads `xyz="1 2 x 3"` as three numbers, a joint without limits as limits of zero, NaN as a limit, and takes
//! unknown parents, cycles and double names as they come. Here every attribute that this crate reads is checked in
//! the XML itself, where its line is still known.

mod elements;
mod mimics;
mod tree;
mod xml;

use std::collections::HashMap;

use roxmltree::{Document, Node, ParsingOptions};

pub(in crate::robot) use self::xml::Xml;
use super::bounds;
use super::load::Inconsistent;
use crate::error::{Error, ErrorKind, Result, listed};

/// Bytes of an attribute that is read, paths of meshes among them.
pub(in crate::robot) const LONGEST: usize = 4096;

/// Links of a robot: kinematics, dynamics and descriptions hold about 1 kB for each.
const MOST_LINKS: usize = 30_000;

/// What is let pass, and has to be told: for a link whose inertia no body has, what is wrong and in which line.
pub(in crate::robot) type Doubtful = HashMap<String, String>;

/// The tree of a text that asks for no more than the bounds.
pub(in crate::robot) fn parse(text: &str) -> Result<Document<'_>> {
    bounds::check(text)?;
    // Without document types there are no entities to expand.
    let options = ParsingOptions::default();
    Document::parse_with_options(text, options).map_err(|e| {
        let what = match e {
            roxmltree::Error::DtdDetected => return bounds::doctype(text, 0),
            roxmltree::Error::UnexpectedEndOfStream | roxmltree::Error::UnclosedRootNode => {
                "the file is cut short".to_owned()
            }
            _ => e.to_string(),
        };
        Error::new(ErrorKind::Syntax, what)
            .expected("a complete XML text without entities")
            .at(format!("line {}", e.pos().row))
    })
}

/// The root of a document, which must be called <robot>.
pub(in crate::robot) fn root<'a>(document: &'a Document<'a>) -> Result<Node<'a, 'a>> {
    let root = document.root_element();
    if root.tag_name().name() == "robot" {
        return Ok(root);
    }
    let what = format!("root element <{}>", listed(&[root.tag_name().name()]));
    Err(Xml::of(document).refuse(root, what).expected("<robot>"))
}

/// Checks a document, tree of links included.
pub(in crate::robot) fn lint(document: &Document, inertia: Inconsistent) -> Result<Doubtful> {
    let xml = Xml::of(document);
    let root = root(document)?;
    if root.has_attribute("name") && root.attribute("name") != Some("") {
        xml.text(root, "name")?;
    }
    let links = xml.named(root, "link")?;
    if links.is_empty() {
        return Err(xml.refuse(root, "no links").expected("at least one <link>"));
    }
    if links.len() > MOST_LINKS {
        return Err(xml
            .refuse(root, format!("{} links", links.len()))
            .expected(format!("at most {MOST_LINKS}")));
    }
    let joints = xml.named(root, "joint")?;
    let mut doubtful = Doubtful::new();
    // In the order of the file: the first fault is the one that is told.
    for node in root.children().filter(Node::is_element) {
        match node.tag_name().name() {
            "link" => xml
                .link(node)
                .and_then(|()| xml.inertia(node, inertia, &mut doubtful)),
            "joint" => xml.joint(node, &links),
            _ => Ok(()),
        }
        .map_err(|e| xml.inside(e, node))?;
    }
    xml.mimics(root, &joints)?;
    xml.tree(&links, &joints)?;
    Ok(doubtful)
}

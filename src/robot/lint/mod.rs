//! What a URDF text must satisfy before a parser that hardly validates may see it.
//!
//! `urdf-rs` reads `xyz="1 2 x 3"` as three numbers, a joint without limits as limits of zero, NaN as a limit, and takes
//! unknown parents, cycles and double names as they come. Here every attribute that this crate reads is checked in
//! the XML itself, where its line is still known.

mod elements;
mod tree;
mod xml;

use roxmltree::{Document, Node, ParsingOptions};

use self::xml::Xml;

use crate::error::{Error, ErrorKind, Result};

/// No real file nests deeper; the parsers behind this one recurse.
const DEEPEST: usize = 64;

/// Checks the text, tree of links included.
pub(in crate::robot) fn lint(text: &str) -> Result<()> {
    // Without document types there are no entities to expand.
    let options = ParsingOptions::default();
    let document = Document::parse_with_options(text, options).map_err(|e| {
        let what = match e {
            roxmltree::Error::DtdDetected => "a document type declaration".to_owned(),
            roxmltree::Error::UnexpectedEndOfStream | roxmltree::Error::UnclosedRootNode => {
                "the file is cut short".to_owned()
            }
            _ => e.to_string(),
        };
        Error::new(ErrorKind::Syntax, what)
            .expected("a complete XML text without entities")
            .at(format!("line {}", e.pos().row))
    })?;
    let xml = Xml(&document);
    xml.check_depth()?;
    let root = document.root_element();
    if root.tag_name().name() != "robot" {
        return Err(xml
            .refuse(root, format!("root element <{}>", root.tag_name().name()))
            .expected("<robot>"));
    }
    let links = xml.named(root, "link")?;
    if links.is_empty() {
        return Err(xml.refuse(root, "no links").expected("at least one <link>"));
    }
    let joints = xml.named(root, "joint")?;
    // In the order of the file: the first fault is the one that is told.
    for node in root.children().filter(Node::is_element) {
        match node.tag_name().name() {
            "link" => xml.link(node),
            "joint" => xml.joint(node, &links, &joints),
            _ => Ok(()),
        }
        .map_err(|e| xml.inside(e, node))?;
    }
    xml.tree(&links, &joints)
}

//! What this crate reads of a URDF, and nothing else, handed to the parser in small pieces.
//!
//! `urdf-rs` builds a general tree of the whole text, writes it out sorted and reads that again: about 1 kB an element. It
//! also reads by rules of its own: a child element for an attribute, by the version of the format. Here it is given
//! elements and attributes that were checked, a few at a time.

use roxmltree::{Document, Node};

use super::lint::{self, LONGEST};
use crate::error::{Error, ErrorKind, Result};

/// Bytes of a piece, but for the element that goes beyond.
const PIECE: usize = 64 << 10;

/// What is read: an element and its attributes. What is in no list is skipped with all that it holds.
const READ: [(&str, &[&str]); 23] = [
    ("link", &["name"]),
    ("joint", &["name", "type"]),
    ("material", &["name"]),
    ("color", &["rgba"]),
    ("inertial", &[]),
    ("mass", &["value"]),
    ("inertia", &["ixx", "ixy", "ixz", "iyy", "iyz", "izz"]),
    ("visual", &[]),
    ("collision", &[]),
    ("origin", &["xyz", "rpy"]),
    ("geometry", &[]),
    ("box", &["size"]),
    ("sphere", &["radius"]),
    ("cylinder", &["radius", "length"]),
    ("capsule", &["radius", "length"]),
    ("mesh", &["filename", "scale"]),
    ("parent", &["link"]),
    ("child", &["link"]),
    ("axis", &["xyz"]),
    ("limit", &["lower", "upper", "velocity", "effort"]),
    ("dynamics", &["damping", "friction"]),
    ("mimic", &["joint", "multiplier", "offset"]),
    (
        "safety_controller",
        &[
            "soft_lower_limit",
            "soft_upper_limit",
            "k_position",
            "k_velocity",
        ],
    ),
];

/// Elements that say nothing of a joint that does not move, and are not checked there.
const OF_MOTION: [&str; 5] = ["axis", "limit", "dynamics", "mimic", "safety_controller"];

/// The robot of a document that has passed the lint.
pub(super) fn parse(document: &Document) -> Result<urdf_rs::Robot> {
    let root = lint::root(document)?;
    let mut robot = empty(root.attribute("name").unwrap_or(""));
    let mut piece = String::new();
    let kinds = ["link", "joint", "material"];
    let tag = |node: &Node| node.tag_name().name().to_owned();
    for node in root
        .children()
        .filter(|n| n.is_element() && kinds.contains(&tag(n).as_str()))
    {
        write(node, &mut piece);
        if piece.len() > PIECE {
            read(&piece, &mut robot)?;
            piece.clear();
        }
    }
    read(&piece, &mut robot)?;
    // A name that the parser reads otherwise than the lint did would be another robot's.
    let names = |kind: &'static str| {
        let named = move |n: &Node| n.has_tag_name(kind);
        root.children().filter(named).map(|n| n.attribute("name"))
    };
    let same = names("link").eq(robot.links.iter().map(|l| Some(l.name.as_str())))
        && names("joint").eq(robot.joints.iter().map(|j| Some(j.name.as_str())));
    if !same {
        return Err(Error::new(
            ErrorKind::Unsupported,
            "a name in characters that are not read",
        )
        .expected("letters, digits and signs"));
    }
    Ok(robot)
}

fn empty(name: &str) -> urdf_rs::Robot {
    urdf_rs::Robot {
        name: name.to_owned(),
        version: None,
        links: Vec::new(),
        joints: Vec::new(),
        materials: Vec::new(),
    }
}

fn read(piece: &str, robot: &mut urdf_rs::Robot) -> Result<()> {
    if piece.is_empty() {
        return Ok(());
    }
    let parsed = urdf_rs::read_from_string(&format!("<robot name=\"\">{piece}</robot>"))
        .map_err(|e| Error::new(ErrorKind::Syntax, e.to_string()).expected("a URDF"))?;
    robot.links.extend(parsed.links);
    robot.joints.extend(parsed.joints);
    robot.materials.extend(parsed.materials);
    Ok(())
}

/// Writes what is read of an element. It recurses as deep as elements that are read nest in each other: the bound on
/// depth holds here too.
fn write(node: Node, text: &mut String) {
    let tag = node.tag_name().name();
    let Some((_, attributes)) = READ.iter().find(|(name, _)| *name == tag) else {
        return;
    };
    if tag == "color" && !is_color(node.attribute("rgba").unwrap_or("")) {
        return;
    }
    text.push('<');
    text.push_str(tag);
    for name in *attributes {
        let value = match (tag, *name, node.attribute(*name)) {
            // Without a name it is nobody's but its own; without a limit there is none, written as 0.
            ("material", "name", None) => "",
            ("limit", "velocity", None) | ("safety_controller", "k_velocity", _) => "0",
            ("safety_controller", "soft_lower_limit", None) => "-inf",
            ("safety_controller", "soft_upper_limit", None) => "inf",
            ("material", "name", Some(name)) if name.len() > LONGEST => "",
            (.., None) => continue,
            (.., Some(value)) => value,
        };
        text.push(' ');
        text.push_str(name);
        text.push_str("=\"");
        escape(value, text);
        text.push('"');
    }
    text.push('>');
    let is_still = tag == "joint" && node.attribute("type") == Some("fixed");
    // A second shape would not be checked, and is not read.
    let most = if tag == "geometry" { 1 } else { usize::MAX };
    for child in node.children().filter(Node::is_element).take(most) {
        if !(is_still && OF_MOTION.contains(&child.tag_name().name())) {
            write(child, text);
        }
    }
    text.push_str("</");
    text.push_str(tag);
    text.push('>');
}

fn is_color(rgba: &str) -> bool {
    let is_part = |word: &str| word.parse().is_ok_and(f32::is_finite);
    rgba.len() <= LONGEST
        && rgba.split_whitespace().count() == 4
        && rgba.split_whitespace().all(is_part)
}

fn escape(value: &str, text: &mut String) {
    for c in value.chars() {
        match c {
            '&' => text.push_str("&amp;"),
            '<' => text.push_str("&lt;"),
            '>' => text.push_str("&gt;"),
            '"' => text.push_str("&quot;"),
            '\'' => text.push_str("&apos;"),
            // Attributes that are read hold no control characters but in numbers, where they part words.
            c if c.is_control() => text.push(' '),
            c => text.push(c),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_material_of_a_longer_name_than_is_read_has_none() {
        for (length, is_kept) in [(LONGEST, true), (LONGEST + 1, false)] {
            let name = "m".repeat(length);
            let source = format!("<material name=\"{name}\"/>");
            let document = roxmltree::Document::parse(&source).unwrap();
            let mut text = String::new();
            write(document.root_element(), &mut text);
            assert_eq!(text.contains(&name), is_kept, "{length}");
        }
    }
}

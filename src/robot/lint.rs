//! What a URDF text must satisfy before a parser that hardly validates may see it.
//!
//! `urdf-rs` reads `xyz="1 2 x 3"` as three numbers, a joint without limits as limits of zero, NaN as a limit, and takes
//! unknown parents, cycles and double names as they come. Here every attribute that this crate reads is checked in
//! the XML itself, where its line is still known.

use std::collections::{HashMap, HashSet};

use roxmltree::{Document, Node, ParsingOptions};

use crate::error::{Error, ErrorKind, Result, listed};

/// No real file nests deeper; the parsers behind this one recurse.
const DEEPEST: usize = 64;

/// No length, angle, mass or inertia of a robot is larger; sums and products of such numbers stay finite.
const LARGEST: f64 = 1e9;

/// Elements whose content is their attributes. The parser behind this would take a child element for an attribute of the
/// same name, past all checks here.
const LEAVES: [&str; 14] = [
    "origin", "axis", "limit", "dynamics", "mimic", "mass", "inertia", "parent", "child", "box",
    "sphere", "cylinder", "capsule", "mesh",
];

/// Checks the text, tree of links included.
pub(super) fn lint(text: &str) -> Result<()> {
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

type Names<'a> = HashMap<&'a str, Node<'a, 'a>>;

struct Xml<'a>(&'a Document<'a>);

impl<'a> Xml<'a> {
    fn line(&self, node: Node) -> String {
        format!("line {}", self.0.text_pos_at(node.range().start).row)
    }

    fn refuse(&self, node: Node, what: impl Into<String>) -> Error {
        Error::new(ErrorKind::Value, what).at(self.line(node))
    }

    fn inside(&self, error: Error, node: Node) -> Error {
        error.at(format!(
            "{} `{}`",
            node.tag_name().name(),
            node.attribute("name").unwrap_or("")
        ))
    }

    fn check_depth(&self) -> Result<()> {
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
    fn named(&self, root: Node<'a, 'a>, tag: &str) -> Result<Names<'a>> {
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
    fn text(&self, node: Node<'a, 'a>, attribute: &str) -> Result<&'a str> {
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
    fn numbers(&self, node: Node<'a, 'a>, attribute: &str, count: usize) -> Result<Vec<f64>> {
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
    fn any_numbers(&self, node: Node<'a, 'a>, attribute: &str, count: usize) -> Result<Vec<f64>> {
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

    fn number(&self, node: Node<'a, 'a>, attribute: &str) -> Result<f64> {
        Ok(self.numbers(node, attribute, 1)?[0])
    }

    fn optional_limit(&self, node: Node<'a, 'a>, attribute: &str) -> Result<Option<f64>> {
        node.attribute(attribute)
            .map(|_| Ok(self.any_numbers(node, attribute, 1)?[0]))
            .transpose()
    }

    fn optional_number(&self, node: Node<'a, 'a>, attribute: &str) -> Result<Option<f64>> {
        node.attribute(attribute)
            .map(|_| self.number(node, attribute))
            .transpose()
    }

    fn positive(&self, node: Node<'a, 'a>, attribute: &str, count: usize) -> Result<()> {
        let numbers = self.numbers(node, attribute, count)?;
        if numbers.iter().all(|x| *x > 0.0) {
            return Ok(());
        }
        let text = node.attribute(attribute).unwrap_or("");
        Err(self
            .refuse(node, format!("{attribute}=\"{text}\""))
            .expected("positive lengths"))
    }

    fn child(&self, node: Node<'a, 'a>, tag: &str) -> Option<Node<'a, 'a>> {
        node.children().find(|n| n.has_tag_name(tag))
    }

    fn origin(&self, node: Node<'a, 'a>) -> Result<()> {
        if let Some(origin) = self.child(node, "origin") {
            for attribute in ["xyz", "rpy"] {
                if origin.has_attribute(attribute) {
                    self.numbers(origin, attribute, 3)?;
                }
            }
        }
        Ok(())
    }

    /// Below a link or joint, leaves have no children, and elements that are read once are there once.
    fn structure(&self, node: Node<'a, 'a>) -> Result<()> {
        for element in node.descendants().filter(Node::is_element) {
            let tag = element.tag_name().name();
            if LEAVES.contains(&tag) && element.children().any(|c| c.is_element()) {
                return Err(self
                    .refuse(element, format!("<{tag}> with elements inside"))
                    .expected("its values as attributes"));
            }
            let mut seen = HashSet::new();
            for child in element.children().filter(Node::is_element) {
                let child_tag = child.tag_name().name();
                let once = LEAVES.contains(&child_tag)
                    || child_tag == "inertial"
                    || child_tag == "geometry";
                if once && !seen.insert(child_tag) {
                    return Err(self
                        .refuse(child, format!("a second <{child_tag}>"))
                        .expected("one"));
                }
            }
        }
        Ok(())
    }

    fn link(&self, node: Node<'a, 'a>) -> Result<()> {
        self.structure(node)?;
        if let Some(inertial) = self.child(node, "inertial") {
            self.origin(inertial)?;
            let part = |tag: &str| {
                self.child(inertial, tag)
                    .ok_or_else(|| self.refuse(inertial, format!("<inertial> without <{tag}>")))
            };
            self.number(part("mass")?, "value")?;
            let inertia = part("inertia")?;
            for attribute in ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"] {
                self.number(inertia, attribute)?;
            }
        }
        let is_solid = |n: &Node| n.has_tag_name("collision") || n.has_tag_name("visual");
        for solid in node.children().filter(is_solid) {
            self.origin(solid)?;
            self.geometry(solid)?;
        }
        Ok(())
    }

    fn geometry(&self, solid: Node<'a, 'a>) -> Result<()> {
        let shape = self
            .child(solid, "geometry")
            .and_then(|g| g.children().find(Node::is_element))
            .ok_or_else(|| {
                self.refuse(
                    solid,
                    format!(
                        "<{}> without a shape in its <geometry>",
                        solid.tag_name().name()
                    ),
                )
            })?;
        match shape.tag_name().name() {
            "box" => self.positive(shape, "size", 3),
            "sphere" => self.positive(shape, "radius", 1),
            "cylinder" | "capsule" => {
                self.positive(shape, "radius", 1)?;
                self.positive(shape, "length", 1)
            }
            "mesh" => {
                self.text(shape, "filename")?;
                if shape.has_attribute("scale") {
                    self.numbers(shape, "scale", 3)?;
                }
                Ok(())
            }
            other => Err(self
                .refuse(shape, format!("shape <{other}>"))
                .expected("box, sphere, cylinder, capsule or mesh")),
        }
    }

    fn joint(&self, node: Node<'a, 'a>, links: &Names, joints: &Names<'a>) -> Result<()> {
        self.structure(node)?;
        let kind = self.text(node, "type")?;
        let moves = match kind {
            "fixed" => false,
            "revolute" | "continuous" | "prismatic" => true,
            "floating" | "planar" | "spherical" => {
                return Err(
                    Error::new(ErrorKind::Unsupported, format!("a {kind} joint"))
                        .expected("revolute, continuous, prismatic or fixed")
                        .help("replace it by joints of one degree of freedom")
                        .at(self.line(node)),
                );
            }
            _ => {
                return Err(self
                    .refuse(node, format!("joint type `{kind}`"))
                    .expected("revolute, continuous, prismatic or fixed"));
            }
        };
        self.origin(node)?;
        for end in ["parent", "child"] {
            let element = self
                .child(node, end)
                .ok_or_else(|| self.refuse(node, format!("joint without <{end}>")))?;
            let link = self.text(element, "link")?;
            if !links.contains_key(link) {
                return Err(Error::new(
                    ErrorKind::Name,
                    format!("no link `{link}` to be its {end}"),
                )
                .help("add the link or correct the name")
                .at(self.line(element)));
            }
        }
        if !moves {
            return Ok(());
        }
        if let Some(axis) = self.child(node, "axis") {
            let axis_vector = self.numbers(axis, "xyz", 3)?;
            if axis_vector.iter().map(|x| x * x).sum::<f64>().sqrt() < 1e-9 {
                return Err(self
                    .refuse(axis, "an axis of length zero")
                    .expected("a direction"));
            }
        }
        self.limit(node, kind)?;
        if let Some(dynamics) = self.child(node, "dynamics") {
            for attribute in ["damping", "friction"] {
                if self
                    .optional_number(dynamics, attribute)?
                    .is_some_and(|x| x < 0.0)
                {
                    return Err(self
                        .refuse(dynamics, format!("negative {attribute}"))
                        .expected("zero or more"));
                }
            }
        }
        self.mimic(node, joints)
    }

    fn limit(&self, node: Node<'a, 'a>, kind: &str) -> Result<()> {
        let Some(limit) = self.child(node, "limit") else {
            return if kind == "continuous" {
                Ok(())
            } else {
                Err(self
                    .refuse(node, format!("a {kind} joint without <limit>"))
                    .help("add <limit lower=.. upper=.. velocity=.. effort=..>"))
            };
        };
        let lower = self.optional_limit(limit, "lower")?.unwrap_or(0.0);
        let upper = self.optional_limit(limit, "upper")?.unwrap_or(0.0);
        if lower > upper {
            return Err(self
                .refuse(
                    limit,
                    format!("lower limit {lower} above upper limit {upper}"),
                )
                .help("exchange them"));
        }
        if !limit.has_attribute("velocity") {
            return Err(self
                .refuse(limit, "<limit> without `velocity`")
                .expected("a speed, or 0 for not given"));
        }
        for attribute in ["velocity", "effort"] {
            if self
                .optional_limit(limit, attribute)?
                .is_some_and(|x| x < 0.0)
            {
                return Err(self
                    .refuse(limit, format!("negative {attribute} limit"))
                    .expected("a positive number, or 0 for not given"));
            }
        }
        Ok(())
    }

    fn mimic(&self, node: Node<'a, 'a>, joints: &Names<'a>) -> Result<()> {
        let mut at = node;
        let mut seen = HashSet::from([node.id()]);
        while let Some(mimic) = self.child(at, "mimic") {
            let leader = self.text(mimic, "joint")?;
            if self.optional_number(mimic, "multiplier")? == Some(0.0) {
                return Err(self
                    .refuse(mimic, "a mimic with multiplier 0 never moves")
                    .help("make the joint fixed"));
            }
            self.optional_number(mimic, "offset")?;
            let Some(leader_node) = joints.get(leader).copied() else {
                return Err(
                    Error::new(ErrorKind::Name, format!("no joint `{leader}` to mimic"))
                        .at(self.line(mimic)),
                );
            };
            if !seen.insert(leader_node.id()) {
                return Err(self.refuse(mimic, format!("mimic of `{leader}` comes back to itself")));
            }
            if leader_node.attribute("type") == Some("fixed") {
                return Err(self.refuse(mimic, format!("mimic of the fixed joint `{leader}`")));
            }
            at = leader_node;
        }
        Ok(())
    }

    /// One root, one parent a link, no cycle.
    fn tree(&self, links: &Names<'a>, joints: &Names<'a>) -> Result<()> {
        let end = |joint: Node<'a, 'a>, tag| {
            self.child(joint, tag)
                .and_then(|n| n.attribute("link"))
                .unwrap_or("")
        };
        let mut parents: HashMap<&str, &str> = HashMap::new();
        let mut in_order: Vec<Node> = joints.values().copied().collect();
        in_order.sort_by_key(|n| n.range().start);
        for joint in in_order {
            let (parent, child) = (end(joint, "parent"), end(joint, "child"));
            if let Some(other) = parents.insert(child, parent) {
                return Err(self.refuse(
                    joint,
                    format!("link `{child}` has two parents, `{other}` and `{parent}`"),
                ));
            }
        }
        let mut roots: Vec<&str> = links
            .keys()
            .copied()
            .filter(|l| !parents.contains_key(l))
            .collect();
        roots.sort_unstable();
        match roots.as_slice() {
            [] => {
                let mut all: Vec<&str> = links.keys().copied().collect();
                all.sort_unstable();
                Err(
                    Error::new(ErrorKind::Shape, "no root: the links form a cycle")
                        .expected("one link without a parent")
                        .at(format!("links {}", listed(&all))),
                )
            }
            // With one root and one parent each, what is not reached from the root is in a cycle.
            [root] => {
                let mut children: HashMap<&str, Vec<&str>> = HashMap::new();
                for (child, parent) in &parents {
                    children.entry(parent).or_default().push(child);
                }
                let mut reached = HashSet::from([*root]);
                let mut open = vec![*root];
                while let Some(link) = open.pop() {
                    for child in children.get(link).into_iter().flatten() {
                        reached.insert(child);
                        open.push(child);
                    }
                }
                let mut lost: Vec<&str> = links
                    .keys()
                    .copied()
                    .filter(|l| !reached.contains(l))
                    .collect();
                lost.sort_unstable();
                if lost.is_empty() {
                    return Ok(());
                }
                Err(
                    Error::new(ErrorKind::Shape, "links form a cycle apart from the root")
                        .expected("a tree")
                        .at(format!("links {}", listed(&lost))),
                )
            }
            many => Err(
                Error::new(ErrorKind::Shape, format!("{} roots", many.len()))
                    .expected("one link without a parent")
                    .help("join the parts with a fixed joint")
                    .at(format!("links {}", listed(many))),
            ),
        }
    }
}

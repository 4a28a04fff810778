//! Links and joints: what each must say.

use std::collections::HashSet;

use roxmltree::Node;

use super::super::inertia::{self, Fault};
use super::super::load::Inconsistent;
use super::Doubtful;
use super::xml::{Names, Xml};
use crate::error::{Error, ErrorKind, Result, listed};

/// Elements whose content is their attributes. The parser behind this would take a child element for an attribute of the
/// same name, past all checks here.
const LEAVES: [&str; 14] = [
    "origin", "axis", "limit", "dynamics", "mimic", "mass", "inertia", "parent", "child", "box",
    "sphere", "cylinder", "capsule", "mesh",
];

/// What elements are read of, and what of them.
const READ: [(&str, &[&str]); 6] = [
    ("link", &["inertial", "visual", "collision"]),
    (
        "joint",
        &[
            "origin",
            "parent",
            "child",
            "axis",
            "limit",
            "dynamics",
            "mimic",
            "calibration",
            "safety_controller",
        ],
    ),
    ("inertial", &["origin", "mass", "inertia"]),
    ("visual", &["origin", "geometry", "material"]),
    ("collision", &["origin", "geometry"]),
    (
        "geometry",
        &["box", "sphere", "cylinder", "capsule", "mesh"],
    ),
];

/// What is so few letters away from a name is a slip of the pen, and a shape or an axis that would be missed.
const SLIP: usize = 2;

/// The numbers of <inertia>.
const INERTIA: [&str; 6] = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];

/// Shapes of one link; each is read at once with all others.
const MOST_SHAPES: usize = 1024;

/// Findings that are told with their line.
const MOST_LINES: usize = 100;

/// What an element in another is taken for, whose name is nearly right.
fn meant(parent: &str, tag: &str) -> Option<&'static str> {
    let (_, read) = READ.iter().find(|(of, _)| *of == parent)?;
    if read.contains(&tag) {
        return None;
    }
    let near = |name: &&&str| {
        let slip = SLIP.min(name.len() / 3);
        name.len().abs_diff(tag.len()) <= slip && edits(name, tag) <= slip
    };
    read.iter().find(near).copied()
}

/// Letters to insert, drop or change (Levenshtein).
fn edits(a: &str, b: &str) -> usize {
    let b = b.as_bytes();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, letter) in a.bytes().enumerate() {
        let mut corner = row[0];
        row[0] = i + 1;
        for j in 0..b.len() {
            let changed = corner + usize::from(letter != b[j]);
            corner = row[j + 1];
            row[j + 1] = changed.min(row[j] + 1).min(corner + 1);
        }
    }
    row[b.len()]
}

impl<'a> Xml<'a> {
    /// Below a link or joint, leaves have no children, and elements that are read once are there once. What others have
    /// put there (sensors, simulators' settings) is not looked at.
    fn structure(&self, node: Node<'a, 'a>) -> Result<()> {
        let mut open = vec![node];
        while let Some(element) = open.pop() {
            let mut seen = HashSet::new();
            for child in element.children().filter(Node::is_element) {
                let tag = child.tag_name().name();
                if child.tag_name().namespace().is_none()
                    && let Some(meant) = meant(element.tag_name().name(), tag)
                {
                    return Err(self
                        .refuse(child, format!("<{}>", listed(&[tag])))
                        .expected(format!("<{meant}>")));
                }
                let is_leaf = LEAVES.contains(&tag);
                if is_leaf && child.children().any(|c| c.is_element()) {
                    return Err(self
                        .refuse(child, format!("<{tag}> with elements inside"))
                        .expected("its values as attributes"));
                }
                let once = is_leaf || ["inertial", "geometry"].contains(&tag);
                if once && !seen.insert(tag) {
                    return Err(self
                        .refuse(child, format!("a second <{tag}>"))
                        .expected("one"));
                }
                if ["inertial", "visual", "collision", "geometry"].contains(&tag) {
                    open.push(child);
                }
            }
        }
        Ok(())
    }

    pub(super) fn link(&self, node: Node<'a, 'a>) -> Result<()> {
        self.structure(node)?;
        if let Some(inertial) = self.child(node, "inertial") {
            self.origin(inertial)?;
            let part = |tag: &str| {
                self.child(inertial, tag)
                    .ok_or_else(|| self.refuse(inertial, format!("<inertial> without <{tag}>")))
            };
            self.number(part("mass")?, "value")?;
            let inertia = part("inertia")?;
            for attribute in INERTIA {
                self.number(inertia, attribute)?;
            }
        }
        let is_solid = |n: &Node| n.has_tag_name("collision") || n.has_tag_name("visual");
        let shapes = node.children().filter(is_solid).count();
        if shapes > MOST_SHAPES {
            return Err(self
                .refuse(node, format!("{shapes} shapes"))
                .expected(format!("at most {MOST_SHAPES} a link")));
        }
        for solid in node.children().filter(is_solid) {
            self.origin(solid)?;
            self.geometry(solid)?;
        }
        Ok(())
    }

    /// The inertia of a link that has mass: refused where kinetic energy could be negative, told where no body has it.
    pub(super) fn inertia(
        &self,
        node: Node<'a, 'a>,
        inconsistent: Inconsistent,
        doubtful: &mut Doubtful,
    ) -> Result<()> {
        let Some(inertial) = self.child(node, "inertial") else {
            return Ok(());
        };
        let (Some(mass), Some(inertia)) = (
            self.child(inertial, "mass"),
            self.child(inertial, "inertia"),
        ) else {
            return Ok(());
        };
        if inconsistent == Inconsistent::Mend || self.number(mass, "value")? <= 0.0 {
            return Ok(());
        }
        let mut six = [0.0; 6];
        for (number, attribute) in six.iter_mut().zip(INERTIA) {
            *number = self.number(inertia, attribute)?;
        }
        match inertia::fault(&inertia::tensor(six)) {
            None => Ok(()),
            Some(fault @ Fault::Indefinite(_)) => Err(self
                .refuse(inertia, fault.told())
                .expected("moments of a body with mass")
                .help("recompute the inertia from the mesh or shape, or have it mended")),
            Some(fault @ Fault::Triangle(_)) => {
                // Lines are counted from the start of the text: told for the first ones only.
                let line = match doubtful.len() {
                    0..MOST_LINES => format!(", {}", self.line(inertia)),
                    _ => String::new(),
                };
                let name = self.text(node, "name")?;
                let told = format!("link `{}`{line}: {}", listed(&[name]), fault.told());
                doubtful.insert(name.to_owned(), told);
                Ok(())
            }
        }
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
                    let scale = self.numbers(shape, "scale", 3)?;
                    if scale.contains(&0.0) {
                        return Err(self
                            .refuse(shape, "a mesh scaled by 0")
                            .expected("three factors, negative to mirror"));
                    }
                }
                Ok(())
            }
            other => Err(self
                .refuse(shape, format!("shape <{other}>"))
                .expected("box, sphere, cylinder, capsule or mesh")),
        }
    }

    pub(super) fn joint(&self, node: Node<'a, 'a>, links: &Names) -> Result<()> {
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
                    .refuse(node, format!("joint type `{}`", listed(&[kind])))
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
                    format!("no link `{}` to be its {end}", listed(&[link])),
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
        self.soft_limits(node)?;
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
        Ok(())
    }

    fn soft_limits(&self, node: Node<'a, 'a>) -> Result<()> {
        if let Some(safety) = self.child(node, "safety_controller") {
            for attribute in ["soft_lower_limit", "soft_upper_limit", "k_position"] {
                self.optional_limit(safety, attribute)?;
            }
        }
        Ok(())
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
        // In 1.2 what is not there is no limit: a joint without bounds is called continuous.
        if self.version >= (1, 2) && kind != "continuous" {
            for attribute in ["lower", "upper"] {
                if !limit.has_attribute(attribute) {
                    return Err(self
                        .refuse(limit, format!("<limit> without `{attribute}`"))
                        .expected("a bound; a joint without is continuous"));
                }
            }
        }
        if !limit.has_attribute("velocity") && self.version < (1, 2) {
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
}

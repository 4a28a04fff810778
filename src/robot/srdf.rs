//! What an SRDF says of a robot besides its URDF: pairs of links that need not be kept apart, groups, end effectors.

use std::collections::{BTreeSet, HashSet};
use std::path::Path;

use roxmltree::{Document, Node};

use super::lint::{self, Xml};
use super::{Robot, bounds};
use crate::error::{Error, ErrorKind, Result, listed};

/// A semantic description in the format of `MoveIt`. It is a text about some robot: names are looked up only when it is
/// held against one, with [`told`](Self::told).
#[derive(Debug, Clone, PartialEq)]
pub struct Srdf {
    name: String,
    disabled: Vec<(String, String, Option<String>)>,
    groups: Vec<Group>,
    end_effectors: Vec<EndEffector>,
    notes: Vec<String>,
}

/// A named set of links and joints.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Group {
    /// Its name.
    pub name: String,
    /// Links, each with the joint that holds it.
    pub links: Vec<String>,
    /// Joints.
    pub joints: Vec<String>,
    /// Base and tip: all joints between the two links.
    pub chains: Vec<(String, String)>,
    /// Other groups that belong to it.
    pub groups: Vec<String>,
}

/// A tool or hand.
#[derive(Debug, Clone, PartialEq)]
pub struct EndEffector {
    /// Its name.
    pub name: String,
    /// The group of its own joints.
    pub group: String,
    /// The link that carries it.
    pub parent_link: String,
}

/// Elements of the format that are of no use here: states to start from, joints that are not there.
const UNREAD: [&str; 7] = [
    "group_state",
    "virtual_joint",
    "passive_joint",
    "link_sphere_approximation",
    "joint_property",
    "property",
    "chain_property",
];

impl Srdf {
    /// Reads an SRDF text.
    ///
    /// ```
    /// use undulate::Srdf;
    ///
    /// let srdf = Srdf::from_xml(r#"<robot name="arm">
    ///   <disable_collisions link1="base" link2="elbow" reason="Never"/>
    /// </robot>"#)?;
    /// assert_eq!(srdf.disabled()[0], ("base".into(), "elbow".into(), Some("Never".into())));
    /// # Ok::<(), undulate::Error>(())
    /// ```
    ///
    /// # Errors
    /// When the text is no XML of a `<robot>`, lacks a name, or asks for more than a robot needs; the message names the line.
    pub fn from_xml(text: &str) -> Result<Self> {
        let text = text.trim_start_matches('\u{feff}').trim_start();
        if text.is_empty() {
            return Err(Error::new(ErrorKind::Syntax, "the file is empty").expected("an SRDF"));
        }
        let document = lint::parse(text)?;
        Reader::new(&document)?.read()
    }

    /// Reads an SRDF file.
    ///
    /// # Errors
    /// As [`from_xml`](Self::from_xml), and when the file cannot be read.
    pub fn open(path: &Path) -> Result<Self> {
        let text = bounds::read(path)?;
        Self::from_xml(&text).map_err(|e| e.at(path.display().to_string()))
    }

    /// The name of the robot that it is about.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Pairs of links that need not be kept apart, and the reason that the file gives; each pair once.
    pub fn disabled(&self) -> &[(String, String, Option<String>)] {
        &self.disabled
    }

    /// Groups in the order of the file.
    pub fn groups(&self) -> &[Group] {
        &self.groups
    }

    /// End effectors in the order of the file.
    pub fn end_effectors(&self) -> &[EndEffector] {
        &self.end_effectors
    }

    /// What does not fit `robot`, and what was not read: such parts of the file say nothing of this robot.
    pub fn told(&self, robot: &Robot) -> Vec<String> {
        let mut told = self.notes.clone();
        if self.name != robot.name() {
            told.push(format!(
                "the SRDF is about robot `{}`, not `{}`",
                self.name,
                robot.name()
            ));
        }
        let links: HashSet<&str> = robot.links().iter().map(|l| l.name.as_str()).collect();
        let joints: HashSet<&str> = robot
            .links()
            .iter()
            .filter_map(|l| l.joint.as_deref())
            .collect();
        let groups: HashSet<&str> = self.groups.iter().map(|g| g.name.as_str()).collect();
        // Each unknown name once, in the order of the alphabet.
        let mut unknown = BTreeSet::new();
        let mut look = |kind: &'static str, known: &HashSet<&str>, name: &str| {
            if !known.contains(name) {
                unknown.insert((kind, name.to_owned()));
            }
        };
        for (a, b, _) in &self.disabled {
            look("link", &links, a);
            look("link", &links, b);
        }
        for group in &self.groups {
            let ends = group.chains.iter().flat_map(|(base, tip)| [base, tip]);
            ends.chain(&group.links)
                .for_each(|name| look("link", &links, name));
            group
                .joints
                .iter()
                .for_each(|name| look("joint", &joints, name));
            group
                .groups
                .iter()
                .for_each(|name| look("group", &groups, name));
        }
        for effector in &self.end_effectors {
            look("link", &links, &effector.parent_link);
            look("group", &groups, &effector.group);
        }
        told.extend(
            unknown
                .iter()
                .map(|(kind, name)| format!("the SRDF names {kind} `{name}`, which is not there")),
        );
        told
    }

    /// The joints of a group that `robot` has, fixed ones too, in the order of its links: those listed, those that hold the
    /// listed links, those of chains, and those of the groups in it.
    ///
    /// # Errors
    /// When there is no such group, or one of its chains does not lead from base to tip.
    pub fn joints<'r>(&self, group: &str, robot: &'r Robot) -> Result<Vec<&'r str>> {
        let mut member = vec![false; robot.links().len()];
        let mut seen = HashSet::new();
        let mut open = vec![group];
        while let Some(name) = open.pop() {
            if !seen.insert(name) {
                continue;
            }
            let Some(group) = self.groups.iter().find(|g| g.name == name) else {
                let known: Vec<&str> = self.groups.iter().map(|g| g.name.as_str()).collect();
                return Err(
                    Error::new(ErrorKind::Name, format!("no group `{}`", listed(&[name])))
                        .expected(format!("one of {}", listed(&known)))
                        .at("SRDF"),
                );
            };
            let listed: HashSet<&str> = group.links.iter().map(String::as_str).collect();
            let joints: HashSet<&str> = group.joints.iter().map(String::as_str).collect();
            for (link, member) in robot.links().iter().zip(&mut member) {
                let by_joint = link.joint.as_deref().is_some_and(|j| joints.contains(j));
                *member |= by_joint || listed.contains(link.name.as_str());
            }
            for (base, tip) in &group.chains {
                for index in
                    between(robot, base, tip).map_err(|e| e.at(format!("group `{name}`")))?
                {
                    member[index] = true;
                }
            }
            open.extend(group.groups.iter().map(String::as_str));
        }
        let links = robot.links().iter().zip(member);
        Ok(links
            .filter(|(_, member)| *member)
            .filter_map(|(link, _)| link.joint.as_deref())
            .collect())
    }
}

/// The links after `base` up to `tip`.
fn between(robot: &Robot, base: &str, tip: &str) -> Result<Vec<usize>> {
    let index = |name: &str| robot.links().iter().position(|l| l.name == name);
    let mut links = Vec::new();
    let mut at = index(tip);
    while let Some(i) = at {
        let link = &robot.links()[i];
        if link.name == base {
            return Ok(links);
        }
        links.push(i);
        at = link.parent;
    }
    let what = format!("no chain from link `{base}` to `{tip}`");
    Err(Error::new(ErrorKind::Name, what).at("SRDF"))
}

struct Reader<'a> {
    xml: Xml<'a>,
    root: Node<'a, 'a>,
}

impl<'a> Reader<'a> {
    fn new(document: &'a Document<'a>) -> Result<Self> {
        let (xml, root) = (Xml::of(document), lint::root(document)?);
        Ok(Self { xml, root })
    }

    fn text(&self, node: Node<'a, 'a>, attribute: &str) -> Result<String> {
        self.xml.text(node, attribute).map(ToOwned::to_owned)
    }

    fn pair(&self, node: Node<'a, 'a>) -> Result<(String, String)> {
        Ok((self.text(node, "link1")?, self.text(node, "link2")?))
    }

    fn read(&self) -> Result<Srdf> {
        let mut srdf = Srdf {
            name: self.text(self.root, "name")?,
            disabled: Vec::new(),
            groups: Vec::new(),
            end_effectors: Vec::new(),
            notes: Vec::new(),
        };
        let (mut disabled, mut enabled) = (Vec::new(), HashSet::new());
        let mut unread = BTreeSet::new();
        for node in self.root.children().filter(Node::is_element) {
            match node.tag_name().name() {
                "disable_collisions" => {
                    let (a, b) = self.pair(node)?;
                    let reason = node.attribute("reason").map(|reason| listed(&[reason]));
                    if a == b {
                        srdf.notes
                            .push(format!("the SRDF disables link `{a}` against itself"));
                    } else {
                        disabled.push((a, b, reason));
                    }
                }
                "enable_collisions" => {
                    enabled.insert(ordered(self.pair(node)?));
                }
                "group" => srdf.groups.push(self.group(node)?),
                "end_effector" => srdf.end_effectors.push(EndEffector {
                    name: self.text(node, "name")?,
                    group: self.text(node, "group")?,
                    parent_link: self.text(node, "parent_link")?,
                }),
                tag if !UNREAD.contains(&tag) => {
                    unread.insert(listed(&[tag]));
                }
                _ => {}
            }
        }
        // What the file enables again stays checked.
        let mut seen = enabled;
        srdf.disabled = disabled
            .into_iter()
            .filter(|(a, b, _)| seen.insert(ordered((a.clone(), b.clone()))))
            .collect();
        let mut names = HashSet::new();
        if let Some(group) = srdf.groups.iter().find(|g| !names.insert(&g.name)) {
            let what = format!("two groups are called `{}`", listed(&[&group.name]));
            return Err(Error::new(ErrorKind::Name, what));
        }
        if !unread.is_empty() {
            let unread: Vec<String> = unread.into_iter().collect();
            srdf.notes.push(format!(
                "elements of the SRDF that are not read: {}",
                listed(&unread)
            ));
        }
        Ok(srdf)
    }

    fn group(&self, node: Node<'a, 'a>) -> Result<Group> {
        let mut group = Group {
            name: self.text(node, "name")?,
            ..Group::default()
        };
        for part in node.children().filter(Node::is_element) {
            match part.tag_name().name() {
                "link" => group.links.push(self.text(part, "name")?),
                "joint" => group.joints.push(self.text(part, "name")?),
                "group" => group.groups.push(self.text(part, "name")?),
                "chain" => group
                    .chains
                    .push((self.text(part, "base_link")?, self.text(part, "tip_link")?)),
                other => {
                    return Err(self
                        .xml
                        .refuse(part, format!("<{}> in a group", listed(&[other])))
                        .expected("link, joint, chain or group"));
                }
            }
        }
        Ok(group)
    }
}

fn ordered((a, b): (String, String)) -> (String, String) {
    if a <= b { (a, b) } else { (b, a) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn robot() -> Robot {
        let joint = |name: &str, kind: &str, parent: &str, child: &str| {
            format!(
                r#"<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/></joint>"#
            )
        };
        Robot::from_urdf(&format!(
            r#"<robot name="r"><link name="base"/><link name="a"/><link name="b"/><link name="tool"/><link name="head"/>
            {}{}{}{}</robot>"#,
            joint("j1", "continuous", "base", "a"),
            joint("j2", "continuous", "a", "b"),
            joint("mount", "fixed", "b", "tool"),
            joint("neck", "continuous", "base", "head"),
        ))
        .unwrap()
    }

    #[test]
    fn pairs_are_read_once_and_what_is_enabled_again_stays() {
        let srdf = Srdf::from_xml(
            "\u{feff}<?xml version='1.0'?><robot name='r'><!-- pairs -->
            <disable_collisions link1='base' link2='a' reason='Adjacent'/>
            <disable_collisions link1='a' link2='base'/>
            <disable_collisions link1='a' link2='a'/>
            <disable_collisions link1='a' link2='b'/>
            <enable_collisions link1='b' link2='a'/>
            <disable_collisions link1='base' link2='ghost'/>
            <disable_default_collisions link='a'/>
            <group_state name='home' group='arm'/></robot>",
        )
        .unwrap();
        let pair = |a: &str, b: &str, reason: Option<&str>| {
            (a.to_owned(), b.to_owned(), reason.map(str::to_owned))
        };
        assert_eq!(
            srdf.disabled(),
            [
                pair("base", "a", Some("Adjacent")),
                pair("base", "ghost", None)
            ]
        );
        assert_eq!(
            srdf.told(&robot()),
            [
                "the SRDF disables link `a` against itself",
                "elements of the SRDF that are not read: disable_default_collisions",
                "the SRDF names link `ghost`, which is not there",
            ]
        );
    }

    #[test]
    fn groups_are_resolved_through_chains_and_each_other() {
        let srdf = Srdf::from_xml(
            "<robot name='other'>
            <group name='arm'><chain base_link='base' tip_link='tool'/></group>
            <group name='neck'><joint name='neck'/><joint name='nod'/></group>
            <group name='hand'><link name='tool'/></group>
            <group name='all'><group name='neck'/><group name='arm'/><group name='all'/></group>
            <group name='back'><chain base_link='tool' tip_link='base'/></group>
            <group name='lost'><group name='none'/></group>
            <end_effector name='grip' group='hand' parent_link='b'/></robot>",
        )
        .unwrap();
        let robot = robot();
        assert_eq!(srdf.joints("arm", &robot).unwrap(), ["j1", "j2", "mount"]);
        assert_eq!(srdf.joints("hand", &robot).unwrap(), ["mount"]);
        assert_eq!(
            srdf.joints("all", &robot).unwrap(),
            ["j1", "j2", "mount", "neck"]
        );
        assert_eq!(srdf.end_effectors()[0].parent_link, "b");
        let error = |group| srdf.joints(group, &robot).unwrap_err().to_string();
        assert!(error("back").contains("no chain from link `tool` to `base`"));
        assert!(error("lost").contains("no group `none`"));
        assert_eq!(
            srdf.told(&robot),
            [
                "the SRDF is about robot `other`, not `r`",
                "the SRDF names group `none`, which is not there",
                "the SRDF names joint `nod`, which is not there",
            ]
        );
    }

    #[test]
    fn what_is_wrong_is_refused_by_line() {
        for (text, message) in [
            ("", "the file is empty"),
            ("<robot name='r'>", "line 1"),
            ("<model/>", "root element <model>"),
            ("<robot/>", "line 1: <robot> without `name`"),
            (
                "<robot name='r'>\n<disable_collisions link1='a'/></robot>",
                "line 2: <disable_collisions> without `link2`",
            ),
            (
                "<robot name='r'>\n<group name='g'><ring/></group></robot>",
                "line 2: <ring> in a group",
            ),
            (
                "<robot name='r'><group name='g'/><group name='g'/></robot>",
                "two groups are called `g`",
            ),
            (
                "<!DOCTYPE r [<!ENTITY a 'b'>]><robot name='r'/>",
                "a document type declaration",
            ),
        ] {
            let error = Srdf::from_xml(text).unwrap_err().to_string();
            assert!(error.contains(message), "`{message}`, got: {error}");
        }
    }
}

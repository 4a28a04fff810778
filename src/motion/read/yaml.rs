//! Moves from the motion files of play_motion2.
//!
//! YAML is read by the events of `saphyr-parser` (pure Rust, no dependency that was not here but a ring buffer): the
//! crates that deserialise YAML either are no longer kept or expand aliases. Aliases are refused here, so that no file
//! can stand for more than it holds; so are tags and further documents.

mod node;

use node::{Node, parse};

use super::{Error, ErrorKind, Reason, Result, Waypoints, listed, utf8};
use crate::fourier::Joints;
use crate::motion::waypoints::{Rows, Waypoint, wrong_size};

/// What a motion may hold; another key is refused, for it would mean something.
const KEYS: [&str; 4] = ["joints", "positions", "times_from_start", "meta"];

/// The motions of a play_motion2 file: `NODE: ros__parameters: motions: NAME: {joints, positions, times_from_start, meta}`,
/// positions \[rad, m\] a flat list, waypoint by waypoint. What else the file holds is not looked at.
///
/// play_motion2 sends positions alone, so these moves are linear; and it approaches the first waypoint by a plan of its own
/// or in a time that depends on where the robot is, so what is checked begins there
/// ([`StartPosture::AtFirstWaypoint`](crate::StartPosture)), or at a posture that is given, if the time in the file is kept.
#[derive(Debug, Clone, PartialEq)]
pub struct PlayMotion {
    name: String,
    motions: Vec<(String, Waypoints)>,
}

impl PlayMotion {
    /// Reads all motions of a file.
    ///
    /// # Errors
    /// When the text is not such a file, or one of its motions is not one: `name`, line and motion say where.
    pub fn read(name: &str, text: &[u8]) -> Result<Self> {
        let motions = utf8(text)
            .and_then(parse)
            .and_then(|root| motions(&root))
            .map_err(|e| e.at(name))?;
        Ok(Self {
            name: name.to_owned(),
            motions,
        })
    }

    /// Each motion with its name, in the order of the file.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (&str, &Waypoints)> {
        self.motions.iter().map(|(name, w)| (name.as_str(), w))
    }

    /// The motion called `motion`; the only one when no name is given.
    ///
    /// # Errors
    /// When there is no such motion, or no name and several motions; the message lists them.
    pub fn choose(mut self, motion: Option<&str>) -> Result<Waypoints> {
        let found = match motion {
            Some(wanted) => self.motions.iter().position(|(name, _)| name == wanted),
            None if self.motions.len() == 1 => Some(0),
            None => None,
        };
        match found {
            Some(i) => Ok(self.motions.swap_remove(i).1),
            None => {
                let names: Vec<&str> = self.iter().map(|(name, _)| name).collect();
                let what = match motion {
                    Some(wanted) => format!("no motion `{wanted}`"),
                    None => format!("{} motions", names.len()),
                };
                Err(Error::new(ErrorKind::Name, what)
                    .because(Reason::UnknownMotion)
                    .expected(format!("one of {}", listed(&names)))
                    .help("choose a motion by its name (--motion), or look at all (--all-motions)")
                    .at(self.name))
            }
        }
    }
}

fn motions(root: &Node<'_>) -> Result<Vec<(String, Waypoints)>> {
    let mut found = Vec::new();
    let mut open = vec![root];
    while let Some(node) = open.pop() {
        if let Some(parameters) = node.get("ros__parameters") {
            if let Some(motions) = parameters.get("motions") {
                let entries = motions
                    .map()
                    .ok_or_else(|| motions.error("motions that are no mapping"))?;
                for (name, node) in entries {
                    if found.iter().any(|(n, _)| n == name) {
                        return Err(node.error(format!("motion `{name}` twice")));
                    }
                    let waypoints = motion(node).map_err(|e| e.at(format!("motion `{name}`")))?;
                    found.push((name.clone().into_owned(), waypoints));
                }
            }
        } else if let Some(entries) = node.map() {
            // Namespaces of the node, in the order of the file.
            open.extend(entries.iter().rev().map(|(_, node)| node));
        }
    }
    if found.is_empty() {
        return Err(Error::new(ErrorKind::Shape, "no motion")
            .because(Reason::UnknownMotion)
            .expected(
                "NODE: ros__parameters: motions: NAME: joints, positions, times_from_start",
            ));
    }
    Ok(found)
}

fn motion(node: &Node<'_>) -> Result<Waypoints> {
    let entries = node
        .map()
        .ok_or_else(|| node.error("a motion that is no mapping"))?;
    if let Some((key, value)) = entries.iter().find(|(k, _)| !KEYS.contains(&k.as_ref())) {
        return Err(value
            .error(format!("key `{key}`"))
            .expected(format!("{}: the format of play_motion2", listed(&KEYS))));
    }
    let field = |key: &str| {
        node.get(key).ok_or_else(|| {
            node.error(format!("no `{key}`"))
                .expected(format!("{}: the format of play_motion2", listed(&KEYS)))
        })
    };
    let joints = field("joints")?;
    let joints = Joints::new(joints.names("joints")?).map_err(|e| {
        e.because(Reason::MissingJoint)
            .at(format!("line {}", joints.line))
    })?;
    let times = field("times_from_start")?.numbers("times_from_start")?;
    let positions = field("positions")?.numbers("positions")?;
    if positions.len() != times.len() * joints.len() {
        return Err(wrong_size(
            format!("{} positions", positions.len()),
            format!("{} times {} joints", times.len(), joints.len()),
        )
        .at(format!("line {}", node.line)));
    }
    let mut rows = Rows::new(joints.clone());
    for (i, (time, positions)) in times
        .iter()
        .zip(positions.chunks_exact(joints.len()))
        .enumerate()
    {
        rows.push(Waypoint {
            time: *time,
            positions,
            velocities: None,
            accelerations: None,
        })
        .map_err(|e| e.at(format!("waypoint {}", i + 1)))?;
    }
    rows.finish()
}

#[cfg(test)]
mod tests {
    use super::node::MOST_BYTES;
    use super::*;

    const TWO: &str = "# motions\n/play_motion2:\n  ros__parameters:\n    approach_velocity: 0.5\n    controllers: [arm]\n    motions:\n      home:\n        joints: [a]\n        positions: [1]\n        times_from_start: [0.5]\n      wave:\n        joints:\n          - a\n          - 'b'\n        positions: [0.0, 0.25,\n                    0.5, .5]\n        times_from_start:\n          - 0\n          - 1.0\n        meta: {name: Wave, usage: demo, description: \"x\"}\n";

    fn read(text: &str) -> Result<PlayMotion> {
        PlayMotion::read("m.yaml", text.as_bytes())
    }

    /// A file of one motion with these lines.
    fn one(lines: &str) -> String {
        format!("/**:\n  ros__parameters:\n    motions:\n      m:\n        {lines}\n")
    }

    #[test]
    fn motions_are_listed_and_chosen_by_name() {
        let file = read(TWO).unwrap();
        assert_eq!(
            file.iter().map(|(n, _)| n).collect::<Vec<_>>(),
            ["home", "wave"]
        );
        let wave = file.clone().choose(Some("wave")).unwrap();
        assert_eq!(wave.joints().listed(), "a, b");
        assert_eq!(wave.get(1).positions, [0.5, 0.5]);
        for motion in [None, Some("nod")] {
            let error = file.clone().choose(motion).unwrap_err();
            assert_eq!(error.reason(), Some(Reason::UnknownMotion));
            assert!(
                error.to_string().contains("expected one of home, wave"),
                "{error}"
            );
        }
        let flow = "ns: {n: {ros__parameters: {motions: {m: {joints: [a], positions: [1, 2], times_from_start: [0, 1]}}}}}";
        assert!(read(flow).unwrap().choose(None).is_ok());
    }

    #[test]
    fn each_bad_file_gets_its_place_and_reason() {
        let rest = "times_from_start: [0, 1]";
        for (text, expected, reason) in [
            (
                String::new(),
                "m.yaml: the file is empty",
                Reason::Unreadable,
            ),
            ("a: [1".into(), "m.yaml, line", Reason::Unreadable),
            (
                "a: 1".into(),
                "no motion, expected NODE: ros__parameters",
                Reason::UnknownMotion,
            ),
            (
                "n: {ros__parameters: {motions: 3}}".into(),
                "line 1: motions that are no",
                Reason::Unreadable,
            ),
            (
                "n: {ros__parameters: {motions: {m: 3}}}".into(),
                "motion `m`, line 1",
                Reason::Unreadable,
            ),
            (
                "a: 1\na: 2".into(),
                "line 2: key `a` twice",
                Reason::Unreadable,
            ),
            (
                "? [a]\n: 1".into(),
                "a key that is no name",
                Reason::Unreadable,
            ),
            (
                "a: &x [1]\nb: *x".into(),
                "line 2: an alias",
                Reason::Unsupported,
            ),
            ("a: !!float 1".into(), "line 1: a tag", Reason::Unsupported),
            (
                "a: 1\n---\nb: 2".into(),
                "a second document",
                Reason::Unsupported,
            ),
            (
                one("joints: [a]"),
                "line 5: no `times_from_start`",
                Reason::Unreadable,
            ),
            (
                one("joints: [a]\n        points: []"),
                "key `points`, expected joints, positions",
                Reason::Unreadable,
            ),
            (
                one(&format!(
                    "joints: a\n        positions: [1, 2]\n        {rest}"
                )),
                "line 5: joints that are no list",
                Reason::Unreadable,
            ),
            (
                one(&format!(
                    "joints: [a, a]\n        positions: [1, 2]\n        {rest}"
                )),
                "line 5: joint `a` is named twice",
                Reason::MissingJoint,
            ),
            (
                one(&format!(
                    "joints: [a]\n        positions: [1, .nan]\n        {rest}"
                )),
                "line 6: found `.nan` among positions",
                Reason::NotFinite,
            ),
            (
                one(&format!(
                    "joints: [a]\n        positions: [1, '2']\n        {rest}"
                )),
                "line 6: no number among positions",
                Reason::NotFinite,
            ),
            (
                one(&format!(
                    "joints: [a]\n        positions: [1, inf]\n        {rest}"
                )),
                "found `inf`",
                Reason::NotFinite,
            ),
            (
                one(&format!(
                    "joints: [a]\n        positions: [1, [2]]\n        {rest}"
                )),
                "line 6: no number",
                Reason::NotFinite,
            ),
            (
                one(&format!(
                    "joints: [a]\n        positions: [1, 2, 3]\n        {rest}"
                )),
                "line 5: 3 positions, expected 2 times 1 joints",
                Reason::WrongSize,
            ),
            (
                one("joints: [a]\n        positions: [1, 2]\n        times_from_start: [1, 0.5]"),
                "motion `m`, waypoint 2: time 0.5 s",
                Reason::TimesNotIncreasing,
            ),
            (
                one("joints: [a]\n        positions: []\n        times_from_start: []"),
                "no waypoint",
                Reason::NoDuration,
            ),
        ] {
            let error = read(&text).unwrap_err();
            assert!(error.to_string().contains(expected), "{text:?}: {error}");
            assert_eq!(error.reason(), Some(reason), "{error}");
        }
    }

    #[test]
    fn a_file_made_to_overwhelm_is_refused() {
        let bomb = "a: &a [x, x]\nb: &b [*a, *a]\nc: &c [*b, *b]\n";
        let many: String = (0..20_000).map(|i| format!("k{i}: 1\n")).collect();
        for text in [
            bomb.to_owned(),
            "[".repeat(1_000_000),
            "{a: ".repeat(100_000),
            "- ".repeat(100_000),
            "? ".repeat(100_000),
            "&a ".repeat(100_000),
            many,
            "[".to_owned() + &"0,".repeat(MOST_BYTES / 2),
            "[".to_owned() + &"0,".repeat(MOST_BYTES / 2 - 2) + "0]",
            "\u{0}".repeat(100_000),
            "a: \"".to_owned() + &"\\".repeat(100_001),
        ] {
            let error = read(&text).unwrap_err();
            assert!(error.reason().is_some(), "{error}");
        }
    }
}

//! A joint map to start from.

use std::fmt::Write as _;

use super::JointMap;
use crate::fourier::Joints;
use crate::robot::{JointKind, Robot};

impl JointMap {
    /// A commented map to be edited, for waves of `learned` joints on `robot`: equal names are filled in, and those
    /// that share a word are suggested; every other joint holds its rest position.
    pub fn template(learned: &Joints, robot: &Robot) -> String {
        let mut text = format!(
            "# Joint map: what moves each joint of robot `{}`.\n\
             # Learned joints: {}.\n\
             # A robot joint follows a learned one,\n\
             #     position = sign * scale * learned + offset,\n\
             # or holds a constant. Angles: \"15deg\", \"0.26rad\"; a bare number is radians.\n\
             # Learned joints that nothing follows are left out. Look at the result: undulate map --show\n",
            robot.name(),
            learned.listed()
        );
        for (i, joint) in robot.joints().iter().enumerate() {
            let properties = robot.properties(i);
            let (unit, scale, digits) = match robot.joint(i).kind {
                JointKind::Revolute => ("deg", 1f64.to_degrees(), 1),
                JointKind::Prismatic => ("m", 1.0, 4),
            };
            let range = properties.position.map_or("no limits".to_owned(), |p| {
                format!(
                    "{:.digits$} to {:.digits$} {unit}",
                    scale * p.lower,
                    scale * p.upper
                )
            });
            let _ = write!(text, "\n[joints.{}]  # {range}\n", key(joint));
            match likely(joint, learned) {
                Some(from) => {
                    let guess = if from == joint {
                        ""
                    } else {
                        "  # a guess from the name"
                    };
                    let _ = write!(
                        text,
                        "from = {}{guess}\nsign = 1  # or -1\nscale = 1.0\noffset = \"0deg\"\n",
                        key_value(from)
                    );
                }
                None => {
                    let rest = robot.rest()[i];
                    let _ = writeln!(
                        text,
                        "constant = {rest:?}  # {}; or: from = \"..\", sign, scale, offset",
                        if unit == "m" { "m" } else { "rad" }
                    );
                }
            }
        }
        text
    }
}

/// The learned joint of the same name, else the only one whose words appear in the robot joint's name.
fn likely<'a>(joint: &str, learned: &'a Joints) -> Option<&'a str> {
    if let Some(same) = learned.iter().find(|l| *l == joint) {
        return Some(same);
    }
    let words = |name: &str| -> Vec<String> {
        name.to_lowercase()
            .split(|c: char| !c.is_alphanumeric())
            .map(str::to_owned)
            .collect()
    };
    let wanted = words(joint);
    let shared = |l: &String| words(l).iter().filter(|w| wanted.contains(w)).count();
    let best = learned.iter().map(shared).max().filter(|n| *n > 0)?;
    let mut candidates = learned.iter().filter(|l| shared(l) == best);
    match (candidates.next(), candidates.next()) {
        (Some(one), None) => Some(one),
        _ => None,
    }
}

/// A TOML key, quoted where it must be.
fn key(name: &str) -> String {
    let bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !name.is_empty() && name.chars().all(bare) {
        name.to_owned()
    } else {
        key_value(name)
    }
}

fn key_value(name: &str) -> String {
    toml::Value::String(name.to_owned()).to_string()
}

#[cfg(test)]
mod tests {
    use super::super::tests::{robot, wave};
    use super::*;

    #[test]
    fn the_template_is_a_map_that_works() {
        let learned = wave();
        let text = JointMap::template(learned.joints(), &robot());
        let map = JointMap::from_toml(&text).unwrap();
        let mapped = map.apply(&learned, &robot()).unwrap();
        assert_eq!(mapped.offsets().as_slice(), [0.5, 0.1], "{text}");
    }
}

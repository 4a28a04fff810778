//! Limits that look wrong: allowed, and hardly meant.

use std::f64::consts::{PI, TAU};

use super::{BodyJoint, JointKind, Robot};
use crate::fourier::Interval;

/// A joint that turns farther than this \[rad\] in its limits is continuous, or its limits are degrees.
/// Two turns, and the rounding of printed digits.
const WIDEST: f64 = 2.0 * TAU + 1e-3;

/// A slide that is longer \[m\] was meant in millimetres.
const LONGEST: f64 = 10.0;

/// Speeds outside this range \[rad/s\] are degrees per second, turns per minute or a slip.
const SPEEDS: [f64; 2] = [0.01, 50.0];

/// The same for slides \[m/s\].
const SLIDES: [f64; 2] = [0.001, 10.0];

/// Torques or forces outside this range \[N m, N\] are none that a joint of a robot has.
const EFFORTS: [f64; 2] = [1e-3, 1e5];

impl Robot {
    /// Limits that look wrong, one sentence each; the robot takes them as they stand.
    pub fn doubts(&self) -> Vec<String> {
        let mut doubts = Vec::new();
        for (_, joint) in self.moving() {
            let mut doubt = |what: String| doubts.push(format!("joint `{}`: {what}", joint.name));
            if let Some(range) = &joint.properties.position {
                position(joint.kind, range, &mut doubt);
            }
            rates(joint, &mut doubt);
        }
        doubts
    }
}

fn position(kind: JointKind, range: &Interval, doubt: &mut impl FnMut(String)) {
    let (lower, upper) = (range.lower, range.upper);
    let width = upper - lower;
    let largest = lower.abs().max(upper.abs());
    if lower == upper {
        doubt(format!("both position limits are {lower}: it cannot move"));
    } else if lower > 0.0 || upper < 0.0 {
        doubt(format!("position 0 lies outside {lower} .. {upper}"));
    }
    match kind {
        // Whole degrees, and far beyond a turn: 90, 170, 360.
        JointKind::Revolute if largest > TAU && is_whole(lower) && is_whole(upper) => doubt(
            format!("{lower} .. {upper} rad are whole numbers beyond a turn: degrees?"),
        ),
        JointKind::Revolute if width > WIDEST => doubt(format!(
            "{lower} .. {upper} rad is a range of {:.1} turns",
            width / TAU
        )),
        JointKind::Revolute if width > 0.0 && largest < PI / 180.0 => {
            doubt(format!("{lower} .. {upper} rad is less than a degree"));
        }
        JointKind::Prismatic if largest > LONGEST => {
            doubt(format!(
                "{lower} .. {upper} m is a long slide: millimetres?"
            ));
        }
        _ => {}
    }
}

fn is_whole(number: f64) -> bool {
    number == number.round()
}

fn rates(joint: &BodyJoint, doubt: &mut impl FnMut(String)) {
    let (speeds, rate, force) = match joint.kind {
        JointKind::Revolute => (SPEEDS, "rad/s", "N m"),
        JointKind::Prismatic => (SLIDES, "m/s", "N"),
    };
    let outside = |value: f64, [low, high]: [f64; 2]| value < low || value > high;
    match joint.properties.velocity {
        None if joint.is_commanded => doubt("no velocity limit: any speed passes".to_owned()),
        Some(v) if outside(v, speeds) => doubt(format!("a velocity limit of {v} {rate}")),
        _ => {}
    }
    match joint.properties.effort {
        None if joint.is_commanded => doubt("no effort limit: any load passes".to_owned()),
        Some(e) if outside(e, EFFORTS) => doubt(format!("an effort limit of {e} {force}")),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn doubts(kind: &str, limit: &str) -> Vec<String> {
        Robot::from_urdf(&format!(
            r#"<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="{kind}"><parent link="a"/>
            <child link="b"/><limit {limit}/></joint></robot>"#
        ))
        .unwrap()
        .doubts()
    }

    #[test]
    fn limits_that_are_hardly_meant_are_told_and_sound_ones_are_not() {
        let rest = r#"velocity="2" effort="5""#;
        for (kind, limit, told) in [
            ("revolute", format!(r#"lower="-1" upper="1" {rest}"#), None),
            (
                "revolute",
                format!(r#"lower="-6.28318530718" upper="6.28318530718" {rest}"#),
                None,
            ),
            (
                "prismatic",
                format!(r#"lower="0" upper="0.04" {rest}"#),
                None,
            ),
            ("continuous", rest.to_owned(), None),
            (
                "revolute",
                format!(r#"lower="-90" upper="90" {rest}"#),
                Some("degrees?"),
            ),
            (
                "revolute",
                format!(r#"lower="-10.5" upper="10.5" {rest}"#),
                Some("3.3 turns"),
            ),
            (
                "revolute",
                format!(r#"lower="-0.001" upper="0.01" {rest}"#),
                Some("less than a degree"),
            ),
            (
                "revolute",
                format!(r#"lower="1" upper="1" {rest}"#),
                Some("cannot move"),
            ),
            (
                "revolute",
                format!(r#"lower="0.1" upper="1" {rest}"#),
                Some("position 0 lies outside"),
            ),
            (
                "prismatic",
                format!(r#"lower="0" upper="400" {rest}"#),
                Some("millimetres?"),
            ),
            (
                "continuous",
                r#"velocity="180" effort="5""#.into(),
                Some("a velocity limit of 180 rad/s"),
            ),
            (
                "continuous",
                r#"velocity="0.001" effort="5""#.into(),
                Some("a velocity limit of 0.001 rad/s"),
            ),
            (
                "continuous",
                r#"velocity="0" effort="5""#.into(),
                Some("no velocity limit"),
            ),
            (
                "continuous",
                r#"velocity="1""#.into(),
                Some("no effort limit"),
            ),
            (
                "continuous",
                r#"velocity="1" effort="1e16""#.into(),
                Some("an effort limit of 1"),
            ),
        ] {
            let found = doubts(kind, &limit);
            match told {
                None => assert!(found.is_empty(), "{limit}: {found:?}"),
                Some(told) => assert!(
                    found
                        .iter()
                        .any(|d| d.starts_with("joint `j`: ") && d.contains(told)),
                    "{limit} lacks {told}: {found:?}"
                ),
            }
        }
    }
}

//! [`Reason`]: why a motion does not pass, as codes that other people's scripts may rely on.

use super::{Error, ErrorKind};

/// Why a motion does not pass. The codes are stable: one may be added, none changes its name or meaning.
///
/// What cannot be checked does not pass, so what is wrong with the input is a reason like any other.
///
/// | code | meaning |
/// |---|---|
/// | `position-limit` | a joint leaves its range of positions, between waypoints included |
/// | `velocity-limit` | a joint moves faster than it may |
/// | `acceleration-limit` | a joint accelerates more than it may |
/// | `effort-limit` | a joint needs more torque or force than it has, by inverse dynamics at samples |
/// | `velocity-jump` | a joint changes its velocity at once although its acceleration is limited: linear interpolation, or a start or end in motion |
/// | `limit-missing` | a limit that must be known is given neither by the robot nor by the caller |
/// | `self-collision` | two links of the robot meet |
/// | `scene-collision` | a link meets an obstacle of the scene |
/// | `clearance` | nothing meets, but two bodies come nearer than the margin asked for |
/// | `undecided` | neither a collision nor its absence could be proven at the accuracy asked for |
/// | `no-collision-geometry` | no two things have collision geometry, or that of a link could not be read |
/// | `unknown-joint` | the motion names a joint that the robot does not have |
/// | `missing-joint` | the motion names none of the joints it needs, or not all of them |
/// | `start-unknown` | the first waypoint comes after time 0, and it is not said where the robot starts |
/// | `start-elsewhere` | the first waypoint, at time 0, is not where the robot is said to start |
/// | `not-closed` | the motion is to repeat and does not end where it begins |
/// | `no-duration` | the motion has no waypoint or one at time 0 only: there is nothing to check |
/// | `times-not-increasing` | a waypoint's time repeats, goes back, or is less than a nanosecond later |
/// | `out-of-range` | a number is too large to be what it stands for, or has the wrong sign |
/// | `not-finite` | a number is missing, no number, or not finite |
/// | `wrong-size` | counts do not fit together: joints, positions, velocities, times |
/// | `too-large` | more waypoints than are checked at once |
/// | `unknown-motion` | the file holds several motions and none was chosen, or not the one that was |
/// | `unreadable` | a file cannot be opened, or does not follow the grammar of its format |
/// | `unsupported` | the input uses a feature that is not supported |
/// | `invalid` | something else is wrong with the input or a setting |
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Reason {
    /// `position-limit`
    PositionLimit,
    /// `velocity-limit`
    VelocityLimit,
    /// `acceleration-limit`
    AccelerationLimit,
    /// `effort-limit`
    EffortLimit,
    /// `velocity-jump`
    VelocityJump,
    /// `limit-missing`
    LimitMissing,
    /// `self-collision`
    SelfCollision,
    /// `scene-collision`
    SceneCollision,
    /// `clearance`
    Clearance,
    /// `undecided`
    Undecided,
    /// `no-collision-geometry`
    NoCollisionGeometry,
    /// `unknown-joint`
    UnknownJoint,
    /// `missing-joint`
    MissingJoint,
    /// `start-unknown`
    StartUnknown,
    /// `start-elsewhere`
    StartElsewhere,
    /// `not-closed`
    NotClosed,
    /// `no-duration`
    NoDuration,
    /// `times-not-increasing`
    TimesNotIncreasing,
    /// `out-of-range`
    OutOfRange,
    /// `not-finite`
    NotFinite,
    /// `wrong-size`
    WrongSize,
    /// `too-large`
    TooLarge,
    /// `unknown-motion`
    UnknownMotion,
    /// `unreadable`
    Unreadable,
    /// `unsupported`
    Unsupported,
    /// `invalid`
    Invalid,
}

impl Reason {
    /// Every reason, in the order of the table.
    pub const ALL: [Self; 26] = [
        Self::PositionLimit,
        Self::VelocityLimit,
        Self::AccelerationLimit,
        Self::EffortLimit,
        Self::VelocityJump,
        Self::LimitMissing,
        Self::SelfCollision,
        Self::SceneCollision,
        Self::Clearance,
        Self::Undecided,
        Self::NoCollisionGeometry,
        Self::UnknownJoint,
        Self::MissingJoint,
        Self::StartUnknown,
        Self::StartElsewhere,
        Self::NotClosed,
        Self::NoDuration,
        Self::TimesNotIncreasing,
        Self::OutOfRange,
        Self::NotFinite,
        Self::WrongSize,
        Self::TooLarge,
        Self::UnknownMotion,
        Self::Unreadable,
        Self::Unsupported,
        Self::Invalid,
    ];

    /// The stable code.
    pub fn code(self) -> &'static str {
        self.row().0
    }

    /// What it means, in one line.
    pub fn meaning(self) -> &'static str {
        self.row().1
    }

    /// The table: the one place where codes and meanings are written.
    fn row(self) -> (&'static str, &'static str) {
        match self {
            Self::PositionLimit => (
                "position-limit",
                "a joint leaves its range of positions, between waypoints included",
            ),
            Self::VelocityLimit => ("velocity-limit", "a joint moves faster than it may"),
            Self::AccelerationLimit => {
                ("acceleration-limit", "a joint accelerates more than it may")
            }
            Self::EffortLimit => (
                "effort-limit",
                "a joint needs more torque or force than it has, by inverse dynamics at samples",
            ),
            Self::VelocityJump => (
                "velocity-jump",
                "a joint changes its velocity at once although its acceleration is limited: linear interpolation, or a start or end in motion",
            ),
            Self::LimitMissing => (
                "limit-missing",
                "a limit that must be known is given neither by the robot nor by the caller",
            ),
            Self::SelfCollision => ("self-collision", "two links of the robot meet"),
            Self::SceneCollision => ("scene-collision", "a link meets an obstacle of the scene"),
            Self::Clearance => (
                "clearance",
                "nothing meets, but two bodies come nearer than the margin asked for",
            ),
            Self::Undecided => (
                "undecided",
                "neither a collision nor its absence could be proven at the accuracy asked for",
            ),
            Self::NoCollisionGeometry => (
                "no-collision-geometry",
                "no two things have collision geometry, or that of a link could not be read",
            ),
            Self::UnknownJoint => (
                "unknown-joint",
                "the motion names a joint that the robot does not have",
            ),
            Self::MissingJoint => (
                "missing-joint",
                "the motion names none of the joints it needs, or not all of them",
            ),
            Self::StartUnknown => (
                "start-unknown",
                "the first waypoint comes after time 0, and it is not said where the robot starts",
            ),
            Self::StartElsewhere => (
                "start-elsewhere",
                "the first waypoint, at time 0, is not where the robot is said to start",
            ),
            Self::NotClosed => (
                "not-closed",
                "the motion is to repeat and does not end where it begins",
            ),
            Self::NoDuration => (
                "no-duration",
                "the motion has no waypoint or one at time 0 only: there is nothing to check",
            ),
            Self::TimesNotIncreasing => (
                "times-not-increasing",
                "a waypoint's time repeats, goes back, or is less than a nanosecond later",
            ),
            Self::OutOfRange => (
                "out-of-range",
                "a number is too large to be what it stands for, or has the wrong sign",
            ),
            Self::NotFinite => (
                "not-finite",
                "a number is missing, no number, or not finite",
            ),
            Self::WrongSize => (
                "wrong-size",
                "counts do not fit together: joints, positions, velocities, times",
            ),
            Self::TooLarge => ("too-large", "more waypoints than are checked at once"),
            Self::UnknownMotion => (
                "unknown-motion",
                "the file holds several motions and none was chosen, or not the one that was",
            ),
            Self::Unreadable => (
                "unreadable",
                "a file cannot be opened, or does not follow the grammar of its format",
            ),
            Self::Unsupported => (
                "unsupported",
                "the input uses a feature that is not supported",
            ),
            Self::Invalid => (
                "invalid",
                "something else is wrong with the input or a setting",
            ),
        }
    }

    /// The reason of an error: its own, or the one that its kind stands for.
    pub fn of(error: &Error) -> Self {
        error.reason().unwrap_or(match error.kind() {
            ErrorKind::Io | ErrorKind::Syntax => Self::Unreadable,
            ErrorKind::Shape => Self::WrongSize,
            ErrorKind::Unsupported => Self::Unsupported,
            _ => Self::Invalid,
        })
    }
}

impl std::fmt::Display for Reason {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.code())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_reason_is_listed_once_with_a_code_of_its_own() {
        for (i, reason) in Reason::ALL.iter().enumerate() {
            // The order of declaration is that of the table, so a reason left out or listed twice shows here.
            assert_eq!(*reason as usize, i);
            let code = reason.code();
            assert!(code.bytes().all(|b| b.is_ascii_lowercase() || b == b'-'));
            assert!(Reason::ALL[..i].iter().all(|r| r.code() != code), "{code}");
            assert!(!reason.meaning().contains('\n'));
        }
        assert_eq!(Reason::ALL[25], Reason::Invalid);
    }

    #[test]
    fn the_documentation_holds_the_table() {
        let source = include_str!("reason.rs");
        for reason in Reason::ALL {
            let row = format!("/// | `{}` | {} |\n", reason.code(), reason.meaning());
            assert!(source.contains(&row), "{row}");
        }
    }

    #[test]
    fn an_error_that_names_no_reason_has_one_by_its_kind() {
        let error = Error::new(ErrorKind::Syntax, "x");
        assert_eq!(Reason::of(&error), Reason::Unreadable);
        let error = error.because(Reason::NotFinite).because(Reason::TooLarge);
        assert_eq!(Reason::of(&error), Reason::NotFinite);
    }
}

//! [`Finding`]: what may spoil a recording as a demonstration, as codes that scripts may rely on.

/// What may spoil a recording. The codes are stable: one may be added, none changes its name or meaning.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Flag {
    /// `no-rhythm`
    NoRhythm,
    /// `few-cycles`
    FewCycles,
    /// `several-parts`
    SeveralParts,
    /// `gap`
    Gap,
    /// `frozen-frames`
    FrozenFrames,
    /// `turn-jump`
    TurnJump,
    /// `fast-jump`
    FastJump,
    /// `gimbal`
    Gimbal,
    /// `still-joint`
    StillJoint,
    /// `odd-frequency`
    OddFrequency,
    /// `odd-size`
    OddSize,
    /// `odd-posture`
    OddPosture,
}

impl Flag {
    /// Every flag, in the order of the table.
    pub const ALL: [Self; 12] = [
        Self::NoRhythm,
        Self::FewCycles,
        Self::SeveralParts,
        Self::Gap,
        Self::FrozenFrames,
        Self::TurnJump,
        Self::FastJump,
        Self::Gimbal,
        Self::StillJoint,
        Self::OddFrequency,
        Self::OddSize,
        Self::OddPosture,
    ];

    /// The stable code.
    pub fn code(self) -> &'static str {
        self.row().0
    }

    /// What it means, in one line.
    pub fn meaning(self) -> &'static str {
        self.row().1
    }

    /// Whether the recording, or this part of it, is better left out or mended; the others are told.
    pub fn spoils(self) -> bool {
        self != Self::SeveralParts
    }

    fn row(self) -> (&'static str, &'static str) {
        match self {
            Self::NoRhythm => ("no-rhythm", "no two and a half cycles in a row are alike"),
            Self::FewCycles => (
                "few-cycles",
                "it goes to and fro, but not often enough to be learned",
            ),
            Self::SeveralParts => ("several-parts", "it holds more than one rhythmic part"),
            Self::Gap => ("gap", "samples are missing; the value is for how long [s]"),
            Self::FrozenFrames => (
                "frozen-frames",
                "all joints repeat themselves exactly; the value is for how long [s]",
            ),
            Self::TurnJump => (
                "turn-jump",
                "a joint jumps by whole turns, which learning takes out; the value is how often",
            ),
            Self::FastJump => (
                "fast-jump",
                "a joint is faster than any arm; the value is how fast [rad/s]",
            ),
            Self::Gimbal => (
                "gimbal",
                "the shoulder is near where two of its angles turn about one axis; the value is the cosine of the second",
            ),
            Self::StillJoint => (
                "still-joint",
                "a joint stands still: leave it out; the value is how far it goes [rad]",
            ),
            Self::OddFrequency => (
                "odd-frequency",
                "its frequency is far from the median of the set; the value is the ratio",
            ),
            Self::OddSize => (
                "odd-size",
                "it swings far more or less than the median of the set; the value is the ratio",
            ),
            Self::OddPosture => (
                "odd-posture",
                "a joint's mean is far from the median of the set; the value is how far [rad]",
            ),
        }
    }
}

/// One thing that was found, when and in which joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// What.
    pub flag: Flag,
    /// When \[s\], in the recording's own time; `None` is all the time.
    pub time: Option<f64>,
    /// The joint, where it is one.
    pub joint: Option<String>,
    /// How much, in the unit that the flag's meaning names; 0 where there is nothing to say.
    pub value: f64,
}

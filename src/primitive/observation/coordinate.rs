//! [`Coordinate`]: one quantity of a wave, by name.

use std::fmt;

/// Which harmonic: its number k, or its frequency k/T, for which a quarter of the spacing is near enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Harmonic {
    /// k, from 1.
    Number(usize),
    /// \[Hz\]
    Hertz(f64),
}

impl From<usize> for Harmonic {
    fn from(k: usize) -> Self {
        Self::Number(k)
    }
}

impl fmt::Display for Harmonic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(k) => write!(f, "{k}"),
            Self::Hertz(hertz) => write!(f, "{hertz}Hz"),
        }
    }
}

/// One quantity of a wave, by name: a linear function a^T x of its vector in a chart (the logarithm of it, for moduli and ratios).
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)] // of the fields: the variants say it
pub enum Coordinate {
    /// |w_{d,k}| \[rad\]: half the amplitude of harmonic k of a joint.
    Modulus { joint: String, harmonic: Harmonic },
    /// Arg w_{d,k} \[rad\].
    Phase { joint: String, harmonic: Harmonic },
    /// Arg w_{d,k} - Arg w_{e,k} \[rad\], joint d against joint e: who leads.
    RelativePhase {
        joint: String,
        to: String,
        harmonic: Harmonic,
    },
    /// w_{d,0} \[rad\]: the posture of a joint.
    Offset { joint: String },
    /// |w_{d,k}| / |w_{e,l}|.
    Ratio {
        joint: String,
        harmonic: Harmonic,
        to: String,
        to_harmonic: Harmonic,
    },
    /// Half of peak to peak of a joint's cycle, mean over the cycles of a wave \[rad\]. Of cycles only, as all that follow.
    Swing { joint: String },
    /// Cycles a second, mean over a wave \[Hz\].
    Frequency,
    /// How lively a wave is: standard deviation of ln amplitude or ln tempo from cycle to cycle (0.05 is 5 %), in the long run; a wave of few
    /// cycles, each like the one before, shows less.
    Jitter(JitterOf),
    /// |w_{d,h}| over the joint's swing, but for the factor, common to a joint's harmonics, that scales a drawn shape to its swing: two of them
    /// against each other (a ratio) are exact, one alone is as near as the shapes of the demonstrations agree.
    Shape { joint: String, harmonic: Harmonic },
    /// Arg w_{d,h} - h Arg w_{ref,1} \[rad\]: a phase that does not depend on the start.
    LockedPhase { joint: String, harmonic: Harmonic },
}

/// What varies from cycle to cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum JitterOf {
    Amplitude,
    Tempo,
}

/// In what a coordinate is told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// rad; as text degrees or radians.
    Angle,
    /// Hz
    Hertz,
    /// A plain number.
    Number,
    /// A plain number; as text per cent.
    Share,
}

impl Unit {
    /// For people: the factor from the number, and what to write behind it.
    pub(crate) fn told(self) -> (f64, &'static str) {
        match self {
            Self::Angle => (1f64.to_degrees(), "deg"),
            Self::Hertz => (1.0, "Hz"),
            Self::Number => (1.0, ""),
            Self::Share => (100.0, "%"),
        }
    }
}

impl Coordinate {
    /// |w_{d,k}|.
    pub fn modulus(joint: impl Into<String>, harmonic: impl Into<Harmonic>) -> Self {
        let (joint, harmonic) = (joint.into(), harmonic.into());
        Self::Modulus { joint, harmonic }
    }

    /// Arg w_{d,k}.
    pub fn phase(joint: impl Into<String>, harmonic: impl Into<Harmonic>) -> Self {
        let (joint, harmonic) = (joint.into(), harmonic.into());
        Self::Phase { joint, harmonic }
    }

    /// Arg w_{d,k} - Arg w_{e,k}.
    pub fn relative_phase(
        joint: impl Into<String>,
        to: impl Into<String>,
        harmonic: impl Into<Harmonic>,
    ) -> Self {
        Self::RelativePhase {
            joint: joint.into(),
            to: to.into(),
            harmonic: harmonic.into(),
        }
    }

    /// |w_{d,k}| / |w_{e,k}|.
    pub fn ratio(
        joint: impl Into<String>,
        to: impl Into<String>,
        harmonic: impl Into<Harmonic>,
    ) -> Self {
        let harmonic = harmonic.into();
        Self::Ratio {
            joint: joint.into(),
            harmonic,
            to: to.into(),
            to_harmonic: harmonic,
        }
    }

    /// The (first) harmonic, where there is one.
    pub fn harmonic(&self) -> Option<Harmonic> {
        match self {
            Self::Modulus { harmonic, .. }
            | Self::Phase { harmonic, .. }
            | Self::RelativePhase { harmonic, .. }
            | Self::Ratio { harmonic, .. }
            | Self::Shape { harmonic, .. }
            | Self::LockedPhase { harmonic, .. } => Some(*harmonic),
            Self::Offset { .. } | Self::Swing { .. } | Self::Frequency | Self::Jitter(_) => None,
        }
    }

    /// In what it is told.
    pub fn unit(&self) -> Unit {
        match self {
            Self::Ratio { .. } | Self::Shape { .. } => Unit::Number,
            Self::Frequency => Unit::Hertz,
            Self::Jitter(_) => Unit::Share,
            _ => Unit::Angle,
        }
    }

    /// Whether it is its logarithm that is linear in x (but for offsets, whose form the chart knows).
    pub(in crate::primitive) fn is_logarithmic(&self) -> bool {
        !matches!(
            self,
            Self::Phase { .. }
                | Self::RelativePhase { .. }
                | Self::LockedPhase { .. }
                | Self::Offset { .. }
        )
    }
}

impl fmt::Display for Coordinate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Modulus { joint, harmonic } => write!(f, "modulus:{joint}:{harmonic}"),
            Self::Phase { joint, harmonic } => write!(f, "phase:{joint}:{harmonic}"),
            Self::RelativePhase {
                joint,
                to,
                harmonic,
            } => write!(f, "phase:{joint}/{to}:{harmonic}"),
            Self::Offset { joint } => write!(f, "offset:{joint}"),
            Self::Ratio {
                joint,
                harmonic,
                to,
                to_harmonic,
            } => write!(f, "ratio:{joint}:{harmonic}/{to}:{to_harmonic}"),
            Self::Swing { joint } => write!(f, "swing:{joint}"),
            Self::Frequency => f.write_str("frequency"),
            Self::Jitter(JitterOf::Amplitude) => f.write_str("jitter:amplitude"),
            Self::Jitter(JitterOf::Tempo) => f.write_str("jitter:tempo"),
            Self::Shape { joint, harmonic } => write!(f, "shape:{joint}:{harmonic}"),
            Self::LockedPhase { joint, harmonic } => write!(f, "lock:{joint}:{harmonic}"),
        }
    }
}

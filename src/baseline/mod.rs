//! Other models of a gesture behind one interface with ours: what a comparison needs, and no more.

mod aligned;
mod gaussian;
mod linear_gaussian;
mod ours;
mod rhythmic_promp;
mod stroke_promp;

use nalgebra::DMatrix;
use rand::Rng;

pub use linear_gaussian::LinearGaussian;
pub use rhythmic_promp::RhythmicProMp;
pub use stroke_promp::StrokeProMp;

use crate::demonstration::Recording;
use crate::error::{Error, ErrorKind, Result};

/// A gesture learned from recordings, of which motions are drawn.
pub trait GestureModel: Send + Sync {
    /// Joint positions at `times` \[s\], of which the first is the motion's start: N x D \[rad\].
    fn draw(&self, times: &[f64], rng: &mut dyn Rng) -> DMatrix<f64>;

    /// The natural logarithm of the density of a demonstration's weights \[nats\], where the model has one. Each model has its own weights: numbers of
    /// two models do not compare.
    fn log_density(&self, _demonstration: &Recording) -> Option<f64> {
        None
    }

    /// The model given a wish; what it does not ask for follows as it did in the demonstrations.
    ///
    /// # Errors
    /// When the model has no such coordinate, or the wish contradicts what it knows.
    fn condition(&self, wish: &Wish) -> Result<Box<dyn GestureModel>>;
}

/// What may be asked of a model.
#[derive(Debug, Clone, PartialEq)]
pub enum Wish {
    /// Half of peak to peak of a joint within a cycle \[rad\].
    #[allow(missing_docs)]
    Swing { joint: String, swing: f64 },
    /// Cycles a second \[Hz\].
    Frequency(f64),
    /// A joint's position \[rad\] at a time \[s\].
    #[allow(missing_docs)]
    Position {
        joint: String,
        time: f64,
        position: f64,
    },
}

impl Wish {
    fn refused(&self, because: &str) -> Error {
        let wish = match self {
            Self::Swing { .. } => "a swing",
            Self::Frequency(_) => "a frequency",
            Self::Position { .. } => "a position at a time",
        };
        Error::new(
            ErrorKind::Infeasible,
            format!("{wish} cannot be asked for: {because}"),
        )
    }
}

/// The models that are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ModelKind {
    /// Ours, a cycle of each recording's own tempo with its jitter and what cycles leave.
    Cycle,
    /// Ours, one period common to all, as in the paper.
    CommonPeriod,
    /// [`StrokeProMp`].
    StrokeProMp,
    /// [`RhythmicProMp`].
    RhythmicProMp,
    /// [`LinearGaussian`].
    LinearGaussian,
}

/// How finely models see: the same number of weights a joint for all whose basis spans one length.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Resolution {
    /// K of a common period; a stroke has 2 K + 1 bases.
    pub harmonics: usize,
    /// H of a cycle; a rhythmic ProMP has 2 H + 1 bases.
    pub cycle_harmonics: usize,
    /// Whether cycles are drawn with what they leave.
    pub residual: bool,
}

impl Default for Resolution {
    fn default() -> Self {
        Self {
            harmonics: 25,
            cycle_harmonics: 4,
            residual: true,
        }
    }
}

impl ModelKind {
    /// One of each, ours first.
    pub const ALL: [Self; 5] = [
        Self::Cycle,
        Self::CommonPeriod,
        Self::StrokeProMp,
        Self::RhythmicProMp,
        Self::LinearGaussian,
    ];

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cycle => "cycle",
            Self::CommonPeriod => "common period",
            Self::StrokeProMp => "stroke ProMP",
            Self::RhythmicProMp => "rhythmic ProMP",
            Self::LinearGaussian => "linear Gaussian",
        }
    }

    /// In a word.
    pub fn short_name(self) -> &'static str {
        match self {
            Self::Cycle => "cycle",
            Self::CommonPeriod => "common",
            Self::StrokeProMp => "stroke",
            Self::RhythmicProMp => "rhythm",
            Self::LinearGaussian => "linear",
        }
    }

    /// Whether it is no baseline.
    pub fn is_ours(self) -> bool {
        matches!(self, Self::Cycle | Self::CommonPeriod)
    }

    /// Learns from recordings, uncut.
    ///
    /// # Errors
    /// When there are fewer than two that can be used.
    pub fn learn(
        self,
        recordings: &[Recording],
        resolution: Resolution,
    ) -> Result<Box<dyn GestureModel>> {
        let Resolution {
            harmonics,
            cycle_harmonics,
            residual,
        } = resolution;
        Ok(match self {
            Self::Cycle => Box::new(ours::cycle(recordings, cycle_harmonics, residual)?),
            Self::CommonPeriod => Box::new(ours::common_period(recordings, harmonics)?),
            Self::StrokeProMp => Box::new(StrokeProMp::learn(recordings, 2 * harmonics + 1)?),
            Self::RhythmicProMp => {
                Box::new(RhythmicProMp::learn(recordings, 2 * cycle_harmonics + 1)?)
            }
            Self::LinearGaussian => Box::new(LinearGaussian::learn(recordings, harmonics)?),
        })
    }
}

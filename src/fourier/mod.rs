//! Finite Fourier series: fitting them to samples, evaluating and bounding them.
//!
//! A motion of D joints with period T \[s\] and fundamental frequency w = 2 pi / T \[rad/s\] is
//!
//! ```text
//! y_d(t) = w_{d,0} + 2 Re sum_{k=1..K} w_{d,k} exp(i k w t)
//! ```
//!
//! Motions are real, so w_{d,-k} is the conjugate of w_{d,k} and only k >= 0 is stored;
//! |w_{d,k}| is HALF the amplitude of its sinusoid. Positions are radians (metres for prismatic joints), times seconds.

mod autoregression;
mod basis;
mod bounds;
mod file;
mod grid;
mod joints;
mod residual;
mod ring;
mod wave;

pub use autoregression::Autoregression;
pub use basis::FourierBasis;
pub(crate) use basis::WORST_CONDITION;
pub use bounds::{Extremes, Interval};
pub use grid::PeriodGrid;
pub use joints::Joints;
pub use residual::CycleResidual;
pub use ring::CycleRing;
pub(crate) use ring::{LARGEST_DEVIATION, MOST_CYCLE_HARMONICS};
pub use wave::{Derivative, State, Wave};

//! [`Example`]: one demonstration as a primitive learns it.

use super::chart::Jitter;
use crate::demonstration::CycleFit;
use crate::fourier::Wave;

/// A fitted demonstration: its wave, and where that is one cycle of it, how its cycles vary.
#[derive(Debug, Clone, PartialEq)]
pub struct Example {
    /// The fitted wave: of the common period, or of one cycle.
    pub wave: Wave,
    /// Of the cycles; none where the period is common to all.
    pub jitter: Option<Jitter>,
}

impl From<Wave> for Example {
    fn from(wave: Wave) -> Self {
        Self { wave, jitter: None }
    }
}

impl From<&Wave> for Example {
    fn from(wave: &Wave) -> Self {
        wave.clone().into()
    }
}

impl From<&CycleFit> for Example {
    fn from(fit: &CycleFit) -> Self {
        Self {
            wave: fit.wave.clone(),
            jitter: Some(Jitter {
                amplitude: fit.amplitude_jitter,
                tempo: fit.tempo_jitter,
            }),
        }
    }
}

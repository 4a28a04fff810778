//! What a chart of cycles has more: swings, frequency, and how lively the jitter is.

use nalgebra::DVector;

use crate::elementary::exp;
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::{
    Autoregression, CycleResidual, CycleRing, Derivative, LARGEST_DEVIATION, MOST_CYCLE_HARMONICS,
    PeriodGrid, Wave,
};

/// Points at which a cycle is looked at for its largest and smallest position, for each harmonic: between them the highest harmonic, which is the
/// smallest, moves by less than 0.5 % of its amplitude.
const POINTS: usize = 32;

/// Levels of jitter below this are no different from none: a tenth of a per cent from cycle to cycle.
const LEAST_JITTER: f64 = 1e-3;

/// Entries after the swings: ln f and two levels of jitter.
pub(super) const AFTER_SWINGS: usize = 3;

/// How cycles follow each other in a drawn wave: C of them on a ring, ln amplitude and ln tempo as autoregressions of first order.
#[derive(Debug, Clone)]
pub struct Cycles {
    ring: CycleRing,
    amplitude: Autoregression,
    tempo: Autoregression,
    residual: Option<CycleResidual>,
    grid: PeriodGrid,
}

impl PartialEq for Cycles {
    fn eq(&self, other: &Self) -> bool {
        let numbers = |c: &Self| (c.count(), c.amplitude, c.tempo, c.grid.points());
        numbers(self) == numbers(other) && self.residual == other.residual
    }
}

/// Standard deviations of ln amplitude and of ln tempo from cycle to cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs)]
pub struct Jitter {
    pub amplitude: f64,
    pub tempo: f64,
}

impl Cycles {
    /// Rings of `count` cycles of so many harmonics, with the two autoregressions.
    ///
    /// # Errors
    /// When there is no cycle, or more than a thousand, or no harmonic, or more than fifty.
    pub fn new(
        count: usize,
        harmonics: usize,
        amplitude: Autoregression,
        tempo: Autoregression,
    ) -> Result<Self> {
        if !(1..=MOST_CYCLE_HARMONICS).contains(&harmonics) {
            return Err(Error::new(
                ErrorKind::Setting,
                format!("{harmonics} harmonics of a cycle"),
            )
            .expected(format!("from 1 to {MOST_CYCLE_HARMONICS}")));
        }
        Ok(Self {
            ring: CycleRing::new(count)?,
            amplitude,
            tempo,
            residual: None,
            grid: PeriodGrid::new(POINTS * harmonics, harmonics),
        })
    }

    /// The same with a residual in every drawn wave.
    #[must_use]
    pub fn with_residual(self, residual: CycleResidual) -> Self {
        Self {
            residual: Some(residual),
            ..self
        }
    }

    /// C.
    pub fn count(&self) -> usize {
        self.ring.cycles()
    }

    /// How ln amplitude follows that of the cycle before.
    pub fn amplitude(&self) -> Autoregression {
        self.amplitude
    }

    /// How ln tempo follows that of the cycle before.
    pub fn tempo(&self) -> Autoregression {
        self.tempo
    }

    /// What drawn waves have besides their cycles, if they have it.
    pub fn residual(&self) -> Option<&CycleResidual> {
        self.residual.as_ref()
    }

    /// How many standard normal numbers make cycles of so many harmonics differ.
    pub(in crate::primitive) fn latent(&self, harmonics: usize) -> usize {
        let drawn = (harmonics + 1) * self.count() - 1;
        let residual = self.residual.as_ref().map_or(0, |r| r.latent(drawn));
        2 * self.count() + residual
    }

    /// Half of peak to peak of each joint of a steady cycle \[rad\] (D).
    pub(super) fn swings(&self, wave: &Wave) -> DVector<f64> {
        let positions = wave.on_grid(&self.grid, Derivative::Position);
        DVector::from_iterator(
            positions.ncols(),
            positions.column_iter().map(|y| {
                let (low, high) = y.iter().fold((y[0], y[0]), |(low, high): (f64, f64), y| {
                    (low.min(*y), high.max(*y))
                });
                (high - low) / 2.0
            }),
        )
    }

    /// The entries of x that follow the swings.
    pub(super) fn tail(wave: &Wave, jitter: Jitter) -> [f64; AFTER_SWINGS] {
        [
            -libm::log(wave.period()),
            libm::log(jitter.amplitude.max(LEAST_JITTER)),
            libm::log(jitter.tempo.max(LEAST_JITTER)),
        ]
    }

    /// The wave of C cycles about a steady one, with levels of jitter as they stand in x, from [`latent`](Self::latent) standard normal numbers.
    pub(in crate::primitive) fn enliven(
        &self,
        steady: &Wave,
        levels: [f64; 2],
        normals: &[f64],
    ) -> Result<Wave> {
        let (jitter, rest) = normals.split_at(2 * self.count());
        let (first, second) = jitter.split_at(self.count());
        let series = |process: Autoregression, normals: &[f64], level: f64| -> Vec<f64> {
            let level = exp(level);
            let scaled = |x: f64| (level * x).clamp(-LARGEST_DEVIATION, LARGEST_DEVIATION);
            process.on_ring(normals).into_iter().map(scaled).collect()
        };
        let wave = self.ring.wave(
            steady,
            &series(self.amplitude, first, levels[0]),
            &series(self.tempo, second, levels[1]),
        )?;
        match &self.residual {
            None => Ok(wave),
            Some(residual) => residual.onto(&wave, self.count(), steady.weights().norm(), rest),
        }
    }
}

//! Demonstrations: recordings of one kind of gesture, checked and cut to a common period.

mod course;
mod cycle;
mod demodulation;
mod finding;
mod gesture;
mod half_cycles;
mod hand;
mod inspection;
mod jitter;
mod leakage;
mod level;
mod mean_cycle;
mod pieces;
mod read;
mod recording;
mod residual;
mod rhythm;
mod rhythmic_part;
mod runs;
mod set;
mod slow_drift;
mod steady;
mod synthetic;
mod variation;
mod window;

use realfft::RealFftPlanner;

pub(crate) use course::Course;
pub use cycle::{CycleFit, CycleFits};
pub use finding::{Finding, Flag};
pub use inspection::{Inspection, Rhythm};
pub use leakage::Leakage;
pub use read::CsvOptions;
pub use recording::Recording;
pub use rhythmic_part::RhythmicPart;
pub use synthetic::{JOINTS as DEMONSTRATOR_JOINTS, PERIOD as DEMONSTRATOR_PERIOD, synthetic};
pub use variation::Variation;
pub use window::{Duration, LeftOut};

use crate::error::{Error, ErrorKind, Result};
use crate::fourier::{FourierBasis, Joints, Wave};

/// A joint whose positions differ by no more than this \[rad\] stands still: no encoder sees it.
const STILL: f64 = 1e-9;

/// Recordings of one gesture, cut to one period T, their times counted from 0.
///
/// Harmonic k means k/T Hz only if T is common to all, so recordings are cut, never stretched, and fitted on their
/// own time stamps, never resampled. Those shorter than T are left out, by name.
#[derive(Debug, Clone, PartialEq)]
pub struct Demonstrations {
    joints: Joints,
    period: f64,
    recordings: Vec<Recording>,
    left_out: Vec<LeftOut>,
}

impl Demonstrations {
    /// Cuts `recordings` to a common period.
    ///
    /// # Errors
    /// When there are no recordings, their joints differ, a joint never moves, or no two are long enough.
    pub fn new(recordings: Vec<Recording>, duration: Duration) -> Result<Self> {
        let joints = common_joints(&recordings)?;
        let (period, recordings, left_out) = window::cut(recordings, duration)?;
        for recording in &recordings {
            for (d, joint) in joints.iter().enumerate() {
                let column = recording.positions.column(d);
                if column.max() - column.min() <= STILL {
                    return Err(Error::new(ErrorKind::Value, "the joint never moves")
                        .expected("a motion: the logarithm of its amplitude is learned")
                        .help("leave the joint out with --joints, and give it a constant in the joint map")
                        .at(format!("joint `{joint}`"))
                        .at(recording.name.clone()));
                }
            }
        }
        Ok(Self {
            joints,
            period,
            recordings,
            left_out,
        })
    }

    /// The joints' names.
    pub fn joints(&self) -> &Joints {
        &self.joints
    }

    /// T \[s\].
    pub fn period(&self) -> f64 {
        self.period
    }

    /// The recordings that were kept, cut, with times from 0.
    pub fn recordings(&self) -> &[Recording] {
        &self.recordings
    }

    /// The recordings that were not kept, and why.
    pub fn left_out(&self) -> &[LeftOut] {
        &self.left_out
    }

    /// Fits every demonstration with harmonics 0..=K (Algorithm 1, line 5).
    ///
    /// # Errors
    /// Those of [`FourierBasis::fit`], with the recording's name.
    pub fn fit(&self, harmonics: usize) -> Result<Vec<Wave>> {
        let basis = FourierBasis::new(self.period, harmonics)?;
        let mut planner = RealFftPlanner::new();
        self.recordings
            .iter()
            .map(|r| {
                basis
                    .fit_with(&mut planner, &r.joints, &r.times, &r.positions)
                    .map_err(|e| e.at(r.name.clone()))
            })
            .collect()
    }

    /// What `waves`, fitted to these demonstrations, leave unexplained.
    pub fn leakage(&self, waves: &[Wave]) -> Vec<Leakage> {
        self.recordings
            .iter()
            .zip(waves)
            .map(|(recording, wave)| recording.leakage(wave))
            .collect()
    }

    /// The highest dominant frequency of a recording \[Hz\]: K/T should be at least twice that.
    pub fn highest_tempo(&self) -> f64 {
        self.recordings
            .iter()
            .map(Recording::tempo)
            .fold(0.0, f64::max)
    }
}

/// The joints that all recordings have.
pub(crate) fn common_joints(recordings: &[Recording]) -> Result<Joints> {
    let Some(first) = recordings.first() else {
        return Err(Error::new(ErrorKind::Shape, "no recordings")
            .expected("at least two")
            .help("name CSV files, a folder of them, or a list file"));
    };
    for recording in recordings {
        same_joints(first, recording)?;
    }
    Ok(first.joints.clone())
}

pub(crate) fn same_joints(first: &Recording, recording: &Recording) -> Result<()> {
    if recording.joints == first.joints {
        return Ok(());
    }
    let found = format!("joints {}", recording.joints.listed());
    Err(Error::new(ErrorKind::Name, found)
        .expected(format!("{} as in {}", first.joints.listed(), first.name))
        .help("pick the columns that all have with --joints a,b,..")
        .at(recording.name.clone()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    fn recording(name: &str, frequency: f64, span: f64) -> Recording {
        let times: Vec<f64> = (0..)
            .map(|n| f64::from(n) / 60.0)
            .take_while(|t| *t <= span + 1e-9)
            .collect();
        let positions = DMatrix::from_fn(times.len(), 1, |n, _| {
            (std::f64::consts::TAU * frequency * times[n]).sin()
        });
        Recording::new(name, Joints::new(["a"]).unwrap(), times, positions).unwrap()
    }

    #[test]
    fn a_still_joint_and_differing_joints_are_named() {
        let still = Recording::new(
            "still.csv",
            Joints::new(["a"]).unwrap(),
            vec![0.0, 0.5, 1.0],
            DMatrix::from_element(3, 1, 0.25),
        )
        .unwrap();
        let error =
            Demonstrations::new(vec![still.clone(), still], Duration::Seconds(1.0)).unwrap_err();
        assert!(
            error
                .to_string()
                .starts_with("still.csv, joint `a`: the joint never moves")
        );
        let other = Recording::new(
            "other.csv",
            Joints::new(["b"]).unwrap(),
            vec![0.0, 1.0],
            DMatrix::zeros(2, 1),
        )
        .unwrap();
        let error =
            Demonstrations::new(vec![recording("r", 1.0, 4.0), other], Duration::Auto).unwrap_err();
        assert!(
            error.to_string().starts_with("other.csv: joints b"),
            "{error}"
        );
    }

    #[test]
    fn whole_cycles_leak_nothing_and_half_cycles_jump() {
        let whole = Demonstrations::new(
            vec![recording("x", 2.0, 4.0), recording("y", 2.0, 4.0)],
            Duration::Seconds(4.0),
        )
        .unwrap();
        let leakage = &whole.leakage(&whole.fit(12).unwrap())[0];
        assert!(leakage.residual_energy < 1e-20 && leakage.end_jump < 1e-9);
        let cut = Demonstrations::new(
            vec![recording("x", 2.0, 4.0), recording("y", 2.0, 4.0)],
            Duration::Seconds(3.125),
        )
        .unwrap();
        let leakage = &cut.leakage(&cut.fit(12).unwrap())[0];
        assert!(
            leakage.end_jump > 0.9 && leakage.residual_energy > 1e-3,
            "{leakage:?}"
        );
    }
}

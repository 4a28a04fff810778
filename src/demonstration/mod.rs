//! Demonstrations: recordings of one kind of gesture, checked and cut to a common period.

mod read;
mod rhythm;
mod synthetic;
mod window;

use nalgebra::DMatrix;
use realfft::RealFftPlanner;

pub use read::CsvOptions;
pub use synthetic::{JOINTS as DEMONSTRATOR_JOINTS, PERIOD as DEMONSTRATOR_PERIOD, synthetic};
pub use window::{Duration, LeftOut};

use crate::error::{Error, ErrorKind, Result};
use crate::fourier::{FourierBasis, Joints, Wave};

/// One recording: joint positions at strictly increasing times.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    name: String,
    joints: Joints,
    times: Vec<f64>,
    positions: DMatrix<f64>,
}

impl Recording {
    /// A recording called `name` (usually its file): `times` \[s\] (N), `positions` \[rad\] (N x D).
    ///
    /// # Errors
    /// When there are fewer than two samples, sizes do not fit, a number is not finite, or a time does not come
    /// after the one before it.
    pub fn new(
        name: impl Into<String>,
        joints: Joints,
        times: Vec<f64>,
        positions: DMatrix<f64>,
    ) -> Result<Self> {
        let name = name.into();
        let check = || {
            if times.len() < 2 {
                return Err(
                    Error::new(ErrorKind::Shape, format!("{} samples", times.len()))
                        .expected("at least two"),
                );
            }
            if positions.nrows() != times.len() || positions.ncols() != joints.len() {
                return Err(Error::new(
                    ErrorKind::Shape,
                    format!("positions of {} x {}", positions.nrows(), positions.ncols()),
                )
                .expected(format!(
                    "{} times x {} joints",
                    times.len(),
                    joints.len()
                )));
            }
            for (n, t) in times.iter().enumerate() {
                if !t.is_finite() {
                    return Err(Error::new(ErrorKind::Value, format!("time is {t}"))
                        .at(format!("sample {}", n + 1)));
                }
                if n > 0 && *t <= times[n - 1] {
                    return Err(Error::new(
                        ErrorKind::Value,
                        format!("time {t} s does not come after {} s", times[n - 1]),
                    )
                    .expected("strictly increasing times")
                    .at(format!("sample {}", n + 1)));
                }
            }
            for (d, joint) in joints.iter().enumerate() {
                if let Some(n) = positions.column(d).iter().position(|p| !p.is_finite()) {
                    return Err(Error::new(
                        ErrorKind::Value,
                        format!("position is {}", positions[(n, d)]),
                    )
                    .at(format!("sample {}, joint `{joint}`", n + 1)));
                }
            }
            Ok(())
        };
        check().map_err(|e| e.at(name.clone()))?;
        Ok(Self {
            name,
            joints,
            times,
            positions,
        })
    }

    /// What it is called in messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The joints' names.
    pub fn joints(&self) -> &Joints {
        &self.joints
    }

    /// Time stamps \[s\], N of them.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Positions \[rad\], N x D.
    pub fn positions(&self) -> &DMatrix<f64> {
        &self.positions
    }

    /// From the first to the last stamp \[s\].
    pub fn span(&self) -> f64 {
        self.times[self.times.len() - 1] - self.times[0]
    }

    /// Without the straight line through each joint's positions (least squares, its value at mid-time kept):
    /// a slow drift of posture is no part of a periodic gesture, and would leak into every harmonic.
    #[must_use]
    pub fn without_drift(&self) -> Self {
        let middle = self.times.iter().sum::<f64>() / self.times.len() as f64;
        let spread: f64 = self.times.iter().map(|t| (t - middle).powi(2)).sum();
        let mut positions = self.positions.clone();
        for mut column in positions.column_iter_mut() {
            let slope = self
                .times
                .iter()
                .zip(column.iter())
                .map(|(t, y)| (t - middle) * y)
                .sum::<f64>()
                / spread;
            for (y, t) in column.iter_mut().zip(&self.times) {
                *y -= slope * (t - middle);
            }
        }
        Self {
            positions,
            ..self.clone()
        }
    }
}

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

/// How well one demonstration is described by its wave, over all joints.
#[derive(Debug, Clone, PartialEq)]
pub struct Leakage {
    /// The recording.
    pub name: String,
    /// Share of the energy about the mean that the harmonics 1..=K leave, 0 to 1.
    pub residual_energy: f64,
    /// The largest step from the end of the window back to its start \[rad\]: a period that is not a whole number of
    /// cycles, or drift.
    pub end_jump: f64,
    /// The joint with that step.
    pub end_jump_joint: String,
}

impl Demonstrations {
    /// Cuts `recordings` to a common period.
    ///
    /// # Errors
    /// When there are no recordings, their joints differ, a joint never moves, or no two are long enough.
    pub fn new(recordings: Vec<Recording>, duration: Duration) -> Result<Self> {
        let Some(first) = recordings.first() else {
            return Err(Error::new(ErrorKind::Shape, "no recordings")
                .expected("at least two")
                .help("name CSV files, a folder of them, or a list file"));
        };
        let joints = first.joints.clone();
        for recording in &recordings {
            if recording.joints != joints {
                return Err(Error::new(
                    ErrorKind::Name,
                    format!("joints {}", recording.joints.listed()),
                )
                .expected(format!("{} as in {}", joints.listed(), first.name))
                .help("pick the columns that all have with --joints a,b,..")
                .at(recording.name.clone()));
            }
        }
        let (period, recordings, left_out) = window::cut(recordings, duration)?;
        for recording in &recordings {
            for (d, joint) in joints.iter().enumerate() {
                let column = recording.positions.column(d);
                if column.max() == column.min() {
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

impl Recording {
    fn leakage(&self, wave: &Wave) -> Leakage {
        let mut left = 0.0;
        let mut energy = 0.0;
        let mut state = crate::fourier::State::zeros(self.joints.len());
        for (n, &t) in self.times.iter().enumerate() {
            wave.state_into(t, &mut state);
            for d in 0..self.joints.len() {
                let y = self.positions[(n, d)];
                left += (y - state.position[d]).powi(2);
                energy += (y - wave.offsets()[d]).powi(2);
            }
        }
        let last = self.times.len() - 1;
        let (joint, end_jump) = (0..self.joints.len())
            .map(|d| {
                (
                    d,
                    (self.positions[(last, d)] - self.positions[(0, d)]).abs(),
                )
            })
            .fold(
                (0, 0.0),
                |best, next| if next.1 > best.1 { next } else { best },
            );
        Leakage {
            name: self.name.clone(),
            residual_energy: left / energy,
            end_jump,
            end_jump_joint: self.joints.name(joint).to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn a_line_is_removed_and_its_middle_stays() {
        let times: Vec<f64> = (0..50).map(|n| 0.1 * f64::from(n)).collect();
        let positions = DMatrix::from_fn(50, 1, |n, _| 0.4 + 0.3 * times[n]);
        let straight = Recording::new("r", Joints::new(["a"]).unwrap(), times, positions).unwrap();
        let flat = straight.without_drift();
        let middle = 0.4 + 0.3 * 2.45;
        assert!(flat.positions.iter().all(|p| (p - middle).abs() < 1e-12));
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

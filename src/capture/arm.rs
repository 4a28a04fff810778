//! [`ArmMotion`]: how an arm is turned over time, and [`Captured`], its angles.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, Matrix3, Vector3};

use super::branch::{continuous, median, unwind};
use super::note::CaptureNote;
use super::skeleton::Side;
use crate::anatomy::{ARM_ANGLES, ShoulderOrder, about_x, about_y, about_z, elbow, wrist};
use crate::demonstration::Recording;
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::Joints;

/// Nearer to singular than by this cosine of the middle angle, the others change too fast to learn from.
const SINGULAR: f64 = 0.25;

/// A row of frames alike shorter than this \[s\] is no fault of a recording.
const FROZEN: f64 = 0.1;

/// A distance between samples so many times the median's is a gap.
const GAP: f64 = 2.5;

/// The mean sine of an elbow's flexion below which its axis is noise.
const BENT: f64 = 0.02;

/// How an arm is turned, sample by sample: a right arm, or the mirror image of a left one.
///
/// From a skeleton ([`from_bvh`](Self::from_bvh)) or from positions ([`from_positions`](Self::from_positions)); its angles are
/// [`angles`](Self::angles).
#[derive(Debug, Clone, PartialEq)]
pub struct ArmMotion {
    pub(super) side: Side,
    pub(super) times: Vec<f64>,
    pub(super) poses: Vec<Pose>,
    /// Of the axis of the elbow about the humerus \[rad\], from where the T-pose has it.
    pub(super) hinge_roll: f64,
    pub(super) notes: Vec<CaptureNote>,
}

/// One sample of it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pose {
    /// In the thorax, without the roll to the elbow's axis.
    pub humerus: Matrix3<f64>,
    /// Where the forearm points, in that humerus.
    pub forearm: Vector3<f64>,
    /// In the thorax.
    pub hand: Option<Matrix3<f64>>,
}

/// A recording of an arm's angles.
#[derive(Debug, Clone, PartialEq)]
pub struct Captured {
    /// With times from 0 \[s\] and joints of [`ARM_ANGLES`], as many of them as are determined.
    pub recording: Recording,
    /// What the user should know.
    pub notes: Vec<CaptureNote>,
}

impl ArmMotion {
    /// With the roll by the mean axis of the elbow over all samples.
    pub(super) fn new(
        side: Side,
        times: Vec<f64>,
        poses: Vec<Pose>,
        mut notes: Vec<CaptureNote>,
    ) -> Self {
        // The sum of upper arm x forearm: samples count as far as the elbow is bent.
        let axis: Vector3<f64> = poses
            .iter()
            .map(|pose| (-Vector3::y()).cross(&pose.forearm))
            .sum();
        let hinge_roll = if axis.norm() < BENT * poses.len() as f64 {
            notes.push(CaptureNote::NoHinge);
            0.0
        } else {
            // It is -X of the humerus that is looked for.
            libm::atan2(axis.z, -axis.x)
        };
        Self {
            side,
            times,
            poses,
            hinge_roll,
            notes,
        }
    }

    /// Which arm it is.
    pub fn side(&self) -> Side {
        self.side
    }

    /// By how much the mean axis of the elbow is turned about the upper arm \[rad\] from where the T-pose has it: the zero of
    /// shoulder_rotation.
    pub fn hinge_roll(&self) -> f64 {
        self.hinge_roll
    }

    /// With another such zero: that of a longer recording of the same person.
    ///
    /// # Errors
    /// When it is beyond half a turn.
    pub fn with_hinge_roll(self, hinge_roll: f64) -> Result<Self> {
        if !(-TAU / 2.0..=TAU / 2.0).contains(&hinge_roll) {
            return Err(
                Error::new(ErrorKind::Setting, format!("hinge roll {hinge_roll} rad"))
                    .expected("an angle within half a turn"),
            );
        }
        let mut notes = self.notes;
        notes.retain(|note| *note != CaptureNote::NoHinge);
        Ok(Self {
            hinge_roll,
            notes,
            ..self
        })
    }

    /// From the first to the last sample \[s\].
    pub fn span(&self) -> f64 {
        self.times[self.times.len() - 1] - self.times[0]
    }

    /// How many there are.
    pub fn samples(&self) -> usize {
        self.times.len()
    }

    /// Samples a second, of their median distance.
    pub fn rate(&self) -> f64 {
        1.0 / median(self.times.windows(2).map(|t| t[1] - t[0]))
    }

    /// The way of its hand a second, in lengths of the straight arm: what tells the arm that waves from the one that hangs.
    pub fn speed(&self) -> f64 {
        let hand = |pose: &Pose| pose.humerus * (pose.forearm - Vector3::y()) / 2.0;
        let ways = self.poses.windows(2);
        ways.map(|p| (hand(&p[1]) - hand(&p[0])).norm())
            .sum::<f64>()
            / self.span()
    }

    /// The part from one time to another \[s\], both included; the zero of the rotation stays that of the whole.
    ///
    /// # Errors
    /// When fewer than two samples are left.
    pub fn between(&self, from: f64, to: f64) -> Result<Self> {
        // Ends that are written with some digits mean the samples there.
        let slack = 1e-3 / self.rate();
        let first = self.times.partition_point(|t| *t < from - slack);
        let end = self.times.partition_point(|t| *t <= to + slack);
        if end < first + 2 {
            let last = self.times[self.times.len() - 1];
            return Err(
                Error::new(ErrorKind::Setting, format!("nothing from {from} to {to} s"))
                    .expected(format!("a part of {} to {last} s", self.times[0])),
            );
        }
        Ok(Self {
            times: self.times[first..end].to_vec(),
            poses: self.poses[first..end].to_vec(),
            notes: self.notes.clone(),
            ..*self
        })
    }

    /// Its angles, as a recording called `name`: continuous, also through where the order is singular, and on the branch whose medians are nearest 0.
    ///
    /// # Errors
    /// Those of [`Recording::new`].
    pub fn angles(&self, name: &str, order: ShoulderOrder) -> Result<Captured> {
        let roll = about_y(self.hinge_roll);
        let columns = match self.poses.iter().all(|pose| pose.hand.is_some()) {
            true => ARM_ANGLES.len(),
            false => 4,
        };
        let mut angles = DMatrix::zeros(self.poses.len(), columns);
        for (n, pose) in self.poses.iter().enumerate() {
            let humerus = pose.humerus * roll;
            let [flexion, carrying] = elbow(&(roll.transpose() * pose.forearm));
            let [f, a, r] = order.angles(&humerus);
            let mut row = [f, a, r, flexion, 0.0, 0.0, 0.0];
            if let Some(hand) = &pose.hand {
                let forearm = humerus * about_x(-flexion) * about_z(-carrying);
                row[4..].copy_from_slice(&wrist(&(forearm.transpose() * hand)));
            }
            for (angle, value) in angles.row_mut(n).iter_mut().zip(row) {
                *angle = value;
            }
        }
        continuous(&mut angles, order.middle());
        for mut column in angles.column_iter_mut() {
            unwind(column.as_mut_slice());
        }
        let start = self.times[0];
        let times = self.times.iter().map(|t| t - start).collect();
        let joints = Joints::new(ARM_ANGLES[..columns].iter().copied())?;
        let mut notes = self.notes.clone();
        notes.extend(self.singular(order));
        notes.extend(self.frozen());
        notes.extend(self.gaps());
        Ok(Captured {
            recording: Recording::new(name, joints, times, angles)?,
            notes,
        })
    }

    fn singular(&self, order: ShoulderOrder) -> Option<CaptureNote> {
        // The roll turns about Y and leaves the middle angle as it is.
        let nearest = |order: ShoulderOrder| {
            let margins = self.poses.iter().map(|pose| order.margin(&pose.humerus));
            margins.fold(f64::INFINITY, f64::min)
        };
        let [own, other] = [nearest(order), nearest(order.other())];
        (own < SINGULAR).then_some(CaptureNote::Singular {
            order,
            nearest: own,
            other,
        })
    }

    fn frozen(&self) -> Option<CaptureNote> {
        let (mut frames, mut longest, mut at) = (0, 0.0, 0.0);
        for row in self.poses.chunk_by(|a, b| a == b).scan(0, |first, row| {
            *first += row.len();
            Some((*first - row.len(), *first - 1))
        }) {
            let span = self.times[row.1] - self.times[row.0];
            if span >= FROZEN {
                frames += row.1 - row.0;
            }
            if span > longest {
                (longest, at) = (span, self.times[row.0]);
            }
        }
        (frames > 0).then_some(CaptureNote::Frozen {
            frames,
            longest,
            at,
        })
    }

    fn gaps(&self) -> Option<CaptureNote> {
        let least = GAP / self.rate();
        let gaps: Vec<&[f64]> = self
            .times
            .windows(2)
            .filter(|t| t[1] - t[0] > least)
            .collect();
        let longest = gaps
            .iter()
            .max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])))?;
        Some(CaptureNote::Gap {
            gaps: gaps.len(),
            longest: longest[1] - longest[0],
            at: longest[0],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A forearm that leaves the plane in which the elbow bends: pronation and wrist are reckoned from where it points, first bent and then carried.
    #[test]
    fn the_wrist_is_measured_from_a_forearm_that_is_carried_outward() {
        let (elbow, carrying) = (1.1, 0.2);
        let [pronation, bend, deviation] = [0.4, -0.3, 0.25];
        let humerus = about_x(-0.5) * about_z(-0.3) * about_y(0.2);
        let turn = about_x(-elbow) * about_z(-carrying);
        let hand = humerus * turn * about_y(pronation) * about_z(bend) * about_x(-deviation);
        let pose = Pose {
            humerus,
            forearm: turn * -Vector3::y(),
            hand: Some(hand),
        };
        let motion = ArmMotion {
            side: Side::Right,
            times: vec![0.0, 1.0],
            poses: vec![pose.clone(), pose],
            hinge_roll: 0.0,
            notes: Vec::new(),
        };
        let captured = motion.angles("carried", ShoulderOrder::Xzy).unwrap();
        let found = captured.recording.positions();
        let expected = [0.5, 0.3, 0.2, elbow, pronation, bend, deviation];
        for (joint, expected) in expected.iter().enumerate() {
            let found = found[(0, joint)];
            assert!((found - expected).abs() < 1e-12, "{joint}: {found}");
        }
    }
}

//! A second look at a certificate, by other means: poses by the robot's own kinematics, distances by parry, and how far points are from axes
//! by the corners of the shapes.

use super::certificate::{Certificate, NOT_COVERED};
use super::side::{distance, fall, side};
use super::{CollisionModel, CollisionOptions};
use crate::error::{Error, ErrorKind, Result};
use crate::motion::{Motion, Tube};
use crate::robot::Robot;

/// Two ways of computing a distance may differ by this \[m\].
const ROUNDING: f64 = 1e-9;

/// And poses are rounded by this share of all lengths.
const LENGTHS: f64 = 64.0 * f64::EPSILON;

/// What a verification looked at.
#[derive(Debug, Clone, PartialEq)]
pub struct Verified {
    /// Intervals of time.
    pub intervals: usize,
    /// Distances by parry.
    pub distances: usize,
    /// On no interval came a pair nearer to the margin than this \[m\].
    pub spare: f64,
}

impl Certificate {
    /// Verifies the proof for this robot, motion and options: that it is of these joints, this geometry and these pairs, that its intervals
    /// cover the motion for every pair, and that on each the distance in the middle, by parry, exceeds what it can fall.
    ///
    /// # Errors
    /// When anything of that does not hold; the message says what.
    pub fn verify<M: Motion>(
        &self,
        robot: &Robot,
        motion: &M,
        options: &CollisionOptions,
    ) -> Result<Verified> {
        let file = &self.file;
        let refuse = |what: String| Error::new(ErrorKind::Infeasible, what).at("certificate");
        if *motion.joints() != self.joints || *robot.joints() != self.joints {
            return Err(refuse(format!("it is of {}", self.joints.listed()))
                .expected(motion.joints().listed()));
        }
        if motion.duration() != file.duration_s || motion.is_periodic() != file.is_periodic {
            return Err(
                refuse(format!("it is of a motion of {} s", file.duration_s))
                    .expected(format!("{} s", motion.duration())),
            );
        }
        if file.robot != robot.name() {
            return Err(refuse(format!("it is of the robot `{}`", file.robot))
                .expected(format!("`{}`", robot.name())));
        }
        let is_number = |x: &f64| *x >= 0.0 && x.is_finite();
        if !(is_number(&file.margin_m) && file.tolerance.iter().all(is_number)) {
            return Err(refuse("a margin or tolerance that is none".to_owned()));
        }
        let model = CollisionModel::new(robot, options)?;
        if model.geometry_sha256(robot) != file.geometry_sha256
            || model.geometry(robot) != file.geometry
        {
            return Err(refuse("the collision geometry is another one".to_owned())
                .help("give the same URDF, meshes and scene"));
        }
        let checked: Vec<_> = model.pairs().iter().filter(|p| p.is_checked()).collect();
        let same = checked.len() == file.checked.len()
            && checked
                .iter()
                .zip(&file.checked)
                .all(|(pair, entry)| pair.names == entry.pair && pair.padding == entry.padding_m);
        if !same || model.not_checked() != file.not_checked {
            return Err(refuse("the pairs that are checked are others".to_owned())
                .help("give the same SRDF, padding, and pairs to be left out or kept"));
        }
        let sides = checked
            .iter()
            .map(|pair| {
                Ok([
                    side(robot, options, &pair.names.0)?,
                    side(robot, options, &pair.names.1)?,
                ])
            })
            .collect::<Result<Vec<_>>>()?;
        self.require_cover()?;
        let joints = self.joints.len();
        let mut tube = motion.tube();
        let (mut q, mut radius) = (vec![0.0; joints], vec![0.0; joints]);
        let mut verified = Verified {
            intervals: file.tree.len(),
            distances: 0,
            spare: f64::INFINITY,
        };
        for (middle, half, pairs) in &file.tree {
            tube.over(*middle, *half, &mut q, &mut radius);
            for (radius, tolerance) in radius.iter_mut().zip(&file.tolerance) {
                *radius += tolerance;
            }
            let poses = robot.body_poses(&q);
            let lengths: f64 = poses.iter().map(|p| p.translation.vector.norm()).sum();
            for number in pairs {
                let [a, b] = &sides[*number];
                let fall = fall(robot, &poses, a, b, &radius);
                let (distance, looks) = distance(&poses, a, b);
                verified.distances += looks;
                let spare = distance - file.checked[*number].padding_m - fall - file.margin_m;
                // Certificates are written with a hundred times as much to spare.
                let least = ROUNDING + LENGTHS * lengths;
                if spare <= least || spare.is_nan() {
                    let (first, second) = &file.checked[*number].pair;
                    return Err(refuse(format!(
                        "{first} and {second} are {distance:.6} m apart at {middle:.4} s and may come nearer by {fall:.6} m within {half:.2e} s"
                    ))
                    .expected(format!("a distance above the margin of {} m", file.margin_m)));
                }
                verified.spare = verified.spare.min(spare);
            }
        }
        self.require_claims(&verified)?;
        Ok(verified)
    }

    /// What it says beside the proof is no more than what is proven.
    fn require_claims(&self, verified: &Verified) -> Result<()> {
        let file = &self.file;
        let refuse = |what: String| Error::new(ErrorKind::Infeasible, what).at("certificate");
        let proven = file.margin_m + verified.spare;
        if file.clearance_above_m.is_nan() || file.clearance_above_m > proven + ROUNDING {
            return Err(refuse(format!(
                "it claims a clearance above {} m",
                file.clearance_above_m
            ))
            .expected(format!("no more than the {proven} m that it proves")));
        }
        let (first, second) = &file.nearest;
        if !file.checked.iter().any(|entry| entry.pair == file.nearest) {
            return Err(refuse(format!("its nearest pair is {first} and {second}"))
                .expected("a pair that is checked"));
        }
        if file.not_covered != NOT_COVERED {
            return Err(refuse("what it does not cover was changed".to_owned()));
        }
        Ok(())
    }

    /// For every pair the intervals follow each other without a gap, from 0 to the end.
    fn require_cover(&self) -> Result<()> {
        let file = &self.file;
        // Ends of neighbours are rounded; intervals are meant to reach over by a few machine epsilons (see `Tube::over`).
        let rounding = 4.0 * f64::EPSILON * file.duration_s;
        let mut intervals: Vec<Vec<(f64, f64)>> = vec![Vec::new(); file.checked.len()];
        for (middle, half, pairs) in &file.tree {
            if !(middle.is_finite() && *half >= 0.0 && half.is_finite()) {
                return Err(
                    Error::new(ErrorKind::Value, format!("an interval about {middle} s"))
                        .at("certificate"),
                );
            }
            for pair in pairs {
                intervals[*pair].push((middle - half, middle + half));
            }
        }
        for (entry, intervals) in file.checked.iter().zip(&mut intervals) {
            intervals.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut covered = 0.0;
            for (from, to) in intervals.iter() {
                if *from > covered + rounding {
                    break;
                }
                covered = f64::max(covered, *to);
            }
            if covered < file.duration_s - rounding {
                return Err(Error::new(
                    ErrorKind::Infeasible,
                    format!(
                        "{} and {} are not proven from {covered} s on",
                        entry.pair.0, entry.pair.1
                    ),
                )
                .expected(format!("a proof to {} s", file.duration_s))
                .at("certificate"));
            }
        }
        Ok(())
    }
}

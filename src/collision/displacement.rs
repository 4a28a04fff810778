//! How much nearer two parts can come than they are in one configuration, while every joint stays within a radius of it.
//!
//! Between parts A and B lies a chain of joints. Turning one of them by at most r moves every point beyond it, as seen from this side,
//! by at most rho r, rho the distance of the farthest point from the axis. Let the joints go to where they are one after the other:
//! those up to some joint s in the order from s to A, those beyond it in the order from s to B. Whenever one moves, the joints
//! between it and A (or B) have not moved yet, so that A (or B) and the axis are to each other as they were in the one configuration,
//! and moving A against the axis is moving the axis, with all beyond it, against A. So
//!
//! ```text
//! d(q) >= d(q_m) - sum_{k <= s} rho_k(A) r_k - sum_{k > s} rho_k(B) r_k     for |q - q_m| <= r and every s,
//! ```
//!
//! with every rho taken at q_m, and no term of second order. The s of the least sum is taken. What is round about its core, a ball or a
//! capsule, is so however it turns, so rho is of points of the core alone. Points move by less than this on circles,
//! and a prismatic joint has rho = 1. What is moved by at most x lets the signed distance change by at most x, deep in each other too:
//! it is the largest over all directions of the gap between two parallel planes, and each gap changes by at most x.

use std::collections::HashMap;

use super::filter::OUTWARD;
use super::frames::Frames;
use super::pairs::Pair;
use super::part::{Part, PartGeometry};
use crate::error::{Error, ErrorKind, Result};
use crate::robot::JointKind;

/// The joints between the parts of each pair, one chain after the other in one list: long chains have very many pairs.
#[derive(Debug, Clone)]
pub(super) struct Chains {
    steps: Vec<Step>,
    /// Where the chain of each pair starts; at the end, where the last one ends.
    starts: Vec<usize>,
    /// What the steps share.
    pub rows: Vec<Row>,
}

/// A joint of a chain.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    joint: u32,
    /// Seen from the first part, the second turns against the joint: on the way from the first part to the base.
    is_against: bool,
    rows: (Option<u32>, u32),
}

impl Step {
    /// Number of the joint among [`Frames::joints`].
    pub fn joint(&self) -> usize {
        self.joint as usize
    }

    /// Seen from the first part, the second turns with the joint (1), or against it (-1).
    pub fn sign(&self) -> f64 {
        if self.is_against { -1.0 } else { 1.0 }
    }

    /// Which row has its rho for the first part and for the second; `None` for the first where it is a half-space, which is endless.
    pub fn rows(&self) -> (Option<usize>, usize) {
        (self.rows.0.map(|row| row as usize), self.rows.1 as usize)
    }
}

/// What rho is wanted of: a part and a joint.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row {
    pub part: usize,
    pub joint: usize,
    /// However the joints stand, the middle of the ball around the part is no farther from the joint's axis \[m\]; 1 for prismatic joints.
    pub most: f64,
}

/// So many joints are in all chains together at most: memory grows with them.
const MOST_STEPS: usize = 4_000_000;

impl Chains {
    /// The chain of every pair that is checked; of the others none is asked, and theirs is empty.
    pub fn new(frames: &Frames, parts: &[Part], pairs: &[Pair]) -> Result<Self> {
        let ways: Vec<Vec<usize>> = parts.iter().map(|part| way(frames, part.body)).collect();
        // Both ways end at the base; what they share moves both parts alike.
        let own = |a: usize, b: usize| {
            let (up, down) = (&ways[a], &ways[b]);
            let both = up.iter().rev().zip(down.iter().rev());
            let shared = both.take_while(|(x, y)| x == y).count();
            (&up[..up.len() - shared], &down[..down.len() - shared])
        };
        let checked = |pair: &Pair| {
            let own = pair.is_checked().then(|| own(pair.parts.0, pair.parts.1));
            own.unwrap_or_default()
        };
        let lengths = pairs.iter().map(|pair| {
            let (up, down) = checked(pair);
            up.len() + down.len()
        });
        let starts: Vec<usize> = std::iter::once(0)
            .chain(lengths.scan(0, |sum, length| {
                *sum += length;
                Some(*sum)
            }))
            .collect();
        let count = starts[pairs.len()];
        if count > MOST_STEPS {
            return Err(Error::new(
                ErrorKind::Unsupported,
                format!("{count} joints between the links of all pairs together"),
            )
            .expected(format!("at most {MOST_STEPS}"))
            .help(
                "join links by fixed joints, or take collision shapes off those that cannot touch",
            ));
        }
        let mut steps = Vec::with_capacity(count);
        let mut rows: Vec<Row> = Vec::new();
        let mut numbers: HashMap<(usize, usize), u32> = HashMap::new();
        for pair in pairs {
            let (a, b) = pair.parts;
            let (up, down) = checked(pair);
            let against = up.iter().map(|joint| (*joint, true));
            let along = down.iter().rev().map(|joint| (*joint, false));
            let mut row = |part: usize, joint: usize| {
                *numbers.entry((part, joint)).or_insert_with(|| {
                    let most = most(frames, &parts[part], joint);
                    rows.push(Row { part, joint, most });
                    rows.len() as u32 - 1
                })
            };
            let endless = matches!(parts[a].geometry, PartGeometry::HalfSpace(_));
            steps.extend(against.chain(along).map(|(joint, is_against)| Step {
                joint: joint as u32,
                is_against,
                rows: ((!endless).then(|| row(a, joint)), row(b, joint)),
            }));
        }
        Ok(Self {
            steps,
            starts,
            rows,
        })
    }

    /// From the first part of a pair to the second.
    pub fn of(&self, pair: usize) -> &[Step] {
        &self.steps[self.starts[pair]..self.starts[pair + 1]]
    }
}

/// However the joints stand, how far the middle of the ball around a part can be from the axis of a joint.
fn most(frames: &Frames, part: &Part, joint: usize) -> f64 {
    let PartGeometry::Convexes { ball, .. } = &part.geometry else {
        return f64::INFINITY;
    };
    let turning = &frames.joints()[joint];
    if turning.kind == JointKind::Prismatic {
        return 1.0;
    }
    if turning.parent == part.body {
        let arm = ball.center - turning.translation;
        return arm.cross(&turning.rotation.column(2)).norm() * OUTWARD;
    }
    let above = |body: usize| {
        way(frames, body)
            .into_iter()
            .map(|joint| &frames.joints()[joint])
    };
    // What both have above them ends in the same place.
    let shared = way(frames, part.body)
        .iter()
        .rev()
        .zip(way(frames, turning.body).iter().rev())
        .take_while(|(x, y)| x == y)
        .count();
    let own = |body: usize| above(body).take(way(frames, body).len() - shared);
    // Only what is across the axis counts of the last way to it.
    let (mut arm, mut beyond) = (ball.center, 0.0);
    for joint in own(part.body).chain(own(turning.body)) {
        if joint.kind == JointKind::Prismatic {
            return f64::INFINITY;
        }
        beyond += arm.norm();
        arm = joint.translation;
    }
    let last = if shared == way(frames, turning.body).len() {
        arm.xy().norm()
    } else {
        arm.norm()
    };
    (last + beyond) * OUTWARD
}

/// The joints from a body to the base.
fn way(frames: &Frames, body: usize) -> Vec<usize> {
    let mut joints = Vec::new();
    let mut at = body;
    while at > 0 {
        joints.push(at - 1);
        at = frames.joints()[at - 1].parent;
    }
    joints
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use rand::RngExt;

    use super::*;
    use crate::collision::{CollisionModel, CollisionOptions};
    use crate::geometry::Placement;
    use crate::{shipped, stream};

    /// Over how many postures the farthest is sought.
    const POSTURES: u64 = 400;
    /// What a posture is off by in rounding \[m\].
    const ROUNDING: f64 = 1e-12;

    /// Up from the first part as far as the ways to the base part, then down to the second: what comes later in a chain is moved by what comes before.
    #[test]
    fn a_chain_goes_from_the_first_part_to_the_second() {
        for name in shipped::robots() {
            let robot = shipped::robot(name).unwrap();
            let model = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
            let joints = model.frames.joints();
            for (number, pair) in model.pairs.iter().enumerate() {
                let [from, to] = [pair.parts.0, pair.parts.1].map(|part| model.parts[part].body);
                let mut at = from;
                for step in model.chains.of(number) {
                    let (body, parent) = (step.joint() + 1, joints[step.joint()].parent);
                    let [here, there] = if step.sign() < 0.0 {
                        [body, parent]
                    } else {
                        [parent, body]
                    };
                    assert_eq!(at, here, "{name}: {:?}", pair.names);
                    at = there;
                }
                assert!(at == to || !pair.is_checked(), "{name}: {:?}", pair.names);
            }
        }
    }

    #[test]
    fn no_ball_is_farther_from_an_axis_than_it_can_be() {
        for name in shipped::robots() {
            let robot = shipped::robot(name).unwrap();
            let model = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
            let (frames, rows) = (&model.frames, &model.chains.rows);
            let mut farthest = vec![0.0_f64; rows.len()];
            let mut placed = vec![Placement::identity(); frames.bodies()];
            for number in 0..POSTURES {
                let mut rng = stream(4, number);
                let mut q = vec![0.0; robot.joints().len()];
                q.fill_with(|| 7.0 * (rng.random::<f64>() - 0.5));
                frames.place(&q, &mut placed);
                for (row, farthest) in rows.iter().zip(&mut farthest) {
                    let (part, turning) = (&model.parts[row.part], &frames.joints()[row.joint]);
                    let PartGeometry::Convexes { ball, .. } = &part.geometry else {
                        continue;
                    };
                    let axis: &Placement = &placed[turning.body];
                    let arm = placed[part.body].point(&ball.center) - axis.translation;
                    let across = arm.cross(&Vector3::from(axis.rotation.column(2)));
                    *farthest = farthest.max(across.norm());
                }
            }
            for (row, farthest) in rows.iter().zip(farthest) {
                assert!(
                    farthest <= row.most + ROUNDING,
                    "{name}: {farthest}, {row:?}"
                );
                // From a joint that the part's own body bears it is always as far.
                let turning = &frames.joints()[row.joint];
                if turning.parent == model.parts[row.part].body {
                    assert!(
                        row.most <= farthest + ROUNDING,
                        "{name}: {farthest}, {row:?}"
                    );
                }
            }
        }
    }
}

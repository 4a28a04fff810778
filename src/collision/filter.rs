//! What balls and capsules around the parts prove, for several intervals of time at once.

use fearless_simd::{Simd, SimdBase, SimdFloat, SimdMask, f64x8};

use super::CollisionModel;
use super::displacement::{Row, Step};
use super::frames::{Poses, Stored, V3};
use super::part::PartGeometry;
use crate::motion::{LANES, TubeRows};
use crate::robot::JointKind;

/// Intervals of time: where everything is in their middles, and how far from there it can be.
pub(super) struct Batch {
    /// Of the motion.
    pub rows: TubeRows,
    /// Of each body.
    pub placed: Vec<Stored>,
    /// Of each body's joint, how far it can be from where it is.
    pub turn: Vec<[f64; LANES]>,
    /// What of that is tolerance.
    pub tolerance: Vec<[f64; LANES]>,
    /// Of each part, the centre of its ball.
    centers: Vec<[[f64; LANES]; 3]>,
    /// Of each part, the ends of its capsule.
    ends: Vec<InRound<[[[f64; LANES]; 3]; 2]>>,
    /// Of each row, its rho by the ball and by the capsule.
    ball_rho: Vec<InRound<[f64; LANES]>>,
    capsule_rho: Vec<InRound<[f64; LANES]>>,
    /// Counts the placements.
    round: u64,
    /// What rounding of frames does to a distance at most \[m\], with prismatic joints where they are.
    pub rounding: f64,
    /// Whether all that falls is told by the points of the shapes alone, as whoever verifies a certificate does.
    pub is_plain: bool,
}

/// Which rho a fall is reckoned with.
#[derive(Debug, Clone, Copy)]
enum Rho {
    Most,
    Ball,
    Capsule,
}

/// What has been computed in a round, and is then read.
#[derive(Debug, Clone, Copy)]
struct InRound<T> {
    value: T,
    round: u64,
}

/// By how much the distance of a pair falls at most in the intervals of a batch.
#[derive(Debug, Clone, Copy)]
pub(super) struct Falls {
    /// From what it is in the middle \[m\].
    pub fall: [f64; LANES],
    /// However short the interval \[m\]: what the tolerance of the joints is good for.
    pub rest: [f64; LANES],
}

impl Batch {
    pub fn new(model: &CollisionModel) -> Self {
        let zero = [0.0; LANES];
        Self {
            rows: TubeRows::new(model.joints().len()),
            placed: vec![[zero; 12]; model.frames.bodies()],
            turn: vec![zero; model.frames.joints().len()],
            tolerance: vec![zero; model.frames.joints().len()],
            centers: vec![[zero; 3]; model.parts.len()],
            ends: vec![InRound::never([[zero; 3]; 2]); model.parts.len()],
            ball_rho: vec![InRound::never(zero); model.chains.rows.len()],
            capsule_rho: vec![InRound::never(zero); model.chains.rows.len()],
            round: 0,
            rounding: model.rounding,
            is_plain: false,
        }
    }

    /// Puts all bodies where the positions say, `tolerance` \[rad, m\] a joint of the motion being added to the radii.
    #[inline(always)]
    pub fn place<S: Simd>(&mut self, simd: S, model: &CollisionModel, tolerance: &[f64]) {
        self.round += 1;
        model
            .frames
            .place_lanes(simd, &self.rows.position, &mut self.placed);
        let mut slid = 0.0;
        for (i, joint) in model.frames.joints().iter().enumerate() {
            let size = joint.multiplier.abs() * OUTWARD;
            let tolerance = size * tolerance[joint.index];
            self.tolerance[i] = [tolerance; LANES];
            // What the joint's own position is rounded by, multiplied and shifted.
            let position = f64x8::load_array_ref(simd, &self.rows.position[joint.index]);
            let position = (position * joint.multiplier).abs() + joint.offset.abs();
            let radius = f64x8::load_array_ref(simd, &self.rows.radius[joint.index]);
            let turn = radius * size + tolerance + position * (4.0 * f64::EPSILON);
            turn.store_slice(&mut self.turn[i]);
            if joint.kind == JointKind::Prismatic {
                slid += position.reduce_max();
            }
        }
        self.rounding = model.rounding + model.rounding_of(slid);
        for (center, part) in self.centers.iter_mut().zip(&model.parts) {
            if let PartGeometry::Convexes { ball, .. } = &part.geometry {
                let placed = Poses::load(simd, &self.placed[part.body]);
                placed.point(&ball.center.into()).store(center);
            }
        }
    }

    /// Less than this \[m\] the distance of a pair cannot be anywhere in the interval, by the balls around its two parts: as good as it takes to
    /// be above the bar on these lanes.
    #[inline(always)]
    pub fn by_balls<S: Simd>(
        &mut self,
        simd: S,
        model: &CollisionModel,
        pair: usize,
        (bar, lanes): (f64, u8),
    ) -> [f64; LANES] {
        let (a, b) = model.pairs[pair].parts;
        let PartGeometry::Convexes { ball: ball_b, .. } = &model.parts[b].geometry else {
            return UNKNOWN;
        };
        let center = self.center(simd, b);
        let gap = match &model.parts[a].geometry {
            PartGeometry::Convexes { ball, .. } => {
                self.center(simd, a).sub(&center).norm() - (ball.radius + ball_b.radius)
            }
            PartGeometry::HalfSpace(half_space) => {
                let normal = V3::splat(simd, &(*half_space.normal()).into());
                normal.dot(&center) - (half_space.offset() + ball_b.radius)
            }
        };
        let gap = gap - (model.pairs[pair].padding + self.rounding);
        let chain = model.chains.of(pair);
        let girths = if self.is_plain {
            [model.parts[a].core_radius, model.parts[b].core_radius]
        } else {
            [0.0; 2]
        };
        let [fall] = self.fall(simd, model, chain, Rho::Most, girths, [&self.turn]);
        let lower = gap - fall;
        let above = lower.simd_gt(f64x8::splat(simd, bar)).to_bitmask() as u8;
        if above & lanes == lanes {
            return to_array(lower);
        }
        for (first, second) in chain.iter().map(Step::rows) {
            if let Some(row) = first {
                self.update_ball_rho(simd, model, row);
            }
            self.update_ball_rho(simd, model, second);
        }
        let [fall] = self.fall(simd, model, chain, Rho::Ball, girths, [&self.turn]);
        to_array(gap - fall)
    }

    /// The same by the capsules around them.
    #[inline(always)]
    pub fn by_capsules<S: Simd>(
        &mut self,
        simd: S,
        model: &CollisionModel,
        pair: usize,
    ) -> [f64; LANES] {
        let (a, b) = model.pairs[pair].parts;
        let PartGeometry::Convexes { capsule, .. } = &model.parts[b].geometry else {
            return UNKNOWN;
        };
        let ends_b = self.ends(simd, model, b);
        let gap = match &model.parts[a].geometry {
            PartGeometry::Convexes { capsule: other, .. } => {
                let ends_a = self.ends(simd, model, a);
                segment_gap(simd, &ends_a, &ends_b) - (capsule.radius + other.radius)
            }
            PartGeometry::HalfSpace(half_space) => {
                let normal = V3::splat(simd, &(*half_space.normal()).into());
                let least = normal.dot(&ends_b[0]).min(normal.dot(&ends_b[1]));
                least - (half_space.offset() + capsule.radius)
            }
        };
        let chain = model.chains.of(pair);
        for (first, second) in chain.iter().map(Step::rows) {
            if let Some(row) = first {
                self.update_capsule_rho(simd, model, row);
            }
            self.update_capsule_rho(simd, model, second);
        }
        let girths = if self.is_plain {
            [model.parts[a].girth, model.parts[b].girth]
        } else {
            [0.0; 2]
        };
        let [fall] = self.fall(simd, model, chain, Rho::Capsule, girths, [&self.turn]);
        to_array(gap - (model.pairs[pair].padding + self.rounding) - fall)
    }

    /// By how much the shapes themselves come nearer, once capsules have been asked. The shapes are as far from the axes as the
    /// capsules' surfaces, but for their own margins, which are round.
    #[inline(always)]
    pub fn falls<S: Simd>(&self, simd: S, model: &CollisionModel, pair: usize) -> Falls {
        let (a, b) = model.pairs[pair].parts;
        let girths = [model.parts[a].girth, model.parts[b].girth];
        let turns = [self.turn.as_slice(), &self.tolerance];
        let chain = model.chains.of(pair);
        let [fall, rest] = self.fall(simd, model, chain, Rho::Capsule, girths, turns);
        Falls {
            fall: to_array(fall),
            rest: to_array(rest),
        }
    }

    /// The least sum over the joints of a chain, those up to some joint by the rho of the first part and the others by that of the second, each
    /// with what `girths` adds to it for revolute joints, times each of `turns`.
    #[inline(always)]
    fn fall<S: Simd, const N: usize>(
        &self,
        simd: S,
        model: &CollisionModel,
        chain: &[Step],
        rho: Rho,
        girths: [f64; 2],
        turns: [&[[f64; LANES]]; N],
    ) -> [f64x8<S>; N] {
        let zero = f64x8::splat(simd, 0.0);
        // The sum of all by the second; what it changes when those up to a joint are by the first, and the least of that.
        let (mut sum, mut change, mut least) = ([zero; N], [zero; N], [zero; N]);
        for step in chain {
            let is_turning = match model.frames.joints()[step.joint()].kind {
                JointKind::Revolute => 1.0,
                JointKind::Prismatic => 0.0,
            };
            let (first, second) = step.rows();
            let second = self.rho(simd, model, rho, second) + girths[1] * is_turning;
            let first = match first {
                Some(row) => self.rho(simd, model, rho, row) + girths[0] * is_turning,
                // A half-space is endless: no joint is reckoned with it.
                None => second,
            };
            for i in 0..N {
                let turn = f64x8::load_array_ref(simd, &turns[i][step.joint()]);
                sum[i] += second * turn;
                change[i] += (first - second) * turn;
                least[i] = least[i].min(change[i]);
            }
        }
        for i in 0..N {
            sum[i] = sum[i] * OUTWARD + least[i];
        }
        sum
    }

    #[inline(always)]
    fn rho<S: Simd>(&self, simd: S, model: &CollisionModel, rho: Rho, row: usize) -> f64x8<S> {
        match rho {
            Rho::Most => f64x8::splat(simd, model.chains.rows[row].most + self.rounding),
            Rho::Ball => f64x8::load_array_ref(simd, &self.ball_rho[row].value),
            Rho::Capsule => f64x8::load_array_ref(simd, &self.capsule_rho[row].value),
        }
    }

    /// The distance of the middle of the ball around a part from a joint's axis; 1 for prismatic joints. Balls are balls however they turn, so
    /// that the gap between two falls by no more than their middles move.
    #[inline(always)]
    fn update_ball_rho<S: Simd>(&mut self, simd: S, model: &CollisionModel, row: usize) {
        if self.ball_rho[row].round != self.round {
            let Row { part, joint, .. } = model.chains.rows[row];
            let joint = &model.frames.joints()[joint];
            let rho = match joint.kind {
                JointKind::Prismatic => f64x8::splat(simd, 1.0),
                JointKind::Revolute => {
                    let placed = Poses::load(simd, &self.placed[joint.body]);
                    let arm = self.center(simd, part).sub(&placed.origin);
                    arm.cross(&placed.z).norm() + self.rounding
                }
            };
            rho.store_slice(&mut self.ball_rho[row].value);
            self.ball_rho[row].round = self.round;
        }
    }

    /// The distance of the farther end of the axis of the capsule around a part from a joint's axis: the gap between two capsules falls by no more
    /// than their axes move.
    #[inline(always)]
    fn update_capsule_rho<S: Simd>(&mut self, simd: S, model: &CollisionModel, row: usize) {
        if self.capsule_rho[row].round != self.round {
            let Row { part, joint, .. } = model.chains.rows[row];
            let joint = &model.frames.joints()[joint];
            let rho = match joint.kind {
                JointKind::Prismatic => f64x8::splat(simd, 1.0),
                JointKind::Revolute => {
                    let placed = Poses::load(simd, &self.placed[joint.body]);
                    let [first, second] = self.ends(simd, model, part);
                    let first = first.sub(&placed.origin).cross(&placed.z);
                    let second = second.sub(&placed.origin).cross(&placed.z);
                    first.dot(&first).max(second.dot(&second)).sqrt() + self.rounding
                }
            };
            rho.store_slice(&mut self.capsule_rho[row].value);
            self.capsule_rho[row].round = self.round;
        }
    }

    /// By the capsule around the second part of a pair, of a joint of its chain.
    pub fn second_rho(&self, step: &Step) -> &[f64; LANES] {
        &self.capsule_rho[step.rows().1].value
    }

    #[inline(always)]
    fn center<S: Simd>(&self, simd: S, part: usize) -> V3<S> {
        V3::load(simd, self.centers[part].each_ref())
    }

    /// The ends of the capsule around a part.
    #[inline(always)]
    fn ends<S: Simd>(&mut self, simd: S, model: &CollisionModel, part: usize) -> [V3<S>; 2] {
        if self.ends[part].round != self.round
            && let PartGeometry::Convexes { capsule, .. } = &model.parts[part].geometry
        {
            let placed = Poses::load(simd, &self.placed[model.parts[part].body]);
            for (end, row) in capsule.ends.iter().zip(&mut self.ends[part].value) {
                placed.point(&(*end).into()).store(row);
            }
            self.ends[part].round = self.round;
        }
        let [first, second] = &self.ends[part].value;
        [
            V3::load(simd, first.each_ref()),
            V3::load(simd, second.each_ref()),
        ]
    }
}

impl<T> InRound<T> {
    /// Rounds are counted from 1.
    fn never(value: T) -> Self {
        Self { value, round: 0 }
    }
}

/// Sums and products of a few dozen numbers are below this times themselves as computed.
pub(super) const OUTWARD: f64 = 1.0 + 64.0 * f64::EPSILON;

/// A bound that says nothing.
const UNKNOWN: [f64; LANES] = [f64::NEG_INFINITY; LANES];

#[inline(always)]
fn to_array<S: Simd>(lanes: f64x8<S>) -> [f64; LANES] {
    let mut array = [0.0; LANES];
    lanes.store_slice(&mut array);
    array
}

/// A lower bound on the distance of two segments: what separates them along the direction between the points that are found to be
/// nearest (Ericson, "Real-Time Collision Detection", 2005, section 5.1.9), nearest or not.
#[inline(always)]
fn segment_gap<S: Simd>(simd: S, a: &[V3<S>; 2], b: &[V3<S>; 2]) -> f64x8<S> {
    let zero = f64x8::splat(simd, 0.0);
    let tiny = f64x8::splat(simd, f64::MIN_POSITIVE);
    let (along_a, along_b) = (a[1].sub(&a[0]), b[1].sub(&b[0]));
    let between = a[0].sub(&b[0]);
    let (aa, bb) = (along_a.dot(&along_a), along_b.dot(&along_b));
    let (ab, ar, br) = (
        along_a.dot(&along_b),
        along_a.dot(&between),
        along_b.dot(&between),
    );
    let determinant = aa * bb - ab * ab;
    let s = within_one(simd, (ab * br - ar * bb) / determinant.max(tiny));
    let t = within_one(simd, (ab * s + br) / bb.max(tiny));
    let s = within_one(simd, (ab * t - ar) / aa.max(tiny));
    let nearest_a = a[0].add(&along_a.scaled(s));
    let nearest_b = b[0].add(&along_b.scaled(t));
    let direction = nearest_b.sub(&nearest_a);
    let length = direction.norm();
    let highest = direction.dot(&a[0]).max(direction.dot(&a[1]));
    let lowest = direction.dot(&b[0]).min(direction.dot(&b[1]));
    // Along a direction of length zero nothing is separated, and 0 / 0 is kept out.
    ((lowest - highest) / length.max(tiny)).max(zero)
}

#[inline(always)]
fn within_one<S: Simd>(simd: S, x: f64x8<S>) -> f64x8<S> {
    x.max(f64x8::splat(simd, 0.0)).min(f64x8::splat(simd, 1.0))
}

#[cfg(test)]
mod tests;

//! What balls and capsules around the parts prove, for four intervals of time at once.

use fearless_simd::{Simd, SimdBase, SimdFloat, f64x4};

use super::CollisionModel;
use super::displacement::Chain;
use super::frames::{Poses, Stored, V3};
use super::part::PartGeometry;
use crate::motion::{LANES, TubeRows};
use crate::robot::JointKind;

/// Four intervals of time: where everything is in their middles, and how far from there it can be.
pub(super) struct Four {
    /// Of the motion.
    pub rows: TubeRows,
    /// Of each body.
    pub placed: Vec<Stored>,
    /// Of each body's joint, how far it can be from where it is.
    pub turn: Vec<[f64; LANES]>,
    /// What of that is tolerance.
    pub tolerance: Vec<f64>,
    /// Of each part, the centre of its ball.
    centers: Vec<[[f64; LANES]; 3]>,
    /// Of each row, its rho by the ball, and of which round it is.
    rho: Vec<([f64; LANES], u64)>,
    round: u64,
    /// What rounding of frames does to a distance at most \[m\], with prismatic joints where they are.
    pub rounding: f64,
    /// Whether all that falls is told by the points of the shapes alone, as whoever verifies a certificate does.
    pub is_plain: bool,
    /// Of the pair at hand, of each joint between its parts, the rho of the first part and of the second.
    pub rhos: Vec<[[f64; LANES]; 2]>,
}

/// Of a pair in four intervals.
#[derive(Debug, Clone, Copy)]
pub(super) struct PairBounds {
    /// Less than this the distance cannot be anywhere in the interval \[m\].
    pub lower: [f64; LANES],
    /// From what it is in the middle it falls by no more than this \[m\]. By balls it is not told.
    pub fall: [f64; LANES],
    /// However short the interval, it falls by this \[m\]: what the tolerance of the joints is good for. By balls it is not told.
    pub rest: [f64; LANES],
}

impl Four {
    pub fn new(model: &CollisionModel) -> Self {
        let zero = [0.0; LANES];
        Self {
            rows: TubeRows::new(model.joints().len()),
            placed: vec![[zero; 12]; model.frames.bodies()],
            turn: vec![zero; model.frames.joints().len()],
            tolerance: vec![0.0; model.frames.joints().len()],
            centers: vec![[zero; 3]; model.parts.len()],
            rho: vec![(zero, 0); model.rows.len()],
            round: 0,
            rounding: model.rounding,
            is_plain: false,
            rhos: vec![[zero; 2]; model.frames.joints().len()],
        }
    }

    /// Puts all bodies where the positions say, `tolerance` \[rad, m\] a joint of the motion being added to the radii.
    #[inline(always)]
    pub fn place<S: Simd>(&mut self, simd: S, model: &CollisionModel, tolerance: &[f64]) {
        self.round += 1;
        model
            .frames
            .place_four(simd, &self.rows.position, &mut self.placed);
        let mut slid: f64 = 0.0;
        for (i, joint) in model.frames.joints().iter().enumerate() {
            let (radius, tolerance) = (&self.rows.radius[joint.index], tolerance[joint.index]);
            let size = joint.multiplier.abs() * OUTWARD;
            self.tolerance[i] = size * tolerance;
            let mut farthest: f64 = 0.0;
            let rows = self.rows.position[joint.index].iter().zip(radius);
            for (turn, (position, radius)) in self.turn[i].iter_mut().zip(rows) {
                // What the joint's own position is rounded by, multiplied and shifted.
                let position = (joint.multiplier * position).abs() + joint.offset.abs();
                *turn = size * (radius + tolerance) + 4.0 * f64::EPSILON * position;
                farthest = farthest.max(position);
            }
            if joint.kind == JointKind::Prismatic {
                slid += farthest;
            }
        }
        self.rounding = model.rounding + model.rounding_of(slid);
        for (center, part) in self.centers.iter_mut().zip(&model.parts) {
            if let PartGeometry::Convexes { ball, .. } = &part.geometry {
                let placed = Poses::load(simd, &self.placed[part.body]);
                let point = placed.point(&ball.center.into());
                for (row, number) in center.iter_mut().zip(point.0) {
                    number.store_slice(row);
                }
            }
        }
    }

    /// What the balls around its two parts say of a pair.
    #[inline(always)]
    pub fn by_balls<S: Simd>(
        &mut self,
        simd: S,
        model: &CollisionModel,
        pair: usize,
    ) -> PairBounds {
        let (a, b) = model.pairs[pair].parts;
        let PartGeometry::Convexes { ball: ball_b, .. } = &model.parts[b].geometry else {
            return PairBounds::nothing();
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
        let chain = &model.chains[pair];
        for step in &chain.steps {
            for row in [step.rows.0, Some(step.rows.1)].into_iter().flatten() {
                if self.rho[row].1 != self.round {
                    let rho = self.ball_rho(simd, model, row);
                    rho.store_slice(&mut self.rho[row].0);
                    self.rho[row].1 = self.round;
                }
            }
        }
        for (step, rhos) in chain.steps.iter().zip(&mut self.rhos) {
            let first = step.rows.0.map_or(ENDLESS, |row| self.rho[row].0);
            *rhos = [first, self.rho[step.rows.1].0];
        }
        let plain = [model.parts[a].core_radius(), model.parts[b].core_radius()];
        let girths = if self.is_plain { plain } else { [0.0; 2] };
        let fall = self.fall(simd, model, chain, girths);
        PairBounds::of(gap - (model.pairs[pair].padding + self.rounding), fall[0])
    }

    /// What the capsules around its two parts say of a pair.
    #[inline(always)]
    pub fn by_capsules<S: Simd>(
        &mut self,
        simd: S,
        model: &CollisionModel,
        pair: usize,
    ) -> PairBounds {
        let (a, b) = model.pairs[pair].parts;
        let PartGeometry::Convexes { capsule, .. } = &model.parts[b].geometry else {
            return PairBounds::nothing();
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
        let chain = &model.chains[pair];
        for (i, step) in chain.steps.iter().enumerate() {
            let second = self.capsule_rho(simd, model, b, step.joint);
            second.store_slice(&mut self.rhos[i][1]);
            self.rhos[i][0] = ENDLESS;
            if step.rows.0.is_some() {
                let first = self.capsule_rho(simd, model, a, step.joint);
                first.store_slice(&mut self.rhos[i][0]);
            }
        }
        // The shapes themselves are as far from the axes as the capsules' surfaces, but for their own margins, which are round.
        let shapes = self.fall(
            simd,
            model,
            chain,
            [model.parts[a].girth(), model.parts[b].girth()],
        );
        let axes = match self.is_plain {
            true => shapes,
            false => self.fall(simd, model, chain, [0.0; 2]),
        };
        let mut bounds = PairBounds::of(gap - (model.pairs[pair].padding + self.rounding), axes[0]);
        let fall = shapes;
        fall[0].store_slice(&mut bounds.fall);
        fall[1].store_slice(&mut bounds.rest);
        bounds
    }

    /// The least sum over the joints of a chain, those up to some joint by the first of [`rhos`](Self::rhos) and the others by the second, each
    /// with what `girths` adds to it for revolute joints: for all that the joints can turn, and for their tolerance alone.
    #[inline(always)]
    fn fall<S: Simd>(
        &self,
        simd: S,
        model: &CollisionModel,
        chain: &Chain,
        girths: [f64; 2],
    ) -> [f64x4<S>; 2] {
        let zero = f64x4::splat(simd, 0.0);
        // The sum of all by the second; what it changes when those up to a joint are by the first, and the least of that.
        let (mut sum, mut change, mut least) = ([zero; 2], [zero; 2], [zero; 2]);
        for (step, [first, second]) in chain.steps.iter().zip(&self.rhos) {
            let turn = [
                f64x4::load_array_ref(simd, &self.turn[step.joint]),
                f64x4::splat(simd, self.tolerance[step.joint]),
            ];
            let turns = match model.frames.joints()[step.joint].kind {
                JointKind::Revolute => 1.0,
                JointKind::Prismatic => 0.0,
            };
            let first = f64x4::load_array_ref(simd, first) + girths[0] * turns;
            let second = f64x4::load_array_ref(simd, second) + girths[1] * turns;
            for i in 0..2 {
                sum[i] += second * turn[i];
                change[i] += (first - second) * turn[i];
                least[i] = least[i].min(change[i]);
            }
        }
        [sum[0] * OUTWARD + least[0], sum[1] * OUTWARD + least[1]]
    }

    /// The distance of the middle of the ball around a part from a joint's axis; 1 for prismatic joints. Balls are balls however they turn, so
    /// that the gap between two falls by no more than their middles move.
    #[inline(always)]
    fn ball_rho<S: Simd>(&self, simd: S, model: &CollisionModel, row: usize) -> f64x4<S> {
        let row = &model.rows[row];
        let joint = &model.frames.joints()[row.joint];
        if joint.kind == JointKind::Prismatic {
            return f64x4::splat(simd, 1.0);
        }
        let placed = Poses::load(simd, &self.placed[joint.body]);
        let arm = self.center(simd, row.part).sub(&placed.origin);
        arm.cross(&placed.z).norm() + self.rounding
    }

    /// The distance of the farther end of the axis of the capsule around a part from a joint's axis: the gap between two capsules falls by no more
    /// than their axes move.
    #[inline(always)]
    fn capsule_rho<S: Simd>(
        &self,
        simd: S,
        model: &CollisionModel,
        part: usize,
        joint: usize,
    ) -> f64x4<S> {
        let joint = &model.frames.joints()[joint];
        if joint.kind == JointKind::Prismatic {
            return f64x4::splat(simd, 1.0);
        }
        let placed = Poses::load(simd, &self.placed[joint.body]);
        let [first, second] = self.ends(simd, model, part);
        let first = first.sub(&placed.origin).cross(&placed.z);
        let second = second.sub(&placed.origin).cross(&placed.z);
        first.dot(&first).max(second.dot(&second)).sqrt() + self.rounding
    }

    #[inline(always)]
    fn center<S: Simd>(&self, simd: S, part: usize) -> V3<S> {
        let [x, y, z] = &self.centers[part];
        V3([
            f64x4::load_array_ref(simd, x),
            f64x4::load_array_ref(simd, y),
            f64x4::load_array_ref(simd, z),
        ])
    }

    #[inline(always)]
    fn ends<S: Simd>(&self, simd: S, model: &CollisionModel, part: usize) -> [V3<S>; 2] {
        let part = &model.parts[part];
        let placed = Poses::load(simd, &self.placed[part.body]);
        match &part.geometry {
            PartGeometry::Convexes { capsule, .. } => {
                let [first, second] = &capsule.ends;
                [
                    placed.point(&(*first).into()),
                    placed.point(&(*second).into()),
                ]
            }
            PartGeometry::HalfSpace(_) => [placed.origin, placed.origin],
        }
    }
}

/// The rho of a half-space, far more than any other.
const ENDLESS: [f64; LANES] = [1e30; LANES];

/// Sums and products of a few dozen numbers are below this times themselves as computed.
pub(super) const OUTWARD: f64 = 1.0 + 64.0 * f64::EPSILON;

impl PairBounds {
    #[inline(always)]
    fn of<S: Simd>(gap: f64x4<S>, fall: f64x4<S>) -> Self {
        let mut bounds = Self::nothing();
        (gap - fall).store_slice(&mut bounds.lower);
        bounds
    }

    fn nothing() -> Self {
        Self {
            lower: [f64::NEG_INFINITY; LANES],
            fall: [f64::INFINITY; LANES],
            rest: [f64::INFINITY; LANES],
        }
    }

    /// The better of the two.
    #[inline(always)]
    pub fn and(&self, other: &Self) -> Self {
        let mut both = *self;
        for lane in 0..LANES {
            both.lower[lane] = self.lower[lane].max(other.lower[lane]);
            both.fall[lane] = self.fall[lane].min(other.fall[lane]);
            both.rest[lane] = self.rest[lane].min(other.rest[lane]);
        }
        both
    }
}

/// A lower bound on the distance of two segments: what separates them along the direction between the points that are found to be
/// nearest (Ericson, "Real-Time Collision Detection", 2005, section 5.1.9), nearest or not.
#[inline(always)]
fn segment_gap<S: Simd>(simd: S, a: &[V3<S>; 2], b: &[V3<S>; 2]) -> f64x4<S> {
    let zero = f64x4::splat(simd, 0.0);
    let tiny = f64x4::splat(simd, f64::MIN_POSITIVE);
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
fn within_one<S: Simd>(simd: S, x: f64x4<S>) -> f64x4<S> {
    x.max(f64x4::splat(simd, 0.0)).min(f64x4::splat(simd, 1.0))
}

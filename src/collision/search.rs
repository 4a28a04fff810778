//! The tree of intervals behind the certificate and the minimum clearance.

use super::CollisionModel;
use super::filter::Batch;
use super::found::{At, Found, Goal, Leaf, Stretch};
use super::frames::lane_of;
use super::part::PartGeometry;
use crate::geometry::{
    Warm, rough_separation, separation_until, separation_with, signed_distance_with,
};
use crate::motion::{LANES, Motion, Tube};
use fearless_simd::{Level, Simd, dispatch};

/// What falls by less than this \[m\] over an interval is not split any more: the answer hangs on less.
const NARROWEST: f64 = 1e-9;

/// Distances are told apart from here on \[m\]: between a distance and the plane that proves it, and between a margin and what breaks it.
const FINEST: f64 = 1e-10;

/// No more intervals are looked at; what is left is undecided.
const MOST_INTERVALS: usize = 500_000;

/// No more intervals wait for their level to be gone through.
const WIDEST: usize = 1 << 14;

/// An interval that is still to be looked at, and which of `open` are its pairs.
#[derive(Debug, Clone, Copy)]
struct Node {
    middle: f64,
    half: f64,
    pairs: (usize, usize),
    /// What its parent proved of these pairs.
    lower: f64,
}

/// Intervals that are still to be looked at.
#[derive(Debug, Default)]
struct Stack {
    nodes: Vec<Node>,
    /// Their pairs, those of the last one at the end.
    open: Vec<usize>,
    /// How many of them every node shares, at the start.
    shared: usize,
}

/// Memory for searches on one model; nothing is allocated for a search once it has grown.
pub(super) struct Search<'m> {
    model: &'m CollisionModel,
    batch: Batch,
    /// Of each pair of convex shapes, the direction that separated them last.
    warm: Vec<Warm>,
    pieces: Vec<(f64, f64)>,
    level: Stack,
    /// Of the halves of what is looked at, while levels are gone through one after the other.
    next: Stack,
    /// Of each pair, in which intervals of the batch it is open, as bits.
    lanes: Vec<u8>,
    /// Of each interval, what is left open.
    left: [Vec<usize>; LANES],
    /// Looks at pairs with the scene alone, or at pairs of links alone; at all when `None`.
    pub with_scene: Option<bool>,
}

impl<'m> Search<'m> {
    pub fn new(model: &'m CollisionModel) -> Self {
        Self {
            model,
            batch: Batch::new(model),
            warm: vec![Warm::default(); model.convex_pairs()],
            pieces: Vec::new(),
            level: Stack::default(),
            next: Stack::default(),
            lanes: vec![0; model.pairs.len()],
            left: std::array::from_fn(|_| Vec::new()),
            with_scene: None,
        }
    }

    /// Searches a motion of the robot's joints; `tolerance` \[rad, m\] a joint is added to how far they may be from it.
    pub fn run<M: Motion>(
        &mut self,
        motion: &M,
        goal: Goal,
        tolerance: &[f64],
        keep: bool,
    ) -> Found {
        let mut tube = motion.tube();
        self.pieces.clear();
        tube.pieces(&mut self.pieces);
        self.start(&mut tube, goal, tolerance, keep)
    }

    /// [`run`](Self::run) over one interval of a motion alone: its middle and half width \[s\].
    pub fn run_within<T: Tube>(
        &mut self,
        tube: &mut T,
        piece: (f64, f64),
        goal: Goal,
        tolerance: &[f64],
    ) -> Found {
        self.pieces.clear();
        self.pieces.push(piece);
        self.start(tube, goal, tolerance, false)
    }

    fn start<T: Tube>(&mut self, tube: &mut T, goal: Goal, tolerance: &[f64], keep: bool) -> Found {
        // So that a search gives the same whatever was searched before.
        self.warm.fill(Warm::default());
        self.level.clear();
        self.next.clear();
        // A refutation leaves these as they were.
        self.lanes.fill(0);
        self.left.iter_mut().for_each(Vec::clear);
        let mut found = Found::new(goal, keep);
        self.batch.is_plain = keep;
        let model = self.model;
        let is_asked = |pair: &&usize| {
            let with_scene = model.pairs[**pair].parts.0 < model.scene;
            self.with_scene.is_none_or(|asked| asked == with_scene)
        };
        let all = model.checked.iter().filter(is_asked);
        self.level.open.extend(all);
        let count = self.level.open.len();
        if count == 0 {
            return found;
        }
        self.level.shared = count;
        if matches!(goal, Goal::Least(_)) {
            scatter(&mut self.pieces);
        }
        for (middle, half) in self.pieces.iter().rev() {
            self.level.nodes.push(Node {
                middle: *middle,
                half: *half,
                pairs: (0, count),
                lower: f64::NEG_INFINITY,
            });
        }
        dispatch!(Level::new(), simd => self.search(simd, tube, tolerance, &mut found));
        found
    }

    #[inline(always)]
    fn search<S: Simd, T: Tube>(
        &mut self,
        simd: S,
        tube: &mut T,
        tolerance: &[f64],
        found: &mut Found,
    ) {
        let model = self.model;
        loop {
            if self.level.nodes.is_empty() {
                std::mem::swap(&mut self.level, &mut self.next);
                self.next.clear();
            }
            if self.level.nodes.is_empty() {
                return;
            }
            let (nodes, count) = self.take(found);
            if count == 0 {
                continue;
            }
            found.work.intervals += count;
            if found.work.intervals > MOST_INTERVALS {
                for (lane, node) in nodes[..count].iter().enumerate() {
                    let open = self.lanes.iter().position(|l| l >> lane & 1 == 1);
                    let pair = open.unwrap_or(model.checked[0]);
                    found.give_up((node.middle, node.half), node.lower, pair);
                }
                self.lanes.fill(0);
                continue;
            }
            let middle = nodes.map(|n| n.middle);
            let half = nodes.map(|n| n.half);
            tube.over_lanes(&middle, &half, &mut self.batch.rows);
            self.batch.place(simd, model, tolerance);
            let mut lower = [f64::INFINITY; LANES];
            if let Some(leaves) = &mut found.leaves {
                for node in &nodes[..count] {
                    leaves.push(Leaf {
                        middle: node.middle,
                        half: node.half,
                        pairs: Vec::new(),
                    });
                }
            }
            for pair in 0..self.lanes.len() {
                let lanes = std::mem::take(&mut self.lanes[pair]);
                if lanes == 0 {
                    continue;
                }
                let balls = self.batch.by_balls(simd, model, pair, (found.bar(), lanes));
                let mut open = found.settle(&balls, lanes, pair, &middle, count);
                if open == 0 {
                    continue;
                }
                let capsules = self.batch.by_capsules(simd, model, pair);
                open = found.settle(&capsules, open, pair, &middle, count);
                if open == 0 {
                    continue;
                }
                let falls = self.batch.falls(simd, model, pair);
                for lane in 0..LANES {
                    if open >> lane & 1 == 0 {
                        continue;
                    }
                    let at = At {
                        distance: 0.0,
                        pair,
                        time: middle[lane],
                    };
                    let known = balls[lane].max(capsules[lane]);
                    let falls = [falls.fall[lane], falls.rest[lane]];
                    match self.narrow(simd, known, falls, (lane, half[lane]), at, found) {
                        Narrowed::Proven => found.keep(lane, count, pair),
                        Narrowed::Open(least) => {
                            lower[lane] = lower[lane].min(least);
                            self.left[lane].push(pair);
                        }
                        Narrowed::Undecided => found.undecided.push(Stretch {
                            from: middle[lane] - half[lane],
                            to: middle[lane] + half[lane],
                            pair,
                        }),
                        Narrowed::Refuted => return,
                    }
                }
            }
            for lane in (0..count).rev() {
                self.split(&nodes[lane], lane, lower[lane], found);
            }
        }
    }

    /// Up to a batch of nodes off the stack, as many as are; the others repeat the last. Marks their pairs.
    #[inline(always)]
    fn take(&mut self, found: &mut Found) -> ([Node; LANES], usize) {
        let level = &mut self.level;
        let mut nodes = [level.nodes[level.nodes.len() - 1]; LANES];
        let mut count = 0;
        let bar = found.bar();
        let mut start = level.open.len();
        while count < LANES
            && let Some(node) = level.nodes.pop()
        {
            start = node.pairs.0;
            let pairs = &level.open[node.pairs.0..node.pairs.1];
            // What was found since may be below all that the parent left open.
            if node.lower > bar {
                found.proven(At {
                    distance: node.lower,
                    pair: pairs[0],
                    time: node.middle,
                });
                continue;
            }
            for pair in pairs {
                self.lanes[*pair] |= 1 << count;
            }
            nodes[count..].fill(node);
            count += 1;
        }
        level.open.truncate(start.max(level.shared));
        (nodes, count)
    }

    /// Looks at the shapes themselves, in the middle of an interval.
    #[inline(always)]
    fn narrow<S: Simd>(
        &mut self,
        simd: S,
        known: f64,
        [fall, rest]: [f64; 2],
        (lane, half): (usize, f64),
        at: At,
        found: &mut Found,
    ) -> Narrowed {
        let model = self.model;
        let pair = &model.pairs[at.pair];
        // What is kept apart by more than this is proven.
        let bar = found.bar();
        let needed = bar + fall + pair.padding + self.batch.rounding;
        let (a, b) = (&model.parts[pair.parts.0], &model.parts[pair.parts.1]);
        let placed_b = lane_of(&self.batch.placed[b.body], lane);
        let PartGeometry::Convexes { convexes, .. } = &b.geometry else {
            return Narrowed::Undecided;
        };
        // Lower bounds over the interval, upper ones in its middle. A tree that is kept holds what falls by the sum over joints alone.
        let (mut lower, mut upper) = (f64::INFINITY, f64::INFINITY);
        let is_plain = self.batch.is_plain;
        match &a.geometry {
            PartGeometry::HalfSpace(half_space) => {
                for convex in convexes {
                    found.work.distances += 1;
                    let between = half_space.separation_with(simd, convex.at(&placed_b));
                    lower = least_proven(lower, between.lower - fall);
                    upper = upper.min(between.upper);
                }
            }
            PartGeometry::Convexes {
                convexes: others, ..
            } => {
                let placed_a = lane_of(&self.batch.placed[a.body], lane);
                let first = model.first_convex_pair[at.pair];
                let combinations = others
                    .iter()
                    .flat_map(|other| convexes.iter().map(move |c| (other, c)));
                for (i, (other, convex)) in combinations.enumerate() {
                    let (placed_a, placed_b) = (other.at(&placed_a), convex.at(&placed_b));
                    let warm = &mut self.warm[first + i];
                    if others.len() * convexes.len() > 1 {
                        let gap = rough_separation(placed_a, placed_b, warm, needed);
                        if gap > needed {
                            lower = least_proven(lower, gap - fall);
                            continue;
                        }
                    }
                    found.work.distances += 1;
                    // What cannot be the least is not measured more closely than it takes to tell how far it falls.
                    let (beyond, near) = found.of_no_use(pair.padding);
                    let between =
                        separation_until(simd, placed_a, placed_b, warm, needed, |lower, upper| {
                            lower > needed
                                || match found.goal {
                                    Goal::Above(_) => upper <= needed,
                                    Goal::Least(_) => lower > beyond && upper - lower <= near,
                                }
                        });
                    let (mut below, mut above) = (between.lower, between.upper);
                    let margins = other.margin() + convex.margin();
                    if matches!(found.goal, Goal::Least(_)) && above <= FINEST - margins {
                        above = signed_distance_with(simd, placed_a, placed_b, warm).distance;
                        // By the plane that this ended with.
                        below =
                            separation_with(simd, placed_a, placed_b, warm, above - FINEST).lower;
                    }
                    let mut least = below - fall;
                    if below <= needed
                        && !is_plain
                        && let Some(direction) = warm.direction(placed_a.placement)
                    {
                        let bends = self.batch.bends(model, at.pair, lane, half);
                        least = least.max(bends.separation(simd, placed_a, placed_b, &direction));
                    }
                    lower = least_proven(lower, least);
                    upper = upper.min(above);
                }
            }
        }
        let least = lower - pair.padding - self.batch.rounding;
        let least = least.max(known);
        if least > bar {
            found.proven(At {
                distance: least,
                ..at
            });
            return Narrowed::Proven;
        }
        let upper = upper - pair.padding;
        let witness = At {
            distance: upper,
            ..at
        };
        match found.goal {
            Goal::Above(margin) if upper <= margin + FINEST => {
                found.upper = Some(witness);
                return Narrowed::Refuted;
            }
            // However narrow the interval, the tolerance alone leaves it open.
            Goal::Above(margin) if upper - rest <= margin || fall - rest < NARROWEST => {
                return Narrowed::Undecided;
            }
            Goal::Above(_) => {}
            Goal::Least(_) => {
                if found.upper.is_none_or(|best| upper < best.distance) {
                    found.upper = Some(witness);
                }
                if least > found.bar() || fall < NARROWEST {
                    found.proven(At {
                        distance: least,
                        ..at
                    });
                    return Narrowed::Proven;
                }
            }
        }
        Narrowed::Open(least)
    }

    /// Puts the two halves of a node on the stack, with the pairs that are left of it.
    #[inline(always)]
    fn split(&mut self, node: &Node, lane: usize, lower: f64, found: &mut Found) {
        let Some(first) = self.left[lane].first() else {
            return;
        };
        let half = node.half / 2.0;
        // No time lies between: what moves by much there has left all numbers.
        if node.middle + half == node.middle {
            found.give_up((node.middle, node.half), node.lower, *first);
            self.left[lane].clear();
            return;
        }
        // The least distance is nearly known when a level has been gone through; only then is it split.
        let is_by_level = matches!(found.goal, Goal::Least(_)) && self.next.nodes.len() < WIDEST;
        let stack = if is_by_level {
            &mut self.next
        } else {
            &mut self.level
        };
        for middle in [node.middle + half, node.middle - half] {
            let start = stack.open.len();
            stack.open.extend_from_slice(&self.left[lane]);
            stack.nodes.push(Node {
                middle,
                half,
                pairs: (start, stack.open.len()),
                lower,
            });
        }
        self.left[lane].clear();
    }
}

impl Stack {
    fn clear(&mut self) {
        self.nodes.clear();
        self.open.clear();
        self.shared = 0;
    }
}

/// Every eighth piece first, then those between: what is near to the least distance is found soon, and all else is measured against it.
fn scatter(pieces: &mut Vec<(f64, f64)>) {
    const STRIDE: usize = 8;
    let scattered =
        (0..STRIDE).flat_map(|start| pieces.iter().copied().skip(start).step_by(STRIDE));
    *pieces = scattered.collect();
}

/// The lesser of two lower bounds; what is no number is no proof.
fn least_proven(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        f64::NEG_INFINITY
    } else {
        a.min(b)
    }
}

/// What became of a pair on an interval.
enum Narrowed {
    Proven,
    /// With this lower bound.
    Open(f64),
    Undecided,
    Refuted,
}

//! The clearance on samples as [`Dense`] finds it, but parry is not asked where no answer could matter.
//!
//! Conservative advancement (Mirtich, "Impulse-based dynamic simulation of rigid body systems", 1996), from sample to sample:
//! a pair at a distance need not be asked again until its joints have turned far enough to use that distance up.

use undulate::{CollisionModel, Derivative, JointKind, PeriodGrid, Robot, Wave, stream};

use crate::dense::{Dense, Pair, Part, distance};
use crate::robots::robots;
use crate::waves::random_wave;
use crate::{HARMONICS, PERIOD, RATE, ROUNDING, grid};

/// Far above what parry's distances and sums of angles are wrong by \[m\].
const SLACK: f64 = 1e-6;

pub struct Advancement<'d> {
    dense: &'d Dense,
    grid: PeriodGrid,
    /// Of each pair, the entries of q that move it, each with the most by which it changes the distance \[m/rad\].
    levers: Vec<Vec<(usize, f64)>>,
}

impl<'d> Advancement<'d> {
    /// On the samples of `grid`.
    pub fn new(robot: &Robot, dense: &'d Dense, grid: PeriodGrid) -> Self {
        Self {
            dense,
            grid,
            levers: dense.pairs.iter().map(|p| levers(robot, p)).collect(),
        }
    }

    /// The smallest distance on the samples, 0 where something touches; `bound` where none is smaller.
    pub fn clearance(&self, robot: &Robot, wave: &Wave, bound: f64) -> f64 {
        let q = wave.on_grid(&self.grid, Derivative::Position);
        let mut least = bound;
        // Of each pair, the sample at which it was asked last, and its distance there.
        let mut asked = vec![(0, f64::NEG_INFINITY); self.levers.len()];
        for n in 0..q.nrows() {
            let mut poses = None;
            for (pair, asked) in asked.iter_mut().enumerate() {
                let moved: f64 = self.levers[pair]
                    .iter()
                    .map(|(joint, lever)| lever * (q[(n, *joint)] - q[(asked.0, *joint)]).abs())
                    .sum();
                if asked.1 - moved - SLACK > least {
                    continue;
                }
                let poses = poses.get_or_insert_with(|| {
                    let q: Vec<f64> = q.row(n).iter().copied().collect();
                    Dense::poses(robot, &q)
                });
                *asked = (n, distance(&self.dense.pairs[pair], poses, f64::INFINITY));
                least = least.min(asked.1);
            }
        }
        least
    }
}

/// The joints between the two parts of a pair, each with the farthest that a point of one part can be from its axis.
///
/// That of the nearer part: it is the same whether this part turns about the axis or the other one turns back. Nothing is
/// farther from the axis than the lengths of the links on the way, added up, and the part's own reach; so it is for every
/// configuration, and turning joint after joint moves the part by no more than the arcs, added up.
fn levers(robot: &Robot, [a, b]: &Pair) -> Vec<(usize, f64)> {
    let (up, down) = (chain(robot, a), chain(robot, b));
    let shared = up.iter().zip(&down).take_while(|(i, j)| i == j).count();
    let joint = |body: &usize| robot.bodies()[*body].joint.as_ref().expect("it moves");
    let length = |body: &usize| joint(body).origin.translation.vector.norm();
    // From the first part's frame to the frame of each body on the way; the last is the second part's.
    let mut way = 0.0;
    let mut on_way = Vec::new();
    for body in up[shared..].iter().rev() {
        on_way.push((body, way));
        way += length(body);
    }
    for body in &down[shared..] {
        way += length(body);
        on_way.push((body, way));
    }
    let (reach_a, reach_b) = (reach(a), reach(b));
    let lever = |(body, from_a): (&usize, f64)| {
        let joint = joint(body);
        assert_eq!(joint.kind, JointKind::Revolute, "slides lengthen the way");
        let farthest = (from_a + reach_a).min(way - from_a + reach_b);
        (joint.index, joint.multiplier.abs() * farthest)
    };
    on_way.into_iter().map(lever).collect()
}

/// The bodies that move a part, the base left out, its own the last.
fn chain(robot: &Robot, part: &Part) -> Vec<usize> {
    let mut chain = Vec::new();
    let mut body = part[0].body;
    while body != 0 {
        chain.push(body);
        body = robot.bodies()[body].parent;
    }
    chain.reverse();
    chain
}

/// The farthest that a point of a part is from the origin of its body \[m\].
fn reach(part: &Part) -> f64 {
    part.iter()
        .map(|solid| solid.pose.transform_point(solid.sphere.center).length() + solid.sphere.radius)
        .fold(0.0, f64::max)
}

#[test]
fn advancing_finds_what_every_sample_says() {
    let mut missed = 0;
    for (name, robot, options, some) in robots() {
        let model = CollisionModel::new(&robot, &options).unwrap();
        let dense = Dense::new(&robot, &model);
        let advancement = Advancement::new(&robot, &dense, grid());
        // A twin that is broken on purpose.
        let mut halved = Advancement::new(&robot, &dense, grid());
        for (_, lever) in halved.levers.iter_mut().flatten() {
            *lever /= 2.0;
        }
        for number in 0..some / 10 {
            let wave = random_wave(&robot, HARMONICS, PERIOD, 0.6, &mut stream(3, number));
            let every = dense.clearance(&robot, &wave, RATE, f64::NEG_INFINITY);
            for bound in [f64::INFINITY, every + SLACK, every - SLACK] {
                let found = advancement.clearance(&robot, &wave, bound);
                assert!(
                    (found - every.min(bound)).abs() < ROUNDING,
                    "{name} {number}: {found} with the bound {bound}, every sample says {every}"
                );
            }
            let found = halved.clearance(&robot, &wave, f64::INFINITY);
            missed += usize::from(found > every + ROUNDING);
        }
    }
    assert!(missed > 0);
}

#[test]
fn no_lever_is_too_short_and_half_of_it_would_be() {
    /// Of one joint \[rad\].
    const TURN: f64 = 0.01;
    for (name, robot, options, _) in robots() {
        let model = CollisionModel::new(&robot, &options).unwrap();
        let dense = Dense::new(&robot, &model);
        let advancement = Advancement::new(&robot, &dense, grid());
        // Of what a lever allows.
        let mut most: f64 = 0.0;
        for number in 0..4000 {
            let posture = random_wave(&robot, 0, PERIOD, 0.0, &mut stream(4, number));
            let mut q = posture.offsets().as_slice().to_vec();
            let here = Dense::poses(&robot, &q);
            for (pair, levers) in dense.pairs.iter().zip(&advancement.levers) {
                let before = distance(pair, &here, f64::INFINITY);
                for (joint, lever) in levers {
                    q[*joint] += TURN;
                    let after = distance(pair, &Dense::poses(&robot, &q), f64::INFINITY);
                    q[*joint] -= TURN;
                    most = most.max(((after - before).abs() - ROUNDING) / (lever * TURN));
                }
            }
        }
        assert!(0.5 < most && most <= 1.0, "{name}: {most}");
    }
}

//! What is said of an interval against the shapes within it.

use fearless_simd::{Level, dispatch};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

use super::*;
use crate::collision::filter::Falls;
use crate::collision::{CollisionOptions, PartGeometry};
use crate::geometry::{Placement, Warm, signed_distance};
use crate::motion::LANES;
use crate::robot::Robot;

/// Times within an interval, ends included.
const TIMES: i32 = 20;
/// A bound and a distance are rounded otherwise \[m\].
const ROUNDING: f64 = 1e-9;

const BALL: &str = r#"<sphere radius="0.1"/>"#;
/// Wide, so that the distance is that of a plane: stretched towards it, an arm makes the bound of second order tight.
const WALL: &str = r#"<box size="0.2 30 1"/>"#;

/// A ball at the end of an arm in a plane, and something at its foot. The last joint follows the one before it, so many times as fast.
fn arm(foot: &str, multiplier: f64) -> CollisionModel {
    let solid = |geometry: &str| {
        format!(r#"<collision><origin xyz="1 0 0"/><geometry>{geometry}</geometry></collision>"#)
    };
    let joint = |name: &str, parent: &str, child: &str, more: &str| {
        format!(
            r#"<joint name="{name}" type="continuous"><parent link="{parent}"/><child link="{child}"/>
            <origin xyz="1 0 0"/><axis xyz="0 0 1"/>{more}</joint>"#
        )
    };
    let robot = Robot::from_urdf(&format!(
        r#"<robot name="arm"><link name="foot">{}</link><link name="one"/><link name="two"/><link name="three">{}</link>{}{}{}</robot>"#,
        solid(foot),
        solid(BALL),
        joint("a", "foot", "one", ""),
        joint("b", "one", "two", ""),
        joint("c", "two", "three", &format!(r#"<mimic joint="b" multiplier="{multiplier}"/>"#)),
    ))
    .unwrap();
    CollisionModel::new(&robot, &CollisionOptions::default()).unwrap()
}

/// The distance of the only pair at a posture, and the direction of its plane.
fn measured(model: &CollisionModel, q: &[f64]) -> (f64, Vector3<f64>) {
    let mut placed = vec![Placement::identity(); model.frames.bodies()];
    model.frames.place(q, &mut placed);
    let (a, b) = model.pairs[0].parts;
    let convex = |part: usize| match &model.parts[part].geometry {
        PartGeometry::Convexes { convexes, .. } => convexes[0].at(&placed[model.parts[part].body]),
        PartGeometry::HalfSpace(_) => unreachable!("there is no scene"),
    };
    let mut warm = Warm::default();
    let distance = signed_distance(convex(a), convex(b), &mut warm).distance;
    let direction = warm.direction(&placed[model.parts[a].body]);
    (distance, direction.expect("it has been measured"))
}

#[test]
fn no_bound_is_above_what_is_within_the_interval() {
    for multiplier in [3.0, -3.0] {
        bounds_hold(&arm(BALL, multiplier), 3.0);
        let tightest = bounds_hold(&arm(WALL, multiplier), 0.3);
        assert!(tightest < 0.05, "{tightest}");
    }
}

/// Of postures with the first joint so far from straight at most. By how much the bound of second order was nearest below the least that was seen,
/// as a share of the time squared.
fn bounds_hold(model: &CollisionModel, most: f64) -> f64 {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mut tightest = f64::INFINITY;
    for _ in 0..2000 {
        let mut random = |size: f64| size * (2.0 * rng.random::<f64>() - 1.0);
        let (middle, velocity) = ([random(most), random(0.3)], [random(1.0), random(1.0)]);
        let half = random(0.4).abs() + 1e-3;
        let mut batch = Batch::new(model);
        for joint in 0..2 {
            batch.rows.position[joint] = [middle[joint]; LANES];
            batch.rows.velocity[joint] = [velocity[joint]; LANES];
            batch.rows.radius[joint] = [velocity[joint].abs() * half; LANES];
        }
        let (there, direction) = measured(model, &middle);
        let bounds = dispatch!(Level::new(), simd => {
            batch.place(simd, model, &[0.0; 2]);
            let balls = batch.by_balls(simd, model, 0, (f64::INFINITY, u8::MAX))[0];
            let capsules = batch.by_capsules(simd, model, 0)[0];
            let Falls { fall, .. } = batch.falls(simd, model, 0);
            let bends = batch.bends(model, 0, 0, half);
            let [a, b] = [model.pairs[0].parts.0, model.pairs[0].parts.1].map(|part| &model.parts[part]);
            let placed = [a, b].map(|part| lane_of(&batch.placed[part.body], 0));
            let convex = |i: usize| match &[a, b][i].geometry {
                PartGeometry::Convexes { convexes, .. } => convexes[0].at(&placed[i]),
                PartGeometry::HalfSpace(_) => unreachable!("there is no scene"),
            };
            let second = bends.separation(simd, convex(0), convex(1), &direction);
            [balls, capsules, there - fall[0], second]
        });
        let least = (-TIMES..=TIMES)
            .map(|n| {
                let time = half * f64::from(n) / f64::from(TIMES);
                let q = [0, 1].map(|joint| middle[joint] + velocity[joint] * time);
                measured(model, &q).0
            })
            .fold(f64::INFINITY, f64::min);
        for (bound, name) in bounds.iter().zip(["balls", "capsules", "falls", "bends"]) {
            assert!(
                *bound <= least + ROUNDING,
                "{name}: {bound}, and {least} at {middle:?}, {velocity:?}, {half}"
            );
        }
        tightest = tightest.min((least - bounds[3]) / half.powi(2));
    }
    tightest
}

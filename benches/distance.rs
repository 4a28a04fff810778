//! Distance of hulls like those of an arm's links: ours warm and cold, beside parry's in the same run.

use std::hint::black_box;

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use parry3d::math::{Pose, Rotation, Vector};
use parry3d::query;
use parry3d::shape::SharedShape;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use undulate::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use undulate::{Convex, Placed, Placement, Warm, intersects, separation, signed_distance};

/// Vertices of the convex hulls of a UR5's collision meshes: from 72 to 220.
const VERTICES: [usize; 4] = [72, 120, 170, 220];

/// Two hulls, and poses of the second on a way past the first, each a little on from the last.
struct Pair {
    convex: [Convex; 2],
    parry: [SharedShape; 2],
    poses: Vec<(Placement, Pose)>,
}

/// Points on an ellipsoid of a link's proportions: every one of them is a vertex.
fn points(random: &mut ChaCha8Rng, count: usize) -> Vec<Point3<f64>> {
    (0..count)
        .map(|_| {
            loop {
                let p = Vector3::from_fn(|_, _| random.random_range(-1.0..1.0));
                if (0.1..1.0).contains(&p.norm()) {
                    let p: Vector3<f64> = p.normalize();
                    return Point3::new(0.06 * p.x, 0.06 * p.y, 0.25 * p.z);
                }
            }
        })
        .collect()
}

/// `gap` \[m\] between the ellipsoids at the nearest; negative when they overlap.
fn pairs(gap: f64) -> Vec<Pair> {
    let mut random = ChaCha8Rng::seed_from_u64(4);
    VERTICES
        .iter()
        .map(|count| {
            let points = [0, 1].map(|_| points(&mut random, *count));
            let convex = [0, 1].map(|i| Convex::from_points(&points[i], 0.0).unwrap());
            let parry = [0, 1].map(|i| {
                let points: Vec<_> = points[i]
                    .iter()
                    .map(|p| Vector::new(p.x, p.y, p.z))
                    .collect();
                SharedShape::convex_hull(&points).unwrap()
            });
            let poses = (0..64)
                .map(|step| {
                    let share = f64::from(step) / 64.0;
                    let turn = UnitQuaternion::from_euler_angles(0.1, 0.2 * share, share);
                    let at = Vector3::new(0.12 + gap + 0.05 * share, 0.02 * share, 0.05 * share);
                    let pose = Isometry3::from_parts(at.into(), turn);
                    let q = turn.coords;
                    let parry = Pose::from_parts(
                        Vector::new(at.x, at.y, at.z),
                        Rotation::from_xyzw(q.x, q.y, q.z, q.w),
                    );
                    (Placement::from(&pose), parry)
                })
                .collect();
            Pair {
                convex,
                parry,
                poses,
            }
        })
        .collect()
}

/// Times `ours` over all pairs and poses; a time is that of all 256 queries.
fn each(
    criterion: &mut Criterion,
    name: &str,
    pairs: &[Pair],
    is_warm: bool,
    ours: impl Fn(Placed, Placed, &mut Warm) -> f64,
) {
    let home = Placement::identity();
    criterion.bench_function(name, |bench| {
        bench.iter_batched_ref(
            || vec![Warm::default(); pairs.len()],
            |warm| {
                let mut sum = 0.0;
                for (pair, warm) in pairs.iter().zip(warm) {
                    let [a, b] = &pair.convex;
                    for (placement, _) in &pair.poses {
                        if !is_warm {
                            *warm = Warm::default();
                        }
                        sum += ours(a.at(&home), b.at(black_box(placement)), warm);
                    }
                }
                sum
            },
            BatchSize::SmallInput,
        );
    });
}

fn parry(criterion: &mut Criterion, name: &str, pairs: &[Pair], of: impl Fn(&Pair, &Pose) -> f64) {
    criterion.bench_function(name, |bench| {
        bench.iter(|| {
            let mut sum = 0.0;
            for pair in pairs {
                for (_, pose) in &pair.poses {
                    sum += of(pair, black_box(pose));
                }
            }
            sum
        });
    });
}

fn distance(criterion: &mut Criterion) {
    let home = Pose::IDENTITY;
    for (name, gap) in [("apart", 0.03), ("deep", -0.05)] {
        let pairs = pairs(gap);
        let named = |what: &str| format!("{name}: {what}, 256 queries");
        if gap > 0.0 {
            each(
                criterion,
                &named("warm separation"),
                &pairs,
                true,
                |a, b, warm| separation(a, b, warm, 0.0).lower,
            );
        }
        each(
            criterion,
            &named("warm intersects"),
            &pairs,
            true,
            |a, b, warm| f64::from(u8::from(intersects(a, b, warm))),
        );
        each(
            criterion,
            &named("warm signed distance"),
            &pairs,
            true,
            |a, b, warm| signed_distance(a, b, warm).distance,
        );
        each(
            criterion,
            &named("cold signed distance"),
            &pairs,
            false,
            |a, b, warm| signed_distance(a, b, warm).distance,
        );
        parry(criterion, &named("parry distance"), &pairs, |pair, pose| {
            let [a, b] = &pair.parry;
            query::distance(&home, &**a, pose, &**b).map_or(f64::NAN, |d| d.distance)
        });
        parry(criterion, &named("parry contact"), &pairs, |pair, pose| {
            let [a, b] = &pair.parry;
            query::contact(&home, &**a, pose, &**b, 1.0)
                .ok()
                .flatten()
                .map_or(f64::NAN, |c| c.dist)
        });
        parry(
            criterion,
            &named("parry intersects"),
            &pairs,
            |pair, pose| {
                let [a, b] = &pair.parry;
                query::intersection_test(&home, &**a, pose, &**b)
                    .map_or(f64::NAN, |i| f64::from(u8::from(i.intersecting)))
            },
        );
    }
}

criterion_group!(benches, distance);
criterion_main!(benches);

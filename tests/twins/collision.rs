//! Distances, pairs and certificates.

use std::f64::consts::{PI, TAU};

use nalgebra::{DMatrix, DVector, Matrix3, Point3, Rotation3, Vector3};
use num_complex::Complex;
use proptest::prelude::*;
use undulate::testing::{arms, keeps_clear};
use undulate::{
    CollisionModel, CollisionOptions, Convex, HalfSpace, Placement, Robot, Shape, Wave,
};

use crate::halved::Halved;
use crate::{Twin, Verdict, for_all, near};

pub const TWINS: [Twin; 7] = [
    ("a certificate with its bound halved", |broken| {
        proves(0.0, |model, wave| match broken {
            true => keeps_clear(model, &Halved(wave.clone()), 0.0).is_ok(),
            false => keeps_clear(model, wave, 0.0).is_ok(),
        })
    }),
    ("a tolerance ignored", |broken| {
        proves(OFF, |model, wave| {
            let tolerance: &[f64] = if broken { &[] } else { &[OFF; 2] };
            model.certify(wave, 0.0, tolerance).unwrap().is_clear()
        })
    }),
    ("a support that misses a corner", |broken| {
        boxes(|half, turn| {
            corners(half, turn)
                .skip(usize::from(broken))
                .fold(f64::MAX, f64::min)
        })
    }),
    ("half an extent for an extent", |broken| {
        boxes(|half, turn| {
            let half = half * if broken { 0.5 } else { 1.0 };
            corners(&half, turn).fold(f64::MAX, f64::min)
        })
    }),
    ("a pose applied backwards", |broken| {
        boxes(|half, turn| {
            let turn = if broken { turn.transpose() } else { *turn };
            corners(half, &turn).fold(f64::MAX, f64::min)
        })
    }),
    ("a radius that is added", |broken| {
        let sign = if broken { 1.0 } else { -1.0 };
        for_all((0.1..0.5f64, -2.0..2.0f64), |(radius, z)| {
            let found = z + sign * radius;
            near(
                "a distance",
                found,
                above(&Shape::Sphere { radius }, &Matrix3::identity(), z),
            )
        })
    }),
    ("neighbours of neighbours left out", |broken| {
        for_all(arms(2..=5), |arm| {
            let model = CollisionModel::new(arm.robot(), &CollisionOptions::default())?;
            let checked = model
                .pairs()
                .iter()
                .filter(|pair| pair.is_checked())
                .count();
            // Of a chain of links with a shape each.
            let apart = if broken { 3 } else { 2 };
            let links = arm.joints().len() + 1;
            let pairs = (0..links).flat_map(|a| (a + apart..links).map(move |b| (a, b)));
            near("pairs", pairs.count() as f64, checked as f64)
        })
    }),
];

/// How far a shape that is turned, at a height, is above the plane z = 0, as the library has it.
fn above(shape: &Shape, turn: &Matrix3<f64>, height: f64) -> f64 {
    let convex = Convex::new(shape, &nalgebra::Isometry3::identity()).unwrap();
    let placement = Placement {
        rotation: *turn,
        translation: Vector3::z() * height,
    };
    let floor = HalfSpace::new(Vector3::z(), 0.0).unwrap();
    floor.signed_distance(convex.at(&placement)).distance
}

/// Heights of a box's corners.
fn corners(half: &Vector3<f64>, turn: &Matrix3<f64>) -> impl Iterator<Item = f64> {
    let (half, turn) = (*half, *turn);
    (0..8).map(move |corner| {
        let sign = |axis: usize| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 };
        let corner = Vector3::from_fn(|axis, _| sign(axis) * half[axis]);
        (turn * Point3::from(corner)).z
    })
}

/// The height of the lowest corner of a box about the origin, as the library has it.
fn boxes(lowest: impl Fn(&Vector3<f64>, &Matrix3<f64>) -> f64) -> Verdict {
    let extents = prop::array::uniform3(0.1..0.9f64).prop_map(Vector3::from);
    for_all(
        (extents, prop::array::uniform3(-PI..PI)),
        |(half, [r, p, y])| {
            let turn = Rotation3::from_euler_angles(r, p, y).into_inner();
            let shape = Shape::Box { half_extents: half };
            near(
                "a distance",
                lowest(&half, &turn),
                above(&shape, &turn, 0.0),
            )
        },
    )
}

/// Of two thin balls on arms of 1 m about one post, that are off by an angle \[rad\]: where it is proven that they keep clear, they do not meet. They do when
/// the angle between the arms passes 0.
fn proves(off: f64, is_clear: impl Fn(&CollisionModel, &Wave) -> bool) -> Verdict {
    let arm = |name: &str| {
        format!(
            r#"<link name="{name}"><collision><origin xyz="1 0 0"/><geometry><sphere radius="0.005"/></geometry></collision></link>
            <joint name="{name}_joint" type="continuous"><parent link="post"/><child link="{name}"/><axis xyz="0 0 1"/></joint>"#
        )
    };
    let arms = arm("one") + &arm("two");
    let robot = Robot::from_urdf(&format!(
        r#"<robot name="post"><link name="post"/>{arms}</robot>"#
    ))
    .unwrap();
    let model = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
    // Three harmonics that swing the second arm about an angle, whose sum nearly reaches the first.
    let modulus = || prop::array::uniform3(0.05..0.25f64);
    let phase = || prop::array::uniform3(-PI..PI);
    for_all(
        (0.3..1.2f64, modulus(), phase()),
        |(offset, moduli, phases)| {
            let weights = DMatrix::from_fn(2, 3, |joint, k| {
                Complex::from_polar(moduli[k], phases[k]) * joint as f64
            });
            let offsets = DVector::from_vec(vec![0.0, offset]);
            let wave = Wave::new(robot.joints().clone(), TAU, offsets, weights)?;
            let angles = (0..1000).map(|n| wave.position(TAU * f64::from(n) / 1000.0)[1]);
            let meets = angles.fold(f64::MAX, f64::min) < 2.0 * off;
            let is_wrong = meets && is_clear(&model, &wave);
            prop_assert!(!is_wrong, "proven clear, and they meet");
            Ok(())
        },
    )
}

/// By which joints are off \[rad\].
const OFF: f64 = 0.05;

//! The hulls of a UR5's collision meshes, as Coal sees them.

use std::fs;

use serde_json::Value;
use undulate::nalgebra::Point3;
use undulate::{Convex, Hull, Mesh, Placement, Robot, Warm, separation, signed_distance};

use crate::EXACT;
use crate::common::shared;

/// Coal stops when its distance is no more than this above the least \[m\], its default.
const COAL: f64 = 1e-6;

fn numbers(value: &Value) -> Vec<f64> {
    let array = value.as_array().unwrap();
    array.iter().map(|x| x.as_f64().unwrap()).collect()
}

/// How far `p` is above the highest of the faces under it.
fn outside(hull: &Hull, p: &Point3<f64>) -> f64 {
    let vertices = hull.vertices();
    let above = hull.faces().iter().map(|face| {
        let [q, r, s] = face.map(|i| vertices[i as usize]);
        (r - q).cross(&(s - q)).normalize().dot(&(p - q))
    });
    above.fold(f64::NEG_INFINITY, f64::max)
}

#[test]
fn coal_agrees_on_the_hulls_of_a_ur5() {
    let Some(folder) = shared("Coal's distances of a UR5's hulls") else {
        return;
    };
    let text = fs::read_to_string(folder.join("oracle/ur5_hull_distances.json")).unwrap();
    let oracle: Value = serde_json::from_str(&text).unwrap();
    let robots = folder.join("robots/ur5");
    let robot = Robot::open(&robots.join("ur5_robot.urdf")).unwrap();
    let meshes = robots.join("example-robot-data/robots/ur_description/meshes/ur5/collision");
    let link = |name: &str| {
        let file = name.trim_end_matches("_link").replace('_', "") + ".stl";
        let mesh = Mesh::from_stl(&fs::read(meshes.join(file)).unwrap()).unwrap();
        let hull = mesh.hull().unwrap();
        let convex = Convex::from_points(hull.vertices(), 0.0).unwrap();
        let index = robot.links().iter().position(|l| l.name == name).unwrap();
        (index, convex, hull)
    };
    let pairs: Vec<_> = oracle["pairs"]
        .as_array()
        .unwrap()
        .iter()
        .map(|pair| [0, 1].map(|i| link(pair[i].as_str().unwrap())))
        .collect();
    let mut warm = vec![Warm::default(); pairs.len()];
    let (mut apart, mut early, mut overlapping) = (0, 0, 0);
    for case in oracle["cases"].as_array().unwrap() {
        let poses = robot.link_poses(&numbers(&case["q"]));
        let expected = numbers(&case["signed_distance_m"]);
        assert_eq!(expected.len(), pairs.len());
        for ((pair, warm), expected) in pairs.iter().zip(&mut warm).zip(expected) {
            let [at_a, at_b] = [0, 1].map(|i| Placement::from(&poses[pair[i].0]));
            let (a, b) = (pair[0].1.at(&at_a), pair[1].1.at(&at_b));
            let cold = signed_distance(a, b, &mut Warm::default());
            let found = signed_distance(a, b, warm);
            let distance = found.distance;
            assert!((cold.distance - distance).abs() < EXACT);
            assert_eq!(distance > 0.0, expected > 0.0, "{distance:e} {expected:e}");
            if expected <= 0.0 {
                overlapping += 1;
                assert!(
                    (distance - expected).abs() < COAL,
                    "{distance:e} {expected:e}"
                );
                continue;
            }
            apart += 1;
            if (distance - expected).abs() < EXACT {
                continue;
            }
            // Then Coal is the one that has stopped early: a plane and two points of the hulls prove the distance.
            early += 1;
            assert!(
                (0.0..COAL).contains(&(expected - distance)),
                "{distance:e} {expected:e}"
            );
            assert!(separation(a, b, warm, distance - EXACT).lower > distance - EXACT);
            assert!(((found.points[1] - found.points[0]).norm() - distance).abs() < EXACT);
            for i in 0..2 {
                let own = poses[pair[i].0].inverse_transform_point(&found.points[i]);
                assert!(outside(&pair[i].2, &own) < EXACT);
            }
        }
    }
    println!(
        "{apart} pairs apart, in {early} of which Coal stopped early, {overlapping} overlapping"
    );
    assert!(apart > 4000 && early < apart / 10 && overlapping > 150);
}

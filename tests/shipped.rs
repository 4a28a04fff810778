//! The robots that come with the crate: rest, mirror images, inertias, and that they wave as the person did.

use std::collections::BTreeSet;

use nalgebra::{Isometry3, Matrix3, Vector3};
use rand::distr::Distribution;
use undulate::{
    CollisionModel, CollisionOptions, FourierMovementPrimitive, JointMap, Robot, Shape, Solid,
    Verdict, Wave, shipped, stream, synthetic,
};

/// What every robot keeps between its links at rest \[m\].
const REST_CLEARANCE: f64 = 0.01;

/// What is proven between links of a robot that waves \[m\].
const MARGIN: f64 = 0.005;

/// Waves of the synthetic demonstrator.
fn waves(count: u64) -> Vec<Wave> {
    let primitive = FourierMovementPrimitive::learn(&synthetic(0).unwrap(), 25).unwrap();
    (0..count)
        .map(|k| primitive.sample(&mut stream(7, k)))
        .collect()
}

fn demonstrator(robot: &str) -> JointMap {
    shipped::map(&format!("{robot}_demonstrator")).unwrap()
}

#[test]
fn every_robot_is_whole_and_rests_clear_of_itself() {
    for name in shipped::robots() {
        let robot = shipped::robot(name).unwrap();
        assert!(robot.notes().is_empty(), "{name}: {:?}", robot.notes());
        robot.require_dynamics().unwrap();
        for j in 0..robot.joints().len() {
            let joint = robot.properties(j);
            assert!(
                joint.position.is_some() && joint.velocity.is_some() && joint.effort.is_some(),
                "{name} joint {j}"
            );
        }
        for body in robot.bodies() {
            assert!(
                !body.collision.is_empty() && !body.visual.is_empty(),
                "{name} {}",
                body.name
            );
        }
        let collision = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
        let nearest = collision.clearance(&robot.rest()).unwrap();
        assert!(nearest.distance > REST_CLEARANCE, "{name}: {nearest:?}");
    }
}

#[test]
fn every_robot_has_maps_for_both_kinds_of_recordings() {
    let maps: BTreeSet<&str> = shipped::maps().collect();
    for name in shipped::robots() {
        for kind in ["demonstrator", "human"] {
            assert!(
                maps.contains(format!("{name}_{kind}").as_str()),
                "{name}_{kind}"
            );
        }
    }
    assert_eq!(maps.len(), 2 * shipped::robots().count());
}

/// Most draws can be executed: limits of position and speed, and a proof that links keep their distance throughout.
#[test]
fn most_waves_of_the_demonstrator_pass_on_every_robot() {
    let waves = waves(20);
    for name in shipped::robots() {
        let robot = shipped::robot(name).unwrap();
        let collision = CollisionModel::new(&robot, &CollisionOptions::default()).unwrap();
        let map = demonstrator(name);
        let passed = waves
            .iter()
            .filter(|wave| {
                let wave = map.apply(wave, &robot).unwrap();
                let verdict = Verdict::of(&robot, &collision, &wave, MARGIN).unwrap();
                if !verdict.passes() {
                    println!("{name}: {verdict:?}");
                }
                verdict.passes()
            })
            .count();
        assert!(passed >= 18, "{name}: {passed} of {}", waves.len());
    }
}

/// The plane between left and right.
fn mirror() -> Matrix3<f64> {
    Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, 1.0))
}

/// What is to be the mirror image of a pose: a reflected rotation, reflected back in its own frame.
fn mirrored(pose: &Isometry3<f64>) -> (Vector3<f64>, Matrix3<f64>) {
    let rotation = pose.rotation.to_rotation_matrix().into_inner();
    (
        mirror() * pose.translation.vector,
        mirror() * rotation * mirror(),
    )
}

#[test]
fn the_left_arm_is_the_right_arm_in_a_mirror() {
    let (right, left) = (
        shipped::robot("wave_arm").unwrap(),
        shipped::robot("wave_arm_left").unwrap(),
    );
    assert_eq!(right.joints(), left.joints());
    let collisions = [&right, &left]
        .map(|robot| CollisionModel::new(robot, &CollisionOptions::default()).unwrap());
    for kind in ["demonstrator", "human"] {
        let maps = ["wave_arm", "wave_arm_left"]
            .map(|robot| shipped::map(&format!("{robot}_{kind}")).unwrap());
        for wave in waves(5) {
            let wave = if kind == "human" {
                with_still_joints(&wave)
            } else {
                wave
            };
            let [r, l] = [(&maps[0], &right), (&maps[1], &left)]
                .map(|(map, robot)| map.apply(&wave, robot).unwrap());
            for t in [0.0, 0.31, 2.7, 5.9] {
                let (q_r, q_l) = (r.position(t), l.position(t));
                let poses = right.link_poses(q_r.as_slice());
                for ((link, pose), image) in right
                    .links()
                    .iter()
                    .zip(poses)
                    .zip(left.link_poses(q_l.as_slice()))
                {
                    let (origin, rotation) = mirrored(&pose);
                    let found = image.rotation.to_rotation_matrix().into_inner();
                    assert!(
                        (image.translation.vector - origin).norm() < 1e-14,
                        "{}",
                        link.name
                    );
                    assert!((found - rotation).amax() < 1e-14, "{}", link.name);
                }
                let [near, image] = [(&collisions[0], &q_r), (&collisions[1], &q_l)]
                    .map(|(c, q)| c.clearance(q.as_slice()).unwrap().distance);
                assert!((near - image).abs() < 1e-9, "{near} {image}");
            }
        }
    }
    for (r, l) in right.bodies().iter().zip(left.bodies()) {
        let (r, l) = (r.inertial.as_ref().unwrap(), l.inertial.as_ref().unwrap());
        assert_eq!((r.mass, mirror() * r.center), (l.mass, l.center));
        assert!((mirror() * r.inertia * mirror() - l.inertia).amax() < 1e-15);
    }
    for j in 0..right.joints().len() {
        let (r, l) = (right.properties(j), left.properties(j));
        assert_eq!(
            (r.velocity, r.effort, r.damping),
            (l.velocity, l.effort, l.damping)
        );
        let (r, l) = (r.position.unwrap(), l.position.unwrap());
        let axis = left.joint(j).axis;
        let image = if axis.y == 0.0 {
            (-r.upper, -r.lower)
        } else {
            (r.lower, r.upper)
        };
        assert_eq!((l.lower, l.upper), image, "joint {j}");
    }
}

/// A person's wave with the joints that the demonstrator lacks, held at an angle that shows.
fn with_still_joints(wave: &Wave) -> Wave {
    let names = wave
        .joints()
        .iter()
        .cloned()
        .chain(["forearm_pronation".into(), "wrist_flexion".into()]);
    let mut offsets = wave.offsets().clone();
    offsets = offsets.insert_rows(5, 2, 0.2);
    let weights = wave.weights().clone().insert_rows(5, 2, 0.0.into());
    Wave::new(
        undulate::Joints::new(names).unwrap(),
        wave.period(),
        offsets,
        weights,
    )
    .unwrap()
}

/// The palm goes to the left when the person's does (or its mirror image to the right), and farther than forward or up.
#[test]
fn hands_swing_from_side_to_side_with_the_person() {
    let wave = &waves(1)[0];
    let person = shipped::robot("wave_arm").unwrap();
    let palms = |robot: &Robot, map: &JointMap| -> Vec<Vector3<f64>> {
        let wave = map.apply(wave, robot).unwrap();
        let palm = robot.links().iter().position(|l| l.name == "palm").unwrap();
        (0..400)
            .map(|n| {
                let q = wave.position(wave.period() * f64::from(n) / 400.0);
                robot.link_poses(q.as_slice())[palm].translation.vector
            })
            .collect()
    };
    let reference = palms(&person, &demonstrator("wave_arm"));
    for name in shipped::robots() {
        let robot = shipped::robot(name).unwrap();
        let found = palms(&robot, &demonstrator(name));
        let side = if name == "wave_arm_left" { -1.0 } else { 1.0 };
        let agreement = correlation(
            &reference.iter().map(|p| p.y).collect::<Vec<_>>(),
            &found.iter().map(|p| side * p.y).collect::<Vec<_>>(),
        );
        let spread = |axis: usize| {
            let values = found.iter().map(|p| p[axis]);
            values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
        };
        println!(
            "{name}: {agreement:.3}, swings {:.3} {:.3} {:.3} m",
            spread(0),
            spread(1),
            spread(2)
        );
        assert!(agreement > 0.9, "{name}: {agreement}");
        assert!(
            spread(1) > 1.5 * spread(0).max(spread(2)),
            "{name} does not swing sideways"
        );
    }
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    let (ma, mb) = (mean(a), mean(b));
    let dot = |x: &[f64], mx: f64, y: &[f64], my: f64| -> f64 {
        x.iter().zip(y).map(|(x, y)| (x - mx) * (y - my)).sum()
    };
    dot(a, ma, b, mb) / (dot(a, ma, a, ma) * dot(b, mb, b, mb)).sqrt()
}

/// Volume, centre and second moment about it, of a solid of density one.
fn moments(solid: &Solid) -> (f64, Vector3<f64>, Matrix3<f64>) {
    let diagonal = |x: f64, y: f64, z: f64| Matrix3::from_diagonal(&Vector3::new(x, y, z));
    let (volume, center, inertia) = match &solid.shape {
        Shape::Box { half_extents: h } => {
            let volume = 8.0 * h.x * h.y * h.z;
            let [x, y, z] = [h.x * h.x, h.y * h.y, h.z * h.z].map(|s| s * volume / 3.0);
            (volume, Vector3::zeros(), diagonal(y + z, x + z, x + y))
        }
        Shape::Sphere { radius } => {
            let volume = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
            let i = 0.4 * volume * radius * radius;
            (volume, Vector3::zeros(), diagonal(i, i, i))
        }
        Shape::Cylinder { radius, length } => {
            let volume = std::f64::consts::PI * radius * radius * length;
            let across = volume * (3.0 * radius * radius + length * length) / 12.0;
            (
                volume,
                Vector3::zeros(),
                diagonal(across, across, volume * radius * radius / 2.0),
            )
        }
        Shape::Hull(hull) => {
            let (mut volume, mut first, mut second) = (0.0, Vector3::zeros(), Matrix3::zeros());
            for face in hull.faces() {
                let [a, b, c] = face.map(|i| hull.vertices()[i as usize].coords);
                let v = a.dot(&b.cross(&c)) / 6.0;
                let sum = a + b + c;
                volume += v;
                first += sum * (v / 4.0);
                let outer = |x: Vector3<f64>| x * x.transpose();
                second += (outer(a) + outer(b) + outer(c) + outer(sum)) * (v / 20.0);
            }
            let center = first / volume;
            second -= center * center.transpose() * volume;
            (
                volume,
                center,
                Matrix3::from_diagonal_element(second.trace()) - second,
            )
        }
        other => panic!("{other:?}: no shipped robot has one"),
    };
    let rotation = solid.pose.rotation.to_rotation_matrix().into_inner();
    let center = (solid.pose * nalgebra::Point3::from(center)).coords;
    (volume, center, rotation * inertia * rotation.transpose())
}

/// Each body that moves has the inertia of its collision shapes, of one density.
#[test]
fn inertias_are_those_of_the_shapes() {
    for name in shipped::robots() {
        let robot = shipped::robot(name).unwrap();
        for body in &robot.bodies()[1..] {
            let parts: Vec<_> = body.collision.iter().map(moments).collect();
            let volume: f64 = parts.iter().map(|p| p.0).sum();
            let center = parts.iter().map(|p| p.1 * p.0).sum::<Vector3<f64>>() / volume;
            let inertia: Matrix3<f64> = parts
                .iter()
                .map(|(v, c, i)| {
                    let d = c - center;
                    i + (Matrix3::identity() * d.norm_squared() - d * d.transpose()) * *v
                })
                .sum();
            let told = body.inertial.as_ref().unwrap();
            let density = told.mass / volume;
            println!("{name} {}: {density:.0} kg/m^3", body.name);
            assert!(
                (300.0..3000.0).contains(&density),
                "{name} {}: {density}",
                body.name
            );
            assert!((told.center - center).norm() < 1e-9, "{name} {}", body.name);
            let error = (told.inertia - inertia * density).amax();
            assert!(
                error < 1e-9 * told.inertia.trace(),
                "{name} {}: {error:e}",
                body.name
            );
        }
    }
}

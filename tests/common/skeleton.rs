//! A skeleton that moves by known angles, as BVH text: the convention of the angles written once more, and forwards.

// Every test file takes what it needs of these.
#![allow(dead_code)]

use std::f64::consts::{FRAC_PI_2, TAU};
use std::fmt::Write;

use nalgebra::{Matrix3, Rotation3, Vector3};
use undulate::Side;
use undulate::rand::{Rng, RngExt};

/// Of each of the seven angles where it waves about, how far, and from which phase: offset, amplitude, phase \[rad\].
pub type Waves = [[f64; 3]; 7];

pub const FRAMES: usize = 40;
pub const RATE: f64 = 40.0;

/// The angles of one arm in a frame: a cycle in all.
pub fn angles(waves: &Waves, frame: usize) -> [f64; 7] {
    let t = frame as f64 / FRAMES as f64;
    waves.map(|[offset, amplitude, phase]| offset + amplitude * (TAU * t + phase).sin())
}

/// Any that stay within a quarter turn where they must, of the order whose angle in the middle is `middle`, with an elbow that is bent.
pub fn random_waves<R: Rng>(rng: &mut R, middle: usize) -> Waves {
    let mut wave = |low: f64, high: f64, amplitude: f64| {
        [
            rng.random_range(low..high),
            rng.random_range(0.0..amplitude),
            rng.random_range(0.0..TAU),
        ]
    };
    let mut waves = [
        wave(-2.0, 2.0, 0.5),
        wave(-2.0, 2.0, 0.5),
        wave(-2.0, 2.0, 0.5),
        wave(0.8, 1.8, 0.6),
        wave(-1.5, 1.5, 0.5),
        wave(-0.7, 0.7, 0.4),
        wave(-1.0, 1.0, 0.5),
    ];
    waves[middle] = wave(-0.9, 0.9, 0.4);
    waves
}

fn about(axis: usize, angle: f64) -> Matrix3<f64> {
    let axis = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()][axis];
    *Rotation3::from_axis_angle(&axis, angle).matrix()
}

/// Humerus, forearm and hand in the thorax, of a right arm or of the left one that mirrors it.
pub fn segments(angles: [f64; 7], zxy: bool, side: Side) -> [Matrix3<f64>; 3] {
    let [
        flexion,
        abduction,
        rotation,
        elbow,
        pronation,
        bend,
        deviation,
    ] = angles;
    let (x, z) = (about(0, -flexion), about(2, -abduction));
    let humerus = if zxy { z * x } else { x * z } * about(1, rotation);
    let forearm = humerus * about(0, -elbow);
    let hand = forearm * about(1, pronation) * about(2, bend) * about(0, -deviation);
    let mirror = match side {
        Side::Right => Matrix3::identity(),
        Side::Left => Matrix3::from_diagonal(&Vector3::new(-1.0, 1.0, 1.0)),
    };
    [humerus, forearm, hand].map(|rotation| mirror * rotation * mirror)
}

/// What of a skeleton differs from one file to another.
pub struct Skeleton {
    /// Thorax, then of each side upper arm, forearm, hand and fingers: right, left.
    pub thorax: &'static str,
    pub arms: [[&'static str; 4]; 2],
    /// Left, up and forward of the T-pose in the own axes of thorax, and of each arm.
    pub thorax_axes: Matrix3<f64>,
    pub arm_axes: [Matrix3<f64>; 2],
    /// Three axes for each bone in turn, as channels.
    pub channels: Vec<[usize; 3]>,
    /// By how much the axes of the elbows are rolled about the upper arms' bones \[rad\].
    pub roll: f64,
}

impl Skeleton {
    pub fn mixamo() -> Self {
        Self {
            thorax: "mixamorig:Spine2",
            arms: [
                [
                    "mixamorig:RightArm",
                    "mixamorig:RightForeArm",
                    "mixamorig:RightHand",
                    "mixamorig:RightHandMiddle1",
                ],
                [
                    "mixamorig:LeftArm",
                    "mixamorig:LeftForeArm",
                    "mixamorig:LeftHand",
                    "mixamorig:LeftHandMiddle1",
                ],
            ],
            thorax_axes: Matrix3::identity(),
            arm_axes: [Matrix3::identity(); 2],
            channels: vec![[2, 0, 1]],
            roll: 0.0,
        }
    }

    /// The text of a file in which both arms move so; the trunk moves as it likes.
    pub fn text(&self, waves: [&Waves; 2], zxy: bool) -> String {
        let bones = self.bones();
        let mut text = String::from("HIERARCHY\n");
        for (i, bone) in bones.iter().enumerate() {
            let kind = if bone.parent.is_some() {
                "JOINT"
            } else {
                "ROOT"
            };
            // What was opened since the parent, and holds this one no more.
            let depth = |mut i: usize| {
                let mut depth = 0;
                while let Some(parent) = bones[i].parent {
                    (i, depth) = (parent, depth + 1);
                }
                depth
            };
            if i > 0 {
                let open = depth(i - 1) + 1;
                (depth(i)..open).for_each(|_| text.push_str("}\n"));
            }
            let [x, y, z] = bone.offset.into();
            let channels = self
                .channels(i)
                .map(|axis| format!("{}rotation", ["X", "Y", "Z"][axis]))
                .join(" ");
            let channels = match bone.parent {
                Some(_) => format!("3 {channels}"),
                None => format!("6 Xposition Yposition Zposition {channels}"),
            };
            write!(
                text,
                "{kind} {}\n{{\n\tOFFSET {x} {y} {z}\n\tCHANNELS {channels}\n",
                bone.name
            )
            .unwrap();
            if i + 1 == bones.len() || bones[i + 1].parent != Some(i) {
                text.push_str("\tEnd Site\n\t{\n\t\tOFFSET 0 0 0\n\t}\n");
            }
            if i + 1 == bones.len() {
                (0..=depth(i)).for_each(|_| text.push_str("}\n"));
            }
        }
        write!(
            text,
            "MOTION\nFrames: {FRAMES}\nFrame Time: {}\n",
            1.0 / RATE
        )
        .unwrap();
        for frame in 0..FRAMES {
            let turned = self.turned(frame, waves, zxy);
            let mut row = vec![0.1 * frame as f64, 1.0, -2.0];
            for (i, bone) in bones.iter().enumerate() {
                let local = match bone.parent {
                    Some(parent) => turned[parent].transpose() * turned[i],
                    None => turned[i],
                };
                row.extend(euler(&local, self.channels(i)).map(f64::to_degrees));
            }
            let row: Vec<String> = row.iter().map(f64::to_string).collect();
            text.push_str(&row.join(" "));
            text.push('\n');
        }
        text
    }

    fn channels(&self, bone: usize) -> [usize; 3] {
        self.channels[bone % self.channels.len()]
    }

    fn bones(&self) -> Vec<Bone> {
        let mut bones = vec![
            Bone::new("Root", None, Vector3::zeros()),
            Bone::new(self.thorax, Some(0), Vector3::new(0.0, 0.4, 0.0)),
        ];
        for (side, names, axes) in [
            (-1.0, self.arms[0], self.arm_axes[0]),
            (1.0, self.arms[1], self.arm_axes[1]),
        ] {
            let out = |length: f64| Vector3::new(side * length, 0.0, 0.0);
            let first = bones.len();
            bones.push(Bone::new(
                names[0],
                Some(1),
                self.thorax_axes * (out(0.2) + Vector3::new(0.0, 0.1, 0.0)),
            ));
            for (i, length) in [(1, 0.28), (2, 0.25), (3, 0.1)] {
                bones.push(Bone::new(names[i], Some(first + i - 1), axes * out(length)));
            }
        }
        bones
    }

    /// Where each bone is turned to.
    fn turned(&self, frame: usize, waves: [&Waves; 2], zxy: bool) -> Vec<Matrix3<f64>> {
        let trunk = trunk(frame);
        let mut turned = vec![about(1, 2.0), trunk * self.thorax_axes.transpose()];
        for (i, side) in Side::ALL.into_iter().enumerate() {
            let sign = [-1.0, 1.0][i];
            // An arm that hangs, seen from one in the T-pose.
            let raise = about(2, -sign * FRAC_PI_2).transpose();
            let [humerus, forearm, hand] = segments(angles(waves[i], frame), zxy, side);
            let back = raise.transpose() * self.arm_axes[i].transpose();
            let rolled = humerus * about(1, sign * self.roll);
            // A bone of the forearm has of its twist what it likes.
            let twisted = forearm * about(1, 0.3 * (frame as f64).cos());
            let bones = [rolled, twisted, hand, hand].map(|segment| trunk * segment * back);
            turned.extend(bones);
        }
        turned
    }
}

/// How the trunk is turned.
pub fn trunk(frame: usize) -> Matrix3<f64> {
    let t = frame as f64 / FRAMES as f64;
    about(1, 0.7 + t) * about(0, 0.2 * (TAU * t).sin()) * about(2, -0.3 * t)
}

struct Bone {
    name: &'static str,
    parent: Option<usize>,
    offset: Vector3<f64>,
}

impl Bone {
    fn new(name: &'static str, parent: Option<usize>, offset: Vector3<f64>) -> Self {
        Self {
            name,
            parent,
            offset,
        }
    }
}

/// The angles about three axes, each about what those before have turned, whose product is a rotation.
fn euler(r: &Matrix3<f64>, [i, j, k]: [usize; 3]) -> [f64; 3] {
    let sign = if (i + 1) % 3 == j { 1.0 } else { -1.0 };
    [
        (-sign * r[(j, k)]).atan2(r[(k, k)]),
        (sign * r[(i, k)]).clamp(-1.0, 1.0).asin(),
        (-sign * r[(i, j)]).atan2(r[(i, i)]),
    ]
}

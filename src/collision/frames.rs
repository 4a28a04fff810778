//! Forward kinematics in frames whose z axes are the joints' axes, for one configuration or several at once.

use fearless_simd::{Simd, SimdBase, SimdFloat, f64x8};
use nalgebra::{Isometry3, Matrix3, UnitQuaternion, Vector3};

use crate::elementary;
use crate::geometry::Placement;
use crate::motion::LANES;
use crate::robot::{JointKind, Robot};

/// Rotation (columns) and origin of a body in the base frame, in several configurations.
#[derive(Debug, Clone, Copy)]
pub(super) struct Poses<S: Simd> {
    pub x: V3<S>,
    pub y: V3<S>,
    pub z: V3<S>,
    pub origin: V3<S>,
}

/// A vector in several configurations.
#[derive(Debug, Clone, Copy)]
pub(super) struct V3<S: Simd>(pub [f64x8<S>; 3]);

/// Twelve numbers of several configurations: the columns of the rotation, then the origin.
pub(super) type Stored = [[f64; LANES]; 12];

/// The tree of bodies. A body's frame is turned so that its z axis is the axis of its joint: then every revolute joint turns
/// two columns of a rotation matrix, whatever its axis.
#[derive(Debug, Clone)]
pub(super) struct Frames {
    joints: Vec<FrameJoint>,
    /// Of each body, from its frame in the robot to the one used here.
    turns: Vec<UnitQuaternion<f64>>,
    reach: f64,
}

/// The joint of a body.
#[derive(Debug, Clone)]
pub(super) struct FrameJoint {
    pub body: usize,
    pub parent: usize,
    pub kind: JointKind,
    /// Entry of q, and the joint's position multiplier * q + offset.
    pub index: usize,
    pub multiplier: f64,
    pub offset: f64,
    /// The frame at position 0 in the parent's.
    pub rotation: Matrix3<f64>,
    pub translation: Vector3<f64>,
}

impl Frames {
    pub fn new(robot: &Robot) -> Self {
        let turns: Vec<UnitQuaternion<f64>> = robot
            .bodies()
            .iter()
            .map(|body| {
                body.joint
                    .as_ref()
                    .map_or_else(UnitQuaternion::identity, |j| aligned(&j.axis))
            })
            .collect();
        let joints = robot
            .moving()
            .map(|(body, joint)| {
                let parent = robot.bodies()[body].parent;
                let origin =
                    isometry(turns[parent].inverse()) * joint.origin * isometry(turns[body]);
                FrameJoint {
                    body,
                    parent,
                    kind: joint.kind,
                    index: joint.index,
                    multiplier: joint.multiplier,
                    offset: joint.offset,
                    rotation: origin.rotation.to_rotation_matrix().into_inner(),
                    translation: origin.translation.vector,
                }
            })
            .collect();
        let lengths = robot
            .moving()
            .map(|(_, joint)| joint.origin.translation.vector.norm());
        let reach = lengths.sum();
        Self {
            joints,
            turns,
            reach,
        }
    }

    /// The joint of each body but the base, parents first: that of body i is number i - 1.
    pub fn joints(&self) -> &[FrameJoint] {
        &self.joints
    }

    pub fn bodies(&self) -> usize {
        self.turns.len()
    }

    /// Takes coordinates in the frame that a body has in the robot to the frame used here.
    pub fn frame_of(&self, body: usize) -> Isometry3<f64> {
        isometry(self.turns[body].inverse())
    }

    /// The sum of all lengths between joints \[m\], prismatic joints at 0: with what these slide besides, no origin is farther from the base.
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// The frames of all bodies at configuration `q`.
    pub fn place(&self, q: &[f64], placed: &mut [Placement]) {
        placed[0] = Placement::identity();
        for joint in &self.joints {
            let position = joint.multiplier * q[joint.index] + joint.offset;
            let parent = &placed[joint.parent];
            let mut rotation = parent.rotation * joint.rotation;
            let mut translation = parent.translation + parent.rotation * joint.translation;
            match joint.kind {
                JointKind::Revolute => {
                    let (sin, cos) = libm::sincos(position);
                    let (x, y) = (
                        rotation.column(0).into_owned(),
                        rotation.column(1).into_owned(),
                    );
                    rotation.set_column(0, &(x * cos + y * sin));
                    rotation.set_column(1, &(y * cos - x * sin));
                }
                JointKind::Prismatic => translation += rotation.column(2) * position,
            }
            placed[joint.body] = Placement {
                rotation,
                translation,
            };
        }
    }

    /// The frames of all bodies at several configurations, one row of `q` a joint.
    #[inline(always)]
    pub fn place_lanes<S: Simd>(&self, simd: S, q: &[[f64; LANES]], placed: &mut [Stored]) {
        let unit = |i: usize| {
            [
                f64::from(u8::from(i == 0)),
                f64::from(u8::from(i == 1)),
                f64::from(u8::from(i == 2)),
            ]
        };
        let base = Poses {
            x: V3::splat(simd, &unit(0)),
            y: V3::splat(simd, &unit(1)),
            z: V3::splat(simd, &unit(2)),
            origin: V3::splat(simd, &[0.0; 3]),
        };
        base.store(&mut placed[0]);
        for joint in &self.joints {
            let parent = Poses::load(simd, &placed[joint.parent]);
            let r = &joint.rotation;
            let mut x = parent.turned(&[r.m11, r.m21, r.m31]);
            let mut y = parent.turned(&[r.m12, r.m22, r.m32]);
            let z = parent.turned(&[r.m13, r.m23, r.m33]);
            let t = &joint.translation;
            let mut origin = parent.origin.add(&parent.turned(&[t.x, t.y, t.z]));
            let mut position = [0.0; LANES];
            for (position, q) in position.iter_mut().zip(&q[joint.index]) {
                *position = joint.multiplier * q + joint.offset;
            }
            match joint.kind {
                JointKind::Revolute => {
                    let (sin, cos) = sin_cos_lanes(&position);
                    let sin = f64x8::load_array_ref(simd, &sin);
                    let cos = f64x8::load_array_ref(simd, &cos);
                    (x, y) = (
                        x.scaled(cos).add(&y.scaled(sin)),
                        y.scaled(cos).sub(&x.scaled(sin)),
                    );
                }
                JointKind::Prismatic => {
                    origin = origin.add(&z.scaled(f64x8::load_array_ref(simd, &position)));
                }
            }
            Poses { x, y, z, origin }.store(&mut placed[joint.body]);
        }
    }
}

fn isometry(turn: UnitQuaternion<f64>) -> Isometry3<f64> {
    Isometry3::from_parts(Vector3::zeros().into(), turn)
}

/// The rotation that takes z to `axis`.
fn aligned(axis: &Vector3<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::rotation_between(&Vector3::z(), axis)
        // Opposite: half a turn about x.
        .unwrap_or_else(|| {
            UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
        })
}

fn sin_cos(x: f64) -> (f64, f64) {
    if x.abs() <= elementary::LARGEST {
        elementary::sin_cos(x)
    } else {
        libm::sincos(x)
    }
}

#[inline(always)]
fn sin_cos_lanes(x: &[f64; LANES]) -> ([f64; LANES], [f64; LANES]) {
    let (mut sin, mut cos) = ([0.0; LANES], [0.0; LANES]);
    for lane in 0..LANES {
        (sin[lane], cos[lane]) = elementary::sin_cos(x[lane]);
    }
    // Many turns are rare, and no reason for a branch in every lane.
    if x.iter().any(|x| x.abs() > elementary::LARGEST) {
        for lane in 0..LANES {
            (sin[lane], cos[lane]) = sin_cos(x[lane]);
        }
    }
    (sin, cos)
}

/// One of several configurations.
pub(super) fn lane_of(stored: &Stored, lane: usize) -> Placement {
    let at = |i: usize| stored[i][lane];
    Placement {
        rotation: Matrix3::new(
            at(0),
            at(3),
            at(6),
            at(1),
            at(4),
            at(7),
            at(2),
            at(5),
            at(8),
        ),
        translation: Vector3::new(at(9), at(10), at(11)),
    }
}

impl<S: Simd> Poses<S> {
    #[inline(always)]
    pub fn load(simd: S, stored: &Stored) -> Self {
        let [xx, xy, xz, yx, yy, yz, zx, zy, zz, ox, oy, oz] = stored;
        Self {
            x: V3::load(simd, [xx, xy, xz]),
            y: V3::load(simd, [yx, yy, yz]),
            z: V3::load(simd, [zx, zy, zz]),
            origin: V3::load(simd, [ox, oy, oz]),
        }
    }

    #[inline(always)]
    fn store(&self, stored: &mut Stored) {
        let columns = [&self.x, &self.y, &self.z, &self.origin];
        for (rows, column) in stored.chunks_exact_mut(3).zip(columns) {
            for (row, number) in rows.iter_mut().zip(&column.0) {
                number.store_slice(row);
            }
        }
    }

    /// A constant vector of the body's frame in the base's.
    #[inline(always)]
    fn turned(&self, v: &[f64; 3]) -> V3<S> {
        V3([self.row(0, v), self.row(1, v), self.row(2, v)])
    }

    // A closure would not always be inlined, and vectors pass between functions by way of memory.
    #[inline(always)]
    fn row(&self, i: usize, v: &[f64; 3]) -> f64x8<S> {
        self.x.0[i] * v[0] + self.y.0[i] * v[1] + self.z.0[i] * v[2]
    }

    /// A constant point of the body's frame in the base's.
    #[inline(always)]
    pub fn point(&self, p: &[f64; 3]) -> V3<S> {
        self.origin.add(&self.turned(p))
    }
}

impl<S: Simd> V3<S> {
    #[inline(always)]
    pub fn load(simd: S, [x, y, z]: [&[f64; LANES]; 3]) -> Self {
        Self([
            f64x8::load_array_ref(simd, x),
            f64x8::load_array_ref(simd, y),
            f64x8::load_array_ref(simd, z),
        ])
    }

    #[inline(always)]
    pub fn store(&self, rows: &mut [[f64; LANES]; 3]) {
        for (row, number) in rows.iter_mut().zip(&self.0) {
            number.store_slice(row);
        }
    }

    #[inline(always)]
    pub fn splat(simd: S, v: &[f64; 3]) -> Self {
        Self([
            f64x8::splat(simd, v[0]),
            f64x8::splat(simd, v[1]),
            f64x8::splat(simd, v[2]),
        ])
    }

    #[inline(always)]
    pub fn add(&self, o: &Self) -> Self {
        let ([a, b, c], [d, e, f]) = (self.0, o.0);
        Self([a + d, b + e, c + f])
    }

    #[inline(always)]
    pub fn sub(&self, o: &Self) -> Self {
        let ([a, b, c], [d, e, f]) = (self.0, o.0);
        Self([a - d, b - e, c - f])
    }

    #[inline(always)]
    pub fn scaled(&self, s: f64x8<S>) -> Self {
        let [a, b, c] = self.0;
        Self([a * s, b * s, c * s])
    }

    #[inline(always)]
    pub fn dot(&self, o: &Self) -> f64x8<S> {
        let ([a, b, c], [d, e, f]) = (self.0, o.0);
        a * d + b * e + c * f
    }

    #[inline(always)]
    pub fn cross(&self, o: &Self) -> Self {
        let ([a, b, c], [d, e, f]) = (self.0, o.0);
        Self([b * f - c * e, c * d - a * f, a * e - b * d])
    }

    #[inline(always)]
    pub fn norm(&self) -> f64x8<S> {
        self.dot(self).sqrt()
    }
}

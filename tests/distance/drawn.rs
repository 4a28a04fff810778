//! Shapes and poses at random, and what each shape is by its own formula.

use std::f64::consts::FRAC_PI_2;

use parry3d::math::{Pose, Rotation, Vector};
use parry3d::shape::SharedShape;
use proptest::collection::vec;
use proptest::prelude::*;
use undulate::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use undulate::{Convex, Placement, Shape};

pub type V = Vector3<f64>;

/// A shape about its own origin.
#[derive(Debug, Clone)]
pub enum Drawn {
    Box(V),
    /// The hull of these.
    Points(Vec<V>),
    Sphere(f64),
    /// Radius and length.
    Capsule(f64, f64),
    Cylinder(f64, f64),
}

impl Drawn {
    pub fn convex(&self) -> Convex {
        let shape = match self {
            Self::Box(half_extents) => Shape::Box {
                half_extents: *half_extents,
            },
            Self::Points(points) => {
                let points: Vec<Point3<f64>> = points.iter().map(|p| Point3::from(*p)).collect();
                return Convex::from_points(&points, 0.0).unwrap();
            }
            Self::Sphere(radius) => Shape::Sphere { radius: *radius },
            Self::Capsule(radius, length) => Shape::Capsule {
                radius: *radius,
                length: *length,
            },
            Self::Cylinder(radius, length) => Shape::Cylinder {
                radius: *radius,
                length: *length,
            },
        };
        Convex::new(&shape, &Isometry3::identity()).unwrap()
    }

    /// The same for parry, unless it has no such shape: its cylinders are about y, its hulls must have an inside.
    pub fn parry(&self) -> Option<SharedShape> {
        Some(match self {
            Self::Box(half) => SharedShape::cuboid(half.x, half.y, half.z),
            Self::Points(points) if points.len() >= 10 => {
                let points: Vec<Vector> =
                    points.iter().map(|p| Vector::new(p.x, p.y, p.z)).collect();
                SharedShape::convex_hull(&points)?
            }
            Self::Sphere(radius) => SharedShape::ball(*radius),
            Self::Capsule(radius, length) => SharedShape::capsule_z(length / 2.0, *radius),
            Self::Points(_) | Self::Cylinder(..) => return None,
        })
    }

    /// Corners, of shapes that have few and nothing else.
    pub fn corners(&self) -> Option<Vec<V>> {
        match self {
            Self::Box(half) => Some(
                (0..8)
                    .map(|corner| {
                        let sign = |axis: usize| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 };
                        half.component_mul(&V::new(sign(0), sign(1), sign(2)))
                    })
                    .collect(),
            ),
            Self::Points(points) if points.len() < 10 => Some(points.clone()),
            _ => None,
        }
    }

    /// The largest u . p over its points.
    pub fn height(&self, u: &V) -> f64 {
        match self {
            Self::Box(half) => half.dot(&u.abs()),
            Self::Points(points) => points.iter().map(|p| u.dot(p)).fold(f64::MIN, f64::max),
            Self::Sphere(radius) => radius * u.norm(),
            Self::Capsule(radius, length) => radius * u.norm() + length / 2.0 * u.z.abs(),
            Self::Cylinder(radius, length) => radius * u.xy().norm() + length / 2.0 * u.z.abs(),
        }
    }

    /// How far `p` is outside; of a hull's points how far it is from the surface.
    pub fn outside(&self, p: &V) -> f64 {
        match self {
            Self::Box(half) => (p.abs() - half).map(|x| x.max(0.0)).norm(),
            Self::Sphere(radius) => p.norm() - radius,
            Self::Capsule(radius, length) => {
                let along = p.z.clamp(-length / 2.0, length / 2.0);
                (p - V::new(0.0, 0.0, along)).norm() - radius
            }
            Self::Cylinder(radius, length) => {
                (p.xy().norm() - radius).max(p.z.abs() - length / 2.0)
            }
            Self::Points(points) => from_triangles(points, p),
        }
    }
}

/// How far `p` is from the nearest triangle with corners among the points: 0 on the surface of their hull.
pub fn from_triangles(points: &[V], p: &V) -> f64 {
    let mut nearest = f64::INFINITY;
    for (i, a) in points.iter().enumerate() {
        for (j, b) in points[..=i].iter().enumerate() {
            for c in &points[..=j] {
                nearest = nearest.min(from_triangle([a, b, c], p));
            }
        }
    }
    nearest
}

fn from_triangle([a, b, c]: [&V; 3], p: &V) -> f64 {
    let edges = [(a, b), (b, c), (c, a)];
    let across = (b - a).cross(&(c - a));
    if edges
        .iter()
        .all(|(a, b)| (*b - *a).cross(&(p - *a)).dot(&across) > 0.0)
    {
        return ((p - a).dot(&across) / across.norm()).abs();
    }
    let from_edge = |(a, b): &(&V, &V)| {
        let way = *b - *a;
        let share = ((p - *a).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
        // No number where both ends are one.
        (p - *a - way * if share.is_nan() { 0.0 } else { share }).norm()
    };
    edges.iter().map(from_edge).fold(f64::INFINITY, f64::min)
}

/// 1 mm to 1 m, evenly over the orders of magnitude.
fn size() -> impl Strategy<Value = f64> {
    (-3.0..0.0f64).prop_map(|exponent| 10f64.powf(exponent))
}

pub fn unit() -> impl Strategy<Value = V> {
    (-1.0..1.0f64, 0.0..std::f64::consts::TAU).prop_map(|(z, angle)| {
        let across = (1.0 - z * z).sqrt();
        V::new(across * angle.cos(), across * angle.sin(), z)
    })
}

fn inside_cube() -> impl Strategy<Value = V> {
    [-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64].prop_map(V::from)
}

/// Points of a coarse grid: many coincide, are in one line or in one plane.
fn on_grid() -> impl Strategy<Value = V> {
    [0..3i32, 0..3i32, 0..3i32].prop_map(|at| V::from(at.map(f64::from)))
}

fn scaled(points: impl Strategy<Value = Vec<V>>) -> impl Strategy<Value = Drawn> {
    (points, size())
        .prop_map(|(points, size)| Drawn::Points(points.into_iter().map(|p| p * size).collect()))
}

fn boxes() -> impl Strategy<Value = Drawn> {
    [size(), size(), size()].prop_map(|half| Drawn::Box(V::from(half)))
}

/// Polytopes of so few corners that everything can be tried.
pub fn small() -> impl Strategy<Value = Drawn> {
    prop_oneof![
        boxes(),
        scaled(vec(inside_cube(), 1..10)),
        scaled(vec(unit(), 4..10)),
        scaled(vec(on_grid(), 1..10)),
    ]
}

/// All kinds.
pub fn every_kind() -> impl Strategy<Value = Drawn> {
    prop_oneof![
        small(),
        scaled(vec(inside_cube(), 10..300)),
        scaled(vec(unit(), 10..300)),
        size().prop_map(Drawn::Sphere),
        (size(), size()).prop_map(|(radius, length)| Drawn::Capsule(radius, length)),
        (size(), size()).prop_map(|(radius, length)| Drawn::Cylinder(radius, length)),
    ]
}

/// Where one origin is as seen from the other.
#[derive(Debug, Clone)]
enum Apart {
    /// By this share of the sum of the two reaches.
    Share(f64),
    /// So far from touching along the direction \[m\].
    Touching(f64),
}

/// Two shapes and where they are.
#[derive(Debug, Clone)]
pub struct Case {
    pub shapes: [Drawn; 2],
    pub poses: [Isometry3<f64>; 2],
}

fn turns() -> impl Strategy<Value = UnitQuaternion<f64>> {
    prop_oneof![
        Just(UnitQuaternion::identity()),
        Just(UnitQuaternion::from_axis_angle(&V::z_axis(), FRAC_PI_2)),
        (unit(), 0.0..3.1f64)
            .prop_map(|(axis, angle)| UnitQuaternion::from_scaled_axis(axis * angle)),
        (unit(), 0.0..3.1f64)
            .prop_map(|(axis, angle)| UnitQuaternion::from_scaled_axis(axis * angle)),
    ]
}

/// Far, near, touching within 1e-12 to 1e-6 m, deep in one another, concentric; faces and edges parallel or not.
pub fn cases<S: Strategy<Value = Drawn>>(shapes: impl Fn() -> S) -> impl Strategy<Value = Case> {
    let apart = prop_oneof![
        Just(Apart::Share(0.0)),
        Just(Apart::Share(1e-12)),
        (0.0..0.3f64).prop_map(Apart::Share),
        (0.0..1.0f64).prop_map(Apart::Share),
        (1.0..3.0f64).prop_map(Apart::Share),
        (-12.0..-6.0f64).prop_map(|exponent| Apart::Touching(10f64.powf(exponent))),
        (-12.0..-6.0f64).prop_map(|exponent| Apart::Touching(-(10f64.powf(exponent)))),
    ];
    let direction = prop_oneof![Just(V::x()), unit(), unit()];
    let turns = (turns(), turns(), proptest::bool::ANY);
    (shapes(), shapes(), turns, direction, apart, inside_cube()).prop_map(
        |(a, b, (turn, other, is_parallel), direction, apart, at)| {
            let other = if is_parallel { turn } else { other };
            let direction = turn * direction;
            let away = match apart {
                Apart::Share(share) => share * (a.convex().reach() + b.convex().reach()),
                Apart::Touching(gap) => {
                    let to_b = a.height(&turn.inverse_transform_vector(&direction));
                    to_b + b.height(&-other.inverse_transform_vector(&direction)) + gap
                }
            };
            Case {
                shapes: [a, b],
                poses: [
                    Isometry3::from_parts(at.into(), turn),
                    Isometry3::from_parts((at + direction * away).into(), other),
                ],
            }
        },
    )
}

impl Case {
    pub fn placements(&self) -> [Placement; 2] {
        [0, 1].map(|i| Placement::from(&self.poses[i]))
    }

    /// The value of the plane across `u`, by the shapes' formulas: no more than the signed distance.
    pub fn plane(&self, u: &V) -> f64 {
        let [a, b] = &self.poses;
        let offset = b.translation.vector - a.translation.vector;
        u.dot(&offset)
            - self.shapes[0].height(&a.rotation.inverse_transform_vector(u))
            - self.shapes[1].height(&-b.rotation.inverse_transform_vector(u))
    }

    /// Corners of both about A's origin, in the world's directions.
    pub fn corners(&self) -> Option<[Vec<V>; 2]> {
        let offset = self.poses[1].translation.vector - self.poses[0].translation.vector;
        let placed = |i: usize, at: V| -> Option<Vec<V>> {
            let turn = self.poses[i].rotation;
            Some(
                self.shapes[i]
                    .corners()?
                    .iter()
                    .map(|p| turn * p + at)
                    .collect(),
            )
        };
        Some([placed(0, V::zeros())?, placed(1, offset)?])
    }
}

pub fn pose(isometry: &Isometry3<f64>) -> Pose {
    let (t, r) = (&isometry.translation.vector, &isometry.rotation.coords);
    Pose::from_parts(
        Vector::new(t.x, t.y, t.z),
        Rotation::from_xyzw(r.x, r.y, r.z, r.w),
    )
}

//! Contact and distance at one configuration.

use nalgebra::{Point3, Vector3};

use super::CollisionModel;
use super::part::PartGeometry;
use crate::geometry::{
    Convex, HalfSpace, Placed, Placement, Warm, rough_separation, separation, signed_distance,
};
use crate::robot::JointKind;

/// The smallest distance between the parts of a pair, or of all checked pairs, at one configuration.
#[derive(Debug, Clone, PartialEq)]
pub struct Clearance {
    /// \[m\]; negative when they overlap: minus the depth. Less what padding the pair has.
    pub distance: f64,
    /// Names of the two links, or of an object of the scene and a link.
    pub pair: (String, String),
    /// The nearest points of the two in the base frame \[m\]; where they overlap, those that are deepest in each other.
    pub points: [Point3<f64>; 2],
}

/// Answers questions about configurations, one after the other: near ones are answered faster, since what separated two shapes last is
/// tried first.
pub struct Checker<'m> {
    model: &'m CollisionModel,
    placed: Vec<Placement>,
    /// What rounding of frames does to a distance at most \[m\].
    rounding: f64,
    /// Of each part, the middle of the ball around it.
    centers: Vec<Vector3<f64>>,
    warm: Vec<Warm>,
    /// Of each checked pair, how far the balls around its parts are apart, and the pair.
    order: Vec<(f64, usize)>,
}

impl CollisionModel {
    /// What answers questions about configurations.
    pub fn checker(&self) -> Checker<'_> {
        Checker {
            model: self,
            placed: vec![Placement::identity(); self.frames.bodies()],
            rounding: self.rounding,
            centers: vec![Vector3::zeros(); self.parts.len()],
            warm: vec![Warm::default(); self.convex_pairs()],
            order: Vec::with_capacity(self.checked.len()),
        }
    }

    /// [`Checker::collision`] for a single configuration.
    pub fn collision(&self, q: &[f64]) -> Option<&super::Pair> {
        let mut checker = self.checker();
        checker.first_touching(q).map(|pair| &self.pairs[pair])
    }

    /// [`Checker::clearance`] for a single configuration.
    pub fn clearance(&self, q: &[f64]) -> Option<Clearance> {
        self.checker().clearance(q)
    }
}

impl<'m> Checker<'m> {
    /// The first checked pair that touches, overlaps or is nearer than its padding at configuration `q`, if any. Panics when `q` has not one
    /// entry a joint.
    pub fn collision(&mut self, q: &[f64]) -> Option<&'m super::Pair> {
        let model = self.model;
        self.first_touching(q).map(|pair| &model.pairs[pair])
    }

    /// The numbers of all checked pairs, in the order of [`CollisionModel::pairs`], that touch, overlap or are nearer than their padding at
    /// configuration `q`. Panics when `q` has not one entry a joint.
    pub fn collisions(&mut self, q: &[f64], pairs: &mut Vec<usize>) {
        self.place(q);
        pairs.clear();
        let checked = &self.model.checked;
        pairs.extend(checked.iter().filter(|pair| self.is_touching(**pair)));
    }

    fn first_touching(&mut self, q: &[f64]) -> Option<usize> {
        self.place(q);
        let model = self.model;
        model
            .checked
            .iter()
            .copied()
            .find(|pair| self.is_touching(*pair))
    }

    /// All pairs that touch at configuration `q`, checked or not.
    pub(super) fn touching(&mut self, q: &[f64]) -> Vec<usize> {
        self.place(q);
        (0..self.model.pairs.len())
            .filter(|pair| self.is_touching(*pair))
            .collect()
    }

    /// The checked pair with the smallest distance at configuration `q`; `None` when no pair is checked. Panics when `q` has not one entry a
    /// joint.
    pub fn clearance(&mut self, q: &[f64]) -> Option<Clearance> {
        self.place(q);
        let model = self.model;
        self.order.clear();
        for pair in &model.checked {
            self.order.push((self.ball_gap(*pair), *pair));
        }
        self.order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let mut best: Option<Clearance> = None;
        for i in 0..self.order.len() {
            let (gap, pair) = self.order[i];
            let least = best.as_ref().map_or(f64::INFINITY, |b| b.distance);
            if gap > least {
                break;
            }
            if let Some(found) = self.nearer(pair, least) {
                best = Some(found);
            }
        }
        best
    }

    /// That of one pair, checked or not.
    pub(super) fn pair_clearance(&mut self, q: &[f64], pair: usize) -> Clearance {
        self.place(q);
        self.nearer(pair, f64::INFINITY)
            .unwrap_or_else(|| Clearance {
                distance: f64::NEG_INFINITY,
                pair: self.model.names(pair),
                points: [Point3::origin(); 2],
            })
    }

    fn place(&mut self, q: &[f64]) {
        assert_eq!(q.len(), self.model.joints().len(), "one position a joint");
        self.model.frames.place(q, &mut self.placed);
        let slides = self.model.frames.joints().iter();
        let slid = slides
            .filter(|j| j.kind == JointKind::Prismatic)
            .map(|j| (j.multiplier * q[j.index]).abs() + j.offset.abs());
        self.rounding = self.model.rounding + self.model.rounding_of(slid.sum());
        for (center, part) in self.centers.iter_mut().zip(&self.model.parts) {
            if let PartGeometry::Convexes { ball, .. } = &part.geometry {
                *center = self.placed[part.body].point(&ball.center);
            }
        }
    }

    /// A lower bound on the distance of a pair.
    fn ball_gap(&self, pair: usize) -> f64 {
        let model = self.model;
        let pair = &model.pairs[pair];
        let (a, b) = pair.parts;
        let gap = match (&model.parts[a].geometry, &model.parts[b].geometry) {
            (PartGeometry::Convexes { ball, .. }, PartGeometry::Convexes { ball: other, .. }) => {
                (self.centers[a] - self.centers[b]).norm() - ball.radius - other.radius
            }
            (PartGeometry::HalfSpace(half_space), PartGeometry::Convexes { ball, .. }) => {
                half_space.normal().dot(&self.centers[b]) - half_space.offset() - ball.radius
            }
            _ => f64::NEG_INFINITY,
        };
        gap - pair.padding - self.rounding
    }

    fn is_touching(&mut self, pair: usize) -> bool {
        if self.ball_gap(pair) > 0.0 {
            return false;
        }
        let padding = self.model.pairs[pair].padding;
        self.any_convex_pair(pair, |a, b, warm| match a {
            Other::Convex(convex, placed) => {
                let a = convex.at(placed);
                let is_apart = rough_separation(a, b, warm, padding) > padding
                    || separation(a, b, warm, padding).lower > padding;
                !is_apart
            }
            Other::HalfSpace(half_space) => {
                let is_apart = half_space.separation(b).lower > padding;
                !is_apart
            }
        })
    }

    /// The distance of a pair where it is below `bound`.
    fn nearer(&mut self, pair: usize, bound: f64) -> Option<Clearance> {
        let model = self.model;
        let padding = model.pairs[pair].padding;
        let mut least = bound + padding;
        let mut points = None;
        self.any_convex_pair(pair, |a, b, warm| {
            let (distance, at) = match a {
                Other::Convex(convex, placed) => {
                    let a = convex.at(placed);
                    if rough_separation(a, b, warm, least) > least
                        || separation(a, b, warm, least).lower > least
                    {
                        return false;
                    }
                    let signed = signed_distance(a, b, warm);
                    (signed.distance, signed.points)
                }
                Other::HalfSpace(half_space) => {
                    let signed = half_space.signed_distance(b);
                    (signed.distance, signed.points)
                }
            };
            if distance < least {
                least = distance;
                points = Some(at);
            }
            false
        });
        points.map(|points| Clearance {
            distance: least - padding,
            pair: model.names(pair),
            points,
        })
    }

    /// Whether `is` holds for any pair of convex shapes of the two parts.
    fn any_convex_pair(
        &mut self,
        pair: usize,
        mut is: impl FnMut(Other, Placed, &mut Warm) -> bool,
    ) -> bool {
        let model = self.model;
        let (a, b) = model.pairs[pair].parts;
        let (a, b) = (&model.parts[a], &model.parts[b]);
        let PartGeometry::Convexes { convexes, .. } = &b.geometry else {
            return true;
        };
        let placed = &self.placed[b.body];
        let mut number = model.first_convex_pair[pair];
        match &a.geometry {
            PartGeometry::HalfSpace(half_space) => convexes.iter().any(|convex| {
                let warm = &mut self.warm[number];
                number += 1;
                is(Other::HalfSpace(half_space), convex.at(placed), warm)
            }),
            PartGeometry::Convexes {
                convexes: others, ..
            } => others.iter().any(|other| {
                convexes.iter().any(|convex| {
                    let warm = &mut self.warm[number];
                    number += 1;
                    is(
                        Other::Convex(other, &self.placed[a.body]),
                        convex.at(placed),
                        warm,
                    )
                })
            }),
        }
    }
}

/// The first of two shapes.
enum Other<'a> {
    Convex(&'a Convex, &'a Placement),
    HalfSpace(&'a HalfSpace),
}

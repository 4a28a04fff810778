//! Balls and capsules around points: small, and proven to enclose, for tests that cost little.

use nalgebra::{Matrix3, Point3, Vector3};

/// What a distance, once computed, may be too small by, relative to it: five roundings, and the square root halves most.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Rounded up: at least as long as the vector whose length was computed as `length`.
pub(super) fn outward(length: f64) -> f64 {
    length * (1.0 + ROUNDING)
}

/// A ball. Lengths in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ball {
    pub(super) centre: Point3<f64>,
    pub(super) radius: f64,
}

impl Ball {
    /// The smallest about `centre` that holds all points, rounded outward.
    pub(super) fn about(centre: Point3<f64>, points: &[Point3<f64>]) -> Self {
        let squares = points.iter().map(|p| (p - centre).norm_squared());
        let radius = outward(squares.fold(0.0, f64::max).sqrt());
        Self { centre, radius }
    }

    /// The smallest around `points` but for rounding: takes in the farthest point, and is then the smallest around it and
    /// the at most four points that determined it before (a problem of the linear-programming type: Matousek, Sharir and
    /// Welzl, "A Subexponential Bound for Linear Programming", 1996). Whatever stops it, it holds all points.
    pub(super) fn around(points: &[Point3<f64>]) -> Self {
        // It grows with each step, and seldom needs more than ten.
        const MOST_STEPS: usize = 1000;
        let mut on_it: Vec<Point3<f64>> = points.first().into_iter().copied().collect();
        let mut ball = Self {
            centre: on_it.first().copied().unwrap_or_else(Point3::origin),
            radius: 0.0,
        };
        for _ in 0..MOST_STEPS {
            let off = |p: &&Point3<f64>| (*p - ball.centre).norm_squared();
            let farthest = points.iter().max_by(|p, q| off(p).total_cmp(&off(q)));
            let Some(farthest) = farthest.filter(|p| off(p).sqrt() > outward(ball.radius)) else {
                break;
            };
            on_it.push(*farthest);
            let Some((larger, members)) = smallest(&on_it) else {
                break;
            };
            if larger.radius <= ball.radius {
                break;
            }
            ball = larger;
            let mut index = 0;
            on_it.retain(|_| {
                index += 1;
                members >> (index - 1) & 1 == 1
            });
        }
        Self::about(ball.centre, points)
    }
}

/// The smallest ball around at most five points, the last of them on it, and the set of points on it, as bits.
fn smallest(points: &[Point3<f64>]) -> Option<(Ball, u32)> {
    let last = points.len().checked_sub(1)?;
    let mut best: Option<(Ball, u32)> = None;
    for members in 1_u32 << last..1 << (last + 1) {
        let mut chosen = [Point3::origin(); 4];
        let count = members.count_ones() as usize;
        if count > chosen.len() {
            continue;
        }
        let inside = (0..=last).filter(|i| members >> i & 1 == 1);
        for (slot, i) in chosen.iter_mut().zip(inside) {
            *slot = points[i];
        }
        let Some(ball) = through(&chosen[..count]) else {
            continue;
        };
        let holds = |p: &Point3<f64>| (p - ball.centre).norm() <= ball.radius * (1.0 + 1e-12);
        if points.iter().all(holds) && best.is_none_or(|(b, _)| ball.radius < b.radius) {
            best = Some((ball, members));
        }
    }
    best
}

/// The smallest ball with one to four points on its surface; `None` when they are not in general position.
fn through(points: &[Point3<f64>]) -> Option<Ball> {
    let (first, others) = points.split_first()?;
    // The centre first + sum of x_j q_j has q_i . (sum of x_j q_j) = q_i . q_i / 2.
    let mut gram = Matrix3::identity();
    let mut right = Vector3::zeros();
    for (i, p) in others.iter().enumerate() {
        right[i] = 0.5 * (p - first).norm_squared();
        for (j, q) in others.iter().enumerate() {
            gram[(i, j)] = (p - first).dot(&(q - first));
        }
    }
    // Backward stable, as an inverse is not: all are as far from the centre but for rounding, however near to one line they are.
    let x = gram.cholesky()?.solve(&right);
    let centre = others
        .iter()
        .zip(x.iter())
        .fold(*first, |c, (p, x)| c + *x * (p - first));
    let radius = (first - centre).norm();
    radius.is_finite().then_some(Ball { centre, radius })
}

/// All that is within `radius` of a segment. Lengths in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Capsule {
    pub(super) ends: [Point3<f64>; 2],
    pub(super) radius: f64,
}

impl Capsule {
    /// The one about a segment that holds all points, rounded outward.
    pub(super) fn about(ends: [Point3<f64>; 2], points: &[Point3<f64>]) -> Self {
        let [a, b] = ends;
        let along = b - a;
        let square = along.norm_squared();
        let far = points.iter().map(|p| {
            // Any point of the segment will do for a bound.
            let t = if square > 0.0 {
                ((p - a).dot(&along) / square).clamp(0.0, 1.0)
            } else {
                0.0
            };
            (p - (a + t * along)).norm_squared()
        });
        let radius = far.fold(0.0, f64::max).sqrt();
        // The point of the segment is itself rounded, by less than this.
        let size = a.coords.amax().max(b.coords.amax());
        Self {
            ends,
            radius: outward(radius) + ROUNDING * size,
        }
    }

    /// A small one around `points`: of all tried axes (of the frame, the longest extent, then tilted ones about the best) the
    /// one of least volume, where for each axis the radius is the least possible.
    pub(super) fn around(points: &[Point3<f64>]) -> Self {
        let ball = Ball::around(points);
        let mut best = Self {
            ends: [ball.centre; 2],
            radius: ball.radius,
        };
        let mut axis = None;
        let far = |from: &Point3<f64>| {
            let off = |p: &&Point3<f64>| (*p - from).norm_squared();
            points.iter().max_by(|p, q| off(p).total_cmp(&off(q)))
        };
        let extent = far(&ball.centre).and_then(|a| Some(far(a)? - a));
        let tried = [Vector3::x(), Vector3::y(), Vector3::z()];
        for direction in tried.into_iter().chain(extent) {
            best.improve(&mut axis, direction, &ball.centre, points);
        }
        let mut tilt = 0.25;
        for _ in 0..40 {
            let Some(middle) = axis.filter(|_| tilt > 0.01) else {
                break;
            };
            let aside = middle.cross(&Vector3::ith(middle.iamin(), 1.0)).normalize();
            let other = middle.cross(&aside);
            for step in [aside, -aside, other, -other] {
                best.improve(&mut axis, middle + tilt * step, &ball.centre, points);
            }
            if axis == Some(middle) {
                tilt *= 0.5;
            }
        }
        best
    }

    /// Becomes the capsule along `direction` if that is smaller.
    fn improve(
        &mut self,
        axis: &mut Option<Vector3<f64>>,
        direction: Vector3<f64>,
        middle: &Point3<f64>,
        points: &[Point3<f64>],
    ) {
        let Some(u) = direction.try_normalize(0.0) else {
            return;
        };
        let flat = |p: &Point3<f64>| p - u * u.dot(&(p - middle));
        let shadow: Vec<_> = points.iter().map(flat).collect();
        let disc = Ball::around(&shadow);
        // A point at height t is within r of the axis from t - w to t + w.
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for (p, q) in points.iter().zip(&shadow) {
            let t = u.dot(&(p - middle));
            let w = (disc.radius.powi(2) - (q - disc.centre).norm_squared()).max(0.0);
            low = low.min(t + w.sqrt());
            high = high.max(t - w.sqrt());
        }
        if low > high {
            low = 0.5 * (low + high);
            high = low;
        }
        let capsule = Self::about([disc.centre + low * u, disc.centre + high * u], points);
        if capsule.volume() < self.volume() * (1.0 - 1e-6) {
            *self = capsule;
            *axis = Some(u);
        }
    }

    /// In units of pi.
    pub(super) fn volume(&self) -> f64 {
        let length = (self.ends[1] - self.ends[0]).norm();
        self.radius.powi(2) * (length + 4.0 / 3.0 * self.radius)
    }
}

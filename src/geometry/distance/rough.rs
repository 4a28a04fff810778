//! What balls and capsules around shapes prove.

use super::{SLACK, segments, slack};
use crate::geometry::convex::{Placed, dot, turn};

/// A lower bound of the signed distance of `a` and `b` in some nanoseconds: by the balls around them and, when these are no
/// farther apart than `threshold` \[m\], by the capsules.
#[inline(always)]
pub fn rough_separation(a: Placed, b: Placed, threshold: f64) -> f64 {
    let (ra, rb) = (&a.placement.rotation, &b.placement.rotation);
    let offset = b.placement.translation - a.placement.translation;
    let slack = slack(a, b, &offset);
    let (p, q) = (a.convex.ball(), b.convex.ball());
    let way = turn(rb, &q.center) + offset - turn(ra, &p.center);
    let by_balls = dot(&way, &way).sqrt() - (p.radius + q.radius) - slack;
    if !by_balls.is_finite() {
        return f64::NEG_INFINITY;
    }
    if by_balls > threshold {
        return by_balls;
    }
    let (p, q) = (a.convex.capsule(), b.convex.capsule());
    let ends = [
        p.ends.map(|end| turn(ra, &end)),
        q.ends.map(|end| turn(rb, &end) + offset),
    ];
    // By the plane across the way between the nearest points: that these are nearest need not be believed.
    let nearest = segments::nearest(ends, slack / SLACK);
    let by_capsules = segments::plane(ends, &nearest.normal) - (p.radius + q.radius) - slack;
    by_balls.max(by_capsules)
}

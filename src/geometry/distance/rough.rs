//! What balls and capsules around shapes prove.

use nalgebra::Vector3;

use super::{SLACK, Warm, segments, slack};
use crate::geometry::convex::{Placed, dot, turn, turn_back};

/// A lower bound of the signed distance of `a` and `b` in some nanoseconds: by the balls around them and, when these are no
/// farther apart than `threshold` \[m\], by the capsules, across the direction that held last and then across their own.
#[inline(always)]
pub fn rough_separation(a: Placed, b: Placed, warm: &mut Warm, threshold: f64) -> f64 {
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
    let given = p.radius + q.radius + slack;
    if warm.direction != Vector3::zeros() {
        let gap = segments::plane(ends, &turn(ra, &warm.direction)) - given;
        if gap > threshold {
            return gap;
        }
    }
    // By the plane across the way between the nearest points: that these are nearest need not be believed.
    let nearest = segments::nearest(ends, slack / SLACK);
    let gap = segments::plane(ends, &nearest.normal) - given;
    if gap > threshold
        && let Some(direction) = turn_back(ra, &nearest.normal).try_normalize(0.0)
    {
        warm.direction = direction;
    }
    by_balls.max(gap)
}

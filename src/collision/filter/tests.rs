//! Gaps of segments against plain formulas.

use fearless_simd::{Level, dispatch};
use nalgebra::Vector3;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

use super::*;

type Segment = [Vector3<f64>; 2];

fn along([a, b]: &Segment, t: f64) -> Vector3<f64> {
    a + (b - a) * t
}

fn to_point(segment: &Segment, p: &Vector3<f64>) -> f64 {
    let way = segment[1] - segment[0];
    let t = (p - segment[0]).dot(&way) / way.norm_squared();
    (along(segment, t.clamp(0.0, 1.0)) - p).norm()
}

/// The distance from a point of one to the other is convex along the one: thirds are left out until nothing is left.
fn distance(a: &Segment, b: &Segment) -> f64 {
    let (mut from, mut to) = (0.0, 1.0);
    for _ in 0..200 {
        let third = (to - from) / 3.0;
        let at = |t: f64| to_point(b, &along(a, t));
        if at(from + third) < at(to - third) {
            to -= third;
        } else {
            from += third;
        }
    }
    to_point(b, &along(a, 0.5 * (from + to)))
}

#[test]
fn the_gap_of_two_segments_is_their_distance() {
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    for _ in 0..200 {
        // Of different lengths, some beside each other and some not.
        let mut segment = |length: f64, far: f64| -> Segment {
            let mut point = |size: f64| Vector3::from_fn(|_, _| size * rng.random::<f64>());
            let from = point(far);
            [from, from + point(length)]
        };
        let pairs: [[Segment; 2]; LANES] =
            std::array::from_fn(|i| [segment(3.0, 1.0), segment(0.4 * i as f64 + 0.1, 4.0)]);
        let ends = |s: usize, end: usize| -> [[f64; LANES]; 3] {
            std::array::from_fn(|x| std::array::from_fn(|lane| pairs[lane][s][end][x]))
        };
        let gaps = dispatch!(Level::new(), simd => {
            let load = |s, end| {
                let [x, y, z] = ends(s, end);
                V3::load(simd, [&x, &y, &z])
            };
            let segment = |s| [load(s, 0), load(s, 1)];
            to_array(segment_gap(simd, &segment(0), &segment(1)))
        });
        for ([a, b], gap) in pairs.iter().zip(gaps) {
            let known = distance(a, b);
            assert!((gap - known).abs() < 1e-7, "{a:?} {b:?}: {gap}, {known}");
        }
    }
}

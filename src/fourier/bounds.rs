//! Rigorous bounds on a wave and its derivatives: over an interval of time, and over the whole period.

use super::{Derivative, Wave};

/// Evaluating a series of K harmonics rounds; each bound is widened by this many machine epsilons a harmonic of the
/// sum of the moduli, which exceeds the rounding of the sum and of the powers of exp(i w t) in [`Wave::state`].
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Pieces of the period narrower than this share of it are not split.
const NARROWEST: f64 = 1e-13;

/// A closed interval of real numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs)]
pub struct Interval {
    pub lower: f64,
    pub upper: f64,
}

impl Interval {
    /// Width.
    pub fn width(self) -> f64 {
        self.upper - self.lower
    }

    /// The larger of the two moduli: a bound on |x| for x within.
    pub fn magnitude(self) -> f64 {
        self.lower.abs().max(self.upper.abs())
    }

    /// Whether `x` lies within, ends included.
    pub fn contains(self, x: f64) -> bool {
        self.lower <= x && x <= self.upper
    }

    /// From -`radius` to `radius`; contains no NaN.
    pub(crate) fn within(radius: f64) -> Self {
        Self::around(0.0, radius)
    }

    fn around(centre: f64, radius: f64) -> Self {
        Self::point(centre).widened(radius)
    }

    /// `x` alone.
    pub(crate) fn point(x: f64) -> Self {
        Self { lower: x, upper: x }
    }

    /// With `margin` more at either end.
    pub(crate) fn widened(self, margin: f64) -> Self {
        Self {
            lower: self.lower - margin,
            upper: self.upper + margin,
        }
    }

    /// The smallest interval that holds both.
    pub(crate) fn hull(self, other: Self) -> Self {
        Self {
            lower: self.lower.min(other.lower),
            upper: self.upper.max(other.upper),
        }
    }

    pub(crate) fn intersect(self, other: Self) -> Self {
        Self {
            lower: self.lower.max(other.lower),
            upper: self.upper.min(other.upper),
        }
    }
}

/// The range of a quantity over a motion, and when its ends are reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extremes {
    /// An enclosure of the quantity.
    pub range: Interval,
    /// When the lower end is reached, or as nearly as the range is tight \[s\].
    pub lower_time: f64,
    /// When the upper end is.
    pub upper_time: f64,
}

impl Wave {
    /// Sum over the harmonics of 2 |w_{d,k}| (k w)^n for joint `joint`: bounds the n-th derivative everywhere
    /// (for n = 0, the distance from the offset). Rounded upwards.
    pub fn harmonic_sum(&self, joint: usize, order: i32) -> f64 {
        let w = self.angular_frequency();
        let row = self.weights().row(joint);
        let sum: f64 = row
            .iter()
            .enumerate()
            .map(|(k, weight)| {
                let modulus = libm::sqrt(weight.re * weight.re + weight.im * weight.im);
                let kw = (k + 1) as f64 * w;
                2.0 * modulus * (0..order).fold(1.0, |s, _| s * kw)
            })
            .sum();
        sum * (1.0 + self.slack())
    }

    /// [`harmonic_sum`](Self::harmonic_sum) for n = 0 to 3.
    #[cfg(feature = "robot")]
    pub(crate) fn harmonic_sums(&self, joint: usize) -> [f64; 4] {
        let w = self.angular_frequency();
        let mut sums = [0.0; 4];
        for (k, weight) in self.weights().row(joint).iter().enumerate() {
            let kw = (k + 1) as f64 * w;
            let mut term = 2.0 * libm::sqrt(weight.re * weight.re + weight.im * weight.im);
            for sum in &mut sums {
                *sum += term;
                term *= kw;
            }
        }
        sums.map(|sum| sum * (1.0 + self.slack()))
    }

    /// What evaluation may lose, as a share of the harmonic sums.
    pub(crate) fn slack(&self) -> f64 {
        ROUNDING * (self.harmonics() + 1) as f64
    }

    /// An enclosure of a derivative of one joint while |t - `middle`| <= `half_width` \[s\].
    ///
    /// The best of Taylor's theorem with a remainder of first, second and third order, the remainders from the
    /// harmonic sums: |y(t) - y(m)| <= min(S1 h, |y'(m)| h + S2 h^2 / 2, |y'(m)| h + |y''(m)| h^2 / 2 + S3 h^3 / 6),
    /// intersected with the bound over the period.
    pub fn enclosure(
        &self,
        joint: usize,
        derivative: Derivative,
        middle: f64,
        half_width: f64,
    ) -> Interval {
        self.bounded(joint, derivative)
            .enclosure(middle, half_width.abs())
    }

    /// The range of a derivative of one joint over the whole period, as an enclosure that is at most
    /// `1e-6` of the harmonic sum (and rounding) wider than the truth at either end
    /// (branch and bound on [`enclosure`](Self::enclosure)).
    pub fn range(&self, joint: usize, derivative: Derivative) -> Interval {
        self.extremes(joint, derivative).range
    }

    /// [`range`](Self::range), with the times of the extremes.
    pub fn extremes(&self, joint: usize, derivative: Derivative) -> Extremes {
        self.extremes_within(joint, derivative, 0.0, self.period())
    }

    /// [`extremes`](Self::extremes) while `from` <= t <= `to` \[s\] alone.
    pub fn extremes_within(
        &self,
        joint: usize,
        derivative: Derivative,
        from: f64,
        to: f64,
    ) -> Extremes {
        let bounded = self.bounded(joint, derivative);
        // The second term covers what evaluation rounds, lest a tiny wave about a large offset be split for ever.
        let tolerance = 1e-6 * bounded.sums[0]
            + 4.0 * self.slack() * (bounded.sums[0] + bounded.offset().abs())
            + f64::MIN_POSITIVE;
        // Four pieces a cycle of the highest harmonic: Taylor's remainders are of use from the start.
        let length = (to - from).clamp(0.0, self.period());
        let cycles = 4.0 * self.harmonics().max(1) as f64;
        let pieces = (cycles * length / self.period()).ceil().max(1.0) as usize;
        let half = length / (2 * pieces) as f64;
        let mut open: Vec<(f64, f64)> = (0..pieces)
            .map(|i| (from + (2 * i + 1) as f64 * half, half))
            .collect();
        // Values that are reached, and what is proven of the pieces that are done with.
        let first = bounded.value(from);
        let mut reached = Interval::point(first);
        let (mut lower_time, mut upper_time) = (from, from);
        let mut proven = reached;
        while let Some((middle, half)) = open.pop() {
            let (value, enclosure) = bounded.value_and_enclosure(middle, half);
            if value < reached.lower {
                reached.lower = value;
                lower_time = middle;
            }
            if value > reached.upper {
                reached.upper = value;
                upper_time = middle;
            }
            let tight = enclosure.lower >= reached.lower - tolerance
                && enclosure.upper <= reached.upper + tolerance;
            // An enclosure holds at any width; below this one time itself is rounding.
            if tight || half < NARROWEST * self.period() {
                proven = proven.hull(enclosure);
            } else {
                let half = half / 2.0;
                open.push((middle - half, half));
                open.push((middle + half, half));
            }
        }
        Extremes {
            range: proven,
            lower_time,
            upper_time,
        }
    }

    fn bounded(&self, joint: usize, derivative: Derivative) -> Bounded<'_> {
        let order = derivative.order();
        Bounded {
            wave: self,
            joint,
            order,
            sums: std::array::from_fn(|i| self.harmonic_sum(joint, order + i as i32)),
        }
    }
}

/// One derivative of one joint with the harmonic sums of it and of the three derivatives after it.
struct Bounded<'a> {
    wave: &'a Wave,
    joint: usize,
    order: i32,
    sums: [f64; 4],
}

impl Bounded<'_> {
    fn offset(&self) -> f64 {
        if self.order == 0 {
            self.wave.offsets()[self.joint]
        } else {
            0.0
        }
    }

    fn value(&self, t: f64) -> f64 {
        self.jet(t)[0]
    }

    /// The derivative and the two after it, at `t`.
    fn jet(&self, t: f64) -> [f64; 3] {
        let w = self.wave.angular_frequency();
        let turns = t / self.wave.period();
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * (turns - libm::floor(turns)));
        let step = num_complex::Complex::new(cos, sin);
        let mut rotation = step;
        let mut jet = [self.offset(), 0.0, 0.0];
        for (k, weight) in self.wave.weights().row(self.joint).iter().enumerate() {
            let kw = (k + 1) as f64 * w;
            let z = (0..self.order).fold(weight * rotation * 2.0, |z, _| {
                num_complex::Complex::new(-z.im * kw, z.re * kw)
            });
            jet[0] += z.re;
            jet[1] -= kw * z.im;
            jet[2] -= kw * kw * z.re;
            rotation *= step;
        }
        jet
    }

    fn enclosure(&self, middle: f64, half: f64) -> Interval {
        self.value_and_enclosure(middle, half).1
    }

    fn value_and_enclosure(&self, middle: f64, half: f64) -> (f64, Interval) {
        let [value, slope, curvature] = self.jet(middle);
        let [s0, s1, s2, s3] = self.sums;
        let slack = self.wave.slack();
        // What evaluation at `middle` may have lost.
        let (slope, curvature) = (slope.abs() + slack * s1, curvature.abs() + slack * s2);
        let radius = (s1 * half)
            .min(slope * half + s2 * half * half / 2.0)
            .min(slope * half + curvature * half * half / 2.0 + s3 * half.powi(3) / 6.0);
        // Dividing a late time by the period loses digits of the phase.
        let late = 4.0 * f64::EPSILON * (middle.abs() + self.wave.period()) * s1;
        let rounding = slack * (s0 + value.abs() + self.offset().abs()) + late;
        let local = Interval::around(value, radius * (1.0 + slack) + rounding);
        let global = Interval::around(self.offset(), s0 + rounding);
        (value, local.intersect(global))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fourier::Joints;
    use nalgebra::{dmatrix, dvector};
    use num_complex::Complex;

    /// 0.1 + 0.6 cos(w t) + 0.2 cos(2 w t): maximum 0.9 at 0; minimum where cos = -0.75, at 0.1 - 0.425.
    fn wave() -> Wave {
        Wave::new(
            Joints::new(["a"]).unwrap(),
            2.0,
            dvector![0.1],
            dmatrix![Complex::new(0.3, 0.0), Complex::new(0.1, 0.0)],
        )
        .unwrap()
    }

    #[test]
    fn a_magnitude_is_that_of_the_end_that_is_farther_from_zero() {
        let of = |lower, upper| Interval { lower, upper }.magnitude();
        assert_eq!([of(-3.0, 1.0), of(-1.0, 3.0)], [3.0; 2]);
        assert_eq!([of(-3.0, -1.0), of(1.0, 3.0)], [3.0; 2]);
    }

    #[test]
    fn range_meets_the_analytic_extremes() {
        let range = wave().range(0, Derivative::Position);
        assert!(range.upper >= 0.9 && range.upper < 0.9 + 2e-6, "{range:?}");
        assert!(
            range.lower <= -0.325 && range.lower > -0.325 - 2e-6,
            "{range:?}"
        );
    }

    #[test]
    fn a_wave_that_stands_still_has_a_point_for_a_range() {
        let wave = Wave::new(
            Joints::new(["a"]).unwrap(),
            2.0,
            dvector![-0.7],
            nalgebra::DMatrix::zeros(1, 3),
        )
        .unwrap();
        let range = wave.range(0, Derivative::Position);
        assert!(range.contains(-0.7) && range.width() < 1e-13, "{range:?}");
        assert_eq!(wave.range(0, Derivative::Velocity).magnitude(), 0.0);
    }

    #[test]
    fn harmonic_sums_are_the_sums() {
        let w = std::f64::consts::PI;
        let expected = 0.6 * w * w + 0.2 * 4.0 * w * w;
        assert!((wave().harmonic_sum(0, 2) - expected).abs() < 1e-12);
    }
}

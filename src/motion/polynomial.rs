//! Polynomials of degree 5 at most on the unit interval: values, Taylor's coefficients, rigorous ranges.

use crate::fourier::Interval;

/// Powers 0 to 5.
const TERMS: usize = 6;

/// Rounding of a control point or a value, in the sum of the moduli of the coefficients: Horner's scheme five deep over
/// coefficients that grow by binomials no larger than 10, and six products summed, stay below.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Narrower pieces are not split: an enclosure holds at any width, and the polygon's excess, which falls with the square
/// of the width, is far below rounding here.
const NARROWEST: f64 = 1.0 / (1u64 << 40) as f64;

/// `BERNSTEIN[j][i]` = C(j, i) / C(5, i): control point j is the sum of these times the coefficients (Farin, "Curves and
/// surfaces for CAGD", the conversion from monomials).
const BERNSTEIN: [[f64; TERMS]; TERMS] = {
    let mut table = [[0.0; TERMS]; TERMS];
    let mut j = 0;
    while j < TERMS {
        let mut i = 0;
        while i <= j {
            table[j][i] = binomial(j, i) / binomial(TERMS - 1, i);
            i += 1;
        }
        j += 1;
    }
    table
};

const fn binomial(n: usize, k: usize) -> f64 {
    let mut value = 1;
    let mut i = 0;
    while i < k {
        value = value * (n - i) / (i + 1);
        i += 1;
    }
    value as f64
}

/// c_0 + c_1 u + .. + c_5 u^5 for u from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Quintic(pub(super) [f64; TERMS]);

impl Quintic {
    /// The line from `a` to `b`.
    pub(super) fn linear(a: f64, b: f64) -> Self {
        Self([a, b - a, 0.0, 0.0, 0.0, 0.0])
    }

    /// The cubic with values and slopes `a` and `b` at the ends.
    pub(super) fn cubic(a: [f64; 2], b: [f64; 2]) -> Self {
        let d = b[0] - a[0];
        Self([
            a[0],
            a[1],
            3.0 * d - 2.0 * a[1] - b[1],
            -2.0 * d + a[1] + b[1],
            0.0,
            0.0,
        ])
    }

    /// The quintic with values, slopes and second derivatives `a` and `b` at the ends.
    pub(super) fn hermite(a: [f64; 3], b: [f64; 3]) -> Self {
        let d = b[0] - a[0];
        Self([
            a[0],
            a[1],
            a[2] / 2.0,
            10.0 * d - 6.0 * a[1] - 4.0 * b[1] - 1.5 * a[2] + 0.5 * b[2],
            -15.0 * d + 8.0 * a[1] + 7.0 * b[1] + 1.5 * a[2] - b[2],
            6.0 * d - 3.0 * (a[1] + b[1]) + 0.5 * (b[2] - a[2]),
        ])
    }

    /// The `order`-th derivative, over `length`^order: the derivative to t when u = t / length.
    pub(super) fn derivative(&self, order: i32, length: f64) -> Self {
        let mut c = self.0;
        for _ in 0..order {
            for i in 1..TERMS {
                c[i - 1] = i as f64 * c[i] / length;
            }
            c[TERMS - 1] = 0.0;
        }
        Self(c)
    }

    /// Taylor's coefficients about `u`: p(u + x) = b_0 + b_1 x + .. + b_5 x^5 (repeated synthetic division).
    pub(super) fn about(&self, u: f64) -> [f64; TERMS] {
        let mut b = self.0;
        for i in 0..TERMS - 1 {
            for j in (i..TERMS - 1).rev() {
                b[j] += u * b[j + 1];
            }
        }
        b
    }

    /// The value at `u`.
    pub(super) fn value(&self, u: f64) -> f64 {
        self.0.iter().rev().fold(0.0, |sum, c| sum * u + c)
    }

    /// A bound on what evaluation anywhere within 0..1 loses to rounding.
    pub(super) fn rounding(&self) -> f64 {
        ROUNDING * self.0.iter().map(|c| c.abs()).sum::<f64>()
    }

    /// The interval of the control points of the piece from `u` to `u + width`: encloses the polynomial there up to
    /// [`rounding`](Self::rounding), with equality where it is monotone.
    fn polygon(&self, u: f64, width: f64) -> Interval {
        let mut local = self.about(u);
        let mut power = width;
        for c in &mut local[1..] {
            *c *= power;
            power *= width;
        }
        let mut hull = Interval::point(local[0]);
        for row in &BERNSTEIN[1..] {
            let point = row.iter().zip(&local).map(|(w, c)| w * c).sum();
            hull = hull.hull(Interval::point(point));
        }
        hull
    }

    /// An enclosure over 0..1, from the control points of its halves.
    pub(super) fn hull(&self) -> Interval {
        let hull = self.polygon(0.0, 0.5).hull(self.polygon(0.5, 0.5));
        hull.widened(self.rounding())
    }
}

/// The range of a function given piece by piece, and where its ends are reached: branch and bound on control polygons.
#[derive(Debug)]
pub(super) struct RangeSearch {
    /// What is reached, at (piece, u).
    reached: Interval,
    lowest: (usize, f64),
    highest: (usize, f64),
    proven: Interval,
    open: Vec<(f64, f64)>,
}

impl RangeSearch {
    pub(super) fn new() -> Self {
        let nothing = Interval {
            lower: f64::INFINITY,
            upper: f64::NEG_INFINITY,
        };
        Self {
            reached: nothing,
            lowest: (0, 0.0),
            highest: (0, 0.0),
            proven: nothing,
            open: Vec::new(),
        }
    }

    /// Notes the value of a piece at `u`.
    pub(super) fn reach(&mut self, piece: usize, p: &Quintic, u: f64) {
        let value = p.value(u);
        if value < self.reached.lower {
            self.reached.lower = value;
            self.lowest = (piece, u);
        }
        if value > self.reached.upper {
            self.reached.upper = value;
            self.highest = (piece, u);
        }
    }

    /// Proves that a piece does not leave what is reached by more than rounding, reaching more until that is so.
    pub(super) fn enclose(&mut self, piece: usize, p: &Quintic) {
        let rounding = p.rounding();
        self.open.push((0.0, 1.0));
        while let Some((u, width)) = self.open.pop() {
            let polygon = p.polygon(u, width);
            let within = polygon.lower >= self.reached.lower - rounding
                && polygon.upper <= self.reached.upper + rounding;
            if within || width < NARROWEST {
                self.proven = self.proven.hull(polygon.widened(rounding));
            } else {
                let half = width / 2.0;
                self.reach(piece, p, u + half);
                self.open.push((u + half, half));
                self.open.push((u, half));
            }
        }
    }

    /// The enclosure, and the (piece, u) where its lower and upper ends are reached.
    pub(super) fn found(&self) -> (Interval, (usize, f64), (usize, f64)) {
        (self.proven, self.lowest, self.highest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn range(p: &Quintic) -> (Interval, f64, f64) {
        let mut search = RangeSearch::new();
        search.reach(0, p, 0.0);
        search.reach(0, p, 1.0);
        search.enclose(0, p);
        let (range, low, high) = search.found();
        (range, low.1, high.1)
    }

    /// A value by de Casteljau's scheme, from control points made without [`BERNSTEIN`]: those of the integral of the
    /// derivative, b_{j+1} = b_j + b'_j / n (Farin), down to the constant.
    fn casteljau(c: &[f64], u: f64) -> f64 {
        fn points(c: &[f64]) -> Vec<f64> {
            let n = c.len() - 1;
            if n == 0 {
                return vec![c[0]];
            }
            let derivative: Vec<f64> = (1..=n).map(|i| i as f64 * c[i]).collect();
            let mut all = vec![c[0]];
            for slope in points(&derivative) {
                all.push(all[all.len() - 1] + slope / n as f64);
            }
            all
        }
        let mut b = points(c);
        while b.len() > 1 {
            b = b.windows(2).map(|w| w[0] + u * (w[1] - w[0])).collect();
        }
        b[0]
    }

    #[test]
    fn ranges_of_known_polynomials_are_exact_to_rounding() {
        // u^2 (1 - u): from 0 to 4/27 at 2/3. Chebyshev's T5 on 0..1: from -1 to 1 five times over.
        let chebyshev = [-1.0, 50.0, -400.0, 1120.0, -1280.0, 512.0];
        for (c, lower, upper) in [
            ([0.0, 0.0, 1.0, -1.0, 0.0, 0.0], 0.0, 4.0 / 27.0),
            (chebyshev, -1.0, 1.0),
            ([0.3, 0.0, 0.0, 0.0, 0.0, 0.0], 0.3, 0.3),
            ([1.0, -2.0, 1.0, 0.0, 0.0, 0.0], 0.0, 1.0),
        ] {
            let p = Quintic(c);
            let (range, low, high) = range(&p);
            let slack = 3.0 * p.rounding();
            assert!(
                range.lower <= lower && range.lower >= lower - slack,
                "{range:?}"
            );
            assert!(
                range.upper >= upper && range.upper <= upper + slack,
                "{range:?}"
            );
            assert!((p.value(low) - lower).abs() <= slack);
            assert!((p.value(high) - upper).abs() <= slack);
        }
    }

    proptest! {
        #[test]
        fn nothing_lies_outside_the_range_and_its_ends_are_reached(
            c in proptest::array::uniform6(-3.0..3.0_f64),
        ) {
            let p = Quintic(c);
            let (range, low, high) = range(&p);
            let hull = p.hull();
            for i in 0..=1000 {
                let y = casteljau(&c, f64::from(i) / 1000.0);
                prop_assert!(range.contains(y) && hull.contains(y), "{} of {:?}", y, range);
            }
            prop_assert!(p.value(low) - range.lower <= 3.0 * p.rounding());
            prop_assert!(range.upper - p.value(high) <= 3.0 * p.rounding());
        }

        /// The coefficients are those of the linear system of the end conditions, solved in general.
        #[test]
        fn coefficients_solve_the_hermite_system(
            a in proptest::array::uniform3(-2.0..2.0_f64),
            b in proptest::array::uniform3(-2.0..2.0_f64),
        ) {
            for n in [2usize, 4, 6] {
                let system = nalgebra::DMatrix::from_fn(n, n, |row, i| {
                    let order = row % (n / 2);
                    let factor: f64 = (0..order).map(|k| i as f64 - k as f64).product();
                    if row < n / 2 && i != order { 0.0 } else { factor }
                });
                let right = nalgebra::DVector::from_fn(n, |row, _| {
                    if row < n / 2 { a[row] } else { b[row - n / 2] }
                });
                let expected = system.lu().solve(&right).unwrap();
                let found = match n {
                    2 => Quintic::linear(a[0], b[0]),
                    4 => Quintic::cubic([a[0], a[1]], [b[0], b[1]]),
                    _ => Quintic::hermite(a, b),
                };
                for i in 0..n {
                    prop_assert!((found.0[i] - expected[i]).abs() < 1e-12, "{}: {:?}", n, found);
                }
            }
        }

        #[test]
        fn taylor_and_derivatives_agree(
            c in proptest::array::uniform6(-3.0..3.0_f64),
            u in 0.0..1.0_f64,
            length in 0.1..3.0_f64,
        ) {
            let p = Quintic(c);
            let b = p.about(u);
            let mut factorial = 1.0;
            for order in 0..4 {
                let direct = p.derivative(order, length).value(u) * length.powi(order);
                prop_assert!((b[order as usize] * factorial - direct).abs() < 1e-10);
                factorial *= f64::from(order) + 1.0;
            }
        }
    }
}

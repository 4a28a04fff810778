//! Double-double arithmetic, for oracles that must not share the rounding of what they check.
//!
//! A number is the unevaluated sum of two `f64` that do not overlap, some 106 bits (Dekker, A floating-point technique for
//! extending the available precision, Numerische Mathematik 18, 1971; Hida, Li and Bailey, ARITH-15, 2001).

use std::ops::{Add, Div, Mul, Neg, Sub};

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DoubleDouble {
    high: f64,
    low: f64,
}

/// a + b and what its rounding lost, for any a and b (Knuth).
fn sum(a: f64, b: f64) -> DoubleDouble {
    let high = a + b;
    let part = high - a;
    DoubleDouble {
        high,
        low: (a - (high - part)) + (b - part),
    }
}

/// The same for |a| >= |b| (Dekker).
fn ordered_sum(a: f64, b: f64) -> DoubleDouble {
    let high = a + b;
    DoubleDouble {
        high,
        low: b - (high - a),
    }
}

/// a b and what its rounding lost.
fn product(a: f64, b: f64) -> DoubleDouble {
    let high = a * b;
    DoubleDouble {
        high,
        low: a.mul_add(b, -high),
    }
}

impl DoubleDouble {
    pub const ZERO: Self = Self {
        high: 0.0,
        low: 0.0,
    };

    /// Rounded to one `f64`.
    pub fn rounded(self) -> f64 {
        self.high + self.low
    }

    /// One step of Newton's iteration for 1 / sqrt(a) from the `f64` root doubles its digits (Karp and Markstein).
    pub fn sqrt(self) -> Self {
        if self == Self::ZERO {
            return self;
        }
        let inverse = 1.0 / self.high.sqrt();
        let root = self.high * inverse;
        let residual = self - product(root, root);
        sum(root, residual.high * inverse / 2.0)
    }
}

impl From<f64> for DoubleDouble {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Neg for DoubleDouble {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            high: -self.high,
            low: -self.low,
        }
    }
}

impl Add for DoubleDouble {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (high, low) = (sum(self.high, other.high), sum(self.low, other.low));
        let first = ordered_sum(high.high, high.low + low.high);
        ordered_sum(first.high, first.low + low.low)
    }
}

impl Sub for DoubleDouble {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let leading = product(self.high, other.high);
        let cross = self.high * other.low + self.low * other.high;
        ordered_sum(leading.high, leading.low + cross)
    }
}

impl Div for DoubleDouble {
    type Output = Self;

    /// Long division, three digits of 53 bits.
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * first.into();
        let second = rest.high / other.high;
        let third = (rest - other * second.into()).high / other.high;
        ordered_sum(first, second) + third.into()
    }
}

impl std::iter::Sum for DoubleDouble {
    fn sum<I: Iterator<Item = Self>>(numbers: I) -> Self {
        numbers.fold(Self::ZERO, Add::add)
    }
}

#[test]
fn roots_and_quotients_are_undone_to_a_hundred_bits() {
    let number = |x: f64| DoubleDouble::from(x);
    for i in 1..50 {
        let a = number(f64::from(i)) / number(7.0);
        let back = a * number(7.0) - number(f64::from(i));
        assert!(back.rounded().abs() < 2f64.powi(-98), "{i} / 7: {back:?}");
        let root = a.sqrt();
        let squared = root * root - a;
        assert!(squared.rounded().abs() < 2f64.powi(-98), "{i}: {squared:?}");
    }
    // 1 + 2^-80 is not 1.
    let close = number(1.0) + number(2f64.powi(-80));
    assert_eq!((close - number(1.0)).rounded(), 2f64.powi(-80));
}

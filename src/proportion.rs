//! The exact interval of a proportion.

/// Steps of the continued fraction; it takes about the square root of the larger parameter, and trials are below 1e9.
const MOST_STEPS: usize = 200_000;

/// The interval of Clopper and Pearson ("The use of confidence or fiducial limits illustrated in the case of the binomial",
/// Biometrika 26, 1934) for the probability behind `successes` of `trials`: it covers the truth with a probability of
/// `confidence` at least, whatever the truth is. Without trials it is 0 to 1.
///
/// ```
/// let (lower, upper) = undulate::clopper_pearson(0, 10, 0.95);
/// assert_eq!(lower, 0.0);
/// assert!((upper - (1.0 - 0.025f64.powf(0.1))).abs() < 1e-12);
/// ```
///
/// # Panics
/// When there are more successes than trials, or the confidence is not between 0 and 1.
pub fn clopper_pearson(successes: u64, trials: u64, confidence: f64) -> (f64, f64) {
    assert!(
        successes <= trials,
        "{successes} successes of {trials} trials"
    );
    assert!(
        confidence > 0.0 && confidence < 1.0,
        "a confidence of {confidence}"
    );
    let tail = 0.5 * (1.0 - confidence);
    (
        lower_bound(successes, trials, tail),
        upper_bound(successes, trials, tail),
    )
}

/// The probability at which so many successes or more have a chance of `tail`; 0 without successes.
pub(crate) fn lower_bound(successes: u64, trials: u64, tail: f64) -> f64 {
    if successes == 0 {
        return 0.0;
    }
    crossing(|p| at_least(successes, trials, p) < tail)
}

/// The probability at which so many successes or fewer have a chance of `tail`; 1 without failures.
pub(crate) fn upper_bound(successes: u64, trials: u64, tail: f64) -> f64 {
    if successes == trials {
        return 1.0;
    }
    crossing(|p| at_most(successes, trials, p) > tail)
}

/// P(X >= k) of a binomial X: the incomplete beta function I_p(k, n - k + 1), increasing in p.
pub(crate) fn at_least(k: u64, trials: u64, p: f64) -> f64 {
    if k == 0 {
        return 1.0;
    }
    incomplete_beta(p, k as f64, (trials - k) as f64 + 1.0)
}

/// P(X <= k) of a binomial X; by symmetry and not as 1 less the other, which knows no tail below rounding.
pub(crate) fn at_most(k: u64, trials: u64, p: f64) -> f64 {
    if k == trials {
        return 1.0;
    }
    incomplete_beta(1.0 - p, (trials - k) as f64, k as f64 + 1.0)
}

/// Where `is_below` ceases to hold between 0 and 1, by bisection until neighbouring numbers.
fn crossing(is_below: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return middle;
        }
        if is_below(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/// The regularised incomplete beta function I_x(a, b), for positive a and b.
pub(crate) fn incomplete_beta(x: f64, a: f64, b: f64) -> f64 {
    if x <= 0.0 || x >= 1.0 {
        return x.clamp(0.0, 1.0);
    }
    // The fraction converges fast on this side of the mean; the other follows by symmetry.
    if x > (a + 1.0) / (a + b + 2.0) {
        1.0 - by_fraction(1.0 - x, b, a)
    } else {
        by_fraction(x, a, b)
    }
}

/// By its continued fraction, DLMF 8.17.22, evaluated as Lentz does (Applied Optics 15, 1976).
fn by_fraction(x: f64, a: f64, b: f64) -> f64 {
    let away = |v: f64| if v.abs() < 1e-300 { 1e-300 } else { v };
    let log = libm::lgamma(a + b) - libm::lgamma(a) - libm::lgamma(b)
        + a * libm::log(x)
        + b * libm::log1p(-x);
    let mut c = 1.0;
    let mut d = 1.0 / away(1.0 - (a + b) * x / (a + 1.0));
    let mut fraction = d;
    for step in 1..MOST_STEPS {
        let m = step as f64;
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let mut change = 1.0;
        for term in [even, odd] {
            d = 1.0 / away(1.0 + term * d);
            c = away(1.0 + term / c);
            change = c * d;
            fraction *= change;
        }
        if (change - 1.0).abs() < f64::EPSILON {
            break;
        }
    }
    libm::exp(log) * fraction / a
}

#[cfg(test)]
mod tests {
    use super::*;

    /// P(X >= k) for n trials of probability p, term by term, from the end that does not underflow.
    fn at_least(k: u64, n: u64, p: f64) -> f64 {
        let below = |k: u64, p: f64| {
            let mut term = (1.0 - p).powi(n as i32);
            let mut sum = 0.0;
            for i in 0..k {
                sum += term;
                term *= (n - i) as f64 / (i + 1) as f64 * p / (1.0 - p);
            }
            sum
        };
        if p < 0.5 {
            1.0 - below(k, p)
        } else {
            below(n - k + 1, 1.0 - p)
        }
    }

    #[test]
    fn the_ends_leave_half_of_the_rest_to_either_tail() {
        for (k, n) in [
            (1, 2),
            (3, 10),
            (7, 10),
            (50, 100),
            (99, 100),
            (1, 300),
            (299, 300),
        ] {
            for confidence in [0.5, 0.95, 0.999] {
                let (lower, upper) = clopper_pearson(k, n, confidence);
                let tail = 0.5 * (1.0 - confidence);
                assert!((at_least(k, n, lower) / tail - 1.0).abs() < 1e-9, "{k} {n}");
                let above = 1.0 - at_least(k + 1, n, upper);
                assert!((above / tail - 1.0).abs() < 1e-9, "{k} {n} {above}");
            }
        }
    }

    #[test]
    fn tails_far_below_rounding_are_known() {
        // None of 100: closed form, and the same from the other side.
        let expected = 1.0 - 1e-30f64.powf(0.01);
        assert!((upper_bound(0, 100, 1e-30) - expected).abs() < 1e-12);
        assert!((lower_bound(100, 100, 1e-30) - (1.0 - expected)).abs() < 1e-12);
    }

    #[test]
    fn known_values() {
        // None or all of n: closed form. One of two: 1 - sqrt(1 - 0.025), sqrt(1 - 0.025).
        let (lower, upper) = clopper_pearson(20, 20, 0.95);
        assert!((lower - 0.025f64.powf(0.05)).abs() < 1e-12 && upper == 1.0);
        let (lower, upper) = clopper_pearson(1, 2, 0.95);
        assert!((lower - (1.0 - 0.975f64.sqrt())).abs() < 1e-12);
        assert!((upper - 0.975f64.sqrt()).abs() < 1e-12);
        assert_eq!(clopper_pearson(0, 0, 0.95), (0.0, 1.0));
        // Large numbers come near to the normal approximation.
        let (lower, upper) = clopper_pearson(500_000, 1_000_000, 0.95);
        let normal = 1.959_963_985 * 0.0005;
        assert!((lower - (0.5 - normal)).abs() < 2e-6 && (upper - (0.5 + normal)).abs() < 2e-6);
    }
}

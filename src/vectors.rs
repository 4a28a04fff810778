//! Sums over slices in an order that no machine changes, and that every machine can put into vectors.

/// Independent sums; with more of them the golden streams of models would change.
const LANES: usize = 4;

/// a . b; what one slice is longer is left out.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let shared = a.len().min(b.len());
    let (a_blocks, a_rest) = a[..shared].as_chunks::<LANES>();
    let (b_blocks, b_rest) = b[..shared].as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (a, b) in a_blocks.iter().zip(b_blocks) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

/// y + s x into y, as far as both go.
pub(crate) fn add_scaled(y: &mut [f64], s: f64, x: &[f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += s * x;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_are_summed_exactly_at_any_length() {
        for n in 0..40u32 {
            let a: Vec<f64> = (0..n).map(f64::from).collect();
            let mut b: Vec<f64> = (0..n).map(|i| f64::from(3 * i + 1)).collect();
            let expected: u32 = (0..n).map(|i| i * (3 * i + 1)).sum();
            assert_eq!(dot(&a, &b), f64::from(expected));
            add_scaled(&mut b, -3.0, &a);
            assert!(b.iter().all(|b| *b == 1.0));
        }
    }
}

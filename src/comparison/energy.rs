//! How far draws lie from what was left out.

/// Draws are compared with so many that follow them: all pairs would cost more and tell little more.
const FOLLOWERS: usize = 10;

/// 2 E|X - y| - E|X - X'| - E|y - y'|: the energy distance (Szekely and Rizzo, Journal of Statistical Planning and Inference 143, 2013) of what is drawn to what
/// was left out, each draw and the demonstration seen in one vector or several. X and X' are of different draws, so over left-out
/// demonstrations the mean is smallest for the distribution that they come from (Gneiting and Raftery, JASA 102, 2007), and no narrower one gains; the last term is the
/// same for all models. Draws without a vector are left out; where none has any, the distance is infinite.
pub(super) fn distance(draws: &[Vec<Vec<f64>>], truth: &[Vec<f64>]) -> f64 {
    let draws: Vec<&Vec<Vec<f64>>> = draws.iter().filter(|d| !d.is_empty()).collect();
    let count = draws.len();
    if count == 0 {
        return f64::INFINITY;
    }
    let between = draws.iter().map(|x| mean(x, truth)).sum::<f64>() / count as f64;
    let followers = FOLLOWERS.min(count.saturating_sub(1));
    let pair = |i: usize| (1..=followers).map(move |j| (i, (i + j) % count));
    let within: f64 = (0..count)
        .flat_map(pair)
        .map(|(i, j)| mean(draws[i], draws[j]))
        .sum();
    let pairs = (count * followers).max(1) as f64;
    // Of different windows of the one demonstration; of one alone it is nothing.
    let own = truth.len() as f64;
    let within_truth = mean(truth, truth) * own / (own - 1.0).max(1.0);
    2.0 * between - within / pairs - within_truth
}

/// E |x - y|.
fn mean(xs: &[Vec<f64>], ys: &[Vec<f64>]) -> f64 {
    let sum: f64 = xs
        .iter()
        .flat_map(|x| ys.iter().map(move |y| apart(x, y)))
        .sum();
    sum / (xs.len() * ys.len()) as f64
}

fn apart(x: &[f64], y: &[f64]) -> f64 {
    let square: f64 = x.iter().zip(y).map(|(x, y)| (x - y) * (x - y)).sum();
    square.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_without_a_vector_are_left_out_and_of_none_the_distance_is_infinite() {
        let draws = [vec![], vec![vec![0.0]], vec![]];
        assert_eq!(distance(&draws, &[vec![1.0]]), 2.0);
        assert_eq!(distance(&draws[..1], &[vec![1.0]]), f64::INFINITY);
    }

    #[test]
    fn points_measure_as_by_hand_and_a_narrow_model_gains_nothing() {
        let at = |x: f64| vec![vec![x]];
        // X = 0 or 2, y = 1: 2 * 1 - 2.
        assert_eq!(distance(&[at(0.0), at(2.0)], &[vec![1.0]]), 0.0);
        assert_eq!(distance(&[at(1.0), at(1.0)], &[vec![1.0], vec![3.0]]), 0.0);
        // The truth is 0 or 2, half of the time each: drawing so is better than its mean, and better than one of both.
        let expected = |draws: &[Vec<Vec<f64>>]| {
            (distance(draws, &[vec![0.0]]) + distance(draws, &[vec![2.0]])) / 2.0
        };
        // X and X' are independent: in twos of either kind, 1 of 2 pairs differ.
        let fair: Vec<_> = (0..40).map(|i| at(f64::from((i / 10 % 2) * 2))).collect();
        assert!(expected(&fair) < expected(&[at(1.0), at(1.0)]));
        assert!(expected(&fair) < expected(&[at(0.0), at(0.0)]));
    }
}

//! Which of the angles that mean the same rotation.

use std::f64::consts::TAU;

use nalgebra::DMatrix;

/// Of the two sets of angles that turn the shoulder alike, (a, b, c) and (a + pi, pi - b, c + pi) with b in the `middle`, takes in
/// each sample the one that is nearest to the sample before, by the sum of their steps: angles then run on through where the
/// order is singular. Which set is the first is such that the median of the one in the middle is nearest 0.
pub(super) fn continuous(angles: &mut DMatrix<f64>, middle: usize) {
    let other = |set: [f64; 3]| {
        std::array::from_fn(|i| match i == middle {
            true => TAU / 2.0 - set[i],
            false => set[i] + TAU / 2.0,
        })
    };
    let mut sets: Vec<[f64; 3]> = Vec::with_capacity(angles.nrows());
    for row in angles.row_iter() {
        let set = [row[0], row[1], row[2]];
        let next = sets.last().map_or(set, |before| {
            let near = |set: [f64; 3]| -> [f64; 3] {
                std::array::from_fn(|i| set[i] - TAU * ((set[i] - before[i]) / TAU).round())
            };
            let way = |set: &[f64; 3]| -> f64 {
                set.iter().zip(before).map(|(a, b)| (a - b).abs()).sum()
            };
            let [own, others] = [near(set), near(other(set))];
            if way(&own) <= way(&others) {
                own
            } else {
                others
            }
        });
        sets.push(next);
    }
    // As far from 0 as whole turns leave it.
    let off = |angle: f64| (angle - TAU * (angle / TAU).round()).abs();
    let usual = median(sets.iter().map(|set| set[middle]));
    let swap = off(TAU / 2.0 - usual) < off(usual);
    for (mut row, set) in angles.row_iter_mut().zip(sets) {
        let set = if swap { other(set) } else { set };
        row.iter_mut()
            .zip(set)
            .for_each(|(angle, value)| *angle = value);
    }
}

/// Takes out steps of more than half a turn, and then as many turns as bring the median nearest 0.
pub(super) fn unwind(angles: &mut [f64]) {
    let mut turns = 0.0;
    for n in 1..angles.len() {
        let step = angles[n] + turns - angles[n - 1];
        turns -= TAU * (step / TAU).round();
        angles[n] += turns;
    }
    let turns = TAU * (median(angles.iter().copied()) / TAU).round();
    for angle in angles {
        *angle -= turns;
    }
}

/// The mean of the two in the middle where their count is even.
pub(super) fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    let half = values.len() / 2;
    let even = values.len().is_multiple_of(2);
    let (below, middle, _) = values.select_nth_unstable_by(half, f64::total_cmp);
    let middle = *middle;
    match below.iter().copied().max_by(f64::total_cmp) {
        Some(before) if even => 0.5 * (before + middle),
        _ => middle,
    }
}

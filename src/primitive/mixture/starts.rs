//! Where expectation maximisation starts: k-means++ (Arthur and Vassilvitskii, SODA 2007).

use std::cmp::Ordering;

use nalgebra::DMatrix;
use rand::RngExt;

use crate::primitive::chart::principal;
use crate::primitive::scatter::Charted;
use crate::primitive::stream;

/// Demonstrations by what they are: in whatever order they come, the same is drawn.
pub(super) fn sorted(charted: &Charted) -> Vec<usize> {
    let mut all: Vec<usize> = (0..charted.vectors.len()).collect();
    all.sort_by(|m, j| {
        let [x, y] = [m, j].map(|m| charted.vectors[*m].iter());
        x.zip(y)
            .map(|(x, y)| x.total_cmp(y))
            .find(|order| order.is_ne())
            .unwrap_or(Ordering::Equal)
    });
    all
}

/// Squared distances between demonstrations, in standard deviations of all that take part; phases the short way round, uniform ones left out.
pub(super) struct Distances {
    squared: DMatrix<f64>,
    present: Vec<usize>,
}

impl Distances {
    pub fn new(charted: &Charted, present: &[bool]) -> Self {
        let shares: Vec<f64> = present.iter().map(|p| f64::from(u8::from(*p))).collect();
        let scatter = charted.scatter(&shares);
        let (phases, after) = scatter.chart.starts();
        let count = present.len();
        let squared = DMatrix::from_fn(count, count, |m, j| {
            let (x, y) = (&charted.vectors[m], &charted.vectors[j]);
            (0..x.len())
                .filter(|i| scatter.deviations[*i] > 0.0)
                .map(|i| {
                    let difference = x[i] - y[i];
                    let is_angle = (phases..after).contains(&i);
                    let short = if is_angle {
                        principal(difference)
                    } else {
                        difference
                    };
                    (short / scatter.deviations[i]).powi(2)
                })
                .sum()
        });
        let present = sorted(charted)
            .into_iter()
            .filter(|m| present[*m])
            .collect();
        Self { squared, present }
    }

    /// Responsibilities (M x C), each demonstration of the kind whose centre is nearest; the centres are demonstrations, drawn one after the other by their
    /// squared distance from those before. `None` where fewer differ than there are kinds.
    pub fn start(&self, kinds: usize, seed: u64, number: u64) -> Option<DMatrix<f64>> {
        let mut rng = stream(seed, number);
        let mut centres: Vec<usize> = Vec::new();
        while centres.len() < kinds {
            let chances: Vec<f64> = self
                .present
                .iter()
                .map(|m| match self.nearest(*m, &centres) {
                    None => 1.0,
                    Some((_, squared)) => squared,
                })
                .collect();
            let total: f64 = chances.iter().sum();
            let mut left = rng.random::<f64>() * total;
            let drawn = chances.iter().position(|chance| {
                left -= chance;
                left < 0.0
            })?;
            centres.push(self.present[drawn]);
        }
        let mut responsibilities = DMatrix::zeros(self.squared.nrows(), kinds);
        for m in &self.present {
            let (kind, _) = self.nearest(*m, &centres)?;
            responsibilities[(*m, kind)] = 1.0;
        }
        Some(responsibilities)
    }

    fn nearest(&self, m: usize, centres: &[usize]) -> Option<(usize, f64)> {
        let distances = centres.iter().map(|j| self.squared[(m, *j)]).enumerate();
        distances.fold(None, |best: Option<(usize, f64)>, next| match best {
            Some(best) if best.1 <= next.1 => Some(best),
            _ => Some(next),
        })
    }
}

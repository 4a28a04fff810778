//! The density of a Gaussian whose covariance is a factor and a structured rest.

use nalgebra::{DMatrix, DVector};

use crate::primitive::Covariance;
use crate::vectors::dot;

/// N(0, f F F^T + t T), T what the blocks and independent parts of a covariance make, for many f and t: Woodbury's identity and the matrix determinant
/// lemma about T, whose inverse square root W is explicit but for what is left of a Kronecker product when some coordinates take no part.
/// Coordinates in which T has no variance are left out.
pub(crate) struct Density {
    whitening: Vec<Whitening>,
    logarithm: f64,
    /// How many coordinates there are.
    pub count: usize,
    /// W F.
    columns: Vec<Vec<f64>>,
    /// (W F)^T W F.
    gram: DMatrix<f64>,
}

/// Consecutive coordinates, or one.
struct Whitening {
    active: Vec<usize>,
    /// The lower Cholesky factor of T over the active ones, row by row.
    root: Vec<f64>,
}

impl Whitening {
    fn dense(active: Vec<usize>, entry: impl Fn(usize, usize) -> f64) -> Option<Self> {
        let m = active.len();
        let matrix = DMatrix::from_fn(m, m, |i, j| entry(active[i], active[j]));
        let root = matrix.cholesky()?.unpack().transpose();
        Some(Self {
            active,
            root: root.as_slice().to_vec(),
        })
    }

    fn logarithm(&self) -> f64 {
        let m = self.active.len();
        (0..m).map(|i| self.root[i * m + i].ln()).sum()
    }

    /// Appends W v.
    fn apply(&self, v: &[f64], whitened: &mut Vec<f64>) {
        let m = self.active.len();
        let from = whitened.len();
        for (i, at) in self.active.iter().enumerate() {
            let row = &self.root[i * m..][..=i];
            let sum = dot(&row[..i], &whitened[from..]);
            whitened.push((v[*at] - sum) / row[i]);
        }
    }
}

impl Density {
    pub fn new(covariance: &Covariance) -> Self {
        let mut whitening = Vec::new();
        let independent = covariance.independent();
        let mut in_block = vec![false; covariance.dimension()];
        for block in covariance.blocks() {
            let active: Vec<usize> = block
                .deviations()
                .iter()
                .enumerate()
                .filter(|(_, s)| **s > 0.0)
                .map(|(i, _)| block.start() + i)
                .collect();
            active.iter().for_each(|i| in_block[*i] = true);
            whitening.extend(Whitening::dense(active, |i, j| {
                let alone = if i == j { independent[i].powi(2) } else { 0.0 };
                block.covariance(i, j) + alone
            }));
        }
        for (i, s) in independent.iter().enumerate() {
            if *s > 0.0 && !in_block[i] {
                whitening.extend(Whitening::dense(vec![i], |_, _| s * s));
            }
        }
        let mut density = Self {
            logarithm: whitening.iter().map(Whitening::logarithm).sum(),
            count: whitening.iter().map(|w| w.active.len()).sum(),
            whitening,
            columns: Vec::new(),
            gram: DMatrix::zeros(0, 0),
        };
        let factor = covariance.factor();
        density.columns = factor
            .column_iter()
            .map(|c| density.whitened(c.as_slice()))
            .collect();
        let r = density.columns.len();
        density.gram = DMatrix::from_fn(r, r, |i, j| dot(&density.columns[i], &density.columns[j]));
        density
    }

    fn whitened(&self, v: &[f64]) -> Vec<f64> {
        let mut whitened = Vec::with_capacity(self.count);
        for part in &self.whitening {
            part.apply(v, &mut whitened);
        }
        whitened
    }

    /// The natural logarithm of the density at `deviation` (n), for shares f > 0 of F F^T and t > 0 of T.
    pub fn log(&self, deviation: &[f64], f: f64, t: f64) -> f64 {
        let whitened = self.whitened(deviation);
        let r = self.columns.len();
        // f F F^T + t T has determinant t^p |T| |I + (f/t) G|.
        let inner = DMatrix::identity(r, r) + &self.gram * (f / t);
        let mut quadratic = dot(&whitened, &whitened) / t;
        let mut logarithm = self.logarithm + 0.5 * self.count as f64 * t.ln();
        // Its eigenvalues are 1 and more.
        if let Some(cholesky) = inner.cholesky() {
            let mut projected =
                DVector::from_iterator(r, self.columns.iter().map(|c| dot(c, &whitened)));
            cholesky
                .l_dirty()
                .solve_lower_triangular_mut(&mut projected);
            quadratic -= projected.norm_squared() * f / (t * t);
            logarithm += (0..r).map(|i| cholesky.l_dirty()[(i, i)].ln()).sum::<f64>();
        }
        -0.5 * (quadratic + self.count as f64 * std::f64::consts::TAU.ln()) - logarithm
    }
}

//! [`Covariance`]: a covariance matrix that is never formed, only its action.

use fearless_simd::{Level, dispatch};
use nalgebra::{DMatrix, DVector};

use super::Kronecker;
use crate::error::{Error, ErrorKind, Result};
use crate::vectors::dot;

/// The covariance of n coordinates as a sum of three parts,
///
/// ```text
/// Sigma = F F^T + sum_b S_b (A_b (x) R_b) S_b + diag(s)^2 = B B^T
/// ```
///
/// a factor F (n x r), Kronecker blocks on consecutive coordinates ([`Kronecker`]), and coordinates that vary on their own.
/// B is a square root of l columns, in this order: those of F, those of each block, one for each coordinate with s > 0.
/// Everything else (draws, conditioning, densities) is made of products with B and its transpose, O(n r) each.
#[derive(Debug, Clone, PartialEq)]
pub struct Covariance {
    factor: DMatrix<f64>,
    blocks: Vec<Kronecker>,
    independent: DVector<f64>,
    /// The coordinates with s > 0.
    alone: Vec<usize>,
}

impl Covariance {
    /// Of a factor (n x r), blocks within the n coordinates, and standard deviations s (n) of what each coordinate does alone.
    ///
    /// # Errors
    /// When sizes do not fit, blocks overlap, or a number is not finite or a standard deviation negative.
    pub fn new(
        factor: DMatrix<f64>,
        mut blocks: Vec<Kronecker>,
        independent: DVector<f64>,
    ) -> Result<Self> {
        let n = factor.nrows();
        blocks.sort_by_key(Kronecker::start);
        let mut free = 0;
        for block in &blocks {
            let end = block.start().checked_add(block.len());
            if block.start() < free || end.is_none_or(|end| end > n) {
                return Err(Error::new(
                    ErrorKind::Shape,
                    format!(
                        "a block of {} coordinates from {}",
                        block.len(),
                        block.start()
                    ),
                )
                .expected(format!("blocks within {n} coordinates that do not overlap")));
            }
            free = block.start() + block.len();
        }
        if independent.len() != n {
            return Err(Error::new(
                ErrorKind::Shape,
                format!(
                    "{} standard deviations for {n} coordinates",
                    independent.len()
                ),
            ));
        }
        if factor.iter().any(|f| !f.is_finite())
            || independent.iter().any(|s| !(s.is_finite() && *s >= 0.0))
        {
            return Err(Error::new(
                ErrorKind::Value,
                "a covariance has entries that are not finite, or negative standard deviations",
            ));
        }
        let alone = (0..n).filter(|i| independent[*i] > 0.0).collect();
        Ok(Self {
            factor,
            blocks,
            independent,
            alone,
        })
    }

    /// F F^T alone.
    ///
    /// # Errors
    /// When a number is not finite.
    pub fn of_factor(factor: DMatrix<f64>) -> Result<Self> {
        let independent = DVector::zeros(factor.nrows());
        Self::new(factor, Vec::new(), independent)
    }

    /// Coordinate i times `scales[i]`, and with what it does alone of standard deviation `alone[i]` more.
    pub(crate) fn rescaled(&self, scales: &[f64], alone: &DVector<f64>) -> Result<Self> {
        let mut factor = self.factor.clone();
        for (mut row, scale) in factor.row_iter_mut().zip(scales) {
            row *= *scale;
        }
        let blocks = self.blocks.iter().map(|b| b.rescaled(scales)).collect();
        let independent = DVector::from_fn(scales.len(), |i, _| {
            (scales[i] * self.independent[i]).hypot(alone[i])
        });
        Self::new(factor, blocks, independent)
    }

    /// n.
    pub fn dimension(&self) -> usize {
        self.factor.nrows()
    }

    /// l, the number of columns of B.
    pub fn latent(&self) -> usize {
        self.factor.ncols()
            + self.blocks.iter().map(Kronecker::len).sum::<usize>()
            + self.alone.len()
    }

    /// F (n x r).
    pub fn factor(&self) -> &DMatrix<f64> {
        &self.factor
    }

    /// The Kronecker blocks, by their first coordinate.
    pub fn blocks(&self) -> &[Kronecker] {
        &self.blocks
    }

    /// s (n): the standard deviation of what each coordinate does alone.
    pub fn independent(&self) -> &DVector<f64> {
        &self.independent
    }

    /// Where in z the columns of B begin that move only the coordinates from `start` on, if these have a block.
    pub(super) fn latent_of_block(&self, start: usize) -> Option<std::ops::Range<usize>> {
        let mut at = self.factor.ncols();
        for block in &self.blocks {
            if block.start() == start {
                return Some(at..at + block.len());
            }
            at += block.len();
        }
        None
    }

    /// x += B z. The order of summation is fixed: the same bits everywhere, in vectors of any width.
    pub(super) fn apply(&self, z: &[f64], x: &mut [f64]) {
        let longest = self.blocks.iter().map(Kronecker::len).max().unwrap_or(0);
        let mut scratch = vec![0.0; longest];
        dispatch!(Level::new(), _ => self.apply_in_vectors(z, x, &mut scratch));
    }

    #[inline(always)]
    fn apply_in_vectors(&self, z: &[f64], x: &mut [f64], scratch: &mut [f64]) {
        let (of_factor, mut rest) = z.split_at(self.factor.ncols());
        let n = self.dimension();
        let columns = self.factor.as_slice();
        // Slices, so that it becomes vectors.
        for (j, z) in of_factor.iter().enumerate() {
            for (x, f) in x.iter_mut().zip(&columns[j * n..][..n]) {
                *x += f * z;
            }
        }
        for block in &self.blocks {
            let (of_block, after) = rest.split_at(block.len());
            let own = &mut x[block.start()..][..block.len()];
            block.apply(of_block, own, &mut scratch[..block.len()]);
            rest = after;
        }
        for (i, z) in self.alone.iter().zip(rest) {
            x[*i] += self.independent[*i] * z;
        }
    }

    /// B^T g (l).
    pub(super) fn apply_transposed(&self, g: &[f64]) -> Vec<f64> {
        let mut z = Vec::with_capacity(self.latent());
        for column in self.factor.column_iter() {
            z.push(dot(column.as_slice(), g));
        }
        for block in &self.blocks {
            block.apply_transposed(&g[block.start()..][..block.len()], &mut z);
        }
        z.extend(self.alone.iter().map(|i| self.independent[*i] * g[*i]));
        z
    }

    /// Variance of coordinate `i`.
    pub fn variance(&self, i: usize) -> f64 {
        let of_blocks: f64 = self.blocks.iter().map(|b| b.covariance(i, i)).sum();
        self.factor.row(i).norm_squared() + of_blocks + self.independent[i].powi(2)
    }

    /// Sigma (n x n).
    pub fn dense(&self) -> DMatrix<f64> {
        let mut sigma = &self.factor * self.factor.transpose();
        for block in &self.blocks {
            let range = block.start()..block.start() + block.len();
            for j in range.clone() {
                for i in range.clone() {
                    sigma[(i, j)] += block.covariance(i, j);
                }
            }
        }
        for i in &self.alone {
            sigma[(*i, *i)] += self.independent[*i].powi(2);
        }
        sigma
    }
}

//! [`Reference`]: the Gaussian that trajectories follow exactly, learned in warm-up.

use nalgebra::{DMatrix, SymmetricEigen};

use crate::vectors::{add_scaled, dot};

/// A direction whose variance is above this is left as the prior has it: it would gain less than its estimate is off.
const NARROW: f64 = 0.7;

/// Rounds of subspace iteration; the gradients of tight observations stand out by orders of magnitude.
const ROUNDS: usize = 4;

/// Draws for each direction that is learned, at least: a covariance of r directions from 5 r draws is off by a factor of two
/// at most.
const DRAWS_A_DIRECTION: usize = 5;

/// Draws' worth of the prior in a covariance that is learned: without, directions that happen to look narrow after a short
/// warm-up are crossed slowly ever after.
const PRIOR_DRAWS: f64 = 20.0;

/// Orthogonal to what is there already, a gradient this much shorter is no new direction.
const DEPENDENT: f64 = 1e-8;

/// The QR algorithm needs two or three iterations an eigenvalue.
const MOST_ITERATIONS: usize = 10_000;

/// z = m + A x with A = I + sum_j (s_j - 1) q_j q_j^T, orthonormal q_j: where the posterior is about N(m, A A^T), x is about
/// N(0, I). Narrow directions are stretched, all others are as in the prior.
#[derive(Debug, Clone)]
pub(super) struct Reference {
    mean: Vec<f64>,
    /// q_j (n) with s_j - 1 and 1 / s_j - 1.
    directions: Vec<(Vec<f64>, f64, f64)>,
}

impl Reference {
    /// The prior, z = x.
    pub fn prior(dimension: usize) -> Self {
        Self {
            mean: vec![0.0; dimension],
            directions: Vec::new(),
        }
    }

    /// z of x.
    pub fn latent(&self, x: &[f64], z: &mut [f64]) {
        z.copy_from_slice(x);
        for (q, stretch, _) in &self.directions {
            add_scaled(z, stretch * dot(q, x), q);
        }
        add_scaled(z, 1.0, &self.mean);
    }

    /// x of z.
    pub fn whitened(&self, z: &[f64], x: &mut [f64]) {
        x.copy_from_slice(z);
        add_scaled(x, -1.0, &self.mean);
        // Orthonormal directions: what one of them changes the others do not see.
        for (q, _, shrink) in &self.directions {
            let along = dot(q, x);
            add_scaled(x, shrink * along, q);
        }
    }

    /// A g: the gradient over x of what has gradient g over z.
    pub fn pull_back(&self, gradient: &mut [f64]) {
        for (q, stretch, _) in &self.directions {
            let along = dot(q, gradient);
            add_scaled(gradient, stretch * along, q);
        }
    }

    /// From `draws` z and the gradients of L there.
    ///
    /// Gradients J^T r of tight observations y(z) span few directions: the leading ones, `most` at most, are found by
    /// subspace iteration. Within them the reference has the draws' mean and covariance, the latter with a share of the
    /// prior's, since it may be that of a few draws' worth.
    ///
    /// It is as wide as the posterior and not as stiff as its curvature, on purpose: where J turns along the posterior, the
    /// inverse mean curvature, or its geometric mean with the covariance (Seyboldt, Carlson and Carpenter, arXiv
    /// 2503.18845, 2025), is narrower than the posterior, and chains mixed worse with it (DESIGN.md).
    pub fn learn(draws: &[Vec<f64>], gradients: &[Vec<f64>], most: usize) -> Self {
        let dimension = draws.first().map_or(0, Vec::len);
        let count = most.min(draws.len() / DRAWS_A_DIRECTION).min(dimension);
        let mut reference = Self::prior(dimension);
        let basis = leading(&centred(gradients), count);
        if basis.is_empty() {
            return reference;
        }
        let project = |v: &Vec<f64>| basis.iter().map(|q| dot(q, v)).collect();
        let places: Vec<Vec<f64>> = draws.iter().map(project).collect();
        let middle = mean(&places);
        let Some((variances, turn)) = eigen(covariance(&places)) else {
            return reference;
        };
        for (j, variance) in variances.iter().enumerate() {
            if !(*variance > 0.0 && *variance < NARROW) {
                continue;
            }
            let mut q = vec![0.0; dimension];
            let mut place = 0.0;
            for (i, axis) in basis.iter().enumerate() {
                add_scaled(&mut q, turn[(i, j)], axis);
                place += turn[(i, j)] * middle[i];
            }
            add_scaled(&mut reference.mean, place, &q);
            let scale = libm::sqrt(*variance);
            reference
                .directions
                .push((q, scale - 1.0, 1.0 / scale - 1.0));
        }
        reference
    }
}

fn mean(vectors: &[Vec<f64>]) -> Vec<f64> {
    let mut mean = vec![0.0; vectors[0].len()];
    for v in vectors {
        add_scaled(&mut mean, 1.0 / vectors.len() as f64, v);
    }
    mean
}

fn centred(vectors: &[Vec<f64>]) -> Vec<Vec<f64>> {
    if vectors.is_empty() {
        return Vec::new();
    }
    let mean = mean(vectors);
    let mut vectors = vectors.to_vec();
    for v in &mut vectors {
        add_scaled(v, -1.0, &mean);
    }
    vectors
}

/// As if `PRIOR_DRAWS` of the prior's were among them.
fn covariance(vectors: &[Vec<f64>]) -> DMatrix<f64> {
    let centred = centred(vectors);
    let r = centred[0].len();
    DMatrix::from_fn(r, r, |i, j| {
        let products = centred.iter().map(|v| v[i] * v[j]);
        let prior = if i == j { PRIOR_DRAWS } else { 0.0 };
        (products.sum::<f64>() + prior) / (centred.len() as f64 + PRIOR_DRAWS)
    })
}

/// Orthonormal vectors that span the leading `count` principal directions of `vectors`, fewer where there are fewer.
fn leading(vectors: &[Vec<f64>], count: usize) -> Vec<Vec<f64>> {
    // Vectors from all over the chain, as it moves slowly at first.
    let stride = (vectors.len() / count.max(1)).max(1);
    let first = vectors.iter().step_by(stride).take(count);
    let mut basis = orthonormal(first.cloned().collect());
    for _ in 0..ROUNDS {
        // V^T (V b) for each b.
        let next = basis.iter().map(|b| {
            let mut product = vec![0.0; b.len()];
            for v in vectors {
                add_scaled(&mut product, dot(v, b), v);
            }
            product
        });
        basis = orthonormal(next.collect());
    }
    basis
}

/// Gram and Schmidt, twice for each vector so that rounding leaves no angle; without those that depend on earlier ones.
fn orthonormal(vectors: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::with_capacity(vectors.len());
    for mut v in vectors {
        let before = dot(&v, &v);
        for _ in 0..2 {
            for q in &basis {
                let along = dot(q, &v);
                add_scaled(&mut v, -along, q);
            }
        }
        let left = dot(&v, &v);
        if left > DEPENDENT * DEPENDENT * before && left.is_finite() {
            let scale = 1.0 / libm::sqrt(left);
            v.iter_mut().for_each(|v| *v *= scale);
            basis.push(v);
        }
    }
    basis
}

/// Eigenvalues, and eigenvectors as columns; none, where numbers overflowed.
fn eigen(symmetric: DMatrix<f64>) -> Option<(Vec<f64>, DMatrix<f64>)> {
    if symmetric.iter().any(|v| !v.is_finite()) {
        return None;
    }
    let eigen = SymmetricEigen::try_new(symmetric, f64::EPSILON, MOST_ITERATIONS)?;
    Some((eigen.eigenvalues.as_slice().to_vec(), eigen.eigenvectors))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::normal;
    use rand::SeedableRng;
    use rand::rngs::ChaCha8Rng;

    /// Draws of N((1, .., 1) / 10, I - 0.99 q q^T), q = (1, 1, 0, ..) / sqrt 2, with gradients along q.
    fn learned() -> (Reference, Vec<f64>) {
        let n = 20;
        let mut q = vec![0.0; n];
        q[0] = 0.5f64.sqrt();
        q[1] = q[0];
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let (mut draws, mut gradients) = (Vec::new(), Vec::new());
        for _ in 0..2000 {
            let mut z = vec![0.0; n];
            normal::fill(&mut rng, &mut z);
            let along = dot(&q, &z);
            add_scaled(&mut z, -0.9 * along, &q);
            z.iter_mut().for_each(|z| *z += 0.1);
            gradients.push(q.iter().map(|q| 10.0 * along * q).collect());
            draws.push(z);
        }
        (Reference::learn(&draws, &gradients, 4), q)
    }

    #[test]
    fn one_narrow_direction_is_found() {
        let (reference, q) = learned();
        assert_eq!(reference.directions.len(), 1);
        let (found, stretch, _) = &reference.directions[0];
        assert!((dot(found, &q).abs() - 1.0).abs() < 1e-12);
        // sqrt((2000 x 0.01 + 20) / 2020): the prior has its share.
        assert!((stretch + 1.0 - 0.1407).abs() < 0.005, "{stretch}");
        assert!((reference.mean[0] - 0.1).abs() < 0.01 && reference.mean[2].abs() < 1e-12);
    }

    #[test]
    fn whitening_is_the_inverse_and_pulling_back_the_transpose() {
        let (reference, _) = learned();
        let x: Vec<f64> = (0..20).map(|i| f64::from(i) * 0.1 - 0.7).collect();
        let (mut z, mut back, mut origin) = (x.clone(), x.clone(), x.clone());
        reference.latent(&x, &mut z);
        reference.whitened(&z, &mut back);
        assert!(x.iter().zip(&back).all(|(a, b)| (a - b).abs() < 1e-13));
        // g . (z(x) - z(0)) = A g . x
        reference.latent(&[0.0; 20], &mut origin);
        let g: Vec<f64> = (0..20).map(|i| f64::from(i * i % 7) - 3.0).collect();
        let mut pulled = g.clone();
        reference.pull_back(&mut pulled);
        let along: f64 = (0..20).map(|i| g[i] * (z[i] - origin[i])).sum();
        assert!((along - dot(&pulled, &x)).abs() < 1e-12);
    }

    #[test]
    fn what_cannot_be_learned_from_leaves_the_prior() {
        let flat = vec![vec![0.0; 3]; 50];
        let draws: Vec<Vec<f64>> = (0..50).map(|i| vec![f64::from(i % 7) - 3.0; 3]).collect();
        assert!(Reference::learn(&draws, &flat, 3).directions.is_empty());
        assert!(Reference::learn(&[], &[], 3).directions.is_empty());
        let huge: Vec<Vec<f64>> = (0..50)
            .map(|i| vec![1e200 * f64::from(i), 1.0, 0.0])
            .collect();
        Reference::learn(&draws, &huge, 3);
        Reference::learn(&huge, &huge, 3);
    }
}

//! Moments of trajectories by tensor Gauss-Hermite quadrature over the latent numbers of a primitive.

use nalgebra::{DMatrix, DVector};
use undulate::Derivative::{Acceleration, Jerk, Position, Velocity};
use undulate::{Derivative, FourierMovementPrimitive, StartSpread, Wave};

/// What is looked at of a trajectory: all joints at each of these.
pub type Instants = [(f64, Derivative)];

/// y of one wave at all instants, that much later.
pub fn trajectory(wave: &Wave, instants: &Instants, delay: f64) -> DVector<f64> {
    let entries = instants.iter().flat_map(|(t, derivative)| {
        let state = wave.state(t + delay);
        let y = match derivative {
            Position => state.position,
            Velocity => state.velocity,
            Acceleration => state.acceleration,
            Jerk => state.jerk,
        };
        y.as_slice().to_vec()
    });
    DVector::from_vec(entries.collect())
}

/// Nodes and weights for the standard normal density (Golub and Welsch, Mathematics of Computation 23, 1969): eigenvalues of the Jacobi matrix of
/// the Hermite polynomials, and the squares of the first entries of its eigenvectors.
fn gauss_hermite(points: usize) -> Vec<(f64, f64)> {
    let jacobi = DMatrix::from_fn(points, points, |i, j| {
        if i.abs_diff(j) == 1 {
            (i.max(j) as f64).sqrt()
        } else {
            0.0
        }
    });
    let eigen = jacobi.symmetric_eigen();
    let weights = eigen.eigenvectors.row(0).map(|v| v * v);
    eigen
        .eigenvalues
        .iter()
        .copied()
        .zip(weights.iter().copied())
        .collect()
}

/// A pair of terms is exp(c^T z) with |c_i| below 1.35 in what follows; n nodes leave |c|^2n n! / (2n)! of it, here 1e-15.
const NODES: usize = 14;

/// Delays and their weights; the trapezoidal rule is exact for a uniform start, since a product has no harmonic beyond 2 K.
fn delays(start: StartSpread, primitive: &FourierMovementPrimitive) -> Vec<(f64, f64)> {
    match start {
        StartSpread::None => vec![(0.0, 1.0)],
        StartSpread::Uniform => {
            let (points, period) = (
                2 * primitive.chart().harmonics() + 1,
                primitive.chart().period().unwrap(),
            );
            let share = 1.0 / points as f64;
            (0..points)
                .map(|i| (period * i as f64 * share, share))
                .collect()
        }
        StartSpread::Normal(deviation) => gauss_hermite(NODES)
            .into_iter()
            .map(|(node, weight)| (deviation * node, weight))
            .collect(),
    }
}

/// Mean and covariance by tensor quadrature over z of x = mu + F z.
pub fn quadrature(
    primitive: &FourierMovementPrimitive,
    start: StartSpread,
    instants: &Instants,
) -> (DVector<f64>, DMatrix<f64>) {
    let (mu, factor) = (primitive.gaussian().mean(), primitive.gaussian().factor());
    let (rule, delays) = (gauss_hermite(NODES), delays(start, primitive));
    // Relative to the wave at the mean, so that the difference of moments loses nothing.
    let origin = trajectory(&primitive.mean_wave(), instants, 0.0);
    let mut first = DVector::zeros(origin.len());
    let mut second = DMatrix::zeros(origin.len(), origin.len());
    for index in 0..NODES.pow(factor.ncols() as u32) {
        let (mut rest, mut weight) = (index, 1.0);
        let z = DVector::from_fn(factor.ncols(), |_, _| {
            let (node, share) = rule[rest % NODES];
            rest /= NODES;
            weight *= share;
            node
        });
        let wave = primitive.chart().wave(&(mu + &factor * z)).unwrap();
        for (delay, share) in &delays {
            let y = trajectory(&wave, instants, *delay) - &origin;
            first.axpy(weight * share, &y, 1.0);
            second.ger(weight * share, &y, &y, 1.0);
        }
    }
    (origin + &first, second - &first * first.transpose())
}

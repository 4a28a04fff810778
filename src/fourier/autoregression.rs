//! [`Autoregression`]: how one cycle resembles the one before it.

use crate::error::{Error, ErrorKind, Result};

/// A stationary autoregression of first order with variance 1, x_c = phi x_{c-1} + s e_c.
///
/// On a line of cycles its covariance at lag k is phi^|k|. On a ring of C cycles, where cycle 0 follows cycle C-1, the same
/// recursion has one solution, and with s^2 = (1 - phi^2)(1 - phi^C)/(1 + phi^C) its covariance is circulant and exactly
///
/// ```text
/// E x_c x_{c+k} = (phi^k + phi^{C-k}) / (1 + phi^C),   k = 0..C
/// ```
///
/// which is phi^k but for the wrap, and whose spectrum is that of the line at the frequencies j/C.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Autoregression {
    coefficient: f64,
}

impl Autoregression {
    /// phi: the correlation of successive cycles on a line.
    ///
    /// # Errors
    /// When it is not between -1 and 1, both excluded.
    pub fn new(coefficient: f64) -> Result<Self> {
        if coefficient.abs() < 1.0 {
            Ok(Self { coefficient })
        } else {
            Err(Error::new(
                ErrorKind::Value,
                format!("autoregression with coefficient {coefficient}"),
            )
            .expected("between -1 and 1: otherwise nothing is stationary"))
        }
    }

    /// phi.
    pub fn coefficient(&self) -> f64 {
        self.coefficient
    }

    /// A draw on the ring of C = `normals.len()` cycles from as many independent standard normal numbers e_c.
    /// Products and sums in a fixed order and one square root: the same bits everywhere.
    pub fn on_ring(&self, normals: &[f64]) -> Vec<f64> {
        let phi = self.coefficient;
        // phi^C and sum phi^k e_{-k}, the solution at cycle 0 but for the times it has gone round: Horner's scheme.
        let mut around = 1.0;
        let mut last = 0.0;
        for e in normals {
            around *= phi;
            last = phi * last + e;
        }
        let scale = libm::sqrt((1.0 - phi * phi) * (1.0 - around) / (1.0 + around));
        let mut x = scale * last / (1.0 - around);
        normals
            .iter()
            .map(|e| {
                x = phi * x + scale * e;
                x
            })
            .collect()
    }

    /// Spectral density at `frequency` \[1/cycle\], -1/2 to 1/2, with integral 1:
    /// (1 - phi^2) / |1 - phi exp(-2 pi i frequency)|^2.
    pub fn density(&self, frequency: f64) -> f64 {
        let phi = self.coefficient;
        let cos = libm::cos(std::f64::consts::TAU * frequency);
        (1.0 - phi * phi) / (1.0 - 2.0 * phi * cos + phi * phi)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The draw is linear in its normals, so unit vectors give its matrix, and the matrix its exact covariance.
    #[test]
    fn covariance_on_the_ring_is_the_one_stated() {
        for cycles in [1, 2, 3, 7, 10] {
            for phi in [-0.7, 0.0, 0.4, 0.95] {
                let process = Autoregression::new(phi).unwrap();
                let columns: Vec<Vec<f64>> = (0..cycles)
                    .map(|i| {
                        let mut unit = vec![0.0; cycles];
                        unit[i] = 1.0;
                        process.on_ring(&unit)
                    })
                    .collect();
                for c in 0..cycles {
                    for k in 0..cycles {
                        let found: f64 = columns.iter().map(|x| x[c] * x[(c + k) % cycles]).sum();
                        let expected = (phi.powi(k as i32) + phi.powi((cycles - k) as i32))
                            / (1.0 + phi.powi(cycles as i32));
                        assert!(
                            (found - expected).abs() < 1e-12,
                            "C {cycles}, phi {phi}, cycle {c}, lag {k}: {found} {expected}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn a_draw_obeys_the_recursion_across_the_seam() {
        let normals = [0.3, -1.2, 0.7, 2.0, -0.1, 0.4];
        let phi = 0.6;
        let x = Autoregression::new(phi).unwrap().on_ring(&normals);
        let around = phi.powi(6);
        let scale = ((1.0 - phi * phi) * (1.0 - around) / (1.0 + around)).sqrt();
        for c in 0..6 {
            let before = x[(c + 5) % 6];
            assert!((x[c] - phi * before - scale * normals[c]).abs() < 1e-14);
        }
    }

    #[test]
    fn density_is_the_transform_of_the_covariance_and_integrates_to_one() {
        let process = Autoregression::new(0.5).unwrap();
        for lag in 0..4 {
            let found: f64 = (0..1000)
                .map(|i| {
                    let frequency = (f64::from(i) + 0.5) / 1000.0 - 0.5;
                    process.density(frequency)
                        * (std::f64::consts::TAU * frequency * f64::from(lag)).cos()
                        / 1000.0
                })
                .sum();
            assert!((found - 0.5f64.powi(lag)).abs() < 1e-12, "lag {lag}");
        }
    }

    #[test]
    fn what_would_not_be_stationary_is_refused() {
        for phi in [1.0, -1.0, 2.0, f64::NAN] {
            assert!(Autoregression::new(phi).is_err());
        }
    }
}

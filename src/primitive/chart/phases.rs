//! Phases in the vector: which joint each is relative to, and its branch.

use std::sync::Arc;

use super::PhaseForm;

/// D x K phases, joint by joint.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::primitive) struct Phases {
    form: PhaseForm,
    /// Where phases are relative.
    reference: Option<usize>,
    harmonics: usize,
    /// The branch of entry i is (c_i - pi, c_i + pi]. Fixed at learning, and never moved: else the order of observations mattered.
    centres: Arc<[f64]>,
    /// Whether all harmonics hang on the first one of the reference joint.
    locked: bool,
}

impl Phases {
    pub fn principal(joints: usize, harmonics: usize) -> Self {
        let centres = vec![0.0; joints * harmonics];
        Self::new(PhaseForm::Principal, 0, harmonics, centres, false)
    }

    pub fn new(
        form: PhaseForm,
        reference: usize,
        harmonics: usize,
        centres: Vec<f64>,
        locked: bool,
    ) -> Self {
        Self {
            locked,
            form,
            reference: (form == PhaseForm::Relative).then_some(reference),
            harmonics,
            centres: centres.into(),
        }
    }

    pub fn form(&self) -> PhaseForm {
        self.form
    }

    pub fn centres(&self) -> &[f64] {
        &self.centres
    }

    /// The reference joint, where phases are relative.
    pub fn reference(&self) -> Option<usize> {
        self.reference
    }

    pub fn about(&self, centres: Vec<f64>) -> Self {
        Self {
            centres: centres.into(),
            ..self.clone()
        }
    }

    /// The entry that is added to that of joint `d` and harmonic `k` (from 0) to make Arg w, and how often.
    pub fn anchor(&self, d: usize, k: usize) -> Option<(usize, f64)> {
        let reference = self.reference()?;
        if self.locked {
            ((d, k) != (reference, 0)).then_some((reference * self.harmonics, (k + 1) as f64))
        } else {
            (d != reference).then_some((reference * self.harmonics + k, 1.0))
        }
    }

    /// The entries whose sum, with whole coefficients, is Arg w of joint `d` and harmonic `k` (from 0).
    pub fn row(&self, d: usize, k: usize) -> Vec<(usize, f64)> {
        let own = (d * self.harmonics + k, 1.0);
        std::iter::once(own).chain(self.anchor(d, k)).collect()
    }

    /// Arg w becomes entries of x.
    pub fn chart(&self, phases: &mut [f64]) {
        self.add_reference(phases, -1.0);
        self.wrap(phases);
    }

    /// Entries of x become Arg w, on some branch.
    pub fn absolute(&self, phases: &mut [f64]) {
        self.add_reference(phases, 1.0);
    }

    fn wrap(&self, phases: &mut [f64]) {
        for (phase, centre) in phases.iter_mut().zip(self.centres.iter()) {
            *phase = branch(*phase, *centre);
        }
    }

    fn add_reference(&self, phases: &mut [f64], sign: f64) {
        let Some(reference) = self.reference() else {
            return;
        };
        let length = self.harmonics;
        if self.locked {
            let start = sign * phases[reference * length];
            for (i, phase) in phases.iter_mut().enumerate() {
                if i != reference * length {
                    *phase += (i % length + 1) as f64 * start;
                }
            }
            return;
        }
        let (before, rest) = phases.split_at_mut(reference * length);
        let (reference, after) = rest.split_at_mut(length);
        for joint in before
            .chunks_exact_mut(length)
            .chain(after.chunks_exact_mut(length))
        {
            for (phase, reference) in joint.iter_mut().zip(reference.iter()) {
                *phase += sign * reference;
            }
        }
    }
}

/// The representative of an angle in (centre - pi, centre + pi].
pub(in crate::primitive) fn branch(angle: f64, centre: f64) -> f64 {
    let turned = centre + principal(angle - centre);
    // Rounding of the sum must not leave the branch by its open end.
    if turned <= centre - std::f64::consts::PI {
        turned + std::f64::consts::TAU
    } else {
        turned
    }
}

/// The representative of an angle in (-pi, pi].
pub(in crate::primitive) fn principal(angle: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    let turned = angle - TAU * libm::round(angle / TAU);
    if turned <= -PI {
        turned + TAU
    } else if turned > PI {
        turned - TAU
    } else {
        turned
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn principal_values_are_half_open() {
        assert_eq!(principal(PI), PI);
        assert_eq!(principal(-PI), PI);
        assert!((principal(7.0 * PI + 0.1) - (0.1 - PI)).abs() < 1e-14);
    }

    #[test]
    fn an_angle_at_the_cut_stands_at_the_upper_end_of_its_branch() {
        for centre in [0.0, 0.3, -2.0, 3.0] {
            let (upper, lower) = (branch(centre + PI, centre), branch(centre - PI, centre));
            assert!((upper - (centre + PI)).abs() < 1e-15 && (lower - upper).abs() < 1e-15);
        }
    }

    #[test]
    fn relative_phases_go_there_and_back() {
        let phases = Phases::new(
            PhaseForm::Relative,
            1,
            2,
            vec![0.1, 3.0, -1.0, 0.0, 2.0, 1.0],
            false,
        );
        let absolute = [0.5, 1.0, 3.0, -3.0, -2.0, 0.0];
        let mut x = absolute;
        phases.chart(&mut x);
        assert!((x[0] - (0.5 - 3.0)).abs() < 1e-15 && (x[2] - (3.0 - 2.0 * PI)).abs() < 1e-15);
        phases.absolute(&mut x);
        for (x, a) in x.iter().zip(absolute) {
            assert!(principal(x - a).abs() < 1e-14);
        }
    }
}

//! The alignment that every baseline gets: each recording's own tempo, and where its dominant joint first turns.

use std::f64::consts::TAU;

use crate::demonstration::{CycleFits, Recording};
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::Wave;

/// A recording with its rhythm.
pub(super) struct Aligned<'a> {
    pub recording: &'a Recording,
    /// Of the mean cycle \[Hz\].
    pub frequency: f64,
    /// When the dominant joint's first harmonic is at its upper turning point first, since the first stamp \[s\].
    pub start: f64,
}

impl<'a> Aligned<'a> {
    /// A recording in a joint of it, from its cycle with so many harmonics; none without a rhythm.
    pub fn of(recording: &'a Recording, joint: usize, harmonics: usize) -> Option<Self> {
        let cycle = cycle(recording, harmonics)?;
        Some(Self::from_cycle(recording, &cycle, joint))
    }

    fn from_cycle(recording: &'a Recording, cycle: &Wave, joint: usize) -> Self {
        let left = (-cycle.weights()[(joint, 0)].arg() / TAU).rem_euclid(1.0);
        Self {
            recording,
            frequency: 1.0 / cycle.period(),
            start: left * cycle.period(),
        }
    }
}

fn cycle(recording: &Recording, harmonics: usize) -> Option<Wave> {
    let fits = CycleFits::new(std::slice::from_ref(recording), harmonics).ok()?;
    Some(fits.fits().first()?.wave.clone())
}

/// The recordings that have a rhythm, aligned in the joint whose first harmonic carries most energy over all of them, and that joint.
pub(super) fn aligned(
    recordings: &[Recording],
    harmonics: usize,
) -> Result<(Vec<Aligned<'_>>, usize)> {
    let cycles: Vec<(&Recording, Wave)> = recordings
        .iter()
        .filter_map(|recording| Some((recording, cycle(recording, harmonics)?)))
        .collect();
    if cycles.len() < 2 {
        return Err(Error::new(
            ErrorKind::Infeasible,
            format!(
                "{} of {} recordings have a rhythm",
                cycles.len(),
                recordings.len()
            ),
        )
        .expected("at least two"));
    }
    let energy = |d: usize| -> f64 {
        let of = |(_, cycle): &(&Recording, Wave)| cycle.weights()[(d, 0)].norm_sqr();
        cycles.iter().map(of).sum()
    };
    let joints = cycles[0].1.joints().len();
    let dominant = (0..joints).fold(0, |best, d| if energy(d) > energy(best) { d } else { best });
    let aligned = cycles
        .iter()
        .map(|(recording, cycle)| Aligned::from_cycle(recording, cycle, dominant))
        .collect();
    Ok((aligned, dominant))
}

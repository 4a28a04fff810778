//! Complex demodulation: how amplitude and phase of a rhythm develop over a recording.

use nalgebra::{DMatrix, Matrix3, Vector3};
use num_complex::Complex;

use super::Recording;

/// Width of the window \[cycles\]. Hann's window of two cycles has its zeros at one cycle and all whole multiples: neither
/// posture nor the second harmonic leaks into the first, and modulations of up to half a cycle come through.
const WIDTH: f64 = 2.0;
/// How near to an end of the recording a window may be centred \[cycles\]. Least squares needs no full window.
const MARGIN: f64 = 0.5;
/// Centres a cycle, an even number.
pub(super) const CENTRES: usize = 8;
/// Over a longer gap between samples \[cycles\] a window does not tell harmonics apart, though it may be solved.
const LONGEST_GAP: f64 = 0.35;
/// The smallest eigenvalue of a window's Gram matrix of 1, cos, sin; for dense samples it is 1/2. Below: a gap.
const LEAST_EIGENVALUE: f64 = 0.1;

/// One window: phasors and what went into them.
#[derive(Debug, Clone)]
pub(super) struct Window {
    /// Its centre, in steps of 1/[`CENTRES`] of a cycle. Steps that fall into a gap are missing.
    pub step: usize,
    /// Its centre \[cycles since the first stamp\].
    pub centre: f64,
    /// The samples within half a cycle of the centre.
    pub cycle: std::ops::Range<usize>,
    /// Number of its first sample, and the samples' weights, of sum 1.
    pub first: usize,
    pub weights: Vec<f64>,
    /// z_d: y_d(t) = offset + 2 Re z_d exp(i 2 pi f (t - t_0)) near the centre \[rad\], one a joint.
    pub phasors: Vec<Complex<f64>>,
    /// The offsets beside them \[rad\].
    pub offsets: Vec<f64>,
}

/// Windows along a recording, at a `frequency` \[Hz\] close to the rhythm's; none where samples are missing.
pub(super) fn demodulate(recording: &Recording, frequency: f64) -> Vec<Window> {
    let start = recording.times[0];
    // Time in cycles.
    let cycles: Vec<f64> = recording
        .times
        .iter()
        .map(|t| (t - start) * frequency)
        .collect();
    let length = cycles[cycles.len() - 1];
    let steps = ((length - 2.0 * MARGIN) * CENTRES as f64).floor();
    if !(steps.is_finite() && steps >= 0.0) {
        return Vec::new();
    }
    // What is left over is shared between both ends.
    let first_centre = (length - steps / CENTRES as f64) / 2.0;
    (0..=steps as usize)
        .filter_map(|step| {
            let centre = first_centre + step as f64 / CENTRES as f64;
            window(&cycles, &recording.positions, step, centre)
        })
        .collect()
}

/// Least squares of offset, cosine and sine about `centre`, all joints at once.
fn window(cycles: &[f64], positions: &DMatrix<f64>, step: usize, centre: f64) -> Option<Window> {
    let first = cycles.partition_point(|u| *u <= centre - WIDTH / 2.0);
    let last = cycles.partition_point(|u| *u < centre + WIDTH / 2.0);
    let inside = &cycles[first..last];
    // The neighbours on both sides too: a gap may reach into the window from outside.
    let around = &cycles[first.saturating_sub(1)..(last + 1).min(cycles.len())];
    if around
        .windows(2)
        .any(|pair| pair[1] - pair[0] > LONGEST_GAP)
    {
        return None;
    }
    let hann = |u: f64| {
        let cos = (std::f64::consts::PI * (u - centre) / WIDTH).cos();
        cos * cos
    };
    // Each sample stands for the time around it, so that uneven stamps leave the harmonics orthogonal.
    let mut weights: Vec<f64> = (0..inside.len())
        .map(|i| {
            let (before, after) = (i.saturating_sub(1), (i + 1).min(inside.len() - 1));
            hann(inside[i]) * (inside[after] - inside[before])
        })
        .collect();
    let total: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|w| *w /= total);
    let columns: Vec<Vector3<f64>> = inside
        .iter()
        .map(|u| {
            let (sin, cos) = (std::f64::consts::TAU * u).sin_cos();
            Vector3::new(1.0, cos, -sin)
        })
        .collect();
    let mut gram = Matrix3::zeros();
    for (w, column) in weights.iter().zip(&columns) {
        gram += *w * column * column.transpose();
    }
    if gram.iter().any(|g| !g.is_finite()) || gram.symmetric_eigenvalues().min() < LEAST_EIGENVALUE
    {
        return None;
    }
    let inverse = gram.try_inverse()?;
    let (offsets, phasors) = positions
        .column_iter()
        .map(|y| {
            let mut right = Vector3::zeros();
            for (i, (w, column)) in weights.iter().zip(&columns).enumerate() {
                right += *w * y[first + i] * column;
            }
            let solution = inverse * right;
            // cos and -sin carry twice the phasor.
            (solution[0], Complex::new(solution[1], solution[2]) / 2.0)
        })
        .unzip();
    let near = |u: f64| cycles.partition_point(|v| *v < u - 1e-9);
    Some(Window {
        step,
        centre,
        cycle: near(centre - 0.5)..near(centre + 0.5),
        first,
        weights,
        phasors,
        offsets,
    })
}

/// The joint whose first harmonic carries most energy.
pub(super) fn dominant(windows: &[Window]) -> usize {
    let joints = windows.first().map_or(0, |w| w.phasors.len());
    let energy = |d: usize| windows.iter().map(|w| w.phasors[d].norm_sqr()).sum::<f64>();
    (0..joints).fold(0, |best, d| if energy(d) > energy(best) { d } else { best })
}

/// The phases of one joint along the windows \[rad\], without jumps.
pub(super) fn unwrapped(windows: &[Window], joint: usize) -> Vec<f64> {
    let mut phases: Vec<f64> = Vec::with_capacity(windows.len());
    for window in windows {
        let phase = window.phasors[joint].arg();
        phases.push(match phases.last() {
            None => phase,
            Some(last) => {
                let turns = ((phase - last) / std::f64::consts::TAU).round();
                phase - turns * std::f64::consts::TAU
            }
        });
    }
    phases
}

/// Pairs of windows whose centres are one cycle apart.
pub(super) fn a_cycle_apart(windows: &[Window]) -> Vec<(usize, usize)> {
    pairs(windows.iter().map(|w| w.step), CENTRES)
}

/// Places of values `apart` steps of each other among increasing `steps`.
pub(super) fn pairs(steps: impl Iterator<Item = usize>, apart: usize) -> Vec<(usize, usize)> {
    let steps: Vec<usize> = steps.collect();
    (0..steps.len())
        .filter_map(|i| {
            let other = steps.binary_search(&(steps[i] + apart)).ok()?;
            Some((i, other))
        })
        .collect()
}

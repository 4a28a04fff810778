//! What the paper claims, beside what came out.

use super::case::Case;
use super::{ELBOW, HARMONICS, WRIST};
use crate::error::Result;
use crate::primitive::FourierMovementPrimitive;

/// The lowest harmonic of the centroid: below it is posture, not waving.
const CENTROID_FROM: usize = 7;

/// A claim of the paper, and what came out.
pub(super) struct Claim {
    pub text: &'static str,
    pub expected: &'static str,
    pub found: f64,
    pub holds: bool,
}

/// All of them.
pub(super) fn claims(
    prior: &FourierMovementPrimitive,
    elbow: &Case,
    wrist: &Case,
) -> Result<Vec<Claim>> {
    let share =
        elbow.primitive.median_modulus(WRIST, 10)? / elbow.primitive.median_modulus(ELBOW, 10)?;
    let ratio = |p: &FourierMovementPrimitive| -> Result<f64> {
        Ok(p.median_modulus(ELBOW, 20)? / p.median_modulus(ELBOW, 10)?)
    };
    let rise = ratio(&wrist.primitive)? / ratio(prior)?;
    let shift = centroid(&wrist.primitive)? - centroid(prior)?;
    let rms = elbow
        .rollout
        .rms_error()
        .max()
        .max(wrist.rollout.rms_error().max());
    let clearance = elbow.clearance.lower.min(wrist.clearance.lower);
    Ok(vec![
        Claim {
            text: "given the elbow, the wrist waves along: |w_10| wrist / elbow",
            expected: "0.6 to 1.1 (paper 0.78)",
            found: share,
            holds: (0.6..=1.1).contains(&share),
        },
        Claim {
            text: "given a fast wrist, the elbow turns fast: its |w_20| / |w_10|, times more",
            expected: "3 or more",
            found: rise,
            holds: rise >= 3.0,
        },
        Claim {
            text: "  and its spectrum moves up: centroid over k >= 7, by so many cycles",
            expected: "2 or more",
            found: shift,
            holds: shift >= 2.0,
        },
        Claim {
            text: "executed on the robot: largest RMS tracking error of a joint [rad]",
            expected: "below 1e-3",
            found: rms,
            holds: rms < 1e-3,
        },
        Claim {
            text: "  free of self-collision, proven: no clearance below [m]",
            expected: "more than 0",
            found: clearance,
            holds: clearance > 0.0,
        },
    ])
}

/// The centre of the elbow's median spectrum over k >= 7 \[cycles\].
fn centroid(primitive: &FourierMovementPrimitive) -> Result<f64> {
    let (mut weighted, mut total) = (0.0, 0.0);
    for k in CENTROID_FROM..=HARMONICS {
        let modulus = primitive.median_modulus(ELBOW, k)?;
        weighted += k as f64 * modulus;
        total += modulus;
    }
    Ok(weighted / total)
}

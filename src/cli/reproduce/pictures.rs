//! The paper's figures, from what was learned and executed.

use super::case::Case;
use super::{ELBOW, WRIST};
use crate::error::Result;
use crate::figure::{Color, Image, Labelled, Picture, Poses, spectra, trajectories};
use crate::fourier::Wave;
use crate::primitive::FourierMovementPrimitive;
use crate::robot::Robot;

/// Overlaid poses of a panel of figure 3.
const GHOSTS: usize = 9;
/// Width and height of a panel \[px\].
const POSES: (u32, u32) = (900, 720);

/// Figure 1: spectra of elbow and wrist, before and after conditioning.
pub(super) fn figure1(
    fits: &[Wave],
    prior: &FourierMovementPrimitive,
    elbow: &Case,
    wrist: &Case,
) -> Result<Picture> {
    let of = |label, color, primitive| Labelled {
        label,
        color,
        primitive,
    };
    spectra(
        fits,
        &[
            of("unconditioned", Color::GREY, prior),
            of("elbow |w₁₀| = 5°", Color::BLUE, &elbow.primitive),
            of("wrist |w₂₀| = 4°", Color::VERMILION, &wrist.primitive),
        ],
        &[
            (
                ELBOW,
                "elbow flexion: median and ±1 standard deviation of ln |wₖ|",
            ),
            (WRIST, "wrist deviation"),
        ],
        (1400, 520),
    )
}

/// Figure 2: two waves of one conditional distribution.
pub(super) fn figure2(case: &Case) -> Result<Picture> {
    trajectories(
        &[
            ("a sample", Color::GREEN, &case.waves[0]),
            ("another", Color::PURPLE, &case.waves[1]),
        ],
        &[
            (ELBOW, "elbow flexion, given |w₁₀| = 5° of the elbow"),
            (WRIST, "wrist deviation, given the same"),
        ],
        (1400, 800),
    )
}

/// Figure 3: executed poses of both conditions side by side, as PNG.
pub(super) fn figure3(robot: &Robot, elbow: &Case, wrist: &Case) -> Result<Vec<u8>> {
    Image::beside(&[
        poses(robot, elbow, "elbow-conditioned, |w₁₀| = 5°")?,
        poses(robot, wrist, "wrist-conditioned, |w₂₀| = 4°")?,
    ])?
    .to_png()
}

/// The executed poses from one turning point of the hand to the next, where its swing is widest, and the path of the
/// hand over a second around them.
fn poses(robot: &Robot, case: &Case, caption: &str) -> Result<Image> {
    let rollout = &case.rollout;
    let row = |n: usize| -> Vec<f64> { rollout.position.row(n).iter().copied().collect() };
    let tip = robot.tip();
    let sideways: Vec<f64> = (0..rollout.times.len())
        .map(|n| {
            (robot.body_poses(&row(n))[tip.body] * tip.pose)
                .translation
                .y
        })
        .collect();
    let (from, to) = widest_swing(&sideways);
    let configurations: Vec<Vec<f64>> = (0..GHOSTS)
        .map(|i| row(from + (to - from) * i / (GHOSTS - 1)))
        .collect();
    let margin = (to - from) / 2;
    let path: Vec<Vec<f64>> = (from.saturating_sub(margin)..=(to + margin).min(sideways.len() - 1))
        .step_by(4)
        .map(row)
        .collect();
    Poses {
        robot,
        configurations: &configurations,
        path: &path,
    }
    .draw(POSES)?
    .captioned(caption)
}

/// Neighbouring turning points of a signal that are farthest apart in value, away from its ends.
fn widest_swing(signal: &[f64]) -> (usize, usize) {
    let turning: Vec<usize> = (1..signal.len().saturating_sub(1))
        .filter(|&n| (signal[n] - signal[n - 1]) * (signal[n + 1] - signal[n]) < 0.0)
        .collect();
    turning
        .windows(2)
        .map(|pair| (pair[0], pair[1]))
        .max_by(|a, b| {
            let swing = |(from, to): &(usize, usize)| (signal[*to] - signal[*from]).abs();
            swing(a).total_cmp(&swing(b))
        })
        .unwrap_or((0, signal.len() - 1))
}

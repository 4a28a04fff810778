//! `undulate reproduce`: the main job, end to end.

use std::path::PathBuf;

use clap::Args;
use rand::distr::Distribution;
use serde_json::{Value, json};

use super::simulate::{rollout_json, rollout_table};
use super::{Outcome, output};
use crate::collision::CollisionModel;
use crate::demonstration::{Demonstrations, synthetic};
use crate::error::{Error, ErrorKind, Result};
use crate::feasibility::Verdict;
use crate::figure::{Color, Image, Labelled, Picture, Poses, spectra, trajectories};
use crate::fourier::Wave;
use crate::primitive::{FourierMovementPrimitive, Observation, stream};
use crate::retarget::JointMap;
use crate::robot::Robot;
use crate::shipped;
use crate::simulation::{Rollout, TrackOptions, track};

const ELBOW: &str = "elbow_flexion";
const WRIST: &str = "wrist_deviation";
const PANELS: [(&str, &str); 2] = [(ELBOW, "elbow flexion"), (WRIST, "wrist deviation")];
const HARMONICS: usize = 25;
/// The lowest harmonic of the centroid: below it is posture, not waving.
const CENTROID_FROM: usize = 7;
/// No link moves farther between two samples of the collision check \[m\].
const STEP: f64 = 0.002;
/// Draws after which a condition is given up.
const MOST_DRAWS: u64 = 1000;
/// Overlaid poses of a panel of figure 3.
const GHOSTS: usize = 9;
/// Width and height of a panel \[px\].
const POSES: (u32, u32) = (900, 720);

/// Learn, condition, sample, check and execute the paper's waves; draw its figures.
#[derive(Args)]
#[command(after_help = "Example:\n  undulate reproduce --seed 1 --out out")]
pub(super) struct Arguments {
    /// Seed of the demonstrator and of the draws.
    #[arg(long, value_name = "SEED", default_value_t = 0)]
    seed: u64,
    /// The folder to write figures and report into.
    #[arg(long, short, value_name = "FOLDER", default_value = "out")]
    out: PathBuf,
}

/// One condition, from the observation to the rollout.
struct Case {
    name: &'static str,
    observation: Observation,
    primitive: FourierMovementPrimitive,
    /// As drawn, in learned joints; the first is executed.
    waves: Vec<Wave>,
    draws: u64,
    verdict: Verdict,
    rollout: Rollout,
}

struct Bench<'a> {
    robot: &'a Robot,
    collision: &'a CollisionModel,
    map: &'a JointMap,
    seed: u64,
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    let bar = output::progress(6, "learning");
    let demonstrations = synthetic(arguments.seed)?;
    let fits = demonstrations.fit(HARMONICS)?;
    let primitive = FourierMovementPrimitive::from_waves(&fits)?;
    let robot = shipped::robot("wave_arm")?;
    let collision = CollisionModel::new(&robot, &[])?;
    let map = shipped::map("wave_arm_demonstrator")?;
    let bench = Bench {
        robot: &robot,
        collision: &collision,
        map: &map,
        seed: arguments.seed,
    };
    bar.inc(1);
    bar.set_message("executing, elbow-conditioned");
    let elbow = bench.case(
        &primitive,
        "elbow",
        Observation::modulus(ELBOW, 10, 5f64.to_radians()),
    )?;
    bar.inc(1);
    bar.set_message("executing, wrist-conditioned");
    let wrist = bench.case(
        &primitive,
        "wrist",
        Observation::modulus(WRIST, 20, 4f64.to_radians()),
    )?;
    bar.inc(1);

    bar.set_message("drawing");
    let figure1 = figure1(&fits, &primitive, &elbow, &wrist)?;
    let figure2 = trajectories(
        &[
            ("first sample", Color::BLUE, &elbow.waves[0]),
            ("second sample", Color::VERMILION, &elbow.waves[1]),
        ],
        &PANELS,
        (1400, 800),
    )?;
    bar.inc(1);
    let figure3 = Image::beside(&[
        poses(&robot, &elbow, "elbow-conditioned, |w₁₀| = 5°")?,
        poses(&robot, &wrist, "wrist-conditioned, |w₂₀| = 4°")?,
    ])?
    .to_png()?;
    bar.inc(1);

    let claims = claims(&primitive, &elbow, &wrist)?;
    let report = report(
        arguments.seed,
        &demonstrations,
        &claims,
        &primitive,
        &[&elbow, &wrist],
    )?;
    let pretty = serde_json::to_string_pretty(&report)
        .map_err(|e| Error::new(ErrorKind::Io, e.to_string()))?;
    save(arguments, "figure1", &figure1)?;
    save(arguments, "figure2", &figure2)?;
    output::write(&arguments.out.join("figure3.png"), &figure3)?;
    output::write(
        &arguments.out.join("report.json"),
        format!("{pretty}\n").as_bytes(),
    )?;
    bar.finish_and_clear();
    output::report(json, &report, || {
        words(arguments, &claims, &[&elbow, &wrist])
    });
    Ok(Outcome::Done)
}

impl Bench<'_> {
    fn case(
        &self,
        prior: &FourierMovementPrimitive,
        name: &'static str,
        observation: Observation,
    ) -> Result<Case> {
        let primitive = prior.condition(std::slice::from_ref(&observation))?;
        let mut draws = 0;
        let (first, verdict) = self.redraw(&primitive, &mut draws)?;
        let (second, _) = self.redraw(&primitive, &mut draws)?;
        let rollout = track(
            self.robot,
            &self.map.apply(&first, self.robot)?,
            &TrackOptions::default(),
        )?;
        Ok(Case {
            name,
            observation,
            primitive,
            waves: vec![first, second],
            draws,
            verdict,
            rollout,
        })
    }

    /// The next draw that breaks no limit and touches nothing.
    fn redraw(
        &self,
        primitive: &FourierMovementPrimitive,
        draws: &mut u64,
    ) -> Result<(Wave, Verdict)> {
        while *draws < MOST_DRAWS {
            let wave = primitive.sample(&mut stream(self.seed, *draws));
            *draws += 1;
            let mapped = self.map.apply(&wave, self.robot)?;
            let verdict = Verdict::of(self.robot, self.collision, &mapped, STEP)?;
            if verdict.passes() {
                return Ok((wave, verdict));
            }
        }
        Err(Error::new(
            ErrorKind::Infeasible,
            format!("none of {MOST_DRAWS} draws is executable"),
        )
        .expected("a wave within the robot's limits"))
    }
}

/// A claim of the paper, and what came out.
struct Claim {
    text: &'static str,
    expected: &'static str,
    found: f64,
    holds: bool,
}

fn claims(prior: &FourierMovementPrimitive, elbow: &Case, wrist: &Case) -> Result<Vec<Claim>> {
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
    let clearance = [elbow, wrist]
        .iter()
        .filter_map(|c| c.verdict.collision.as_ref())
        .map(|c| c.clearance.distance)
        .fold(f64::INFINITY, f64::min);
    Ok(vec![
        Claim {
            text: "given the elbow, the wrist waves along: |w_10| wrist / elbow",
            expected: "about 0.8",
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
            text: "  free of self-collision: smallest clearance [m]",
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

fn figure1(
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
        &PANELS,
        (1400, 520),
    )
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

fn save(arguments: &Arguments, name: &str, picture: &Picture) -> Result<()> {
    output::write(
        &arguments.out.join(format!("{name}.svg")),
        picture.svg.as_bytes(),
    )?;
    output::write(&arguments.out.join(format!("{name}.png")), &picture.png)
}

fn report(
    seed: u64,
    demonstrations: &Demonstrations,
    claims: &[Claim],
    prior: &FourierMovementPrimitive,
    cases: &[&Case],
) -> Result<Value> {
    let spectrum = |primitive: &FourierMovementPrimitive| -> Result<Value> {
        let mut joints = serde_json::Map::new();
        for joint in primitive.chart().joints() {
            let medians = (1..=HARMONICS)
                .map(|k| Ok(primitive.median_modulus(joint, k)?.to_degrees()))
                .collect::<Result<Vec<f64>>>()?;
            joints.insert(joint.clone(), json!(medians));
        }
        Ok(Value::Object(joints))
    };
    let cases = cases
        .iter()
        .map(|case| {
            Ok(json!({
                "condition": case.observation.coordinate.to_string(),
                "value_deg": case.observation.value.to_degrees(),
                "median_moduli_deg": spectrum(&case.primitive)?,
                "waves": case.waves.len(),
                "draws": case.draws,
                "clearance_m": case.verdict.collision.as_ref().map(|c| c.clearance.distance),
                "nearest_pair": case.verdict.collision.as_ref().map(|c| [&c.clearance.pair.0, &c.clearance.pair.1]),
                "limits": case.verdict.limits.iter().map(super::check::limit_json).collect::<Vec<_>>(),
                "rollout": rollout_json(&case.rollout),
            }))
        })
        .collect::<Result<Vec<_>>>()?;
    Ok(json!({
        "seed": seed,
        "demonstrations": demonstrations.recordings().len(),
        "joints": demonstrations.joints().iter().collect::<Vec<_>>(),
        "period_s": demonstrations.period(),
        "harmonics": HARMONICS,
        "median_moduli_deg": spectrum(prior)?,
        "claims": claims.iter().map(|c| json!({
            "claim": c.text.trim(), "expected": c.expected, "found": c.found, "holds": c.holds,
        })).collect::<Vec<_>>(),
        "cases": cases,
    }))
}

fn words(arguments: &Arguments, claims: &[Claim], cases: &[&Case]) -> String {
    let number = |x: f64| {
        if x.abs() < 0.01 {
            format!("{x:.1e}")
        } else {
            format!("{x:.2}")
        }
    };
    let rows: Vec<Vec<String>> = claims
        .iter()
        .map(|c| {
            vec![
                c.text.to_owned(),
                c.expected.to_owned(),
                number(c.found),
                if c.holds {
                    "holds".into()
                } else {
                    "does not hold".into()
                },
            ]
        })
        .collect();
    let mut text = output::table(&["the paper's claims", "expected", "found", ""], &rows);
    for case in cases {
        text.push_str(&format!(
            "\n\n{}-conditioned, executed: {} draws for {} waves within limits and free of contact\n{}",
            case.name,
            case.draws,
            case.waves.len(),
            rollout_table(&case.rollout)
        ));
    }
    text.push_str(&format!(
        "\n\nwrote figure1 and figure2 (svg, png), figure3.png and report.json into {}",
        arguments.out.display()
    ));
    text
}

//! `undulate check`.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::robot::RobotArguments;
use super::robot::tell_notes;
use super::simulate::units;
use super::{Outcome, output, read_wave};
use crate::collision::{CollisionModel, PairStatus};
use crate::error::{Error, ErrorKind, Result};
use crate::feasibility::{LimitUse, Verdict, limits};
use crate::fourier::Derivative;
use crate::robot::JointKind;

/// The largest distance \[m\] that a link moves between two samples, unless the user says otherwise.
pub(super) const STEP: f64 = 0.002;

/// Check a wave on a robot: position and velocity limits, self-collision.
#[derive(Args)]
#[command(
    after_help = "Limits are checked against rigorous bounds of the wave over its period; self-collision at samples so close that no\n\
    link moves more than --step between them. Exit code 3 when the wave does not pass.\n\n\
    Example:\n  \
    undulate check wave.json --robot wave_arm\n  \
    undulate check wave.json --robot my.urdf --map my.toml --leave-out base:forearm"
)]
pub(super) struct Arguments {
    /// The wave file.
    wave: PathBuf,
    #[command(flatten)]
    robot: RobotArguments,
    /// The largest distance [m] that a link may move between two samples.
    #[arg(
        long,
        value_name = "METRES",
        allow_negative_numbers = true,
        default_value_t = 0.002
    )]
    step: f64,
    /// Two links that are not to be kept apart; may be given several times.
    #[arg(long, value_name = "LINK:LINK")]
    leave_out: Vec<String>,
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    let wave = read_wave(&arguments.wave)?;
    let (robot, map) = arguments.robot.load(wave.joints())?;
    let wave = map.apply(&wave, &robot)?;
    let mut left_out = arguments
        .leave_out
        .iter()
        .map(|pair| {
            pair.split_once(':')
                .map(|(a, b)| (a.to_owned(), b.to_owned()))
                .ok_or_else(|| {
                    Error::new(ErrorKind::Setting, format!("--leave-out {pair}"))
                        .expected("LINK:LINK")
                })
        })
        .collect::<Result<Vec<_>>>()?;
    left_out.extend(arguments.robot.reading.disabled(&robot)?);
    let notes = tell_notes(&robot);
    let limits = limits(&robot, &wave)?;
    let looked_at = CollisionModel::new(&robot, &left_out).and_then(|collision| {
        Ok((
            Verdict::of(&robot, &collision, &wave, arguments.step)?,
            collision,
        ))
    });
    let (verdict, collision) = looked_at.inspect_err(|error| {
        // Limits can be told even where contact cannot; the answer is no all the same.
        let value = json!({
            "passes": false,
            "notes": notes,
            "limits": limits.iter().map(limit_json).collect::<Vec<_>>(),
            "collision": null,
            "error": error.to_string(),
        });
        output::report(json, &value, || limit_table(&limits));
    })?;
    for pair in collision
        .pairs()
        .iter()
        .filter(|p| p.status == PairStatus::TouchingAtRest)
    {
        output::warn(format!(
            "{} and {} touch when all joints are at 0, or as near to it as their limits allow: a wave that comes by there does not pass; if they touch by design, --leave-out {}:{}",
            pair.names.0, pair.names.1, pair.names.0, pair.names.1
        ));
    }
    let value = json!({
        "passes": verdict.passes(),
        "notes": notes,
        "limits": verdict.limits.iter().map(limit_json).collect::<Vec<_>>(),
        "collision": verdict.collision.as_ref().map(|c| json!({
            "free": c.is_free(),
            "clearance_m": c.clearance.distance,
            "pair": [c.clearance.pair.0, c.clearance.pair.1],
            "time_s": c.time,
            "samples": c.samples,
            "step_m": c.step,
        })),
        "pairs": collision.pairs().iter().map(|p| json!({
            "links": [p.names.0, p.names.1],
            "checked": p.is_checked(),
            "status": status(p.status),
        })).collect::<Vec<_>>(),
    });
    output::report(json, &value, || words(&verdict, &collision));
    Ok(if verdict.passes() {
        Outcome::Done
    } else {
        Outcome::Refused
    })
}

fn words(verdict: &Verdict, collision: &CollisionModel) -> String {
    let mut text = limit_table(&verdict.limits);
    let checked = collision.pairs().iter().filter(|p| p.is_checked()).count();
    let left_out = collision.pairs().len() - checked;
    text.push_str(&match &verdict.collision {
        None => "\nself-collision: not looked at, a limit is broken".to_owned(),
        Some(c) if c.is_free() => format!(
            "\nself-collision: none in {} samples of {checked} pairs ({left_out} left out), no link moves more than {:.1} mm between them\n\
             smallest clearance {:.1} mm, {} and {} at {:.3} s",
            c.samples,
            1e3 * c.step,
            1e3 * c.clearance.distance,
            c.clearance.pair.0,
            c.clearance.pair.1,
            c.time
        ),
        Some(c) => format!(
            "\nself-collision: {} and {} touch at {:.3} s",
            c.clearance.pair.0, c.clearance.pair.1, c.time
        ),
    });
    text.push_str(if verdict.passes() {
        "\npasses"
    } else {
        "\ndoes not pass"
    });
    text
}

fn status(status: PairStatus) -> &'static str {
    match status {
        PairStatus::Checked => "checked",
        PairStatus::TouchingAtRest => "checked, touching at rest",
        PairStatus::Adjacent => "adjacent",
        PairStatus::LeftOut => "left out",
    }
}

pub(super) fn limit_json(limit: &LimitUse) -> Value {
    json!({
        "joint": limit.joint,
        "quantity": quantity(limit),
        "unit": unit(limit),
        "range": [limit.range.lower, limit.range.upper],
        "limit": [limit.limit.lower, limit.limit.upper],
        "excess": limit.excess(),
    })
}

fn unit(limit: &LimitUse) -> &'static str {
    let (position, rate, _) = units(limit.kind);
    match limit.quantity {
        Derivative::Velocity => rate,
        _ => position,
    }
}

fn quantity(limit: &LimitUse) -> &'static str {
    match limit.quantity {
        Derivative::Velocity => "velocity",
        _ => "position",
    }
}

fn limit_table(limits: &[LimitUse]) -> String {
    let rows: Vec<Vec<String>> = limits.iter().map(limit_row).collect();
    output::table(&["joint", "", "wave", "limit", ""], &rows)
}

fn limit_row(limit: &LimitUse) -> Vec<String> {
    // Angles of a person are degrees; everything else is SI.
    let (unit, digits, scale) = match (limit.kind, limit.quantity) {
        (JointKind::Revolute, Derivative::Position) => ("deg", 1, 1f64.to_degrees()),
        _ => (unit(limit), 2, 1.0),
    };
    let shown = |x: f64| {
        let x = scale * x;
        if x.abs() < 1e6 {
            format!("{x:.digits$}")
        } else {
            format!("{x:.1e}")
        }
    };
    let range = |i: crate::fourier::Interval| format!("{} .. {}", shown(i.lower), shown(i.upper));
    vec![
        limit.joint.clone(),
        quantity(limit).to_owned(),
        format!("{} {unit}", range(limit.range)),
        format!("{} {unit}", range(limit.limit)),
        if limit.excess() > 0.0 {
            format!("exceeded by {}", shown(limit.excess()))
        } else {
            "ok".to_owned()
        },
    ]
}

//! `undulate check`.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::robot::RobotArguments;
use super::robot::tell_notes;
use super::simulate::units;
use super::{Outcome, output, read_wave};
use crate::collision::{Certification, CollisionModel, MinimumClearance, PairStatus};
use crate::error::{Error, ErrorKind, Result};
use crate::feasibility::{LimitUse, Verdict, limits};
use crate::fourier::Derivative;
use crate::robot::JointKind;

/// Check a wave on a robot: position and velocity limits, self-collision.
/// Of the smallest clearance \[m\].
const ACCURACY: f64 = 1e-4;

#[derive(Args)]
#[command(
    after_help = "Limits are checked against rigorous bounds of the wave over its period; self-collision by a proof that\n\
    holds between samples too. Exit code 3 when the wave does not pass.\n\n\
    Example:\n  \
    undulate check wave.json --robot wave_arm\n  \
    undulate check wave.json --robot my.urdf --map my.toml --leave-out base:forearm"
)]
pub(super) struct Arguments {
    /// The wave file.
    wave: PathBuf,
    #[command(flatten)]
    robot: RobotArguments,
    /// Links must stay farther apart than this [m].
    #[arg(
        long,
        value_name = "METRES",
        allow_negative_numbers = true,
        default_value_t = 0.0
    )]
    margin: f64,
    /// Two links that are not to be kept apart; may be given several times.
    #[arg(long, value_name = "LINK:LINK")]
    leave_out: Vec<String>,
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    let wave = read_wave(&arguments.wave)?;
    let (robot, map) = arguments.robot.load(wave.joints())?;
    let wave = map.apply(&wave, &robot)?;
    let left_out = arguments
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
    let mut options = arguments.robot.reading.collision(&robot)?;
    options.left_out = left_out;
    let notes = tell_notes(&robot);
    let limits = limits(&robot, &wave)?;
    let looked_at = CollisionModel::new(&robot, &options).and_then(|collision| {
        let verdict = Verdict::of(&robot, &collision, &wave, arguments.margin)?;
        let clearance = collision.minimum_clearance(&wave, ACCURACY)?;
        Ok((verdict, clearance, collision))
    });
    let (verdict, clearance, collision) = looked_at.inspect_err(|error| {
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
            "proven_clear": c.is_clear(),
            "clearance_m": [clearance.lower, clearance.at.distance],
            "pair": [clearance.at.pair.0, clearance.at.pair.1],
            "time_s": clearance.at.time,
            "intervals": c.work().intervals,
        })),
        "pairs": collision.pairs().iter().map(|p| json!({
            "links": [p.names.0, p.names.1],
            "checked": p.is_checked(),
            "status": p.status.to_string(),
        })).collect::<Vec<_>>(),
    });
    output::report(json, &value, || words(&verdict, &clearance, &collision));
    Ok(if verdict.passes() {
        Outcome::Done
    } else {
        Outcome::Refused
    })
}

fn words(verdict: &Verdict, clearance: &MinimumClearance, collision: &CollisionModel) -> String {
    let mut text = limit_table(&verdict.limits);
    let checked = collision.pairs().iter().filter(|p| p.is_checked()).count();
    let left_out = collision.pairs().len() - checked;
    let pair = format!("{} and {}", clearance.at.pair.0, clearance.at.pair.1);
    text.push_str(&match &verdict.collision {
        None => "\nself-collision: not looked at, a limit is broken".to_owned(),
        Some(Certification::Clear { work, .. }) => format!(
            "\nself-collision: proven that none of {checked} pairs touches ({left_out} left out), on {} intervals of time\n\
             smallest clearance {:.1} mm, {pair} at {:.3} s",
            work.intervals,
            1e3 * clearance.at.distance,
            clearance.at.time
        ),
        Some(Certification::Collides { witness, .. }) => format!(
            "\nself-collision: {} and {} are {:.1} mm apart at {:.3} s\nworst {:.1} mm, {pair} at {:.3} s",
            witness.pair.0,
            witness.pair.1,
            1e3 * witness.distance,
            witness.time,
            1e3 * clearance.at.distance,
            clearance.at.time
        ),
        Some(Certification::Undecided { stretches, .. }) => format!(
            "\nself-collision: undecided on {} stretches, the first {:.3} .. {:.3} s",
            stretches.len(),
            stretches[0].from,
            stretches[0].to
        ),
    });
    text.push_str(if verdict.passes() {
        "\npasses"
    } else {
        "\ndoes not pass"
    });
    text
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

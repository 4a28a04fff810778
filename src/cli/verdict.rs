//! A verdict, for people and for machines.

use serde_json::{Value, json};

use super::output;
use super::simulate::units;
use crate::collision::{Certification, MinimumClearance, Moment, Stretch};
use crate::error::Reason;
use crate::feasibility::{CheckOptions, EffortUse, LimitSource, LimitUse, Verdict};
use crate::fourier::{Derivative, Interval, Joints};
use crate::robot::JointKind;

/// More stretches are not listed in words.
const MOST_STRETCHES: usize = 5;

pub(super) fn codes(reasons: &[Reason]) -> Vec<&'static str> {
    reasons.iter().map(|r| r.code()).collect()
}

pub(super) fn limit_json(limit: &LimitUse) -> Value {
    // What is infinite, as an acceleration where the velocity jumps, is null in JSON.
    json!({
        "joint": limit.joint,
        "quantity": quantity(limit),
        "unit": unit(limit),
        "range": [limit.range.lower, limit.range.upper],
        "limit": [limit.limit.lower, limit.limit.upper],
        "source": source(limit),
        "excess": limit.excess(),
        "time_s": limit.worst_time(),
        "reason": limit.reason().map(Reason::code),
    })
}

/// What a motion takes of the efforts, where that was looked at.
pub(super) fn efforts_json(verdict: &Verdict) -> Value {
    let entry = |effort: &EffortUse| {
        json!({
            "joint": effort.joint,
            "unit": units(effort.kind).2,
            "estimate": [effort.range.lower, effort.range.upper],
            "limit": effort.limit,
            "excess": effort.excess(),
            "time_s": effort.worst_time(),
            "reason": effort.reason().map(Reason::code),
        })
    };
    json!(
        verdict
            .efforts
            .as_ref()
            .map(|all| all.iter().map(entry).collect::<Vec<_>>())
    )
}

pub(super) fn effort_table(efforts: &[EffortUse]) -> String {
    let rows: Vec<Vec<String>> = efforts
        .iter()
        .map(|effort| {
            let unit = units(effort.kind).2;
            let Interval { lower, upper } = effort.range;
            vec![
                effort.joint.clone(),
                format!("{lower:.2} .. {upper:.2} {unit}"),
                effort.limit.map_or("none given".to_owned(), |limit| {
                    format!("{limit:.2} {unit}")
                }),
                match effort.limit {
                    None => String::new(),
                    Some(_) if effort.excess() == 0.0 => "ok".to_owned(),
                    Some(_) => format!(
                        "exceeded by {:.2e} at {:.3} s",
                        effort.excess(),
                        effort.worst_time()
                    ),
                },
            ]
        })
        .collect();
    output::table(&["joint", "effort (estimated)", "limit", ""], &rows)
}

/// What the proof and the search for the smallest clearance came to.
pub(super) fn collision_json(verdict: &Verdict, options: &CheckOptions, joints: &Joints) -> Value {
    let Some(collision) = &verdict.collision else {
        return Value::Null;
    };
    let tolerance: serde_json::Map<String, Value> = joints
        .iter()
        .zip(&options.tolerance)
        .map(|(joint, tolerance)| (joint.clone(), json!(tolerance)))
        .collect();
    let (witness, undecided) = match collision {
        Certification::Clear { .. } => (None, &[][..]),
        Certification::Collides { witness, .. } => (Some(witness), &[][..]),
        Certification::Undecided { stretches, .. } => (None, stretches.as_slice()),
    };
    let nearest = verdict.clearance.as_ref();
    json!({
        "proven_clear": collision.is_clear(),
        "margin_m": options.margin,
        "tolerance": tolerance,
        "clearance_m": nearest.map(|c| [c.lower, c.at.distance]),
        "pair": nearest.map(|c| [&c.at.pair.0, &c.at.pair.1]),
        "time_s": nearest.map(|c| c.at.time),
        "witness": witness.map(moment_json),
        "undecided": undecided.iter().map(stretch_json).collect::<Vec<_>>(),
        "intervals": collision.work().intervals,
        "distances": collision.work().distances,
    })
}

fn moment_json(moment: &Moment) -> Value {
    json!({
        "pair": [moment.pair.0, moment.pair.1],
        "time_s": moment.time,
        "distance_m": moment.distance,
        "padding_m": moment.padding,
        "with_scene": moment.is_with_scene,
    })
}

fn stretch_json(stretch: &Stretch) -> Value {
    json!({
        "from_s": stretch.from,
        "to_s": stretch.to,
        "pair": [stretch.pair.0, stretch.pair.1],
    })
}

/// The verdict on collisions, in lines.
pub(super) fn collision_words(
    verdict: &Verdict,
    options: &CheckOptions,
    checked: usize,
    left_out: usize,
) -> Vec<String> {
    let mut lines = Vec::new();
    let within = if options.tolerance.iter().any(|t| *t > 0.0) {
        ", for all joints within their tolerance"
    } else {
        ""
    };
    match &verdict.collision {
        None => lines.push("collision: not looked at".to_owned()),
        Some(Certification::Clear { work, .. }) => {
            let apart = if options.margin > 0.0 {
                format!("comes within {} mm", millimetres(options.margin))
            } else {
                "touches".to_owned()
            };
            lines.push(format!(
                "collision: proven that none of {checked} pairs {apart}{within} ({left_out} pairs left out), on {} intervals of time",
                work.intervals
            ));
        }
        Some(Certification::Collides { witness, .. }) => lines.push(format!(
            "collision: {} at {:.3} s",
            apart(witness),
            witness.time
        )),
        Some(Certification::Undecided { stretches, .. }) => {
            lines.push(format!(
                "collision: undecided{within} on {} stretches of time",
                stretches.len()
            ));
            for stretch in stretches.iter().take(MOST_STRETCHES) {
                lines.push(format!(
                    "  {:.4} .. {:.4} s: {} and {}",
                    stretch.from, stretch.to, stretch.pair.0, stretch.pair.1
                ));
            }
            if stretches.len() > MOST_STRETCHES {
                lines.push(format!("  and {} more", stretches.len() - MOST_STRETCHES));
            }
        }
    }
    if let Some(MinimumClearance { lower, at, .. }) = &verdict.clearance {
        lines.push(format!(
            "smallest clearance: between {} and {} mm, {} and {} at {:.3} s{}",
            millimetres(*lower),
            millimetres(at.distance),
            at.pair.0,
            at.pair.1,
            at.time,
            padding(at)
        ));
    }
    lines
}

fn apart(moment: &Moment) -> String {
    let (a, b) = &moment.pair;
    let distance = moment.distance + moment.padding;
    if distance > 0.0 {
        format!(
            "{a} and {b} come within {} mm{}",
            millimetres(distance),
            padding(moment)
        )
    } else {
        format!(
            "{a} and {b} are {} mm deep in each other",
            millimetres(-distance)
        )
    }
}

fn padding(moment: &Moment) -> String {
    if moment.padding > 0.0 {
        format!(" (padding {} mm)", millimetres(moment.padding))
    } else {
        String::new()
    }
}

/// To a hundredth, from metres.
pub(super) fn millimetres(metres: f64) -> String {
    let text = format!("{:.2}", 1e3 * metres);
    // What is zero but for rounding has no sign.
    if text == "-0.00" { "0.00".into() } else { text }
}

fn unit(limit: &LimitUse) -> String {
    let (position, rate, _) = units(limit.kind);
    match limit.quantity {
        Derivative::Position => position.to_owned(),
        Derivative::Velocity => rate.to_owned(),
        _ => format!("{rate}^2"),
    }
}

fn quantity(limit: &LimitUse) -> &'static str {
    match limit.quantity {
        Derivative::Position => "position",
        Derivative::Velocity => "velocity",
        _ => "acceleration",
    }
}

fn source(limit: &LimitUse) -> &'static str {
    match limit.source {
        LimitSource::Robot => "robot",
        LimitSource::Given => "given",
    }
}

/// Where a limit came from, as a certificate tells it; `given` says where those of the caller are.
pub(super) fn limit_source(limit: &LimitUse, given: &str) -> String {
    format!(
        "{}: {} from {} to {} {}, {}",
        limit.joint,
        quantity(limit),
        limit.limit.lower,
        limit.limit.upper,
        unit(limit),
        match limit.source {
            LimitSource::Robot => "of the URDF".to_owned(),
            LimitSource::Given => format!("given by {given}"),
        }
    )
}

pub(super) fn limit_table(limits: &[LimitUse]) -> String {
    let rows: Vec<Vec<String>> = limits.iter().map(limit_row).collect();
    output::table(&["joint", "", "motion", "limit", ""], &rows)
}

fn limit_row(limit: &LimitUse) -> Vec<String> {
    // Angles of a person are degrees; everything else is SI.
    let (unit, digits, scale) = match (limit.kind, limit.quantity) {
        (JointKind::Revolute, Derivative::Position) => ("deg".to_owned(), 1, 1f64.to_degrees()),
        _ => (unit(limit), 2, 1.0),
    };
    let shown = |x: f64| {
        let x = scale * x;
        if x.abs() < 1e6 {
            let text = format!("{x:.digits$}");
            // What is zero but for rounding has no sign.
            match text.strip_prefix('-') {
                Some(zero) if zero.bytes().all(|b| b == b'0' || b == b'.') => zero.to_owned(),
                _ => text,
            }
        } else {
            format!("{x:.1e}")
        }
    };
    let range = |i: Interval| format!("{} .. {}", shown(i.lower), shown(i.upper));
    let excess = limit.excess();
    vec![
        limit.joint.clone(),
        quantity(limit).to_owned(),
        format!("{} {unit}", range(limit.range)),
        format!(
            "{} {unit}{}",
            range(limit.limit),
            match limit.source {
                LimitSource::Robot => "",
                LimitSource::Given => " given",
            }
        ),
        if excess == 0.0 {
            "ok".to_owned()
        } else if limit.reason() == Some(Reason::VelocityJump) {
            format!("velocity jumps at {:.3} s", limit.worst_time())
        } else {
            let shown = shown(excess);
            // What is too little for the digits is not shown as nothing.
            let by = if shown
                .bytes()
                .any(|b| (b'1'..=b'9').contains(&b) || b == b'i')
            {
                shown
            } else {
                format!("{:.1e}", scale * excess)
            };
            format!("exceeded by {by} at {:.3} s", limit.worst_time())
        },
    ]
}

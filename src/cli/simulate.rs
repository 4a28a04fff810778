//! `undulate simulate`.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::execution::ExecutionArguments;
use super::moves::{Course, MoveArguments};
use super::robot::RobotArguments;
use super::verdict::millimetres;
use super::{Outcome, output};
use crate::collision::{Certification, CollisionModel, Moment};
use crate::error::{Error, ErrorKind, Result};
use crate::feasibility::{LimitUse, limits};
use crate::fourier::Derivative;
use crate::motion::Motion;
use crate::robot::{JointKind, Robot};
use crate::simulation::{Event, EventKind, Rollout, Simulation};

/// More events are not told in words.
const MOST_EVENTS: usize = 10;

/// Execute a motion on a robot in simulation.
#[derive(Args)]
#[command(
    after_help = "MOTION is a wave file, or a move as `undulate check` takes it. The robot moves under gravity with the effort limits, stops, damping and\n\
    friction of its URDF. Commanded and achieved motion are then proven clear apart: the commanded one for all positions as far from it as the\n\
    joints were. This is no gate: what breaks a limit or touches is told and simulated all the same; `undulate check` refuses it.\n\n\
    Examples:\n  \
    undulate simulate wave.json --robot wave_arm -o rollout.csv\n  \
    undulate simulate wave.json --robot wave_arm --plant rk4 --torque-error 0.05 --payload hand=0.5 --push hand=20,0,0@0.5..0.7"
)]
pub(super) struct Arguments {
    /// A wave file, or a recorded move.
    #[arg(value_name = "MOTION")]
    file: PathBuf,
    #[command(flatten)]
    robot: RobotArguments,
    #[command(flatten)]
    moves: MoveArguments,
    #[command(flatten)]
    execution: ExecutionArguments,
    /// Write the rollout: `time_s`, then for each joint reference, position, velocity, torque.
    #[arg(long, short, value_name = "CSV")]
    output: Option<PathBuf>,
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    let robot = arguments.robot.reading.robot(&arguments.robot.robot)?;
    let mut motions = arguments
        .moves
        .open(&arguments.file, &robot, &arguments.robot);
    if motions.len() != 1 {
        let error = Error::new(ErrorKind::Setting, format!("{} motions", motions.len()));
        return Err(error.expected("one").help("choose with --motion"));
    }
    let motion = motions.remove(0).1?;
    for warning in &motion.warnings {
        output::warn(warning);
    }
    match &motion.course {
        Course::Wave(wave) => execute(arguments, &robot, wave.as_ref(), json),
        Course::Move(spline) => execute(arguments, &robot, spline.as_ref(), json),
    }
}

fn execute<M: Motion>(
    arguments: &Arguments,
    robot: &Robot,
    motion: &M,
    json: bool,
) -> Result<Outcome> {
    let notes = super::robot::tell_notes(robot);
    let limits = limits(robot, motion)?;
    for limit in limits.iter().filter(|l| l.excess() > 0.0) {
        output::warn(broken(limit));
    }
    let simulation = Simulation::new(robot, arguments.execution.options(robot)?)?;
    let rollout = simulation.run(motion)?;
    // What was achieved is looked at apart from what was commanded.
    let options = arguments.robot.reading.collision(robot)?;
    let collision = CollisionModel::new(robot, &options);
    let mut events = rollout.events.clone();
    let mut proofs = Value::Null;
    let mut lines = Vec::new();
    match &collision {
        Ok(collision) => {
            events.extend(rollout.contacts(collision)?);
            let tolerance = rollout.tolerance();
            let commanded = collision.certify(motion, 0.0, &tolerance)?;
            let achieved = rollout
                .achieved()
                .and_then(|spline| collision.certify(&spline, 0.0, &[]))?;
            proofs = json!({
                "tolerance": tolerance,
                "commanded": proof_json(&commanded),
                "achieved": proof_json(&achieved),
            });
            lines.push(format!(
                "commanded, for positions as far from it as was simulated: {}",
                proof_words(&commanded)
            ));
            lines.push(format!("achieved: {}", proof_words(&achieved)));
        }
        Err(error) => output::warn(format!("collision is not looked at: {error}")),
    }
    if let Some(path) = &arguments.output {
        output::write(path, rollout.to_csv().as_bytes())?;
    }
    for event in events.iter().take(MOST_EVENTS) {
        output::warn(event_words(event));
    }
    if events.len() > MOST_EVENTS {
        output::warn(format!("and {} more", events.len() - MOST_EVENTS));
    }
    let energy = &rollout.energy;
    let last = |series: &[f64]| series.last().copied();
    let value = json!({
        "robot": robot.name(),
        "notes": notes,
        "duration_s": rollout.times.last(),
        "joints": rollout_json(&rollout),
        "energy_j": {
            "motors": last(&energy.motors),
            "losses": last(&energy.losses),
            "pushes": last(&energy.pushes),
            "stops": last(&energy.stops),
            "imbalance": energy.imbalance(),
        },
        "events": events.iter().map(event_json).collect::<Vec<_>>(),
        "collision": proofs,
        "limits_exceeded": limits.iter().filter(|l| l.excess() > 0.0).map(super::verdict::limit_json).collect::<Vec<_>>(),
        "rollout": arguments.output,
    });
    output::report(json, &value, || {
        let mut text = rollout_table(&rollout);
        for line in &lines {
            text.push_str(&format!("\n{line}"));
        }
        if let Some(path) = &arguments.output {
            text.push_str(&format!("\nwrote {}", path.display()));
        }
        text
    });
    Ok(Outcome::Done)
}

fn proof_json(proof: &Certification) -> Value {
    let moment = |m: &Moment| json!({"pair": [m.pair.0, m.pair.1], "time_s": m.time, "distance_m": m.distance});
    match proof {
        Certification::Clear { .. } => json!({"proven_clear": true}),
        Certification::Collides { witness, .. } => {
            json!({"proven_clear": false, "witness": moment(witness)})
        }
        Certification::Undecided { stretches, .. } => {
            json!({"proven_clear": false, "undecided": stretches.len()})
        }
    }
}

fn proof_words(proof: &Certification) -> String {
    match proof {
        Certification::Clear { .. } => "proven clear".to_owned(),
        Certification::Collides { witness, .. } => format!(
            "{} and {} are {} mm apart at {:.3} s",
            witness.pair.0,
            witness.pair.1,
            millimetres(witness.distance),
            witness.time
        ),
        Certification::Undecided { stretches, .. } => {
            format!("undecided on {} stretches of time", stretches.len())
        }
    }
}

fn event_json(event: &Event) -> Value {
    let (kind, on) = match &event.kind {
        EventKind::Saturated { joint } => ("saturated", json!([joint])),
        EventKind::Stopped { joint } => ("stopped", json!([joint])),
        EventKind::TooFast { joint } => ("too-fast", json!([joint])),
        EventKind::Contact { pair } => ("contact", json!([pair.0, pair.1])),
    };
    json!({"kind": kind, "on": on, "from_s": event.from, "to_s": event.to})
}

fn event_words(event: &Event) -> String {
    let what = match &event.kind {
        EventKind::Saturated { joint } => format!("the motor of `{joint}` is at its effort limit"),
        EventKind::Stopped { joint } => format!("joint `{joint}` is at its stop"),
        EventKind::TooFast { joint } => format!("joint `{joint}` is faster than its limit"),
        EventKind::Contact { pair } => format!("{} and {} touch", pair.0, pair.1),
    };
    format!("{what}, {:.3} .. {:.3} s", event.from, event.to)
}

fn broken(limit: &LimitUse) -> String {
    let (position, rate, _) = units(limit.kind);
    match limit.quantity {
        Derivative::Position => format!(
            "joint `{}` leaves its position limit by {:.3e} {position}; the simulated joint runs into its stop",
            limit.joint,
            limit.excess()
        ),
        _ => format!(
            "joint `{}` leaves its velocity limit by {:.3e} {rate}; the simulated motor is not stopped by that, a real one will be",
            limit.joint,
            limit.excess()
        ),
    }
}

/// Units of position, rate and effort.
pub(super) fn units(kind: JointKind) -> (&'static str, &'static str, &'static str) {
    match kind {
        JointKind::Revolute => ("rad", "rad/s", "N m"),
        JointKind::Prismatic => ("m", "m/s", "N"),
    }
}

pub(super) fn rollout_json(rollout: &Rollout) -> serde_json::Value {
    let (rms, peak, torque) = (
        rollout.rms_error(),
        rollout.peak_error(),
        rollout.peak_torque(),
    );
    rollout
        .joints
        .iter()
        .enumerate()
        .map(|(j, joint)| match rollout.kinds[j] {
            JointKind::Revolute => json!({
                "joint": joint,
                "rms_error_rad": rms[j],
                "peak_error_rad": peak[j],
                "peak_torque_nm": torque[j],
                "saturated_steps": rollout.saturated[j],
            }),
            JointKind::Prismatic => json!({
                "joint": joint,
                "rms_error_m": rms[j],
                "peak_error_m": peak[j],
                "peak_force_n": torque[j],
                "saturated_steps": rollout.saturated[j],
            }),
        })
        .collect()
}

pub(super) fn rollout_table(rollout: &Rollout) -> String {
    let (rms, peak, torque) = (
        rollout.rms_error(),
        rollout.peak_error(),
        rollout.peak_torque(),
    );
    let rows: Vec<Vec<String>> = rollout
        .joints
        .iter()
        .enumerate()
        .map(|(j, joint)| {
            let (position, _, effort) = units(rollout.kinds[j]);
            vec![
                joint.clone(),
                format!("{:.1e} {position}", rms[j]),
                format!("{:.1e} {position}", peak[j]),
                format!("{:.2} {effort}", torque[j]),
                rollout.saturated[j].to_string(),
            ]
        })
        .collect();
    output::table(
        &[
            "joint",
            "rms error",
            "peak error",
            "peak torque",
            "steps saturated",
        ],
        &rows,
    )
}

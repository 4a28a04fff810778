//! `undulate simulate`.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::robot::RobotArguments;
use super::{Outcome, output, read_wave};
use crate::collision::CollisionModel;
use crate::error::Result;
use crate::feasibility::{LimitUse, limits};
use crate::fourier::Derivative;
use crate::robot::JointKind;
use crate::simulation::{Rollout, TrackOptions, track};

/// Execute a wave on a robot in simulation.
#[derive(Args)]
#[command(
    after_help = "The robot is a Rapier multibody under gravity with the effort limits and damping of its URDF. This is no check:\nwhat breaks a limit or touches is told and simulated all the same; `undulate check` refuses it.\n\n\
    Example:\n  \
    undulate simulate wave.json --robot wave_arm -o rollout.csv"
)]
pub(super) struct Arguments {
    /// The wave file.
    wave: PathBuf,
    #[command(flatten)]
    robot: RobotArguments,
    /// How long [s] [default: one period].
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    duration: Option<f64>,
    /// Step of simulation and controller [s].
    #[arg(
        long,
        value_name = "SECONDS",
        allow_negative_numbers = true,
        default_value_t = 0.001
    )]
    time_step: f64,
    /// Natural frequency of the position loops [Hz].
    #[arg(long, value_name = "HERTZ", allow_negative_numbers = true, default_value_t = TrackOptions::default().bandwidth)]
    bandwidth: f64,
    /// Motors alone, without the torque that the model says the motion needs.
    #[arg(long)]
    no_feed_forward: bool,
    /// Write the rollout: `time_s`, then for each joint reference, position, velocity, torque.
    #[arg(long, short, value_name = "CSV")]
    output: Option<PathBuf>,
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    let wave = read_wave(&arguments.wave)?;
    let (robot, map) = arguments.robot.load(wave.joints())?;
    let wave = map.apply(&wave, &robot)?;
    let notes = super::robot::tell_notes(&robot);
    let limits = limits(&robot, &wave)?;
    for limit in limits.iter().filter(|l| l.excess() > 0.0) {
        output::warn(broken(limit));
    }
    let options = TrackOptions {
        time_step: arguments.time_step,
        duration: arguments.duration,
        bandwidth: arguments.bandwidth,
        feed_forward: !arguments.no_feed_forward,
    };
    let rollout = track(&robot, &wave, &options)?;
    // What was achieved is looked at apart from what was commanded.
    let options = arguments.robot.reading.collision(&robot)?;
    let contact = match CollisionModel::new(&robot, &options) {
        Ok(collision) => {
            let mut checker = collision.checker();
            rollout.position.row_iter().enumerate().find_map(|(n, q)| {
                let q: Vec<f64> = q.iter().copied().collect();
                let pair = checker.collision(&q);
                pair.map(|pair| (rollout.times[n], pair.names.clone()))
            })
        }
        Err(error) => {
            output::warn(format!("self-collision is not looked at: {error}"));
            None
        }
    };
    if let Some(path) = &arguments.output {
        output::write(path, rollout.to_csv().as_bytes())?;
    }
    if let Some((time, (a, b))) = &contact {
        output::warn(format!("{a} and {b} touch at {time:.3} s"));
    }
    let value = json!({
        "robot": robot.name(),
        "notes": notes,
        "duration_s": rollout.times.last(),
        "joints": rollout_json(&rollout),
        "first_contact": contact.as_ref().map(|(time, (a, b))| json!({"time_s": time, "pair": [a, b]})),
        "limits_exceeded": limits.iter().filter(|l| l.excess() > 0.0).map(super::verdict::limit_json).collect::<Vec<_>>(),
        "rollout": arguments.output,
    });
    output::report(json, &value, || {
        let mut text = rollout_table(&rollout);
        if let Some(path) = &arguments.output {
            text.push_str(&format!("\nwrote {}", path.display()));
        }
        text
    });
    Ok(Outcome::Done)
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

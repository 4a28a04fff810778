//! `undulate perform`.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::demands::{Apart, Demands};
use super::export::{Format, departure};
use super::moves::posture;
use super::robot::{RobotArguments, tell_notes};
use super::{Outcome, output, read_wave};
use crate::collision::CollisionModel;
use crate::error::{Error, ErrorKind, Result};
use crate::feasibility::{Passages, Verdict};
use crate::fourier::Wave;
use crate::motion::{Motion, Spline, StartPosture, Waypoint, Waypoints};

/// What the controller makes of the waypoints follows the wave to this \[rad, m\].
const ON_WAVE: f64 = 1e-4;

/// How often the rate is doubled to make it so.
const DOUBLINGS: usize = 3;

/// From rest into a wave, on to further waves, and back to rest: one smooth move that a controller can run.
#[derive(Args)]
#[command(
    after_help = "The move is twice continuously differentiable, within the limits, and proven clear as a whole, as it is written: waypoints with velocities and\n\
    accelerations, joined by quintics. `undulate check` takes it again. Phases at which waves are entered and left are chosen so that ways are short.\n\n\
    Examples:\n  \
    undulate perform wave.json --robot wave_arm --duration 6 -o greeting.json\n  \
    undulate perform large.json small.json --robot my.urdf --map my.toml --at shoulder_lift_joint=-90deg --max-acceleration 10 -o greeting.csv"
)]
pub(super) struct Arguments {
    /// Wave files of the same joints, in order.
    #[arg(value_name = "WAVE", required = true)]
    waves: Vec<PathBuf>,
    #[command(flatten)]
    robot: RobotArguments,
    #[command(flatten)]
    demands: Demands,
    #[command(flatten)]
    apart: Apart,
    /// How long each wave goes on, or up to a period longer [s].
    #[arg(
        long,
        value_name = "SECONDS",
        allow_negative_numbers = true,
        default_value_t = 5.0
    )]
    duration: f64,
    /// The posture of rest: where a joint stands before and after [default: 0, or as near as its limits allow]. `elbow=90deg`, `lift=0.1m`; may be
    /// given several times.
    #[arg(long, value_name = "JOINT=ANGLE")]
    at: Vec<String>,
    /// Ways out of rest and back take so long at least, those from wave to wave half of it [s].
    #[arg(
        long,
        value_name = "SECONDS",
        allow_negative_numbers = true,
        default_value_t = 1.0
    )]
    ease: f64,
    /// At least so many waypoints a second [default: 100]; twice, four or eight times as many where it takes that to
    /// keep the limits and to follow the wave.
    #[arg(long, value_name = "HERTZ", allow_negative_numbers = true)]
    rate: Option<f64>,
    /// The move: .csv, .json (trajectory_msgs/JointTrajectory) or .mcap.
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    let format = Format::of(&arguments.output)?;
    if format == Format::Yaml {
        return Err(Error::new(
            ErrorKind::Setting,
            "a motion file of play_motion2, which holds no velocities",
        )
        .expected("a name that ends in .csv, .json or .mcap")
        .help("`undulate export` writes it, joined by lines"));
    }
    let waves: Vec<Wave> = arguments
        .waves
        .iter()
        .map(|path| read_wave(path))
        .collect::<Result<_>>()?;
    let (robot, map) = arguments.robot.load(waves[0].joints())?;
    let notes = tell_notes(&robot);
    let waves: Vec<Wave> = waves
        .iter()
        .map(|wave| map.apply(wave, &robot))
        .collect::<Result<_>>()?;
    let (options, _) = arguments.demands.options(&robot)?;
    let apart = arguments.apart.options(&arguments.robot.reading, &robot)?;
    let collision = CollisionModel::new(&robot, &apart)?;
    let mut rest = robot.rest();
    for text in &arguments.at {
        let (joint, position) = posture(text, &robot)?;
        rest[joint] = position;
    }
    let mut passages =
        Passages::new(&robot, collision.prover(), options.clone()).eased(arguments.ease)?;
    let waves: Vec<&Wave> = waves.iter().collect();
    let performance = passages.perform(&waves, &rest, arguments.duration)?;
    let sequence = performance.sequence;
    // What a controller makes of the waypoints is what is to pass.
    let through = |rate: f64| {
        let waypoints = at_rest(&Waypoints::sampled(&sequence, rate)?, &rest)?;
        let spline = Spline::new(&waypoints, StartPosture::Given)?;
        let verdict = Verdict::with(&robot, &mut collision.prover(), &spline, &options)?;
        Ok::<_, Error>((waypoints, verdict))
    };
    let leaves = |rate: f64| {
        let each = waves
            .iter()
            .map(|wave| departure(wave, 1.0 / rate, Format::Csv));
        each.flatten().fold(0.0, f64::max)
    };
    let mut rate = arguments.rate.unwrap_or(100.0);
    let (mut waypoints, mut verdict) = through(rate)?;
    for _ in 0..DOUBLINGS {
        if verdict.passes() && leaves(rate) <= ON_WAVE {
            break;
        }
        rate *= 2.0;
        (waypoints, verdict) = through(rate)?;
    }
    if leaves(rate) > ON_WAVE {
        return Err(Error::new(
            ErrorKind::Refused,
            format!(
                "through {} waypoints it leaves the wave by up to {:.1e} rad",
                waypoints.len(),
                leaves(rate)
            ),
        )
        .expected(format!("at most {ON_WAVE} rad"))
        .help("ask for a higher --rate"));
    }
    if let Some(reason) = verdict.reasons().first() {
        return Err(Error::new(
            ErrorKind::Refused,
            format!(
                "through {} waypoints it does not pass: {}",
                waypoints.len(),
                verdict.faults().join("; ")
            ),
        )
        .because(*reason)
        .expected("waypoints near enough to follow the motion")
        .help("ask for a higher --rate"));
    }
    let bytes = format.bytes(&waypoints, None, &arguments.output)?;
    output::write(&arguments.output, &bytes)?;
    let clearance = verdict.clearance.as_ref();
    let value = json!({
        "robot": robot.name(),
        "notes": notes,
        "legs_end_s": &sequence.times()[1..],
        "duration_s": sequence.duration(),
        "waypoints": waypoints.len(),
        "clearance_m": clearance.map(|c| [c.lower, c.at.distance]),
        "written": arguments.output,
    });
    output::report(json, &value, || {
        let ends: Vec<String> = sequence.times()[1..]
            .iter()
            .map(|end| format!("{end:.2}"))
            .collect();
        format!(
            "wrote {}: {} waypoints; legs end at {} s",
            arguments.output.display(),
            waypoints.len(),
            ends.join(", ")
        )
    });
    Ok(Outcome::Done)
}

/// The same move, at rest at its ends to the last bit and not but for rounding.
fn at_rest(waypoints: &Waypoints, rest: &[f64]) -> Result<Waypoints> {
    let zeros = vec![0.0; rest.len()];
    let last = waypoints.len() - 1;
    let rows = waypoints.iter().enumerate().map(|(n, row)| {
        if n == 0 || n == last {
            Waypoint {
                time: row.time,
                positions: rest,
                velocities: Some(&zeros),
                accelerations: Some(&zeros),
            }
        } else {
            row
        }
    });
    Waypoints::new(waypoints.joints().clone(), rows)
}

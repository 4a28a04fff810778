//! `undulate fit`.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use serde_json::json;

use super::robot::{Reading, is_file, tell_notes};
use super::{Outcome, output, read_text, read_wave};
use crate::anatomy::ShoulderOrder;
use crate::error::{Error, ErrorKind, Result};
use crate::feasibility::limits;
use crate::fourier::Derivative;
use crate::retarget::{Person, Residual, RobotArm};
use crate::robot::JointKind;
use crate::shipped;

/// A direction this far off \[deg\] at some time is no longer the person's.
const NOTABLE: f64 = 20.0;

/// Fit a person's wave to a robot whose axes are others, by where upper arm, forearm, hand and palm point.
#[derive(Args)]
#[command(
    after_help = "WAVE is of a person's joint angles: shoulder_flexion, shoulder_abduction, shoulder_rotation, elbow_flexion, and where it has them\n\
    forearm_pronation, wrist_flexion, wrist_deviation. What is written is a wave of the robot's own joints, within their limits of position, for\n\
    every other verb, without a joint map. A joint map (`undulate map`) is for robots that have a person's axes; this is for the others.\n\n\
    --directions is a TOML file:\n  \
    forward = [1, 0, 0]   # where the person looks, in the robot's base frame; up = [0, 0, 1], side = \"right\" or \"left\"\n  \
    [upper_arm]           # or [forearm], [hand], [palm]; at least one\n  \
    from = \"shoulder\"     # from the frame of one link to that of another\n  \
    to = \"elbow\"\n  \
    [hand]\n  \
    link = \"flange\"       # or an axis of a link\n  \
    axis = [0, 0, 1]\n  \
    weight = 0.5          # of its squared errors; 1 where none is given\n\n\
    How far each direction is off is told in degrees, and which joints are at a limit. A robot with few joints cannot follow all: give less weight\n\
    to what matters less, or leave it out.\n\n\
    Examples:\n  \
    undulate fit wave.json --robot table_arm -o table.json\n  \
    undulate fit wave.json --robot ur5.urdf --directions ur5_directions.toml --harmonics 15 -o ur5.json\n  \
    undulate check ur5.json --robot ur5.urdf"
)]
pub(super) struct Arguments {
    /// A wave file of a person's joints.
    wave: PathBuf,
    /// A URDF file, or the name of a shipped robot (`wave_arm`).
    #[arg(long, value_name = "URDF|NAME")]
    robot: String,
    #[command(flatten)]
    reading: Reading,
    /// What of the robot points (TOML), or the name of a shipped robot. Default: for a shipped robot, its own.
    #[arg(long, value_name = "TOML|NAME")]
    directions: Option<String>,
    /// In which order the person's shoulder angles turn: x is flexion, z abduction, y rotation.
    #[arg(long, value_enum, default_value_t = Order::Xzy)]
    order: Order,
    /// Harmonics of the robot's wave [default: those of the person's].
    #[arg(long, value_name = "K")]
    harmonics: Option<usize>,
    /// The wave file to write.
    #[arg(long, short, value_name = "FILE.json")]
    output: PathBuf,
}

#[derive(Clone, Copy, ValueEnum)]
pub(super) enum Order {
    Xzy,
    Zxy,
}

impl From<Order> for ShoulderOrder {
    fn from(order: Order) -> Self {
        match order {
            Order::Xzy => Self::Xzy,
            Order::Zxy => Self::Zxy,
        }
    }
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    let robot = arguments.reading.robot(&arguments.robot)?;
    tell_notes(&robot);
    let arm = arm(arguments)?;
    let wave = read_wave(&arguments.wave)?;
    let harmonics = arguments.harmonics.unwrap_or(wave.harmonics());
    let person = Person::new(wave, arguments.order.into())
        .map_err(|e| e.at(arguments.wave.display().to_string()))?;
    let fit = arm.fit(&person, &robot, harmonics)?;
    output::write(&arguments.output, fit.wave.to_json().as_bytes())?;

    for residual in &fit.residuals {
        let peak = residual.peak.to_degrees();
        if peak > NOTABLE {
            output::warn(format!(
                "{} is up to {peak:.0} deg away from where the person's points: this robot does not reach there with the others",
                residual.segment.name()
            ));
        }
    }
    for limit in limits(&robot, &fit.wave)? {
        let speed = limit.range.magnitude();
        if limit.quantity == Derivative::Velocity && limit.excess() > 0.0 {
            output::warn(format!(
                "{} moves at up to {speed:.1} {}, and its limit is {:.1}: it changes over between two ways to point there, or the person is quick; \
                 fewer --harmonics, other weights, or `undulate mend`",
                limit.joint,
                match limit.kind {
                    JointKind::Revolute => "rad/s",
                    JointKind::Prismatic => "m/s",
                },
                limit.limit.upper
            ));
        }
    }
    let degrees = |r: &Residual| {
        json!({
            "segment": r.segment.name(),
            "rms_deg": r.rms.to_degrees(),
            "peak_deg": r.peak.to_degrees(),
            "peak_at_s": r.peak_time,
        })
    };
    let value = json!({
        "wave": arguments.output,
        "residuals": fit.residuals.iter().map(degrees).collect::<Vec<_>>(),
        "at_limit": fit.at_limit,
        "joints": robot.joints().iter().enumerate().map(|(j, joint)| {
            let range = fit.wave.range(j, Derivative::Position);
            json!({"joint": joint, "range": [range.lower, range.upper]})
        }).collect::<Vec<_>>(),
    });
    output::report(json, &value, || {
        let rows: Vec<Vec<String>> = fit
            .residuals
            .iter()
            .map(|r| {
                vec![
                    r.segment.name().to_owned(),
                    output::degrees(r.rms),
                    output::degrees(r.peak),
                    format!("{:.2} s", r.peak_time),
                ]
            })
            .collect();
        let at_limit = match fit.at_limit.as_slice() {
            [] => "no joint is at a limit".to_owned(),
            joints => format!("at a limit: {}", joints.join(", ")),
        };
        format!(
            "{}\n{at_limit}\nwrote {}: look at it with `undulate check`",
            output::table(&["off by [deg]", "rms", "peak", "at"], &rows),
            arguments.output.display()
        )
    });
    Ok(Outcome::Done)
}

/// What of the robot points: what is named, else what is shipped with the robot.
fn arm(arguments: &Arguments) -> Result<RobotArm> {
    let file = |path: &Path| {
        RobotArm::from_toml(&read_text(path)?).map_err(|e| e.at(path.display().to_string()))
    };
    match &arguments.directions {
        Some(name) if Path::new(name).is_file() => file(Path::new(name)),
        Some(name) => shipped::arm(name).map_err(|e| match e.kind() {
            ErrorKind::Name => Error::new(ErrorKind::Name, format!("no directions `{name}`"))
                .expected(format!(
                    "a TOML file, or a shipped robot: {}",
                    shipped::robots().collect::<Vec<_>>().join(", ")
                )),
            _ => e,
        }),
        None if is_file(Path::new(&arguments.robot)) => Err(Error::new(
            ErrorKind::Setting,
            "nothing says what of the robot is its upper arm, forearm and hand",
        )
        .expected("--directions")
        .help("`undulate fit --help` shows such a file")),
        None => shipped::arm(&arguments.robot),
    }
}

//! `undulate export`.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use serde_json::json;

use super::moves::{Course, Loaded, MoveArguments};
use super::robot::{RobotArguments, tell_notes};
use super::{Outcome, output};
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::Wave;
use crate::motion::{Motion, Spline, StartPosture, Waypoints};

/// Write a wave or a recorded move as waypoints of a robot's joints, for controllers and viewers.
#[derive(Args)]
#[command(
    after_help = "MOTION is what `undulate check` takes. A wave is written over one period, evenly, from its start to its start; of a move, its own waypoints\n\
    and as many between them as the rate asks for. Times are whole nanoseconds and begin at 0; the last is the end of the motion.\n\n\
    csv   time_s, a column a joint, JOINT/velocity, JOINT/acceleration [s, rad, m]; `undulate check` reads it\n\
    json  all fields of trajectory_msgs/JointTrajectory, for joint_trajectory_controller; `undulate check` reads it\n\
    yaml  a motion file of play_motion2: positions alone, which the controller joins by lines; `undulate check` reads it\n\
    mcap  a log of joint states (JSON, uncompressed, indexed) that Foxglove plots, and by which it moves the robot of a URDF\n\n\
    A controller starts and ends at rest, and a wave does not: what is told about that is a warning. Check what you export.\n\n\
    Examples:\n  \
    undulate export wave.json --robot wave_arm --rate 100 -o wave.csv\n  \
    undulate export wave.json --robot my.urdf --map my.toml --rate 50 --format json -o trajectory.json\n  \
    undulate export nod.csv --degrees --robot my.urdf --rate 20 --name nod -o motions.yaml\n  \
    undulate export wave.json --robot wave_arm --rate 100 -o wave.mcap"
)]
pub(super) struct Arguments {
    /// A wave file or a recorded move.
    #[arg(value_name = "MOTION")]
    file: PathBuf,
    #[command(flatten)]
    target: RobotArguments,
    #[command(flatten)]
    moves: MoveArguments,
    /// At least so many waypoints a second.
    #[arg(long, value_name = "HERTZ", allow_negative_numbers = true)]
    rate: f64,
    /// What to write [default: what the name of the file ends in].
    #[arg(long, value_enum)]
    format: Option<Format>,
    /// What a motion of play_motion2 is called [default: the file's name without its end].
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// The file to write.
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(super) enum Format {
    Csv,
    Json,
    Yaml,
    Mcap,
}

impl Format {
    pub fn of(path: &Path) -> Result<Self> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
        match extension.to_ascii_lowercase().as_str() {
            "csv" => Ok(Self::Csv),
            "json" => Ok(Self::Json),
            "yaml" | "yml" => Ok(Self::Yaml),
            "mcap" => Ok(Self::Mcap),
            _ => Err(
                Error::new(ErrorKind::Setting, format!("--output {}", path.display()))
                    .expected("--format, or a name that ends in .csv, .json, .yaml, .yml or .mcap"),
            ),
        }
    }

    /// A file of waypoints; of play_motion2 by a name, else that of the file.
    pub fn bytes(self, waypoints: &Waypoints, name: Option<&str>, path: &Path) -> Result<Vec<u8>> {
        Ok(match self {
            Self::Csv => waypoints.to_csv()?,
            Self::Json => waypoints.to_json()?,
            Self::Yaml => {
                let stem = path.file_stem().unwrap_or_default().to_string_lossy();
                let name = name.map_or_else(|| parameter_name(&stem), str::to_owned);
                waypoints.to_play_motion(&name)?
            }
            Self::Mcap => waypoints.to_mcap(),
        })
    }
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    let format = match arguments.format {
        Some(format) => format,
        None => Format::of(&arguments.output)?,
    };
    if arguments.name.is_some() && format != Format::Yaml {
        return Err(
            Error::new(ErrorKind::Setting, "--name for a format without names").expected("yaml"),
        );
    }
    let target = &arguments.target;
    let robot = target.reading.robot(&target.robot)?;
    tell_notes(&robot);
    let motions = arguments.moves.open(&arguments.file, &robot, target);
    let count = motions.len();
    let Some((_, loaded)) = motions.into_iter().next().filter(|_| count == 1) else {
        return Err(Error::new(ErrorKind::Setting, format!("{count} motions"))
            .expected("one")
            .help("choose one with --motion")
            .at(arguments.file.display().to_string()));
    };
    let Loaded { course, held, .. } = loaded?;
    let (waypoints, between) = match &course {
        Course::Wave(wave) => {
            let waypoints = Waypoints::sampled(&**wave, arguments.rate)?;
            let h = wave.duration() / (waypoints.len() - 1) as f64;
            let between = departure(wave, h, format);
            (waypoints, between)
        }
        // As it is run, but for velocities and accelerations where the format has none.
        Course::Move(spline) => (spline.resampled(arguments.rate)?, None),
    };
    match &course {
        Course::Wave(wave) => tell_start(wave),
        Course::Move(_) => {
            let notes = Spline::new(&waypoints, StartPosture::Given)?.notes();
            notes.iter().for_each(output::warn);
        }
    }
    if format == Format::Yaml && waypoints.iter().any(|w| w.velocities.is_some()) {
        output::warn(
            "a motion file of play_motion2 holds no velocities: the controller joins its positions by lines",
        );
    }
    let bytes = format.bytes(&waypoints, arguments.name.as_deref(), &arguments.output)?;
    output::write(&arguments.output, &bytes)?;

    let last = waypoints.get(waypoints.len() - 1).time;
    let value = json!({
        "file": arguments.output,
        "joints": waypoints.joints().iter().collect::<Vec<_>>(),
        "waypoints": waypoints.len(),
        "duration_s": last,
        "held_still": held.iter().map(|(joint, position)| json!({"joint": joint, "position": position})).collect::<Vec<_>>(),
        "departs_from_wave_rad": between,
    });
    output::report(json, &value, || {
        let mut text = format!(
            "wrote {}: {} waypoints of {} joints, 0 to {last} s",
            arguments.output.display(),
            waypoints.len(),
            waypoints.joints().len()
        );
        if let Some(between) = between {
            text.push_str(&format!(
                "; between them the controller leaves the wave by {between:.1e} rad at most"
            ));
        }
        text
    });
    Ok(Outcome::Done)
}

/// A controller is at rest before and after, and a wave is not, nearly anywhere.
fn tell_start(wave: &Wave) {
    let velocity = wave.state(0.0).velocity;
    let joint = velocity.iamax();
    if velocity[joint] != 0.0 {
        output::warn(format!(
            "the wave starts and ends in motion, joint `{}` at {:.2} a second, and a controller at rest: lead the robot in and out of it",
            wave.joints().name(joint),
            velocity[joint]
        ));
    }
}

/// By how much the controller's spline through waypoints `h` \[s\] apart may leave the wave \[rad, m\]: the remainder of Hermite's interpolation by
/// quintics, or by lines; `None` where nothing interpolates.
pub(super) fn departure(wave: &Wave, h: f64, format: Format) -> Option<f64> {
    let (order, divisor) = match format {
        Format::Csv | Format::Json => (6, 46080.0),
        Format::Yaml => (2, 8.0),
        Format::Mcap => return None,
    };
    let joints = 0..wave.joints().len();
    joints
        .map(|joint| wave.harmonic_sum(joint, order) * h.powi(order) / divisor)
        .max_by(f64::total_cmp)
}

/// The name with what a ROS parameter cannot be called by made underscores.
fn parameter_name(name: &str) -> String {
    let fits = |c: char| {
        if c.is_ascii_alphanumeric() { c } else { '_' }
    };
    name.chars().map(fits).collect()
}

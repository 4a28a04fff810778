//! `undulate map`.

use std::path::PathBuf;

use clap::{ArgGroup, Args};
use rand::distr::Distribution;
use serde_json::json;

use super::robot::{Reading, joint_map};
use super::{Outcome, output, read_model};
use crate::error::{Error, ErrorKind, Result};
use crate::figure::{Image, Poses};
use crate::fourier::{Derivative, Interval, Wave};
use crate::primitive::{FourierMovementPrimitive, stream};
use crate::retarget::{JointMap, Source};
use crate::robot::{JointKind, Robot};

/// Width and height of a tile of the picture \[px\].
const TILE: (u32, u32) = (480, 400);
const COLUMNS: usize = 4;
/// Draws, of fixed seed, whose median range is shown.
const DRAWS: u64 = 25;

/// Write a joint map to start from, or look at one.
#[derive(Args)]
#[command(
    group = ArgGroup::new("what").required(true),
    after_help = "--show draws the robot at the mean posture, and for each joint how the robot moves (pale to solid) while the\n    learned joint grows: does it flex when the person flexed?\n\n\
    Examples:\n  \
    undulate map --init model.json my.urdf -o my.toml\n  \
    undulate map --show model.json my.urdf --map my.toml -o my.png"
)]
pub(super) struct Arguments {
    /// Write a commented map for this model and robot.
    #[arg(long, group = "what")]
    init: bool,
    /// Draw the robot as the map moves it.
    #[arg(long, group = "what")]
    show: bool,
    /// The model file.
    model: PathBuf,
    /// A URDF file, or the name of a shipped robot.
    #[arg(value_name = "ROBOT")]
    robot: String,
    #[command(flatten)]
    reading: Reading,
    /// The map to show; as in `undulate check`.
    #[arg(long, value_name = "TOML|NAME", conflicts_with = "init")]
    map: Option<String>,
    /// Let --init overwrite a file.
    #[arg(long, requires = "init")]
    force: bool,
    /// The file to write [default: map.toml, map.png].
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    let primitive = read_model(&arguments.model)?;
    let robot = arguments.reading.robot(&arguments.robot)?;
    let learned = primitive.chart().joints();
    if arguments.init {
        let path = arguments
            .output
            .clone()
            .unwrap_or_else(|| "map.toml".into());
        if path.exists() && !arguments.force {
            return Err(Error::new(
                ErrorKind::Setting,
                "the file exists, and may have been edited",
            )
            .help("name another with --output, or overwrite it with --force")
            .at(path.display().to_string()));
        }
        output::write(&path, JointMap::template(learned, &robot).as_bytes())?;
        output::report(json, &json!({"map": path}), || {
            format!(
                "wrote {}: edit it, then look with `undulate map --show`",
                path.display()
            )
        });
        return Ok(Outcome::Done);
    }
    super::robot::tell_notes(&robot);
    let map = joint_map(arguments.map.as_deref(), &arguments.robot, learned)?;
    let wave = map.apply(&primitive.mean_wave(), &robot)?;
    let ranges = typical_ranges(&primitive, &map, &robot)?;
    let path = arguments.output.clone().unwrap_or_else(|| "map.png".into());
    output::write(&path, &picture(&robot, &map, &wave, &ranges)?.to_png()?)?;

    let outside = |j: usize| {
        robot
            .properties(j)
            .position
            .is_some_and(|limit| ranges[j].lower < limit.lower || ranges[j].upper > limit.upper)
    };
    let value = json!({
        "picture": path,
        "joints": robot.joints().iter().enumerate().map(|(j, joint)| json!({
            "joint": joint,
            "mean_rad": wave.offsets()[j],
            "range_rad": [ranges[j].lower, ranges[j].upper],
            "limit_rad": robot.properties(j).position.map(|l| [l.lower, l.upper]),
        })).collect::<Vec<_>>(),
    });
    let rows: Vec<Vec<String>> = robot
        .joints()
        .iter()
        .enumerate()
        .map(|(j, joint)| {
            vec![
                joint.clone(),
                output::degrees(wave.offsets()[j]),
                span(ranges[j]),
                robot.properties(j).position.map_or("none".into(), span),
                if outside(j) {
                    "outside".into()
                } else {
                    String::new()
                },
            ]
        })
        .collect();
    output::report(json, &value, || {
        format!(
            "{}\nwrote {}",
            output::table(&["joint [deg]", "mean", "typical wave", "limit", ""], &rows),
            path.display()
        )
    });
    Ok(Outcome::Done)
}

/// For each robot joint, the medians over draws of the lowest and highest position.
fn typical_ranges(
    primitive: &FourierMovementPrimitive,
    map: &JointMap,
    robot: &Robot,
) -> Result<Vec<Interval>> {
    let waves = (0..DRAWS)
        .map(|k| map.apply(&primitive.sample(&mut stream(0, k)), robot))
        .collect::<Result<Vec<Wave>>>()?;
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let joints = 0..robot.joints().len();
    Ok(joints
        .map(|j| {
            let ranges: Vec<Interval> = waves
                .iter()
                .map(|w| w.range(j, Derivative::Position))
                .collect();
            Interval {
                lower: median(ranges.iter().map(|r| r.lower).collect()),
                upper: median(ranges.iter().map(|r| r.upper).collect()),
            }
        })
        .collect())
}

fn span(interval: Interval) -> String {
    format!(
        "{} .. {}",
        output::degrees(interval.lower),
        output::degrees(interval.upper)
    )
}

/// A tile of the mean posture, then one a joint that moves: from pale to solid, the learned joint grows.
fn picture(robot: &Robot, map: &JointMap, wave: &Wave, ranges: &[Interval]) -> Result<Image> {
    let posture: Vec<f64> = wave.offsets().iter().copied().collect();
    let tile = |configurations: &[Vec<f64>], caption: &str| {
        let poses = Poses {
            robot,
            configurations,
            path: configurations,
        };
        poses.draw(TILE)?.captioned(caption)
    };
    let mut tiles = vec![tile(std::slice::from_ref(&posture), "mean posture")?];
    for (j, joint) in robot.joints().iter().enumerate() {
        let (learned, gain) = match map.sources().find(|(name, _)| name == joint) {
            Some((_, Source::Constant(_))) => continue,
            Some((_, Source::Learned { joint, gain, .. })) => (joint.as_str(), *gain),
            None => (joint.as_str(), 1.0),
        };
        let Interval { lower, upper } = ranges[j];
        let (from, to) = if gain < 0.0 {
            (upper, lower)
        } else {
            (lower, upper)
        };
        let through: Vec<Vec<f64>> = (0..=4)
            .map(|i| {
                let mut q = posture.clone();
                q[j] = from + (to - from) * f64::from(i) / 4.0;
                q
            })
            .collect();
        let shown = |x: f64| match robot.joint(j).kind {
            JointKind::Revolute => format!("{}°", output::degrees(x)),
            JointKind::Prismatic => format!("{x:.3} m"),
        };
        let caption = format!("{learned} grows: {joint} {} to {}", shown(from), shown(to));
        tiles.push(tile(&through, &caption)?);
    }
    Image::tiled(&tiles, COLUMNS)
}

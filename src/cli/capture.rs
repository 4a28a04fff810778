//! `undulate capture`.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use serde_json::{Value, json};

use super::fit::Order;
use super::{Outcome, output, read_text};
use crate::capture::{ArmMotion, BoneMap, Bvh, PositionOptions, Side};
use crate::demonstration::Recording;
use crate::error::{Error, ErrorKind, Result};
use crate::units::parse_angle;

/// An arm whose hand moves less than this share of the other's hangs or rests.
const MOVES: f64 = 0.5;

/// Turn motion capture, BVH or positions, into recordings of an arm's angles, for `learn`.
#[derive(Args)]
#[command(
    after_help = "BVH: the skeletons of CMU's recordings (for MotionBuilder, for Daz), of Bandai Namco's and of Mixamo are known by their bones. For others say in\n\
    a JSON file (--bones) which bones are what; fingers, and one of the arms, may be left out. Where a bone's own axes are not X left, Y up, Z\n\
    forward in the T-pose (arms out, palms down), say which of them are up and forward then:\n  \
    {\"thorax\": {\"bone\": \"Spine_02\", \"up\": [1, 0, 0], \"forward\": [0, 1, 0]},\n   \
    \"right\": {\"upper_arm\": \"Arm_R\", \"forearm\": \"Elbow_R\", \"hand\": \"Wrist_R\", \"fingers\": \"Middle_R\"}}\n\n\
    CSV: time_s [s]; shoulder_x, _y, _z, elbow_x.., hand_x.. (the wrist) in metres, X to the person's left, Y up, Z forward. With other_shoulder_x..\n\
    and pelvis_x.. angles are relative to the trunk. Shoulder and elbow come of it; forearm and wrist cannot.\n\n\
    Written are shoulder_flexion, shoulder_abduction, shoulder_rotation, elbow_flexion, forearm_pronation, wrist_flexion, wrist_deviation [rad]; 0 is\n\
    the arm hanging, palm to the thigh. Left arms are mirrored, so that both can be learned together. Learn recordings of one --order only, and\n\
    give it to `fit` again.\n\n\
    Examples:\n  \
    undulate capture wave.bvh -o recordings/\n  \
    undulate capture a.bvh b.bvh --arm right --order zxy --from 1.5 --to 7 -o recordings/\n  \
    undulate capture mine.bvh --bones bones.json --arm both -o recordings/\n  \
    undulate capture markers.csv --arm left -o left.csv\n  \
    undulate learn recordings/ -o model.json"
)]
pub(super) struct Arguments {
    /// BVH files, or CSV files of positions.
    #[arg(value_name = "BVH|CSV", required = true)]
    files: Vec<PathBuf>,
    /// Which arm [default: of BVH whose hand moves, of positions the right one].
    #[arg(long, value_enum)]
    arm: Option<Arm>,
    /// In which order the shoulder's angles turn: x is flexion, z abduction, y rotation.
    #[arg(long, value_enum, default_value_t = Order::Xzy)]
    order: Order,
    /// Which bones are what (JSON), for skeletons that are not known.
    #[arg(long, value_name = "JSON")]
    bones: Option<PathBuf>,
    /// Take the part from this time on.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    from: Option<f64>,
    /// Take the part up to this time.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    to: Option<f64>,
    /// Frames a second, where a BVH file's frame time is wrong.
    #[arg(long, value_name = "HERTZ", allow_negative_numbers = true)]
    rate: Option<f64>,
    /// The zero of shoulder_rotation, as it was told for a longer recording of the same person (`-31deg`, or radians) [default: by the mean
    /// axis of the elbow over the whole file].
    #[arg(long, value_name = "ANGLE", value_parser = parse_angle, allow_hyphen_values = true)]
    hinge_roll: Option<f64>,
    /// Where the shoulder stays [m], for positions without it.
    #[arg(
        long,
        value_name = "X,Y,Z",
        value_delimiter = ',',
        num_args = 1,
        allow_hyphen_values = true
    )]
    shoulder: Option<Vec<f64>>,
    /// A folder for FILE_R.csv and FILE_L.csv, or a `.csv` file for one recording.
    #[arg(long, short, value_name = "FOLDER|FILE.csv")]
    output: PathBuf,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Arm {
    Right,
    Left,
    Both,
}

impl Arm {
    fn sides(self) -> &'static [Side] {
        match self {
            Self::Right => &[Side::Right],
            Self::Left => &[Side::Left],
            Self::Both => &Side::ALL,
        }
    }
}

/// Elbows of skeletons that are known turn about axes within 35 deg of across the arm \[rad\].
const MOST_ROLL: f64 = 1.0;

/// What a file gives: its arms, and what is to be said about them.
struct Taken {
    motions: Vec<ArmMotion>,
    skeleton: Option<String>,
    words: String,
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    let map = match &arguments.bones {
        Some(path) => Some(
            BoneMap::from_json(&read_text(path)?).map_err(|e| e.at(path.display().to_string()))?,
        ),
        None => None,
    };
    let mut written: Vec<(PathBuf, Vec<u8>)> = Vec::new();
    let (mut values, mut words) = (Vec::new(), Vec::new());
    for file in &arguments.files {
        let text = crate::document::bytes(file)?;
        let taken = take(arguments, map.as_ref(), file, &text)
            .map_err(|e| e.at(file.display().to_string()))?;
        words.push(format!("{}: {}", file.display(), taken.words));
        for motion in taken.motions {
            let path = path(arguments, file, motion.side());
            let captured = motion
                .angles(&path.display().to_string(), arguments.order.into())
                .map_err(|e| e.at(file.display().to_string()))?;
            for note in &captured.notes {
                output::warn(format!(
                    "{}, {} arm: {note}",
                    file.display(),
                    motion.side().name()
                ));
            }
            let roll = motion.hinge_roll();
            if arguments.hinge_roll.is_none() && roll.abs() > MOST_ROLL {
                output::warn(format!(
                    "{}, {} arm: the elbow bends about an axis {} deg off where an elbow's is, so `up` or `forward` of a bone may be wrong",
                    file.display(),
                    motion.side().name(),
                    output::degrees(roll)
                ));
            }
            words.push(format!(
                "  {} arm: {} samples, {:.2} s, elbow's axis at {} deg, to {}",
                motion.side().name(),
                motion.samples(),
                motion.span(),
                output::degrees(motion.hinge_roll()),
                path.display()
            ));
            values.push(json!({
                "file": path,
                "source": file,
                "skeleton": taken.skeleton,
                "arm": motion.side().name(),
                "samples": motion.samples(),
                "duration_s": motion.span(),
                "rate_hz": motion.rate(),
                "arm_lengths_per_s": motion.speed(),
                "hinge_roll_rad": motion.hinge_roll(),
                "notes": captured.notes.iter().map(ToString::to_string).collect::<Vec<_>>(),
            }));
            if written.iter().any(|(other, _)| *other == path) {
                return Err(Error::new(
                    ErrorKind::Setting,
                    format!("two recordings for {}", path.display()),
                )
                .expected("a folder, and input files of different names"));
            }
            written.push((path, table(&captured.recording)?));
        }
    }
    // All of them are read before the first is written.
    for (path, bytes) in &written {
        output::write(path, bytes)?;
    }
    let order = crate::anatomy::ShoulderOrder::from(arguments.order).to_string();
    let value: Value = json!({"order": order, "recordings": values});
    output::report(json, &value, || {
        format!(
            "{}\nwrote {} recordings, order {order}",
            words.join("\n"),
            written.len()
        )
    });
    Ok(Outcome::Done)
}

fn take(arguments: &Arguments, map: Option<&BoneMap>, file: &Path, text: &[u8]) -> Result<Taken> {
    let is_table = file
        .extension()
        .is_some_and(|end| end.eq_ignore_ascii_case("csv"));
    let mut taken = match is_table {
        true => positions(arguments, text)?,
        false => bones(arguments, map, text)?,
    };
    let ends = [(arguments.from, "--from"), (arguments.to, "--to")];
    if let Some((_, option)) = ends.iter().find(|(end, _)| end.is_some_and(f64::is_nan)) {
        return Err(
            Error::new(ErrorKind::Setting, format!("{option} nan")).expected("a time in seconds")
        );
    }
    if arguments.from.is_some() || arguments.to.is_some() {
        let from = arguments.from.unwrap_or(f64::NEG_INFINITY);
        let to = arguments.to.unwrap_or(f64::INFINITY);
        for motion in &mut taken.motions {
            *motion = motion.between(from, to)?;
        }
    }
    Ok(taken)
}

fn bones(arguments: &Arguments, map: Option<&BoneMap>, text: &[u8]) -> Result<Taken> {
    if arguments.shoulder.is_some() {
        return Err(Error::new(ErrorKind::Setting, "--shoulder for a BVH file")
            .expected("it for positions (.csv)"));
    }
    // Names of bones may be in any encoding.
    let mut bvh = Bvh::from_text(&String::from_utf8_lossy(text))?;
    if let Some(rate) = arguments.rate {
        bvh = bvh.with_rate(rate)?;
    }
    let recognised;
    let map = match map {
        Some(map) => map,
        None => {
            recognised = BoneMap::recognise(&bvh)?;
            &recognised
        }
    };
    let sides: Vec<Side> = match arguments.arm {
        Some(arm) => arm.sides().to_vec(),
        None => map.sides().collect(),
    };
    let motion = |side: &Side| -> Result<ArmMotion> {
        let motion = ArmMotion::from_bvh(&bvh, map, *side)?;
        match arguments.hinge_roll {
            Some(roll) => motion.with_hinge_roll(roll),
            None => Ok(motion),
        }
    };
    let mut motions = sides.iter().map(motion).collect::<Result<Vec<_>>>()?;
    let speeds: Vec<String> = motions
        .iter()
        .map(|m| format!("{} hand {:.2}", m.side().name(), m.speed()))
        .collect();
    if arguments.arm.is_none() {
        let fastest = motions.iter().map(ArmMotion::speed).fold(0.0, f64::max);
        motions.retain(|motion| motion.speed() >= MOVES * fastest);
    }
    let skeleton = map.skeleton();
    Ok(Taken {
        words: format!(
            "{} of {} bones, {} frames at {} Hz; {} arm lengths/s",
            skeleton.map_or("a skeleton".to_owned(), |name| format!("skeleton {name}")),
            bvh.bones().count(),
            bvh.frames(),
            (1e3 * bvh.rate()).round() / 1e3,
            speeds.join(", ")
        ),
        motions,
        skeleton: skeleton.map(str::to_owned),
    })
}

fn positions(arguments: &Arguments, text: &[u8]) -> Result<Taken> {
    let wrong = [
        (arguments.bones.is_some(), "--bones"),
        (arguments.rate.is_some(), "--rate"),
        (arguments.hinge_roll.is_some(), "--hinge-roll"),
    ];
    if let Some((_, option)) = wrong.iter().find(|(given, _)| *given) {
        return Err(
            Error::new(ErrorKind::Setting, format!("{option} for positions"))
                .expected("it for BVH files"),
        );
    }
    let side = match arguments.arm {
        None | Some(Arm::Right) => Side::Right,
        Some(Arm::Left) => Side::Left,
        Some(Arm::Both) => {
            return Err(Error::new(ErrorKind::Setting, "--arm both for positions")
                .expected("right or left: a table is of one arm"));
        }
    };
    let shoulder = match arguments.shoulder.as_deref() {
        None => None,
        Some(numbers) => Some(numbers.try_into().map_err(|_| {
            Error::new(
                ErrorKind::Setting,
                format!("--shoulder of {} numbers", numbers.len()),
            )
            .expected("three: X,Y,Z")
        })?),
    };
    let motion = ArmMotion::from_positions(text, PositionOptions { side, shoulder })?;
    Ok(Taken {
        words: format!(
            "positions of a {} arm, {:.2} Hz",
            side.name(),
            motion.rate()
        ),
        motions: vec![motion],
        skeleton: None,
    })
}

/// The file named as output, or one in that folder that is called after the source and the arm.
fn path(arguments: &Arguments, file: &Path, side: Side) -> PathBuf {
    let is_file = arguments
        .output
        .extension()
        .is_some_and(|end| end.eq_ignore_ascii_case("csv"));
    if is_file {
        return arguments.output.clone();
    }
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let arm = match side {
        Side::Right => "R",
        Side::Left => "L",
    };
    arguments.output.join(format!("{stem}_{arm}.csv"))
}

/// As `learn` reads it.
fn table(recording: &Recording) -> Result<Vec<u8>> {
    let header = ["time_s"].into_iter().map(str::to_owned);
    let header = header.chain(recording.joints().iter().cloned());
    let rows = recording.times().iter().enumerate().map(|(n, t)| {
        let row = recording.positions().row(n);
        std::iter::once(*t).chain(row.iter().copied().collect::<Vec<_>>())
    });
    output::csv(header, rows)
}

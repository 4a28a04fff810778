//! `undulate verify`.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::demands::Apart;
use super::moves::{Course, JOINT_MOTION, Loaded, MoveArguments};
use super::robot::RobotArguments;
use super::{Outcome, output, read_text};
use crate::collision::{Certificate, CollisionModel, Evidence};
use crate::error::{Error, ErrorKind, Result};

/// What every certificate of `check` names.
const NEEDED: [&str; 3] = ["urdf", "motion", JOINT_MOTION];

/// Verify a certificate again, by other means.
#[derive(Args)]
#[command(
    after_help = "First the files are held against the fingerprints that the certificate names: URDF, motion, SRDF, scene, joint map. Then every interval of\n\
    its proof is looked at with the robot's own kinematics and distances by parry, and that the intervals cover the motion for every pair. Limits\n\
    are not looked at again. Give the same options about meshes, pairs and padding as to `check`. Exit codes: 0 it holds, 1 an input cannot be used,\n\
    2 the command line is wrong, 3 it does not hold, or is of other files.\n\n\
    Example:\n  \
    undulate verify wave.cert.json wave.json --robot my.urdf --map my.toml --srdf my.srdf --scene table.toml"
)]
pub(super) struct Arguments {
    /// The certificate that `undulate check --certificate` wrote.
    certificate: PathBuf,
    /// The motion that it is of.
    #[arg(value_name = "MOTION")]
    of: PathBuf,
    #[command(flatten)]
    robot: RobotArguments,
    #[command(flatten)]
    moves: MoveArguments,
    #[command(flatten)]
    apart: Apart,
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    let looked_at = look(arguments, json);
    if let Err(error) = &looked_at {
        let value = json!({"passes": false, "error": error.to_string()});
        output::report(json, &value, || "could not be looked at".to_owned());
    }
    looked_at
}

fn look(arguments: &Arguments, json: bool) -> Result<Outcome> {
    let place = arguments.certificate.display().to_string();
    let certificate = Certificate::from_json(&read_text(&arguments.certificate)?).map_err(|e| {
        e.help("`undulate check --certificate` writes certificates")
            .at(place.clone())
    })?;
    let target = &arguments.robot;
    let robot = target.reading.robot(&target.robot)?;
    let mut motions = arguments.moves.open(&arguments.of, &robot, target);
    let (name, loaded) = match (motions.pop(), motions.is_empty()) {
        (Some(one), true) => one,
        _ => {
            return Err(Error::new(ErrorKind::Setting, "several motions")
                .expected("the one that the certificate is of")
                .help("choose it with --motion"));
        }
    };
    let Loaded {
        course, evidence, ..
    } = loaded?;
    let mut given = target.reading.evidence(&target.robot)?;
    given.extend(evidence);
    let options = arguments.apart.options(&target.reading, &robot)?;
    // What is wrong with the robot itself is no fault of the certificate.
    CollisionModel::new(&robot, &options)?;

    let held = match compare(certificate.rests_on(), &given) {
        Some(difference) => Err(Error::new(ErrorKind::Infeasible, difference)),
        None => match &course {
            Course::Wave(wave) => certificate.verify(&robot, &**wave, &options),
            Course::Move(spline) => certificate.verify(&robot, &**spline, &options),
        },
    };
    let tolerance = certificate.joints().iter().zip(certificate.tolerance());
    let mut value = json!({
        "passes": held.is_ok(),
        "motion": name,
        "robot": robot.name(),
        "margin_m": certificate.margin(),
        "tolerance": tolerance.clone().map(|(j, t)| (j.clone(), json!(t))).collect::<serde_json::Map<_, _>>(),
        "rests_on": certificate.rests_on(),
    });
    let verified = match held {
        Ok(verified) => verified,
        Err(error) => {
            value["error"] = json!(error.to_string());
            output::report(json, &value, || "does not hold".to_owned());
            output::failure(&error.at(place));
            return Ok(Outcome::Refused);
        }
    };
    value["intervals"] = json!(verified.intervals);
    value["distances"] = json!(verified.distances);
    value["spare_m"] = json!(verified.spare);
    output::report(json, &value, || {
        let mut lines: Vec<String> = certificate
            .rests_on()
            .iter()
            .map(|e| format!("{} {}: the same", e.what, e.name))
            .collect();
        lines.push(format!(
            "margin {} mm, tolerance {}",
            super::verdict::millimetres(certificate.margin()),
            match certificate.tolerance().iter().any(|t| *t > 0.0) {
                true => tolerance
                    .map(|(joint, tolerance)| format!("{joint} {tolerance}"))
                    .collect::<Vec<_>>()
                    .join(", "),
                false => "none".to_owned(),
            }
        ));
        lines.push(format!(
            "looked at {} intervals of time and {} distances; least to spare {:.2e} m",
            verified.intervals, verified.distances, verified.spare
        ));
        lines.push("holds".to_owned());
        lines.join("\n")
    });
    Ok(Outcome::Done)
}

/// The first difference between what a certificate rests on and what is given.
fn compare(rests_on: &[Evidence], given: &[Evidence]) -> Option<String> {
    for needed in NEEDED {
        if !rests_on.iter().any(|e| e.what == needed) {
            return Some(format!("the certificate names no {needed}"));
        }
    }
    for named in rests_on {
        let what = &named.what;
        match given.iter().find(|g| g.what == *what) {
            None => {
                return Some(format!(
                    "the certificate rests on the {what} `{}`, and none is given",
                    named.name
                ));
            }
            Some(found) if found.sha256 != named.sha256 && *what == JOINT_MOTION => {
                return Some(
                    "the file makes another motion of the joints than the certificate is of: give the same --motion, --at and --degrees as to `check`"
                        .to_owned(),
                );
            }
            Some(found) if found.sha256 != named.sha256 => {
                return Some(format!(
                    "the {what} `{}` is not the one that the certificate rests on, `{}` of sha256 {}",
                    found.name, named.name, named.sha256
                ));
            }
            Some(_) => {}
        }
    }
    let unnamed = given
        .iter()
        .find(|g| !rests_on.iter().any(|e| e.what == g.what))?;
    Some(format!(
        "the {} `{}` is given, and the certificate rests on none",
        unnamed.what, unnamed.name
    ))
}

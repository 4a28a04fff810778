//! `undulate reproduce`: the main job, end to end.

mod case;
mod claims;
mod pictures;

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use self::case::{Bench, Case};
use self::claims::{Claim, claims};
use self::pictures::{figure1, figure2, figure3};
use super::simulate::{rollout_json, rollout_table};
use super::{Outcome, output};
use crate::collision::{CollisionModel, CollisionOptions};
use crate::demonstration::{Demonstrations, synthetic};
use crate::error::{Error, ErrorKind, Result};
use crate::figure::Picture;
use crate::primitive::{FourierMovementPrimitive, LearnOptions, Observation};
use crate::shipped;

const ELBOW: &str = "elbow_flexion";
const WRIST: &str = "wrist_deviation";
const HARMONICS: usize = 25;

/// Learn, condition, sample, check and execute the paper's waves; draw its figures.
#[derive(Args)]
#[command(after_help = "Example:\n  undulate reproduce --seed 1 --out out")]
pub(super) struct Arguments {
    /// Seed of the demonstrator and of the draws.
    #[arg(long, value_name = "SEED", default_value_t = 0)]
    seed: u64,
    /// The folder to write figures and report into.
    #[arg(long, short, value_name = "FOLDER", default_value = "out")]
    out: PathBuf,
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    let bar = output::progress(6, "learning");
    let demonstrations = synthetic(arguments.seed)?;
    let fits = demonstrations.fit(HARMONICS)?;
    let primitive = FourierMovementPrimitive::from_waves(&fits, &LearnOptions::paper())?;
    let robot = shipped::robot("wave_arm")?;
    let collision = CollisionModel::new(&robot, &CollisionOptions::default())?;
    let map = shipped::map("wave_arm_demonstrator")?;
    let bench = Bench {
        robot: &robot,
        collision: &collision,
        map: &map,
        seed: arguments.seed,
    };
    bar.inc(1);
    bar.set_message("executing, elbow-conditioned");
    let elbow = bench.case(
        &primitive,
        "elbow",
        Observation::modulus(ELBOW, 10, 5f64.to_radians()),
    )?;
    bar.inc(1);
    bar.set_message("executing, wrist-conditioned");
    let wrist = bench.case(
        &primitive,
        "wrist",
        Observation::modulus(WRIST, 20, 4f64.to_radians()),
    )?;
    bar.inc(1);

    bar.set_message("drawing");
    let figure1 = figure1(&fits, &primitive, &elbow, &wrist)?;
    let figure2 = figure2(&elbow)?;
    bar.inc(1);
    let figure3 = figure3(&robot, &elbow, &wrist)?;
    bar.inc(1);

    let claims = claims(&primitive, &elbow, &wrist)?;
    let report = report(
        arguments.seed,
        &demonstrations,
        &claims,
        &primitive,
        &[&elbow, &wrist],
    )?;
    let pretty = serde_json::to_string_pretty(&report)
        .map_err(|e| Error::new(ErrorKind::Io, e.to_string()))?;
    save(arguments, "figure1", &figure1)?;
    save(arguments, "figure2", &figure2)?;
    output::write(&arguments.out.join("figure3.png"), &figure3)?;
    output::write(
        &arguments.out.join("report.json"),
        format!("{pretty}\n").as_bytes(),
    )?;
    bar.finish_and_clear();
    output::report(json, &report, || {
        words(arguments, &claims, &[&elbow, &wrist])
    });
    Ok(Outcome::Done)
}

fn save(arguments: &Arguments, name: &str, picture: &Picture) -> Result<()> {
    output::write(
        &arguments.out.join(format!("{name}.svg")),
        picture.svg.as_bytes(),
    )?;
    output::write(&arguments.out.join(format!("{name}.png")), &picture.png)
}

fn report(
    seed: u64,
    demonstrations: &Demonstrations,
    claims: &[Claim],
    prior: &FourierMovementPrimitive,
    cases: &[&Case],
) -> Result<Value> {
    let spectrum = |primitive: &FourierMovementPrimitive| -> Result<Value> {
        let mut joints = serde_json::Map::new();
        for joint in primitive.chart().joints() {
            let medians = (1..=HARMONICS)
                .map(|k| Ok(primitive.median_modulus(joint, k)?.to_degrees()))
                .collect::<Result<Vec<f64>>>()?;
            joints.insert(joint.clone(), json!(medians));
        }
        Ok(Value::Object(joints))
    };
    let cases = cases
        .iter()
        .map(|case| {
            Ok(json!({
                "condition": case.observation.quantity.to_string(),
                "value_deg": case.observation.value.to_degrees(),
                "median_moduli_deg": spectrum(&case.primitive)?,
                "waves": case.waves.len(),
                "draws": case.draws,
                "clearance_m": case.clearance.lower,
                "nearest_pair": [&case.clearance.at.pair.0, &case.clearance.at.pair.1],
                "limits": case.verdict.limits.iter().map(super::verdict::limit_json).collect::<Vec<_>>(),
                "rollout": rollout_json(&case.rollout),
            }))
        })
        .collect::<Result<Vec<_>>>()?;
    Ok(json!({
        "seed": seed,
        "demonstrations": demonstrations.recordings().len(),
        "joints": demonstrations.joints().iter().collect::<Vec<_>>(),
        "period_s": demonstrations.period(),
        "harmonics": HARMONICS,
        "median_moduli_deg": spectrum(prior)?,
        "claims": claims.iter().map(|c| json!({
            "claim": c.text.trim(), "expected": c.expected, "found": c.found, "holds": c.holds,
        })).collect::<Vec<_>>(),
        "cases": cases,
    }))
}

fn words(arguments: &Arguments, claims: &[Claim], cases: &[&Case]) -> String {
    let number = |x: f64| {
        if x.abs() < 0.01 {
            format!("{x:.1e}")
        } else {
            format!("{x:.2}")
        }
    };
    let rows: Vec<Vec<String>> = claims
        .iter()
        .map(|c| {
            vec![
                c.text.to_owned(),
                c.expected.to_owned(),
                number(c.found),
                if c.holds {
                    "holds".into()
                } else {
                    "does not hold".into()
                },
            ]
        })
        .collect();
    let mut text = output::table(&["the paper's claims", "expected", "found", ""], &rows);
    for case in cases {
        text.push_str(&format!(
            "\n\n{}-conditioned, executed: {} draws for {} waves within limits and free of contact\n{}",
            case.name,
            case.draws,
            case.waves.len(),
            rollout_table(&case.rollout)
        ));
    }
    text.push_str(&format!(
        "\n\nwrote figure1 and figure2 (svg, png), figure3.png and report.json into {}",
        arguments.out.display()
    ));
    text
}

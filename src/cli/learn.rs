//! `undulate learn`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use serde_json::json;

use super::assumptions::{Assumptions, offset_table};
use super::learn_cycle;
use super::learn_kinds::{self, KindsFrom};
use super::recordings::Recordings;
use super::{Outcome, output};
use crate::demonstration::Recording;
use crate::error::{Error, ErrorKind, Result};
use crate::fourier::Wave;
use crate::primitive::{FourierMovementPrimitive, LearnOptions, Offsets};

/// A step from end to start that drawn waves cannot but make up for by speed \[rad\].
const NOTABLE_JUMP: f64 = 0.2;

/// A recording that leaves more of its energy than this to frequencies beyond K is worth a word.
const MUCH_LEAKAGE: f64 = 0.05;

/// No joint of a person or robot that waves is wound up so far \[rad\].
const UNLIKELY: f64 = 4.0 * std::f64::consts::PI;

/// Standard deviations below this are those of one demonstration given several times.
const IDENTICAL: f64 = 1e-9;

/// Learn a movement primitive from recordings.
#[derive(Args)]
#[command(
    after_help = "Recordings are CSV files with a column `time_s` [s] and a column a joint [rad], one file a demonstration.\n\
    Without any, the embedded synthetic demonstrator is learned.\n\n\
    Examples:\n  \
    undulate learn recordings/ -o model.json\n  \
    undulate learn a.csv b.csv c.csv --degrees --joints elbow,wrist -o model.json\n  \
    undulate learn --list set.txt --root recordings --harmonics 30 -o model.json\n  \
    undulate learn recordings/ --period cycle -o lively.json\n  \
    undulate learn slow/ fast/ --period cycle --kinds folders -o both.json"
)]
pub(super) struct Arguments {
    #[command(flatten)]
    pub recordings: Recordings,
    /// What a period is: one T common to all recordings (the paper), or one cycle of each recording's own tempo, whose
    /// amplitude and tempo vary from cycle to cycle as the demonstrations' do.
    #[arg(long, value_enum, default_value_t = Period::Common)]
    period: Period,
    /// The highest harmonic, K [default: 25 of a common period, 4 of a cycle].
    #[arg(long, short = 'k', value_name = "K")]
    pub harmonics: Option<usize>,
    /// With --period cycle: how many cycles a drawn wave has before it repeats.
    #[arg(long, value_name = "C", default_value_t = 10)]
    pub cycles: usize,
    /// With --period cycle: draw waves with what cycles leave too, how posture sways and joints differ from cycle to cycle on their own. Nearer to what people do, less smooth.
    #[arg(long)]
    pub residual: bool,
    /// Several kinds of wave at once: `auto` finds as many as left-out recordings ask for, a number so many; with `folders` every folder of recordings is a kind.
    #[arg(long, value_name = "auto|N|folders")]
    pub kinds: Option<KindsFrom>,
    #[command(flatten)]
    pub assumptions: Assumptions,
    /// The model file to write.
    #[arg(long, short, value_name = "FILE", default_value = "model.json")]
    pub output: PathBuf,
    /// Write the fitted wave of each demonstration into this folder, in the form `undulate sample` writes.
    #[arg(long, value_name = "FOLDER")]
    pub fits: Option<PathBuf>,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(super) enum Period {
    Common,
    Cycle,
}

/// K of a common period.
pub(super) const HARMONICS: usize = 25;

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    match arguments.period {
        Period::Common if arguments.residual => Err(Error::new(
            ErrorKind::Setting,
            "--residual of a common period, whose harmonics leave little",
        )
        .expected("--period cycle")),
        Period::Common => common(arguments, json),
        Period::Cycle => learn_cycle::run(arguments, json),
    }
}

fn common(arguments: &Arguments, json: bool) -> Result<Outcome> {
    let demonstrations = arguments.recordings.demonstrations()?;
    let harmonics = arguments.harmonics.unwrap_or(HARMONICS);
    let waves = demonstrations.fit(harmonics)?;
    let options = arguments.assumptions.options();
    let examples = options.examples(&waves)?;
    let form = options.form(&examples)?;
    for left_out in demonstrations.left_out() {
        output::warn(format!(
            "{} is left out: it {}",
            left_out.name, left_out.reason
        ));
    }
    if let Some(kinds) = arguments.kinds {
        warn_of_units(demonstrations.recordings());
        write_fits(arguments, waves.iter())?;
        let recordings = demonstrations.recordings().iter();
        let names: Vec<String> = recordings.map(|r| r.name().to_owned()).collect();
        let given = (examples.as_slice(), &form);
        return learn_kinds::run(arguments, kinds, &names, given, options.estimator, json);
    }
    let estimator = options.estimator.chosen(&examples, &form)?;
    let options = LearnOptions {
        estimator,
        ..options
    };
    let primitive = FourierMovementPrimitive::from_waves(&waves, &options)?;
    let leakage = demonstrations.leakage(&waves);
    let highest = harmonics as f64 / demonstrations.period();
    let tempo = demonstrations.highest_tempo();

    if highest < 2.0 * tempo {
        output::warn(format!(
            "{} harmonics reach {highest:.2} Hz, less than twice the fastest tempo, {tempo:.2} Hz: the overtones of fast waves are lost; --harmonics {} keeps the first",
            harmonics,
            (2.0 * tempo * demonstrations.period()).ceil()
        ));
    }
    let leaking = leakage
        .iter()
        .filter(|l| l.residual_energy > MUCH_LEAKAGE)
        .count();
    if leaking > 0 {
        output::warn(format!(
            "{leaking} recordings leave more than {:.0} % of their energy beyond {} harmonics; --remove-drift or --harmonics may help",
            100.0 * MUCH_LEAKAGE,
            harmonics
        ));
    }
    warn_of_units(demonstrations.recordings());
    warn_of_sameness(&primitive);
    write_fits(arguments, waves.iter())?;
    output::write(&arguments.output, primitive.to_json().as_bytes())?;

    let value = json!({
        "model": arguments.output,
        "demonstrations": leakage.iter().map(|l| json!({
            "name": l.name,
            "residual_energy": l.residual_energy,
            "end_jump_rad": l.end_jump,
            "end_jump_joint": l.end_jump_joint,
        })).collect::<Vec<_>>(),
        "left_out": demonstrations.left_out().iter().map(|l| json!({"name": l.name, "reason": l.reason})).collect::<Vec<_>>(),
        "joints": demonstrations.joints().iter().collect::<Vec<_>>(),
        "period_s": demonstrations.period(),
        "harmonics": harmonics,
        "highest_frequency_hz": highest,
        "fastest_tempo_hz": tempo,
        "rank": primitive.gaussian().rank(),
        "phases": options.phases.to_string(),
        "phase_reference": primitive.chart().reference(),
        "estimator": estimator.to_string(),
        "offsets": form.offsets.iter().map(ToString::to_string).collect::<Vec<_>>(),
    });
    output::report(json, &value, || {
        let worst = leakage
            .iter()
            .max_by(|a, b| a.end_jump.total_cmp(&b.end_jump));
        let leak = leakage
            .iter()
            .map(|l| l.residual_energy)
            .fold(0.0, f64::max);
        let mut text = format!(
            "learned {} demonstrations of {} joints: T = {:.3} s, K = {} ({highest:.2} Hz), fastest tempo {tempo:.2} Hz",
            leakage.len(),
            demonstrations.joints().len(),
            demonstrations.period(),
            harmonics,
        );
        if let Some(worst) = worst {
            text.push_str(&format!(
                "\nbeyond K: at most {:.1} % of a recording's energy; largest step from end to start {:.1} deg ({}, {})",
                100.0 * leak,
                worst.end_jump.to_degrees(),
                worst.end_jump_joint,
                worst.name
            ));
            if worst.end_jump > NOTABLE_JUMP {
                text.push_str(
                    "\n  T is no whole number of their cycles, so what is drawn is quicker than they were: --period cycle bears that, `undulate compare-periods` compares",
                );
            }
        }
        let reference = primitive.chart().reference();
        text.push_str(&format!(
            "\nphases {}{}, estimator {estimator}",
            options.phases,
            reference.map_or(String::new(), |joint| format!(" to {joint}")),
        ));
        text.push_str(&format!("\n\n{}", strongest(&waves)));
        if options.offsets != Offsets::Signed {
            text.push_str(&format!("\n\n{}", offset_table(&examples, &form.offsets)));
        }
        text.push_str(&format!("\n\nwrote {}", arguments.output.display()));
        text
    });
    Ok(Outcome::Done)
}

/// A joint that is wound up was recorded in other units.
pub(super) fn warn_of_units(recordings: &[Recording]) {
    let farthest = recordings
        .iter()
        .map(|r| r.positions().amax())
        .fold(0.0, f64::max);
    if farthest > UNLIKELY {
        output::warn(format!(
            "a joint is at {farthest:.1} rad, {:.1} turns: are the recordings in degrees? then add --degrees",
            farthest / std::f64::consts::TAU
        ));
    }
}

/// One demonstration given several times teaches no variation.
pub(super) fn warn_of_sameness(primitive: &FourierMovementPrimitive) {
    let angles = 2 * primitive.chart().joints().len() * primitive.chart().harmonics();
    let prior = primitive.gaussian().prior_covariance();
    let still = (0..angles).all(|i| prior.variance(i).sqrt() < IDENTICAL);
    if still {
        output::warn("the demonstrations are all the same: every draw will be the same wave");
    }
}

/// The fitted wave of each demonstration, where asked for.
pub(super) fn write_fits<'a>(
    arguments: &Arguments,
    waves: impl Iterator<Item = &'a Wave>,
) -> Result<()> {
    let Some(folder) = &arguments.fits else {
        return Ok(());
    };
    for (i, wave) in waves.enumerate() {
        let path = folder.join(format!("fit_{i:04}.json"));
        output::write(&path, wave.to_json().as_bytes())?;
    }
    Ok(())
}

/// For each joint where it waves about, and the harmonic to condition on: the one with most energy over all demonstrations.
fn strongest(waves: &[Wave]) -> String {
    let joints = waves[0].joints();
    let rows: Vec<Vec<String>> = joints
        .iter()
        .enumerate()
        .map(|(d, joint)| {
            let offsets: Vec<f64> = waves.iter().map(|w| w.offsets()[d]).collect();
            let energy = |k: &usize| {
                waves
                    .iter()
                    .map(|w| w.weights()[(d, k - 1)].norm_sqr())
                    .sum::<f64>()
            };
            let k = (1..=waves[0].harmonics())
                .max_by(|a, b| energy(a).total_cmp(&energy(b)))
                .unwrap_or(1);
            let moduli: Vec<f64> = waves
                .iter()
                .map(|w| w.weights()[(d, k - 1)].norm())
                .collect();
            let span = |values: &[f64]| {
                let low = values.iter().copied().fold(f64::INFINITY, f64::min);
                let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                format!("{} .. {}", output::degrees(low), output::degrees(high))
            };
            vec![
                joint.clone(),
                span(&offsets),
                format!("{k}, {:.2} Hz", k as f64 / waves[0].period()),
                span(&moduli),
            ]
        })
        .collect();
    output::table(
        &[
            "joint",
            "offset [deg]",
            "strongest harmonic",
            "its modulus [deg]",
        ],
        &rows,
    )
}

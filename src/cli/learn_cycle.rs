//! `undulate learn --period cycle`.

use serde_json::json;

use super::assumptions::offset_table;
use super::learn::{Arguments, warn_of_sameness, warn_of_units, write_fits};
use super::learn_kinds;
use super::{Outcome, output};
use crate::demonstration::{CycleFit, CycleFits};
use crate::error::{Error, ErrorKind, Result};
use crate::primitive::{
    Coordinate, Example, FourierMovementPrimitive, JitterOf, LearnOptions, Offsets,
};

/// K of a cycle.
pub(super) const HARMONICS: usize = 4;

/// A recording of which one steady rhythm explains less than this is worth a word.
const LITTLE_EXPLAINED: f64 = 0.7;

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    for (given, option) in [
        (arguments.recordings.has_duration(), "--duration"),
        (arguments.assumptions.is_paper(), "--paper"),
        (arguments.assumptions.aligns(), "--align"),
    ] {
        if given {
            return Err(Error::new(
                ErrorKind::Setting,
                format!("{option} with --period cycle, where each recording keeps its own length and start"),
            )
            .expected("one of the two"));
        }
    }
    let recordings = arguments.recordings.gestures()?;
    warn_of_units(&recordings);
    let fits = CycleFits::new(&recordings, arguments.harmonics.unwrap_or(HARMONICS))?;
    for left_out in fits.left_out() {
        output::warn(format!(
            "{} is left out: {}",
            left_out.name, left_out.reason
        ));
    }
    for fit in fits
        .fits()
        .iter()
        .filter(|f| f.explained_with_jitter < LITTLE_EXPLAINED)
    {
        output::warn(format!(
            "{}: a rhythm of {:.2} Hz with its jitter explains only {:.0} % of the motion",
            fit.name,
            fit.frequency(),
            100.0 * fit.explained_with_jitter
        ));
    }
    let options = LearnOptions {
        residual: arguments.residual,
        ..arguments.assumptions.options()
    };
    let examples: Vec<Example> = fits.fits().iter().map(Example::from).collect();
    let form = options.form_of_cycles(&fits, arguments.cycles)?;
    if let Some(kinds) = arguments.kinds {
        write_fits(arguments, fits.fits().iter().map(|fit| &fit.wave))?;
        let names: Vec<String> = fits.fits().iter().map(|fit| fit.name.clone()).collect();
        let given = (examples.as_slice(), &form);
        return learn_kinds::run(arguments, kinds, &names, given, options.estimator, json);
    }
    let estimator = options.estimator.chosen(&examples, &form)?;
    let options = LearnOptions {
        estimator,
        ..options
    };
    let primitive = FourierMovementPrimitive::from_cycles(&fits, arguments.cycles, &options)?;
    warn_of_sameness(&primitive);
    write_fits(arguments, fits.fits().iter().map(|fit| &fit.wave))?;
    output::write(&arguments.output, primitive.to_json().as_bytes())?;

    let value = json!({
        "model": arguments.output,
        "demonstrations": fits.fits().iter().map(|fit| json!({
            "name": fit.name,
            "frequency_hz": fit.frequency(),
            "cycles": fit.cycles,
            "explained": fit.explained,
            "explained_with_jitter": fit.explained_with_jitter,
            "amplitude_jitter": fit.amplitude_jitter,
            "tempo_jitter": fit.tempo_jitter,
        })).collect::<Vec<_>>(),
        "left_out": fits.left_out().iter().map(|l| json!({"name": l.name, "reason": l.reason})).collect::<Vec<_>>(),
        "joints": fits.joints().iter().collect::<Vec<_>>(),
        "period": "cycle",
        "cycles": arguments.cycles,
        "harmonics": primitive.chart().harmonics(),
        "amplitude_correlation": fits.amplitude().coefficient(),
        "tempo_correlation": fits.tempo().coefficient(),
        "residual": {"share": fits.residual().share(), "drawn": arguments.residual},
        "phases": options.phases.to_string(),
        "phase_reference": primitive.chart().reference(),
        "estimator": estimator.to_string(),
        "offsets": form.offsets.iter().map(ToString::to_string).collect::<Vec<_>>(),
    });
    let medians = medians(&primitive)?;
    output::report(json, &value, || {
        let mut text = format!(
            "learned {} demonstrations of {} joints, {} harmonics of each one's own cycle; a drawn wave has {} cycles\n\
             phases {}, estimator {estimator}; from one cycle to the next, amplitudes correlate by {:.2}, tempos by {:.2}\n\
             what cycles leave moves {:.0} % as much as they do, and is {}\n\n{}\n\n{medians}",
            fits.fits().len(),
            fits.joints().len(),
            primitive.chart().harmonics(),
            arguments.cycles,
            options.phases,
            fits.amplitude().coefficient(),
            fits.tempo().coefficient(),
            100.0 * fits.residual().share(),
            if arguments.residual {
                "drawn with them"
            } else {
                "not drawn (--residual does)"
            },
            fit_table(fits.fits()),
        );
        if options.offsets != Offsets::Signed {
            text.push_str(&format!("\n\n{}", offset_table(&examples, &form.offsets)));
        }
        text.push_str(&format!("\n\nwrote {}", arguments.output.display()));
        text
    });
    Ok(Outcome::Done)
}

fn fit_table(fits: &[CycleFit]) -> String {
    let percent = |x: f64| format!("{:.1} %", 100.0 * x);
    let rows: Vec<Vec<String>> = fits
        .iter()
        .map(|fit| {
            vec![
                fit.name.clone(),
                format!("{:.2} Hz", fit.frequency()),
                format!("{:.1}", fit.cycles),
                percent(fit.explained),
                percent(fit.explained_with_jitter),
                percent(fit.amplitude_jitter),
                percent(fit.tempo_jitter),
            ]
        })
        .collect();
    output::table(
        &[
            "recording",
            "frequency",
            "cycles",
            "explained",
            "with jitter",
            "of amplitude",
            "of tempo",
        ],
        &rows,
    )
}

/// What to condition on, and where it lies.
fn medians(primitive: &FourierMovementPrimitive) -> Result<String> {
    let mut coordinates = vec![Coordinate::Frequency];
    for joint in primitive.chart().joints() {
        let joint = joint.clone();
        coordinates.push(Coordinate::Swing { joint });
    }
    coordinates.push(Coordinate::Jitter(JitterOf::Amplitude));
    coordinates.push(Coordinate::Jitter(JitterOf::Tempo));
    let rows = coordinates
        .iter()
        .map(|coordinate| {
            let (scale, unit) = coordinate.unit().told();
            let median = primitive.median(coordinate)?;
            let spread = primitive.standard_deviation(coordinate)?.exp();
            let told = |x: f64| format!("{:.2} {unit}", scale * x);
            Ok(vec![
                coordinate.to_string(),
                told(median),
                format!("{} .. {}", told(median / spread), told(median * spread)),
            ])
        })
        .collect::<Result<Vec<_>>>()?;
    Ok(output::table(
        &["quantity", "median", "two thirds within"],
        &rows,
    ))
}

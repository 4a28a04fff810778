//! `undulate compare-periods`.

use clap::Args;
use rand::distr::Distribution;
use serde_json::{Value, json};

use super::assumptions::Assumptions;
use super::recordings::Recordings;
use super::{Outcome, output};
use crate::demonstration::{CycleFits, Demonstrations, Recording, Variation};
use crate::error::Result;
use crate::fourier::{Derivative, FourierBasis, PeriodGrid, Wave};
use crate::primitive::{FourierMovementPrimitive, stream};

/// Samples a cycle at which a drawn wave is looked at.
const SAMPLES: f64 = 48.0;

/// A band about the tempo within which a tone that wanders has its energy, as a share of the tempo.
const BAND: f64 = 0.3;

/// Compare the two models of a period on recordings: one period common to all, or one cycle with its jitter.
#[derive(Args)]
#[command(
    after_help = "Waves drawn from each model are measured as the demonstrations are, each for as many cycles as one of them lasted: how far the amplitude and the tempo\n\
    of the dominant joint vary from cycle to cycle, how near it comes to a stop, how large it is in the band about its tempo, and how firmly the joints\n\
    keep their phase to it. Medians are shown. The held-out fit is the share of energy of every other sample that a fit to the rest explains.\n\n\
    Example:\n  \
    undulate compare-periods recordings/ -n 200"
)]
pub(super) struct Arguments {
    #[command(flatten)]
    recordings: Recordings,
    /// The highest harmonic of the common period.
    #[arg(long, short = 'k', value_name = "K", default_value_t = 25)]
    harmonics: usize,
    /// The highest harmonic of a cycle.
    #[arg(long, value_name = "H", default_value_t = 4)]
    cycle_harmonics: usize,
    #[command(flatten)]
    assumptions: Assumptions,
    /// How many waves are drawn from each.
    #[arg(short = 'n', long, value_name = "N", default_value_t = 100)]
    count: u64,
}

/// What one column of the table holds: medians over demonstrations or drawn waves.
#[derive(Clone, Default)]
struct Column {
    name: &'static str,
    envelope: f64,
    low: f64,
    tempo: f64,
    band: f64,
    lock: f64,
    held_out: Option<f64>,
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    let recordings = arguments.recordings.gestures()?;
    let options = arguments.assumptions.options();
    let fits = CycleFits::new(&recordings, arguments.cycle_harmonics)?;
    for left_out in fits.left_out() {
        output::warn(format!(
            "{} is left out: {}",
            left_out.name, left_out.reason
        ));
    }
    let kept: Vec<&Recording> = recordings
        .iter()
        .filter(|r| fits.fits().iter().any(|fit| fit.name == r.name()))
        .collect();
    let lengths: Vec<f64> = fits.fits().iter().map(|fit| fit.cycles).collect();
    let count = lengths.iter().copied().fold(1.0, f64::max).ceil() as usize;
    let cycle = FourierMovementPrimitive::from_cycles(&fits, count, &options)?;
    let demonstrations = arguments.recordings.cut(&recordings)?;
    let common =
        FourierMovementPrimitive::learn_with(&demonstrations, arguments.harmonics, &options)?;
    let steady = FourierMovementPrimitive::from_cycles(&fits.steady(), count, &options)?;

    let bar = output::progress(3 * arguments.count, "drawing waves");
    let mut columns = vec![Column {
        held_out: None,
        ..of_recordings(&kept)?
    }];
    columns.push(Column {
        name: "common period",
        held_out: Some(held_out_common(&demonstrations, arguments.harmonics)?),
        ..drawn(&common, arguments.count, None, || bar.inc(1))?
    });
    let held_out = held_out_cycle(&kept, arguments.cycle_harmonics)?;
    columns.push(Column {
        name: "cycle, steady",
        held_out: Some(held_out),
        ..drawn(&steady, arguments.count, Some(&lengths), || bar.inc(1))?
    });
    columns.push(Column {
        name: "cycle",
        held_out: Some(held_out),
        ..drawn(&cycle, arguments.count, Some(&lengths), || bar.inc(1))?
    });
    bar.finish_and_clear();

    let value: Value = columns
        .iter()
        .map(|c| {
            json!({
                "model": c.name,
                "envelope_cv": c.envelope,
                "envelope_low": c.low,
                "tempo_cv": c.tempo,
                "band_amplitude_rad": c.band,
                "phase_lock": c.lock,
                "held_out_fit": c.held_out,
            })
        })
        .collect();
    output::report(json, &value, || {
        table(&columns, kept.len(), arguments.count)
    });
    Ok(Outcome::Done)
}

fn table(columns: &[Column], demonstrations: usize, count: u64) -> String {
    let percent = |x: f64| format!("{:.1} %", 100.0 * x);
    let row = |name: &str, cell: &dyn Fn(&Column) -> String| -> Vec<String> {
        std::iter::once(name.to_owned())
            .chain(columns.iter().map(cell))
            .collect()
    };
    let rows = [
        row("amplitude varies by", &|c| percent(c.envelope)),
        row("its 5 % quantile over its mean", &|c| {
            format!("{:.2}", c.low)
        }),
        row("tempo varies by", &|c| percent(c.tempo)),
        row("amplitude in the band of the tempo", &|c| {
            format!("{} deg", output::degrees(c.band))
        }),
        row("phase lock of the joints", &|c| format!("{:.3}", c.lock)),
        row("held-out fit", &|c| {
            c.held_out.map_or(String::new(), percent)
        }),
    ];
    let mut header = vec!["median"];
    header.extend(columns.iter().map(|c| c.name));
    format!(
        "{demonstrations} demonstrations, {count} waves of each model\n\n{}",
        output::table(&header, &rows)
    )
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    if n == 0 {
        f64::NAN
    } else {
        (values[n / 2] + values[(n - 1) / 2]) / 2.0
    }
}

/// Medians of what was measured.
fn column(name: &'static str, measured: &[(Variation, f64)]) -> Column {
    let of = |f: &dyn Fn(&(Variation, f64)) -> f64| median(measured.iter().map(f).collect());
    Column {
        name,
        envelope: of(&|m| m.0.envelope),
        low: of(&|m| m.0.envelope_low),
        tempo: of(&|m| m.0.tempo),
        band: of(&|m| m.1),
        lock: of(&|m| m.0.lock.iter().sum::<f64>() / m.0.lock.len() as f64),
        held_out: None,
    }
}

fn of_recordings(recordings: &[&Recording]) -> Result<Column> {
    let measured = recordings
        .iter()
        .map(|r| {
            let variation = Variation::of(r)?;
            let band = band(r, &variation)?;
            Ok((variation, band))
        })
        .collect::<Result<Vec<_>>>()?;
    Ok(column("demonstrations", &measured))
}

/// Waves number 0, 1, .. of the primitive, wave i seen for as long as demonstration i lasted, in cycles.
fn drawn(
    primitive: &FourierMovementPrimitive,
    count: u64,
    lengths: Option<&[f64]>,
    mut done: impl FnMut(),
) -> Result<Column> {
    let mut measured = Vec::new();
    for i in 0..count {
        let wave = primitive.sample(&mut stream(0, i));
        let share = match (lengths, primitive.chart().cycles()) {
            (Some(lengths), Some(cycles)) => {
                lengths[i as usize % lengths.len()] / cycles.count() as f64
            }
            _ => 1.0,
        };
        let seen = seen(&wave, share.min(1.0))?;
        // A wave without a rhythm that could be measured is none that could be compared.
        if let Ok(variation) = Variation::of(&seen) {
            let band = band(&seen, &variation)?;
            measured.push((variation, band));
        }
        done();
    }
    Ok(column("", &measured))
}

/// The first `share` of a period of a wave, as a recording.
fn seen(wave: &Wave, share: f64) -> Result<Recording> {
    let points = (4 * wave.harmonics()).max((SAMPLES * wave.harmonics() as f64 / 4.0) as usize);
    let grid = PeriodGrid::new(points, wave.harmonics());
    let positions = wave.on_grid(&grid, Derivative::Position);
    let kept = ((points as f64 * share).round() as usize).clamp(2, points);
    let mut times = grid.times(wave.period());
    times.truncate(kept);
    Recording::new(
        "wave",
        wave.joints().clone(),
        times,
        positions.rows(0, kept).into_owned(),
    )
}

/// 2 sqrt(sum |w|^2) of the dominant joint over the frequencies near its tempo.
fn band(recording: &Recording, variation: &Variation) -> Result<f64> {
    let flat = recording.without_drift();
    let start = flat.times()[0];
    let times: Vec<f64> = flat.times().iter().map(|t| t - start).collect();
    let period = flat.span() * (1.0 + 1.0 / (times.len() - 1) as f64);
    let last = ((1.0 + BAND) * variation.frequency * period).floor() as usize;
    let wave =
        FourierBasis::new(period, last.max(1))?.fit(flat.joints(), &times, flat.positions())?;
    let first = (((1.0 - BAND) * variation.frequency * period).ceil() as usize).max(1);
    let square: f64 = (first..=last.max(1))
        .map(|k| wave.weights()[(variation.dominant, k - 1)].norm_sqr())
        .sum();
    Ok(2.0 * square.sqrt())
}

/// Every other sample, and those between.
fn halves(recording: &Recording) -> Result<[Recording; 2]> {
    let half = |from: usize| {
        let picked: Vec<usize> = (from..recording.times().len()).step_by(2).collect();
        let times = picked.iter().map(|n| recording.times()[*n]).collect();
        let positions = recording.positions().select_rows(&picked);
        Recording::new(
            recording.name(),
            recording.joints().clone(),
            times,
            positions,
        )
    };
    Ok([half(0)?, half(1)?])
}

/// Share of the energy about the mean that `wave`, started at time `start`, explains.
fn explained(recording: &Recording, wave: &Wave, start: f64) -> f64 {
    let y = recording.positions();
    let mean = y.row_mean();
    let (mut left, mut energy) = (0.0, 0.0);
    for (n, t) in recording.times().iter().enumerate() {
        let position = wave.position(t - start);
        for d in 0..y.ncols() {
            left += (y[(n, d)] - position[d]).powi(2);
            energy += (y[(n, d)] - mean[d]).powi(2);
        }
    }
    1.0 - left / energy
}

fn held_out_common(demonstrations: &Demonstrations, harmonics: usize) -> Result<f64> {
    let mut shares = Vec::new();
    for recording in demonstrations.recordings() {
        let [fitted, rest] = halves(&recording.without_drift())?;
        let most = (fitted.times().len().saturating_sub(2) / 2)
            .min(harmonics)
            .max(1);
        let basis = FourierBasis::new(demonstrations.period(), most)?;
        // Gaps may leave the harmonics undetermined: then there is no fit to speak of.
        if let Ok(wave) = basis.fit(fitted.joints(), fitted.times(), fitted.positions()) {
            shares.push(explained(&rest, &wave, 0.0));
        }
    }
    Ok(median(shares))
}

fn held_out_cycle(recordings: &[&Recording], harmonics: usize) -> Result<f64> {
    let mut shares = Vec::new();
    for recording in recordings {
        let [fitted, rest] = halves(&recording.without_drift())?;
        if let Ok(fits) = CycleFits::new(std::slice::from_ref(&fitted), harmonics)
            && let Some(fit) = fits.fits().first()
        {
            shares.push(explained(&rest, &fit.wave, fitted.times()[0]));
        }
    }
    Ok(median(shares))
}

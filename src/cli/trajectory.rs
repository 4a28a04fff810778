//! `undulate trajectory`.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use nalgebra::DMatrix;
use rand::distr::Distribution;
use serde_json::json;

use super::wishes::Wishes;
use super::{Outcome, output, read_model};
use crate::error::{Error, ErrorKind, Result};
use crate::figure::{Picture, bands};
use crate::fourier::Derivative;
use crate::primitive::{FourierMovementPrimitive, StartSpread, TrajectoryMoments, stream};

/// No table is longer.
const MOST_POINTS: usize = 100_000;
/// No covariance has more rows: the file of these is above 100 MB.
const MOST_ROWS: usize = 2500;
/// Waves drawn behind the bands, those of seed 0: enough to see what one of them looks like beside the mean.
const DRAWS: u64 = 5;
/// Width and height of a panel of the figure \[px\].
const PANEL: (u32, u32) = (900, 280);

/// Mean, standard deviation and covariance of a model's trajectories, in closed form.
#[derive(Args)]
#[command(
    after_help = "Exact for what the model draws without bounds, and without drawing. The distribution is no Gaussian: its tails are those of \
    log-normal numbers, far heavier, and waves redrawn for a robot (`sample --robot`, `--within`) have other moments.\n\n\
    Examples:\n  \
    undulate trajectory model.json -o moments.csv --figure moments.svg\n  \
    undulate trajectory model.json --given modulus:elbow_flexion:10=5deg --derivative velocity --figure large.png\n  \
    undulate trajectory model.json --start-spread 0.1s --points 100 --covariance covariance.csv"
)]
pub(super) struct Arguments {
    /// The model file, of a common period.
    model: PathBuf,
    #[command(flatten)]
    wishes: Wishes,
    /// How far the start of a wave varies besides, independently of all else: `none`, `uniform` over the period, or with a standard deviation, such as 0.1s.
    #[arg(long, value_name = "none|uniform|SECONDSs", default_value_t)]
    start_spread: StartSpread,
    /// Of what.
    #[arg(long, value_enum, default_value_t = Of::Position)]
    derivative: Of,
    /// How many instants, over one period.
    #[arg(long, value_name = "N", default_value_t = 200)]
    points: usize,
    /// Write a table: `time_s`, then JOINT_mean and JOINT_sd of each joint [rad, rad/s ..].
    #[arg(long, short, value_name = "FILE.csv")]
    output: Option<PathBuf>,
    /// Write the covariance of the whole trajectory [rad^2 ..]: joint by joint and N instants in each, a column JOINT@TIMEs each, and the rows in the same order.
    #[arg(long, value_name = "FILE.csv")]
    covariance: Option<PathBuf>,
    /// Draw mean and standard deviation over time, a panel a joint, and a few drawn waves behind them, the first of seed 0.
    #[arg(long, value_name = "FILE.svg|FILE.png")]
    figure: Option<PathBuf>,
}

/// A derivative of the position.
#[derive(Clone, Copy, ValueEnum)]
enum Of {
    Position,
    Velocity,
    Acceleration,
    Jerk,
}

impl Of {
    /// The derivative, its name, and what its unit has behind that of the position.
    fn told(self) -> (Derivative, &'static str, &'static str) {
        match self {
            Self::Position => (Derivative::Position, "position", ""),
            Self::Velocity => (Derivative::Velocity, "velocity", "/s"),
            Self::Acceleration => (Derivative::Acceleration, "acceleration", "/s^2"),
            Self::Jerk => (Derivative::Jerk, "jerk", "/s^3"),
        }
    }
}

pub(super) fn run(arguments: &Arguments, json: bool) -> Result<Outcome> {
    let points = arguments.points;
    if !(1..=MOST_POINTS).contains(&points) {
        return Err(Error::new(ErrorKind::Setting, format!("--points {points}"))
            .expected(format!("from 1 to {MOST_POINTS}")));
    }
    let form = arguments.figure.as_deref().map(Form::of).transpose()?;
    let primitive = read_model(&arguments.model)?;
    let primitive = primitive.condition(&arguments.wishes.observations(&primitive)?)?;
    let spread = arguments.start_spread;
    let moments = primitive
        .moments(spread)
        .map_err(|e| e.at(arguments.model.display().to_string()))?;
    let (derivative, quantity, per) = arguments.derivative.told();
    let (mean, deviation) = moments.on_grid(points, derivative);

    // All is computed before anything is written.
    let mut files: Vec<(&Path, Vec<u8>)> = Vec::new();
    if let Some(path) = &arguments.output {
        files.push((path, table(&moments, &mean, &deviation)?));
    }
    if let Some(path) = &arguments.covariance {
        files.push((path, covariance(&moments, points, derivative)?));
    }
    if let (Some(path), Some(form)) = (&arguments.figure, form) {
        let bytes = figure(&primitive, &moments, spread, derivative, form)?;
        files.push((path, bytes));
    }
    for (path, bytes) in &files {
        output::write(path, bytes)?;
    }

    let joints: Vec<Summary> = (0..moments.joints().len())
        .map(|d| Summary::of(&moments, &mean, &deviation, d))
        .collect();
    let value = json!({
        "quantity": quantity,
        "unit": format!("rad{per}"),
        "period_s": moments.period(),
        "points": points,
        "start_spread": spread.to_string(),
        "joints": joints.iter().map(|j| json!({
            "joint": j.joint,
            "mean": j.mean,
            "mean_sd": j.mean_sd,
            "largest_sd": j.largest_sd,
            "largest_sd_at_s": j.at,
        })).collect::<Vec<_>>(),
        "table": arguments.output,
        "covariance": arguments.covariance,
        "figure": arguments.figure,
    });
    output::report(json, &value, || {
        let rows: Vec<Vec<String>> = joints.iter().map(Summary::row).collect();
        let unit = format!("{quantity} [deg{per}]");
        let header = [unit.as_str(), "mean", "mean sd", "largest sd", "at"];
        let mut text = format!(
            "{}\nover one period of {:.3} s",
            output::table(&header, &rows),
            moments.period()
        );
        for (path, _) in &files {
            text.push_str(&format!("\nwrote {}", path.display()));
        }
        text
    });
    Ok(Outcome::Done)
}

/// What a joint does over a period \[rad, rad/s ..; s\].
struct Summary<'a> {
    joint: &'a str,
    mean: f64,
    mean_sd: f64,
    largest_sd: f64,
    at: f64,
}

impl<'a> Summary<'a> {
    fn of(
        moments: &'a TrajectoryMoments,
        mean: &DMatrix<f64>,
        deviation: &DMatrix<f64>,
        d: usize,
    ) -> Self {
        let deviations = deviation.column(d);
        let largest_sd = deviations.max();
        // The first, where rounding alone tells equals apart.
        let equal = |sd: &f64| *sd >= largest_sd * (1.0 - 1e-9);
        let n = deviations.iter().position(equal).unwrap_or(0);
        Self {
            joint: moments.joints().name(d),
            mean: mean.column(d).mean(),
            mean_sd: deviations.mean(),
            largest_sd,
            at: time(moments, n, deviations.len()),
        }
    }

    fn row(&self) -> Vec<String> {
        vec![
            self.joint.to_owned(),
            output::degrees(self.mean),
            output::degrees(self.mean_sd),
            output::degrees(self.largest_sd),
            format!("{:.2} s", self.at),
        ]
    }
}

/// n T / N \[s\].
fn time(moments: &TrajectoryMoments, n: usize, points: usize) -> f64 {
    moments.period() * n as f64 / points as f64
}

fn table(
    moments: &TrajectoryMoments,
    mean: &DMatrix<f64>,
    deviation: &DMatrix<f64>,
) -> Result<Vec<u8>> {
    let columns = moments
        .joints()
        .iter()
        .flat_map(|joint| [format!("{joint}_mean"), format!("{joint}_sd")]);
    let rows = (0..mean.nrows()).map(|n| {
        let t = time(moments, n, mean.nrows());
        let numbers = (0..mean.ncols()).flat_map(move |d| [mean[(n, d)], deviation[(n, d)]]);
        std::iter::once(t).chain(numbers)
    });
    output::csv(std::iter::once("time_s".to_owned()).chain(columns), rows)
}

fn covariance(
    moments: &TrajectoryMoments,
    points: usize,
    derivative: Derivative,
) -> Result<Vec<u8>> {
    let joints = moments.joints();
    let size = points * joints.len();
    if size > MOST_ROWS {
        return Err(Error::new(
            ErrorKind::Setting,
            format!(
                "a covariance of {size} rows, {points} instants of {} joints",
                joints.len()
            ),
        )
        .expected(format!("at most {MOST_ROWS}"))
        .help(format!(
            "--points {} or fewer, or without --covariance",
            MOST_ROWS / joints.len()
        )));
    }
    let covariance = moments.covariance_on_grid(points, derivative);
    let header = joints.iter().flat_map(|joint| {
        (0..points).map(move |n| format!("{joint}@{}s", time(moments, n, points)))
    });
    // It is symmetric: columns are rows.
    let rows = covariance.as_slice().chunks_exact(size);
    output::csv(header, rows.map(|row| row.iter().copied()))
}

/// How a figure is written.
#[derive(Clone, Copy)]
pub(super) enum Form {
    Svg,
    Png,
}

impl Form {
    pub fn of(path: &Path) -> Result<Self> {
        match path.extension().and_then(|e| e.to_str()) {
            Some("svg") => Ok(Self::Svg),
            Some("png") => Ok(Self::Png),
            _ => Err(
                Error::new(ErrorKind::Setting, format!("a figure {}", path.display()))
                    .expected("a name that ends in .svg or .png"),
            ),
        }
    }

    pub fn bytes(self, picture: Picture) -> Vec<u8> {
        match self {
            Self::Svg => picture.svg.into_bytes(),
            Self::Png => picture.png,
        }
    }
}

fn figure(
    primitive: &FourierMovementPrimitive,
    moments: &TrajectoryMoments,
    spread: StartSpread,
    derivative: Derivative,
    form: Form,
) -> Result<Vec<u8>> {
    let draws: Vec<_> = (0..DRAWS)
        .map(|k| {
            let mut rng = stream(0, k);
            let wave = primitive.sample(&mut rng);
            spread.apply(&wave, &mut rng)
        })
        .collect();
    let joints: Vec<(&str, &str)> = moments
        .joints()
        .iter()
        .map(|joint| (joint.as_str(), joint.as_str()))
        .collect();
    // About twice as many rows as columns: the figure is then about as wide as high.
    let columns = (joints.len() as f64 / 2.0).sqrt().ceil() as usize;
    let rows = joints.len().div_ceil(columns);
    let size = (PANEL.0 * columns as u32, PANEL.1 * rows as u32);
    let picture = bands(moments, &draws, derivative, &joints, columns, size)?;
    Ok(form.bytes(picture))
}

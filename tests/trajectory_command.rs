//! `undulate trajectory`: the library's closed form, in files.

use std::path::Path;

use nalgebra::DMatrix;
use undulate::{Derivative, FourierMovementPrimitive, StartSpread, TrajectoryMoments};

#[path = "common/program.rs"]
mod program;

use program::{done, fails, files, json};

const GIVEN: &str = "modulus:elbow_flexion:10=5deg";

/// What the library says of a model file given [`GIVEN`].
fn stated(model: &Path, start: StartSpread) -> TrajectoryMoments {
    let text = std::fs::read_to_string(model).unwrap();
    let primitive = FourierMovementPrimitive::from_json(&text).unwrap();
    let given = primitive.condition(&[GIVEN.parse().unwrap()]).unwrap();
    given.moments(start).unwrap()
}

/// Header and numbers of a CSV file.
fn read(path: &Path) -> (Vec<String>, DMatrix<f64>) {
    let mut reader = csv::Reader::from_path(path).unwrap();
    let header = reader.headers().unwrap();
    let header: Vec<String> = header.iter().map(str::to_owned).collect();
    let rows: Vec<Vec<f64>> = reader.deserialize().map(Result::unwrap).collect();
    let numbers = DMatrix::from_fn(rows.len(), header.len(), |i, j| rows[i][j]);
    (header, numbers)
}

#[test]
fn tables_and_words_are_the_librarys_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    done(at, &["learn", "-o", "model.json"]);
    for (quantity, derivative, spread, start) in [
        ("position", Derivative::Position, "none", StartSpread::None),
        (
            "velocity",
            Derivative::Velocity,
            "0.1s",
            StartSpread::Normal(0.1),
        ),
        ("jerk", Derivative::Jerk, "uniform", StartSpread::Uniform),
    ] {
        let moments = stated(&at.join("model.json"), start);
        let arguments = format!(
            "trajectory model.json --given {GIVEN} --derivative {quantity} --start-spread {spread} --points 40 -o table.csv"
        );
        let arguments: Vec<&str> = arguments.split_whitespace().collect();
        let report = json(at, &arguments);
        let (header, numbers) = read(&at.join("table.csv"));
        let (mean, deviation) = moments.on_grid(40, derivative);
        assert_eq!(numbers.shape(), (40, 1 + 2 * moments.joints().len()));
        assert_eq!(header[0], "time_s");
        for n in 0..40 {
            assert_eq!(numbers[(n, 0)], moments.period() * n as f64 / 40.0);
        }
        assert_eq!(report["quantity"], quantity);
        assert_eq!(report["start_spread"], spread);
        for (d, joint) in moments.joints().iter().enumerate() {
            assert_eq!(header[1 + 2 * d], format!("{joint}_mean"));
            assert_eq!(header[2 + 2 * d], format!("{joint}_sd"));
            assert_eq!(numbers.column(1 + 2 * d), mean.column(d));
            assert_eq!(numbers.column(2 + 2 * d), deviation.column(d));
            let told = &report["joints"][d];
            let number = |key: &str| told[key].as_f64().unwrap();
            assert_eq!(told["joint"], joint.as_str());
            assert_eq!(number("mean"), mean.column(d).mean());
            assert_eq!(number("mean_sd"), deviation.column(d).mean());
            assert_eq!(number("largest_sd"), deviation.column(d).max());
            let there = moments.standard_deviation(number("largest_sd_at_s"), derivative)[d];
            assert!((there / number("largest_sd") - 1.0).abs() < 1e-8, "{told}");
        }
    }
    let words = done(at, &["trajectory", "model.json", "--derivative", "jerk"]);
    for word in ["jerk [deg/s^3]", "largest sd", "elbow_flexion", "6.667 s"] {
        assert!(words.contains(word), "{word} is not in {words}");
    }
    assert!(!words.contains("-0.0"), "{words}");
}

#[test]
fn covariance_and_figures_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    done(at, &["learn", "-o", "model.json"]);
    let arguments = format!(
        "trajectory model.json --given {GIVEN} --points 10 --covariance covariance.csv --figure moments.svg"
    );
    let arguments: Vec<&str> = arguments.split_whitespace().collect();
    done(at, &arguments);
    let moments = stated(&at.join("model.json"), StartSpread::None);
    let (header, numbers) = read(&at.join("covariance.csv"));
    assert_eq!(
        numbers,
        moments.covariance_on_grid(10, Derivative::Position)
    );
    let second = moments.joints().name(1);
    assert_eq!(header[10], format!("{second}@0s"));
    assert_eq!(
        header[13],
        format!("{second}@{}s", moments.period() * 3.0 / 10.0)
    );

    let svg = std::fs::read_to_string(at.join("moments.svg")).unwrap();
    for word in moments.joints().iter().map(String::as_str).chain([
        "mean",
        "±1 sd",
        "time (s)",
        "angle (°)",
    ]) {
        assert!(svg.contains(&format!(">\n{word}\n</text>")), "{word}");
    }
    done(at, &["trajectory", "model.json", "--figure", "moments.png"]);
    let png = std::fs::read(at.join("moments.png")).unwrap();
    assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
}

#[test]
fn what_cannot_be_had_is_named_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    done(at, &["learn", "-o", "model.json"]);
    done(at, &["learn", "--period", "cycle", "-o", "lively.json"]);
    let before = files(at);
    for (code, arguments, words) in [
        (
            1,
            "trajectory lively.json -o x.csv",
            "lively.json: moments in closed form of waves that each have their own frequency, expected a model learned with --period common",
        ),
        (
            1,
            "trajectory model.json --given offset:knee=3deg -o x.csv",
            "no joint `knee`",
        ),
        (
            2,
            "trajectory model.json --start-spread 0.1 -o x.csv",
            "start spread `0.1`, expected none, uniform, or a standard deviation such as 0.1s",
        ),
        (
            2,
            "trajectory model.json --points 0 -o x.csv",
            "--points 0, expected from 1 to 100000",
        ),
        (
            2,
            "trajectory model.json --derivative snap -o x.csv",
            "possible values: position, velocity, acceleration, jerk",
        ),
        (
            2,
            "trajectory model.json --points 100000 -o x.csv --covariance y.csv",
            "expected at most 2500; --points",
        ),
        (
            2,
            "trajectory model.json -o x.csv --figure x.pdf",
            "a figure x.pdf, expected a name that ends in .svg or .png",
        ),
    ] {
        let arguments: Vec<&str> = arguments.split_whitespace().collect();
        let error = fails(at, code, &arguments);
        assert!(error.contains(words), "{arguments:?}: {error}");
    }
    assert_eq!(files(at), before);
}

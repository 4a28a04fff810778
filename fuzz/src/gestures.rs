//! Inputs of the learning half: recordings, models, waves, conditions.

use std::fmt::{Debug, Display};
use std::str::FromStr;

use undulate::rand::distr::Distribution;
use undulate::{
    Bound, Coordinate, CsvOptions, Derivative, Estimator, FourierMovementPrimitive, Harmonic,
    Observation, PhaseForm, Recording, Start, StartSpread, Target, Wave, stream,
};

use super::text;

/// A model of more coordinates is read and not drawn from: a draw of all would be slow.
const DRAWN: usize = 400;

pub fn recording(data: &[u8]) {
    for degrees in [false, true] {
        let options = CsvOptions {
            degrees,
            joints: None,
        };
        if let Ok(recording) = Recording::from_csv("fuzzed.csv", data, &options) {
            let times = recording.times();
            assert!(times.windows(2).all(|pair| pair[0] < pair[1]));
            assert!(recording.positions().iter().all(|q| q.is_finite()));
        }
    }
}

pub fn model(data: &[u8]) {
    let Some(Ok(model)) = text(data).map(FourierMovementPrimitive::from_json) else {
        return;
    };
    let printed = model.to_json();
    let again = FourierMovementPrimitive::from_json(&printed).expect("a model that was printed");
    assert_eq!(again.to_json(), printed);
    if model.chart().dimension() <= DRAWN {
        let _ = model.mean_wave();
        let drawn: Wave = model.sample(&mut stream(1, 0));
        let same: Wave = again.sample(&mut stream(1, 0));
        assert_eq!(drawn.to_json(), same.to_json());
    }
}

pub fn wave(data: &[u8]) {
    let Some(Ok(wave)) = text(data).map(Wave::from_json) else {
        return;
    };
    let again = Wave::from_json(&wave.to_json()).expect("a wave that was printed");
    assert_eq!(again, wave);
    if wave.joints().len() * wave.harmonics() > DRAWN {
        return;
    }
    let state = wave.state(wave.period() / 3.0);
    for joint in 0..wave.joints().len() {
        let range = wave.range(joint, Derivative::Position);
        // Sums beyond the range of numbers are none.
        if state.position[joint].is_finite() && (range.lower + range.upper).is_finite() {
            assert!(range.contains(state.position[joint]), "{range:?}");
        }
    }
}

pub fn condition(data: &[u8]) {
    for line in text(data).unwrap_or("").lines() {
        printed::<Observation>(line);
        printed::<Target>(line);
        printed::<Coordinate>(line);
        printed::<Harmonic>(line);
        printed::<Estimator>(line);
        printed::<StartSpread>(line);
        printed::<PhaseForm>(line);
        let _ = line.parse::<Bound>();
        let _ = line.parse::<Start>();
    }
}

/// What can be read can be printed, and read again as it was.
fn printed<T: FromStr<Err: Debug> + Display>(line: &str) {
    if let Ok(read) = line.parse::<T>() {
        let text = read.to_string();
        let again: T = text
            .parse()
            .unwrap_or_else(|e| panic!("`{line}` prints as `{text}`: {e:?}"));
        assert_eq!(again.to_string(), text, "of `{line}`");
    }
}

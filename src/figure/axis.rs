//! Ranges and ticks of an axis.

use crate::error::{Error, ErrorKind, Result};

/// One axis of a plot: what it spans and where it has labels, in units of the data.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Axis {
    /// Lower end.
    pub(crate) low: f64,
    /// Upper end, above `low`.
    pub(crate) high: f64,
    /// Ascending places of the grid lines within the ends, each with its label.
    pub(crate) ticks: Vec<(f64, String)>,
}

impl Axis {
    /// The axis over `range`, or else over all `values` and a margin of `padding` times their
    /// spread at both ends, with about `count` ticks.
    pub(crate) fn new(
        range: Option<(f64, f64)>,
        values: impl Iterator<Item = f64>,
        padding: f64,
        count: usize,
    ) -> Result<Self> {
        let (low, high) = match range {
            Some((low, high)) if low < high && low.is_finite() && high.is_finite() => (low, high),
            Some((low, high)) => {
                return Err(Error::new(
                    ErrorKind::Value,
                    format!("the axis range {low}..{high}"),
                ));
            }
            None => spread(values, padding),
        };
        if !(high - low).is_finite() {
            return Err(Error::new(
                ErrorKind::Value,
                format!("the axis range {low}..{high}"),
            ));
        }
        Ok(Self {
            low,
            high,
            ticks: ticks(low, high, count.max(4)),
        })
    }

    /// The axis of places 0, 1, .. with names.
    pub(crate) fn of_names(names: &[String]) -> Self {
        Self {
            low: -0.5,
            high: names.len() as f64 - 0.5,
            ticks: names
                .iter()
                .enumerate()
                .map(|(i, name)| (i as f64, name.clone()))
                .collect(),
        }
    }

    /// Where `value` lies from the lower end (0) to the upper (1).
    pub(crate) fn fraction(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }
}

/// Ends that hold all of `values`, even if there are none or all are the same.
fn spread(values: impl Iterator<Item = f64>, padding: f64) -> (f64, f64) {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    if low > high {
        return (0.0, 1.0);
    }
    // Below this spread the rounding of the numbers would show as a staircase.
    if high - low <= 1e-9 * low.abs().max(high.abs()) {
        let margin = if low == 0.0 { 1.0 } else { 0.5 * low.abs() };
        return (low - margin, high + margin);
    }
    let margin = padding * (high - low);
    (low - margin, high + margin)
}

/// Multiples of 1, 2 or 5 times a power of ten, as close to `count` of them as these allow.
fn ticks(low: f64, high: f64, count: usize) -> Vec<(f64, String)> {
    let rough = (high - low) / count as f64;
    let power = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .map(|factor| factor * power)
        .into_iter()
        .min_by(|a, b| (a / rough).ln().abs().total_cmp(&(b / rough).ln().abs()))
        .unwrap_or(power);
    // A tick on the very end must not be lost to rounding.
    let slack = 1e-6;
    let first = (low / step - slack).ceil();
    let last = (high / step + slack).floor();
    if !(step > 0.0 && last - first < 1e3) {
        return Vec::new();
    }
    (0..=(last - first) as usize)
        .map(|index| {
            let multiple = first + index as f64;
            (multiple * step, label(multiple * step, step))
        })
        .collect()
}

/// `value` with just the decimals that a multiple of `step` needs.
fn label(value: f64, step: f64) -> String {
    let exponent = (step.log10() + 1e-9).floor();
    let text = if !(-5.0..6.0).contains(&exponent) {
        let digits = ((value.abs() / step).max(1.0).log10() + 1e-9).floor() as usize;
        format!("{value:.digits$e}")
    } else {
        let decimals = (-exponent).max(0.0) as usize;
        format!("{value:.decimals$}")
    };
    let zero = text.bytes().all(|byte| !(b'1'..=b'9').contains(&byte));
    // The typographic minus is as wide as the digits; no "-0".
    if zero {
        "0".into()
    } else {
        text.replace('-', "\u{2212}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(low: f64, high: f64, count: usize) -> Vec<String> {
        ticks(low, high, count)
            .into_iter()
            .map(|(_, label)| label)
            .collect()
    }

    #[test]
    fn labels_are_round() {
        assert_eq!(labels(0.0, 6.67, 6), ["0", "1", "2", "3", "4", "5", "6"]);
        assert_eq!(
            labels(-1.0, 1.0, 4),
            ["\u{2212}1.0", "\u{2212}0.5", "0", "0.5", "1.0"]
        );
        assert_eq!(labels(0.0, 0.3, 3), ["0", "0.1", "0.2", "0.3"]);
        assert_eq!(labels(0.0, 2e9, 2), ["0", "1e9", "2e9"]);
    }

    #[test]
    fn ranges_survive_constant_and_empty_data() {
        let empty = Axis::new(None, std::iter::empty(), 0.05, 5).unwrap();
        assert_eq!((empty.low, empty.high), (0.0, 1.0));
        for value in [0.0, 3.0, -1e-300, 1e200] {
            let axis = Axis::new(None, [value; 3].into_iter(), 0.05, 5).unwrap();
            assert!(axis.low < value && value < axis.high, "{axis:?}");
            assert!(axis.ticks.len() >= 2, "{axis:?}");
        }
    }

    #[test]
    fn impossible_ranges_are_errors() {
        for range in [
            (1.0, 1.0),
            (2.0, 1.0),
            (f64::NAN, 1.0),
            (f64::MIN, f64::MAX),
        ] {
            assert!(Axis::new(Some(range), std::iter::empty(), 0.0, 5).is_err());
        }
    }
}

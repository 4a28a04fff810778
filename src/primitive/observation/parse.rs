//! Observations as text.

use std::str::FromStr;

use super::{Coordinate, Harmonic, JitterOf, Observation, Quantity, Unit};
use crate::error::{Error, ErrorKind, Result};
use crate::units::parse_angle_with_unit;

const GRAMMAR: &str = "`modulus:JOINT:K=VALUE`, `phase:JOINT:K=VALUE`, `phase:JOINT/JOINT:K=VALUE`, `ratio:JOINT:K/JOINT:K=NUMBER`, `offset:JOINT=VALUE` or \
    `sum:C*COORDINATE+C*COORDINATE=NUMBER`, of cycles `frequency=2.5Hz`, `swing:JOINT=VALUE`, `jitter:amplitude=5%` or `jitter:tempo=5%`, with K a number or a frequency like 1.5Hz, VALUE like 5deg or 0.1rad, and `+-VALUE` after it for a standard deviation";

fn malformed(what: impl Into<String>) -> Error {
    Error::new(ErrorKind::Syntax, what).expected(GRAMMAR)
}

impl FromStr for Observation {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        parse(text).map_err(|e| e.at(format!("condition `{text}`")))
    }
}

fn parse(text: &str) -> Result<Observation> {
    let (left, right) = text.rsplit_once('=').ok_or_else(|| malformed("no `=`"))?;
    let quantity = match left.trim().strip_prefix("sum:") {
        Some(terms) => Quantity::Sum(sum(terms)?),
        None => Quantity::One(left.parse()?),
    };
    let unit = match &quantity {
        Quantity::One(coordinate) => coordinate.unit(),
        Quantity::Sum(_) => Unit::Number,
    };
    let number = |text: &str| match unit {
        Unit::Angle => parse_angle_with_unit(text),
        Unit::Number => plain(text),
        Unit::Hertz => suffixed(text, "Hz"),
        Unit::Share => suffixed(text, "%").map(|share| share / 100.0),
    };
    let (value, deviation) = match right.split_once("+-") {
        None => (number(right)?, 0.0),
        Some((value, deviation)) => {
            let value = number(value)?;
            let deviation = match deviation.trim().strip_suffix('%') {
                Some(share) => plain(share)? / 100.0 * value.abs(),
                None => number(deviation)?,
            };
            if deviation <= 0.0 {
                return Err(malformed("a standard deviation that is not positive"));
            }
            (value, deviation)
        }
    };
    Ok(Observation {
        quantity,
        value,
        deviation,
    })
}

fn plain(text: &str) -> Result<f64> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(malformed(format!("number `{}`", text.trim()))),
    }
}

fn suffixed(text: &str, unit: &str) -> Result<f64> {
    let number = text.trim().strip_suffix(unit);
    plain(number.ok_or_else(|| malformed(format!("`{}` without its unit, {unit}", text.trim())))?)
}

/// `2*modulus:elbow:10-1*modulus:wrist:10`: every term begins with its coefficient.
fn sum(text: &str) -> Result<Vec<(f64, Coordinate)>> {
    let mut terms = Vec::new();
    let mut rest = text;
    while !rest.trim().is_empty() {
        let (factor, after) = rest
            .split_once('*')
            .ok_or_else(|| malformed(format!("term `{}` without a coefficient", rest.trim())))?;
        let factor = factor.replace(' ', "");
        let factor = plain(factor.strip_prefix('+').unwrap_or(&factor))?;
        // The coordinate ends where the sign of the next coefficient stands.
        let end = after.match_indices(['+', '-']).map(|(i, _)| i).find(|i| {
            let next = after[i + 1..].trim_start();
            let digits = next.split('*').next().unwrap_or("");
            next.contains('*') && digits.trim().parse::<f64>().is_ok()
        });
        let (coordinate, next) = after.split_at(end.unwrap_or(after.len()));
        terms.push((factor, coordinate.parse()?));
        rest = next;
    }
    if terms.is_empty() {
        return Err(malformed("a sum without terms"));
    }
    Ok(terms)
}

impl FromStr for Harmonic {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let text = text.trim();
        if let Some(hertz) = text.strip_suffix("Hz") {
            return Ok(Self::Hertz(plain(hertz)?));
        }
        text.parse()
            .map(Self::Number)
            .map_err(|_| malformed(format!("harmonic `{text}`")))
    }
}

impl FromStr for Coordinate {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        if text.trim() == "frequency" {
            return Ok(Self::Frequency);
        }
        let (quantity, rest) = text
            .split_once(':')
            .ok_or_else(|| malformed("no `:` after the quantity"))?;
        let quantity = quantity.trim();
        let addressed = |text: &str| {
            let (joint, k) = text
                .rsplit_once(':')
                .ok_or_else(|| malformed(format!("`{quantity}` without a harmonic")))?;
            Ok((joint.trim().to_owned(), k.parse::<Harmonic>()?))
        };
        match quantity {
            "modulus" => addressed(rest).map(|(joint, k)| Self::modulus(joint, k)),
            "phase" => {
                let (joint, k) = addressed(rest)?;
                Ok(match joint.split_once('/') {
                    Some((joint, to)) => Self::relative_phase(joint.trim(), to.trim(), k),
                    None => Self::phase(joint, k),
                })
            }
            "ratio" => {
                let (one, other) = rest
                    .split_once('/')
                    .ok_or_else(|| malformed("`ratio` without a `/`"))?;
                let (joint, harmonic) = addressed(one)?;
                let (to, to_harmonic) = addressed(other)?;
                Ok(Self::Ratio {
                    joint,
                    harmonic,
                    to,
                    to_harmonic,
                })
            }
            "offset" => Ok(Self::Offset {
                joint: rest.trim().to_owned(),
            }),
            "swing" => Ok(Self::Swing {
                joint: rest.trim().to_owned(),
            }),
            "jitter" => match rest.trim() {
                "amplitude" => Ok(Self::Jitter(JitterOf::Amplitude)),
                "tempo" => Ok(Self::Jitter(JitterOf::Tempo)),
                other => Err(malformed(format!("jitter of `{other}`"))),
            },
            "shape" => addressed(rest).map(|(joint, harmonic)| Self::Shape { joint, harmonic }),
            "lock" => {
                addressed(rest).map(|(joint, harmonic)| Self::LockedPhase { joint, harmonic })
            }
            other => Err(malformed(format!("quantity `{other}`"))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn text_is_read_and_written() {
        for text in [
            "modulus:a:b:10=0.25rad",
            "modulus:a:1.5Hz=0.25rad",
            "phase:elbow:3=-1rad",
            "phase:wrist/elbow:3=-1rad",
            "offset:wrist=0.5rad",
        ] {
            let observation: Observation = text.parse().unwrap();
            let written = format!("{}={}rad", observation.quantity, observation.value);
            assert_eq!(written, text);
        }
        for text in [
            "ratio:wrist:20/elbow:10=0.9",
            "shape:wrist:2=0.25",
            "sum:1*modulus:a-b:10-2*modulus:wrist:1.5Hz+0.5*offset:a=-0.3",
        ] {
            let observation: Observation = text.parse().unwrap();
            let written = format!("{}={}", observation.quantity, observation.value);
            assert_eq!(written, text);
        }
        for (text, value) in [
            ("frequency=2.5Hz", 2.5),
            ("swing:wrist=180deg", PI),
            ("jitter:tempo=5%", 0.05),
            ("jitter:amplitude = 5 %", 0.05),
            ("lock:wrist:2=180deg", PI),
        ] {
            let observation: Observation = text.parse().unwrap();
            assert_eq!(observation.value, value, "{text}");
            let name = observation.quantity.to_string();
            assert_eq!(Some(name.as_str()), text.split('=').next().map(str::trim));
        }
        let degrees: Observation = "phase:elbow:3 = 180 deg +- 90deg".parse().unwrap();
        assert_eq!((degrees.value, degrees.deviation), (PI, PI / 2.0));
        let share: Observation = "modulus:elbow:3=2rad+-10%".parse().unwrap();
        assert!((share.deviation - 0.2).abs() < 1e-15);
    }

    #[test]
    fn malformed_text_is_refused_with_the_grammar() {
        for text in [
            "",
            "modulus:elbow:10",
            "modulus:elbow=5deg",
            "size:elbow:1=1",
            "modulus:elbow:x=1",
            "modulus:elbow:1=5grad",
            "modulus:elbow:1=5",
            "modulus:elbow:1=NaN",
            "modulus:elbow:-1=1",
            "modulus:elbow:1=5deg+-0deg",
            "modulus:elbow:1=5deg+-",
            "modulus:elbow:fHz=5deg",
            "ratio:elbow:1=2",
            "ratio:elbow:1/wrist=2",
            "ratio:elbow:1/wrist:1=2deg",
            "sum:=1",
            "frequency=2.5",
            "frequency:a=2.5Hz",
            "jitter:mood=5%",
            "jitter:tempo=0.05",
            "swing:a:1=5",
            "sum:modulus:elbow:1=1",
            "sum:x*modulus:elbow:1=1",
        ] {
            let error = text.parse::<Observation>().unwrap_err();
            assert_eq!(error.kind(), ErrorKind::Syntax, "{text}");
        }
    }
}

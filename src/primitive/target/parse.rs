//! Targets as text.

use std::fmt;
use std::str::FromStr;

use super::{Band, Target, ViaPoint};
use crate::error::{Error, ErrorKind, Result};
use crate::units::parse_angle_with_unit;

impl FromStr for Target {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let malformed = || {
            Error::new(ErrorKind::Syntax, format!("target `{text}`")).expected(
                "JOINT@TIME=VALUE+-VALUE or JOINT:LOW..HIGH=VALUE+-VALUE, such as elbow@1.2s=90deg+-2deg or elbow:1.2Hz..1.8Hz=10deg+-1deg",
            )
        };
        let number = |text: &str, unit: &str| -> Result<f64> {
            let number = text.trim().strip_suffix(unit).ok_or_else(malformed)?;
            let value: f64 = number.trim().parse().map_err(|_| malformed())?;
            if value.is_finite() {
                Ok(value)
            } else {
                Err(malformed())
            }
        };
        let (place, value) = text.rsplit_once('=').ok_or_else(malformed)?;
        let (value, deviation) = value.split_once("+-").ok_or_else(malformed)?;
        let value = parse_angle_with_unit(value)?;
        let deviation = parse_angle_with_unit(deviation)?;
        if let Some((joint, time)) = place.rsplit_once('@') {
            return Ok(Self::ViaPoint(ViaPoint {
                joint: joint.trim().to_owned(),
                time: number(time, "s")?,
                position: value,
                deviation,
            }));
        }
        let (joint, band) = place.rsplit_once(':').ok_or_else(malformed)?;
        let (low, high) = band.split_once("..").ok_or_else(malformed)?;
        Ok(Self::Band(Band {
            joint: joint.trim().to_owned(),
            low: number(low, "Hz")?,
            high: number(high, "Hz")?,
            amplitude: value,
            deviation,
        }))
    }
}

impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (aim, deviation) = self.aim();
        match self {
            Self::ViaPoint(p) => write!(f, "{}@{}s", p.joint, p.time)?,
            Self::Band(b) => write!(f, "{}:{}Hz..{}Hz", b.joint, b.low, b.high)?,
        }
        let (aim, deviation) = (aim.to_degrees(), deviation.to_degrees());
        write!(f, "={aim:.2}deg+-{deviation:.2}deg")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_read_and_written() {
        for text in [
            "elbow@1.2s=90.00deg+-2.00deg",
            "a:b@-0.5s=-10.00deg+-0.50deg",
            "a:b:1.2Hz..1.8Hz=10.00deg+-1.00deg",
        ] {
            let target: Target = text.parse().unwrap();
            assert_eq!(target.to_string(), text);
        }
        for text in [
            "",
            "elbow@1.2=90deg+-2deg",
            "elbow@1.2s=90deg",
            "elbow@1.2s=90+-2deg",
            "elbow:1Hz=5deg+-1deg",
            "elbow:1..2Hz=5deg+-1deg",
            "elbow@NaNs=5deg+-1deg",
        ] {
            assert!(text.parse::<Target>().is_err(), "{text}");
        }
    }
}

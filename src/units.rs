//! Quantities as people write them.

use crate::error::{Error, ErrorKind, Result};

/// An angle \[rad\] with its unit, `5deg` or `0.1rad`; a bare number is radians.
///
/// # Errors
/// When the text is not a finite number with one of these units.
pub fn parse_angle(text: &str) -> Result<f64> {
    let text = text.trim();
    let (number, unit) = if let Some(number) = text.strip_suffix("deg") {
        (number, 1f64.to_radians())
    } else {
        (text.strip_suffix("rad").unwrap_or(text), 1.0)
    };
    match number.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value * unit),
        _ => Err(Error::new(ErrorKind::Syntax, format!("angle `{text}`"))
            .expected("a number with unit deg or rad, such as 5deg")),
    }
}

/// [`parse_angle`] of a text that must name its unit.
///
/// # Errors
/// Those of `parse_angle`, and when there is no unit.
pub fn parse_angle_with_unit(text: &str) -> Result<f64> {
    if text.trim().ends_with("deg") || text.trim().ends_with("rad") {
        return parse_angle(text);
    }
    Err(
        Error::new(ErrorKind::Syntax, format!("angle `{}`", text.trim()))
            .expected("a number with its unit, such as 5deg or 0.1rad"),
    )
}

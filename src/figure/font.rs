//! The embedded sans-serif font, and text in images.

use std::sync::OnceLock;

use plotters::style::{FontDesc, FontFamily, FontStyle, register_font};

use crate::error::{Error, ErrorKind, Result};
use crate::figure::image::{Color, Image};

/// Bytes of the font: Ubuntu Light, the only proportional face that the font crate has.
const BYTES: &[u8] = epaint_default_fonts::UBUNTU_LIGHT;

/// Sub-pixels per pixel side of text drawn into an [`Image`].
const SUPERSAMPLING: u32 = 4;

/// A font size at which the whole numbers that plotters measures in are fine enough.
const MEASURING_SIZE: f64 = 1000.0;

/// Subscripts that labels may use, and of which letters they are small versions.
const SUBSCRIPTS: [(char, char); 17] = [
    ('₀', '0'),
    ('₁', '1'),
    ('₂', '2'),
    ('₃', '3'),
    ('₄', '4'),
    ('₅', '5'),
    ('₆', '6'),
    ('₇', '7'),
    ('₈', '8'),
    ('₉', '9'),
    ('ᵢ', 'i'),
    ('ⱼ', 'j'),
    ('ₖ', 'k'),
    ('ₘ', 'm'),
    ('ₙ', 'n'),
    ('ₚ', 'p'),
    ('ₜ', 't'),
];

/// Metrics of the font; all lengths in multiples of the font size.
pub(crate) struct Font {
    /// The em square, which is what SVG calls the font size.
    pub(crate) em: f64,
    units: f64,
    tables: Tables,
}

/// Offsets in bytes into the font file.
struct Tables {
    character_map: usize,
    metrics: usize,
    metrics_count: usize,
    units_per_em: f64,
}

/// The font, registered with plotters under the name `sans-serif` on the first call.
///
/// # Errors
/// plotters refuses the embedded bytes.
pub(crate) fn sans() -> Result<&'static Font> {
    static FONT: OnceLock<Option<Font>> = OnceLock::new();
    FONT.get_or_init(|| {
        register_font("sans-serif", FontStyle::Normal, BYTES).ok()?;
        let tables = Tables::find()?;
        // The advance of one letter tells how plotters scales the units of the font.
        let (advance, _) = tables.metrics(tables.glyph('M')?)?;
        let ((left, _), (right, _)) = description(MEASURING_SIZE).layout_box("M").ok()?;
        let units = f64::from(right - left) / MEASURING_SIZE / advance;
        Some(Font {
            em: units * tables.units_per_em,
            units,
            tables,
        })
    })
    .as_ref()
    .ok_or_else(|| Error::new(ErrorKind::Infeasible, "the embedded font is unusable"))
}

fn description(size: f64) -> FontDesc<'static> {
    FontDesc::new(FontFamily::SansSerif, size, FontStyle::Normal)
}

impl Font {
    /// Advance and left bearing of a character.
    fn metrics(&self, character: char) -> (f64, f64) {
        let (base, shrink) = self.drawn(character);
        let glyph = self.tables.glyph(base).unwrap_or(0);
        let (advance, bearing) = self.tables.metrics(glyph).unwrap_or((0.0, 0.0));
        (advance * self.units * shrink, bearing * self.units * shrink)
    }

    /// What to draw for a character, and how much smaller: the font has few subscripts.
    fn drawn(&self, character: char) -> (char, f64) {
        let base = SUBSCRIPTS
            .iter()
            .find(|(subscript, _)| *subscript == character);
        base.map_or((character, 1.0), |(_, base)| (*base, 0.7))
    }

    /// Width of `text` in pixels at `size` px.
    pub(crate) fn width(&self, text: &str, size: f64) -> f64 {
        text.chars()
            .map(|character| self.metrics(character).0 * size)
            .sum()
    }

    /// Calls `put(x, y, coverage)` for the pixels of `text`; x counts from the start of the
    /// text, y down from the baseline.
    ///
    /// Glyph by glyph, because plotters 0.3 leaves out the left bearings, which spaces the
    /// letters unevenly.
    pub(crate) fn pixels(
        &self,
        text: &str,
        size: f64,
        mut put: impl FnMut(i32, i32, f64) -> Result<()>,
    ) -> Result<()> {
        let mut pen = 0.0;
        for character in text.chars() {
            let (advance, bearing) = self.metrics(character);
            let left = (pen + bearing * size).round() as i32;
            let (base, shrink) = self.drawn(character);
            let font = description(shrink * size);
            let drop = if shrink < 1.0 { 0.14 * size } else { 0.0 };
            // plotters puts the baseline half the size below the given position.
            let top = drop as i32 - (0.5 * shrink * size) as i32;
            let mut outcome = Ok(());
            font.draw(
                base.encode_utf8(&mut [0; 4]),
                (left, top),
                |x, y, coverage| {
                    if outcome.is_ok() {
                        outcome = put(x, y, f64::from(coverage));
                    }
                    Ok::<(), std::convert::Infallible>(())
                },
            )
            .map_err(|error| Error::new(ErrorKind::Infeasible, error.to_string()))?
            .unwrap_or_else(|never| match never {});
            outcome?;
            pen += advance * size;
        }
        Ok(())
    }
}

impl Tables {
    fn find() -> Option<Self> {
        let count = usize::from(unsigned(4)?);
        let table = |tag: &[u8; 4]| {
            (0..count).map(|index| 12 + 16 * index).find_map(|record| {
                (BYTES.get(record..record + 4)? == tag).then_some(())?;
                long(record + 8)
            })
        };
        let maps = table(b"cmap")?;
        // Format 4 is the map of the Basic Multilingual Plane that every font of this kind has.
        let character_map = (0..usize::from(unsigned(maps + 2)?)).find_map(|index| {
            let offset = maps + long(maps + 4 + 8 * index + 4)?;
            (unsigned(offset)? == 4).then_some(offset)
        })?;
        let metrics_count = usize::from(unsigned(table(b"hhea")? + 34)?);
        let units_per_em = f64::from(unsigned(table(b"head")? + 18)?);
        Some(Self {
            character_map,
            metrics: table(b"hmtx")?,
            metrics_count,
            units_per_em,
        })
    }

    /// Glyph of a character; 0 is the box of a missing one.
    fn glyph(&self, character: char) -> Option<usize> {
        let code = u16::try_from(u32::from(character)).ok()?;
        let map = self.character_map;
        let segments = usize::from(unsigned(map + 6)?);
        let segment = (0..segments)
            .step_by(2)
            .find(|at| unsigned(map + 14 + at).is_some_and(|end| end >= code))?;
        let start = unsigned(map + 16 + segments + segment)?;
        let delta = unsigned(map + 16 + 2 * segments + segment)?;
        let range_at = map + 16 + 3 * segments + segment;
        let range = usize::from(unsigned(range_at)?);
        let within = code.checked_sub(start)?;
        if range == 0 {
            return Some(usize::from(code.wrapping_add(delta)));
        }
        match unsigned(range_at + range + 2 * usize::from(within))? {
            0 => None,
            glyph => Some(usize::from(glyph.wrapping_add(delta))),
        }
    }

    /// Advance and left bearing of a glyph in units of the font.
    fn metrics(&self, glyph: usize) -> Option<(f64, f64)> {
        let last = self.metrics_count.checked_sub(1)?;
        let advance = unsigned(self.metrics + 4 * glyph.min(last))?;
        let bearing_at = match glyph.checked_sub(self.metrics_count) {
            None => self.metrics + 4 * glyph + 2,
            Some(beyond) => self.metrics + 4 * self.metrics_count + 2 * beyond,
        };
        let bearing = unsigned(bearing_at)?.cast_signed();
        Some((f64::from(advance), f64::from(bearing)))
    }
}

fn unsigned(at: usize) -> Option<u16> {
    let bytes = BYTES.get(at..at + 2)?;
    Some(u16::from_be_bytes(bytes.try_into().ok()?))
}

fn long(at: usize) -> Option<usize> {
    let bytes = BYTES.get(at..at + 4)?;
    usize::try_from(u32::from_be_bytes(bytes.try_into().ok()?)).ok()
}

impl Image {
    /// The image under a white strip with `text`, centred, broken between words where it is
    /// wider than the image, and where it has a line feed. The text grows with the image.
    ///
    /// # Errors
    /// The result would be too large.
    pub fn captioned(&self, text: &str) -> Result<Self> {
        let font = sans()?;
        let size = (f64::from(self.width) / 26.0).clamp(11.0, 44.0);
        let lines: Vec<String> = text
            .lines()
            .flat_map(|line| wrapped(font, line, size, f64::from(self.width) - size))
            .collect();
        let line_height = (1.25 * size).ceil();
        let strip_height = (line_height * lines.len() as f64 + 0.5 * size).ceil() as u32;
        let scale = f64::from(SUPERSAMPLING);
        let mut strip = Self::filled(
            self.width.saturating_mul(SUPERSAMPLING),
            strip_height.saturating_mul(SUPERSAMPLING),
            Color::WHITE,
        )?;
        for (index, line) in lines.iter().enumerate() {
            let left = ((f64::from(self.width) - font.width(line, size)) / 2.0).max(0.0);
            let baseline = line_height * index as f64 + 1.05 * size;
            let (left, baseline) = ((left * scale) as i64, (baseline * scale) as i64);
            font.pixels(line, size * scale, |x, y, coverage| {
                let (x, y) = (left + i64::from(x), baseline + i64::from(y));
                strip.blend(x, y, Color::BLACK, coverage);
                // The face is too light for print: a second impression a quarter of a pixel on.
                strip.blend(x + 1, y, Color::BLACK, coverage);
                Ok(())
            })?;
        }
        let strip = strip.downsampled(SUPERSAMPLING)?;
        let height = self.height.saturating_add(strip.height);
        let mut whole = Self::filled(self.width, height, Color::WHITE)?;
        whole.paste(&strip, 0, 0);
        whole.paste(self, 0, strip.height);
        Ok(whole)
    }
}

/// `text` in lines of at most `width` px, except for single words wider than that.
fn wrapped(font: &Font, text: &str, size: f64, width: f64) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.is_empty() => line.push_str(word),
            Some(line) if font.width(&format!("{line} {word}"), size) <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metrics_agree_with_those_of_plotters() {
        let font = sans().unwrap();
        for text in ["i", "W", "°", "θ", "−", "±"] {
            let ((left, _), (right, _)) = description(MEASURING_SIZE).layout_box(text).unwrap();
            let width = font.width(text, MEASURING_SIZE);
            assert!(
                (width - f64::from(right - left)).abs() < 2.0,
                "{text}: {width}"
            );
            assert!(
                font.tables
                    .glyph(text.chars().next().unwrap())
                    .is_some_and(|g| g > 0)
            );
        }
    }

    #[test]
    fn a_caption_is_dark_text_on_a_white_strip_above_the_picture() {
        let image = Image::filled(300, 40, Color::BLUE).unwrap();
        let one = image.captioned("Wave").unwrap();
        assert_eq!(one.width, 300);
        assert_eq!(one.pixel(0, 0), Some([255; 3]));
        assert_eq!(one.pixel(0, one.height - 1), Some(Color::BLUE.rgb));
        assert!(
            one.pixels
                .chunks_exact(3)
                .any(|pixel| pixel.iter().all(|&c| c < 100))
        );
        let long = image
            .captioned(&"many words of a caption ".repeat(6))
            .unwrap();
        assert!(long.height > one.height + 20);
    }
}

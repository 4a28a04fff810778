//! The embedded sans-serif font, and text in images.

use std::sync::OnceLock;

use ab_glyph::{Font as _, FontRef, GlyphId, PxScale, ScaleFont as _, point};

use crate::error::{Error, ErrorKind, Result};
use crate::figure::image::{Color, Image};

/// Bytes of the font: Ubuntu Light, the only proportional face that the font crate has.
const BYTES: &[u8] = epaint_default_fonts::UBUNTU_LIGHT;

/// Sub-pixels per pixel side of text drawn into an [`Image`].
const SUPERSAMPLING: u32 = 4;

/// How much smaller a subscript is, and how far below the baseline it stands, as shares of the size.
const SUBSCRIPT_SIZE: f64 = 0.7;
const SUBSCRIPT_DROP: f64 = 0.14;

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

/// The embedded font. A size is the height in pixels from the deepest descender to the highest ascender.
pub(crate) struct Font(FontRef<'static>);

/// A character as it is drawn: its glyph, its size, and how far it stands below the baseline \[px\].
struct Drawn {
    glyph: GlyphId,
    size: f64,
    drop: f64,
}

/// The font.
///
/// # Errors
/// None that the embedded bytes could cause.
pub(crate) fn sans() -> Result<&'static Font> {
    static FONT: OnceLock<Option<Font>> = OnceLock::new();
    FONT.get_or_init(|| FontRef::try_from_slice(BYTES).ok().map(Font))
        .as_ref()
        .ok_or_else(|| Error::new(ErrorKind::Infeasible, "the embedded font is unusable"))
}

impl Font {
    /// The em square, which is what SVG calls the font size, as a share of the size.
    pub(crate) fn em(&self) -> f64 {
        f64::from(self.0.units_per_em().unwrap_or(1.0) / self.0.height_unscaled())
    }

    /// Width of `text` in pixels at `size` px.
    pub(crate) fn width(&self, text: &str, size: f64) -> f64 {
        text.chars()
            .map(|c| self.advance(&self.drawn(c, size)))
            .sum()
    }

    /// Calls `put(x, y, coverage)` for the pixels of `text`; x counts from the start of the
    /// text, y down from the baseline.
    pub(crate) fn pixels(
        &self,
        text: &str,
        size: f64,
        mut put: impl FnMut(i32, i32, f64) -> Result<()>,
    ) -> Result<()> {
        let mut pen = 0.0;
        for drawn in text.chars().map(|c| self.drawn(c, size)) {
            let at = point(pen as f32, drawn.drop as f32);
            let glyph = drawn.glyph.with_scale_and_position(drawn.size as f32, at);
            if let Some(outline) = self.0.outline_glyph(glyph) {
                let corner = outline.px_bounds().min;
                let mut outcome = Ok(());
                outline.draw(|x, y, coverage| {
                    if outcome.is_ok() && coverage > 0.0 {
                        let (x, y) = (corner.x as i32 + x as i32, corner.y as i32 + y as i32);
                        outcome = put(x, y, f64::from(coverage.min(1.0)));
                    }
                });
                outcome?;
            }
            pen += self.advance(&drawn);
        }
        Ok(())
    }

    /// The font has few subscripts; the others are small letters.
    fn drawn(&self, character: char, size: f64) -> Drawn {
        match SUBSCRIPTS
            .iter()
            .find(|(subscript, _)| *subscript == character)
        {
            Some((_, base)) => Drawn {
                glyph: self.0.glyph_id(*base),
                size: SUBSCRIPT_SIZE * size,
                drop: SUBSCRIPT_DROP * size,
            },
            None => Drawn {
                glyph: self.0.glyph_id(character),
                size,
                drop: 0.0,
            },
        }
    }

    fn advance(&self, drawn: &Drawn) -> f64 {
        let scaled = self.0.as_scaled(PxScale::from(drawn.size as f32));
        f64::from(scaled.h_advance(drawn.glyph))
    }
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
    fn the_font_has_what_labels_need() {
        let font = sans().unwrap();
        for character in "aW°θ−±|".chars().chain(SUBSCRIPTS.map(|(c, _)| c)) {
            assert_ne!(font.drawn(character, 10.0).glyph, GlyphId(0), "{character}");
        }
        assert!(font.width("ii", 100.0) < font.width("WW", 100.0));
        let both = font.width("a", 100.0) + font.width("b", 100.0);
        assert!((font.width("ab", 100.0) - both).abs() < 1e-9);
        assert!(font.width("₀", 100.0) < font.width("0", 100.0));
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

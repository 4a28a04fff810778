//! Colours and RGB images: joining, shrinking, PNG.

use crate::error::{Error, ErrorKind, Result};

/// Longest side of an image, px: beyond it a size is a mistake, not a figure.
pub const MAX_SIDE: u32 = 32_768;

/// Most pixels of an image, for the same reason.
pub const MAX_PIXELS: u32 = 1 << 28;

/// An sRGB colour with opacity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Color {
    /// Red, green and blue in sRGB, 0..=255 each.
    pub rgb: [u8; 3],
    /// 0 (invisible) to 1 (opaque).
    pub alpha: f64,
}

impl Color {
    /// Black.
    pub const BLACK: Self = Self::new(0, 0, 0);
    /// White.
    pub const WHITE: Self = Self::new(255, 255, 255);
    /// A neutral mid grey for baselines.
    pub const GREY: Self = Self::new(110, 110, 110);
    /// Okabe-Ito orange.
    pub const ORANGE: Self = Self::new(230, 159, 0);
    /// Okabe-Ito sky blue.
    pub const SKY: Self = Self::new(86, 180, 233);
    /// Okabe-Ito bluish green.
    pub const GREEN: Self = Self::new(0, 158, 115);
    /// Okabe-Ito yellow; too pale for thin lines on white.
    pub const YELLOW: Self = Self::new(240, 228, 66);
    /// Okabe-Ito blue.
    pub const BLUE: Self = Self::new(0, 114, 178);
    /// Okabe-Ito vermilion.
    pub const VERMILION: Self = Self::new(213, 94, 0);
    /// Okabe-Ito reddish purple.
    pub const PURPLE: Self = Self::new(204, 121, 167);
    /// Opaque colour from sRGB components, 0..=255 each.
    pub const fn new(red: u8, green: u8, blue: u8) -> Self {
        Self {
            rgb: [red, green, blue],
            alpha: 1.0,
        }
    }

    /// The same colour with opacity `alpha` (0..=1).
    pub const fn with_alpha(self, alpha: f64) -> Self {
        Self {
            rgb: self.rgb,
            alpha,
        }
    }
}

/// An opaque 8-bit sRGB image.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    /// Width, px.
    pub width: u32,
    /// Height, px.
    pub height: u32,
    /// Rows from the top, each `width` times red, green, blue: `3 * width * height` bytes.
    pub pixels: Vec<u8>,
}

impl Image {
    /// An image of one colour (its opacity is ignored), `width` x `height` px.
    ///
    /// # Errors
    /// A side of zero or above [`MAX_SIDE`], or more than [`MAX_PIXELS`].
    pub fn filled(width: u32, height: u32, color: Color) -> Result<Self> {
        let sides = 1..=MAX_SIDE;
        let fits = width
            .checked_mul(height)
            .is_some_and(|pixels| pixels <= MAX_PIXELS);
        if !sides.contains(&width) || !sides.contains(&height) || !fits {
            return Err(Error::new(
                ErrorKind::Value,
                format!("an image of {width} x {height} px"),
            ));
        }
        let count = width as usize * height as usize;
        Ok(Self {
            width,
            height,
            pixels: color.rgb.repeat(count),
        })
    }

    /// sRGB components of the pixel in column `x` from the left and row `y` from the top.
    pub fn pixel(&self, x: u32, y: u32) -> Option<[u8; 3]> {
        if x >= self.width || y >= self.height {
            return None;
        }
        let at = 3 * (y as usize * self.width as usize + x as usize);
        self.pixels.get(at..at + 3)?.try_into().ok()
    }

    /// Paints `color` over a pixel with the fraction `coverage` (0..=1) of its opacity; pixels
    /// outside are ignored so that callers need not clip.
    pub fn blend(&mut self, x: i64, y: i64, color: Color, coverage: f64) {
        if x < 0 || y < 0 || x >= i64::from(self.width) || y >= i64::from(self.height) {
            return;
        }
        let at = 3 * (y as usize * self.width as usize + x as usize);
        let weight = (color.alpha * coverage).clamp(0.0, 1.0);
        for (old, new) in self.pixels.iter_mut().skip(at).zip(color.rgb) {
            let mixed = f64::from(*old) * (1.0 - weight) + f64::from(new) * weight;
            *old = mixed.round() as u8;
        }
    }

    /// The image as a PNG file, 8 bits per component.
    ///
    /// # Errors
    /// `pixels` does not have `3 * width * height` bytes, or a side is zero.
    pub fn to_png(&self) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header().map_err(encoding)?;
        writer.write_image_data(&self.pixels).map_err(encoding)?;
        writer.finish().map_err(encoding)?;
        Ok(bytes)
    }

    /// The image `factor` times smaller, each pixel the mean of a `factor` x `factor` block;
    /// an incomplete last row or column of blocks is dropped.
    ///
    /// # Errors
    /// `factor` is zero or above a side of the image.
    pub fn downsampled(&self, factor: u32) -> Result<Self> {
        if factor == 0 || factor > self.width || factor > self.height {
            return Err(Error::new(
                ErrorKind::Value,
                format!(
                    "{} x {} px downsampled {factor} times",
                    self.width, self.height
                ),
            ));
        }
        let (width, height) = (self.width / factor, self.height / factor);
        let mut sums = vec![0_u32; 3 * width as usize];
        let mut pixels = Vec::with_capacity(sums.len() * height as usize);
        let (block, row) = (3 * factor as usize, 3 * self.width as usize);
        let half = factor * factor / 2;
        for rows in self.pixels.chunks_exact(row * factor as usize) {
            sums.fill(0);
            for line in rows.chunks_exact(row) {
                for (sum, samples) in sums.chunks_exact_mut(3).zip(line.chunks_exact(block)) {
                    for sample in samples.chunks_exact(3) {
                        for (total, &value) in sum.iter_mut().zip(sample) {
                            *total += u32::from(value);
                        }
                    }
                }
            }
            pixels.extend(
                sums.iter()
                    .map(|sum| ((sum + half) / (factor * factor)) as u8),
            );
        }
        Ok(Self {
            width,
            height,
            pixels,
        })
    }

    /// Images row by row in `columns` columns, each row as high as its highest image, on white.
    ///
    /// # Errors
    /// No images or columns, or a result beyond the limits of an [`Image`].
    pub fn tiled(images: &[Self], columns: usize) -> Result<Self> {
        let rows = images
            .chunks(columns.max(1))
            .map(Self::beside)
            .collect::<Result<Vec<_>>>()?;
        let width = rows.iter().map(|row| row.width).max().unwrap_or(0);
        let height = rows.iter().map(|row| row.height).sum();
        let mut whole = Self::filled(width, height, Color::WHITE)?;
        let mut top = 0;
        for row in &rows {
            whole.paste(row, 0, top);
            top += row.height;
        }
        Ok(whole)
    }

    /// The images side by side from left to right, their tops aligned, on white.
    ///
    /// # Errors
    /// No image, or a total size beyond [`MAX_SIDE`].
    pub fn beside(images: &[Self]) -> Result<Self> {
        let height = images.iter().map(|image| image.height).max().unwrap_or(0);
        let width = images
            .iter()
            .fold(0_u32, |sum, image| sum.saturating_add(image.width));
        let mut joined = Self::filled(width, height, Color::WHITE)?;
        let mut left = 0;
        for image in images {
            joined.paste(image, left, 0);
            left += image.width;
        }
        Ok(joined)
    }

    /// Copies `other` to the column `left` and the row `top`; what juts out is cut off.
    pub fn paste(&mut self, other: &Self, left: u32, top: u32) {
        let (row, other_row) = (3 * self.width as usize, 3 * other.width as usize);
        if row == 0 || other_row == 0 || left >= self.width {
            return;
        }
        let start = 3 * left as usize;
        let lines = self.pixels.chunks_exact_mut(row).skip(top as usize);
        for (line, source) in lines.zip(other.pixels.chunks_exact(other_row)) {
            for (old, new) in line.iter_mut().skip(start).zip(source) {
                *old = *new;
            }
        }
    }
}

fn encoding(error: png::EncodingError) -> Error {
    Error::new(ErrorKind::Io, error.to_string()).at("PNG")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn png_decodes_to_the_same_image() {
        let mut image = Image::filled(5, 3, Color::BLUE).unwrap();
        image.blend(4, 2, Color::VERMILION, 1.0);
        let bytes = image.to_png().unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
            .read_info()
            .unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        assert_eq!((info.width, info.height), (5, 3));
        assert_eq!(pixels, image.pixels);
    }

    #[test]
    fn downsampling_averages_blocks() {
        let mut image = Image::filled(5, 4, Color::BLACK).unwrap();
        image.blend(0, 0, Color::WHITE, 1.0);
        image.blend(1, 1, Color::WHITE, 1.0);
        let small = image.downsampled(2).unwrap();
        assert_eq!((small.width, small.height), (2, 2));
        assert_eq!(small.pixel(0, 0), Some([128; 3]));
        assert_eq!(small.pixel(1, 1), Some([0; 3]));
        assert!(image.downsampled(0).is_err() && image.downsampled(6).is_err());
    }

    #[test]
    fn joined_images_keep_their_places() {
        let red = Image::filled(2, 2, Color::VERMILION).unwrap();
        let blue = Image::filled(3, 4, Color::BLUE).unwrap();
        let joined = Image::beside(&[red, blue]).unwrap();
        assert_eq!((joined.width, joined.height), (5, 4));
        assert_eq!(joined.pixel(1, 1), Some(Color::VERMILION.rgb));
        assert_eq!(joined.pixel(1, 3), Some([255; 3]));
        assert_eq!(joined.pixel(2, 3), Some(Color::BLUE.rgb));
        assert_eq!(joined.pixel(5, 0), None);
        assert!(Image::beside(&[]).is_err());
    }

    #[test]
    fn wrong_pixel_count_is_an_error() {
        assert!(
            Image {
                width: 2,
                height: 2,
                pixels: vec![0; 5]
            }
            .to_png()
            .is_err()
        );
        assert!(
            Image {
                width: 0,
                height: 2,
                pixels: vec![]
            }
            .to_png()
            .is_err()
        );
        assert!(Image::filled(0, 2, Color::WHITE).is_err());
    }
}

//! sRGB images: PNG files and contact sheets.

use std::io::Write;

/// A picture: `3 * width * height` sRGB bytes, rows from the top.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Image {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green, blue of each pixel.
    pub pixels: Vec<u8>,
}

impl Image {
    /// Creates a picture of one colour.
    #[must_use]
    pub fn filled(width: usize, height: usize, color: [u8; 3]) -> Self {
        Image { width, height, pixels: color.repeat(width * height) }
    }

    /// Returns the colour of a pixel; x and y count from the top left.
    #[must_use]
    pub fn pixel(&self, x: usize, y: usize) -> [u8; 3] {
        let i = 3 * (y * self.width + x);
        [self.pixels[i], self.pixels[i + 1], self.pixels[i + 2]]
    }

    /// Writes the picture as a PNG file.
    ///
    /// # Errors
    /// An error of the writer, or a picture without pixels or too large for the format.
    pub fn write_png(&self, writer: impl Write) -> std::io::Result<()> {
        let mut png = PngWriter::new(writer, [self.width, self.height], None)?;
        png.write_image(self)?;
        png.finish()
    }

    /// Copies `other` in with its top left pixel at (x, y), clipped to this image.
    fn paste_clipped_at(&mut self, other: &Image, x: usize, y: usize) {
        let x = x.min(self.width);
        let width = other.width.min(self.width - x);
        for row in 0..other.height.min(self.height.saturating_sub(y)) {
            let from = 3 * row * other.width;
            let to = 3 * ((y + row) * self.width + x);
            self.pixels[to..to + 3 * width].copy_from_slice(&other.pixels[from..from + 3 * width]);
        }
    }
}

/// The frames of an animated PNG, which loops for ever.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Animation {
    /// Number of frames.
    pub frames: u16,
    /// Duration of all frames together, in seconds.
    pub seconds: u16,
}

/// A writer of a PNG file, picture by picture if the file is animated (APNG, PNG's third edition).
pub struct PngWriter<W: Write>(png::Writer<W>);

impl<W: Write> PngWriter<W> {
    /// Creates a file for one picture of `[width, height]` pixels, or for an animation's.
    ///
    /// # Errors
    /// An error of the writer, or a picture without pixels or too large for the format.
    pub fn new(
        writer: W,
        [width, height]: [usize; 2],
        animation: Option<Animation>,
    ) -> std::io::Result<Self> {
        let side = |n: usize| u32::try_from(n).map_err(std::io::Error::other);
        let mut encoder = png::Encoder::new(writer, side(width)?, side(height)?);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        if let Some(Animation { frames, seconds }) = animation {
            encoder.set_animated(frames.into(), 0)?;
            encoder.set_frame_delay(seconds, frames)?;
        }
        Ok(PngWriter(encoder.write_header()?))
    }

    /// Writes the next picture.
    ///
    /// # Errors
    /// An error of the writer, a picture of another size, or one picture too many.
    pub fn write_image(&mut self, image: &Image) -> std::io::Result<()> {
        Ok(self.0.write_image_data(&image.pixels)?)
    }

    /// Ends the file.
    ///
    /// # Errors
    /// An error of the writer, or a picture too few.
    pub fn finish(self) -> std::io::Result<()> {
        Ok(self.0.finish()?)
    }
}

/// Arranges pictures side by side, `columns` in a row, with thin dark gaps; a cell is as large as the
/// largest of them. Without pictures or columns, returns a picture without pixels.
#[must_use]
pub fn contact_sheet(images: &[Image], columns: usize) -> Image {
    const GAP: usize = 4;
    const BACK: [u8; 3] = [24, 24, 26];
    let columns = columns.min(images.len());
    if columns == 0 {
        return Image::filled(0, 0, BACK);
    }
    let width = images.iter().map(|image| image.width).max().unwrap_or(0) + GAP;
    let height = images.iter().map(|image| image.height).max().unwrap_or(0) + GAP;
    let rows = images.len().div_ceil(columns);
    let mut sheet = Image::filled(columns * width + GAP, rows * height + GAP, BACK);
    for (i, image) in images.iter().enumerate() {
        sheet.paste_clipped_at(image, GAP + i % columns * width, GAP + i / columns * height);
    }
    sheet
}

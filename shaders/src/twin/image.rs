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
    /// A picture of one colour.
    #[must_use]
    pub fn filled(width: usize, height: usize, color: [u8; 3]) -> Self {
        Image { width, height, pixels: color.repeat(width * height) }
    }

    /// The colour of a pixel, counted from the top left.
    #[must_use]
    pub fn pixel(&self, x: usize, y: usize) -> [u8; 3] {
        let i = 3 * (y * self.width + x);
        [self.pixels[i], self.pixels[i + 1], self.pixels[i + 2]]
    }

    /// Writes the picture as a PNG file.
    ///
    /// # Errors
    /// What the writer reports, or a picture without pixels or too large for the format.
    pub fn write_png(&self, writer: impl Write) -> std::io::Result<()> {
        let side = |n: usize| u32::try_from(n).map_err(std::io::Error::other);
        let mut encoder = png::Encoder::new(writer, side(self.width)?, side(self.height)?);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut png = encoder.write_header()?;
        png.write_image_data(&self.pixels)?;
        Ok(png.finish()?)
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

/// Pictures side by side, `columns` in a row, with thin dark gaps; a cell is as large as the
/// largest of them. Without pictures or columns, a picture without pixels.
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

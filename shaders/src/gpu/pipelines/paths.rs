//! Render paths of the sculpture.

/// A render path of the sculpture.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Debug)]
pub enum RenderPath {
    /// Section 4 of the paper, or a variant of it.
    Paper(PaperVariant),
    /// Ray marching of the smooth surface of the blurred volume.
    #[default]
    Fast,
}

/// The paper's path, or one of the experiments of its section 5.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Debug)]
pub enum PaperVariant {
    /// The whole path.
    #[default]
    Whole,
    /// All three range maps sampled at every step.
    FullMarch,
    /// The voxel's face instead of the blobs' distance field.
    NoSdf,
    /// The normal as the colour.
    NoShading,
}

/// The output of a render path: its picture, or a measurement in its place.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Debug)]
pub enum Drawn {
    /// The picture.
    #[default]
    Picture,
    /// Counts as colours, linear and over 255: red the texels sampled and loaded for a pixel, green the
    /// iterations of its march, blue 1 where it hit the sculpture. Fragments that the picture discards are
    /// drawn too, with blue 0.
    Counts,
    /// The same counts for the program for several samples a pixel, in a format of one sample.
    CoverageCounts,
    /// The fast path without its march and with two fetches of shading: a lower bound of its cost. For the
    /// paper's path, its picture.
    Floor,
}

/// The counts in a pixel of [`Drawn::Counts`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct PixelCounts {
    /// Texels sampled and loaded, at most 255; a filtered sample counts as one. Exact to 60, within 1 above.
    pub fetches: u32,
    /// Iterations of the march, with the same bounds.
    pub turns: u32,
    /// `true` if the pixel shows the sculpture.
    pub hit: bool,
}

impl PixelCounts {
    /// Decodes the counts from a pixel's red, green and blue in an sRGB image.
    #[must_use]
    pub fn from_srgb([fetches, turns, hit]: [u8; 3]) -> Self {
        let [fetches, turns] = [fetches, turns].map(linear_of_srgb);
        PixelCounts { fetches, turns, hit: hit == u8::MAX }
    }
}

/// Returns the linear value, of 255, that a byte of an sRGB image encodes (IEC 61966-2-1).
fn linear_of_srgb(byte: u8) -> u32 {
    let encoded = f32::from(byte) / 255.0;
    let linear = match encoded {
        dark if dark <= 0.04045 => dark / 12.92,
        _ => ((encoded + 0.055) / 1.055).powf(2.4),
    };
    (linear * 255.0).round() as u32
}

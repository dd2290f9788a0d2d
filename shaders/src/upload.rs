//! What of a sculpture's textures changed and has to be uploaded.

/// The textures that hold a sculpture on the GPU, for N voxels a side.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Texture {
    /// The range maps of so many intervals a column: N x N texels of two bytes for each interval (as
    /// `Range` stores them), a layer for each axis; x is the column's place, y its line.
    Maps(u8),
    /// The density, one byte a texel, at a level of detail: 0 is the finest.
    Density(u8),
    /// The cells' distances, one byte each.
    Cells,
    /// The paper's noise, one signed byte each.
    Noise,
    /// How grey the marble is, one byte each.
    Marble,
}

/// A box of texels of one texture.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Region {
    /// Which texture.
    pub texture: Texture,
    /// The least texel; z is the layer for [`Texture::Maps`].
    pub min: [u32; 3],
    /// Texels along each side; none is zero.
    pub size: [u32; 3],
}

impl Region {
    /// Bytes of the box, rows after rows without gaps.
    #[must_use]
    pub const fn byte_count(&self) -> usize {
        let texel = match self.texture {
            Texture::Maps(intervals) => 2 * intervals as usize,
            Texture::Density(_) | Texture::Cells | Texture::Noise | Texture::Marble => 1,
        };
        self.size[0] as usize * self.size[1] as usize * self.size[2] as usize * texel
    }

    /// Whether a texel lies in both.
    #[must_use]
    pub fn overlaps(&self, other: &Region) -> bool {
        let begins_within = |a: &Region, b: &Region, i: usize| a.min[i] < b.min[i] + b.size[i];
        self.texture == other.texture
            && (0..3).all(|i| begins_within(self, other, i) && begins_within(other, self, i))
    }
}

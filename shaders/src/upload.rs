//! Contents of a sculpture's textures, and the regions of them that changed and must be uploaded.

use crate::carrara;
use crate::limits::MAP_INTERVALS;

/// The shape of the volumes that textures are made for.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct VolumeFormat {
    grid_side: usize,
    intervals: usize,
}

impl VolumeFormat {
    /// Returns the format of volumes of N voxels a side and K intervals a column, K 1 or 2.
    #[must_use]
    pub const fn of<const N: usize, const K: usize>() -> Self {
        const { assert!(K >= 1 && K <= MAP_INTERVALS, "intervals that a texel holds") };
        VolumeFormat { grid_side: N, intervals: K }
    }

    /// Returns the voxels along a side.
    #[must_use]
    pub const fn grid_side(self) -> usize {
        self.grid_side
    }

    /// Returns the intervals of a column.
    #[must_use]
    pub const fn intervals(self) -> usize {
        self.intervals
    }
}

/// The textures that hold a sculpture on the GPU, for N voxels a side.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Texture {
    /// The range maps of this many intervals a column: N x N texels of two bytes for each interval (as
    /// `Range` stores them), a layer for each axis; x is the column's place, y its line.
    Maps(u8),
    /// The density, one byte a texel, at a level of detail: 0 is the finest.
    Density(u8),
    /// The directions out of the stone at level 1: three signed bytes, and a fourth for the convexity.
    Gradient,
    /// The cells' distances, one byte each.
    Cells,
    /// The paper's noise, one signed byte each.
    Noise,
    /// Two bytes a texel: the greyness of the marble, and the hidden figure's share of it.
    Marble,
}

/// A box of texels of one texture.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Region {
    /// The texture that holds the box.
    pub texture: Texture,
    /// The least texel; z is the layer for [`Texture::Maps`].
    pub min: [u32; 3],
    /// Texels along each side; none is zero.
    pub size: [u32; 3],
}

impl Region {
    /// Returns the region of the whole marble texture.
    #[must_use]
    pub const fn whole_marble() -> Self {
        Region { texture: Texture::Marble, min: [0; 3], size: [carrara::TEXTURE_SIDE as u32; 3] }
    }

    /// Returns the number of bytes of the box, row after row without gaps.
    #[must_use]
    pub const fn byte_count(&self) -> usize {
        let texel = match self.texture {
            Texture::Maps(intervals) => 2 * intervals as usize,
            Texture::Gradient => 4,
            Texture::Marble => 2,
            Texture::Density(_) | Texture::Cells | Texture::Noise => 1,
        };
        self.size[0] as usize * self.size[1] as usize * self.size[2] as usize * texel
    }

    /// Returns `true` if the region fits a volume's textures: maps must have the volume's number of
    /// intervals.
    #[must_use]
    pub fn has_intervals_of(&self, volume: VolumeFormat) -> bool {
        !matches!(self.texture, Texture::Maps(k) if usize::from(k) != volume.intervals)
    }

    /// Returns `true` if the regions share a texel.
    #[must_use]
    pub fn overlaps(&self, other: &Region) -> bool {
        let begins_within = |a: &Region, b: &Region, i: usize| a.min[i] < b.min[i] + b.size[i];
        self.texture == other.texture
            && (0..3).all(|i| begins_within(self, other, i) && begins_within(other, self, i))
    }
}

//! Boxes of texels.

use crate::upload::{Region, Texture};

/// A half-open box of texels: from `lo` up to, but without, `hi`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct TexelBox {
    pub(super) lo: [usize; 3],
    pub(super) hi: [usize; 3],
}

impl TexelBox {
    /// The empty box, neutral to union.
    pub(super) const NONE: TexelBox = TexelBox { lo: [usize::MAX; 3], hi: [0; 3] };

    /// Returns the box of a whole texture.
    pub(super) const fn cube(side: usize) -> Self {
        TexelBox { lo: [0; 3], hi: [side; 3] }
    }

    pub(super) fn is_empty(&self) -> bool {
        (0..3).any(|axis| self.lo[axis] >= self.hi[axis])
    }

    pub(super) fn size(&self) -> [usize; 3] {
        [0, 1, 2].map(|axis| self.hi[axis].saturating_sub(self.lo[axis]))
    }

    pub(super) fn volume(&self) -> usize {
        self.size().iter().product()
    }

    /// Returns the bounding box of both.
    #[must_use]
    #[inline]
    pub(super) fn union(&self, other: &Self) -> Self {
        TexelBox {
            lo: [0, 1, 2].map(|axis| self.lo[axis].min(other.lo[axis])),
            hi: [0, 1, 2].map(|axis| self.hi[axis].max(other.hi[axis])),
        }
    }

    /// Returns the box grown by `texels` on every side, clipped to a texture of `texture_side`.
    #[must_use]
    pub(super) fn grown_by(&self, texels: usize, texture_side: usize) -> Self {
        TexelBox {
            lo: self.lo.map(|lo| lo.saturating_sub(texels)),
            hi: self.hi.map(|hi| (hi + texels).min(texture_side)),
        }
    }

    /// Returns the bounding box of this one in texels `factor` times as large.
    #[must_use]
    pub(super) fn coarser_by(&self, factor: usize) -> Self {
        TexelBox { lo: self.lo.map(|lo| lo / factor), hi: self.hi.map(|hi| hi.div_ceil(factor)) }
    }

    /// Returns the rows along x, as (y, z).
    pub(super) fn rows(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let TexelBox { lo, hi } = *self;
        (lo[2]..hi[2]).flat_map(move |z| (lo[1]..hi[1]).map(move |y| (y, z)))
    }

    /// Converts the box to a region of a texture.
    pub(super) fn to_region(self, texture: Texture) -> Region {
        Region { texture, min: self.lo.map(|i| i as u32), size: self.size().map(|i| i as u32) }
    }
}

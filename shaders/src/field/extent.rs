//! Boxes of texels.

use crate::upload::{Region, Texture};

/// A box of texels: from `lo` up to but without `hi`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Extent {
    pub(super) lo: [usize; 3],
    pub(super) hi: [usize; 3],
}

impl Extent {
    /// No texel, such that the union with any box is that box.
    pub(super) const NONE: Extent = Extent { lo: [usize::MAX; 3], hi: [0; 3] };

    /// A whole texture.
    pub(super) const fn cube(side: usize) -> Self {
        Extent { lo: [0; 3], hi: [side; 3] }
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

    /// The least box that holds both.
    #[must_use]
    #[inline]
    pub(super) fn union(&self, other: &Self) -> Self {
        Extent {
            lo: [0, 1, 2].map(|axis| self.lo[axis].min(other.lo[axis])),
            hi: [0, 1, 2].map(|axis| self.hi[axis].max(other.hi[axis])),
        }
    }

    /// So many texels more on every side, within a texture of `side`.
    #[must_use]
    pub(super) fn grown(&self, by: usize, side: usize) -> Self {
        Extent {
            lo: self.lo.map(|lo| lo.saturating_sub(by)),
            hi: self.hi.map(|hi| (hi + by).min(side)),
        }
    }

    /// The least box of texels `by` times as coarse that covers this one.
    #[must_use]
    pub(super) fn coarser(&self, by: usize) -> Self {
        Extent { lo: self.lo.map(|lo| lo / by), hi: self.hi.map(|hi| hi.div_ceil(by)) }
    }

    /// The rows along x, as (y, z).
    pub(super) fn rows(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let Extent { lo, hi } = *self;
        (lo[2]..hi[2]).flat_map(move |z| (lo[1]..hi[1]).map(move |y| (y, z)))
    }

    /// As a region of a texture.
    pub(super) fn region(&self, texture: Texture) -> Region {
        Region { texture, min: self.lo.map(|i| i as u32), size: self.size().map(|i| i as u32) }
    }
}

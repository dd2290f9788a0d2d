//! An axis-aligned box of voxels.

use crate::volume::range::Range;
use crate::volume::range_maps::RowAddress;
use crate::volume::row::BitSet;

/// A box of voxels: its ranges along x, y and z. In an empty box all three are empty.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct VoxelBox([Range; 3]);

impl VoxelBox {
    /// The empty box.
    pub const EMPTY: Self = VoxelBox([Range::EMPTY; 3]);

    /// Creates the box of these ranges along x, y and z. It is empty if one of them is.
    #[must_use]
    pub const fn new(ranges: [Range; 3]) -> Self {
        let [x, y, z] = ranges;
        if x.is_empty() || y.is_empty() || z.is_empty() { Self::EMPTY } else { VoxelBox(ranges) }
    }

    /// Returns the smallest box around the voxels of row (y, z).
    pub(crate) fn around_row<R: BitSet>((y, z): RowAddress, voxels: R) -> Self {
        match (voxels.first(), voxels.last()) {
            (Some(first), Some(last)) => {
                VoxelBox([Range::new(first, last), Range::new(y, y), Range::new(z, z)])
            }
            _ => Self::EMPTY,
        }
    }

    /// Returns the ranges along x, y and z.
    #[must_use]
    pub const fn ranges(self) -> [Range; 3] {
        self.0
    }

    /// Returns `true` if no voxel is inside.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0[0].is_empty()
    }

    /// Returns the number of voxels inside.
    pub(crate) const fn count_voxels(self) -> usize {
        if self.is_empty() {
            return 0;
        }
        let [x, y, z] = self.0;
        (x.last() - x.first() + 1) * (y.last() - y.first() + 1) * (z.last() - z.first() + 1)
    }

    /// Returns the smallest box that contains both.
    #[must_use]
    #[inline]
    pub const fn hull_with(self, other: Self) -> Self {
        let ([x, y, z], [other_x, other_y, other_z]) = (self.0, other.0);
        VoxelBox([x.hull_with(other_x), y.hull_with(other_y), z.hull_with(other_z)])
    }
}

impl Default for VoxelBox {
    fn default() -> Self {
        Self::EMPTY
    }
}

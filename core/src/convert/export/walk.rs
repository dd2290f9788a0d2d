//! Traversal order of a streamed export, row by row: each layer's voxels before the cells that need
//! them.

use crate::volume::range_maps::RowAddress;

/// An axis-aligned box of integers; both ends are inside.
#[derive(Clone, Copy)]
pub(super) struct ClosedBounds {
    pub(super) lo: [i32; 3],
    pub(super) hi: [i32; 3],
}

impl ClosedBounds {
    /// The initial value: all zero bytes.
    pub(super) const ZERO: ClosedBounds = ClosedBounds { lo: [0; 3], hi: [0; 3] };

    /// The empty box.
    pub(super) const NONE: ClosedBounds = ClosedBounds { lo: [i32::MAX; 3], hi: [i32::MIN; 3] };

    pub(super) fn is_empty(&self) -> bool {
        self.lo[0] > self.hi[0]
    }

    /// Extends the box to include a coordinate along an axis.
    #[inline]
    pub(super) fn include_on_axis(&mut self, axis: usize, at: i32) {
        self.lo[axis] = self.lo[axis].min(at);
        self.hi[axis] = self.hi[axis].max(at);
    }

    /// Extends the box to include a point.
    #[inline]
    pub(super) fn include_point(&mut self, point: [i32; 3]) {
        for (axis, at) in point.into_iter().enumerate() {
            self.include_on_axis(axis, at);
        }
    }
}

/// A step of the traversal.
pub(super) enum WalkStep {
    /// Row (y, z) of voxels.
    Voxels(RowAddress),
    /// The cells between the layers y - 1 and y and the rows z - 1 and z. Follows the voxels of layer y, and
    /// of layer y + 1 if it has any.
    Cells(RowAddress),
}

/// The current position of the traversal.
pub(super) struct CellWalk {
    /// The layer of the current voxels; for cells, the layer above their slab.
    layer: u32,
    row: u32,
    in_cells: bool,
}

impl CellWalk {
    /// Creates a walk without a position; all zero bytes.
    pub(super) const fn new() -> Self {
        CellWalk { layer: 0, row: 0, in_cells: false }
    }

    /// Moves to the first row of voxels within the bounds, which must not be empty.
    pub(super) fn restart(&mut self, voxel_bounds: &ClosedBounds) {
        let [_, bottom, first] = voxel_bounds.lo;
        *self = CellWalk { layer: bottom as u32, row: first as u32, in_cells: false };
    }

    pub(super) fn current_step(&self) -> WalkStep {
        let (layer, row) = (self.layer as usize, self.row as usize);
        if self.in_cells {
            WalkStep::Cells((layer - 1, row))
        } else {
            WalkStep::Voxels((layer, row))
        }
    }

    /// Advances to the next step. Returns `false` after the last one.
    pub(super) fn advance_if_more(&mut self, voxel_bounds: &ClosedBounds) -> bool {
        let ClosedBounds { lo: [_, bottom, first], hi: [_, top, last] } = *voxel_bounds;
        self.row += 1;
        // There is one more row of cells than of voxels.
        if self.row <= last as u32 + u32::from(self.in_cells) {
            return true;
        }
        self.row = first as u32;
        if !self.in_cells && self.layer > bottom as u32 {
            self.in_cells = true;
            return true;
        }
        self.layer += 1;
        self.in_cells = self.layer > top as u32;
        self.layer <= top as u32 + 2
    }
}

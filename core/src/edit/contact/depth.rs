//! Depth of voxels in a bit.

use glam::{I64Vec3, IVec3};

use crate::edit::brush::voxel_centre_subunits;
use crate::edit::grid_bit::{GridBit, GridShape};
use crate::edit::pose::{Pose, SUBUNITS_PER_VOXEL};
use crate::volume::range_maps::RowAddress;
use crate::volume::row::BitSet;

/// Measures how deep voxels lie in a bit at a pose.
pub(super) struct DepthRuler<'a> {
    bit: &'a GridBit,
    position: I64Vec3,
    unit_axes_q14: [IVec3; 3],
}

impl<'a> DepthRuler<'a> {
    pub(super) fn new(bit: &'a GridBit, pose: &Pose) -> Self {
        let position = pose.clamped_position_subunits().as_i64vec3();
        DepthRuler { bit, position, unit_axes_q14: pose.unit_axes_q14() }
    }

    /// Returns the offset from the bit's centre to that of voxel x of a row, along the grid's axes, in
    /// subunits.
    pub(super) fn offset_of(&self, (x, (y, z)): (usize, RowAddress)) -> I64Vec3 {
        I64Vec3::from([x, y, z].map(voxel_centre_subunits)) - self.position
    }

    /// Returns the depth of the point at this offset, in subunits, rounded up; negative outside.
    pub(super) fn depth_at(&self, offset_from_bit: I64Vec3) -> i32 {
        self.bit.depth_subunits_at(&self.unit_axes_q14, offset_from_bit)
    }

    /// Returns the greatest depth of these voxels of a row, in subunits; 0 if there are none.
    #[inline]
    pub(super) fn deepest_of_row<R: BitSet>(&self, row: RowAddress, voxels: R) -> i32 {
        let depth = |x: usize| self.depth_at(self.offset_of((x, row)));
        match self.bit.shape {
            // Only the voxels nearest to the centre, one on each side.
            GridShape::Ball(_) => {
                let centre = self.position.x.div_euclid(SUBUNITS_PER_VOXEL.into());
                let up_to = match usize::try_from(centre) {
                    Ok(centre) => voxels & R::span(0, centre.min(64 * R::WORDS - 1)),
                    Err(_) => R::EMPTY,
                };
                let nearest = [up_to.last(), (voxels & !up_to).first()];
                nearest.into_iter().flatten().map(depth).max().unwrap_or(0)
            }
            GridShape::Box(_) | GridShape::Disc { .. } => {
                voxels.iter_ones().map(depth).max().unwrap_or(0)
            }
        }
    }
}

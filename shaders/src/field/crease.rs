//! Reopens what the blur closes: creases, and gaps one voxel wide.
//!
//! An empty voxel with a blurred density of a half or more lies between walls; smooth surfaces have
//! hardly any. Its density is mirrored at a half, so that the surface stays within a voxel of where
//! the walls meet.

use super::rows::{AtLeastHalfMasks, TexelRows};
use super::window::{BLUR_MARGIN, VoxelWindow};

/// Mirrors the texels of closed empty voxels at a half, in `row_count` rows of each of `slice_count`
/// slices. `row_bits` masks a row's voxels; `at_least_half` is updated.
pub(super) fn reopen_creases(
    window: &VoxelWindow,
    [row_count, slice_count]: [usize; 2],
    row_bits: u64,
    out: &mut TexelRows,
    at_least_half: &mut AtLeastHalfMasks,
) {
    for z in 0..slice_count {
        for y in 0..row_count {
            let mut closed =
                at_least_half[z][y] & row_bits & !window.row(y + BLUR_MARGIN, z + BLUR_MARGIN);
            at_least_half[z][y] &= !closed;
            let row = out[z][y].as_flattened_mut();
            while closed != 0 {
                let texel = &mut row[closed.trailing_zeros() as usize];
                *texel = !*texel;
                closed &= closed - 1;
            }
        }
    }
}

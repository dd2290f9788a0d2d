//! Opens what the blur closes: creases, and gaps of a voxel.
//!
//! Empty voxels that the blur leaves half full or more lie between walls; on what is smooth there
//! are none to speak of. They are told as far below a half as they came out above, so that the
//! surface stays within a voxel of where the walls meet.

use super::blur::{Halves, Rows};
use super::window::{BEFORE, Window};

/// Mirrors texels of so many rows along y and z, whose halves are told, about a half; `mask` has a
/// row's voxels.
pub(super) fn open(
    window: &Window,
    [rows, slices]: [usize; 2],
    mask: u64,
    out: &mut Rows,
    halves: &mut Halves,
) {
    for z in 0..slices {
        for y in 0..rows {
            let mut closed = halves[z][y] & mask & !window.row(y + BEFORE, z + BEFORE);
            halves[z][y] &= !closed;
            let row = out[z][y].as_flattened_mut();
            while closed != 0 {
                let texel = &mut row[closed.trailing_zeros() as usize];
                *texel = !*texel;
                closed &= closed - 1;
            }
        }
    }
}

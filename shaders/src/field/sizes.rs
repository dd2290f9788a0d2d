//! Sizes of the textures, and the meaning of their bytes.

/// Padding around the grid on each side, in texels, so that the surface at its border needs no
/// special case.
pub const PAD: usize = 4;
/// The least texel that counts as inside.
pub const HALF_DENSITY: u8 = 128;
/// Mip levels of the density.
pub const LEVELS: usize = crate::constants::DENSITY_LEVELS as usize;
/// The Chebyshev distance in cells at which distances are clamped, which bounds the cells that a
/// change can affect.
pub const MAX_CELL_DISTANCE: u8 = 7;
/// Radius of the texels that depend on a voxel, along each axis.
pub const REACH: usize = 3;

/// Texels along a side of a cell, for a volume of `grid_side` voxels a side: 68 cells a side at
/// 128, 66 at 256.
#[must_use]
pub const fn cell_side_texels(grid_side: usize) -> usize {
    if grid_side > 128 { 4 } else { 2 }
}

//! Textures that the fast path marches, derived from the range maps and updated incrementally within a
//! frame's budget. Takes range maps and the rectangles that changed, and hands out regions of bytes to
//! upload; knows nothing of their destination, of cameras, or of Vulkan.
//!
//! # Textures, for N voxels a side and K intervals a column
//! - [`Texture::Maps`]: the range maps noted by [`DensityField::note_dirty_columns`], as far as they were
//!   compared.
//! - [`Texture::Density`] 0: a cube of N + 8 texels, one for each voxel and [`PAD`] around the grid on
//!   every side. A byte, 255 where all is full: the mean of 5 x 5 x 5 voxels with the weights 1 4 6 4 1
//!   along each axis. Exactly: the weighted sum of a slice's 5 x 5 voxels, 256 where all are full, is
//!   clamped to 255; the weighted mean of five such sums is rounded half up. Below y = 0 the ground layer
//!   is repeated; everything else outside is empty. Creases that would close are reopened (see `crease`),
//!   and features too thin to reach a half are raised (see `thin`).
//! - [`Texture::Density`] 1 to 3: each texel the mean of 2 x 2 x 2 of the finer one, half up.
//! - [`Texture::Gradient`]: for each texel of level 1 the direction out of the stone, the negative gradient
//!   of that level: three signed bytes, 127 where the density falls by 254 in two texels; the fourth byte
//!   is the convexity. Two central differences are taken: a wide one, -1 -2 0 2 1 along its axis and 1 4 6
//!   4 1 along the others, and a narrow one, -1 0 1 and 1 14 1. Where they differ by 5 degrees or less the
//!   result is the wide one w, from 10 degrees on w + 1.5 (n - w), and between a mix, linear in the squared
//!   cosine. Sums along x and y drop three bits, those of the narrow one a bit; derivatives are rounded
//!   half up. Gradients may lag behind the density by some frames.
//! - [`Texture::Cells`]: a byte for each cell of 2 x 2 x 2 texels at N up to 128 and 4 x 4 x 4 above, so
//!   that cells have the same size in the room (see [`cell_side_texels`]). The surface of half density may
//!   pass through a cell if a texel in it or next to it is at least [`HALF_DENSITY`]. The byte is the
//!   Chebyshev distance to the nearest such cell, at most [`MAX_CELL_DISTANCE`], less one; 0 for such cells
//!   and their neighbours. From anywhere in the cell a ray can step that many cell sides, with no more than
//!   a multiply-add. While changes are pending the byte may be too small, never too large.
//!
//! [`FigureShares`] holds the hidden figure's share at each texel of the marble.
//!
//! A texel depends on the voxels at most [`REACH`] from it along each axis.
//!
//! Textures are stored, and handed out, with x fastest and z slowest, as a GPU has them.
//!
//! [`Texture::Maps`]: crate::upload::Texture::Maps
//! [`Texture::Density`]: crate::upload::Texture::Density
//! [`Texture::Gradient`]: crate::upload::Texture::Gradient
//! [`Texture::Cells`]: crate::upload::Texture::Cells

mod backlog;
mod blur;
mod budget;
mod cells;
mod convexity;
mod crease;
mod extent;
mod figure;
mod gradient;
mod gradient_upkeep;
mod mips;
mod rows;
mod sizes;
mod texels;
mod textures;
mod thin;
mod upkeep;
mod window;

pub use budget::{Budget, Cost};
pub use figure::FigureShares;
pub use sizes::{HALF_DENSITY, LEVELS, MAX_CELL_DISTANCE, PAD, REACH, cell_side_texels};
pub use textures::DensityField;

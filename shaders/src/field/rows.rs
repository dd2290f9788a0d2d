//! Size limits of a box of texels that is computed at once, and the row types of its buffers.

/// Texels of the largest box along each axis. Along x the box, with
/// [`MARGIN_X`](super::window::MARGIN_X) more on either side, fills a word; a multiple of 8. A
/// stroke of radius 6 changes 19 texels along y and z.
pub(super) const MAX_BOX: [usize; 3] = [56, 24, 24];

/// Most rows along y and z that are blurred: those of the box and one on either side.
pub(super) const BLURRED_ROWS: usize = MAX_BOX[1] + 2;
/// Texels of a row.
pub(super) const ROW_TEXELS: usize = 64;
/// Texels of a group that is computed at once: the bytes of a vector register.
pub(super) const LANES: usize = 16;

/// A row of texels, in groups.
pub(super) type TexelRow = [[u8; LANES]; ROW_TEXELS / LANES];

/// The rows of density around a box: by z, then y.
pub(super) type TexelRows = [[TexelRow; BLURRED_ROWS]; BLURRED_ROWS];
/// Bits of those texels that are at least a half: bit rows along x, by z, then y.
pub(super) type AtLeastHalfMasks = [[u64; BLURRED_ROWS]; BLURRED_ROWS];

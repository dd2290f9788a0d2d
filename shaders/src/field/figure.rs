//! The hidden figure's share of the stone. By this share the figure glows where it is bared.

use glam::Vec3;
use paros_core::RangeMaps;
use paros_core::volume::Axis;

use super::texels::TexelCube;

/// The hidden figure's share at each texel of a cube over the grid: the mean of its voxels, blurred with
/// the weights 1 2 1 along each axis. On a figure's flat face the share is a half, a texel above it an
/// eighth: a threshold between the two tells a bared figure from one that stone still covers.
#[derive(Debug)]
pub struct FigureShares {
    texels: TexelCube,
    is_empty: bool,
}

impl FigureShares {
    /// Texels along a side, at every size of the grid: as many as the marble's texture has.
    pub const SIDE: usize = crate::carrara::TEXTURE_SIDE;

    /// Creates the shares without a figure. Allocates all memory.
    #[must_use]
    #[allow(clippy::new_without_default)] // megabytes: to be made on purpose
    pub fn new() -> Self {
        FigureShares { texels: TexelCube::new(Self::SIDE, 0), is_empty: true }
    }

    /// Returns `true` if there is no figure.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.is_empty
    }

    /// Recomputes the shares for another figure.
    pub fn rebuild_from<const N: usize, const K: usize>(&mut self, figure: &RangeMaps<N, K>) {
        let was_empty = core::mem::replace(&mut self.is_empty, figure.is_empty());
        if was_empty && self.is_empty {
            return;
        }
        for (z, y) in (0..Self::SIDE).flat_map(|z| (0..Self::SIDE).map(move |y| (z, y))) {
            write_means(figure, [y, z], self.texels.row_mut(y, z));
        }
        let side = Self::SIDE;
        for stride in [1, side, side * side] {
            for start in (0..side * side * side).filter(|i| i / stride % side == 0) {
                blur_line(self.texels.bytes_mut(), start, stride);
            }
        }
    }

    /// Returns a trilinear sample at a point of the unit cube, 0 to 1, clamped to the edge.
    #[must_use]
    pub fn sample_clamped(&self, cube_point: Vec3) -> f32 {
        if self.is_empty {
            0.0
        } else {
            self.texels.sample_trilinear(cube_point * Self::SIDE as f32)
        }
    }

    /// Returns the texels, x fastest, z slowest; 255 where every voxel is the figure's.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        self.texels.bytes()
    }
}

/// Writes the means of a figure's voxels in a row of texels.
fn write_means<const N: usize, const K: usize>(
    figure: &RangeMaps<N, K>,
    [y, z]: [usize; 2],
    row: &mut [u8],
) {
    // Voxels along a side of a texel, and texels along a side of a voxel.
    let (fine, coarse) = ((N / FigureShares::SIDE).max(1), (FigureShares::SIDE / N).max(1));
    let mut counts = [0u16; FigureShares::SIDE];
    for (dy, dz) in (0..fine).flat_map(|dy| (0..fine).map(move |dz| (dy, dz))) {
        let voxel = [0, y * fine / coarse + dy, z * fine / coarse + dz];
        let column = figure.column(Axis::X, Axis::X.column_address(voxel));
        for range in column.intervals() {
            for x in range.first()..=range.last() {
                let texels = &mut counts[x * coarse / fine..][..coarse];
                texels.iter_mut().for_each(|count| *count += 1);
            }
        }
    }
    for (texel, count) in row.iter_mut().zip(counts) {
        *texel = (usize::from(count) * 255 / (fine * fine * fine)) as u8;
    }
}

/// Blurs a line of texels in place, `stride` bytes apart. Beyond its ends the end texels are repeated.
fn blur_line(bytes: &mut [u8], start: usize, stride: usize) {
    let mut before = u16::from(bytes[start]);
    for i in 0..FigureShares::SIDE {
        let at = start + i * stride;
        let here = u16::from(bytes[at]);
        let after = if i + 1 < FigureShares::SIDE { bytes[at + stride].into() } else { here };
        bytes[at] = ((before + 2 * here + after + 2) / 4) as u8;
        before = here;
    }
}

//! Active cells of a row, which the surface passes through, found a machine word at a time.

use super::cases::CASES;
use crate::volume::row::BitSet;

/// The four rows of voxels at the corners of a row of cells along x, indexed by y, then by z.
pub(super) type CornerRows<R> = [[R; 2]; 2];

/// A cell that the surface passes through.
pub(super) struct SurfaceCell {
    /// Its index in the row: cell x lies between the voxels x - 1 and x.
    pub(super) x: usize,
    /// Its index in [`CASES`].
    pub(super) case: usize,
}

/// Visits every cell of the row whose corners are neither all solid nor all empty. Everything outside the
/// rows is empty.
#[inline(always)]
pub(super) fn visit_surface_cells<R: BitSet>(
    rows: &CornerRows<R>,
    mut visit: impl FnMut(SurfaceCell),
) {
    // 64 voxels bound 63 cells. Corners are in the order of the case's bits: y first, then z.
    for chunk in 0..=R::WORDS {
        let corners = [
            chunk_from_voxel_before(&rows[0][0], chunk),
            chunk_from_voxel_before(&rows[1][0], chunk),
            chunk_from_voxel_before(&rows[0][1], chunk),
            chunk_from_voxel_before(&rows[1][1], chunk),
        ];
        let any = corners[0] | corners[1] | corners[2] | corners[3];
        let all = corners[0] & corners[1] & corners[2] & corners[3];
        let mut left = (any | any >> 1) & !(all & all >> 1) & (!0 >> 1);
        while left != 0 {
            let cell = left.trailing_zeros();
            left &= left - 1;
            let ends = |edge: usize| (corners[edge] >> cell & 3) << (2 * edge);
            visit(SurfaceCell {
                x: CHUNK * chunk + cell as usize,
                case: (ends(0) | ends(1) | ends(2) | ends(3)) as usize,
            });
        }
    }
}

/// Number of cells in a chunk.
const CHUNK: usize = 63;

/// Returns the voxels around the cells of a chunk: bit 0 is voxel `CHUNK * chunk - 1`.
#[inline(always)]
fn chunk_from_voxel_before<R: BitSet>(row: &R, chunk: usize) -> u64 {
    let low = if chunk > 0 { row.word(chunk - 1) >> (CHUNK - chunk) } else { 0 };
    let high = if chunk < R::WORDS { row.word(chunk) << (chunk + 1) } else { 0 };
    low | high
}

/// Returns the number of triangles in a row of cells.
pub(super) fn count_triangles<R: BitSet>(rows: &CornerRows<R>) -> u32 {
    let mut count = 0;
    visit_surface_cells(rows, |cell| count += u32::from(CASES[cell.case].count));
    count
}

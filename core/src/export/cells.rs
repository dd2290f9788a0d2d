//! Walks the cells of a row that the surface passes through, found a machine word at a time.

use super::cases::CASES;
use crate::row::Bits;

/// The rows of voxels at the edges of a row of cells along x: by z, within y.
pub(super) type Edges<R> = [[R; 2]; 2];

/// Calls `each` with every cell of the row whose corners are neither all solid nor all empty, and
/// its case. Cell c lies between the voxels c - 1 and c; outside the rows all is empty.
#[inline(always)]
pub(super) fn each_cell<R: Bits>(edges: &Edges<R>, mut each: impl FnMut(usize, usize)) {
    // 64 voxels bound 63 cells. In the order of the case's bits: y first, then z.
    for chunk in 0..=R::WORDS {
        let corners = [
            voxels(&edges[0][0], chunk),
            voxels(&edges[1][0], chunk),
            voxels(&edges[0][1], chunk),
            voxels(&edges[1][1], chunk),
        ];
        let any = corners[0] | corners[1] | corners[2] | corners[3];
        let all = corners[0] & corners[1] & corners[2] & corners[3];
        let mut left = (any | any >> 1) & !(all & all >> 1) & (!0 >> 1);
        while left != 0 {
            let cell = left.trailing_zeros();
            left &= left - 1;
            let ends = |edge: usize| (corners[edge] >> cell & 3) << (2 * edge);
            each(CHUNK * chunk + cell as usize, (ends(0) | ends(1) | ends(2) | ends(3)) as usize);
        }
    }
}

const CHUNK: usize = 63;

/// The voxels around the cells of a chunk: bit 0 is voxel `CHUNK * chunk - 1`.
#[inline(always)]
fn voxels<R: Bits>(row: &R, chunk: usize) -> u64 {
    let low = if chunk > 0 { row.word(chunk - 1) >> (CHUNK - chunk) } else { 0 };
    let high = if chunk < R::WORDS { row.word(chunk) << (chunk + 1) } else { 0 };
    low | high
}

/// The number of triangles in a row of cells.
pub(super) fn count<R: Bits>(edges: &Edges<R>) -> u32 {
    let mut count = 0;
    each_cell(edges, |_, case| count += u32::from(CASES[case].count));
    count
}

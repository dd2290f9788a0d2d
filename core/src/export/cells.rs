//! Walks the cells of a row that the surface passes through, found a machine word at a time.

use super::cases::CASES;
use crate::row::Bits;

/// The rows of voxels at the edges of a row of cells along x: by z, within y.
pub(super) type Edges<R> = [[R; 2]; 2];

/// Calls `each` with every cell of the row whose corners are neither all solid nor all empty, and
/// its case. Cell c lies between the voxels c - 1 and c; outside the rows all is empty.
#[inline(always)]
pub(super) fn each_cell<R: Bits>(edges: &Edges<R>, mut each: impl FnMut(usize, usize)) {
    // By case bit: low and high end of x, then y, then z.
    let mut corners = [0; 8];
    for w in 0..=R::WORDS {
        for (edge, corners) in corners.chunks_exact_mut(2).enumerate() {
            let row = &edges[edge & 1][edge >> 1];
            let carry = corners[1] >> 63;
            corners[1] = if w < R::WORDS { row.word(w) } else { 0 };
            corners[0] = corners[1] << 1 | carry;
        }
        let any = corners.iter().fold(0, |any, c| any | c);
        let all = corners.iter().fold(!0, |all, c| all & c);
        let mut left = any & !all;
        while left != 0 {
            let bit = left.trailing_zeros();
            left &= left - 1;
            let case = (0..8).fold(0, |case, c| case | (corners[c] >> bit & 1) << c);
            each(w * 64 + bit as usize, case as usize);
        }
    }
}

/// The number of triangles in a row of cells.
pub(super) fn count<R: Bits>(edges: &Edges<R>) -> u32 {
    let mut count = 0;
    each_cell(edges, |_, case| count += u32::from(CASES[case].count));
    count
}

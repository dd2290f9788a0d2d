//! Binary morphology on bit rows: erosion and dilation by six-neighbour steps.
//!
//! Each function computes the voxels `among` of a row of a [`RowStrip`]. These must be farther than the
//! neighbourhood's reach from an end of the strip, unless the strip ends with the grid, as the words beyond
//! aren't read.

use crate::limits::SHELL_DEPTH;
use crate::volume::bit_grid::RowStrip;
use crate::volume::range_maps::RowAddress;
use crate::volume::row::{BitRow, BitSet};
use crate::volume::size::{Grid, Size};

/// Erosion: returns the voxels `among` of row (y, z) that have no empty voxel within `depth` six-neighbour
/// steps. Everything outside the grid is empty. `depth` is at most [`SHELL_DEPTH`].
///
/// A row at distance d in (y, z) contributes its own erosion along x by `depth - d`. Rows of equal
/// distance are combined first, so each step along x is done once for all of them.
#[must_use]
#[inline]
pub(crate) fn eroded_row<const N: usize, const W: usize>(
    rows: RowStrip<'_, N, W>,
    (y, z): RowAddress,
    depth: usize,
    among: BitRow<W>,
) -> BitRow<W>
where
    Grid<N>: Size,
{
    match depth {
        0 => among & rows.row(y, z),
        1 => erode_by::<N, W, 1>(rows, (y, z), among),
        2 => erode_by::<N, W, 2>(rows, (y, z), among),
        3 => erode_by::<N, W, 3>(rows, (y, z), among),
        _ => erode_by::<N, W, SHELL_DEPTH>(rows, (y, z), among),
    }
}

/// Erodes row (y, z) by a constant depth, so that the loops unroll.
///
/// The row's own erosion along x comes first: beside a slot across x, where a blade works, it often leaves no
/// voxels, which ends the work early.
#[inline(never)] // the compiler makes a mess of the loops that it would be inlined into
fn erode_by<const N: usize, const W: usize, const DEPTH: usize>(
    rows: RowStrip<'_, N, W>,
    (y, z): RowAddress,
    among: BitRow<W>,
) -> BitRow<W>
where
    Grid<N>: Size,
{
    if y < DEPTH || z < DEPTH || y >= N - DEPTH || z >= N - DEPTH {
        return BitRow::EMPTY;
    }
    let mut own = rows.row(y, z);
    for _ in 0..DEPTH {
        own = own & own.shifted_up() & own.shifted_down();
    }
    let among = among & own;
    if among.is_empty() {
        return among;
    }
    let mut row = !BitRow::EMPTY;
    for away in 1..=DEPTH {
        if away > 1 {
            row = row & row.shifted_up() & row.shifted_down();
        }
        for i in 0..away {
            let j = away - i;
            row &= rows.row(y - i, z - j);
            row &= rows.row(y + i, z + j);
            row &= rows.row(y - j, z + i);
            row &= rows.row(y + j, z - i);
        }
    }
    row & among
}

/// Dilation: returns the voxels `among` of row (y, z) that have an occupied voxel, or the ground below y = 0,
/// within `depth` six-neighbour steps. Computed like [`eroded_row`].
#[must_use]
pub(crate) fn dilated_row_with_ground<const N: usize, const W: usize>(
    rows: RowStrip<'_, N, W>,
    (y, z): RowAddress,
    depth: usize,
    among: BitRow<W>,
) -> BitRow<W>
where
    Grid<N>: Size,
{
    if y < depth {
        return among;
    }
    let at = |y: usize, z: usize| match y < N && z < N {
        true => rows.row(y, z),
        false => BitRow::EMPTY,
    };
    let mut row = rows.row(y, z);
    for away in 1..=depth {
        row = row | row.shifted_up() | row.shifted_down();
        for i in 0..away {
            let j = away - i;
            row |= at(y - i, z.wrapping_sub(j)) | at(y + i, z + j);
            row |= at(y - j, z + i) | at(y + j, z.wrapping_sub(i));
        }
    }
    row & among
}

//! Neighbourhoods of a bit row: the shell that an edit may reach, and the majority of 3 x 3 x 3.
//!
//! They are asked about voxels `among` a row of a [`Strip`]: as far from an end of the strip that
//! lies within the grid as the neighbourhood reaches, since beyond it nothing is seen.

use crate::limits::SHELL_DEPTH;
use crate::plane::Strip;
use crate::row::{Bits, Row};
use crate::size::{Grid, Size};

/// Of the voxels `among` of a row, those with no empty voxel within `depth` six-neighbour steps;
/// outside the grid counts as empty. `depth` up to [`SHELL_DEPTH`].
///
/// A row so many steps away in y and z counts with what it leaves of the depth along x. Rows as far
/// away meet first, and a step along x is taken for all of them at once on the way out.
#[must_use]
#[inline]
pub fn deep<const N: usize, const W: usize>(
    rows: Strip<'_, N, W>,
    (y, z): (usize, usize),
    depth: usize,
    among: Row<W>,
) -> Row<W>
where
    Grid<N>: Size,
{
    among
        & match depth {
            0 => rows.row(y, z),
            1 => eroded::<N, W, 1>(rows, (y, z)),
            2 => eroded::<N, W, 2>(rows, (y, z)),
            3 => eroded::<N, W, 3>(rows, (y, z)),
            _ => eroded::<N, W, SHELL_DEPTH>(rows, (y, z)),
        }
}

/// The depth is a constant so that its loops unroll.
#[inline(never)] // the compiler makes a mess of the loops that it would be inlined into
fn eroded<const N: usize, const W: usize, const DEPTH: usize>(
    rows: Strip<'_, N, W>,
    (y, z): (usize, usize),
) -> Row<W>
where
    Grid<N>: Size,
{
    if y < DEPTH || z < DEPTH || y >= N - DEPTH || z >= N - DEPTH {
        return Row::EMPTY;
    }
    let mut row = rows.row(y, z);
    for away in 1..=DEPTH {
        row = row & row.up() & row.down();
        for i in 0..away {
            let j = away - i;
            row &= rows.row(y - i, z - j);
            row &= rows.row(y + i, z + j);
            row &= rows.row(y - j, z + i);
            row &= rows.row(y + j, z - i);
        }
    }
    row
}

/// Of the voxels `among` of a row, those with an occupied voxel, or the ground under y = 0, within
/// `depth` six-neighbour steps. Rows are taken as in [`deep`].
#[must_use]
pub fn near<const N: usize, const W: usize>(
    rows: Strip<'_, N, W>,
    (y, z): (usize, usize),
    depth: usize,
    among: Row<W>,
) -> Row<W>
where
    Grid<N>: Size,
{
    if y < depth {
        return among;
    }
    let at = |y: usize, z: usize| match y < N && z < N {
        true => rows.row(y, z),
        false => Row::EMPTY,
    };
    let mut row = rows.row(y, z);
    for away in 1..=depth {
        row = row | row.up() | row.down();
        for i in 0..away {
            let j = away - i;
            row |= at(y - i, z.wrapping_sub(j)) | at(y + i, z + j);
            row |= at(y - j, z + i) | at(y + j, z.wrapping_sub(i));
        }
    }
    row & among
}

/// Of the voxels `among` of a row, those whose 3 x 3 x 3 neighbourhood is mostly (14 of 27)
/// occupied. Below y = 0 counts as occupied, elsewhere outside as empty. Counts in bit planes, a
/// row at a time.
#[must_use]
pub fn majority<const N: usize, const W: usize>(
    rows: Strip<'_, N, W>,
    (y, z): (usize, usize),
    among: Row<W>,
) -> Row<W>
where
    Grid<N>: Size,
{
    let mut count = [Row::EMPTY; 5];
    for i in 0..3 {
        for j in 0..3 {
            let (y, z) = ((y + i).wrapping_sub(1), (z + j).wrapping_sub(1));
            if y == usize::MAX {
                add(&mut count, !Row::EMPTY, 0);
                add(&mut count, !Row::EMPTY, 1);
            } else if y < N && z < N {
                let row = rows.row(y, z);
                let (up, down) = (row.up(), row.down());
                let odd = row ^ up ^ down;
                add(&mut count, odd, 0);
                add(&mut count, row & up | row & down | up & down, 1);
            }
        }
    }
    (count[4] | count[3] & count[2] & count[1]) & among
}

/// Adds a row to counters held as bit planes, at the plane of weight `2^place`.
fn add<R: Bits>(count: &mut [R; 5], mut row: R, place: usize) {
    for plane in &mut count[place..] {
        let carry = *plane & row;
        *plane ^= row;
        row = carry;
    }
}

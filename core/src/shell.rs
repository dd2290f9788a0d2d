//! Neighbourhoods of a bit row: the shell that an edit may reach, and the majority of 3 x 3 x 3.

use crate::plane::Plane;
use crate::row::Bits;
use crate::size::{Grid, Size};

/// Of the voxels `among` of a row, those with no empty voxel within `depth` six-neighbour steps;
/// outside the grid counts as empty. The steps form an octahedron: row (y + i, z + j) is eroded
/// along x by what i and j leave of the depth.
#[must_use]
pub fn deep<const N: usize>(
    rows: &Plane<N>,
    (y, z): (usize, usize),
    depth: usize,
    mut among: <Grid<N> as Size>::Row,
) -> <Grid<N> as Size>::Row
where
    Grid<N>: Size,
{
    if y < depth || z < depth || y + depth >= N || z + depth >= N {
        return <Grid<N> as Size>::Row::EMPTY;
    }
    for (i, j, left) in octahedron(depth) {
        let mut row = rows.row(y + i - depth, z + j - depth);
        for _ in 0..left {
            row = row & row.up() & row.down();
        }
        among &= row;
        if among.is_empty() {
            break;
        }
    }
    among
}

/// Of the voxels `among` of a row, those with an occupied voxel, or the ground under y = 0, within
/// `depth` six-neighbour steps.
#[must_use]
pub fn near<const N: usize>(
    rows: &Plane<N>,
    (y, z): (usize, usize),
    depth: usize,
    among: <Grid<N> as Size>::Row,
) -> <Grid<N> as Size>::Row
where
    Grid<N>: Size,
{
    if y < depth {
        return among;
    }
    let mut found = <Grid<N> as Size>::Row::EMPTY;
    for (i, j, left) in octahedron(depth) {
        let (y, z) = (y + i - depth, (z + j).wrapping_sub(depth));
        if y >= N || z >= N {
            continue;
        }
        let mut row = rows.row(y, z);
        for _ in 0..left {
            row = row | row.up() | row.down();
        }
        found |= row;
    }
    found & among
}

/// The voxels of a row whose 3 x 3 x 3 neighbourhood is mostly (14 of 27) occupied. Below y = 0
/// counts as occupied, elsewhere outside as empty. Counts in bit planes, a row at a time.
#[must_use]
pub fn majority<const N: usize>(
    rows: &Plane<N>,
    (y, z): (usize, usize),
) -> <Grid<N> as Size>::Row
where
    Grid<N>: Size,
{
    let mut count = [<Grid<N> as Size>::Row::EMPTY; 5];
    for i in 0..3 {
        for j in 0..3 {
            let (y, z) = ((y + i).wrapping_sub(1), (z + j).wrapping_sub(1));
            if y == usize::MAX {
                add(&mut count, Grid::<N>::FULL, 0);
                add(&mut count, Grid::<N>::FULL, 1);
            } else if y < N && z < N {
                let row = rows.row(y, z);
                let (up, down) = (row.up(), row.down());
                let odd = row ^ up ^ down;
                add(&mut count, odd, 0);
                add(&mut count, row & up | row & down | up & down, 1);
            }
        }
    }
    (count[4] | count[3] & count[2] & count[1]) & Grid::<N>::FULL
}

/// Adds a row to counters held as bit planes, at the plane of weight `2^place`.
fn add<R: Bits>(count: &mut [R; 5], mut row: R, place: usize) {
    for plane in &mut count[place..] {
        let carry = *plane & row;
        *plane ^= row;
        row = carry;
    }
}

/// The rows of an octahedron of radius `depth`: offsets in y and z from its corner, and the steps
/// left for x.
fn octahedron(depth: usize) -> impl Iterator<Item = (usize, usize, usize)> {
    let side = 2 * depth + 1;
    (0..side * side).filter_map(move |k| {
        let (i, j) = (k / side, k % side);
        let used = i.abs_diff(depth) + j.abs_diff(depth);
        (used <= depth).then(|| (i, j, depth - used))
    })
}

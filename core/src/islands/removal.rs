//! The end of a pass: what wasn't reached goes, at the cost of the rows and columns it lay in.

use super::bytes::keyed;
use super::{IslandReport, Islands};
use crate::maps::{Axis, Column, Range};
use crate::row::Bits;
use crate::size::{Grid, Size};
use crate::volume::{Journal, Volume};

impl<const N: usize> Islands<N>
where
    Grid<N>: Size,
{
    /// The volume becomes the closure of what is reached of it. Nothing is queued, so the open rows
    /// are all those that lose voxels.
    pub(super) fn remove(
        &mut self,
        volume: &mut Volume<N>,
        journal: &mut impl Journal<N>,
    ) -> IslandReport {
        let mut along_y = [<Grid<N> as Size>::Row::EMPTY; N];
        let mut missed = 0;
        for y in 0..N {
            let mut along_z = <Grid<N> as Size>::Row::EMPTY;
            for z in self.open[y].ones() {
                let (here, reached) = (volume.rows().row(y, z), self.reached.row(y, z));
                let islands = here & !reached;
                if islands.is_empty() {
                    self.open[y].toggle(z);
                    continue;
                }
                missed += islands.count();
                along_y[z] |= islands;
                along_z |= islands;
                let range = Range::hull(here & reached);
                volume.set_column(Axis::X, (y, z), Column([range]), journal);
            }
            self.tighten_line(volume, Axis::Z, y, along_z, journal);
        }
        if missed == 0 {
            self.kept_sum = 0;
            return IslandReport::default();
        }
        for (z, columns) in along_y.into_iter().enumerate() {
            self.tighten_line(volume, Axis::Y, z, columns, journal);
        }
        let (kept, kept_sum) = self.close(volume, missed);
        let known = kept_sum == self.kept_sum;
        self.kept_sum = kept_sum;
        let removed = missed - kept;
        IslandReport { removed, kept: if known { 0 } else { kept }, unsupported: false }
    }

    /// Tightens columns of a line to what is reached of them.
    fn tighten_line(
        &self,
        volume: &mut Volume<N>,
        axis: Axis,
        line: usize,
        columns: <Grid<N> as Size>::Row,
        journal: &mut impl Journal<N>,
    ) {
        if columns.is_empty() {
            return;
        }
        let mut within = Range::EMPTY;
        for place in columns.ones() {
            within = within.hull_with(volume.maps().column(axis, (line, place)).hull());
        }
        let reached = |i| {
            let (y, z) = if axis == Axis::Y { (i, line) } else { (line, i) };
            volume.rows().row(y, z) & self.reached.row(y, z)
        };
        let (mut lo, mut hi) = ([0; N], [0; N]);
        let empty = first_in(columns, within.lo()..=within.hi(), reached, &mut lo);
        let rest = columns & !empty;
        first_in(rest, (within.lo()..=within.hi()).rev(), reached, &mut hi);
        for place in empty.ones() {
            volume.set_column(axis, (line, place), Column::EMPTY, journal);
        }
        for place in rest.ones() {
            let range = Range::new(lo[place].into(), hi[place].into());
            volume.set_column(axis, (line, place), Column([range]), journal);
        }
    }

    /// Makes the rows follow the maps. Counts the voxels that closure keeps, and sums them up.
    fn close(&mut self, volume: &mut Volume<N>, missed: u32) -> (u32, u64) {
        // Voxel by voxel for few, all columns at once for many.
        let many = missed as usize > 4 * N * N;
        if many {
            volume.restore_rows();
        }
        let (mut kept, mut sum) = (0, 0u64);
        for y in 0..N {
            for z in self.open[y].ones() {
                let (here, reached) = (volume.rows().row(y, z), self.reached.row(y, z));
                let mut closed = here & !reached;
                if !many {
                    closed = volume.maps().row_among((y, z), closed);
                    *volume.rows_mut().row_mut(y, z) = here & reached | closed;
                }
                kept += closed.count();
                sum = sum.wrapping_add(keyed(y, z, closed));
            }
        }
        (kept, sum)
    }
}

/// Walks rows in the order given and notes where each of `columns` is first set. Returns those
/// that nowhere are.
#[inline]
fn first_in<R: Bits, const N: usize>(
    mut columns: R,
    order: impl Iterator<Item = usize>,
    row: impl Fn(usize) -> R,
    found_at: &mut [u8; N],
) -> R {
    for i in order {
        if columns.is_empty() {
            break;
        }
        let found = columns & row(i);
        for place in found.ones() {
            found_at[place] = i as u8;
        }
        columns &= !found;
    }
    columns
}

//! The end of an island pass: removal of the unreached voxels, in time proportional to the rows and
//! columns that hold them.

use super::bytes::hash_row;
use super::{IslandReport, IslandSearch};
use crate::volume::closing_line::{ClosingLine, find_gapped};
use crate::volume::editable::Volume;
use crate::volume::journal::Journal;
use crate::volume::range::Range;
use crate::volume::range_maps::{Axis, Column, ColumnsBeyond};
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};

/// The columns of a line of N that contain voxels of islands.
#[derive(Clone, Copy)]
struct IslandLine<R> {
    /// The columns.
    columns: R,
    /// The positions along the columns of the first and the last row with islands.
    first: usize,
    last: usize,
}

impl<R: BitSet> IslandLine<R> {
    const NOWHERE: Self = IslandLine { columns: R::EMPTY, first: 0, last: 0 };

    /// Adds a row of islands. Rows must come in ascending order of their position along the columns.
    #[inline]
    fn add_row(&mut self, columns: R, position: usize) {
        if self.columns.is_empty() {
            self.first = position;
        }
        self.last = position;
        self.columns |= columns;
    }
}

impl<const N: usize> IslandSearch<N>
where
    Grid<N>: Size,
{
    /// Sets the volume to the closure of its reached voxels. As the queue is empty, all rows that lose voxels
    /// are open.
    pub(super) fn remove_islands<const K: usize>(
        &mut self,
        volume: &mut Volume<N, K>,
        journal: &mut dyn Journal<N, K>,
    ) -> IslandReport {
        let mut along_y = [IslandLine::NOWHERE; N];
        let (mut missed, mut doubtful) = (0, 0);
        for y in 0..N {
            if self.open[y].is_empty() {
                continue;
            }
            let mut along_z = IslandLine::NOWHERE;
            missed += self.tighten_rows_counting_unreached(
                volume,
                y,
                &mut along_z,
                &mut along_y,
                journal,
            );
            let rest = self.tighten_line_returning_nonempty(volume, Axis::Z, y, &along_z, journal);
            doubtful += self.remove_unreached_counting_doubtful(volume, y, rest);
        }
        if missed == 0 {
            self.kept_sum = 0;
            return IslandReport::default();
        }
        let mut rests = [<Grid<N> as Size>::Row::EMPTY; N];
        for (z, (line, rest)) in along_y.iter().zip(&mut rests).enumerate() {
            *rest = self.tighten_line_returning_nonempty(volume, Axis::Y, z, line, journal);
        }
        let KeptVoxels { count: kept, hash } = self.close_in_open_rows(volume, &rests, doubtful);
        let known = hash == self.kept_sum;
        self.kept_sum = hash;
        let removed = missed - kept;
        IslandReport { removed, kept: if known { 0 } else { kept }, unsupported: false }
    }

    /// Tightens the columns along x of layer `y` and notes which columns along y and z lose voxels. Rows
    /// without reached voxels are emptied at once; of the others, only rows with islands stay open. Returns
    /// the number of unreached voxels.
    fn tighten_rows_counting_unreached<const K: usize>(
        &mut self,
        volume: &mut Volume<N, K>,
        y: usize,
        along_z: &mut IslandLine<<Grid<N> as Size>::Row>,
        along_y: &mut [IslandLine<<Grid<N> as Size>::Row>; N],
        journal: &mut dyn Journal<N, K>,
    ) -> u32 {
        let mut new = [Column::EMPTY; N];
        let mut changed = <Grid<N> as Size>::Row::EMPTY;
        let (mut missed, mut count) = ([changed; N], 0);
        for z in self.open[y].iter_ones() {
            let (here, reached) = (volume.rows().row(y, z), self.reached.row(y, z));
            let islands = here & !reached;
            if islands.is_empty() {
                self.open[y].toggle(z);
                continue;
            }
            missed[count] = islands;
            count += 1;
            along_z.add_row(islands, z);
            along_y[z].add_row(islands, y);
            let left = here & reached;
            if left.is_empty() {
                self.open[y].toggle(z);
                *volume.rows_mut().row_mut(y, z) = left;
                changed.insert(z);
            } else {
                let before = volume.maps().column(Axis::X, (y, z));
                new[z] = Column::closed_over(left, &before);
                changed.insert_if(new[z] != before, z);
            }
        }
        volume.replace_columns(Axis::X, y, changed, &new, journal);
        // Stored contiguously, so that the count vectorises.
        missed[..count].iter().map(BitSet::count_ones).sum()
    }

    /// Tightens columns of a line to their reached voxels. Returns the columns that aren't empty afterwards.
    ///
    /// A range end outside the rows of the islands doesn't move; the others are searched for, N columns at a
    /// time.
    fn tighten_line_returning_nonempty<const K: usize>(
        &self,
        volume: &mut Volume<N, K>,
        axis: Axis,
        line: usize,
        &IslandLine { columns, first, last }: &IslandLine<<Grid<N> as Size>::Row>,
        journal: &mut dyn Journal<N, K>,
    ) -> <Grid<N> as Size>::Row {
        if columns.is_empty() {
            return columns;
        }
        let reached = |i| {
            let (y, z) = if axis == Axis::Y { (i, line) } else { (line, i) };
            volume.rows().row(y, z) & self.reached.row(y, z)
        };
        let ColumnsBeyond { below_first: below, above_last: above } =
            volume.maps().columns_beyond(axis, line, columns, first, last);
        let before = volume.maps().line(axis, line);
        let mut new = *before;
        let within = columns & !below & !above;
        let EndScan { empty, mut changed } =
            move_range_ends(within, first..=last, reached, &mut new, Column::set_hull_first);
        let rest = columns & !empty;
        let on = first..=N - 1;
        changed |= empty
            | move_range_ends(above & !below, on, reached, &mut new, Column::set_hull_first)
                .changed;
        let back = (0..=last).rev();
        changed |=
            move_range_ends(rest & !above, back, reached, &mut new, Column::set_hull_last).changed;
        for run in empty.iter_runs_within_words() {
            new[run.first()..=run.last()].fill(Column::EMPTY);
        }
        let (rows, gapped) = (Range::new(first, last), find_gapped(before, rest));
        changed |= ClosingLine { before, after: &mut new, changed: rows, removed_only: true }
            .close_gaps::<N, _>(rest, gapped, reached);
        volume.replace_columns(axis, line, changed, &new, journal);
        rest
    }

    /// Removes the unreached voxels of layer `y`, except in rows where closure may keep some, because the
    /// ranges along x and z still cover them. Only those rows stay open. Returns the number of such voxels.
    fn remove_unreached_counting_doubtful<const K: usize>(
        &mut self,
        volume: &mut Volume<N, K>,
        y: usize,
        nonempty_along_z: <Grid<N> as Size>::Row,
    ) -> usize {
        let mut doubtful = 0;
        for z in self.open[y].iter_ones() {
            let (here, reached) = (volume.rows().row(y, z), self.reached.row(y, z));
            let along_x = volume.maps().column(Axis::X, (y, z)).to_row();
            let held = here & !reached & nonempty_along_z & along_x;
            if held.is_empty() {
                self.open[y].toggle(z);
                *volume.rows_mut().row_mut(y, z) = here & reached;
            } else {
                doubtful += held.count_ones() as usize;
            }
        }
        doubtful
    }

    /// Updates the open rows from the maps. Returns the unreached voxels that closure keeps.
    /// `nonempty_along_y` is indexed by z; `doubtful_voxels` is the maximum number of such voxels.
    fn close_in_open_rows<const K: usize>(
        &mut self,
        volume: &mut Volume<N, K>,
        nonempty_along_y: &[<Grid<N> as Size>::Row; N],
        doubtful_voxels: usize,
    ) -> KeptVoxels {
        // Few voxels are updated one by one, many by whole lines.
        let many = doubtful_voxels > 4 * N * N;
        if many {
            volume.rebuild_rows();
        }
        let (mut kept, mut sum) = (0, 0u64);
        for y in 0..N {
            for z in self.open[y].iter_ones() {
                let (here, reached) = (volume.rows().row(y, z), self.reached.row(y, z));
                let mut closed = here & !reached;
                if !many {
                    closed = volume.maps().occupied_among((y, z), closed & nonempty_along_y[z]);
                    *volume.rows_mut().row_mut(y, z) = here & reached | closed;
                }
                kept += closed.count_ones();
                sum = sum.wrapping_add(hash_row((y, z), closed));
            }
        }
        // High bits of several words may cancel: only the empty set may have the empty set's hash.
        if kept != 0 && sum == 0 {
            sum = 1;
        }
        KeptVoxels { count: kept, hash: sum }
    }
}

/// Unreached voxels that closure keeps.
struct KeptVoxels {
    count: u32,
    /// Their linear hash; 0 only if there are none.
    hash: u64,
}

/// The result of a scan for range ends.
struct EndScan<R> {
    /// Columns without a voxel in any row.
    empty: R,
    /// Columns whose range changed.
    changed: R,
}

/// Scans rows in the given order of positions along the columns and moves one end of each column's range to
/// the first row in which the column is set. `set_end` moves that end.
#[inline]
fn move_range_ends<R: BitSet, const N: usize, const K: usize>(
    mut columns: R,
    positions: impl Iterator<Item = usize>,
    row_at: impl Fn(usize) -> R,
    line: &mut [Column<K>; N],
    set_end: impl Fn(&mut Column<K>, usize),
) -> EndScan<R> {
    let mut changed = R::EMPTY;
    for position in positions {
        if columns.is_empty() {
            break;
        }
        let found = columns & row_at(position);
        if !found.is_empty() {
            for place in found.iter_ones() {
                let before = line[place];
                set_end(&mut line[place], position);
                changed.insert_if(line[place] != before, place);
            }
            columns &= !found;
        }
    }
    EndScan { empty: columns, changed }
}

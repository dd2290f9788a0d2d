//! The end of a pass: what wasn't reached goes, at the cost of the rows and columns it lay in.

use super::bytes::keyed;
use super::{IslandReport, Islands};
use crate::maps::{Axis, Column, Range};
use crate::row::Bits;
use crate::size::{Grid, Size};
use crate::volume::{Journal, Volume};

/// A line of N columns that islands lay in.
#[derive(Clone, Copy)]
struct Touched<R> {
    /// The columns.
    columns: R,
    /// Along the columns, the first row of islands and the last.
    first: usize,
    last: usize,
}

impl<R: Bits> Touched<R> {
    const NOWHERE: Self = Touched { columns: R::EMPTY, first: 0, last: 0 };

    /// Rows come in their order along the columns.
    #[inline]
    fn add(&mut self, columns: R, place: usize) {
        if self.columns.is_empty() {
            self.first = place;
        }
        self.last = place;
        self.columns |= columns;
    }
}

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
        let mut along_y = [Touched::NOWHERE; N];
        let (mut missed, mut doubtful) = (0, 0);
        for y in 0..N {
            if self.open[y].is_empty() {
                continue;
            }
            let mut along_z = Touched::NOWHERE;
            missed += self.tighten_rows(volume, y, &mut along_z, &mut along_y, journal);
            let rest = self.tighten_line(volume, Axis::Z, y, &along_z, journal);
            doubtful += self.drop_layer(volume, y, rest);
        }
        if missed == 0 {
            self.kept_sum = 0;
            return IslandReport::default();
        }
        let mut rests = [<Grid<N> as Size>::Row::EMPTY; N];
        for (z, (line, rest)) in along_y.iter().zip(&mut rests).enumerate() {
            *rest = self.tighten_line(volume, Axis::Y, z, line, journal);
        }
        let (kept, kept_sum) = self.close(volume, &rests, doubtful);
        let known = kept_sum == self.kept_sum;
        self.kept_sum = kept_sum;
        let removed = missed - kept;
        IslandReport { removed, kept: if known { 0 } else { kept }, unsupported: false }
    }

    /// Tightens the columns along x of a layer and notes which others lose voxels. Rows of which
    /// nothing is left are dropped at once; of the others only those with islands stay open.
    /// Returns the number of voxels that weren't reached.
    fn tighten_rows(
        &mut self,
        volume: &mut Volume<N>,
        y: usize,
        along_z: &mut Touched<<Grid<N> as Size>::Row>,
        along_y: &mut [Touched<<Grid<N> as Size>::Row>; N],
        journal: &mut impl Journal<N>,
    ) -> u32 {
        let mut new = [Column::EMPTY; N];
        let mut changed = <Grid<N> as Size>::Row::EMPTY;
        let (mut missed, mut count) = ([changed; N], 0);
        for z in self.open[y].ones() {
            let (here, reached) = (volume.rows().row(y, z), self.reached.row(y, z));
            let islands = here & !reached;
            if islands.is_empty() {
                self.open[y].toggle(z);
                continue;
            }
            missed[count] = islands;
            count += 1;
            along_z.add(islands, z);
            along_y[z].add(islands, y);
            let left = here & reached;
            if left.is_empty() {
                self.open[y].toggle(z);
                *volume.rows_mut().row_mut(y, z) = left;
                changed.insert(z);
            } else {
                new[z] = Column([Range::hull(left)]);
                changed.insert_if(new[z] != volume.maps().column(Axis::X, (y, z)), z);
            }
        }
        volume.set_columns(Axis::X, y, changed, &new, journal);
        // Side by side they are counted several at once.
        missed[..count].iter().map(Bits::count).sum()
    }

    /// Tightens columns of a line to what is reached of them. Returns those that keep some.
    ///
    /// An end outside the stretch of the islands stands; the others are looked for, N columns at a
    /// time.
    fn tighten_line(
        &self,
        volume: &mut Volume<N>,
        axis: Axis,
        line: usize,
        &Touched { columns, first, last }: &Touched<<Grid<N> as Size>::Row>,
        journal: &mut impl Journal<N>,
    ) -> <Grid<N> as Size>::Row {
        if columns.is_empty() {
            return columns;
        }
        let reached = |i| {
            let (y, z) = if axis == Axis::Y { (i, line) } else { (line, i) };
            volume.rows().row(y, z) & self.reached.row(y, z)
        };
        let (below, above) = volume.maps().beyond(axis, line, columns, first, last);
        let mut new = *volume.maps().line(axis, line);
        let within = columns & !below & !above;
        let (empty, mut changed) = seek(within, first..=last, reached, &mut new, Range::with_lo);
        let rest = columns & !empty;
        let on = first..=N - 1;
        changed |= empty | seek(above & !below, on, reached, &mut new, Range::with_lo).1;
        let back = (0..=last).rev();
        changed |= seek(rest & !above, back, reached, &mut new, Range::with_hi).1;
        for run in empty.runs() {
            new[run.lo()..=run.hi()].fill(Column::EMPTY);
        }
        volume.set_columns(axis, line, changed, &new, journal);
        rest
    }

    /// Drops what wasn't reached of a layer, but for rows of which closure may keep some: where
    /// columns along x and z are left. Only those stay open. Returns the number of such voxels.
    fn drop_layer(
        &mut self,
        volume: &mut Volume<N>,
        y: usize,
        along_z: <Grid<N> as Size>::Row,
    ) -> usize {
        let mut doubtful = 0;
        for z in self.open[y].ones() {
            let (here, reached) = (volume.rows().row(y, z), self.reached.row(y, z));
            let held = here & !reached & along_z & volume.maps().column(Axis::X, (y, z)).row();
            if held.is_empty() {
                self.open[y].toggle(z);
                *volume.rows_mut().row_mut(y, z) = here & reached;
            } else {
                doubtful += held.count() as usize;
            }
        }
        doubtful
    }

    /// Makes the open rows follow the maps. Counts the voxels that closure keeps, and sums them up.
    fn close(
        &mut self,
        volume: &mut Volume<N>,
        along_y: &[<Grid<N> as Size>::Row; N],
        doubtful: usize,
    ) -> (u32, u64) {
        // Voxel by voxel for few, all columns at once for many.
        let many = doubtful > 4 * N * N;
        if many {
            volume.restore_rows();
        }
        let (mut kept, mut sum) = (0, 0u64);
        for y in 0..N {
            for z in self.open[y].ones() {
                let (here, reached) = (volume.rows().row(y, z), self.reached.row(y, z));
                let mut closed = here & !reached;
                if !many {
                    closed = volume.maps().row_among((y, z), closed & along_y[z]);
                    *volume.rows_mut().row_mut(y, z) = here & reached | closed;
                }
                kept += closed.count();
                sum = sum.wrapping_add(keyed(y, z, closed));
            }
        }
        (kept, sum)
    }
}

/// Walks rows in the order given, and where one of `columns` is first set puts that end of its
/// range there. Returns the columns that nowhere are set, and those that this changed.
#[inline]
fn seek<R: Bits, const N: usize>(
    mut columns: R,
    order: impl Iterator<Item = usize>,
    row: impl Fn(usize) -> R,
    line: &mut [Column; N],
    end: impl Fn(Range, usize) -> Range,
) -> (R, R) {
    let mut changed = R::EMPTY;
    for i in order {
        if columns.is_empty() {
            break;
        }
        let found = columns & row(i);
        if !found.is_empty() {
            for place in found.ones() {
                let range = end(line[place].0[0], i);
                changed.insert_if(line[place].0[0] != range, place);
                line[place] = Column([range]);
            }
            columns &= !found;
        }
    }
    (columns, changed)
}

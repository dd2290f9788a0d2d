//! Range update after an edit: the tight hulls of the columns in which voxels were flipped.

use super::pass::EditPass;
use super::{EditOperation, LineFlips};
use crate::volume::closing_line::ClosingLine;
use crate::volume::range::Range;
use crate::volume::range_maps::{Axis, Column};
use crate::volume::row::{BitRow, BitSet};
use crate::volume::size::{Grid, Size};

impl<const N: usize, const K: usize, const W: usize> EditPass<'_, N, K, W>
where
    Grid<N>: Size,
{
    /// Tightens the columns along y in which voxels were flipped.
    pub(super) fn tighten_along_y(&mut self) {
        for z in self.bounds.lo[2]..=self.bounds.hi[2] {
            let LineFlips { flipped, between, .. } = self.scratch.along_y[z];
            if between.is_empty() {
                continue;
            }
            let rows = self.volume.rows().row_strip::<W>(self.first_word);
            let before = self.volume.maps().line(Axis::Y, z);
            let mut columns = *before;
            let flips = (flipped.word_span(0), between);
            let moved =
                self.tighten_flipped_columns(before, &mut columns, flips, |y| rows.row(y, z));
            let ColumnGrowth { grown, growth } = self.replace_columns(Axis::Y, z, moved, &columns);
            self.scratch.along_y[z] = LineFlips { flipped, between, grown, growth };
        }
    }

    /// Tightens the columns along z of layer `y` in which voxels were flipped.
    pub(super) fn tighten_along_z(
        &mut self,
        y: usize,
        flipped_columns: BitRow<W>,
        flipped_z: Range,
    ) {
        let (flipped, between) = (flipped_columns, flipped_z);
        let rows = self.volume.rows().row_strip::<W>(self.first_word);
        let before = self.volume.maps().line(Axis::Z, y);
        let mut columns = *before;
        let flips = (flipped, between);
        let moved = self.tighten_flipped_columns(before, &mut columns, flips, |z| rows.row(y, z));
        let ColumnGrowth { grown, growth } = self.replace_columns(Axis::Z, y, moved, &columns);
        let flipped = BitSet::from_word_span(0, flipped);
        self.scratch.along_z[y] = LineFlips { flipped, between, grown, growth };
    }

    /// Tightens the columns of a line in which voxels were flipped. `row_at(i)` is the line's row at position
    /// `i` along the columns. `flipped_columns` and `between` give the columns and a range of positions that
    /// holds all flips. Returns the columns that may have changed. All ends that may have moved are searched
    /// for together.
    #[inline]
    fn tighten_flipped_columns(
        &self,
        before: &[Column<K>; N],
        columns: &mut [Column<K>; N],
        (flipped_columns, between): (BitRow<W>, Range),
        row_at: impl Fn(usize) -> BitRow<W>,
    ) -> <Grid<N> as Size>::Row {
        let before = &before[64 * self.first_word..];
        let columns = &mut columns[64 * self.first_word..];
        let carve = matches!(self.edit.operation, EditOperation::Carve { .. });
        let (mut seek_lo, mut seek_hi, mut gapped) = (BitRow::EMPTY, BitRow::EMPTY, BitRow::EMPTY);
        let (mut least, mut greatest) = (between.first(), between.last());
        for x in flipped_columns.iter_ones() {
            let old = before[x].hull();
            gapped.insert_if(before[x].has_gaps(), x);
            (least, greatest) = (least.min(old.first()), greatest.max(old.last()));
            // An end is unchanged if its voxel is still occupied (carve) or lies beyond the flips.
            let stands = |end, beyond| if carve { row_at(end).contains(x) } else { beyond };
            seek_lo.insert_if(!stands(old.first(), old.first() < between.first()), x);
            seek_hi.insert_if(!stands(old.last(), between.last() < old.last()), x);
        }
        visit_first_occupied(seek_hi, (least..between.last() + 1).rev(), &row_at, |found| {
            columns[found.x].set_hull_last(found.position);
        });
        let empty =
            visit_first_occupied(seek_lo, between.first()..greatest + 1, &row_at, |found| {
                columns[found.x].set_hull_first(found.position);
            });
        empty.iter_ones().for_each(|x| columns[x] = Column::EMPTY);
        let line = ClosingLine { before, after: columns, changed: between, removed_only: carve };
        let moved = seek_lo | seek_hi | line.close_gaps::<N, _>(flipped_columns, gapped, &row_at);
        BitSet::from_word_span(self.first_word, moved)
    }

    /// Replaces the columns of a line at `places`. Returns their growth if the edit adds voxels, else no
    /// growth.
    #[inline]
    pub(super) fn replace_columns(
        &mut self,
        axis: Axis,
        line: usize,
        mut places: <Grid<N> as Size>::Row,
        columns: &[Column<K>; N],
    ) -> ColumnGrowth<<Grid<N> as Size>::Row> {
        let mut grown = <Grid<N> as Size>::Row::EMPTY;
        let mut growth = Range::EMPTY;
        if self.edit.operation.adds_voxels() {
            let old = self.volume.maps().line(axis, line);
            for place in places.iter_ones() {
                if columns[place] == old[place] {
                    places.toggle(place);
                } else if let Some(by) = range_covering_growth::<N, K>(old[place], columns[place]) {
                    grown.insert(place);
                    growth = growth.hull_with(by);
                }
            }
        }
        self.volume.replace_columns(axis, line, places, columns, self.journal);
        ColumnGrowth { grown, growth }
    }
}

/// Returns an interval that covers the voxels in `new` but not in `old`, or `None` if there are none.
#[inline]
fn range_covering_growth<const N: usize, const K: usize>(
    old: Column<K>,
    new: Column<K>,
) -> Option<Range>
where
    Grid<N>: Size,
{
    if !old.has_gaps() && !new.has_gaps() {
        return range_covering_hull_growth(old.hull(), new.hull());
    }
    let growth = new.to_row::<<Grid<N> as Size>::Row>() & !old.to_row::<<Grid<N> as Size>::Row>();
    (!growth.is_empty()).then(|| Range::hull_of(growth))
}

/// [`range_covering_growth`] for columns of one interval.
#[inline]
fn range_covering_hull_growth(old: Range, new: Range) -> Option<Range> {
    if new.is_empty() || old.first() <= new.first() && new.last() <= old.last() {
        return None;
    }
    let lo = if new.first() < old.first() { new.first() } else { old.last() };
    let hi = if new.last() > old.last() { new.last() } else { old.first() };
    Some(if old.is_empty() { new } else { Range::new(lo, hi) })
}

/// The growth of columns of a line.
pub(super) struct ColumnGrowth<R> {
    /// The columns that grew.
    pub(super) grown: R,
    /// An interval that covers the growth.
    pub(super) growth: Range,
}

/// A column's first occupied voxel in the order of a scan.
struct FirstOccupied {
    /// The column, by its x from the first word on.
    x: usize,
    /// The voxel's position along the column.
    position: usize,
}

/// The columns in which a scan found no voxel.
type EmptyColumns<const W: usize> = BitRow<W>;

/// Scans rows in the given order of positions along the columns and calls `visit` for each sought column
/// where it is first occupied. Returns the columns without an occupied voxel.
#[inline]
fn visit_first_occupied<const W: usize>(
    mut sought: BitRow<W>,
    positions: impl Iterator<Item = usize>,
    row_at: impl Fn(usize) -> BitRow<W>,
    mut visit: impl FnMut(FirstOccupied),
) -> EmptyColumns<W> {
    for position in positions {
        if sought.is_empty() {
            break;
        }
        let found = sought & row_at(position);
        if !found.is_empty() {
            found.iter_ones().for_each(|x| visit(FirstOccupied { x, position }));
            sought &= !found;
        }
    }
    sought
}

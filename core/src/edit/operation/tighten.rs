//! Range update after an edit: the tight hulls of the columns in which voxels were flipped.

use super::pass::EditPass;
use super::{EditOperation, LineFlips};
use crate::volume::journal::Journal;
use crate::volume::range::Range;
use crate::volume::range_maps::{Axis, Column};
use crate::volume::row::{BitRow, BitSet};
use crate::volume::size::{Grid, Size};

impl<const N: usize, const W: usize, J: Journal<N>> EditPass<'_, N, W, J>
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
            let rows = self.volume.rows().strip::<W>(self.first);
            let mut columns = *self.volume.maps().line(Axis::Y, z);
            let moved = self
                .tighten_columns(&mut columns, flipped.word_span(0), between, |y| rows.row(y, z));
            let (grown, growth) = self.replace_columns(Axis::Y, z, moved, &columns);
            self.scratch.along_y[z] = LineFlips { flipped, between, grown, growth };
        }
    }

    /// Tightens the columns along z of layer `y` in which voxels were flipped.
    pub(super) fn tighten_along_z(&mut self, y: usize, flipped: BitRow<W>, between: Range) {
        let rows = self.volume.rows().strip::<W>(self.first);
        let mut columns = *self.volume.maps().line(Axis::Z, y);
        let moved = self.tighten_columns(&mut columns, flipped, between, |z| rows.row(y, z));
        let (grown, growth) = self.replace_columns(Axis::Z, y, moved, &columns);
        let flipped = BitSet::from_word_span(0, flipped);
        self.scratch.along_z[y] = LineFlips { flipped, between, grown, growth };
    }

    /// Tightens the columns of a line in which voxels were flipped. `row(i)` is the line's row at place
    /// `i` along the columns. Returns the columns that may have changed. All ends that may have moved
    /// are searched for together.
    #[inline]
    fn tighten_columns(
        &self,
        columns: &mut [Column; N],
        flipped: BitRow<W>,
        between: Range,
        row: impl Fn(usize) -> BitRow<W>,
    ) -> <Grid<N> as Size>::Row {
        let columns = &mut columns[64 * self.first..];
        let carve = matches!(self.edit.operation, EditOperation::Carve { .. });
        let (mut seek_lo, mut seek_hi) = (BitRow::EMPTY, BitRow::EMPTY);
        let (mut least, mut greatest) = (between.first(), between.last());
        for x in flipped.iter_ones() {
            let old = columns[x].hull();
            (least, greatest) = (least.min(old.first()), greatest.max(old.last()));
            // An end is unchanged if its voxel is still occupied (carve) or lies beyond the flips.
            let stands = |end, beyond| if carve { row(end).contains(x) } else { beyond };
            seek_lo.insert_if(!stands(old.first(), old.first() < between.first()), x);
            seek_hi.insert_if(!stands(old.last(), between.last() < old.last()), x);
        }
        find_first_occupied(seek_hi, (least..between.last() + 1).rev(), &row, |x, i| {
            columns[x] = Column([columns[x].0[0].with_last(i)]);
        });
        let empty = find_first_occupied(seek_lo, between.first()..greatest + 1, &row, |x, i| {
            columns[x] = Column([columns[x].0[0].with_first(i)]);
        });
        empty.iter_ones().for_each(|x| columns[x] = Column::EMPTY);
        BitSet::from_word_span(self.first, seek_lo | seek_hi)
    }

    /// Replaces the columns of a line at `places`. Where an edit adds voxels, returns which columns grew
    /// and an interval that covers their growth.
    #[inline]
    pub(super) fn replace_columns(
        &mut self,
        axis: Axis,
        line: usize,
        mut places: <Grid<N> as Size>::Row,
        columns: &[Column; N],
    ) -> (<Grid<N> as Size>::Row, Range) {
        let mut grown = <Grid<N> as Size>::Row::EMPTY;
        let mut growth = Range::EMPTY;
        if self.edit.operation.adds_voxels() {
            let old = self.volume.maps().line(axis, line);
            for place in places.iter_ones() {
                if columns[place] == old[place] {
                    places.toggle(place);
                } else if let Some(by) = added_stretch(old[place].hull(), columns[place].hull()) {
                    grown.insert(place);
                    growth = growth.hull_with(by);
                }
            }
        }
        self.volume.replace_columns(axis, line, places, columns, self.journal);
        (grown, growth)
    }
}

/// An interval that covers the growth of a range; `None` if it didn't grow.
#[inline]
fn added_stretch(old: Range, new: Range) -> Option<Range> {
    if new.is_empty() || old.first() <= new.first() && new.last() <= old.last() {
        return None;
    }
    let lo = if new.first() < old.first() { new.first() } else { old.last() };
    let hi = if new.last() > old.last() { new.last() } else { old.first() };
    Some(if old.is_empty() { new } else { Range::new(lo, hi) })
}

/// Scans rows in the given order and calls `found_at` with each sought column and the row where it is
/// first occupied. Returns the columns that are occupied in no row.
#[inline]
fn find_first_occupied<const W: usize>(
    mut sought: BitRow<W>,
    order: impl Iterator<Item = usize>,
    row: impl Fn(usize) -> BitRow<W>,
    mut found_at: impl FnMut(usize, usize),
) -> BitRow<W> {
    for i in order {
        if sought.is_empty() {
            break;
        }
        let found = sought & row(i);
        if !found.is_empty() {
            found.iter_ones().for_each(|x| found_at(x, i));
            sought &= !found;
        }
    }
    sought
}

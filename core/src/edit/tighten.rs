//! Ranges after an edit: the tight hulls of what its flips left.

use super::pass::Pass;
use super::{Line, Operation};
use crate::maps::{Axis, Column, Range};
use crate::row::{Bits, Row};
use crate::size::{Grid, Size};
use crate::volume::Journal;

impl<const N: usize, const W: usize, J: Journal<N>> Pass<'_, N, W, J>
where
    Grid<N>: Size,
{
    pub(super) fn tighten_along_y(&mut self) {
        for z in self.bounds.lo[2]..=self.bounds.hi[2] {
            let Line { flipped, between, .. } = self.scratch.along_y[z];
            if between.is_empty() {
                continue;
            }
            let rows = self.volume.rows().strip::<W>(self.first);
            let mut columns = *self.volume.maps().line(Axis::Y, z);
            let moved = self.tighten(&mut columns, flipped.part(0), between, |y| rows.row(y, z));
            let (grown, growth) = self.replace(Axis::Y, z, moved, &columns);
            self.scratch.along_y[z] = Line { flipped, between, grown, growth };
        }
    }

    pub(super) fn tighten_along_z(&mut self, y: usize, flipped: Row<W>, between: Range) {
        let rows = self.volume.rows().strip::<W>(self.first);
        let mut columns = *self.volume.maps().line(Axis::Z, y);
        let moved = self.tighten(&mut columns, flipped, between, |z| rows.row(y, z));
        let (grown, growth) = self.replace(Axis::Z, y, moved, &columns);
        let flipped = Bits::of_part(0, flipped);
        self.scratch.along_z[y] = Line { flipped, between, grown, growth };
    }

    /// Re-tightens the columns of a line that voxels were flipped in; the line's voxels are its
    /// rows one after the other. Returns which may have changed. Ends that may have moved are
    /// looked for all at a time.
    #[inline]
    fn tighten(
        &self,
        columns: &mut [Column; N],
        flipped: Row<W>,
        between: Range,
        row: impl Fn(usize) -> Row<W>,
    ) -> <Grid<N> as Size>::Row {
        let columns = &mut columns[64 * self.first..];
        let carve = matches!(self.edit.operation, Operation::Carve { .. });
        let (mut seek_lo, mut seek_hi) = (Row::EMPTY, Row::EMPTY);
        let (mut least, mut greatest) = (between.lo(), between.hi());
        for x in flipped.ones() {
            let old = columns[x].hull();
            (least, greatest) = (least.min(old.lo()), greatest.max(old.hi()));
            // In a carve an end stands whose voxel is left, else one beyond the flips.
            let stands = |end, beyond| if carve { row(end).contains(x) } else { beyond };
            seek_lo.insert_if(!stands(old.lo(), old.lo() < between.lo()), x);
            seek_hi.insert_if(!stands(old.hi(), between.hi() < old.hi()), x);
        }
        seek(seek_hi, (least..between.hi() + 1).rev(), &row, |x, i| {
            columns[x] = Column([columns[x].0[0].with_hi(i)]);
        });
        let empty = seek(seek_lo, between.lo()..greatest + 1, &row, |x, i| {
            columns[x] = Column([columns[x].0[0].with_lo(i)]);
        });
        empty.ones().for_each(|x| columns[x] = Column::EMPTY);
        Bits::of_part(self.first, seek_lo | seek_hi)
    }

    /// Replaces those columns of a line that differ among `places`. Returns which grew, and by what
    /// stretch at most.
    #[inline]
    pub(super) fn replace(
        &mut self,
        axis: Axis,
        line: usize,
        mut places: <Grid<N> as Size>::Row,
        columns: &[Column; N],
    ) -> (<Grid<N> as Size>::Row, Range) {
        let mut grown = <Grid<N> as Size>::Row::EMPTY;
        let mut growth = Range::EMPTY;
        if self.edit.operation.adds() {
            let old = self.volume.maps().line(axis, line);
            for place in places.ones() {
                if columns[place] == old[place] {
                    places.toggle(place);
                } else if let Some(by) = added_stretch(old[place].hull(), columns[place].hull()) {
                    grown.insert(place);
                    growth = growth.hull_with(by);
                }
            }
        }
        self.volume.set_columns(axis, line, places, columns, self.journal);
        (grown, growth)
    }
}

/// By what stretch a range grew, at most.
#[inline]
fn added_stretch(old: Range, new: Range) -> Option<Range> {
    if new.is_empty() || old.lo() <= new.lo() && new.hi() <= old.hi() {
        return None;
    }
    let lo = if new.lo() < old.lo() { new.lo() } else { old.hi() };
    let hi = if new.hi() > old.hi() { new.hi() } else { old.lo() };
    Some(if old.is_empty() { new } else { Range::new(lo, hi) })
}

/// Walks rows of a line in the order given and tells where each sought column is first occupied.
/// Returns the columns that nowhere are.
#[inline]
fn seek<const W: usize>(
    mut sought: Row<W>,
    order: impl Iterator<Item = usize>,
    row: impl Fn(usize) -> Row<W>,
    mut found_at: impl FnMut(usize, usize),
) -> Row<W> {
    for i in order {
        if sought.is_empty() {
            break;
        }
        let found = sought & row(i);
        if !found.is_empty() {
            found.ones().for_each(|x| found_at(x, i));
            sought &= !found;
        }
    }
    sought
}

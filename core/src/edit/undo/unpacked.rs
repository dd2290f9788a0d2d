//! The newest undo entry: a bitmap of its columns and an array of values.

use super::packed::{EntryCell, flag_cell_count};
use crate::volume::range_maps::{Axis, Column, ColumnAddress};
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};

/// The newest entry. It is empty if `changed` is.
#[derive(Debug)]
pub(super) struct UnpackedEntry<const N: usize, const K: usize = 1>
where
    Grid<N>: Size,
{
    /// Bit `place` of `changed[axis][line]` is set for each column of the entry.
    pub(super) changed: [[<Grid<N> as Size>::Row; N]; 3],
    /// Bit `line` of `lines[axis]` is set for each line with such a column.
    lines: [<Grid<N> as Size>::Row; 3],
    /// The other values of the entry's columns; undefined elsewhere.
    pub(super) others: [[[Column<K>; N]; N]; 3],
    /// The sum of [`super::packed::digest_term`] over its columns.
    pub(super) sum: u64,
}

/// The columns of an entry that lie in one line.
struct EntryLine<'a, const N: usize, const K: usize = 1>
where
    Grid<N>: Size,
{
    /// The line's index in the three maps together.
    line_of_maps: usize,
    columns: <Grid<N> as Size>::Row,
    /// Their other values; undefined elsewhere.
    others: &'a [Column<K>; N],
}

/// A word of an entry's bitmap of columns.
struct BitmapWord {
    index: usize,
    bits: u64,
}

impl<const N: usize, const K: usize> UnpackedEntry<N, K>
where
    Grid<N>: Size,
{
    /// Creates an entry without columns. For static initialisers only.
    pub(super) const fn new() -> Self {
        UnpackedEntry {
            changed: [[<Grid<N> as Size>::Row::EMPTY; N]; 3],
            lines: [<Grid<N> as Size>::Row::EMPTY; 3],
            others: [[[Column::EMPTY; N]; N]; 3],
            sum: 0,
        }
    }

    /// Removes all columns.
    pub(super) fn clear(&mut self) {
        for (changed, lines) in self.changed.iter_mut().zip(&mut self.lines) {
            lines.iter_ones().for_each(|line| changed[line] = BitSet::EMPTY);
            *lines = BitSet::EMPTY;
        }
        self.sum = 0;
    }

    /// Adds columns of a line to the entry.
    #[inline]
    pub(super) fn insert_columns(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
    ) {
        self.changed[axis as usize][line] |= places;
        self.lines[axis as usize].insert(line);
    }

    /// Visits the values of each run of columns.
    #[inline]
    pub(super) fn visit_runs(
        &mut self,
        mut visit: impl FnMut(Axis, ColumnAddress, &mut [Column<K>]),
    ) {
        for axis in Axis::ALL {
            for line in self.lines[axis as usize].iter_ones() {
                let others = &mut self.others[axis as usize][line];
                for run in self.changed[axis as usize][line].iter_runs_within_words() {
                    visit(axis, (line, run.first()), &mut others[run.first()..=run.last()]);
                }
            }
        }
    }

    /// Visits each line of the entry.
    #[inline]
    fn visit_lines(&self, mut visit: impl FnMut(EntryLine<'_, N, K>)) {
        for axis in 0..3 {
            for line in self.lines[axis].iter_ones() {
                visit(EntryLine {
                    line_of_maps: axis * N + line,
                    columns: self.changed[axis][line],
                    others: &self.others[axis][line],
                });
            }
        }
    }

    /// Visits each non-zero word of the bitmap.
    #[inline]
    fn visit_bitmap_words(&self, mut visit: impl FnMut(BitmapWord)) {
        let words = <Grid<N> as Size>::Row::WORDS;
        self.visit_lines(|EntryLine { line_of_maps, columns, .. }| {
            for i in 0..words {
                if columns.word(i) != 0 {
                    visit(BitmapWord { index: line_of_maps * words + i, bits: columns.word(i) });
                }
            }
        });
    }

    /// Returns the number of columns.
    pub(super) fn count_columns(&self) -> u32 {
        let mut count = 0;
        self.visit_lines(|line| count += line.columns.count_ones());
        count
    }

    /// Returns the number of cells that [`UnpackedEntry::write_packed`] emits.
    pub(super) fn packed_cell_count(&self) -> usize {
        let mut cells = flag_cell_count::<N>();
        self.visit_bitmap_words(|word| cells += 4 + K * word.bits.count_ones() as usize);
        cells
    }

    /// Emits the entry as packed cells, some at a time.
    pub(super) fn write_packed(&self, mut emit: impl FnMut(&[EntryCell])) {
        let (mut flags, mut cell) = (0u16, 0);
        self.visit_bitmap_words(|BitmapWord { index: i, .. }| {
            while cell < i / 16 {
                emit(&[flags.to_le_bytes()]);
                (flags, cell) = (0, cell + 1);
            }
            flags |= 1 << (i % 16);
        });
        for _ in cell..flag_cell_count::<N>() {
            emit(&[flags.to_le_bytes()]);
            flags = 0;
        }
        self.visit_bitmap_words(|word| emit(word.bits.to_le_bytes().as_chunks().0));
        let mut buffer = [[[0; 2]; K]; 64];
        self.visit_lines(|EntryLine { columns, others, .. }| {
            for run in columns.iter_runs_within_words() {
                let others = &others[run.first()..=run.last()];
                buffer.iter_mut().zip(others).for_each(|(to, from)| *to = from.to_bytes());
                emit(buffer[..others.len()].as_flattened());
            }
        });
    }
}

//! Undo history: for each stroke, the columns that it changed and their other values. Undo swaps those
//! values with the volume's columns; redo is the same swap.
//!
//! The newest entry, the *head*, is stored unpacked: a bitmap of its columns and an array of values,
//! so that recording a column is a test and a store. Older entries are packed contiguously, oldest first;
//! the oldest is dropped when space runs out.
//!
//! A packed entry is a sequence of cells of two bytes: a bitmap of the columns as words of 64 (map
//! by map, line by line) without the zero words, behind one flag a word; then the K ranges of each
//! column in that order.

mod bytes;
mod check;
mod packed;

pub(crate) use check::UnsoundEntry;

use heapless::Vec;

use crate::codec::digest::DIGEST_KEYS;
use crate::limits::{UNDO_ENTRIES, UNDO_PLANES};
use crate::volume::column_digest::line_key;
use crate::volume::dirty::DirtyRects;
use crate::volume::editable::Volume;
use crate::volume::range_maps::{Axis, Column, ColumnAddress};
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};
use packed::{
    EntryCell, EntryColumns, column_from_cells, digest_term, flag_cell_count, nonzero_column_number,
};

/// The strokes that can be undone and redone in a volume of N^3 voxels.
#[derive(Debug)]
pub struct UndoHistory<const N: usize, const K: usize = 1>
where
    Grid<N>: Size,
{
    head: UnpackedEntry<N, K>,
    /// The packed entries.
    cells: [[[[EntryCell; K]; N]; N]; UNDO_PLANES],
    packed: Vec<PackedEntry, UNDO_ENTRIES, u16>,
    /// Number of applied entries; those after them are undone.
    applied: u16,
    has_head: bool,
    /// Whether a stroke began and has recorded no change yet.
    fresh: bool,
}

/// The newest entry. Empty where `changed` is.
#[derive(Debug)]
struct UnpackedEntry<const N: usize, const K: usize = 1>
where
    Grid<N>: Size,
{
    /// Bit `place` of `changed[axis][line]`: a column of the entry.
    changed: [[<Grid<N> as Size>::Row; N]; 3],
    /// Bit `line` of `lines[axis]`: a line that holds such a column.
    lines: [<Grid<N> as Size>::Row; 3],
    /// The other values of the entry's columns; meaningless elsewhere.
    others: [[[Column<K>; N]; N]; 3],
    sum: u64,
}

/// The numbers of strokes that can be undone and redone.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct UndoCounts {
    /// Strokes that are applied.
    pub undoable: usize,
    /// Strokes that were undone.
    pub redoable: usize,
}

/// The columns of an entry that lie in one line.
struct EntryLine<'a, const N: usize, const K: usize = 1>
where
    Grid<N>: Size,
{
    /// The line's index in the three maps together.
    line_of_maps: usize,
    columns: <Grid<N> as Size>::Row,
    /// Their other values; meaningless elsewhere.
    others: &'a [Column<K>; N],
}

/// A word of an entry's bitmap of columns.
struct BitmapWord {
    index: usize,
    bits: u64,
}

/// One packed entry.
#[derive(Debug, Clone, Copy)]
struct PackedEntry {
    cells: u32,
    /// The sum of [`digest_term`] over its columns.
    sum: u64,
}

impl<const N: usize, const K: usize> UndoHistory<N, K>
where
    Grid<N>: Size,
{
    /// No entries. For static initialisers only.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the entries about by value
    pub const fn new() -> Self {
        UndoHistory {
            head: UnpackedEntry {
                changed: [[<Grid<N> as Size>::Row::EMPTY; N]; 3],
                lines: [<Grid<N> as Size>::Row::EMPTY; 3],
                others: [[[Column::EMPTY; N]; N]; 3],
                sum: 0,
            },
            cells: [[[[[0; 2]; K]; N]; N]; UNDO_PLANES],
            packed: Vec::new(),
            applied: 0,
            has_head: false,
            fresh: false,
        }
    }

    /// Drops all entries.
    pub fn clear(&mut self) {
        self.packed.clear();
        self.head.clear();
        (self.applied, self.has_head, self.fresh) = (0, false, false);
    }

    /// Begins a stroke: the next recorded change opens an entry and drops the undone ones.
    pub fn begin_stroke(&mut self) {
        self.fresh = true;
    }

    /// Records columns that a stroke is about to change: those at `places` of a line, whose present
    /// values are in `old_columns`.
    #[inline]
    pub fn record_columns(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        old_columns: &[Column<K>; N],
    ) {
        if self.fresh && !places.is_empty() {
            self.open_entry();
        }
        self.record_into_newest_entry(axis, line, places, old_columns);
    }

    /// Records columns that an island removal is about to change. They join the newest entry, even when
    /// the next stroke has begun but changed nothing.
    pub fn record_into_newest_entry(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        old_columns: &[Column<K>; N],
    ) {
        if places.is_empty() {
            return;
        }
        self.open_entry_unless_head_is_newest();
        let new = places & !self.head.changed[axis as usize][line];
        self.head.insert_columns(axis, line, new);
        let others = &mut self.head.others[axis as usize][line];
        let mut sum = 0u64;
        for run in new.iter_runs_within_words() {
            let run = run.first()..=run.last();
            let (others, old_columns) = (&mut others[run.clone()], &old_columns[run.clone()]);
            for ((other, old), key) in others.iter_mut().zip(old_columns).zip(&DIGEST_KEYS[run]) {
                *other = *old;
                sum = sum.wrapping_add(key.wrapping_mul(nonzero_column_number(*old)));
            }
        }
        self.head.sum = self.head.sum.wrapping_add(sum.wrapping_mul(line_key(axis, line)));
    }

    /// The numbers of entries that can be undone and redone.
    #[must_use]
    pub fn undo_counts(&self) -> UndoCounts {
        let undoable = usize::from(self.applied);
        UndoCounts { undoable, redoable: self.len() - undoable }
    }

    /// Undoes the newest applied entry and marks its columns in `dirty` as one edit. Returns `false`
    /// when there is none.
    pub fn try_undo(&mut self, volume: &mut Volume<N, K>, dirty: &mut DirtyRects) -> bool {
        if self.applied == 0 {
            return false;
        }
        self.applied -= 1;
        self.swap_entry(self.applied.into(), volume, dirty);
        true
    }

    /// Redoes the oldest undone entry, likewise. Returns `false` when there is none.
    pub fn try_redo(&mut self, volume: &mut Volume<N, K>, dirty: &mut DirtyRects) -> bool {
        if usize::from(self.applied) == self.len() {
            return false;
        }
        self.swap_entry(self.applied.into(), volume, dirty);
        self.applied += 1;
        true
    }

    fn len(&self) -> usize {
        self.packed.len() + usize::from(self.has_head)
    }

    /// Makes the head the newest applied entry, by opening one if it isn't.
    fn open_entry_unless_head_is_newest(&mut self) {
        if usize::from(self.applied) != self.len() || !self.has_head {
            self.open_entry();
        }
    }

    /// Opens an entry as the head: drops the undone entries, or packs the head of before.
    fn open_entry(&mut self) {
        let applied = usize::from(self.applied);
        if applied < self.len() {
            self.packed.truncate(applied);
        } else if self.has_head {
            self.pack_head();
        }
        self.head.clear();
        (self.has_head, self.fresh) = (true, false);
        self.applied = self.packed.len() as u16 + 1;
    }

    fn pack_head(&mut self) {
        let need = self.head.packed_cell_count();
        self.make_room_for_cells(need);
        let mut end = self.count_packed_cells();
        let cells = self.cells.as_flattened_mut().as_flattened_mut().as_flattened_mut();
        self.head.write_packed(|cell| {
            cells[end] = cell;
            end += 1;
        });
        let entry = PackedEntry { cells: need as u32, sum: self.head.sum };
        self.packed.push(entry).expect("room was made");
    }

    /// Drops the oldest entries until one of `needed` cells fits after the rest.
    fn make_room_for_cells(&mut self, needed: usize) {
        let room = UNDO_PLANES * N * N * K;
        let (mut dropped, mut freed, used) = (0, 0, self.count_packed_cells());
        while used - freed + needed > room || self.packed.len() - dropped == UNDO_ENTRIES {
            freed += self.packed[dropped].cells as usize;
            dropped += 1;
        }
        if dropped > 0 {
            self.cells
                .as_flattened_mut()
                .as_flattened_mut()
                .as_flattened_mut()
                .copy_within(freed..used, 0);
            self.packed.rotate_left(dropped);
            self.packed.truncate(self.packed.len() - dropped);
        }
    }

    /// Cells that the packed entries take.
    fn count_packed_cells(&self) -> usize {
        self.packed.iter().map(|entry| entry.cells as usize).sum()
    }

    /// Swaps the values of entry `index` with the volume's columns.
    fn swap_entry(&mut self, index: usize, volume: &mut Volume<N, K>, dirty: &mut DirtyRects) {
        self.swap_columns(index, volume, |axis, at, ours, theirs| {
            if ours != theirs {
                dirty.mark_column(axis, at);
            }
        });
        dirty.end_edit();
        volume.rebuild_rows();
        // Later changes don't belong to the entry that was undone or redone.
        self.fresh = true;
    }

    /// Swaps the values of entry `index` with the volume's columns, whose bit rows are stale then. Calls
    /// `visit` with each column's address, its value and that of the entry.
    #[inline]
    fn swap_columns(
        &mut self,
        index: usize,
        volume: &mut Volume<N, K>,
        mut visit: impl FnMut(Axis, ColumnAddress, Column<K>, Column<K>),
    ) {
        let mut sum = 0u64;
        let mut exchange = |axis, at, theirs: Column<K>| {
            let ours = volume.replace_column_leaving_bit_rows(axis, at, theirs);
            visit(axis, at, ours, theirs);
            sum = sum.wrapping_add(digest_term(axis, at, ours));
            ours
        };
        if index < self.packed.len() {
            let start = self.packed[..index].iter().map(|entry| entry.cells as usize).sum();
            let cells = self.cells.as_flattened_mut().as_flattened_mut().as_flattened_mut();
            let (columns, values) =
                EntryColumns::<N>::split_columns_and_values_mut(&mut cells[start..]);
            for ((axis, at), cells) in columns.zip(values.as_chunks_mut().0) {
                *cells = exchange(axis, at, column_from_cells::<N, K>(*cells)).to_bytes();
            }
            self.packed[index].sum = sum;
        } else {
            self.head.visit_columns(|axis, at, other| *other = exchange(axis, at, *other));
            self.head.sum = sum;
        }
    }
}

impl<const N: usize, const K: usize> UnpackedEntry<N, K>
where
    Grid<N>: Size,
{
    fn clear(&mut self) {
        for (changed, lines) in self.changed.iter_mut().zip(&mut self.lines) {
            lines.iter_ones().for_each(|line| changed[line] = BitSet::EMPTY);
            *lines = BitSet::EMPTY;
        }
        self.sum = 0;
    }

    /// Adds columns of a line to the entry.
    #[inline]
    fn insert_columns(&mut self, axis: Axis, line: usize, places: <Grid<N> as Size>::Row) {
        self.changed[axis as usize][line] |= places;
        self.lines[axis as usize].insert(line);
    }

    fn visit_columns(&mut self, mut visit: impl FnMut(Axis, ColumnAddress, &mut Column<K>)) {
        for axis in Axis::ALL {
            for line in self.lines[axis as usize].iter_ones() {
                for place in self.changed[axis as usize][line].iter_ones() {
                    visit(axis, (line, place), &mut self.others[axis as usize][line][place]);
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

    /// Cells that [`UnpackedEntry::write_packed`] emits.
    fn packed_cell_count(&self) -> usize {
        let mut cells = flag_cell_count::<N>();
        self.visit_bitmap_words(|word| cells += 4 + K * word.bits.count_ones() as usize);
        cells
    }

    fn write_packed(&self, mut emit: impl FnMut(EntryCell)) {
        let (mut flags, mut cell) = (0u16, 0);
        self.visit_bitmap_words(|BitmapWord { index: i, .. }| {
            while cell < i / 16 {
                emit(flags.to_le_bytes());
                (flags, cell) = (0, cell + 1);
            }
            flags |= 1 << (i % 16);
        });
        for _ in cell..flag_cell_count::<N>() {
            emit(flags.to_le_bytes());
            flags = 0;
        }
        self.visit_bitmap_words(|word| {
            word.bits.to_le_bytes().as_chunks().0.iter().for_each(|cell| emit(*cell));
        });
        self.visit_lines(|EntryLine { columns, others, .. }| {
            columns.iter_ones().flat_map(|place| others[place].to_bytes()).for_each(&mut emit);
        });
    }
}
